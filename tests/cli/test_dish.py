"""A bed in a container, as the program runs it: files, resuming, figures, and what is refused."""

import json
import signal

import h5py
import numpy as np
import rodwake
from beds import BedTest, setting
from scipy.interpolate import RegularGridInterpolator

A = 0.4e-3
DISH = """
schema = 1
[granular]
phi_b = 0.7
start = "lattice"
duration = 0.1
equilibrate = 0.02
seed = 3
[granular.container]
kind = "circle"
radius = "14 a"
[granular.output]
frames = 0.02
table = 0.01
[[granular.rods]]
position = ["10 a", "14 a"]
heading = 0.0
[[figures]]
name = "dish"
kind = "snapshot"
[[figures]]
name = "tracks"
kind = "rod_tracks"
"""


class DishTest(BedTest):
    def setUp(self):
        super().setUp()
        self.write("dish.toml", DISH)

    def run_dish(self, out, *arguments):
        return self.expect(0, "dem", "dish.toml", "-o", out, *arguments)

    def test_files(self):
        self.run_dish("out")
        summary = self.summary("out")
        self.assertEqual((summary["container"], summary["box"]), ("circle", 28 * A))
        beads = summary["beads"]
        self.assertAlmostEqual(summary["beads_fraction"], beads / 14**2, delta=1e-12)
        self.assertGreater(summary["psi6"], 0.0)
        with h5py.File(self.out("out", "trajectory.h5md")) as file:
            box = file["particles/trajectory/box"]
            self.assertEqual([part.decode() if isinstance(part, bytes) else part for part in box.attrs["boundary"]], ["none"] * 3)
            self.assertEqual(box["edges/value"][0][0][0], 28 * A)
            places = file["particles/trajectory/position/value"][:, :beads, :2] - 14 * A
            self.assertEqual(np.count_nonzero(file["particles/trajectory/image/value"]), 0)
        furthest = np.linalg.norm(places, axis=-1).max() / A
        self.assertLess(furthest, 13.0 + 0.05)  # of the radius, by impulses of other beads
        self.assertGreater(furthest, 12.8)
        self.assertIn('pbc="F F F"', self.out("out", "trajectory.xyz").read_text())

    def test_resumed_to_the_bit(self):
        keys = setting(duration=1.0, output__checkpoint=0.02)
        self.run_dish("whole", *keys)
        for _ in range(2):
            if self.status_of("parts") != "finished":
                self.interrupt(signal.SIGTERM, 0.3, "dem", "dish.toml", "-o", "parts", *keys)
        if self.status_of("parts") != "finished":
            self.run_dish("parts", *keys)
        self.run_dish("threads", *keys, "-j", 3)
        for run in "parts", "threads":
            self.assert_same(run, "whole")

    def test_restart(self):
        self.run_dish("first")
        again = setting(start='"restart"', restart_from='"first/final.rwc"')
        self.run_dish("second", *again)
        self.assertEqual(self.summary("second")["beads"], self.summary("first")["beads"])
        done = self.expect(2, "dem", "dish.toml", "-o", "third", *again, *setting(container__radius='"15 a"'))
        self.assertRegex(done.stderr, "0.0112 x 0.0112 m there and 0.012 x 0.012 m in the scene")

    def test_reported_before_it_runs(self):
        for command in ("check",), ("dem", "--dry-run"):
            output = self.expect(0, command[0], "dish.toml", *command[1:]).stdout
            self.assertIn("vertical wall around the bed, a dish of radius 14 a = 5.6 mm, its middle at (14 a, 14 a); "
                          "friction/restitution: beads 0.2/0.3, rods 0.03/0.1", output)
            self.assertNotIn("side walls", output)
        output = self.expect(0, "check", "dish.toml", *setting(container__friction=0.5)).stdout
        self.assertIn("beads 0.5/0.3, rods 0.5/0.1", output)

    def test_measures(self):
        """Measured as it runs, from its frames, and from a camera's tracks of the whole dish: the same numbers."""
        keys = (*setting(duration=0.8, output__checkpoint=0.1), "-s", "measure.order=true", "-s", "measure.order_interval=0.02",
                "-s", "measure.microrheology=true", "-s", "measure.block=0.2")
        self.expect(0, "run", "dish.toml", "-o", "out", "--no-figures", *keys)
        found = json.loads(self.out("out", "measure.json").read_text())
        self.assertGreater(found["order"]["at_border"], 0.2)
        self.assertLess(found["order"]["at_border"], 0.6)
        frames = self.out("out", "trajectory.h5md")
        self.expect(0, "measure", "dish.toml", *keys, "-s", f'measure.trajectory="{frames}"', "-o", "again")
        self.assertEqual(json.loads(self.out("again", "measure.json").read_text())["order"]["psi6"], found["order"]["psi6"])
        self.assertIn("circle = ", self.expect_camera("out"))
        self.expect(0, "measure", "out/camera/camera.toml", "-s", "measure.order_interval=0.02", "-s", "measure.block=0.2", "-o", "film")
        film = json.loads(self.out("film", "measure.json").read_text())
        for name in "psi6", "local_psi6", "neighbours":
            self.assertAlmostEqual(film["order"][name]["value"], found["order"][name]["value"], delta=1e-12)  # pixels and back
        self.assertAlmostEqual(film["microrheology"]["stiffness"]["value"] / found["microrheology"]["stiffness"]["value"], 1.0, delta=1e-9)

    def test_wake(self):
        """Displacement and flow around a rod: of the bed, with a stop on the way, and of a film of it."""
        keys = (*setting(phi_b=0.8, container__radius='"30 a"', duration=1.0, output__frames=0.01, output__checkpoint=0.1), "-s", "measure.flow=true",
                "-s", 'measure.displacement="phase"', "-s", "measure.block=0.25", "-s", 'measure.far_from="14 a"', "-s", "granular.rods.0.position=['24 a','30 a']")
        self.expect(0, "run", "dish.toml", "-o", "out", "--no-figures", *keys)
        self.interrupt(signal.SIGTERM, 0.4, "run", "dish.toml", "-o", "parts", "--no-figures", *keys)
        if self.status_of("parts") != "finished":
            self.expect(0, "run", "dish.toml", "-o", "parts", "--no-figures", *keys)
        self.assertIn("circle = ", self.expect_camera("out"))
        self.expect(0, "measure", "out/camera/camera.toml", "-o", "film", *keys[-10:-2])
        for name in "displacement.vti", "flow.vti":
            self.assertEqual(self.out("parts", name).read_bytes(), self.out("out", name).read_bytes())
        # the film's box fits its window, so its bins are others: near the rod both see the same motion
        for names in ("displacement/Ux", "displacement/Uy", "flow/vx", "flow/vy"):
            self.assertGreater(self.likeness("out", "film", names), 0.8, names)  # 0.86 and above in beds of a second; others have none

    def likeness(self, one, other, name):
        """Correlation of two fields within 8 a of the rod, the second one interpolated."""
        (x, y, values), film = self.field(one, name), self.field(other, name)
        places = np.stack(np.meshgrid(y, x, indexing="ij"), axis=-1)
        near = np.linalg.norm(places, axis=-1) < 8.0
        return np.corrcoef(values[near], RegularGridInterpolator((film[1], film[0]), film[2])(places[near]))[0, 1]

    def field(self, run, name):
        group = name.split("/", maxsplit=1)[0]
        with h5py.File(self.out(run, "measure.h5")) as file:
            return [file[one][()] for one in (f"{group}/x", f"{group}/y", name)]

    def expect_camera(self, run):
        self.expect(0, "camera", run, "--pixel", "0.1 a")
        return self.out(run, "camera/camera.toml").read_text()

    def test_figures(self):
        self.run_dish("out")
        self.expect(0, "plot", "out")
        for name in "dish", "tracks":
            self.assertTrue(self.out("out", f"figures/{name}.png").is_file())

    def test_refused(self):
        for keys, words in ((setting(box='"30 a"'), r"granular.box.*leave one of them out"),
                            (["-s", 'granular.container={kind="circle"}'], 'kind = "circle" needs radius'),
                            (["-s", 'granular.container={kind="rectangle"}'], 'kind = "rectangle" needs sides'),
                            (["-s", 'granular.container={kind="rectangle",sides=["20 a","30 a"],radius=0.01}'], "belongs to kind = \"circle\""),
                            (setting(container__radius='"1 a"'), "at least 4 bead radii|no room"),
                            (setting(container__radius=-1), "radius"),
                            (["-s", 'granular.rods.0.position=["2 a","14 a"]'], "through the wall of the container"),
                            (["-s", "granular.rods.0.imposed_speed=0.5"], "shorten the duration"),
                            (["-s", "measure.mechanics=true"], "measure.mechanics.*periodic box.*this bed has a wall"),
                            (["-s", "measure.order_cutoff=0.01", "-s", "measure.order=true"], "order_cutoff.*a quarter of the box"),
                            (["-s", 'measure.displacement="density"'], r'displacement = "density" is measured in a periodic box'),
                            (["-s", 'granular.body_force={kind="gaussian",acceleration=1,width="1 a"}'], "gaussian")):
            with self.subTest(keys=keys):
                self.refuse(2, words, "check", "dish.toml", *keys)
        head, tail = DISH.split("[granular.container]")
        self.write("none.toml", head + "[granular.output]" + tail.split("[granular.output]")[1])
        self.refuse(2, "needs the key box", "check", "none.toml")


if __name__ == "__main__":
    rodwake.main()
