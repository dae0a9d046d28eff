"""Scans of a pair that take a second, what must be equal of two scans, and scans that are stopped."""

import csv
import json
import math
import os
import random
import shutil
import signal
import struct
import time

from beds import content
from rodwake import ProgramTest

# A rod that crosses the way of another one.
CROSSING = """schema = 1
[medium]
eta = 1.0
alpha = 1.0
[coupling]
kappa = 1.0
[[rods]]
position = [0.0, 0.0]
[[rods]]
position = [0.0, -4.0]
heading = "90 deg"
[rods_run]
t_end = 60.0
contact_distance = 0.1
"""


def axis(key, low, high, count, spacing="linear"):
    return f'[[scan.axes]]\nkey = "{key}"\nfrom = {low}\nto = {high}\ncount = {count}\nspacing = "{spacing}"\n'


def axes(count):
    return axis("coupling.kappa", 0.1, 100.0, count, "log") + axis("rods.1.position.0", -6.0, 6.0, count)


ADAPTIVE = (CROSSING + '[scan]\ndesign = "adaptive"\nresolution = 32\naudit = 100\nboundary_tolerance = 1e-4\n'
            "trajectories = 20\n" + axes(16))
GRID = CROSSING + "[scan]\ntrajectories = 5\n" + axes(9)

# Of scan.csv after the axes.
COLUMNS = ["outcome", "time", "status", "min_separation", "min_separation_time", "turn0", "turn1", "non_reciprocity",
           "final_separation", "final_angle", "steps", "rhs_evaluations", "separation", "omega", "certificate", "retries"]
RESULTS = ("scan.csv", "cells.csv", "boundary.csv")


def rows_of(file):
    return list(csv.DictReader(file.read_text().splitlines()))


STATUS = ["ok", "failed", "time_limit", "not_finite", "exception", "stopped"]


def journal_of(file):
    """The records of a journal (rodwake/store/journal.hpp), the key first: layout and content. The last may not be whole."""
    data, at, records = file.read_bytes(), 16, []
    while at + 24 <= len(data):
        length, layout = struct.unpack_from("<QI", data, at)
        if at + 24 + length > len(data):
            break
        records.append((layout, data[at + 16:at + 16 + length]))
        at += 24 + length
    return records


class LedgerFile:
    """`records`: the points of each record, as rows (id, axes, outcome, status, observables, retries, cause); `rows` and
    `brackets` by id: the last of each."""

    def __init__(self, file):
        (_, key), *records = journal_of(file)
        names = json.loads(key.decode().rpartition("\n")[2])
        self.outcomes, axes, observables = names["outcomes"], len(names["axes"]), len(names["observables"])
        point = struct.Struct(f"<q{axes + observables}ddii")
        self.rows, self.brackets, self.records = {}, {}, []

        def row(content, at, status="ok", cause=None):
            number, *values, _, outcome, retries = point.unpack_from(content, at)
            values = [None if math.isnan(value) else value for value in values]
            return (number, *values[:axes], self.outcomes[outcome] if outcome >= 0 else None, status, *values[axes:], retries, cause)

        for kind, content in records:
            points = []
            if kind == 1:
                points = [row(content, at) for at in range(0, len(content), point.size)]
            elif kind == 2:
                status, = struct.unpack_from("<i", content, point.size)
                points = [row(content, 0, STATUS[status], content[point.size + 20:].decode())]
            elif kind == 3:
                self.brackets |= {one[0]: one for one in struct.iter_unpack("<qiidd", content[16:])}
            elif kind == 4:
                for number, in struct.iter_unpack("<q", content[16:]):
                    self.rows.pop(number, None)
            elif kind == 5:
                self.rows = {number: one for number, one in self.rows.items() if one[axes + 2] == "ok"}
                self.brackets = {number: one for number, one in self.brackets.items() if min(one[1:3]) >= 0}
            self.records.append(points)
            self.rows |= {one[0]: one for one in points}


class ScanTest(ProgramTest):
    """A current folder with scan.toml and grid.toml in it."""

    def setUp(self):
        super().setUp()
        self.write("scan.toml", ADAPTIVE)
        self.write("grid.toml", GRID)

    def scan(self, scene, run, *arguments, code=0):
        return self.expect(code, "scan", scene, "-o", run, *arguments)

    def refuse_scan(self, pattern, scene, run, *arguments, code=2):
        return self.refuse(code, pattern, "scan", scene, "-o", run, *arguments)

    def rows(self, run, name="scan.csv"):
        return rows_of(self.folder / run / name)

    def is_finished(self, run):
        return (self.folder / run / "provenance.json").exists() and self.status(run) == "finished"

    def json(self, run):
        return json.loads((self.folder / run / "scan.json").read_text())

    def results(self, run):
        """The tables by name, as bytes."""
        return {name: (self.folder / run / name).read_bytes() for name in RESULTS if (self.folder / run / name).exists()}

    def ledger(self, run):
        """Rows of points and brackets in order; without the seconds they took."""
        ledger = LedgerFile(self.folder / run / "points.log")
        return [row for _, row in sorted(ledger.rows.items())], [one for _, one in sorted(ledger.brackets.items())]

    def points(self, run):
        """In the ledger; 0 before there is one."""
        file = self.folder / run / "points.log"
        return len(self.ledger(run)[0]) if file.exists() and file.stat().st_size > 0 else 0

    def assert_same(self, one, other):
        """Tables to the byte, the ledger row by row, every dataset."""
        self.assertIn("scan.csv", self.results(one))
        self.assertEqual(self.results(one), self.results(other))
        self.assertEqual(self.ledger(one), self.ledger(other))
        self.assertEqual(content(self.folder / one / "scan.h5"), content(self.folder / other / "scan.h5"))


class StoppedScanTest(ScanTest):
    """Scans that are stopped at random moments end as those that are not. The moments: RODWAKE_TEST_SEED."""

    SETTINGS = ("-j", "2", "--quiet")

    def setUp(self):
        super().setUp()
        started = time.monotonic()
        self.scan("scan.toml", "whole", *self.SETTINGS)
        self.seconds = time.monotonic() - started
        self.random = random.Random(os.environ.get("RODWAKE_TEST_SEED", "1"))

    def finish_after(self, run, stops, signals, longest):
        """Stops the scan so many times, each at a random moment up to `longest` s after its start; then lets it end. How
        often it was stopped: it may end before the last one."""
        stopped = 0
        for _ in range(stops):
            arguments = ("scan", "scan.toml", "-o", run, *self.SETTINGS)
            stopped += self.interrupt(self.random.choice(signals), self.random.uniform(0.0, longest), *arguments)
            if self.is_finished(run):
                break
        if not self.is_finished(run):
            self.scan("scan.toml", run, *self.SETTINGS)
        self.assert_same(run, "whole")
        self.assert_no_temporaries()
        return stopped

    def finish_often(self, stops, *chain):
        """finish_after() in folders of their own until there were so many stops. Twice out of three a scan may end before
        its stop: it does not always take the time that the first one took."""
        stopped = runs = 0
        while stopped < stops:
            self.assertLess(runs, 3 * stops + 10, f"only {stopped} of {runs} scans were stopped")
            stopped += self.finish_after("run", *chain)
            shutil.rmtree(self.folder / "run")
            runs += 1


KILL = (signal.SIGKILL,)
ANY = (signal.SIGKILL, signal.SIGTERM, signal.SIGINT)
