"""Runs the program on extreme cells and says how each ended."""

import json
import math
import os
import re
import subprocess
import time
from dataclasses import asdict, dataclass
from pathlib import Path

SOURCE = Path(__file__).resolve().parents[2]

# What a cell is, the worst last:
#   good       an answer, within its bound where there is a reference
#   told       no answer, and the program says why: a refusal, a solver's failure, a time limit that was set
#   differs    an answer outside its bound
#   bad        NaN, no named status, a crash, or the time of the cell exceeded
VERDICTS = ("good", "told", "differs", "bad")

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
            return "refused", "told"
        for stop, name in STOPS.items() if self.code == 1 else ():
            if found := stop.search(text):
                return name or found.group(1), "told"
        return f"unnamed: exit code {self.code}, {text[-200:]}", "bad"


class Lab:
    """A folder for runs, and the cells so far. What a folder holds of an earlier, interrupted run is not done again."""

    def __init__(self, program, folder, seed, quick):
        self.program, self.folder, self.seed, self.quick = str(program), Path(folder).resolve(), seed, quick
        self.folder.mkdir(parents=True, exist_ok=True)
        self.log = self.folder / f"cells_{'quick_' if quick else ''}{seed}.jsonl"
        self.cells, self.done = [], set()
        if self.log.exists():
            for line in self.log.read_text().splitlines():
                entry = json.loads(line)
                self.done.add(entry["batch"])
                self.cells += [Cell(**cell) for cell in entry["cells"]]

    def batch(self, name, make):
        """The cells of `make()`, unless an earlier run left them."""
        if name in self.done:
            return
        cells = list(make())
        with open(self.log, "a", encoding="utf-8") as file:
            file.write(json.dumps({"batch": name, "cells": [asdict(cell) for cell in cells]}) + "\n")
        self.done.add(name)
        self.cells += cells

    def run(self, *arguments, limit, text=None):
        started = time.monotonic()
        environment = {**os.environ, "XDG_CACHE_HOME": str(self.folder / "cache")}
        try:
            done = subprocess.run([self.program, *map(str, arguments)], cwd=self.folder, input=text, capture_output=True,
                                  text=True, errors="replace", timeout=limit, env=environment, check=False)
        except subprocess.TimeoutExpired:
            return Ended(None, time.monotonic() - started, "", "")
        return Ended(done.returncode, time.monotonic() - started, done.stdout, done.stderr)

    def write(self, name, text):
        (self.folder / name).write_text(text, encoding="utf-8")
        return name

    def text(self, *parts):
        return self.folder.joinpath(*parts).read_text(encoding="utf-8")


def not_finite(text):
    """The first NaN or infinity that stands in a result file."""
    found = NOT_FINITE.search(text)
    return text[max(0, found.start() - 40):found.end() + 20].strip() if found else None


def against(value, reference, scale):
    """|value - reference| over what was asked of it."""
    return abs(value - reference) / scale if math.isfinite(value) else math.inf
