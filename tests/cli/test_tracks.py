"""[tracks]: a bed written as tracks and read back has the bed's own numbers; a peer's numbers in an open window; what is odd in a
file is told."""

import json

import h5py
import numpy as np
from beds import columns
from rodwake import SOURCE, ProgramTest
from scipy.spatial import cKDTree

A = 0.4e-3
MEASURE = """[measure]
order = true
order_interval = "0.05 s"
microrheology = true
block = "0.1 s"
"""
BED = """schema = 1
[granular]
phi_b = 0.72
box = "24 a"
equilibrate = 0.0
duration = "0.4 s"
[granular.output]
frames = "0.01 s"
formats = ["h5md"]
last_period = false
""" + MEASURE


def tracks(keys, measure=MEASURE):
    return f'schema = 1\n[tracks]\nfile = "tracks.csv"\n{keys}\n{measure}'


PERIODIC = tracks('time_column = "t"\npixel = "1 m"\nwindow = "periodic"\nbox = "24 a"')
OPEN = tracks('frames_per_second = 100\npixel = "1 a"\nwindow = "hull"', """[measure]
order = true
order_interval = "0.5 s"
order_cutoff = "3 a"
block = "0.5 s"
""")


def share_inside(points, sides, r):
    """Of the circle of radius r about each point, the part inside [0, sides], by its arcs beyond each side and corner."""
    distances = np.stack([points[:, 0], points[:, 1], sides[0] - points[:, 0], sides[1] - points[:, 1]], axis=1)
    half = np.arccos(np.minimum(1, distances / r))
    twice = sum(np.maximum(0, half[:, k] + half[:, (k + 1) % 4] - np.pi / 2) for k in range(4))
    return 1 - (2 * half.sum(axis=1) - twice) / (2 * np.pi)


class Tracks(ProgramTest):
    def write_rows(self, header, rows):
        self.write("tracks.csv", "\n".join([header, *(",".join(map(repr, row)) for row in rows)]) + "\n")

    def results(self, folder):
        return json.loads((self.folder / folder / "measure.json").read_text())

    def test_the_frame_with_most_beads_has_the_measured_order(self):
        """Two frames alike: what is measured over both is the mean of the beads of the frame."""
        random = np.random.default_rng(2)
        place = np.array([(1 + 2.2 * i + 1.1 * (j % 2), 1 + 1.9 * j) for j in range(12) for i in range(10)]) + random.normal(scale=0.2, size=(120, 2))
        self.write_rows("frame,particle,x,y", [(f, p, float(x), float(y)) for f in range(2) for p, (x, y) in enumerate(place % 24)])
        for name, keys in (("periodic", 'window = "periodic"\nbox = "24 a"'), ("open", 'window = "hull"')):
            self.write("scene.toml", tracks(f'frames_per_second = 10\npixel = "1 a"\n{keys}', "[measure]\norder = true\norder_cutoff = \"3 a\"\nblock = \"0.1 s\"\n"))
            self.expect(0, "run", "scene.toml", "-o", name, "--quiet")
            found = np.genfromtxt(self.folder / name / "film_frame.csv", delimiter=",", names=True)
            self.assertEqual(found["x"].size, 120)
            self.assertEqual(bool(np.isnan(found["psi6"]).any()), name == "open")
            self.assertAlmostEqual(np.nanmean(found["psi6"]), self.results(name)["order"]["local_psi6"]["value"], places=12)
            self.assertTrue((self.folder / name / "figures/snapshot.png").is_file())

    def test_a_bed_read_back_has_its_own_numbers_to_the_last_digit(self):
        self.write("bed.toml", BED)
        self.expect(0, "dem", "bed.toml", "-o", "bed")
        self.expect(0, "measure", "bed.toml", "-o", "bed")
        with h5py.File(self.folder / "bed" / "trajectory.h5md") as file:
            particles = file["particles/trajectory"]
            time, place = particles["position/time"][...], particles["position/value"][...]
            self.assertFalse(np.any(particles["image/value"][0]))  # else places differ by whole boxes, and digits by rounding
            self.assertTrue(np.any(particles["image/value"][...]))
        rows = [(float(t), bead, float(x), float(y)) for t, frame in zip(time, place) for bead, (x, y, _) in enumerate(frame)]
        rows = [rows[k] for k in np.random.default_rng(1).permutation(len(rows))]
        self.write_rows("t,particle,x,y", rows)
        self.write("tracks.toml", PERIODIC)
        done = self.expect(0, "run", "tracks.toml", "-o", "seen")
        self.assertIn("tracks: 41 frames, 132 particles, 41.0 frames long on average, 0 % lost", done.stdout + done.stderr)
        for name in ("gr.csv", "gB.csv", "msd.csv", "stiffness.csv"):
            self.assertEqual((self.folder / "bed" / name).read_bytes(), (self.folder / "seen" / name).read_bytes(), name)
        bed, seen = self.results("bed"), self.results("seen")
        self.assertEqual(bed["order"], seen["order"])
        self.assertEqual(bed["microrheology"]["stiffness"], seen["microrheology"]["stiffness"])
        self.assertIsNone(seen["microrheology"]["spring"]["value"])  # nothing is known of the temperature
        self.assertTrue((self.folder / "seen" / "figures" / "msd.png").is_file())
        self.assertIn("41 frames", (self.folder / "seen" / "report.html").read_text())
        self.write("tracks.csv", (self.folder / "tracks.csv").read_text().replace("\n", "\n\n", 3).replace(",5,", ",6,", 1))
        self.expect(0, "run", "tracks.toml", "-o", "other")  # one row less: not the same
        self.assertNotEqual(bed["order"], self.results("other")["order"])

    def test_a_peer_finds_the_same_in_an_open_window(self):
        random = np.random.default_rng(2)
        sides = np.array([40.0, 36.0])
        frames = [random.uniform(0, 1, (300, 2)) * sides for _ in range(2)]
        for frame in frames:
            frame[:4] = [(0, 0), (sides[0], 0), (0, sides[1]), sides]  # so that the hull is the rectangle
        self.write_rows("frame,particle,x,y", [(50 * f, k, *map(float, p)) for f, frame in enumerate(frames) for k, p in enumerate(frame)])
        self.write("tracks.toml", OPEN)
        self.expect(0, "run", "tracks.toml", "-o", "seen")
        bin_width, bins = 0.05, 360
        edges = np.arange(bins + 1) * bin_width
        g, psi, border = np.zeros(bins), [], []
        for frame in frames:
            tree = cKDTree(frame)
            shares = np.stack([share_inside(frame, sides, r) for r in edges[:-1] + bin_width / 2], axis=1)
            inner = np.minimum(frame, sides - frame).min(axis=1) > 3
            border.append(1 - inner.mean())
            order = np.zeros(len(frame), complex)
            for i, near in enumerate(tree.query_ball_point(frame, 3)):
                bonds = frame[[j for j in near if j != i]] - frame[i]
                order[i] = np.exp(6j * np.arctan2(bonds[:, 1], bonds[:, 0])).mean() if len(bonds) else 0
                away = np.hypot(*(np.delete(frame, i, axis=0) - frame[i]).T)
                g += np.histogram(away, edges)[0] / shares[i]
            psi.append(abs(order[inner].mean()))
        ideal = 2 * 300 * 299 * np.pi * np.diff(edges**2) / sides.prod()
        found = columns(self.folder / "seen" / "gr.csv")
        np.testing.assert_allclose(found["g"], g / ideal, rtol=1e-9, atol=1e-12)
        told = self.results("seen")["order"]
        self.assertAlmostEqual(told["psi6"]["value"], np.mean(psi), delta=1e-9)
        self.assertAlmostEqual(told["at_border"], np.mean(border), delta=1e-12)

    def test_trackmate_xml(self):
        self.write("tracks.toml", tracks('frames_per_second = 1\npixel = "1 a"', '[measure]\norder = true\norder_cutoff = "1 a"\nblock = "2 s"\n'))
        spots = "".join(f'<SpotsInFrame frame="{f}">' + "".join(
            f'<Spot ID="{100 * f + k}" FRAME="{f}" POSITION_X="{3.0 * (k % 5) + 0.1 * f}" POSITION_Y="{3.0 * (k // 5)}" POSITION_Z="0"/>'
            for k in range(25)) + "</SpotsInFrame>" for f in range(3))
        edges = "".join(f'<Track TRACK_ID="{k}">' + "".join(
            f'<Edge SPOT_SOURCE_ID="{100 * f + k}" SPOT_TARGET_ID="{100 * f + 100 + k}"/>' for f in range(2)) + "</Track>" for k in range(24))
        self.write("film.xml", f'<?xml version="1.0"?><TrackMate><Model spatialunits="pixel"><AllSpots>{spots}</AllSpots>'
                               f"<AllTracks>{edges}</AllTracks></Model></TrackMate>")
        self.expect(0, "measure", "tracks.toml", "-o", "seen", "-s", "tracks.file=film.xml")
        told = json.loads((self.folder / "seen" / "tracks.json").read_text())
        self.assertEqual((told["frames"], told["particles"], told["mean_length"], told["length_unit"]), (3, 24, 3.0, "pixel"))
        self.assertEqual(told["left_out"], [{"why": "rows in no track, used where one frame is enough", "rows": 3}])

    def test_what_cannot_be_is_told_before_anything_is_written(self):
        self.write("tracks.toml", OPEN)
        self.refuse(2, r'tracks.file = "tracks.csv": no such file; looked for', "run", "tracks.toml", "-o", "seen")
        self.refuse(2, r'tracks.toml:2:1: window = "periodic" needs box, for example box = "78 a"', "check", "tracks.toml", "-s", "tracks.window=periodic")
        self.refuse(2, r"phonons needs a bed", "check", "tracks.toml", "-s", "measure.phonons=true")
        self.refuse(2, r"stands in place of a bed", "check", "tracks.toml", "-s", "granular.phi_b=0.7", "-s", "granular.box=\"30 a\"",
                    "-s", "granular.duration=1.0")
        self.write("tracks.csv", "frame,particle,x,y\n0,1,1.0,1.0\n1,1,oops,1.0\n")
        done = self.expect(2, "run", "tracks.toml", "-o", "seen")
        self.assertIn('tracks.csv:3: x = "oops": expected a number', done.stderr)
        self.assertEqual(self.status("seen"), "failed")

    def test_the_shipped_example(self):
        self.expect(0, "check", SOURCE / "scenes" / "tracks.toml")


if __name__ == "__main__":
    import unittest
    unittest.main()
