"""Order of the motile rods of a bed against a computation of its own from the stored frames."""

import csv
import json

import h5py
import numpy as np
from rodwake import ProgramTest

BED = """schema = 1
[granular]
phi_b = 0.3
box = "48 a"
start = "random"
equilibrate = "0.02 s"
duration = "0.3 s"
runs = 2
[granular.output]
frames = "0.02 s"
last_period = false
[[granular.rods]]
position = ["24 a", "4 a"]
[[granular.rods]]
position = ["24 a", "44 a"]      # 8 a from the first through the side of the box
heading = "180 deg"
[[granular.rods]]
kind = "apolar"
position = ["24 a", "14 a"]
[[granular.rods]]
position = ["24 a", "30 a"]
heading = "60 deg"
[rods_order]
link = "10 a"
from = "0.1 s"
block = "0.1 s"
"""
A, BOX, MOTILE = 0.4e-3, 48 * 0.4e-3, [0, 1, 3]
FILES = "rods_order.csv", "clusters.csv", "rods_order.json"


class Frames:
    """Places and headings of the motile rods as HDF5 has them."""

    def __init__(self, file):
        with h5py.File(file) as opened:
            rods = opened["particles/trajectory_rods"]
            self.t = rods["position/time"][...]
            self.place = rods["position/value"][:, MOTILE, :2]
            w, x, y, z = np.moveaxis(rods["orientation/value"][:, MOTILE], 2, 0)
            self.axis = (w * w + x * x - y * y - z * z) + 2j * (x * y + w * z)  # first column of the rotation

    def order(self, k):
        return np.abs(np.mean((self.axis / np.abs(self.axis)) ** k, axis=1))

    def largest(self, link):
        """Of three rods: by the number of links."""
        apart = self.place[:, [0, 0, 1]] - self.place[:, [1, 2, 2]]
        near = np.hypot(*np.moveaxis(apart - BOX * np.round(apart / BOX), 2, 0)) < link
        return np.minimum(near.sum(axis=1) + 1, 3)


class BedOrderTest(ProgramTest):
    def setUp(self):
        super().setUp()
        self.write("bed.toml", BED)

    def made(self, *options):
        self.expect(0, "dem", "bed.toml", "-o", "run", "--quiet", *options)
        self.expect(0, "measure", "bed.toml", "-o", "run", "--quiet", *options)
        run = self.folder / "run"
        with open(run / "rods_order.csv") as lines:
            rows = list(csv.DictReader(lines))
        return {name: np.array([float(row[name]) for row in rows]) for name in rows[0]}, json.loads((run / "rods_order.json").read_text())

    def test_means_over_the_runs(self):
        series, means = self.made()
        runs = [Frames(self.folder / f"run/runs/000{k}/trajectory.h5md") for k in (1, 2)]
        late = runs[0].t >= 0.1
        self.assertEqual((means["runs"], means["instants"], means["units"]["length"], means["link"]), (2, 2 * late.sum(), "m", 10 * A))
        np.testing.assert_array_equal(series["t"], runs[0].t)
        for name, values in {"polar": [run.order(1) for run in runs], "nematic": [run.order(2) for run in runs],
                             "largest": [run.largest(10 * A) for run in runs]}.items():
            np.testing.assert_allclose(series[name], np.mean(values, axis=0), rtol=1e-12)  # rounding
            self.assertAlmostEqual(means[name]["value"], np.mean([run[late] for run in values]), delta=1e-12)
        self.assertGreater(series["largest"][0], 1)  # the two linked through the side

    def test_another_link_without_the_bed(self):
        self.made()
        frames = self.folder / "run/runs/0001/trajectory.h5md"
        before, old = frames.stat().st_mtime_ns, (self.folder / "run/clusters.csv").read_text()
        self.expect(0, "measure", "bed.toml", "-o", "run", "--quiet", "--force", "-s", "rods_order.link=1 a")
        self.assertNotEqual((self.folder / "run/clusters.csv").read_text(), old)
        self.assertEqual((self.folder / "run/clusters.csv").read_text(), "size,clusters,share\n1,3,1\n")
        self.assertEqual(frames.stat().st_mtime_ns, before)
        manifest = json.loads((self.folder / "run/manifest.json").read_text())["files"]
        self.assertEqual(manifest["rods_order.csv"]["columns"][0]["unit"], "s")

    def test_run_does_both_and_draws(self):
        self.write("drawn.toml", BED + '[[figures]]\nname = "order"\nkind = "rods_order"\n')
        self.expect(0, "run", "drawn.toml", "-o", "drawn", "--quiet", "-s", "granular.runs=1", "-s", "granular.duration=0.2 s")
        self.assertTrue((self.folder / "drawn/figures/order.png").exists())

    def test_scenes_that_cannot_be(self):
        for change, words in (("granular.rods.0.kind=apolar", "at least 2"), ("granular.output.formats=[]", "must have"),
                              ("rods_order.from=1 s", "nothing would count"), ("rods_order.link=30 a", "half the periodic box")):
            more = ("-s", "granular.rods.1.kind=apolar") if "kind" in change else ()
            self.assertIn(words, self.expect(2, "check", "bed.toml", "-s", change, *more).stderr)


if __name__ == "__main__":
    import rodwake
    rodwake.main()
