#!/usr/bin/python3
"""Does strain turn rods where there are no rows? Pairs and wakes in beds of two sizes, a liquid and a solid, and in a crystal whose
beads have a spread of 5 %. The table of docs/findings.md, section 14.

    studies/validate_verdict.py [--program build/release/rodwake] [--only pairs,wakes,weigh,ends] [--runs 50] [-j 1] [--keep DIR]

pairs  two walking rods side by side, 15 and 18 a apart, over half the box, and 20 runs that start at right angles; 5 (liquid), 30 (solid)
       and 12 (crystal) CPU seconds a run. The rods at whole steps are the rows of studies/verdict_tracks.csv.
wakes  one rod that walks, and one that is pulled at the same mean speed: the medium's constants from its displacement map, drag from the
       drift of the bed; a run is a row of studies/verdict_wakes.csv.
weigh  rivals on the tracks of pairs, as studies/validate_mechanism.py weighs them, in the medium that `wakes` found.
ends   of pairs: change of the distance, contacts, who turned.

Runs that have rows are not made again, so another --runs adds to them.
"""

import shutil

import numpy as np

from lab import SOURCE, keep_row, kept_rows, parser, run_parts, told, tracks
from validate_mechanism import A, NUMBERS
from validate_two_sizes import BED

TRACKS, WAKES, BATCH = SOURCE / "studies/verdict_tracks.csv", SOURCE / "studies/verdict_wakes.csv", 5
TWO_SIZES = BED.partition("[granular.output]")[0]
ONE_SIZE = """schema = 1
title = "A crystal with a spread of 5 %"
[granular]
phi_b = {phi}
box = "{box} a"
start = "lattice"
equilibrate = "{equilibrate} s"
duration = "{duration} s"
seed = {seed}
bead_spread = 0.05
"""
# The step of tracks, s, is about 2 a of walking.
BEDS = {
    "liquid": {"scene": TWO_SIZES, "phi": 0.66, "gap": 1.55, "thick": 1.4, "equilibrate": 5, "walk": 12, "step": 0.25},
    "solid": {"scene": TWO_SIZES, "phi": 0.84, "gap": 1.55, "thick": 1.4, "equilibrate": 20, "walk": 60, "step": 1.0},
    "crystal": {"scene": ONE_SIZE, "phi": 0.78, "thick": 1.1, "equilibrate": 1, "walk": 30, "step": 0.5},
}
# Of both rods: x, y in a, heading in degrees; how many runs unless --runs asks for less.
STARTS = {
    "15": (((20, 46.5, 0), (20, 31.5, 0)), 50),
    "18": (((20, 48, 0), (20, 30, 0)), 50),
    "across": (((15, 60, 0), (25, 34, 90)), 20),
}
OUTPUT = """runs = {runs}
{stop}
[granular.plates]
{plates}
{kinds}
[granular.output]
formats = []
last_period = false
"""
ROD = """[[granular.rods]]
position = ["{x} a", "{y} a"]
heading = "{heading} deg"
thick_diameter = "{thick} mm"
"""
KINDS = '[[granular.bead_kinds]]\nradius = "0.4 mm"\nshare = 0.5\n[[granular.bead_kinds]]\nradius = "0.56 mm"\nshare = 0.5\n'


def scene_of(bed, start, seed, runs):
    """Two rods in a bed: rods side by side stop after half a box, others after the longest time."""
    rods, _ = STARTS[start]
    head = bed["scene"].partition("[granular.plates]")[0].format(**bed, box=78, duration=bed["walk"], seed=seed)
    mixed = bed["scene"] is TWO_SIZES
    output = OUTPUT.format(runs=runs, stop="" if start == "across" else 'stop_at_travel = "39 a"',
                           plates=f'gap = "{bed["gap"]} mm"' if mixed else "", kinds=KINDS if mixed else "")
    return head + output + "".join(ROD.format(x=x, y=y, heading=heading, thick=bed["thick"]) for x, y, heading in rods)


def rows_at_steps(track, step):
    """From t = 0 on: t, and the rods in a and rad."""
    keep = [int(np.argmin(np.abs(track["t"] - t))) for t in np.arange(0.0, track["t"][-1] + 1e-9, step)]
    return [{"t": round(float(track["t"][k]), 2)} |
            {one: round(float(track[one][k]) / (1.0 if one.startswith("theta") else A), 3) + 0.0 for one in NUMBERS} for k in keep]


def pairs(lab):
    """Batches in turn, so that all settings have as many runs when time ends."""
    there = {(row["bed"], row["start"], int(row["batch"])) for row in kept_rows(TRACKS)}
    for batch in range(1, (lab.options.runs or 50) // BATCH + 1):
        for start, (_, most) in STARTS.items():
            for name, bed in BEDS.items():
                if (name, start, batch) in there or batch > most // BATCH:
                    continue
                out = lab.make(f"{name}_{start}_{batch}", scene_of(bed, start, batch, BATCH), verbs=("dem",))
                seconds = round(told(out, "summary")["cpu_seconds"] / BATCH)
                for run, track in enumerate(tracks(out), 1):
                    for row in rows_at_steps(track, bed["step"]):
                        keep_row(TRACKS, {"bed": name, "start": start, "batch": batch, "run": run, **row, "cpu_seconds": seconds})
                shutil.rmtree(out)


PARTS = {"pairs": pairs}

if __name__ == "__main__":
    arguments = parser(__doc__, "report", "threads", "keep", "runs", parts=PARTS).parse_args()
    run_parts(arguments, PARTS)
