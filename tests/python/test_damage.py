"""Folders of runs that are damaged: RunError names the file, whatever is wrong with it. What can be sent to another process."""

import json
import multiprocessing
import os
import pickle
import shutil
import signal
import time
import unittest

import h5py
import numpy as np
import rodwake
from program import SCENES, new_folder

BED = ('schema = 1\n[granular]\nbeads = 40\nbox = "16 a"\nstart = "lattice"\nequilibrate = "0 s"\nduration = "0.02 s"\n[granular.output]\nframes = "0.01 s"\n'
       '[measure]\norder = true\n')
DEEP = "[" * 100_000
TEXTS = {"truncated": b'{"schema": 1, "fi', "deep": DEEP.encode(), "deep objects": b'{"a":' * 100_000, "empty": b"", "not UTF-8": b'{"a": "\xff\xfe"}',
         "NaN": b'{"status": NaN}', "Infinity": b"[-Infinity]", "noughts": b"\0" * 4096, "a long number": b"1" * 10_000}
VALUES = {"a list": [1], "a number": 3, "a text": "files", "null": None}


def change(path, edit):
    """An HDF5 file, edited."""
    with h5py.File(path, "r+") as file:
        edit(file)


class DamageTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        keeper = cls()
        cls.addClassCleanup(keeper.doCleanups)
        cls.folder = new_folder(keeper)
        rodwake.Scene.load(SCENES / "pair.toml").run(cls.folder / "pair")
        rodwake.Scene.parse(BED).run(cls.folder / "bed")
        rodwake.scan(rodwake.Scene.load(SCENES / "pair.toml"), {"coupling.kappa": [1.0, 2.0]}, folder=cls.folder / "scan")

    def runTest(self):
        """Of the keeper."""

    def copied(self, name="pair"):
        folder = new_folder(self) / name
        shutil.copytree(self.folder / name, folder)
        return folder

    def assert_reported(self, file, ask, *words):
        """Not by an exception of a library; the file is named."""
        with self.assertRaisesRegex(rodwake.RunError, file.name) as raised:
            ask()
        for word in words:
            self.assertRegex(str(raised.exception), word)
        self.assertLess(len(str(raised.exception)), 1000)

    def asks_of(self, name):
        """What reads a JSON file of each run."""
        return {"manifest.json": ("pair", lambda folder: rodwake.open_run(folder).files),
                "provenance.json": ("pair", lambda folder: rodwake.open_run(folder).status),
                "outcome.json": ("pair", lambda folder: rodwake.open_run(folder).outcome),
                "summary.json": ("bed", lambda folder: rodwake.open_run(folder).json("summary.json")),
                "measure.json": ("bed", lambda folder: rodwake.open_run(folder).json("measure.json")),
                "scan.json": ("scan", lambda folder: rodwake.open_run(folder).json("scan.json"))}[name]

    def test_json_that_is_none(self):
        for name in ("manifest.json", "provenance.json", "outcome.json", "summary.json", "measure.json", "scan.json"):
            run, ask = self.asks_of(name)
            folder = self.copied(run)
            for what, text in TEXTS.items():
                (folder / name).write_bytes(text)
                with self.subTest(name, what=what):
                    self.assert_reported(folder / name, lambda: ask(folder))
            (folder / name).unlink()
            (folder / name).mkdir()
            with self.subTest(name, what="a folder"):
                self.assert_reported(folder / name, lambda: ask(folder), "folder|directory")

    def test_json_of_the_wrong_kind(self):
        for name in ("manifest.json", "provenance.json", "outcome.json"):
            run, ask = self.asks_of(name)
            folder = self.copied(run)
            for what, value in VALUES.items():
                (folder / name).write_text(json.dumps(value))
                with self.subTest(name, what=what):
                    self.assert_reported(folder / name, lambda: ask(folder), "not an object")
        for value in ({}, {"status": 3}, {"status": ["finished"]}):
            (folder / "provenance.json").write_text(json.dumps(value))
            self.assert_reported(folder / "provenance.json", lambda: rodwake.open_run(folder).status, "status")
        self.assertIn("of unknown status", repr(rodwake.Run(self.manifest_with(folder, {}))))

    def manifest_with(self, folder, files):
        (folder / "manifest.json").write_text(json.dumps({"schema": 1, "files": files}))
        return folder

    def test_manifests_of_the_wrong_kind(self):
        folder = self.copied()
        for files in (None, [1], {"rods.csv": None}, {"rods.csv": {"columns": 3}}, {"rods.csv": {"columns": ["t"]}}, {"rods.csv": {"columns": [{"name": "t"}]}},
                      {"rods.csv": {"columns": [{"name": ["t"], "unit": "m"}]}}, {"rods.csv": {"columns": None}}):
            with self.subTest(files):
                self.assert_reported(folder / "manifest.json", lambda: rodwake.open_run(self.manifest_with(folder, files)))
        (folder / "manifest.json").write_text("{}")
        self.assert_reported(folder / "manifest.json", lambda: rodwake.open_run(folder), "not the manifest")

    def test_files_that_are_lost(self):
        folder = self.copied()
        for name, ask in (("rods.csv", lambda run: run.table("rods.csv")), ("result.h5", lambda run: run.rods()), ("outcome.json", lambda run: run.outcome),
                          ("provenance.json", lambda run: run.status), ("scene.toml", lambda run: run.scene())):
            (folder / name).unlink()
            with self.subTest(name):
                self.assert_reported(folder / name, lambda: ask(rodwake.open_run(folder)), "lost")
            (folder / name).mkdir()
            with self.subTest(name, what="a folder"):
                self.assert_reported(folder / name, lambda: ask(rodwake.open_run(folder)), "a folder")

    def test_tables(self):
        folder = self.copied()
        path = folder / "rods.csv"
        whole = path.read_bytes()
        lines = whole.splitlines(keepends=True)
        header = lines[0]
        cases = {"empty": b"", "cut off": whole[:-5], "a row is short": b"".join([*lines[:9], b"2,1\n", *lines[9:]]),
                 "a row is long": b"".join([*lines[:9], lines[9][:-1] + b",7\n"]), "all rows are long": header + b"".join(b"7," + line for line in lines[1:]),
                 "not UTF-8": whole.replace(b"0.25", b"\xff.25", 1), "noughts": whole[:300] + b"\0" * 300, "words": whole.replace(b"0.25", b"none", 1),
                 "a column is missing": whole.replace(b"theta1", b"theta9", 1)}
        for what, text in cases.items():
            path.write_bytes(text)
            with self.subTest(what):
                self.assert_reported(path, lambda: rodwake.open_run(folder).table("rods.csv"))
        path.write_bytes(header)
        self.assertEqual(len(rodwake.open_run(folder).table("rods.csv")), 0)

    def test_scenes(self):
        folder = self.copied()
        for text in (b"", b"schema = 1\n[rods", b"\xff\xfe", DEEP.encode(), b"a = " + DEEP.encode(), b"schema = 1\n[medium]\neta = -3\n", b"\0" * 100):
            (folder / "scene.toml").write_bytes(text)
            with self.subTest(text[:20]):
                self.assert_reported(folder / "scene.toml", lambda: rodwake.open_run(folder).scene())

    def test_hdf5(self):
        asks = (lambda run: run.rods(), lambda run: run.field(), lambda run: run.datasets(), lambda run: run.dataset("rods/scene/x"))
        folder = self.copied()
        path = folder / "result.h5"
        whole = path.read_bytes()
        for what, text in {"empty": b"", "cut off": whole[:len(whole) // 2], "no HDF5": b"CDF" * 100}.items():
            path.write_bytes(text)
            for number, ask in enumerate(asks):
                with self.subTest(what, number=number):
                    self.assert_reported(path, lambda: ask(rodwake.open_run(folder)))

        def removed(name):
            return lambda file: file.pop(name)

        def replaced(name, value):
            def edit(file):
                del file[name]
                file[name] = value
            return edit

        edits = [removed("rods/scene/theta"), removed("rods/scene/t"), replaced("rods/scene/x", [1.0]), replaced("rods/scene/t", [0.0]),
                 replaced("rods/scene", 3.0), lambda file: file["rods/scene/x"].attrs.pop("unit"),
                 lambda file: file["rods/scene/x"].attrs.__setitem__("unit", np.bytes_(b"\xff"))]
        for number, edit in enumerate(edits):
            path.write_bytes(whole)
            change(path, edit)
            with self.subTest(edit=number):
                self.assert_reported(path, lambda: rodwake.open_run(folder).rods())
        bed = self.copied("bed")
        path = bed / "trajectory.h5md"
        whole = path.read_bytes()
        place = "particles/trajectory/"
        edits = [removed(place + "velocity"), removed(place + "position/time"), removed(place + "box/edges"), replaced(place + "species", [0, 0]),
                 replaced(place + "radius", "thick"), replaced(place + "position/value", np.zeros((3, 40))),
                 replaced(place + "velocity/value", np.zeros((2, 40, 3))), replaced("particles/trajectory", 1)]
        for number, edit in enumerate(edits):
            path.write_bytes(whole)
            change(path, edit)
            with self.subTest(frames=number):
                self.assert_reported(path, lambda: rodwake.open_run(bed).trajectory())

    def test_a_lock_that_a_forked_process_keeps(self):
        """As the workers of a pool do that began while result.h5 was written."""
        folder = self.copied()
        file = h5py.File(folder / "result.h5", "r+")
        child = os.fork()
        if child == 0:
            time.sleep(60)
            os._exit(0)
        file.close()
        try:
            self.assertIn("rods/scene/x", rodwake.open_run(folder).datasets())
        finally:
            os.kill(child, signal.SIGKILL)
            os.waitpid(child, 0)

    def test_figures(self):
        for name, text in (("result.h5", b"CDF"), ("outcome.json", b"[1"), ("outcome.json", DEEP.encode()), ("scene.toml", b"[rods")):
            folder = self.copied()
            (folder / name).write_bytes(text)
            with self.subTest(name, text=text[:5]):
                self.assertRaises(rodwake.RunError, rodwake.plots.figures, folder)
                self.assertRaises(rodwake.RunError, rodwake.plots.draw, folder, "trajectories")
        bed = self.copied("bed")
        for name, text in (("summary.json", b'{"box": "wide"}'), ("table.csv", b"t,psi6\n1\n"), ("measure.json", b"[")):
            (bed / name).write_bytes(text)
            with self.subTest(name), self.assertRaisesRegex(rodwake.RunError, name):
                rodwake.plots.draw(bed, "granular_table" if name == "table.csv" else "bond_order")
            shutil.copy(self.folder / "bed" / name, bed / name)
        with self.assertRaises(rodwake.InputError):
            rodwake.plots.draw(bed, "trajectories")

    def test_a_folder_that_may_not_be_read(self):
        with self.assertRaisesRegex(rodwake.Error, "File name too long"):
            rodwake.open_run("a" * 5000)
        with self.assertRaises(rodwake.Error):
            rodwake.open_run("a\0b")


def described(sent):
    """In another process."""
    return [repr(one) for one in sent]


class SentTest(unittest.TestCase):
    def test_what_can_be_sent_to_a_process(self):
        folder = new_folder(self)
        shutil.copy(SCENES / "pair.toml", folder)
        scene = rodwake.Scene.load(folder / "pair.toml").set("coupling.kappa", 3.0)
        run = scene.run(folder / "run", stages="rods")
        medium = rodwake.Medium(eta=2.0, periodic=(30.0, 20.0))
        results = [rodwake.simulate([[0, 2.5, 0], [0, -2.5, 0]], medium, kappa=0.5, t_end=5.0), rodwake.simulate([[0, 0, 0]], t_end=1.0)]
        sent = [medium, scene, run, *results, rodwake.Scene.parse(scene.to_toml())]
        for one in sent:
            other = pickle.loads(pickle.dumps(one))
            self.assertEqual(other, one)
            self.assertEqual(repr(other), repr(one))
        self.assertNotEqual(results[0], results[1])
        self.assertNotEqual(results[0], rodwake.simulate([[0, 2.5, 0], [0, -2.5, 0]], medium, kappa=0.6, t_end=5.0))
        self.assertNotEqual(scene, scene.copy().set("coupling.kappa", 4.0))
        self.assertNotEqual(results[0], 3)
        with multiprocessing.get_context("spawn").Pool(1) as pool:
            self.assertEqual(pool.apply(described, [sent]), described(sent))

    def test_a_copy_does_not_read_the_file_again(self):
        path = new_folder(self) / "pair.toml"
        shutil.copy(SCENES / "pair.toml", path)
        scene = rodwake.Scene.load(path)
        before, sent = scene.to_toml(), pickle.dumps(scene)
        os.unlink(path)
        self.assertEqual((scene.copy().to_toml(), pickle.loads(sent).to_toml()), (before, before))
        self.assertRegex(scene.set("coupling.kappa", 9).to_toml(), r"kappa = 9\b")


if __name__ == "__main__":
    unittest.main()
