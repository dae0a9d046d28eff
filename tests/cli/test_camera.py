"""rodwake camera: a bed's frames as tracks, which measured again are the bed."""

import collections
import csv
import json
import math
import statistics
import subprocess

import rodwake
from rodwake import SOURCE, ProgramTest

BED = """schema = 1
[granular]
phi_b = 0.80
box = "30 a"
equilibrate = "0.05 s"
duration = "1 s"
[granular.output]
frames = "0.025 s"
last_period = false
[[granular.rods]]
position = ["10 a", "15 a"]
[measure]
order = true
order_interval = 0.025
microrheology = true
block = 0.25
"""


class CameraTest(ProgramTest):
    def setUp(self):
        super().setUp()
        self.write("bed.toml", BED)
        self.made_once("bed", "dem", "bed.toml", "--quiet")

    def measured(self, folder):
        return json.loads((self.folder / folder / "measure.json").read_text())

    def spots(self, name):
        """(kind, frame): (x, y, theta) of each."""
        found = collections.defaultdict(list)
        for row in csv.DictReader((self.folder / name).read_text().splitlines()):
            found[row["kind"], int(row["frame"])].append((float(row["x"]), float(row["y"]), float(row["theta"] or "nan")))
        return found

    def test_a_whole_bed_is_itself(self):
        self.expect(0, "measure", "bed.toml", "-o", "bed", "--quiet")
        output = self.expect(0, "camera", "bed", "--pixel", "1 a").stdout
        self.assertIn("camera/tracks.csv: 41 pictures", output)
        self.expect(0, "measure", "bed/camera/camera.toml", "-o", "film", "--quiet")
        bed, film = self.measured("bed"), self.measured("film")
        self.assertAlmostEqual(bed["order"]["psi6"]["value"], film["order"]["psi6"]["value"], delta=1e-13)  # pixels and back: rounding
        tracks = json.loads((self.folder / "film/tracks.json").read_text())
        self.assertEqual((tracks["frames"], tracks["rods"]), (41, 1))

    def test_faults(self):
        self.expect(0, "camera", "bed", "-o", "eye", "--view", "0.6", "--turned", "17", "--lost", "0.1", "--noise", "0.05 a", "--every", "2", "--quiet")
        rows = (self.folder / "eye/tracks.csv").read_text().splitlines()
        self.assertEqual(rows[0], "frame,particle,x,y,theta,kind")
        self.assertEqual(rows[-1].split(",")[0], "20")
        scene = (self.folder / "eye/camera.toml").read_text()
        self.assertIn("rectangle = [0, 0, ", scene)
        self.assertIn("--turned 17", scene)
        self.expect(0, "measure", "eye/camera.toml", "-o", "film", "--quiet")
        self.assertGreater(json.loads((self.folder / "film/tracks.json").read_text())["lost_share"], 0.02)

    def test_images_are_found_again(self):
        self.expect(0, "camera", "bed", "-o", "eye", "--view", "0.7", "--turned", "17", "--every", "8", "--images", "3", "--quiet")
        self.assertEqual(sorted(path.name for path in (self.folder / "eye/images").iterdir()), ["000000.png", "000001.png", "000002.png"])
        subprocess.run(["/usr/bin/python3", SOURCE / "examples/film/find_spots.py", "eye"], cwd=self.folder, check=True, capture_output=True)
        truth, found = self.spots("eye/tracks.csv"), self.spots("eye/found.csv")
        for frame in range(3):
            far = [min(math.dist(spot[:2], bead[:2]) for bead in truth["bead", frame]) for spot in found["bead", frame]]
            self.assertGreater(len(far), 0.75 * len(truth["bead", frame]))  # less those cut by the edge
            self.assertLess(statistics.median(far), 0.2)                    # of 20 pixels of radius
            (rod,), (seen,) = truth["rod", frame], found["rod", frame]
            self.assertLess(math.dist(rod[:2], seen[:2]), 12)               # the middle of its area is not its centre of mass
            self.assertLess(abs(math.remainder(rod[2] - seen[2], math.tau)), 0.05)
        # fewer pictures: what an earlier film left goes
        self.expect(0, "camera", "bed", "-o", "eye", "--every", "8", "--images", "1", "--pixel", "0.2 a", "--force", "--quiet")
        self.assertEqual([path.name for path in (self.folder / "eye/images").iterdir()], ["000000.png"])

    def test_what_cannot_be(self):
        self.refuse(2, "nowhere: not a run directory", "camera", "nowhere")
        self.refuse(2, r'--pixel 3 parsec: is not a length such as "0.05 a"', "camera", "bed", "--pixel", "3 parsec")
        self.refuse(2, "view = 1: so turned and distorted .* take 0.7", "camera", "bed", "--turned", "45")
        self.refuse(2, "41 frames are fewer than two pictures", "camera", "bed", "--every", "41")
        self.expect(0, "camera", "bed", "--quiet")
        self.refuse(2, "tracks.csv: already exists; --force replaces it", "camera", "bed")
        self.expect(0, "camera", "bed", "--quiet", "--force", "--seed", "2")
        (self.folder / "bed/trajectory.h5md").unlink()
        self.refuse(2, "bed: holds no frames", "camera", "bed", "-o", "other")


if __name__ == "__main__":
    rodwake.main()
