"""Runs the scenes of the rows, each once, and keeps what is done: the same command goes on where it was stopped."""

import hashlib
import json
import re
import shlex
import signal
import subprocess
import sys
import tempfile
import time
import tomllib
from pathlib import Path

SOURCE = Path(__file__).resolve().parents[2]
INTERRUPTED = (130, 143)


class Failure(Exception):
    """A run that ended without a result."""


class Lab:
    def __init__(self, program, folder, threads, quick):
        self.program, self.runs, self.threads, self.quick = Path(program), Path(folder) / "runs", threads, quick
        self.failed = {}  # name: reason

    def settings(self, run, quick):
        return (*run.settings, *(run.quick if quick else ()))

    def scene(self, run):
        inside = SOURCE / "scenes" / run.scene
        return inside if inside.is_file() else SOURCE / run.scene

    def name(self, run, quick):
        return f"{run.name}.quick" if quick and run.quick else run.name

    def command(self, run, quick, *extra):
        """As a reader types it, from the top of the source tree."""
        scene = self.scene(run).relative_to(SOURCE)
        return ["rodwake", "run", str(scene), *(part for s in self.settings(run, quick) for part in ("-s", s)), *extra]

    def asked(self, run, quick):
        """Of what the results are: the scene and its settings."""
        text = self.scene(run).read_bytes() + json.dumps(self.settings(run, quick)).encode()
        return hashlib.sha256(text).hexdigest()

    def label(self, run, quick):
        return self.runs / f"{self.name(run, quick)}.asked"

    def is_asked(self, run, quick):
        label = self.label(run, quick)
        return label.is_file() and label.read_text() == self.asked(run, quick)

    def is_done(self, run, quick):
        provenance = self.runs / self.name(run, quick) / "provenance.json"
        return self.is_asked(run, quick) and provenance.is_file() and json.loads(provenance.read_text())["status"] == "finished"

    def is_drawn(self, run, quick):
        """A run that was stopped while its figures were drawn is finished without them."""
        named = tomllib.loads(self.scene(run).read_text(encoding="utf-8")).get("figures", [])
        return all((self.runs / self.name(run, quick) / "figures" / f"{figure['name']}.png").is_file() for figure in named)

    def found(self, run):
        """(folder, whether quick) of the best result there is; None."""
        for quick in (False, True) if run.quick is not None else (False,):
            if self.is_done(run, quick):
                return self.runs / self.name(run, quick), quick
        return None

    def open(self, runs):
        """What is not done of these runs, each once."""
        left = {run.name: run for run in runs if not (self.quick and run.quick is None)}
        return [run for run in left.values() if not any(self.is_done(run, quick) and self.is_drawn(run, quick) for quick in {False, self.quick})]

    def make(self, run):
        self.runs.mkdir(parents=True, exist_ok=True)
        name, began = self.name(run, self.quick), time.monotonic()
        arguments = self.arguments(run, self.runs / name)
        code, errors, stopped = wait_for([str(self.program), *arguments])
        if code not in (0, 3, *INTERRUPTED):
            if arguments[0] == "run":  # what lies there may be of other settings
                self.label(run, self.quick).unlink()
            self.failed[run.name] = (errors.strip().splitlines() or [f"exit code {code}"])[-1]
        print(f"  {name}: {time.monotonic() - began:.0f} s{' FAILED: ' + self.failed[run.name] if run.name in self.failed else ''}", flush=True)
        if stopped or code in INTERRUPTED:
            sys.exit(code if code in INTERRUPTED else INTERRUPTED[0])

    def arguments(self, run, folder):
        if self.is_done(run, self.quick):
            return ["plot", str(folder)]
        fresh = () if self.is_asked(run, self.quick) else ("--force",)  # other settings, or none known: begin anew
        self.label(run, self.quick).write_text(self.asked(run, self.quick))
        return self.command(run, self.quick, "-o", str(folder), "-j", str(self.threads), "--quiet", *fresh)[1:]

    def cost(self, run):
        """CPU seconds that `rodwake check` expects, at most; None where it does not say."""
        command = [str(self.program), "check", str(self.scene(run)), *self.command(run, self.quick)[3:]]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        if done.returncode != 0:
            raise Failure(f"{shlex.join(command)}: {done.stderr.strip()}")
        return expected_seconds(done.stdout)


def wait_for(command):
    """(exit code, errors, whether Ctrl-C was pressed). Ctrl-C is handed on and waited for: the program writes its checkpoint."""
    stopped = False
    with (tempfile.TemporaryFile("w+") as errors,
          subprocess.Popen(command, cwd=SOURCE, stdout=subprocess.DEVNULL, stderr=errors, start_new_session=True) as process):
        while process.returncode is None:
            try:
                process.wait()
            except KeyboardInterrupt:
                stopped = True
                process.send_signal(signal.SIGINT)
        errors.seek(0)
        return process.returncode, errors.read(), stopped


NUMBER = r"(\d[\d.]*(?:e[+-]?\d+)?)"
UNITS = {"us": 1e-6, "ms": 1e-3, "s": 1.0, "CPU seconds": 1.0, "seconds": 1.0, "min": 60.0, "h": 3600.0, "hours": 3600.0}
SUMS = (rf"{NUMBER} in all", rf"{NUMBER} for all \d+ beds", rf"{NUMBER}( ms| us| s|) for \d+ runs", rf"about {NUMBER} (CPU seconds|seconds|us|ms|s|min|h|hours)\b")


def expected_seconds(text):
    """The sum over the stages under "# expected cost"; the first pattern that a stage's line holds is its sum."""
    _, _, part = text.partition("# expected cost")
    found = [of_stage(line) for line in part.splitlines() if re.match(r"  \S.*: ", line)]
    known = [seconds for seconds in found if seconds is not None]
    return sum(known) if known else None


def of_stage(line):
    for pattern in SUMS:
        if match := re.search(pattern, line):
            unit = match[2].strip() if match.lastindex > 1 else ""
            return float(match[1]) * UNITS.get(unit, 1.0)
    return None


def announce(lab, runs):
    """Says what will run and how long it takes, from `rodwake check`, before anything runs."""
    if not runs:
        print("every run is done", flush=True)
        return
    beds = [run for run in runs if "[granular]" in lab.scene(run).read_text(encoding="utf-8")]
    print(f"{len(runs)} runs to make, {len(runs) - len(beds)} of the theory, some seconds each with their figures; asking rodwake check what\n"
          f"the {len(beds)} beds cost ...", flush=True)
    costs = {run.name: lab.cost(run) for run in beds}
    for name, seconds in costs.items():
        print(f"  {name:24} {'?' if seconds is None else in_words(seconds)}", flush=True)
    total = sum(seconds or 0.0 for seconds in costs.values())
    print(f"at most {in_words(total)} of CPU, {in_words(total / lab.threads)} on {lab.threads} threads, figures not counted: pairs stop when\n"
          "they have gone half a box. Ctrl-C stops; the same command goes on.", flush=True)


def in_words(seconds):
    return f"{seconds:.0f} s" if seconds < 100 else f"{seconds / 60:.0f} min" if seconds < 5400 else f"{seconds / 3600:.1f} h"
