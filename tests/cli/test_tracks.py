"""[tracks]: a bed written as tracks and read back has the bed's own numbers; a peer's numbers in an open window; what is odd in a
file is reported."""

import csv
import json
import os

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
        self.expect(0, "run", "tracks.toml", "-o", "other", "--no-figures")  # one row less: not the same
        self.assertNotEqual(bed["order"], self.results("other")["order"])

    def test_a_peer_finds_the_same_in_an_open_window(self):
        random = np.random.default_rng(2)
        sides = np.array([40.0, 36.0])
        frames = [random.uniform(0, 1, (300, 2)) * sides for _ in range(2)]
        for frame in frames:
            frame[:4] = [(0, 0), (sides[0], 0), (0, sides[1]), sides]  # so that the hull is the rectangle
        self.write_rows("frame,particle,x,y", [(50 * f, k, *map(float, p)) for f, frame in enumerate(frames) for k, p in enumerate(frame)])
        self.write("tracks.toml", OPEN)
        self.expect(0, "run", "tracks.toml", "-o", "seen", "--no-figures")
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
        record = self.results("seen")["order"]
        self.assertAlmostEqual(record["psi6"]["value"], np.mean(psi), delta=1e-9)
        self.assertAlmostEqual(record["at_border"], np.mean(border), delta=1e-12)

    def film(self, frames, keys='window = "hull"', measure="", step=0.02, keep=1.0, rods=0):
        """100 discs on a shaken lattice, 2.2 a apart, with a rod in the first `rods` of these frames or steps."""
        random = np.random.default_rng(3)
        k = np.arange(100)
        place = 2.2 * np.stack([k % 10 + 0.5 * (k // 10 % 2), 0.866 * (k // 10)], axis=1) + 3
        rows = []
        for f in frames:
            place = place + random.normal(scale=step, size=place.shape)
            rows += [(int(f), int(i), float(x), float(y), 0, 0) for i, (x, y) in enumerate(place) if random.random() < keep]
        rows += [(f, 7, 8.0 + 0.2 * f, 12.0, 0, 1) for f in range(rods)]
        self.write_rows("frame,particle,x,y,theta,kind", rows)
        self.write("tracks.toml", tracks(f'frames_per_second = 10\npixel = "1 a"\n{keys}', "[measure]\norder = true\norder_cutoff = \"3 a\"\n"
                   "order_interval = 0.1\nblock = 1.0\n" + measure))

    def seen(self, *words, code=0):
        done = self.expect(code, "measure", "tracks.toml", "-o", "seen", "--force", *words)
        return done.stdout + done.stderr, json.loads((self.folder / "seen/tracks.json").read_text()), self.results("seen")

    def test_frames_without_rows_and_uneven_steps(self):
        for frames, lags in ((range(60), [1, 2, 3, 4]), ([f for f in range(180) if f % 30 < 10], [1, 2, 3, 4]), ([0, *(2**k for k in range(20))], [1, 2, 4, 8]),
                             ([0, *(27 + 1000 * k for k in range(40))], [27, 1000]), ([0, 1, 10**9], [1, 10**9])):
            self.film(frames, measure="microrheology = true\n")
            text, record, found = self.seen()
            self.assertEqual((record["frames"], record["beads_per_frame"], record["lost_share"]), (len(frames), 100, 0), text)
            self.assertAlmostEqual(record["phi_b"] * record["area"], 100 * np.pi, delta=1e-9)
            msd = columns(self.folder / "seen/msd.csv")
            self.assertTrue(all(np.isclose(10 * np.array(msd["lag"]), lag, rtol=0.04).any() for lag in lags), msd["lag"])
            if msd["lag"][0] == 0.1 and len(frames) >= 60:
                self.assertAlmostEqual(msd["msd"][0], 2 * 0.02**2, delta=5e-5)
            self.assertEqual(found["microrheology"]["stiffness"]["value"] is None, len(frames) < 32)
            self.assertEqual("no_stiffness" in found["microrheology"], len(frames) < 32)
        self.film(range(60), measure="microrheology = true\ninterval = 0.3\n")
        self.seen()
        self.assertAlmostEqual(columns(self.folder / "seen/msd.csv")["lag"][0], 0.3)

    def test_who_is_cut_where(self):
        box = 'window = "periodic"\nbox = ["22 a", "19.052 a"]'
        self.film(range(80), box, "microrheology = true\n", step=1.0, keep=0.8)
        text, record, found = self.seen()
        self.assertEqual((record["particles"], record["left_out"]), (100, []), text)
        self.assertAlmostEqual(columns(self.folder / "seen/msd.csv")["msd"][0] / 2, 0.99, delta=0.06)  # the drift is taken off
        text, record, found = self.seen("-s", 'tracks.longest_step="1.5 a"')
        self.assertRegex(text, r"\d+ tracks cut where they jump: their number goes on more than tracks.longest_step = 1.5 a away")
        self.film(range(80), step=1.0, keep=0.8)
        self.assertIn("more than 3 mean spacings of", self.seen()[0])
        self.assertEqual(self.seen("-s", "tracks.longest_step=unlimited")[1]["particles"], 100)
        self.refuse(2, 'expected a length \\("2 a"\\), "auto" or "unlimited"', "check", "tracks.toml", "-s", "tracks.longest_step=never")

    def test_a_far_spot_and_a_wrong_unit_are_reported_at_once(self):
        self.film(range(3), step=0.05)
        text = (self.folder / "tracks.csv").read_text().splitlines()
        self.write("tracks.csv", "\n".join([*text[:150], "1,49,3.0,1e7,0,0", *text[151:]]) + "\n")
        words, record, found = self.seen()
        self.assertRegex(words, r"frame 1: a spot at \(3, 1e\+07\) of the file lies far from all others.* set tracks.window")
        self.assertEqual([one["rows"] for one in record["left_out"]][-2:], [0, 0])
        self.film(range(10))
        words, record, found = self.seen("-s", "tracks.pixel=28 mm", "-s", "measure.order_cutoff=3 a")
        self.assertRegex(words, r"beads cover 0.0001\d of the window: is tracks.pixel or tracks.bead_radius right\?")

    def test_two_frames_have_no_errors_and_rods_may_be_seen_longer_than_beads(self):
        self.film([0, 10])
        found = self.seen()[2]["order"]
        self.assertIsNone(found["psi6"]["error"])
        self.assertGreater(found["psi6"]["value"], 0.9)
        everything = "flow = true\nflow_spacing = \"3 a\"\nflow_lag = 0.1\nmicrorheology = true\ndisplacement = \"lagrangian\"\nheading_diffusion = true\n"
        for frames, rods in ((range(40), 41), (range(20), 40), ([0, 1, 2, 5, 9, 30], 40), ([0], 2)):
            for window in ('window = "hull"', 'window = "periodic"\nbox = ["30 a", "30 a"]'):
                self.film(frames, window, everything, rods=rods)
                done = self.run_program("measure", "tracks.toml", "-o", "seen", "--force")
                self.assertIn(done.returncode, (0, 1), done.stderr)  # what cannot be had is reported; nothing crashes
                self.assertTrue((self.folder / "seen/measure.json").is_file(), done.stderr)

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
        record = json.loads((self.folder / "seen" / "tracks.json").read_text())
        self.assertEqual((record["frames"], record["particles"], record["mean_length"], record["length_unit"]), (3, 24, 3.0, "pixel"))
        self.assertEqual(record["left_out"], [{"why": "rows in no track, used where one frame is enough", "rows": 3}])

    def test_what_cannot_be_is_reported_before_anything_is_written(self):
        self.write("tracks.toml", OPEN)
        self.refuse(2, r'tracks.file = "tracks.csv": no such file; looked for', "run", "tracks.toml", "-o", "seen")
        self.refuse(2, r'tracks.toml:2:1: window = "periodic" needs box, for example box = "78 a"', "check", "tracks.toml", "-s", "tracks.window=periodic")
        self.refuse(2, r"phonons needs a bed", "check", "tracks.toml", "-s", "measure.phonons=true")
        self.refuse(2, r"tracks replace a simulated bed", "check", "tracks.toml", "-s", "granular.phi_b=0.7", "-s", "granular.box=\"30 a\"",
                    "-s", "granular.duration=1.0")
        self.write("tracks.csv", "frame,particle,x,y\n0,1,1.0,1.0\n1,1,oops,1.0\n")
        done = self.expect(2, "run", "tracks.toml", "-o", "seen")
        self.assertIn('tracks.csv:3: x = "oops": expected a number', done.stderr)
        self.assertEqual(self.status("seen"), "failed")

    def test_check_reads_the_header_as_the_run_does(self):
        self.write("tracks.toml", OPEN)
        for text, expected in (("frame,particle,a,y\n0,1,1,1\n", r"tracks\.csv:1: no column for x \(usual: x\); the file has frame, particle, a, y"),
                           ("frame,particle,x,y\n0,1,1\n", r'tracks\.csv:2: has 3 fields, and column "y" would be number 4')):
            self.write("tracks.csv", text)
            errors = {self.refuse(2, expected, verb, "tracks.toml").stderr for verb in ("check", "run")}
            self.assertEqual(len(errors), 1, errors)
        rows = [(f, k, 3.0 * (k % 5), 3.0 * (k // 5)) for f in range(3) for k in range(25)]
        self.write_rows("frame,particle,x,y", rows)
        self.write("rods.csv", "frame,id,X1,Y1,X2,Y2\n" + "".join(f"{f},0,7,6,5,6\n" for f in range(3)))
        rods = ("-s", "tracks.rods_file=rods.csv", "-s", "tracks.frames_per_second=1", "-s", "measure.block=2 s", "-s", "tracks.angle=1 deg")
        expected = "columns X1, Y1, X2, Y2 are taken for the ends of a rod, the thin end first"
        self.assertIn(f"rods.csv: {expected}", self.expect(0, "check", "tracks.toml", *rods).stdout)
        self.assertIn(expected, self.expect(0, "measure", "tracks.toml", "-o", "seen", *rods).stderr)
        with open(self.folder / "seen" / "rod_tracks.csv") as file:
            poses = [(float(row["x0"]) / A, float(row["theta0"])) for row in csv.DictReader(file)]
        np.testing.assert_allclose(poses, [(6.0, 0.0)] * 3, rtol=1e-9)

    def test_folders_and_files_of_any_bytes(self):
        folder = self.folder / os.fsdecode(b"d\xe9faut")  # Latin-1
        folder.mkdir()
        rows = [(f, k, 2.1 * (k % 10), 2.1 * (k // 10)) for f in range(3) for k in range(100)]
        self.write_rows("frame,particle,x,y", rows)
        (self.folder / "tracks.csv").rename(folder / "tracks.csv")
        (folder / "tracks.toml").write_text(OPEN.replace("= 100", "= 1").replace('"0.5 s"', '"1 s"'))
        for arguments in (["check"], ["run", "-o", folder / "seen"], ["check", "-s", b"tracks.file=\xe9.csv"], ["check", "-s", b"title=\xe9"]):
            done = self.run_program(arguments[0], folder / "tracks.toml", *arguments[1:])  # whose text is UTF-8, else this raises
            self.assertEqual(done.returncode, 2 if "-s" in arguments else 0, done.stderr)
            self.assertNotIn("json.exception", done.stderr)
        for verb in ("plot", "info"):
            self.expect(0, verb, folder / "seen")
        for path in (folder / "seen").iterdir():
            if path.suffix in (".json", ".txt", ".toml", ".csv", ".html"):
                path.read_text(encoding="utf-8")
        (folder / "tracks.csv").write_bytes("frame,Größe,y\n0,1,2\n".encode("latin-1"))
        self.refuse(2, r"d\\xe9faut/tracks.csv:1: no column for x .*Gr\\xf6\\xdfe, y \(not in UTF-8: save it so\)", "check", folder / "tracks.toml")

    def test_the_shipped_example(self):
        self.expect(0, "check", SOURCE / "scenes" / "tracks.toml")


if __name__ == "__main__":
    import unittest
    unittest.main()
