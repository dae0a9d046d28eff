"""Rods of films: a bed with rods, written as a film and read back, has the bed's own numbers; from a film to a fit."""

import json

import h5py
import numpy as np
from beds import columns
from rodwake import PAIR, SOURCE, ProgramTest

PIXEL = 2.0**-13  # so that to pixels and back costs no digit
MEASURE = """[measure]
flow = true
flow_spacing = "3 a"
flow_lag = 0.021
displacement = "METHOD"
spacing = "2 a"
far_from = "10 a"
reference = "far"
pairs = true
contact_distance = "8 a"
heading_diffusion = true
heading_lag_high = 0.105
block = 0.21
"""
# rows of tracks.csv at whole multiples of 7 steps, where the headings in them are those of the frames
BED = """schema = 1
[granular]
phi_b = 0.80
box = "40 a"
equilibrate = 0.0
duration = "0.63 s"
[granular.output]
frames = "0.0105 s"
table = "0.0105 s"
last_period = false
[[granular.rods]]
position = ["18 a", "13 a"]
[[granular.rods]]
position = ["18 a", "27 a"]
"""
FILM = """schema = 1
[tracks]
file = "film.csv"
time_column = "t"
pixel = "PIXEL m"
window = "periodic"
box = "40 a"
""".replace("PIXEL", str(PIXEL))


class FilmRods(ProgramTest):
    def results(self, folder):
        return json.loads((self.folder / folder / "measure.json").read_text())

    def write_rows(self, header, rows):
        self.write("film.csv", "\n".join([header, *(",".join("" if v is None else v if isinstance(v, str) else repr(v) for v in row) for row in rows)]) + "\n")

    def poses(self, folder, name="theta0"):
        table = np.genfromtxt(self.folder / folder / "rod_tracks.csv", delimiter=",", names=True)
        return table[name]

    def film_of_bed(self):
        """What the camera makes of the bed, with the bed's times in place of numbers of frames."""
        self.expect(0, "camera", "bed", "--pixel", f"{PIXEL} m", "--quiet")
        with h5py.File(self.folder / "bed/trajectory.h5md") as file:
            time = file["particles/trajectory/position/time"][...]
        header, *lines = (self.folder / "bed/camera/tracks.csv").read_text().splitlines()
        rows = [line.split(",", 1) for line in lines]
        self.write("film.csv", "\n".join([header.replace("frame", "t"), *(f"{time[int(frame)]!r},{rest}" for frame, rest in rows)]) + "\n")

    def test_a_bed_with_rods_read_back_has_its_own_numbers(self):
        self.write("bed.toml", BED + MEASURE.replace("METHOD", "phase"))
        self.expect(0, "run", "bed.toml", "-o", "bed", "--no-figures")
        self.film_of_bed()
        self.write("film.toml", FILM + MEASURE.replace("METHOD", "phase"))
        self.expect(0, "run", "film.toml", "-o", "film")
        for name in ("marked.csv", "profile_Ux_x.csv", "profile_Uy_y.csv", "flow.vti", "displacement.vti"):
            self.assertEqual((self.folder / "bed" / name).read_bytes(), (self.folder / "film" / name).read_bytes(), name)
        bed, film = self.results("bed"), self.results("film")
        for name in ("flow", "displacement"):
            self.assertEqual(bed[name], film[name], name)
        for name in ("pairs.csv", "heading.csv"):  # a bed's headings are sums of turns: rounding
            tables = [np.genfromtxt(self.folder / folder / name, delimiter=",", skip_header=1) for folder in ("bed", "film")]
            np.testing.assert_allclose(*tables, rtol=1e-9, atol=1e-12, err_msg=name)
        for name in ("displacement_map", "flow", "heading_diffusion", "pair_tracks"):
            self.assertTrue((self.folder / "film/figures" / f"{name}.png").is_file(), name)
        for method in ("lagrangian", "density"):
            for folder, scene in (("bed", BED), ("film", FILM)):
                self.write(f"{folder}.toml", scene + MEASURE.replace("METHOD", method))
                self.expect(0, "measure", f"{folder}.toml", "-o", folder, "--force", "--quiet")
            self.assertEqual(self.results("bed")["displacement"], self.results("film")["displacement"], method)
            self.assertEqual((self.folder / "bed/displacement.vti").read_bytes(), (self.folder / "film/displacement.vti").read_bytes(), method)
        record = json.loads((self.folder / "film/tracks.json").read_text())
        self.assertEqual([(rod["frames"], rod["known"]) for rod in record["rod_tracks"]], [(61, 61), (61, 61)])
        text = (self.folder / "film.csv").read_text().splitlines()
        self.write("film.csv", "\n".join(line for k, line in enumerate(text) if k % 11 != 5) + "\n")  # a tenth is lost: numbers differ, and are there
        self.expect(0, "measure", "film.toml", "-o", "gaps", "-s", "measure.displacement=phase")
        gaps = self.results("gaps")
        self.assertNotEqual(gaps["flow"], film["flow"])
        self.assertAlmostEqual(gaps["heading_diffusion"]["speed"]["value"], film["heading_diffusion"]["speed"]["value"], delta=0.1)
        self.assertTrue(np.isnan(self.poses("gaps")).any())
        self.expect(0, "camera", "bed", "-o", "eye", "--view", "0.8", "--lost", "0.05", "--quiet")
        self.write("eye/window.toml", (self.folder / "eye/camera.toml").read_text().split("[measure]")[0] + MEASURE.replace("METHOD", "phase"))
        self.expect(0, "measure", "eye/window.toml", "-o", "window", "--quiet")
        window = self.results("window")
        self.assertEqual(window["displacement"]["reference"], "far")
        self.assertAlmostEqual(window["displacement"]["lattice_spacing"], film["displacement"]["lattice_spacing"], delta=0.03)  # other beads
        self.write("maps.toml", 'schema = 1\n[fit]\nparameters = ["f_over_mu", "eta"]\nfixed = { xi = 500.0 }\n[[fit.maps]]\nfiles = ["window/measure.h5"]\n')
        self.refuse(2, "was measured in a window of a film", "fit", "maps.toml", "-o", "maps")

    def lengths(self, folder):
        return [rod["length"] for rod in json.loads((self.folder / folder / "tracks.json").read_text())["rod_tracks"]]

    def test_ends_and_axes_say_what_headings_say(self):
        rows = []
        for f in range(60):
            x, y, theta = 5 + 0.5 * f, 20 + 2 * np.sin(0.1 * f), float(np.arctan2(0.2 * np.cos(0.1 * f), 0.5))
            c, s = np.cos(theta), np.sin(theta)
            rows.append((f, 1, float(x), float(y), theta, float(np.degrees(theta) % 180), float(x + 3 * c), float(y + 3 * s),
                         float(x - 3 * c), float(y - 3 * s), "rod"))
        self.write_rows("frame,particle,x,y,theta,angle,x1,y1,x2,y2,kind", rows)
        film = ('schema = 1\n[tracks]\nfile = "film.csv"\nframes_per_second = 50\npixel = "1 a"\n'
                'window = { rectangle = ["0 a", "0 a", "60 a", "60 a"] }\n[measure]\nheading_diffusion = true\nblock = 0.4\n')
        self.write("film.toml", film)
        self.expect(0, "measure", "film.toml", "-o", "given", "--quiet")
        theta = self.poses("given")
        np.testing.assert_array_equal(theta, [row[4] for row in rows])
        for name, keys in (("axis", ("tracks.columns.heading=angle", "tracks.angle=1 deg", "tracks.thin_end=ahead")),
                           ("ends", ('tracks.columns.ends=["x1","y1","x2","y2"]',)),
                           ("turned", ('tracks.columns.ends=["x2","y2","x1","y1"]', "tracks.thin_end=ahead"))):
            self.expect(0, "measure", "film.toml", "-o", name, "--quiet", *(word for key in keys for word in ("-s", key)))
            np.testing.assert_allclose(self.poses(name), theta, atol=1e-12, err_msg=name)
        self.assertEqual([self.lengths("given"), self.lengths("axis")], [[None], [None]])
        np.testing.assert_allclose(self.lengths("ends"), [6 * 0.4e-3], rtol=1e-12)
        self.assertFalse((self.folder / "ends/film_frame.csv").exists())  # there are no beads
        given = (self.folder / "film.csv").read_text()
        self.write("film.csv", given.replace(",x,y,theta,angle", ",u,v,w,angle", 1))
        self.expect(0, "measure", "film.toml", "-o", "middle", "--quiet", "-s", 'tracks.columns.ends=["x1","y1","x2","y2"]')
        np.testing.assert_allclose(self.poses("middle", "x0"), self.poses("given", "x0"), rtol=1e-12)
        self.write("film.csv", given)
        self.write("rods.csv", given.replace(",kind", ",note").replace(",rod", ",0"))
        self.write("film.csv", "frame,particle,x,y\n" + "".join(f"{f},{p},{8 + 10 * p},{8 + 10 * (p % 3)}\n" for f in range(60) for p in range(5)))
        self.expect(0, "measure", "film.toml", "-o", "apart", "--quiet", "-s", "tracks.rods_file=rods.csv", "-s", "tracks.columns.heading=theta")
        np.testing.assert_array_equal(self.poses("apart"), theta)  # bead 1 is not rod 1
        self.assertEqual(json.loads((self.folder / "apart/tracks.json").read_text())["particles"], 5)
        self.write("film.csv", given)
        self.refuse(2, "ends and heading are given", "check", "film.toml", "-s", "tracks.columns.heading=theta",
                    "-s", 'tracks.columns.ends=["x1","y1","x2","y2"]')
        self.refuse(2, "pairs of .tracks. needs contact_distance", "check", "film.toml", "-s", "measure.pairs=true")
        self.refuse(2, "phonons needs a bed .* positions and headings", "check", "film.toml", "-s", "measure.phonons=true")
        for keys, expected in ((("measure.rod=1",), "no rod 1: it has 1, numbered from 0"), (("tracks.columns.kind=nothing",), "no column"),
                           (("tracks.columns.ends=[\"x1\",\"y1\",\"x2\",\"z\"]",), 'no column "z"')):
            done = self.expect(2, "measure", "film.toml", "-o", "no", "--force", *(word for key in keys for word in ("-s", key)))
            self.assertIn(expected, done.stderr)

    def test_from_a_film_with_gaps_to_the_couplings(self):
        self.write("pair.toml", PAIR)
        self.expect(0, "rods", "pair.toml", "-o", "truth", "--quiet", "-s", "rods_run.output_interval=0.25", "-s", "rods_run.rtol=1e-11")
        truth = columns(self.folder / "truth/rods.csv")
        random = np.random.default_rng(4)
        rows = [(t, rod, truth[f"x{rod}"][f], truth[f"y{rod}"][f], truth[f"theta{rod}"][f], "rod")
                for f, t in enumerate(truth["t"][:-1]) for rod in (0, 1) if f < 2 or random.random() > 0.1]  # without the time of contact
        self.write_rows("t,particle,x,y,theta,kind", rows)
        self.write("film.toml", 'schema = 1\n[tracks]\nfile = "film.csv"\ntime_column = "t"\npixel = 1.0\nbead_radius = 0.1\n'
                                '[measure]\npairs = true\ncontact_distance = 0.1\n'
                                '[fit]\nparameters = ["kappa", "alpha"]\nstart = { kappa = 0.3, alpha = 1.5 }\nfixed = { eta = 1.0 }\n'
                                '[[fit.trajectories]]\nfile = "rod_tracks.csv"\n')
        done = self.expect(0, "run", "film.toml", "-o", "out")
        self.assertRegex(done.stderr + done.stdout, r"rod_tracks.csv: \d+ rows with an unknown rod are left out")
        found = json.loads((self.folder / "out/fit.json").read_text())["parameters"]
        self.assertAlmostEqual(found["kappa"]["value"], 0.5, delta=1e-6)  # the film has all digits
        self.assertAlmostEqual(found["alpha"]["value"], 1.0, delta=1e-6)
        self.assertIn("rod_tracks", (self.folder / "out/report.html").read_text())
        self.assertTrue((self.folder / "out/figures/fit_trajectories.png").is_file())
        self.refuse(2, "names rod 2; there are 2", "fit", "film.toml", "-o", "out", "--force", "-s", "fit.trajectories.0.rods=[0, 2]")

    def test_the_shipped_example(self):
        self.expect(0, "check", SOURCE / "scenes/tracks.toml")


if __name__ == "__main__":
    import unittest
    unittest.main()
