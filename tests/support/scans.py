"""Scans of a pair that take a second, what must be equal of two scans, and scans that are stopped."""

import csv
import json
import math
import os
import random
import shutil
import signal
import sqlite3
import time

import numpy as np
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
           "final_separation", "final_angle", "steps", "rhs_evaluations", "certificate", "retries"]
RESULTS = ("scan.csv", "cells.csv", "boundary.csv")


def rows_of(file):
    return list(csv.DictReader(file.read_text().splitlines()))


def records_of(connection):
    """The layout of a ledger's records, and all of them."""
    layout = np.dtype([tuple(field) for field in
                       json.loads(connection.execute("SELECT value FROM meta WHERE key = 'record'").fetchone()[0])])
    chunks = [row[0] for row in connection.execute("SELECT data FROM chunks ORDER BY number")]
    return layout, np.frombuffer(b"".join(chunks), layout)


def plain_rows(connection):
    """The records as rows of the table of causes would be."""
    outcomes = connection.execute("SELECT value FROM meta WHERE key = 'outcomes'").fetchone()[0].split(",")
    axes = len([name for name in records_of(connection)[0].names if "." in name])
    rows = []
    for one in records_of(connection)[1].tolist():
        numbers = [None if math.isnan(value) else value for value in one[1:-3]]
        outcome = outcomes[one[-2]] if one[-2] >= 0 else None
        rows.append((one[0], *numbers[:axes], outcome, "ok", *numbers[axes:], one[-1], None))
    return rows


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
        connection = sqlite3.connect(self.folder / run / "ledger.sqlite")
        try:
            names = [row[1] for row in connection.execute("PRAGMA table_info(causes)")]
            kept = ", ".join(f'"{name}"' for name in names if name != "seconds")
            rows = connection.execute(f"SELECT {kept} FROM causes").fetchall() + plain_rows(connection)
            return sorted(rows, key=lambda row: row[0]), connection.execute("SELECT * FROM crossings ORDER BY id").fetchall()
        finally:
            connection.close()

    def seconds(self, run):
        """What each point took, by id."""
        connection = sqlite3.connect(self.folder / run / "ledger.sqlite")
        try:
            found = dict(connection.execute("SELECT id, seconds FROM causes"))
            _, records = records_of(connection)
            return found | dict(zip(records["id"].tolist(), records["seconds"].tolist()))
        finally:
            connection.close()

    def change_records(self, run, change):
        """`change` gets the array of each chunk."""
        connection = sqlite3.connect(self.folder / run / "ledger.sqlite")
        layout, _ = records_of(connection)
        for number, data in connection.execute("SELECT number, data FROM chunks").fetchall():
            records = np.frombuffer(data, layout).copy()
            change(records)
            connection.execute("UPDATE chunks SET data = ? WHERE number = ?", (records.tobytes(), number))
        connection.commit()
        connection.close()

    def points(self, run):
        """In the ledger; 0 before there is one."""
        try:
            return len(self.ledger(run)[0])
        except sqlite3.Error:
            return 0

    def change_ledger(self, run, sql):
        connection = sqlite3.connect(self.folder / run / "ledger.sqlite")
        connection.execute(sql)
        connection.commit()
        connection.close()

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
