#!/usr/bin/python3
"""Where in (kappa, eta) stable orbits exist: writes studies/orbits.csv. kappa alone, lengths times alpha (similarity).

    PYTHONPATH=build/release/python studies/orbits.py

A row for each stretch of a branch over kappa , |kappa| from 15 to 1000, along which the orbit is stable. Of its two ends: kappa, the separation times alpha,
and what is there: `fold`, where it merges with an unstable orbit; `hopf`, where a pair of complex eigenvalues crosses (interpolated between
rows, 1e-3); `contact`, separation 0.001 xi, the smallest that is looked at; `range`. kappa_0.1, kappa_0.01: where separation times alpha is that.
Some 30 s.
"""

import csv
from pathlib import Path

import numpy as np

import rodwake

ETAS = (0.1, 0.2, 0.5, 0.6, 0.7, 0.8, 1.0, 2.0, 3.0, 5.0, 7.0, 10.0, 15.0, 20.0, 50.0)
RANGES = ((-1000.0, -15.0), (15.0, 1000.0))
COLUMNS = ("eta", "kappa_from", "separation_from", "end_from", "kappa_to", "separation_to", "end_to", "kappa_0.1", "kappa_0.01")


def stretches(branch):
    """First and last row of each, one more at either side where the branch changes its stability there."""
    stable = np.append(False, np.append(branch.growth < -1e-9, False)).astype(int)
    return zip(np.nonzero(np.diff(stable) == 1)[0], np.nonzero(np.diff(stable) == -1)[0] - 1)


def end(branch, row, onward):
    """kappa, separation and kind of the end at this row, `onward` the step out of the stretch."""
    beyond = row + onward
    if not 0 <= beyond < len(branch.parameter):
        near = branch.separation[row] < 0.00101
        return branch.parameter[row], branch.separation[row], "contact" if near else branch.ends[0 if onward < 0 else 1]
    if beyond in branch.folds:
        return branch.parameter[beyond], branch.separation[beyond], "fold"
    inside, outside = branch.growth[row], branch.growth[beyond]
    part = inside / (inside - outside)
    kind = "hopf" if branch.equilibria[beyond].eigenvalues[0].imag else "opposite"
    return tuple(values[row] + part * (values[beyond] - values[row]) for values in (branch.parameter, branch.separation)) + (kind,)


def kappa_at(eta, separation, kappas, separations):
    """By the secant method on the orbit's separation, from the rows of its branch, which is monotonic there."""
    order = np.argsort(separations)
    if not separations[order[0]] < separation < separations[order[-1]]:
        return None
    low, kappa = (np.interp(np.log(separation * by), np.log(separations[order]), kappas[order]) for by in (1.02, 1.0))

    def off(value):
        orbits = [np.log(e.separation / separation) for e in rodwake.pair_equilibria(rodwake.Medium(eta=eta), kappa=value) if e.kind == "orbit"]
        return min(orbits, key=abs)

    before = off(low)
    for _ in range(6):
        here = off(kappa)
        if abs(here) < 1e-10 or here == before:
            break
        low, before, kappa = kappa, here, kappa - here * (kappa - low) / (here - before)
    return kappa


def rows():
    for eta in ETAS:
        for branch in (branch for span in RANGES for branch in rodwake.pair_branches(rodwake.Medium(eta=eta), "kappa", *span)):
            for first, last in stretches(branch):
                part = slice(first, last + 1)
                contacts = [kappa_at(eta, at, branch.parameter[part], branch.separation[part]) for at in (0.1, 0.01)]
                yield eta, *end(branch, first, -1), *end(branch, last, 1), *contacts


def plain(value):
    return "" if value is None else value if isinstance(value, str) else f"{value:.10g}"


if __name__ == "__main__":
    with open(Path(__file__).with_suffix(".csv"), "w", newline="") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow(COLUMNS)
        for row in rows():
            table.writerow([plain(value) for value in row])
            print(*(plain(value) for value in row))
