"""[tracks] from files that other programs wrote, against the same film as CSV; a bed's frames as other programs read them; psi6, g(r)
and mean-square displacement against SciPy."""

import json

import gsd.hoomd
import h5py
import numpy as np
from beds import columns
from rodwake import ProgramTest
from scipy.spatial import cKDTree

SIDES = np.array([24.0, 22.0])
MEASURE = """[measure]
order = true
order_interval = "0.1 s"
order_cutoff = "3 a"
microrheology = true
block = "1 s"
"""
KEYS = 'pixel = "1 a"\nframes_per_second = 10'
PERIODIC = KEYS + '\nwindow = "periodic"\nbox = ["24 a", "22 a"]'


def film(frames=41, beads=110, seed=3):
    """Places (T, N, 2) on a shaken triangular lattice, as single precision has them."""
    random = np.random.default_rng(seed)
    start = np.array([((i + 0.5 * (j % 2)) * 2.4, j * 2.2) for j in range(10) for i in range(10)] + [(12, 11)] * 10)[:beads]
    walk = start + random.normal(scale=0.3, size=start.shape) + np.cumsum(random.normal(scale=0.08, size=(frames, beads, 2)), axis=0)
    return walk.astype(np.float32).astype(float)


class TrackFormats(ProgramTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.walk = film()
        cls.place = (cls.walk % SIDES).astype(np.float32).astype(float)
        cls.random = np.random.default_rng(4)

    def rows(self, frame):
        return self.random.permutation(len(self.place[frame]))

    def measure(self, file, keys, out, measure=MEASURE):
        self.write(f"{out}.toml", f'schema = 1\n[tracks]\nfile = "{file}"\n{keys}\n{measure}')
        return self.expect(0, "measure", f"{out}.toml", "-o", out)

    def numbers(self, out):
        """Of all measures and of the film, and the tables."""
        found = {name: (self.folder / out / name).read_bytes() for name in ("gr.csv", "gB.csv", "msd.csv", "stiffness.csv")}
        record = json.loads((self.folder / out / "tracks.json").read_text())
        return found, json.loads((self.folder / out / "measure.json").read_text()), {key: record[key] for key in ("frames", "particles", "rods", "window")}

    def as_csv(self, keys=PERIODIC, out="csv"):
        lines = [f"{t},{i},{self.place[t, i, 0]!r},{self.place[t, i, 1]!r}" for t in range(len(self.place)) for i in self.rows(t)]
        self.write("film.csv", "\n".join(["frame,particle,x,y", *lines]) + "\n")
        self.measure("film.csv", keys, out)
        return self.numbers(out)

    def assert_like_csv(self, file, keys, out, csv=None):
        self.measure(file, keys, out)
        tables, values, record = csv or self.as_csv()
        found = self.numbers(out)
        self.assertTrue(found[0] == tables, out)  # assertEqual would look for the differences for a minute
        self.assertEqual(found[1]["order"], values["order"])
        self.assertEqual(found[2], record)

    def test_dumps_and_extended_xyz(self):
        dump, xyz = "", ""
        for t, places in enumerate(self.place):
            dump += (f"ITEM: TIME\n{t / 10}\nITEM: TIMESTEP\n{500 * t}\nITEM: NUMBER OF ATOMS\n{len(places)}\nITEM: BOX BOUNDS pp pp ff\n"
                     "0 24\n0 22\n-1 1\nITEM: ATOMS id type xs ys ix iy\n")
            image = np.floor(self.walk[t] / SIDES).astype(int)
            dump += "".join(f"{i + 1} 1 {places[i, 0] / 24!r} {places[i, 1] / 22!r} {image[i, 0]} {image[i, 1]}\n" for i in self.rows(t))
            xyz += f'{len(places)}\nLattice="24 0 0 0 22 0 0 0 2" Properties=species:S:1:pos:R:3 pbc="T T F" Time={t / 10}\n'
            xyz += "".join(f"Al {x!r} {y!r} 0.5\n" for x, y in places)
        self.write("film.lammpstrj", dump.replace("\n", "\r\n"))
        self.write("film.xyz", xyz)
        csv = self.as_csv()
        self.assert_like_csv("film.xyz", 'pixel = "1 a"', "xyz", csv)  # box and times are its own
        self.assert_like_csv("film.xyz", KEYS, "rate", csv)
        for out, keys in (("own", 'pixel = "1 a"'), ("steps", 'pixel = "1 a"\nframes_per_second = 5000')):  # scaled places are rounded, in the last digits
            self.measure("film.lammpstrj", keys, out)
            tables, values, record = self.numbers(out)
            self.assertEqual(record, csv[2])
            self.assertAlmostEqual(values["order"]["psi6"]["value"], csv[1]["order"]["psi6"]["value"], delta=1e-12)
            np.testing.assert_allclose(columns(self.folder / out / "msd.csv")["msd"], columns(self.folder / "csv" / "msd.csv")["msd"], rtol=1e-9)

    def test_gsd_of_gsd(self):
        with gsd.hoomd.open(str(self.folder / "film.gsd"), "wb") as out:
            for t, places in enumerate(self.place):
                frame = gsd.hoomd.Snapshot()
                frame.configuration.step = 200 * t
                frame.configuration.box = [24, 22, 2, 0, 0, 0]
                frame.particles.N = len(places)
                frame.particles.types = ["bead", "wall"]
                frame.particles.position = np.column_stack([places, np.zeros(len(places))])
                out.append(frame)
        self.assert_like_csv("film.gsd", 'pixel = "1 a"\nframes_per_second = 2000', "gsd")

    def test_h5md_of_others(self):
        """Single precision, two dimensions, rows of other particles in every frame, a fixed step and time, edges as a vector."""
        with h5py.File(self.folder / "film.h5md", "w") as out:
            group = out.create_group("particles/discs")
            ids = np.stack([self.rows(t) for t in range(len(self.place))])
            group["position/value"] = np.take_along_axis(self.place, ids[..., None], axis=1).astype(np.float32)
            group["position/step"], group["position/time"] = 10, 0.1
            group["position/step"].attrs["offset"] = 30
            group["id/value"], group["id/step"] = ids.astype(np.int16) + 7, 10
            box = group.create_group("box")
            box.attrs["dimension"], box.attrs["boundary"] = 2, ["periodic", "periodic"]
            box["edges"] = np.array(SIDES, np.float32)
        self.assert_like_csv("film.h5md", 'pixel = "1 a"', "h5md")
        with h5py.File(self.folder / "film.h5md", "r+") as out:
            out["particles/discs/box"].attrs["boundary"] = ["none", "none"]
            out["particles/walls/position/value"] = np.zeros((1, 1, 2))
        self.assertIn("several groups of particles: discs, walls; name one in tracks.group",
                      self.expect(2, "measure", "h5md.toml", "-o", "two").stderr)
        cut = '\nlongest_step = "8 a"'  # ids of a camera are cut by another rule than those of a simulation
        self.assert_like_csv("film.h5md", 'pixel = "1 a"\nframes_per_second = 100\ngroup = "discs"' + cut, "open", self.as_csv(KEYS + cut, "hull"))

    def test_a_bed_in_every_format(self):
        self.write("bed.toml", """schema = 1
[granular]
phi_b = 0.7
box = "24 a"
equilibrate = 0.0
duration = "0.4 s"
[granular.output]
frames = "0.01 s"
formats = ["h5md", "xyz"]
last_period = false
[[granular.rods]]
position = ["8 a", "8 a"]
""")
        self.refuse(2, r"rodwake convert RUN -o film.gsd", "dem", "bed.toml", "-o", "bed", "-s", 'granular.output.formats=["gsd"]')
        self.expect(0, "dem", "bed.toml", "-o", "bed")
        self.expect(0, "convert", "bed", "-o", "bed/trajectory.gsd")
        with h5py.File(self.folder / "bed" / "trajectory.h5md") as h5, gsd.hoomd.open(str(self.folder / "bed" / "trajectory.gsd")) as trajectory:
            spheres = h5["particles/trajectory"]
            self.assertEqual(len(trajectory), 41)
            for k, frame in enumerate(trajectory):
                box = np.diag(spheres["box/edges/value"][k])
                np.testing.assert_allclose(frame.configuration.box[:3], box / 0.4e-3, rtol=1e-7)  # single precision
                np.testing.assert_allclose(frame.particles.position, (spheres["position/value"][k] - box / 2) / 0.4e-3, atol=2e-6)
                np.testing.assert_array_equal(frame.particles.image, spheres["image/value"][k])
                np.testing.assert_array_equal(frame.particles.typeid, spheres["species"])
                self.assertEqual((frame.configuration.step, frame.log["time"][0]), (spheres["position/step"][k], spheres["position/time"][k]))
            self.assertEqual(frame.particles.types, ["bead", "rod"])
        for format, keys, rods in (("h5md", 'pixel = "1 m"', 1), ("xyz", 'pixel = "1 a"', 12), ("gsd", 'pixel = "1 a"', 12)):
            self.measure(f"bed/trajectory.{format}", keys, format, MEASURE.replace('"1 s"', '"0.2 s"'))
        self.assertEqual([self.numbers(one)[2]["window"] for one in ("h5md", "xyz", "gsd")], ["periodic"] * 3)
        self.assertEqual([self.numbers(one)[2]["rods"] for one in ("h5md", "xyz", "gsd")], [1, 12, 12])
        bed = json.loads((self.folder / "h5md" / "measure.json").read_text())["order"]["psi6"]["value"]
        for other, delta in (("xyz", 1e-12), ("gsd", 1e-5)):  # gsd: single precision moves bonds across the cut-off by 1e-7
            self.assertAlmostEqual(json.loads((self.folder / other / "measure.json").read_text())["order"]["psi6"]["value"], bed, delta=delta)

    def dump(self, name, walk, columns="id x y ix iy", box=lambda t: SIDES, rows=lambda t: range(110)):
        """Frames of `walk`, which is not wrapped."""
        text = []
        for t, frame in enumerate(walk):
            image = np.floor(frame / SIDES)
            text.append(f"ITEM: TIME\n{t / 10}\nITEM: TIMESTEP\n{500 * t}\nITEM: NUMBER OF ATOMS\n{len(rows(t))}\n"
                        f"ITEM: BOX BOUNDS pp pp ff\n0 {box(t)[0]}\n0 {box(t)[1]}\n-1 1\nITEM: ATOMS {columns}\n")
            for i in rows(t):
                (x, y), (ix, iy) = frame[i] - image[i] * SIDES, image[i].astype(int)
                words = {"id": i + 1, "x": x, "y": y, "xu": frame[i, 0], "yu": frame[i, 1], "ix": ix, "iy": iy}
                text.append(" ".join(str(words[column]) for column in columns.split()) + "\n")
        self.write(name, "".join(text))

    def test_a_box_that_changes_is_kept_by_convert_and_refused_by_tracks(self):
        self.dump("film.dump", self.place, box=lambda t: SIDES * (2 if t == 40 else 1))
        for name in ("film.dump", "film.gsd", "film.xyz", "film.h5md"):
            if name != "film.dump":
                self.expect(0, "convert", "film.dump", "-o", name)
            with self.subTest(name):
                self.write("box.toml", f'schema = 1\n[tracks]\nfile = "{name}"\npixel = "1 a"\n{MEASURE}')
                self.assertRegex(self.expect(2, "measure", "box.toml", "-o", f"box_{name}").stderr,
                                 rf'{name}: its box changes in frame 40 \(step 20000\), from 24 x 22 to 48 x 44: give tracks.window = "hull"')
                self.expect(0, "measure", "box.toml", "-o", f"hull_{name}", "-s", "tracks.window=hull")

    def test_steps_longer_than_half_a_box_and_rows_that_are_missing(self):
        """Where image indices or unwrapped positions are known, no shortest way is taken, and no track is cut."""
        random = np.random.default_rng(7)
        walk = self.walk[:1] + np.cumsum(random.normal(scale=6.0, size=(60, 110, 2)), axis=0)
        seen = [np.flatnonzero(random.random(110) < 0.8) for _ in walk]
        drift = np.cumsum([np.mean((walk[t + 1] - walk[t])[np.intersect1d(seen[t], seen[t + 1])], axis=0) for t in range(59)], axis=0)
        free = walk - np.vstack([np.zeros((1, 2)), drift])[:, None]
        first = np.mean(np.concatenate([((free[t + 1] - free[t])[np.intersect1d(seen[t], seen[t + 1])]**2).sum(axis=1) for t in range(59)]))
        for name, names in (("image.dump", "id x y ix iy"), ("free.dump", "id xu yu")):
            self.dump(name, walk, names, rows=lambda t: seen[t])
            self.measure(name, 'pixel = "1 a"', f"of_{name}")
            record = json.loads((self.folder / f"of_{name}" / "tracks.json").read_text())
            self.assertEqual((record["particles"], record["left_out"]), (110, []))
            self.assertAlmostEqual(columns(self.folder / f"of_{name}" / "msd.csv")["msd"][0], first, delta=1e-9 * first)
        self.assertGreater(first, 60)  # the shortest way would give some 45

    def test_a_film_is_made_once_and_looked_into_by_check(self):
        self.dump("film.dump", self.walk)
        self.measure("film.dump", 'pixel = "1 a"', "once")
        (film,) = (self.folder / "once").glob("film_*.h5md")
        before = film.stat().st_mtime_ns
        self.expect(0, "measure", "once.toml", "-o", "once", "--force", "-s", 'measure.order_cutoff="2.5 a"')
        self.assertEqual(film.stat().st_mtime_ns, before)
        self.assertIn("film.dump: its first frames: 110 particles, 0 rods, box 24 x 22", self.expect(0, "check", "once.toml").stdout)
        self.write("film.dump", (self.folder / "film.dump").read_text().replace("0 24.0\n", "0 25.0\n"))
        self.expect(0, "measure", "once.toml", "-o", "once", "--force")
        self.assertEqual(len(list((self.folder / "once").glob("film_*.h5md"))), 1)
        self.assertFalse(film.exists())
        self.write("film.dump", "ITEM: TIMESTEP\n0\nITEM: NUMBER OF ATOMS\n1\nITEM: BOX BOUNDS pp pp ff\n0 1\n0 1\n0 1\nITEM: ATOMS id x y\n1 1_0 2\n")
        for verb in ("check", "measure"):
            self.assertRegex(self.expect(2, verb, "once.toml", "-o", "bad").stderr, r'film.dump:\d+: x = "1_0": expected a number')

    def test_convert_there_and_back_and_what_it_refuses(self):
        self.dump("film.dump", self.walk)
        for name in ("a.h5md", "a.xyz", "a.csv"):
            self.expect(0, "convert", "film.dump", "-o", name)
            self.expect(0, "convert", name, "-o", f"{name}.dump")
            rows = [line.split() for line in (self.folder / f"{name}.dump").read_text().splitlines() if len(line.split()) > 4 and line[0] != "I"]
            np.testing.assert_array_equal([[float(row[2]), float(row[3])] for row in rows], (self.walk - np.floor(self.walk / SIDES) * SIDES).reshape(-1, 2))
        self.refuse(2, r"a.csv: exists already; --force replaces it", "convert", "film.dump", "-o", "a.csv")
        self.refuse(2, r"nothing.gsd: no such file of tracks", "convert", "nothing.gsd", "-o", "b.csv")
        self.refuse(2, r"column speed=v: expected frame, id, x, y, heading or kind", "convert", "film.dump", "-o", "b.csv", "--column", "speed=v")

    def test_scipy_finds_the_same(self):
        self.as_csv()
        width = 0.05
        found = columns(self.folder / "csv" / "gr.csv")
        edges = np.arange(len(found["r"]) + 1) * width
        np.testing.assert_allclose(found["r"], edges[:-1] + width / 2, rtol=1e-12)
        g, psi = np.zeros(len(found["r"])), []
        n = self.place.shape[1]
        for frame in self.place[::1]:
            tree = cKDTree(frame % SIDES, boxsize=SIDES)
            pairs = tree.sparse_distance_matrix(tree, edges[-1], output_type="coo_matrix")
            g += np.histogram(pairs.data[pairs.row != pairs.col], edges)[0]
            near = tree.query_pairs(3.0, output_type="ndarray")
            bond = frame[near[:, 1]] - frame[near[:, 0]]
            bond -= SIDES * np.round(bond / SIDES)
            turn = np.exp(6j * np.arctan2(bond[:, 1], bond[:, 0]))
            sums, counts = np.zeros(n, complex), np.zeros(n)
            for end in near.T:
                np.add.at(sums, end, turn)
                np.add.at(counts, end, 1)
            psi.append(abs((sums / np.maximum(counts, 1)).mean()))
        ideal = len(self.place) * n * (n - 1) / SIDES.prod() * np.pi * np.diff(edges**2)
        np.testing.assert_allclose(found["g"], g / ideal, rtol=1e-9, atol=1e-12)
        record = json.loads((self.folder / "csv" / "measure.json").read_text())["order"]
        self.assertAlmostEqual(record["psi6"]["value"], np.mean(psi), delta=1e-9)
        step = np.diff(self.place, axis=0)
        walk = np.concatenate([self.place[:1], self.place[0] + np.cumsum(step - SIDES * np.round(step / SIDES), axis=0)])
        walk -= walk.mean(axis=1, keepdims=True)
        msd = columns(self.folder / "csv" / "msd.csv")
        lags = np.rint(np.array(msd["lag"]) * 10).astype(int)
        direct = [((walk[lag:] - walk[:len(walk) - lag])**2).sum(axis=2).mean() for lag in lags]
        fine = lags <= 16  # of longer ones not every frame is an origin
        self.assertGreater(fine.sum(), 10)
        np.testing.assert_allclose(np.array(msd["msd"])[fine], np.array(direct)[fine], rtol=1e-9)


if __name__ == "__main__":
    import unittest
    unittest.main()
