"""Granular runs: beds that take a second, what must be equal of two runs, and interruptions."""

import json
import math
import os
import random
import re
from pathlib import Path

import h5py
import numpy
from rodwake import ProgramTest, wait_until

# 49 beads and a rod.
BED = """schema = 1
[granular]
phi_b = 0.7
box = "16 a"
equilibrate = "0.02 s"
duration = "0.2 s"
[granular.output]
frames = "0.01 s"
table = "0.005 s"
[[granular.rods]]
position = ["8 a", "8 a"]
"""

FINAL = {"scene.toml", "provenance.json", "log.txt", "manifest.json", "result.h5", "summary.json", "table.csv", "tracks.csv", "trajectory.h5md",
         "trajectory.xyz", "last_period.h5md", "final.rwc"}


def setting(**keys):
    """-s granular.key=value ...; a double underscore stands for a dot."""
    return [part for key, value in keys.items() for part in ("-s", f"granular.{key.replace('__', '.')}={value}")]


def content(file):
    """Every dataset of an HDF5 file: its shape, type and bytes by name."""
    found = {}
    with h5py.File(file) as opened:
        opened.visititems(lambda name, item: found.update({name: (item.shape, str(item.dtype), item[()].tobytes())})
                          if isinstance(item, h5py.Dataset) and item.dtype.kind in "fiu" else None)
    return found


def numbers_of(file):
    """All numbers in a file of results."""
    if file.suffix in (".h5", ".h5md"):
        for shape, kind, raw in content(file).values():
            if kind.startswith("float"):
                yield from numpy.frombuffer(raw, kind)
    elif file.suffix == ".json":
        yield from (float(word) for word in re.findall(r"-?\b(?:NaN|Infinity)\b", file.read_text()))
    elif file.suffix == ".csv":
        for line in file.read_text().splitlines()[1:]:
            yield from (float(word) for word in line.split(","))


def flip_byte(file, place=-1):
    data = bytearray(file.read_bytes())
    data[place if place >= 0 else len(data) // 2] ^= 0x10
    file.write_bytes(bytes(data))


def columns(file):
    """A CSV file by column."""
    lines = file.read_text().splitlines()
    table = [[float(word or "nan") for word in line.split(",")] for line in lines[1:]]
    return {name: [row[i] for row in table] for i, name in enumerate(lines[0].split(","))}


class BedTest(ProgramTest):
    """A current folder with bed.toml in it."""

    def setUp(self):
        super().setUp()
        self.write("bed.toml", BED)

    def dem(self, run, *arguments, code=0, **options):
        return self.expect(code, "dem", "bed.toml", "-o", run, *arguments, **options)

    def out(self, run, name):
        return self.folder / run / name

    def status_of(self, run):
        return self.status(run) if self.out(run, "provenance.json").exists() else ""

    def summary(self, run):
        return json.loads(self.out(run, "summary.json").read_text())

    def hash(self, run):
        return self.summary(run)["state_hash"]

    def names(self, run):
        return {str(p.relative_to(self.folder / run)) for p in (self.folder / run).rglob("*") if p.is_file()}

    def assert_same(self, one, other):
        """To the bit: last state, tables, all frames."""
        self.assertEqual(self.hash(one), self.hash(other))
        results = [{name for name in self.names(run) if name.endswith((".csv", ".h5md", ".xyz"))} for run in (one, other)]
        self.assertIn("table.csv", results[0])
        self.assertEqual(*results)
        for name in results[0]:
            if not name.endswith(".h5md"):
                self.assertEqual(self.out(one, name).read_bytes(), self.out(other, name).read_bytes(), name)
                continue
            ours, theirs = content(self.out(one, name)), content(self.out(other, name))
            self.assertEqual([key for key in ours.keys() | theirs.keys() if ours.get(key) != theirs.get(key)], [], name)

    def assert_finite(self, run):
        for file in sorted((self.folder / run).rglob("*")):
            if file.is_file():
                self.assertTrue(all(math.isfinite(number) for number in numbers_of(file)), file)

    def steps_gone_on_from(self, run):
        """The steps from which the commands took the run up, by its log."""
        return [int(step) for step in re.findall(r"resuming from step (\d+)", self.out(run, "log.txt").read_text())]

    def wait_for(self, process, *names):
        there = wait_until(lambda: all((self.folder / name).exists() for name in names) or process.poll() is not None, 30)
        self.assertTrue(there and process.poll() is None, f"{names}: not there, or the run ended too early")


class InterruptionTest(BedTest):
    """Runs that are stopped at random moments end as those that are not."""

    SETTINGS = (*setting(output__checkpoint=0.02, duration=2.0, output__frames=0.02), "--quiet")

    def setUp(self):
        super().setUp()
        self.made_once("whole", "dem", "bed.toml", *self.SETTINGS)
        self.seconds = json.loads(self.out("whole", "provenance.json").read_text())["wall_seconds"]
        self.random = random.Random(os.environ.get("RODWAKE_TEST_SEED", "1"))

    def finish_after(self, run, stops, signals, longest):
        """Stops the run so many times, each at a random moment up to `longest` s after its start; then lets it end. How
        often it was stopped: it may end before the last one."""
        stopped = 0
        for _ in range(stops):
            arguments = ("dem", "bed.toml", "-o", run, *self.SETTINGS)
            stopped += self.interrupt(self.random.choice(signals), self.random.uniform(0.0, longest), *arguments)
            if self.status_of(run) == "finished":
                break
        if self.status_of(run) != "finished":
            self.dem(run, *self.SETTINGS)
        self.assert_same(run, "whole")
        return stopped
