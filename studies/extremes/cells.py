"""Runs the program on extreme cells, says how each ended, and counts them by group; and the ranges that keys are drawn from."""

import math
import os
import re
import subprocess
import time
from collections import Counter, defaultdict
from dataclasses import asdict, dataclass

import lab
from lab import keep_line, kept_lines, write_csv

# What a cell is, the worst last:
#   good       an answer, within its bound where there is a reference
#   reported   no answer, and the program says why: a refusal, a solver's failure, a time limit that was set
#   differs    an answer outside its bound
#   bad        NaN, no named status, a crash, or the time of the cell exceeded
VERDICTS = ("good", "reported", "differs", "bad")

# How a run names its end on standard error: a refusal says where, a run that stopped which failure.
REFUSAL = re.compile(r"(?m)^rodwake: ([^ ]+\.(toml|csv)|-s [\w.]+=|standard input|box = \S+: more than|fit: \d+ data points)")
STOPS = {re.compile(r"\(((?:CV|ARK|ERK|IDA)_\w+|COLLISION)[,)]"): "",
         re.compile(r"overlap|(flew .* into|deep in) a plate"): "time step too large"}
NOT_FINITE = re.compile(r"(?i)(?<![a-z_])[-+]?(nan|inf|infinity)(?![a-z_])")


@dataclass
class Cell:
    group: str
    name: str
    status: str
    verdict: str
    seconds: float = 0.0
    error: float = None    # over what was asked, where there is a reference
    note: str = ""


@dataclass
class Ended:
    """A process that ended, or was ended (code None)."""
    code: int
    seconds: float
    stdout: str
    stderr: str

    def refused(self):
        """The status of a run without results, and its verdict."""
        if self.code is None:
            return "timeout", "bad"
        text = self.stderr.strip()
        if self.code == 2 and REFUSAL.search(text):
            return "refused", "reported"
        for stop, name in STOPS.items() if self.code == 1 else ():
            if found := stop.search(text):
                return name or found.group(1), "reported"
        return f"unnamed: exit code {self.code}, {text[-200:]}", "bad"


class Lab(lab.Lab):
    """A folder for runs, and the cells so far. What a folder holds of an earlier, interrupted run is not done again."""

    def __init__(self, program, folder, seed, quick):
        super().__init__(program, folder, quick=quick)
        self.seed, self.log = seed, self.folder / f"cells_{'quick_' if quick else ''}{seed}.jsonl"
        entries = kept_lines(self.log)
        self.done = {entry["batch"] for entry in entries}
        self.cells = [Cell(**cell) for entry in entries for cell in entry["cells"]]

    def batch(self, name, make):
        """The cells of `make()`, unless an earlier run left them."""
        if name in self.done:
            return
        cells = list(make())
        keep_line(self.log, {"batch": name, "cells": [asdict(cell) for cell in cells]})
        self.done.add(name)
        self.cells += cells

    def run(self, *arguments, limit, text=None):
        started = time.monotonic()
        environment = {**os.environ, "XDG_CACHE_HOME": str(self.folder / "cache")}
        try:
            done = self.call(*arguments, good=(), input=text, timeout=limit, env=environment)
        except subprocess.TimeoutExpired:
            return Ended(None, time.monotonic() - started, "", "")
        return Ended(done.returncode, time.monotonic() - started, done.stdout, done.stderr)

    def text(self, *parts):
        return self.folder.joinpath(*parts).read_text(encoding="utf-8")


def not_finite(text):
    """The first NaN or infinity that stands in a result file."""
    found = NOT_FINITE.search(text)
    return text[max(0, found.start() - 40):found.end() + 20].strip() if found else None


# Ranges.


def log_uniform(random_, low, high):
    return math.exp(random_.uniform(math.log(low), math.log(high)))


def either_sign(random_, low, high):
    return random_.choice((-1.0, 1.0)) * log_uniform(random_, low, high)


def coupling(random_):
    """kappa or a gamma: 1e-6 to 1e8 of either sign; one in four 0."""
    return 0.0 if random_.random() < 0.25 else either_sign(random_, 1e-6, 1e8)


def random_eta(random_):
    """1e-6 to 1e6, and (-1, 0): near both of its ends."""
    if random_.random() < 0.7:
        return log_uniform(random_, 1e-6, 1e6)
    near = log_uniform(random_, 1e-6, 0.5)
    return random_.choice((-near, near - 1.0))


# The table.


def summary(cells):
    """Of each group: counts by verdict and status, and the largest and median error over its bound."""
    groups = defaultdict(list)
    for cell in cells:
        groups[cell.group].append(cell)
    found = {}
    for name, members in sorted(groups.items()):
        errors = sorted(cell.error for cell in members if cell.error is not None)
        found[name] = {"cells": len(members), **{verdict: sum(cell.verdict == verdict for cell in members) for verdict in VERDICTS},
                       "statuses": dict(Counter(cell.status for cell in members).most_common()), "compared": len(errors),
                       "median_error": errors[len(errors) // 2] if errors else None, "largest_error": errors[-1] if errors else None,
                       "longest": max(cell.seconds for cell in members)}
    return found


def markdown(found):
    lines = []
    for name, row in found.items():
        statuses = ", ".join(f"{status} {count}" for status, count in row["statuses"].items())
        errors = f"{row['median_error']:.1g}, {row['largest_error']:.1g}" if row["compared"] else ""
        lines.append([name, *(row[key] for key in ("cells", *VERDICTS)), statuses, row["compared"] or "", errors])
    return lab.markdown(["group", "cells", *VERDICTS, "statuses", "compared", "error: median, largest"], lines) + "\n"


def write_cells(path, cells):
    write_csv(path, [asdict(cell) | {"seconds": f"{cell.seconds:.4f}"} for cell in cells])
