#!/usr/bin/python3
"""Does strain turn rods where there are no rows? Pairs of walking rods in beds of two sizes, a liquid and a solid, which moves
along with them or is held, and in a crystal whose beads have a spread of 5 %. The table of docs/findings.md, section 15.

    studies/validate_verdict.py [--program build/release/rodwake] [--only pairs,ends,weigh] [--runs 50] [-j 1] [--keep DIR]

pairs  two rods side by side, 15 and 18 a apart, over half the box, and 20 runs that start at right angles; 3 (liquid), 25 (solid) and 8
       (crystal) CPU seconds a run. The rods at whole steps are the rows of studies/verdict_tracks.csv; batches of five runs that have
       rows are not made again, so another --runs adds to them.
ends   of what is kept: change of the distance, contacts, how far which rod turned.
weigh  rivals on the same tracks, as studies/validate_mechanism.py weighs them: strain, polar couplings, the medium's velocity, rows along
       x, none; in the solid in its own medium (studies/validate_wakes.py), elsewhere in that which sound and pushes give for the crystal.
"""

import shutil

import numpy as np

from lab import SOURCE, columns, keep_row, kept_rows, mean, parser, run_parts, table, text, read_json
from validate_mechanism import A, FIT, MEDIA, NUMBERS, RIVALS, SIGMA_HEADING, SIGMA_POSITION, TRACK, apart_yet, speed_of

TRACKS, BATCH = SOURCE / "studies/verdict_tracks.csv", 5
SCENE = """schema = 1
title = "Rods in a {name}"
[granular]
phi_b = {phi}
box = "78 a"
start = "{start}"
equilibrate = "{equilibrate} s"
duration = "{walk} s"
seed = {seed}
runs = {runs}
{more}
[granular.plates]
gap = "{gap} mm"
[granular.output]
formats = []
last_period = false
"""
ROD = """[[granular.rods]]
position = ["{x} a", "{y} a"]
heading = "{heading} deg"
thick_diameter = "{thick} mm"
"""
TWO_SIZES = '[[granular.bead_kinds]]\nradius = "0.4 mm"\nshare = 0.5\n[[granular.bead_kinds]]\nradius = "0.56 mm"\nshare = 0.5\n'
# The step of tracks, s, is about 2 a of walking.
BEDS = {
    "liquid": {"phi": 0.66, "gap": 1.55, "thick": 1.4, "start": "random", "equilibrate": 5, "walk": 12, "step": 0.25, "kinds": TWO_SIZES, "more": ""},
    "solid": {"phi": 0.84, "gap": 1.55, "thick": 1.4, "start": "random", "equilibrate": 20, "walk": 60, "step": 1.0, "kinds": TWO_SIZES, "more": "",
              "medium": (2.7, 9.1, 0.001)},  # f/mu in a, eta, alpha, by sound and force of the first runs of studies/validate_wakes.py
    # A rod of the solid takes all of the periodic bed along. Here a uniform force on the beads, of this acceleration in m/s^2 a rod and against it,
    # holds the bed where it is.
    "held": {"phi": 0.84, "gap": 1.55, "thick": 1.4, "start": "random", "equilibrate": 20, "walk": 60, "step": 1.0, "kinds": TWO_SIZES, "more": "",
             "hold": 3.0e-3, "medium": (2.7, 9.1, 0.001)},
    "crystal": {"phi": 0.78, "gap": 1.2, "thick": 1.1, "start": "lattice", "equilibrate": 1, "walk": 30, "step": 0.5, "kinds": "", "more": "bead_spread = 0.05"},
}
# Of both rods: x, y in a, heading in degrees; how many runs unless --runs asks for less.
STARTS = {
    "15": (((20, 46.5, 0), (20, 31.5, 0)), 50),
    "18": (((20, 48, 0), (20, 30, 0)), 50),
    "across": (((15, 60, 0), (25, 34, 90)), 20),
}


def scene_of(name, start, seed, runs):
    """Two rods in a bed: rods side by side stop after half a box, others after the longest time."""
    bed, (rods, _) = BEDS[name], STARTS[start]
    more = bed["more"] if start == "across" else bed["more"] + '\nstop_at_travel = "39 a"'
    head = SCENE.format(**bed | {"name": name, "seed": seed, "runs": runs, "more": more})
    return (head + bed["kinds"] + "".join(ROD.format(x=x, y=y, heading=heading, thick=bed["thick"]) for x, y, heading in rods)
            + hold(bed, [heading for *_, heading in rods]))


def hold(bed, headings):
    """Against the push of rods that head this way, in degrees."""
    push = bed.get("hold", 0.0) * np.exp(1j * np.radians(headings)).sum()
    return f'[granular.body_force]\nkind = "uniform"\nacceleration = {abs(push):.6g}\ndirection = {np.angle(-push):.6f}\n' if push else ""


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
                out = lab.make(f"{name}_{start}_{batch}", scene_of(name, start, batch, BATCH), verbs=("dem",), good=(0, 1))
                for run, folder in enumerate(sorted(out.glob("runs/*")), 1):
                    if not (folder / "summary.json").is_file():  # beads overlapped by too much, and the run was stopped
                        print(f"{name} {start}, batch {batch}: run {run} failed")
                        continue
                    seconds = round(read_json(folder, "summary")["cpu_seconds"])
                    for row in rows_at_steps(columns(folder / "tracks.csv"), bed["step"]):
                        keep_row(TRACKS, {"bed": name, "start": start, "batch": batch, "run": run, **row, "cpu_seconds": seconds})
                shutil.rmtree(out)


def kept_pairs(bed, start):
    """[run]: t, x0, y0, theta0, x1, y1, theta1 in a row, and the CPU seconds of all."""
    found, seconds = {}, 0.0
    for row in kept_rows(TRACKS):
        if (row["bed"], row["start"]) == (bed, start):
            key = (row["batch"], row["run"])
            seconds += 0.0 if key in found else float(row["cpu_seconds"])
            found.setdefault(key, []).append([float(row[one]) for one in ("t", *NUMBERS)])
    return [np.array(one) for one in found.values()], seconds


def winding_of(pair):
    """Turns of one rod around the other."""
    angle = np.unwrap(np.arctan2(pair[:, 5] - pair[:, 2], pair[:, 4] - pair[:, 1]))
    return np.ptp(angle) / (2 * np.pi)


def ends(_):
    """Inward: the lower rod to the left, the upper one to the right. The rods that start at right angles: rod 1 comes from below."""
    beside, across, winding = [], [], []
    for name in BEDS:
        for start in STARTS:
            found, seconds = kept_pairs(name, start)
            if not found:
                continue
            touched = sum(len(apart_yet(one)) < len(one) for one in found)
            turns = [(one[-1, 3] - one[0, 3], one[-1, 6] - one[0, 6]) for one in map(apart_yet, found)]
            winding.append([name, start, len(found), f"{max(winding_of(one) for one in found):.2f}"])
            if start == "across":
                across.append([name, len(found), touched, *(text(mean([turn[k] for turn in turns])) for k in (0, 1)),
                               *(text(mean([abs(turn[k]) for turn in turns])) for k in (0, 1)),
                               text(mean([abs(turn[1]) - abs(turn[0]) for turn in turns])), f"{seconds / 3600:.2f}"])
                continue
            change = [abs(one[-1, 5] - one[-1, 2]) - abs(one[0, 5] - one[0, 2]) for one in found]
            beside.append([name, start, len(found), text(mean(change)), f"{np.std(change, ddof=1):.1f}", touched,
                           text(mean([turn[1] - turn[0] for turn in turns])), f"{np.mean([speed_of(one) for one in found]):.1f}", f"{seconds / 3600:.2f}"])
    table("Pairs side by side", ["bed", "apart, a", "runs", "Delta y over half the box, a", "its scatter, a", "contacts", "turned inward, rad",
                                 "speed, a/s", "CPU hours"], beside)
    table("Starts at right angles, 26 a apart", ["bed", "runs", "contacts", "rod 0 turned, rad", "rod 1", "|turn| of rod 0", "of rod 1", "difference", "CPU hours"], across)
    table("Does a pair orbit? Turns of one rod around the other, most of all runs", ["bed", "start", "runs", "turns"], winding)


def weigh(lab):
    """Pairs side by side, 15 and 18 a together, until they touch."""
    lines = []
    for name, bed in BEDS.items():
        found = [one for start in ("15", "18") for one in map(apart_yet, kept_pairs(name, start)[0][:lab.options.runs]) if len(one) > 3]
        (scale, eta, alpha), parts = bed.get("medium", MEDIA["medium"]), []
        for number, pair in enumerate(found):
            file = lab.write(f"{name}_{number}.csv", "t,x0,y0,theta0,x1,y1,theta1\n" +
                             "".join(",".join(f"{value:.4f}" for value in row) + "\n" for row in pair))
            parts.append(TRACK.format(file=file, scale=scale, speed=round(speed_of(pair), 4), position=SIGMA_POSITION, heading=SIGMA_HEADING))
        out = lab.make(f"weigh_{name}", FIT.format(eta=eta, alpha=alpha, direction=0.0, tracks="".join(parts)), verbs=("fit",))
        models = {one["name"]: one for one in read_json(out, "models")["models"]}
        couplings = {one: models[one]["parameters"][RIVALS[one][0]] for one in ("strain", "flow", "rows")}
        lines.append([name, len(found), *(f"{models[one]['aic'] - models['none']['aic']:+.1f}" for one in RIVALS),
                      *(text((one["value"], one["stderr"]), digits=3) for one in couplings.values()),
                      f"{models['none']['misfit']['probability']:.2g}"])
    table("Rivals on the tracks of pairs side by side", ["bed", "runs", *(f"{one}: AIC less that of none" for one in RIVALS), "kappa", "gamma_flow",
                                                         "gamma_rows", "misfit of none"], lines)


PARTS = {"pairs": pairs, "ends": ends, "weigh": weigh}

if __name__ == "__main__":
    arguments = parser(__doc__, "report", "threads", "keep", "runs", parts=PARTS).parse_args()
    run_parts(arguments, PARTS)
