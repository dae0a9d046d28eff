"""Cells of pairs: random extremes of every key through `rodwake scan`, by each method and form and by the batch.

A sheet is one medium, tolerance, duration, contact distance and offset of the origin, with POINTS pairs in it. Each
setting runs the sheet; two tight runs by different methods are the reference where they agree.
"""

import csv
import io
import math
import random

from .lab import Cell, not_finite
from .ranges import coupling, log_uniform, random_eta

POINTS = 20
LIMIT = 0.12    # s a point: scan.time_limit; above what a pair of a batch may take, or there would be no batch
KEYS = ("coupling.kappa", "coupling.gamma1", "coupling.gamma2", "rods.1.position.0", "rods.1.position.1", "rods.1.heading")
SETTINGS = {"batch": ("auto", "angle"), "bdf": ("bdf", "angle"), "adams": ("adams", "angle"), "erk": ("erk", "angle"),
            "director, bdf": ("bdf", "director"), "director, erk": ("erk", "director"), "dae": ("bdf", "dae")}
REFERENCES = (("erk", "angle"), ("bdf", "angle"))
OUTCOMES = ("contact", "pursuit", "escape", "undecided")
STATUSES = ("failed", "time_limit", "exception")
# Tolerances within which times and separations of a good cell agree with the reference: local errors add up along a run.
# docs/validation_rods.md, "Trajectories": at most 83 on the reference trajectories.
BOUND = 100.0

SCENE = """schema = 1
[medium]
eta = 1.0
alpha = 1.0
[coupling]
kappa = 1.0
gamma1 = 1.0
gamma2 = 1.0
[[rods]]
position = [0.0, 0.0]
heading = 0.5
[[rods]]
position = [0.0, -4.0]
[rods_run]
t_end = 1.0
max_steps = 100000
[scan]
design = "list"
file = "points.csv"
trajectories = 0
"""


class Sheet:
    def __init__(self, random_, moderate):
        """`moderate`: rates and times for which a solver has a chance to follow every turn."""
        self.origin = random_.choice((0.0, 0.0, 1.0, 1e3, 1e6, 1e9))
        self.eta, self.alpha = random_eta(random_), log_uniform(random_, 1e-4, 1e4)
        self.rtol = log_uniform(random_, 1e-12, 1e-3) if moderate else log_uniform(random_, 1e-13, 1e-2)
        self.t_end = log_uniform(random_, 0.1, 100.0) if moderate else log_uniform(random_, 1e-9, 1e9)
        self.contact = random_.choice((None, 1e-9, 1e-3, 0.1))
        self.rows = [self.pair(random_, moderate) for _ in range(POINTS)]

    def pair(self, random_, moderate):
        distance = log_uniform(random_, 0.2, 20.0) if moderate else log_uniform(random_, 1e-8, 1e6)
        angle = random_.uniform(-math.pi, math.pi)
        turning = [random_.uniform(-3.0, 3.0) for _ in range(3)] if moderate else [coupling(random_) for _ in range(3)]
        return (*turning, self.origin + distance * math.cos(angle), self.origin + distance * math.sin(angle), random_.uniform(-4.0, 4.0))

    def settings(self, method, form, rtol):
        keys = {"medium.eta": self.eta, "medium.alpha": self.alpha, "rods_run.rtol": rtol, "rods_run.t_end": self.t_end,
                "rods.0.position.0": self.origin, "rods.0.position.1": self.origin, "rods_run.method": method, "rods_run.form": form,
                "scan.time_limit": LIMIT}
        if self.contact:
            keys["rods_run.contact_distance"] = self.contact
        return [f"-s{key}={value!r}" if isinstance(value, float) else f"-s{key}={value}" for key, value in keys.items()]

    def __str__(self):
        return (f"eta={self.eta!r} alpha={self.alpha!r} rtol={self.rtol!r} t_end={self.t_end!r} contact={self.contact} "
                f"origin={self.origin!r}")


def scanned(lab, sheet, method, form, rtol):
    """The process and its rows, none if it was refused."""
    lab.write("sheet.toml", SCENE)
    lab.write("points.csv", ",".join(KEYS) + "\n" + "".join(",".join(map(repr, row)) + "\n" for row in sheet.rows))
    done = lab.run("scan", "sheet.toml", "-o", "sheet", "--force", "--quiet", "-j", "1", *sheet.settings(method, form, rtol),
                   limit=POINTS * 4 * LIMIT + 10.0)
    return done, list(csv.DictReader(io.StringIO(lab.text("sheet", "scan.csv")))) if done.code in (0, 3) else []


def named(row):
    """Status and verdict of a row."""
    if not_finite(",".join(row.values())):
        return "not finite", "bad"
    if row["status"] == "ok":
        return (row["outcome"], "good") if row["outcome"] in OUTCOMES else (f"unnamed outcome: {row['outcome']}", "bad")
    return (row["status"], "told") if row["status"] in STATUSES else (f"unnamed status: {row['status']}", "bad")


def numbers(row):
    return [float(row[name]) for name in ("time", "final_separation", "min_separation")]


def difference(row, other):
    """Of two finished rows, over the size of what differs, at least 1: coordinates have no origin."""
    if row["outcome"] != other["outcome"]:
        return math.inf
    return max(abs(a - b) / max(1.0, abs(b)) for a, b in zip(numbers(row), numbers(other)))


def floor_of(sheet):
    """What rounding of coordinates leaves, over a few steps."""
    return 64.0 * 2.0**-52 * max(1.0, abs(sheet.origin) + min(sheet.t_end, 1e9))


def reference_rows(lab, sheet):
    """Tight runs by two methods; None where they are not both finished and alike to a tenth of the tolerance."""
    tight = max(1e-3 * sheet.rtol, 1e-13)
    runs = [scanned(lab, sheet, method, form, tight)[1] for method, form in REFERENCES]
    if not all(runs):
        return [None] * POINTS
    near = 0.1 * max(sheet.rtol, floor_of(sheet))
    return [one if one["status"] == other["status"] == "ok" and difference(one, other) <= near else None for one, other in zip(*runs)]


def cells_of(lab, group, sheet):
    wanted = reference_rows(lab, sheet)
    for name, (method, form) in SETTINGS.items():
        done, rows = scanned(lab, sheet, method, form, sheet.rtol)
        if len(rows) != POINTS:
            status, verdict = done.refused() if done.code not in (0, 3) else ("unnamed: rows missing", "bad")
            yield from (Cell(f"{group}: {name}", str(sheet), status, verdict, done.seconds) for _ in range(POINTS))
            continue
        for row, pair, want in zip(rows, sheet.rows, wanted):
            status, verdict = named(row)
            error = None
            if verdict == "good" and want:
                error = difference(row, want) / max(sheet.rtol, floor_of(sheet))
                verdict = "good" if error <= BOUND else "differs"
            where = " ".join(f"{key}={value!r}" for key, value in zip(KEYS, pair))
            yield Cell(f"{group}: {name}", f"{sheet} {where}", status, verdict, done.seconds / POINTS, error,
                       f"reference: {want['outcome']}" if verdict == "differs" else "")


def run(lab):
    for group, moderate, count in (("pairs, extremes", False, 1 if lab.quick else 30), ("pairs, moderate", True, 1 if lab.quick else 30)):
        for number in range(count):
            random_ = random.Random(f"{group} {lab.seed} {number}")
            sheet = Sheet(random_, moderate)
            lab.batch(f"{group} {number}", lambda: cells_of(lab, group, sheet))
