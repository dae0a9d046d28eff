#!/usr/bin/python3
"""Validation of scans: the numbers of studies/reports/scan.md, "Scans", that come from whole scans.

    studies/validate_scan.py [--program build/release/rodwake] [--only memory,cells,large,stiff,maps] [-j 2] [--keep DIR]

Runs scenes of scenes/ with other settings and prints Markdown. --keep DIR keeps the results and takes up what is there. Times are of
whole commands, from the scene to the written files; take them on idle cores.
"""

import math
import resource
import sys
import time
from collections import Counter
from pathlib import Path

from lab import SOURCE, parser, rows, run_parts, table
from lab import read_json as file_of

PERPENDICULAR = "phase_perpendicular.toml"


def scan(lab, scene, name, *settings, traced=False):
    """The finished run directory, and the seconds that the command took; 0 of one that was there. Boundaries are bisected only
    if they are to be `traced`."""
    lines = (SOURCE / "scenes" / scene).read_text().splitlines()
    kept = [line for line in lines if traced or not line.startswith("boundary_tolerance")]
    started = time.monotonic()
    out = lab.make(name, "\n".join(kept) + "\n", *settings, verbs=("scan",), good=(0, 3))
    return out, time.monotonic() - started


def points(folder):
    return rows(folder / "scan.csv")


def summary(folder):
    return file_of(folder, "scan")


def grid(side):
    """The full lattice of an adaptive scan, as a grid."""
    return "scan.design=grid", f"scan.axes.0.count={side + 1}", f"scan.axes.1.count={side + 1}", "scan.trajectories=0"


def adaptive(side, start=64):
    return (f"scan.resolution={side}", f"scan.axes.0.count={start}", f"scan.axes.1.count={start}", "scan.trajectories=0")


def cell_of(value, axis):
    """The number of a value along an axis in 0 .. 1."""
    low, high = float(axis["from"]), float(axis["to"])
    return math.log(value / low) / math.log(high / low) if axis["spacing"] == "log" else (value - low) / (high - low)


class Cells:
    """The map that cells.csv draws: an outcome for each place of the lattice; mixed cells say nothing of theirs."""

    def __init__(self, folder, side):
        self.side, self.known = side, {}
        self.axes = summary(folder)["axes"]
        for row in rows(folder / "cells.csv"):
            ends = [self.range(row, axis) for axis in self.axes]
            for i in range(ends[0][0], ends[0][1] + 1):
                for j in range(ends[1][0], ends[1][1] + 1):
                    if row["outcome"] != "mixed":
                        self.known[i, j] = row["outcome"]

    def number(self, value, axis):
        return round(self.side * cell_of(float(value), axis))

    def range(self, row, axis):
        return [self.number(row[axis["key"] + end], axis) for end in ("_from", "_to")]

    def of(self, row):
        return self.known.get(tuple(self.number(row[axis["key"]], axis) for axis in self.axes))


def cells(lab):
    """Every point of the full lattice against the cells of the adaptive scan of the same lattice."""
    side, lines = 256, []
    for scene in (PERPENDICULAR, "phase_parallel.toml", "phase_gamma_zero.toml"):
        full, _ = scan(lab, scene, f"full_{Path(scene).stem}", *grid(side))
        few, _ = scan(lab, scene, f"few_{Path(scene).stem}", *adaptive(side))
        drawn, every = Cells(few, side), points(full)
        uniform = [(row, drawn.of(row)) for row in every]
        differ = sum(outcome not in (None, row["outcome"]) for row, outcome in uniform)
        lines.append((scene, len(every), summary(few)["evaluated"], f"{len(every) / summary(few)['evaluated']:.1f}",
                      sum(outcome is not None for _, outcome in uniform), differ, rate(few)))
    table(f"Adaptive against the full lattice, {side} cells a side",
          ("scene", "points", "evaluated", "fewer", "places in uniform cells", "of another outcome", "audit: missed, at most (95 %)"), lines)


def rate(folder):
    found = summary(folder)
    return f"{found['missed']} of {found['audited']}, {100 * found['missed_rate_high']:.2g} %"


def large(lab):
    """1024 cells a side. rtol 1e-6 as in scans of old; the boundary is traced too."""
    common = ("rods_run.rtol=1e-6",)
    full, of_full = scan(lab, PERPENDICULAR, "large_full", *grid(1024), *common)
    few, of_few = scan(lab, PERPENDICULAR, "large_few", *adaptive(1024), *common)
    traced, of_traced = scan(lab, PERPENDICULAR, "large_traced", *adaptive(1024), *common, traced=True)
    table("1024 cells a side", ("design", "points", "seconds", "audit"),
          [("full grid", summary(full)["evaluated"], f"{of_full:.1f}", ""), ("adaptive", summary(few)["evaluated"], f"{of_few:.1f}", rate(few)),
           ("adaptive, boundary to 1e-8", summary(traced)["evaluated"], f"{of_traced:.1f}", rate(traced))])
    drawn = Cells(few, 1024)
    differ = sum(drawn.of(row) not in (None, row["outcome"]) for row in points(full))
    print(f"\nPlaces in uniform cells with another outcome in the full grid: {differ}")


def memory(lab):
    """10^6 points that cost next to nothing: encounters that end at once. First, since a child begins with its parent's memory."""
    out, seconds = scan(lab, PERPENDICULAR, "memory", *grid(999), "rods_run.t_end=1e-3")
    peak = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss / 1024.0
    print(f"\n10^6 points that end at t = 0.001: {summary(out)['evaluated']} points in {seconds:.1f} s, "
          f"{1e6 * seconds / summary(out)['evaluated']:.2f} us a point with tables; largest memory of all scans so far {peak:.0f} MB")


def stiff(lab):
    """The stiff end again at a tenth of the tolerance, on the points of a grid."""
    lines = []
    for scene in ("phase_stiff_attract.toml", "phase_stiff_repel.toml"):
        settings = (*grid(64), "scan.audit=0")
        once, _ = scan(lab, scene, f"once_{Path(scene).stem}", *settings)
        tight, _ = scan(lab, scene, f"tight_{Path(scene).stem}", *settings, "rods_run.rtol=1e-8")
        first, second = points(once), points(tight)
        outcomes = [row["outcome"] for row in first]
        changed = [k for k, (a, b) in enumerate(zip(first, second)) if (a["outcome"], a["status"]) != (b["outcome"], b["status"])]
        inside = [k for k in changed if not at_boundary(outcomes, k, 65)]
        for k in inside:
            place = tuple(first[k][axis["key"]] for axis in summary(once)["axes"])
            print(f"{scene}: {place}: {first[k]['outcome']} -> {second[k]['outcome']}", file=sys.stderr)
        lines.append((scene, len(first), dict(Counter(row["status"] for row in first)), len(changed), len(inside)))
    table("Stiff end, rtol 1e-7 against 1e-8, 65 x 65 points", ("scene", "points", "status", "outcome changed", "of them off the boundary"), lines)


def at_boundary(outcomes, number, side):
    """Whether a neighbour of a point on the square lattice has another outcome."""
    i, j = divmod(number, side)
    near = [(i + a, j + b) for a in (-1, 0, 1) for b in (-1, 0, 1) if 0 <= i + a < side and 0 <= j + b < side]
    return any(outcomes[a * side + b] != outcomes[number] for a, b in near)


def share(folder):
    """Shares of the plane by outcome, from the cells; half of a mixed cell is nobody's."""
    areas, axes = Counter(), summary(folder)["axes"]
    for row in rows(folder / "cells.csv"):
        area = 1.0
        for axis in axes:
            area *= abs(cell_of(float(row[axis["key"] + "_to"]), axis) - cell_of(float(row[axis["key"] + "_from"]), axis))
        areas[row["outcome"]] += area
    return {name: f"{100 * area:.1f} %" for name, area in sorted(areas.items())}


def maps(lab):
    """The diagrams of scenes/ as they are: points, audit, shares of the plane."""
    lines = []
    for scene in sorted((SOURCE / "scenes").glob("phase_*.toml")) + [SOURCE / "scenes" / "capture_basin.toml"]:
        out, _ = scan(lab, scene.name, f"map_{scene.stem}", traced=True)
        lines.append((scene.stem, summary(out)["evaluated"], summary(out)["requested"], summary(out)["failed"], rate(out), share(out)))
    table("The diagrams of scenes/", ("scene", "points", "of", "failed", "audit: missed, at most (95 %)", "share of the plane"), lines)


PARTS = {"memory": memory, "cells": cells, "large": large, "stiff": stiff, "maps": maps}

if __name__ == "__main__":
    run_parts(parser(__doc__, "report", "threads", "keep", parts=PARTS).parse_args(), PARTS)
