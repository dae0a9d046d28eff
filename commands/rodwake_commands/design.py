"""rodwake design: rank candidate experiments by how well they would discriminate between the models of a fit, before any is done.

For each design every model of the scene in turn makes sets of tracks, which all models weigh (DesignModels of the bindings says how), all
equally probable beforehand. The expected information on which model it is, in bits, is log2(models) + <log2 p(true model | tracks)>: the
mutual information of model and tracks.
"""

import csv
import itertools
import json
import math
import os
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from rodwake import InputError, _core

from .files import number, refuse_present, write_atomically

MOST_RUNS = 10000


@dataclass(frozen=True)
class Weighed:
    settings: list       # "key=value"
    runs: int
    information: float   # bits
    error: float         # its standard error
    right: float         # share of sets in which the true model has the largest evidence
    log_bayes: np.ndarray  # [by, other]: mean logarithm of the evidence of the model that made the tracks over that of the other one

    @property
    def least_log_bayes(self):
        return float(np.min(self.log_bayes[~np.eye(len(self.log_bayes), dtype=bool)]))


def combinations(vary):
    """Settings of all designs of --vary key=1,2,3."""
    choices = []
    for text in vary:
        key, _, values = text.partition("=")
        if not key or not values:
            raise InputError(f"--vary {text}: expected key=values, for example rods.1.position.1=1.5,2,3")
        choices.append([f"{key}={value}" for value in values.split(",")])
    return [list(settings) for settings in itertools.product(*choices)]


def rows_of_list(file):
    """Settings of all designs of --list: keys in the first row, a design in each other one."""
    try:
        lines = file.read_text(encoding="utf-8", errors="replace").splitlines()
    except OSError as error:
        raise InputError(f"{file}: cannot read the file: {error.strerror}") from error
    rows = [(k, next(csv.reader([line]))) for k, line in enumerate(lines, 1) if line.strip() and not line.startswith("#")]
    designs, keys = [], [key.strip() for key in rows[0][1]] if rows else []
    for line, cells in rows[1:]:
        if len(cells) != len(keys):
            raise InputError(f"{file}:{line}: {len(cells)} values for {len(keys)} keys")
        designs.append([])
        for key, cell in zip(keys, cells):
            try:
                designs[-1].append(f"{key}={number(cell)}")
            except ValueError as error:
                raise InputError(f'{file}:{line}: {key}: expected a number, found "{cell}"') from error
    if not designs:
        raise InputError(f"{file}: holds no design")
    return designs


def numbers_of_runs(text):
    numbers = []
    for word in text.split(","):
        if not (word.isascii() and word.isdigit() and 1 <= int(word) <= MOST_RUNS):
            raise InputError(f"--runs: {word} is not a whole number from 1 to {MOST_RUNS}")
        numbers.append(int(word))
    return numbers


def weigh(designs, sets, seed, threads, show):
    """Of (settings, runs, models) of each design what is expected of it."""
    count = len(designs[0][2].names())
    jobs = [(models, by, k) for _, _, models in designs for by in range(count) for k in range(sets)]
    logs = []
    with ThreadPoolExecutor(threads) as pool:
        try:
            for found in [pool.submit(models.log_evidence, by, seed, k) for models, by, k in jobs]:
                logs.append(found.result())
                if show and sys.stderr.isatty():
                    print(f"\rdesign: {len(logs)} of {len(jobs)} sets", end="\n" if len(logs) == len(jobs) else "", file=sys.stderr, flush=True)
        except BaseException:  # an error or Ctrl-C: what has begun ends, and nothing else begins
            pool.shutdown(cancel_futures=True)
            raise

    weighed = []
    for (settings, runs, _), found in zip(designs, np.reshape(logs, (len(designs), count, sets, count))):
        with np.errstate(invalid="ignore"):
            most = found.max(axis=2)
            true = np.stack([found[by, :, by] for by in range(count)])
            bits = math.log2(count) + (true - most - np.log(np.exp(found - most[..., None]).sum(axis=2))) / math.log(2.0)
            log_bayes = np.mean(true[..., None] - found, axis=1)
        information = float(bits.mean())
        error = math.sqrt(max(0.0, float(np.mean(bits**2)) - information**2) / (bits.size - 1))
        weighed.append(Weighed(settings, runs, information, error, float(np.mean(true == most)), log_bayes))
    return weighed


def write(folder, names, weighed, sets, command):
    """design.json, and design.csv with a row for each design."""
    def known(x):
        return float(x) if math.isfinite(x) else None

    rows, members = [], []
    for design in weighed:
        settings = dict(setting.split("=", 1) for setting in design.settings)
        values = {"runs": float(design.runs), "information": design.information, "information_stderr": design.error, "right": design.right,
                  "least_log_bayes": design.least_log_bayes}
        pairs = {by: {other: known(design.log_bayes[i, j]) for j, other in enumerate(names) if j != i} for i, by in enumerate(names)}
        members.append({"settings": settings, **{name: known(value) for name, value in values.items()}, "log_bayes": pairs})
        rows += [[*settings, *values]] if not rows else []
        rows.append([*settings.values(), *("" if math.isnan(value) else number(value) for value in values.values())])
    best = max(range(len(weighed)), key=lambda k: weighed[k].information)
    written = {"models": names, "sets": sets, "designs": members, "best": best,
               "provenance": {"command": command, "version": _core.version, "git": _core.git}}
    write_atomically(folder / "design.csv", "".join(",".join(row) + "\n" for row in rows))
    write_atomically(folder / "design.json", json.dumps(written, indent=2, ensure_ascii=False) + "\n")


def print_table(names, weighed):
    print(f"information on {', '.join(names)}, of {math.log2(len(names)):.3g} bits:\n"
          f"{'bits':>14}  {'wins':>7}  {'log Bayes, least':>13}  {'runs':>4}  design")
    for design in sorted(weighed, key=lambda design: -design.information):
        bits = f"{design.information:.2f} +- {design.error:.2f}"
        print(f"{bits:>14}  {100.0 * design.right:>5.0f} %  {design.least_log_bayes:>16.3g}  {design.runs:>4}  {' '.join(design.settings)}")


def main(request):
    folder, sets, dry_run = request.folder(), request.whole("sets", 20), request.flag("dry_run")
    scene = _core.read_scene(request.text("target"), request.all("set"))
    if not request.flag("force") and not dry_run:
        refuse_present(folder / "design.json")
    all_settings = rows_of_list(Path(request.text("list"))) if request.text("list") else combinations(request.all("vary"))
    numbers = numbers_of_runs(request.text("runs", "1"))
    of_scene = _core.DesignModels(scene, [], 1)
    names, seed = of_scene.names(), request.whole("seed", of_scene.seed_of_scene())
    designs = [(settings, runs, _core.DesignModels(scene, settings, runs)) for settings in all_settings for runs in numbers]

    # A dry run weighs one set, so that it refuses what would be refused.
    threads = request.whole("threads", len(os.sched_getaffinity(0)))
    weighed = weigh(designs, 1 if dry_run else sets, seed, threads, not request.flag("quiet"))
    if dry_run:
        print(f"{len(designs)} designs would be evaluated, {sets} sets of tracks for each of {', '.join(names)}, results in {folder}")
        return 0
    write(folder, names, weighed, sets, request.text("command"))
    plotted = subprocess.run([request.program, "plot", str(folder), "--quiet"], check=False).returncode
    if plotted == 0 and not request.flag("quiet"):
        print_table(names, weighed)
    return plotted
