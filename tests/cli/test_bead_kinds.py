"""Beds of beads of several sizes and beds from a file, as the program runs them: files, resuming, replay, measures, and what is refused."""

import json
import signal

import h5py
import numpy as np
import rodwake
from beds import BedTest, setting

A = 0.4e-3
MIXED = """schema = 1
[granular]
phi_b = 0.7
box = "20 a"
start = "random"
equilibrate = 0.02
duration = 0.2
plates = { gap = "1.55 mm" }
[[granular.bead_kinds]]
radius = "0.4 mm"
share = 0.5
[[granular.bead_kinds]]
radius = "0.56 mm"
share = 0.5
[granular.output]
frames = 0.02
table = 0.01
[[granular.rods]]
position = ["10 a", "10 a"]
"""


class BeadKindsTest(BedTest):
    def setUp(self):
        super().setUp()
        self.write("mixed.toml", MIXED)

    def mixed(self, out, *arguments, code=0):
        return self.expect(code, "dem", "mixed.toml", "-o", out, *arguments)

    def test_files(self):
        self.mixed("out")
        summary = self.summary("out")
        kinds, beads = summary["kinds"], summary["beads"]
        small, large = (kind["radius"] for kind in kinds)
        np.testing.assert_allclose((small, large), (A, 1.4 * A), rtol=1e-15)
        self.assertEqual(sum(kind["beads"] for kind in kinds), beads)
        self.assertLessEqual(abs(kinds[0]["beads"] - kinds[1]["beads"]), 1)
        share = sum(kind["beads"] * np.pi * (kind["radius"] / (20 * A))**2 for kind in kinds)
        self.assertAlmostEqual(summary["beads_fraction"], share, delta=1e-12)
        mean = sum(kind["beads"] * kind["T_xy"] for kind in kinds) / beads
        self.assertAlmostEqual(summary["T_xy"] / mean, 1.0, delta=1e-12)
        self.assertGreater(kinds[0]["T_xy"], kinds[1]["T_xy"])
        with h5py.File(self.out("out", "trajectory.h5md")) as file:
            radius, mass = (file[f"particles/trajectory/{name}"][:beads] for name in ("radius", "mass"))
        self.assertEqual(sorted(set(radius.tolist())), [small, large])
        self.assertEqual(np.count_nonzero(radius == small), kinds[0]["beads"])
        np.testing.assert_allclose(mass, 2700.0 * 4.0 / 3.0 * np.pi * radius**3, rtol=1e-14)
        lines = self.out("out", "trajectory.xyz").read_text().splitlines()[2:2 + beads]
        np.testing.assert_allclose([float(line.split()[9]) for line in lines], radius / A, rtol=1e-14)

    def test_resumed_and_replayed_to_the_bit(self):
        keys = setting(duration=1.0, output__checkpoint=0.02, output__archive=0.1)
        self.mixed("whole", *keys)
        for _ in range(2):
            if self.status_of("parts") != "finished":
                self.interrupt(signal.SIGTERM, 0.3, "dem", "mixed.toml", "-o", "parts", *keys)
        if self.status_of("parts") != "finished":
            self.mixed("parts", *keys)
        self.assert_same("parts", "whole")
        self.assertEqual(self.summary("parts")["kinds"], self.summary("whole")["kinds"])
        self.assertEqual(self.out("parts", "archive.rwc").read_bytes(), self.out("whole", "archive.rwc").read_bytes())
        self.assertIn("all to the bit", self.expect(0, "replay", "whole", "--verify").stdout)

    def test_equal_kinds_are_one(self):
        one = setting(phi_b=0.6, start='"lattice"')
        self.mixed("two", *one, "-s", 'granular.bead_kinds.1.radius="0.4 mm"')
        self.write("one.toml", MIXED.replace('[[granular.bead_kinds]]\nradius = "0.4 mm"\nshare = 0.5\n', "")
                   .replace('[[granular.bead_kinds]]\nradius = "0.56 mm"\nshare = 0.5\n', ""))
        self.expect(0, "dem", "one.toml", "-o", "one", *one)
        self.assertEqual(self.hash("two"), self.hash("one"))
        self.assertNotIn("kinds", self.summary("one"))

    def test_ensemble_and_restart(self):
        self.mixed("out", *setting(runs=2, bead_spread=0.03))
        summary = self.summary("out")
        self.assertEqual([kind["absorbing_runs"] for kind in summary["kinds"]], [0, 0])
        self.assertAlmostEqual(summary["beads_fraction"], 0.7 - self.shadow(), delta=1e-8)  # of the points
        self.assertIn("T_xy_kind1", self.out("out", "runs.csv").read_text().splitlines()[0])
        again = setting(start='"restart"', restart_from='"out/runs/0001/final.rwc"')
        self.mixed("next", *again, *setting(bead_spread=0.03))
        stored, followed = (h5py.File(self.out(run, "trajectory.h5md"))["particles/trajectory/radius"][()] for run in ("out/runs/0001", "next"))
        np.testing.assert_array_equal(followed, stored)
        # beads of a denser bed that a rod's place takes out: the fraction is that of the beads that are left
        self.mixed("fewer", *again, *setting(bead_spread=0.03, phi_b=0.6))
        with h5py.File(self.out("fewer", "trajectory.h5md")) as file:
            beads = file["particles/trajectory"]
            radius = beads["radius"][:self.summary("fewer")["beads"]]
            self.assertAlmostEqual(file["parameters"].attrs["beads_fraction"], np.pi * (radius**2).sum() / (20 * A)**2, delta=1e-12)
        self.assertAlmostEqual(self.summary("fewer")["beads_fraction"], np.pi * (radius**2).sum() / (20 * A)**2, delta=1e-12)
        self.assertGreater(abs(self.summary("fewer")["beads_fraction"] - (0.6 - self.shadow())), 1e-5)
        self.assertRegex(self.mixed("third", *again, code=2).stderr, "radii of the beads are .* with a spread of 0.03 there and")

    def shadow(self):
        """Share of the box that the rod covers: its spheres in plan view, by counting points."""
        radius, x = np.linspace(0.55e-3, 0.4e-3, 12), np.linspace(0.0, 4.5e-3 - 0.95e-3, 12)
        at = np.linspace(-0.6e-3, 4.2e-3, 200_001)
        height = np.sqrt(np.maximum(radius**2 - (at[:, None] - x)**2, 0.0)).max(axis=1)
        return 2.0 * height.sum() * (at[1] - at[0]) / (20 * A)**2

    def test_measured_from_its_frames(self):
        keys = ("-s", "measure.order=true", "-s", 'measure.order_neighbours="delaunay"', "-s", "measure.order_interval=0.02", "-s", "measure.block=0.1")
        self.expect(0, "run", "mixed.toml", "-o", "out", "--no-figures", *keys)
        found = json.loads(self.out("out", "measure.json").read_text())["order"]
        frames = self.out("out", "trajectory.h5md")
        self.expect(0, "measure", "mixed.toml", *keys, "-s", f'measure.trajectory="{frames}"', "-o", "again")
        self.assertEqual(json.loads(self.out("again", "measure.json").read_text())["order"]["psi6"], found["psi6"])
        others = ("-s", 'granular.bead_kinds.1.radius="0.57 mm"'), ("-s", "granular.bead_kinds.0.share=0.6", "-s", "granular.bead_kinds.1.share=0.4")
        beads = int(self.summary("out")["beads"])
        for other, message in zip(others, ("radius of 0.00056.* and its kind 0.00057", "beads of the kinds .* number .* there and")):
            more = ("-s", f"granular.beads={beads}", "-s", "granular.phi_b= ", "-s", f'measure.trajectory="{frames}"')
            self.assertRegex(self.expect(2, "measure", "mixed.toml", *keys, *other, *more, "-o", "other").stderr, message)

    def test_displacement_without_a_lattice(self):
        keys = ("-s", 'granular.rods.0.thick_diameter="1.4 mm"', "-s", 'measure.displacement="lagrangian"', "-s", "measure.interval=0.02", "-s", "measure.block=0.25")
        self.expect(0, "run", "mixed.toml", "-o", "out", "--no-figures", *setting(duration=2.0), *keys)
        found = json.loads(self.out("out", "measure.json").read_text())["displacement"]
        self.assertEqual((found["method"], found["row_angle"], found["lattice_spacing"]), ("lagrangian", None, None))
        with h5py.File(self.out("out", "measure.h5")) as file:
            seen = file["displacement/count"][()] > 0
            u, sigma = (file[f"displacement/{name}"][()][seen] for name in ("Ux", "sigma_x"))
        self.assertGreater(np.count_nonzero(seen), 200)  # of 400 bins
        self.assertTrue(np.isfinite(u).all() and (sigma > 0).all())

    def test_refused(self):
        for keys, message in ((setting(start='"lattice"'), "granular.start.*use start = .random"),
                              (setting(plates__gap='"1.1 mm"'), "must be larger than the largest bead diameter"),
                              (setting(bead_kinds__1__radius=0), "granular.bead_kinds.*radius"),
                              (("-s", "measure.phonons=true"), "waves of a lattice")):
            with self.subTest(message):
                self.assertRegex(self.mixed("refused", *keys, code=2).stderr, message)
                self.assertFalse((self.folder / "refused").exists())

    def test_reported_before_it_runs(self):
        output = self.expect(0, "check", "mixed.toml").stdout
        self.assertIn("plates: gap 1.55 mm", output)
        self.assertIn("plates: gap 1.512 mm", self.expect(0, "check", "mixed.toml", "-s", "granular.plates=").stdout)
        self.assertRegex(output, r"beads of radius 0.4 mm \(\d+\) and 0.56 mm \(\d+\) and 2700 kg")


class MeasuredKindsTest(BedTest):
    """g(r) and stiffness by kind of a bed, from its film, and of the film as tracks with radii."""
    KEYS = tuple(word for key in ("measure.order=true", 'measure.order_neighbours="delaunay"', "measure.microrheology=true", "measure.order_interval=0.02", "measure.block=0.2",
                                  "granular.duration=0.72", "granular.rods=[]") for word in ("-s", key))
    TRACKS = """schema = 1
[tracks]
file = "{}"
pixel = "1 m"
{}
[[tracks.bead_kinds]]
radius = "0.4 mm"
[[tracks.bead_kinds]]
radius = "0.56 mm"
[measure]
order = true
order_interval = 0.02
microrheology = true
block = 0.2
"""

    def table(self, run, name):
        return np.genfromtxt(self.out(run, name), delimiter=",", names=True, comments="#")

    def test_bed_and_tracks(self):
        self.write("mixed.toml", MIXED)
        self.expect(0, "run", "mixed.toml", "-o", "out", "--no-figures", *self.KEYS)
        g, stiffness = self.table("out", "gr_kinds.csv"), self.table("out", "stiffness_kinds.csv")
        self.assertEqual(sorted(set(zip(g["kind"], g["other"]))), [(0, 0), (0, 1), (1, 1)])
        for k, touching in (((0, 0), 2.0), ((0, 1), 2.4), ((1, 1), 2.8)):
            mine = g[(g["kind"] == k[0]) & (g["other"] == k[1])]
            self.assertAlmostEqual(mine["r"][mine["g"] > 0.2].min(), touching, delta=0.4)  # spheres at other heights pass closer
        self.assertTrue((stiffness["stiffness"] > 0).all())
        np.testing.assert_allclose(stiffness["radius"], [1.0, 1.4])
        # from its film: the same bits
        frames = self.out("out", "trajectory.h5md")
        self.expect(0, "measure", "mixed.toml", *self.KEYS, "-s", f'measure.trajectory="{frames}"', "-o", "again")
        for name in ("gr_kinds.csv", "msd_kinds.csv", "stiffness_kinds.csv"):
            self.assertEqual(self.out("again", name).read_bytes(), self.out("out", name).read_bytes())
        # the film as tracks, of its own radii; the same places as CSV, with a column of radii, or of kinds that have names
        with h5py.File(frames) as file:
            beads = file["particles/trajectory"]
            places, times, radius = beads["position/value"][()], beads["position/time"][()], beads["radius"][()]
        rows = [f"{t:.17g},{i},{x:.17g},{y:.17g},{radius[i]:.17g},{'large' if radius[i] > 0.5e-3 else 'small'}"
                for t, frame in zip(times, places) for i, (x, y, _) in enumerate(frame)]
        self.write("t.csv", "\n".join(["t,particle,x,y,r,kind", *rows]))
        periodic = 'time_column = "t"\nwindow = "periodic"\nbox = "20 a"\n'
        named = self.TRACKS.format("t.csv", periodic).replace('"0.4 mm"', '"0.4 mm"\nnames = ["small"]').replace('"0.56 mm"', '"0.56 mm"\nnames = ["large"]')
        for name, scene in (("film", self.TRACKS.format(frames, "")), ("named", named),
                            ("radii", self.TRACKS.format("t.csv", periodic + 'rod_kinds = ["rod"]\ncolumns = { radius = "r" }\n'))):
            self.write(f"{name}.toml", scene)
            self.expect(0, "run", f"{name}.toml", "-o", name, "--no-figures")
            np.testing.assert_allclose(self.table(name, "gr_kinds.csv")["g"], g["g"], rtol=1e-9, err_msg=name)
            np.testing.assert_allclose(self.table(name, "stiffness_kinds.csv")["stiffness"], stiffness["stiffness"], rtol=1e-6, err_msg=name)
            np.testing.assert_allclose(np.sort(self.table(name, "film_frame.csv")["radius"]), np.sort(radius), rtol=1e-9, err_msg=name)
            self.assertAlmostEqual(json.loads(self.out(name, "tracks.json").read_text())["phi_b"], self.summary("out")["beads_fraction"], delta=1e-9)
        for scene, message in ((named.replace("small", "smal"), 't.csv:.*: kind = "small": expected one of the names in tracks.bead_kinds'),
                               (self.TRACKS.format("t.csv", periodic), "tracks.bead_kinds need a column of radii"),
                               (self.TRACKS.format(frames, 'columns = { radius = "r" }'), "tracks.columns.radius is for CSV"),
                               (named.replace("0.56", "0.4"), "kinds differ in radius")):
            self.write("refused.toml", scene)
            self.assertRegex(self.expect(2, "run", "refused.toml", "-o", "refused", "--no-figures").stderr, message)


class StartFileTest(BedTest):
    SCENE = """schema = 1
[granular]
box = "20 a"
start = "file"
start_file = "beads.csv"
duration = 0.02
gravity = 0.0
plates = { gap = "1.2 mm", gamma = 0.0 }
contacts = { particle_particle = { friction = 0.0, restitution = 1.0 } }
[granular.output]
frames = 0.01
"""

    def setUp(self):
        super().setUp()
        self.write("given.toml", self.SCENE)
        x, y = np.meshgrid(np.arange(5) * 4 * A + 2 * A, np.arange(5) * 4 * A + 2 * A)
        self.x, self.y = x.ravel(), y.ravel()
        speed = np.random.default_rng(1).normal(0.0, 0.05, (2, 25))
        self.table = {"x": self.x, "y": self.y, "z": np.full(25, 0.6e-3), "vx": speed[0], "vy": speed[1], "vz": np.zeros(25)}

    def put(self, **changed):
        table = {name: column for name, column in (self.table | changed).items() if column is not None}
        rows = [",".join(f"{column[i]:.17g}" for column in table.values()) for i in range(25)]
        self.write("beads.csv", "\n".join([",".join(table), *rows]) + "\n")

    def positions(self, run):
        with h5py.File(self.out(run, "trajectory.h5md")) as file:
            return file["particles/trajectory/position/value"][()], file["particles/trajectory/velocity/value"][()]

    def test_beads_start_where_the_file_says(self):
        self.put()
        self.expect(0, "dem", "given.toml", "-o", "out")
        position, velocity = self.positions("out")
        np.testing.assert_array_equal(position[0], np.stack([self.x, self.y, self.table["z"]], axis=1))
        np.testing.assert_array_equal(velocity[0], np.stack([self.table["vx"], self.table["vy"], np.zeros(25)], axis=1))
        self.assertTrue((position[..., 2] == 0.6e-3).all())  # spheres in one plane stay there to the bit
        self.assertEqual(self.summary("out")["beads"], 25)
        self.assertIn("1 stretches", self.expect(0, "replay", "out", "--verify").stdout)
        self.assertIn("start from the beads in beads.csv", self.expect(0, "check", "given.toml").stdout)

    def test_another_file_of_the_same_name_is_another_bed(self):
        self.put()
        self.expect(0, "dem", "given.toml", "-o", "out")
        self.put(vx=-self.table["vx"])
        output = self.expect(2, "dem", "given.toml", "-o", "out", "-s", "granular.runs=2")
        self.assertRegex(output.stderr, "another scene")
        self.assertRegex(self.expect(2, "replay", "out", "--verify").stderr, "not the file that the run began from")

    def test_a_frame_of_a_film(self):
        """Its beads to the bit between plates at rest, near mid gap between others."""
        self.put()
        kinds = ("-s", 'granular.bead_kinds=[{ radius = "0.4 mm" }, { radius = "0.5 mm" }]')
        self.put(kind=np.arange(25) % 2)
        self.expect(0, "dem", "given.toml", "-o", "out", *kinds)
        film = ("-s", 'granular.start_file="out/trajectory.h5md"', *kinds)
        position, velocity = self.positions("out")
        for frame, key in ((2, ()), (1, ("-s", "granular.start_frame=1"))):
            self.expect(0, "dem", "given.toml", "-o", f"from_{frame}", *film, *key)
            for stored, followed in zip((position, velocity), self.positions(f"from_{frame}")):
                np.testing.assert_array_equal(followed[0], stored[frame])
            self.assertEqual([kind["beads"] for kind in self.summary(f"from_{frame}")["kinds"]], [13, 12])
        self.assertIn("all to the bit", self.expect(0, "replay", "from_1", "--verify").stdout)
        self.expect(0, "dem", "given.toml", "-o", "shaken", *film, "-s", "granular.plates.gamma=7", "-s", "granular.gravity=9.81")
        self.assertGreater(np.ptp(self.positions("shaken")[0][0, :, 2]), 0.0)
        for keys, message in (((*film, "-s", "granular.start_frame=3"), r"start_frame = 3: .*out/trajectory.h5md has frames 0 to 2"),
                              ((*film, "-s", 'granular.box="21 a"'), "its box is 0.008 x 0.008 m, and the box of the scene 0.0084 x 0.0084 m"),
                              (("-s", "granular.start_frame=0", *kinds), "beads.csv is a table, which has no frames"),
                              ((*film[:2], "-s", "granular.bead_radius=0.00041", "-s", 'granular.box="8 mm"'), "has a radius of 0.0004 m, and its kind 0.00041 m")):
            with self.subTest(message):
                self.assertRegex(self.expect(2, "check", "given.toml", *keys).stderr, message)

    def test_missing_columns_are_drawn(self):
        self.put(z=None, vx=None, vz=None)
        self.expect(0, "dem", "given.toml", "-o", "out")
        position, velocity = self.positions("out")
        np.testing.assert_array_equal(position[0, :, :2], np.stack([self.x, self.y], axis=1))  # nothing overlaps
        self.assertLess(np.abs(position[0, :, 2] - 0.6e-3).max(), 0.01 * 0.2e-3)
        np.testing.assert_array_equal(velocity[0, :, 1], self.table["vy"])
        self.assertAlmostEqual(np.std(velocity[0, :, 0]), 0.02, delta=0.01)

    def test_radii_and_kinds(self):
        kinds = ("-s", 'granular.bead_kinds=[{ radius = "0.4 mm" }, { radius = "0.5 mm" }]')
        kind = np.arange(25) % 2
        self.put(kind=kind)
        self.expect(0, "dem", "given.toml", "-o", "out", *kinds)
        with h5py.File(self.out("out", "trajectory.h5md")) as file:
            np.testing.assert_array_equal(file["particles/trajectory/radius"][()], np.where(kind == 1, 0.5e-3, A))
        self.put(radius=np.where(kind == 1, 0.5e-3, A))
        self.expect(0, "dem", "given.toml", "-o", "same", *kinds)
        self.assertEqual(self.hash("same"), self.hash("out"))
        self.assertEqual([kind["beads"] for kind in self.summary("same")["kinds"]], [13, 12])

    def test_refused(self):
        near = self.x.copy()
        near[1] = near[0] + 1.5 * A
        wrong = self.table["vx"].copy()
        wrong[3] = np.nan
        for changed, message in (({"x": near}, "bead 0 .* is 0.5 radii deep in bead 1: must be at most overlap_limit = 0.1"),
                                 ({"z": np.full(25, 0.9e-3)}, "deep in the lid"),
                                 ({"kind": np.ones(25)}, r"beads.csv:2: kind = 1: must be a whole number from 0 to 0"),
                                 ({"radius": np.full(25, 0.5e-3)}, "has a radius of 0.0005 m, and its kind 0.0004 m"),
                                 ({"x": 1e3 * self.x}, "outside the box and its next images: columns are in m"),
                                 ({"vx": wrong}, r"beads.csv:5: "), ({"x": None}, "beads.csv.*x"),
                                 ({"radios": np.full(25, A)}, r'unknown column "radios" \(did you mean "radius"\?\)')):
            with self.subTest(message):
                self.put(**changed)
                for verb in (("dem", "given.toml", "-o", "refused"), ("check", "given.toml")):
                    self.assertRegex(self.expect(2, *verb).stderr, message)
        (self.folder / "beads.csv").unlink()
        self.assertRegex(self.expect(2, "check", "given.toml").stderr, 'granular.start_file = "beads.csv": there is no such file')


if __name__ == "__main__":
    rodwake.main()
