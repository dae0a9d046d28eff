"""tools/result_hashes: what differs by nature is the same to it, a changed digit is not."""

import contextlib
import importlib.machinery
import importlib.util
import io
import json
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import h5py
import numpy as np
import rodwake

TOOL = rodwake.SOURCE / "tools/result_hashes"
_loader = importlib.machinery.SourceFileLoader("result_hashes", str(TOOL))
result_hashes = importlib.util.module_from_spec(importlib.util.spec_from_loader("result_hashes", _loader))
_loader.exec_module(result_hashes)

LOG = "2026-11-22 07:04:00.512 {}\n"


def write_run(folder, *, seconds, command, date):
    """Files of every kind, with all that differs of two runs of the same scene."""
    folder.mkdir(parents=True)
    (folder / "provenance.json").write_text(json.dumps({"command": command, "date": date, "wall_seconds": seconds, "seed": 1}))
    (folder / "summary.json").write_text(json.dumps({"cpu_seconds": seconds, "rods": [{"mean_speed": 0.25}]}))
    (folder / "runs.csv").write_text(f"run,cpu_seconds,T_xy\n1,{seconds},0.5\n")
    (folder / "rods.csv").write_text("# of two rods\nt,x0\n0,0.10000000000000001\n")
    (folder / "log.txt").write_text(LOG.format(f"debug: {command}") + LOG.format("info: 9 steps")
                                    + LOG.format(f"info:  {seconds}  1.0") + LOG.format(f"info: 2 s simulated in {seconds} s of CPU; done"))
    (folder / "final.rwc").write_bytes(bytes([int(seconds)]))
    with h5py.File(folder / "result.h5", "w") as file:
        compression = {"compression": "gzip", "compression_opts": int(seconds)}
        file.create_dataset("grid/Ux", data=np.linspace(0.0, 1.0, 50), **compression).attrs["unit"] = "a"
        file["grid"].attrs["command"] = command


class HashesTest(unittest.TestCase):
    def setUp(self):
        keeper = tempfile.TemporaryDirectory(prefix="rodwake-hashes-")
        self.addCleanup(keeper.cleanup)
        self.folder = Path(keeper.name)
        write_run(self.folder / "a/results/pair", seconds=1.5, command="/one/rodwake rods", date="2026-01-01")
        write_run(self.folder / "b/results/pair", seconds=7.25, command="/other/rodwake rods", date="2027-01-01")

    def hashed(self, name):
        work = self.folder / name
        shutil.rmtree(work / "normal", ignore_errors=True)
        found = result_hashes.hash_results(work / "results", work / "normal")
        (work / "hashes.txt").write_text(result_hashes.listing(found))
        return work

    def difference(self):
        return result_hashes.compare(self.hashed("a"), self.hashed("b"))

    def file(self, name):
        return self.folder / "b/results/pair" / name

    def test_what_differs_by_nature_is_the_same(self):
        self.assertEqual(self.difference(), [])
        names = set(result_hashes.hashes_of(self.folder / "a"))
        self.assertEqual(names, {f"pair/{name}" for name in ("provenance.json", "summary.json", "runs.csv", "rods.csv", "log.txt", "result.h5")})

    def test_a_changed_digit_is_seen(self):
        for name, old, new in (("provenance.json", '"seed": 1', '"seed": 2'), ("summary.json", "0.25", "0.25000000000000006"),
                               ("runs.csv", "0.5", "0.6"), ("rods.csv", "0.10000000000000001", "0.10000000000000002"),
                               ("rods.csv", "two rods", "three rods"), ("log.txt", "9 steps", "8 steps")):
            with self.subTest(name):
                text = self.file(name).read_text()
                self.assertIn(old, text)
                self.file(name).write_text(text.replace(old, new))
                words = self.difference()
                self.assertEqual([line for line in words if not line.startswith(" ")], [f"differing pair/{name}"])
                self.assertEqual(len([line for line in words if line.startswith("    ")]), 2, words)  # one line, before and after
                self.file(name).write_text(text)

    def test_changes_inside_hdf5_are_seen(self):
        def last_bit(file):
            file["grid/Ux"][7] = np.nextafter(file["grid/Ux"][7], 1.0)

        def unit(file):
            file["grid/Ux"].attrs["unit"] = "m"

        def single_precision(file):
            values = file["grid/Ux"][...]
            del file["grid/Ux"]
            file.create_dataset("grid/Ux", data=values.astype("f4")).attrs["unit"] = "a"

        kept = self.file("result.h5").read_bytes()
        for change in (last_bit, unit, single_precision):
            with self.subTest(change.__name__):
                with h5py.File(self.file("result.h5"), "r+") as file:
                    change(file)
                self.assertIn("differing pair/result.h5", self.difference())
                self.file("result.h5").write_bytes(kept)
        self.assertEqual(self.difference(), [])

    def test_missing_and_new_files_and_the_exit_code(self):
        self.assertEqual(self.exit_code_of_compare(), 0)
        self.file("rods.csv").rename(self.file("tracks.csv"))
        self.assertEqual(self.difference(), ["missing   pair/rods.csv", "new       pair/tracks.csv"])
        self.assertEqual(self.exit_code_of_compare(), 1)

    def exit_code_of_compare(self):
        folders = [self.hashed("a"), self.hashed("b")]
        return subprocess.run([sys.executable, TOOL, "--compare", *folders], stdout=subprocess.DEVNULL).returncode

    def test_folders_are_not_overwritten(self):
        with self.assertRaises(SystemExit), contextlib.redirect_stderr(io.StringIO()):
            result_hashes.run_scenes("rodwake", self.folder / "a", [])


if __name__ == "__main__":
    rodwake.main()
