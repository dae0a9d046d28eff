"""Rods with bodies through the program: outcome and gap, a shape of their own, scans over the body, clusters of rods that
touch, the same from Python, and what is refused."""

import csv
import json
import math

import rodwake
from rodwake import SCENES, ProgramTest

PAIR, CROWD = SCENES / "rods_with_bodies.toml", SCENES / "crowd_with_bodies.toml"
LONE = """schema = 1
[[rods]]
position = [0.0, 0.0]
body = { length = 2.0, spheres = 10 }
[[rods]]
position = [4.0, 0.0]
heading = "180 deg"
%s
[rods_run]
t_end = 2.5
"""
BODY = "[body]\nspheres = 8\nlength = 1.3\nthick_diameter = 0.32\nthin_diameter = 0.23\n"
FIT = "schema = 1\n" + BODY + """[fit]
parameters = ["kappa", "stall_overlap", "mobility_ratio"]
fixed = { eta = 1.0, alpha = 1.0 }
[[fit.trajectories]]
file = "%s"
start_poses = "exact"
sigma_position = 0.01
sigma_heading = 0.01
"""
DISC = "body = { spheres = 1, length = 0.4, thick_diameter = 0.4, thin_diameter = 0.4 }"


def options(*settings):
    return [part for setting in settings for part in ("-s", setting)]


class BodiesTest(ProgramTest):
    def rods(self, scene, *settings):
        self.expect(0, "rods", scene, "--quiet", "-o", self.folder / "out", "--force", *options(*settings))
        return json.loads((self.folder / "out/outcome.json").read_text())

    def test_a_pair_stays_together_or_slides_apart(self):
        bound = self.rods(PAIR)
        self.assertEqual((bound["outcome"], bound["certificate"]), ("bound", "open"))
        self.assertLess(-0.03, bound["min_gap"])  # some overlap of the kind at which one rod stalls
        self.assertLess(bound["min_gap"], 0)
        self.assertLess(bound["separation"], 0.6)
        apart = self.rods(PAIR, "rods.1.heading=-90 deg", "coupling.kappa=0")
        self.assertEqual(apart["outcome"], "escape")
        self.assertGreater(apart["min_gap"], 0)
        self.assertNotIn("min_gap", self.rods(PAIR, "body=", "rods.1.body=", "rods_run.contact_distance=0.1"))

    def test_a_pair_in_a_medium_with_memory(self):
        """The quick medium of small alpha has the wakes of the exact one, but for the width of its force and its box."""
        quick = "medium.alpha=0.05", "rods_run.t_end=3"
        static = self.rods(PAIR, *quick)
        memory = self.rods(PAIR, *quick, "medium.field=dynamic", "medium.dynamic={box=20, force_width=0.4, modes=60}")
        self.assertEqual(memory["outcome"], static["outcome"])
        self.assertLess(memory["min_gap"], 0)
        for key, error in (("min_gap", 0.001), ("min_separation", 0.05)):
            self.assertAlmostEqual(memory[key], static[key], delta=error, msg=key)

    def test_rods_of_their_own_shape(self):
        scene = self.write("own.toml", LONE % DISC)
        stalled = self.rods(scene)
        # a long rod pushes a disc of 0.4 that walks against it: both walk, so their discs overlap by 0.05 of two radii
        self.assertEqual(stalled["outcome"], "bound")
        self.assertAlmostEqual(stalled["min_gap"], -0.05 * (0.1 + 0.2), delta=1e-6)
        refused = self.expect(2, "check", self.write("some.toml", LONE % "")).stderr
        self.assertIn("give [body] for all, or each rod a body", refused)

    def test_a_scan_over_the_body(self):
        scene = self.write("scan.toml", PAIR.read_text() + """
[scan]
[[scan.axes]]
key = "body.thin_diameter"
values = [0.19, 0.2, 0.3]
[[scan.axes]]
key = "rods.1.heading"
values = ["-90 deg", "97 deg"]
""")
        self.expect(0, "scan", scene, "--quiet", "-o", self.folder / "scan", *options("rods_run.t_end=6"))
        with (self.folder / "scan/scan.csv").open(encoding="utf-8") as file:
            rows = list(csv.DictReader(line for line in file if not line.startswith("#")))
        self.assertEqual({row["outcome"] for row in rows}, {"bound", "escape"})

    def test_clusters_of_rods_that_touch(self):
        short = "rods_random.count=30", "rods_random.extent=8", "rods_run.t_end=3", "rods_order.from=1"
        self.rods(CROWD, *short)
        means = json.loads((self.folder / "out/rods_order.json").read_text())
        self.assertNotIn("link", means)
        self.assertGreater(means["mean_size"]["value"], 1)
        self.assertGreater(means["touch_lifetime"], 0)
        with (self.folder / "out/fluctuations.csv").open(encoding="utf-8") as file:
            cells = list(csv.DictReader(file))
        self.assertEqual(len(cells), 2)  # 2 x 2 and 4 x 4 for 30 rods
        self.assertAlmostEqual(float(cells[0]["cell"]), 2 * float(cells[1]["cell"]), delta=1e-9)
        self.assertAlmostEqual(float(cells[0]["rods"]), 4 * float(cells[1]["rods"]), delta=1e-9)
        self.assertGreater(float(cells[1]["fluctuation_error"]), 0)
        no_link = self.expect(2, "check", CROWD, *options(*short, "body=")).stderr
        self.assertIn("rods_order.link is missing", no_link)

    def test_a_film_for_other_programs(self):
        """Each rod as its discs, in the box."""
        self.rods(PAIR, "rods_run.t_end=1", "rods_run.output_interval=0.5", "medium.periodic=12")
        self.expect(0, "convert", self.folder / "out", "-o", self.folder / "film.xyz", "--quiet")
        frames = (self.folder / "film.xyz").read_text().split("18\n")[1:]  # 8 + 10 discs
        self.assertEqual([("Lattice=\"12.0 " in frame, f"Time={k / 2}" in frame) for k, frame in enumerate(frames)], [(True, True)] * 3)
        discs = [[float(word) for word in line.split()[1:]] for line in frames[0].splitlines()[1:]]
        back, front = discs[0], discs[7]  # of a rod of 1.3 at the origin that heads to 0.2
        self.assertAlmostEqual(math.dist(back[:2], front[:2]), 1.3 - 0.16 - 0.115, delta=1e-9)
        self.assertAlmostEqual(math.atan2(front[1] - back[1], front[0] - back[0]), 0.2, delta=1e-9)
        self.assertEqual((back[4], front[4], discs[8][4]), (0.16, 0.115, 0.17))
        self.expect(0, "convert", self.folder / "out", "-o", self.folder / "film.csv", "--quiet")
        self.assertEqual(len((self.folder / "film.csv").read_text().splitlines()), 1 + 3 * 2)  # poses
        none = self.expect(2, "convert", self.folder / "out", "-o", self.folder / "film.dump", "--group", "other").stderr
        self.assertIn("no rods of the case other", none)

    def test_fit_of_rods_that_touch(self):
        """The body's numbers come back from the rods' own tracks."""
        self.rods(PAIR, "rods.1.body=", "body.stall_overlap=0.1", "body.mobility_ratio=0.6", "rods_run.t_end=3", "rods_run.output_interval=0.1")
        text = FIT % (self.folder / "out/rods.csv")
        self.expect(0, "fit", self.write("fit.toml", text), "--quiet", "-o", self.folder / "fit")
        found = json.loads((self.folder / "fit/fit.json").read_text())["parameters"]
        for name, value in (("kappa", 2), ("stall_overlap", 0.1), ("mobility_ratio", 0.6)):
            self.assertAlmostEqual(found[name]["value"], value, delta=1e-4 * value, msg=name)
        for old, new, why in ((BODY, "", "stall_overlap is of rods with bodies: give [body]"), ('"kappa"', '"D_r"', "not linear in what noise moves them")):
            self.assertIn(why, self.expect(2, "check", self.write("no.toml", text.replace(old, new))).stderr)

    def test_what_is_refused(self):
        for setting, why in (("body.spheres=2", "body.spheres is 2: must be 1 or 3 to 1000"), ("body.spheres=5", "leaves gaps in the row"),
                             ("body.thin_diameter=0.4", "at most thick_diameter = 0.32"), ("body.stall_overlap=0", ">= 0.0001"),
                             ("rods.1.position=[0.3, 0.0]", "overlap by"), ("medium.periodic=3.1", "must exceed 3.2")):
            self.assertIn(why, self.expect(2, "check", PAIR, *options(setting)).stderr)
        mesh = options("medium.field=dynamic", 'medium.dynamic={evaluation="mesh"}')
        self.assertIn("take self_field = true, or sums for at most 64 rods", self.expect(2, "check", PAIR, *mesh).stderr)
        dense = self.expect(2, "check", CROWD, *options("rods_random.extent=8")).stderr
        self.assertIn("fewer rods or a larger extent", dense)


if __name__ == "__main__":
    rodwake.main()
