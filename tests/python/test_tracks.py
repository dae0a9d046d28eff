"""Tracks in the hands of Python: from arrays, tables and files, the numbers of `rodwake run`."""

import os
import unittest

import numpy as np
import pandas as pd
import rodwake
from program import new_folder

SIDE = 20.0
KEYS = dict(frames_per_second=10.0, bead_radius=1.0, window="periodic", box=SIDE)
MEASURE = dict(order_cutoff=3.0, block=1.0)


def film(frames=40, beads=100, seed=1):
    """Discs on a shaken lattice, (T, N, 2), through the edges of the box."""
    random = np.random.default_rng(seed)
    lattice = np.stack(np.meshgrid(np.arange(10) * 2.0, np.arange(10) * 2.0), axis=-1).reshape(-1, 2)[:beads]
    return lattice + np.cumsum(random.normal(scale=0.05, size=(frames, beads, 2)), axis=0)


def frame_of(places):
    frame, particle = np.indices(places.shape[:2])
    return pd.DataFrame({"frame": frame.ravel(), "particle": particle.ravel(), "x": places[..., 0].ravel(), "y": places[..., 1].ravel(), "mass": 1})


class TracksTest(unittest.TestCase):
    def test_arrays_a_table_and_a_file_give_the_same(self):
        places = film()
        folder = new_folder(self)
        table = frame_of(places)
        table.sample(frac=1, random_state=2).to_csv(folder / "film.csv")
        given = [rodwake.Tracks.from_arrays(places, **KEYS), rodwake.Tracks(table, pixel=1.0, **KEYS),
                 rodwake.Tracks(dict(table), pixel=1.0, **KEYS), rodwake.Tracks(folder / "film.csv", pixel=1.0, **KEYS),
                 rodwake.Tracks(table.to_records(index=False), pixel=1.0, **KEYS)]
        orders, moves = [one.order(**MEASURE) for one in given], [one.displacement(**MEASURE) for one in given]
        for order, move in zip(orders, moves):
            self.assertEqual(order.values, orders[0].values)
            pd.testing.assert_frame_equal(order.tables["gr"], orders[0].tables["gr"])
            pd.testing.assert_frame_equal(move.tables["msd"], moves[0].tables["msd"])
        self.assertEqual((orders[0].film["frames"], orders[0].film["particles"]), (40, 100))
        self.assertEqual(orders[0].tables["gr"].attrs["units"]["r"], "a")
        walked = places[5:] - places[:-5]
        walked -= walked.mean(axis=1, keepdims=True)
        found = moves[0].tables["msd"]
        at = np.flatnonzero(np.isclose(found.iloc[:, 0], 0.5))
        self.assertEqual(len(at), 1)
        np.testing.assert_allclose(found.iloc[at[0]][1], (walked**2).sum(axis=2).mean(), rtol=1e-9)

    def test_times_and_gaps(self):
        places = film(40, 50)
        places[3, 7] = np.nan
        table = frame_of(places)
        table["t"] = table.pop("frame") / 10.0
        keys = {key: value for key, value in KEYS.items() if key != "frames_per_second"}
        found = rodwake.Tracks(table, pixel=1.0, **keys).order(**MEASURE)
        self.assertEqual([one["rows"] for one in found.film["left_out"]], [1])
        hidden = np.ma.masked_invalid(places)
        self.assertEqual(rodwake.Tracks.from_arrays(hidden, **KEYS).order(**MEASURE).values, found.values)
        self.assertIn("40 frames", repr(found))

    def test_a_run_stays(self):
        folder = new_folder(self)
        tracks = rodwake.Tracks.from_arrays(film(), **KEYS)
        run = tracks.run(folder / "seen", order=True, microrheology=True, **MEASURE)
        self.assertEqual(run.json("measure.json")["order"], tracks.order(**MEASURE).values)
        self.assertIn("msd.csv", run.files)
        self.assertIn("4000 rows", repr(tracks))

    def test_a_folder_of_any_bytes(self):
        folder = new_folder(self) / os.fsdecode(b"d\xe9faut")  # Latin-1
        folder.mkdir()
        table = frame_of(film(12))
        table.to_csv(folder / "tracks.csv")
        scene = folder / "film.toml"
        scene.write_text('schema = 1\n[tracks]\nfile = "tracks.csv"\npixel = "1 m"\nframes_per_second = 10.0\nbead_radius = 1.0\n'
                         '[measure]\norder = true\norder_cutoff = 3.0\nblock = 1.0\n')
        loaded = rodwake.Scene.load(scene)
        self.assertEqual(loaded.path, str(scene))
        self.assertIn("tracks.csv", loaded.check())
        run = loaded.run(folder / "seen")
        self.assertEqual(rodwake.open_run(folder / "seen").json("measure.json"), run.json("measure.json"))
        (folder / "tracks.csv").write_bytes("frame,Größe,y\n0,1,2\n".encode("latin-1"))
        with self.assertRaisesRegex(rodwake.InputError, r"d\\xe9faut/tracks.csv:1: no column for x .*Gr\\xf6\\xdfe"):
            loaded.check()
        with self.assertRaisesRegex(rodwake.InputError, "a scene is UTF-8 and cannot hold this name"):
            rodwake.Tracks(folder / "tracks.csv", pixel=1.0, **KEYS)
        with self.assertRaisesRegex(rodwake.SceneError, r"d\\xe9faut"):
            rodwake.Scene.load(folder / "none.toml")

    def test_what_cannot_be_is_reported(self):
        table = frame_of(film(3, 4))
        for rows, expected in ((table.rename(columns={"x": "X"}), "no column x; there are frame, particle, X"),
                           (table.drop(columns="frame"), r"no column frame \(or t\)"),
                           ({"frame": [0, 1], "x": [1.0], "y": [1.0]}, "expected one axis of one length"),
                           ({"frame": ["a"], "x": [1.0], "y": [1.0]}, "rows.frame: expected numbers")):
            with self.subTest(expected), self.assertRaisesRegex(rodwake.InputError, expected):
                rodwake.Tracks(rows, pixel=1.0, **KEYS)
        with self.assertRaisesRegex(TypeError, "rows: expected the name of a file"):
            rodwake.Tracks(3.0, pixel=1.0)
        with self.assertRaisesRegex(rodwake.SceneError, "give frames_per_second"):
            rodwake.Tracks(table, pixel=1.0)
        with self.assertRaisesRegex(rodwake.SceneError, 'unknown key "windwo"'):
            rodwake.Tracks(table, pixel=1.0, frames_per_second=1.0, windwo="hull")
        with self.assertRaisesRegex(rodwake.InputError, r"positions: expected an array of shape \(T, N, 2\)"):
            rodwake.Tracks.from_arrays(np.zeros((3, 4)))
        with self.assertRaisesRegex(rodwake.RunError, "run failed: measure: microrheology: [a-z]"):  # the reason, for the log is gone
            rodwake.Tracks.from_arrays(film(40, 20), localisation=1.0, **KEYS).displacement()  # more than the beads move
        with self.assertRaisesRegex(rodwake.InputError, "none.csv.*no such file"):
            rodwake.Tracks(new_folder(self) / "none.csv", pixel=1.0, **KEYS).order()


if __name__ == "__main__":
    unittest.main()
