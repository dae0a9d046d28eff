"""rodwake check: what it says of the cost, part by part. Times are those of this machine; what is tested is which parts are there."""

import re

import rodwake
from rodwake import PAIR, ProgramTest

BED = """schema = 1
[granular]
phi_b = 0.6
box = "20 a"
duration = "1 s"
[granular.output]
formats = []
"""
ROD = "[[granular.rods]]\nposition = [\"10 a\", \"10 a\"]\n"


class CostTest(ProgramTest):
    def cost(self, scene, *settings):
        self.write("scene.toml", scene)
        text = self.expect(0, "check", "scene.toml", *(f"-s{one}" for one in settings)).stdout
        return text.split("# expected cost\n")[1]

    def parts(self, scene, *settings):
        """The rows of the table by name: share in per cent, or None."""
        rows, share_end = {}, 0
        for line in self.cost(scene, *settings).splitlines():
            if line.startswith("    part or setting"):
                share_end = line.index("share") + len("share")
            elif line.startswith("    "):
                name = re.match(r" {4}(.*?)(?:  |$)", line)[1]
                share = re.search(r"([\d.]+) %$", line[:share_end].rstrip())
                rows[name] = float(share[1]) if share else None
        return rows

    def test_a_pair(self):
        rows = self.parts(PAIR)
        rest = ["solver, separations, contact"]  # not if disturbed timings of the others leave nothing
        self.assertEqual([name for name in rows if name not in rest],
                         ["walking straight", "strain (kappa)", "rods_run.rtol = 1e-06 instead of 1e-08",
                          "the end alone instead of 7 output times"])
        shares = [share for share in rows.values() if share is not None]
        self.assertAlmostEqual(sum(shares), 100.0, delta=2.0)  # each has two digits
        self.assertRegex(self.cost(PAIR), r"  rods: about \S+ [mu]?s: \d+ steps, \d+ right-hand sides of \S+ [mun]?s\n")

    def test_terms_come_with_their_keys(self):
        polar, images = "polar turning (gamma1, gamma2)", "images in the box (medium.periodic)"
        short = ("rods_run.t_end=1", "rods_run.output_interval=1")
        self.assertNotIn(polar, self.parts(PAIR, *short, "coupling.gamma1=0"))
        rows = self.parts(PAIR, *short, "coupling.gamma1=0.3", "medium.periodic=20", "rods_run.method=bdf")
        for term in ("strain (kappa)", polar, images):
            self.assertIn(term, rows)
        self.assertTrue(any(name.startswith("Jacobian (") for name in rows), rows)
        self.assertGreater(rows[images], rows["strain (kappa)"])  # a thousand times the plane's field, measured
        alone = self.parts(PAIR, *short, "coupling.kappa=0", "coupling.gamma2=1")
        self.assertIn(polar, alone)
        self.assertNotIn("strain (kappa)", alone)
        self.assertNotIn("strain (kappa)", self.parts(PAIR, *short, "coupling.kappa=0"))

    def test_settings_of_many_rods(self):
        rows = self.parts(rodwake.crowd(81), "rods_run.t_end=1", "rods_run.rtol=1e-3")
        for setting in ('rods_run.precision = "fine"', 'rods_run.precision = "single"'):
            self.assertIn(setting, rows)
        self.assertNotIn("rods_run.turning_tolerance = 0.0001", rows)  # of so few rods far wakes are never taken
        self.assertIn("rods_run.turning_tolerance = 0.0001", self.parts(rodwake.crowd(529), "rods_run.t_end=1", "rods_run.rtol=1e-3"))
        self.assertFalse(any("rtol" in name for name in rows))  # it is loose already
        rows = self.parts(rodwake.crowd(81), "rods_run.t_end=1", "rods_run.rtol=1e-3", "rods_run.precision=single")
        self.assertFalse(any("precision" in name for name in rows))

    def test_a_bed(self):
        step = ["flight, bounces off the plates", "search for contacts", "impulses between pairs"]
        rows = self.parts(BED)
        for part in (*step, "samples, rows of the table"):
            self.assertIn(part, rows)
        self.assertFalse(any("time_step" in part for part in rows))  # it is the longest that follows the bed
        self.assertIn("granular.time_step = 0.0001", self.parts(BED, "granular.time_step=2e-5"))
        self.assertNotIn("motion of the rods", rows)
        self.assertFalse(any("measure" in part for part in rows))
        rows = self.parts(BED + ROD + "[measure]\norder = true\ninterval = \"0.01 s\"\n")
        for part in (*step, "motion of the rods", "frames for the measures", "measure.order"):
            self.assertIn(part, rows)
        self.assertAlmostEqual(sum(share for share in rows.values() if share is not None), 100.0, delta=3.0)

    def test_quiet_says_nothing_of_a_valid_scene(self):
        self.write("scene.toml", PAIR)
        done = self.expect(0, "check", "scene.toml", "--quiet")
        self.assertEqual(done.stdout + done.stderr, "")
        self.refuse(2, r"eta", "check", "scene.toml", "--quiet", "-s", "medium.eta=-3")


if __name__ == "__main__":
    rodwake.main()
