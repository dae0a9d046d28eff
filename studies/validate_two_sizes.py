#!/usr/bin/python3
"""Beds of two sizes of beads, 0.4 and 0.56 mm, half of the number each: do they move, are they solid, does a rod walk.

    studies/validate_two_sizes.py [--program build/release/rodwake] [--only gap,solid,walk] [--runs 4] [-j 1] [--keep DIR]

gap    temperature of each kind against the gap between the plates, at 0.70 and 0.80; 3 CPU seconds a run, 14 beds
solid  mean-square displacement after two waiting times, seven area fractions in a box of 78 a; 15 CPU seconds a run
walk   speed of a rod and the displacement around it in the same box, for three thick ends; 10 CPU seconds a run, 6 beds

A run is a row (solid: two rows) of studies/two_sizes_<part>.csv. Runs that have a row are not made again, so another --runs adds to them.
"""

import json
import shutil

import h5py
import numpy as np
from scipy.spatial import Delaunay

from lab import SOURCE, columns, keep_row, kept_rows, leave_one_out, mean, parser, run_parts, table, text, read_json

A = 4e-4
GAPS, DENSE = (1.2, 1.3, 1.4, 1.5, 1.55, 1.6, 1.7), (0.70, 0.80)
DENSITIES = (0.60, 0.66, 0.72, 0.76, 0.80, 0.82, 0.84)
WAITED, LAGS, ORIGINS = (2.0, 22.0), (0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 18.0), 10
THICK = (1.1, 1.3, 1.4)
BED = """schema = 1
title = "Beads of two sizes"
[granular]
phi_b = {phi}
box = "{box} a"
start = "random"
equilibrate = "{equilibrate} s"
duration = "{duration} s"
seed = {seed}
[granular.plates]
gap = "{gap} mm"
[[granular.bead_kinds]]
radius = "0.4 mm"
share = 0.5
[[granular.bead_kinds]]
radius = "0.56 mm"
share = 0.5
[granular.output]
frames = "{frames} s"
formats = ["h5md"]
last_period = false
{more}
"""
WALKER = """[[granular.rods]]
position = ["20 a", "39 a"]
thick_diameter = "{thick} mm"
[measure]
displacement = "lagrangian"
from_travel = "20 a"
interval = "0.1 s"
block = "2 s"
"""


def kept(part):
    return SOURCE / "studies" / f"two_sizes_{part}.csv"


def made(lab, part, reduce, bed, verbs=("dem",), more="", **settings):
    """The rows of a run with these settings, which begin with them: kept, or made now in this bed."""
    def rows():
        return [row for row in kept_rows(kept(part)) if all(float(row[key]) == value for key, value in settings.items())]
    if not rows():
        scene = BED.format(**{"gap": 1.55, "equilibrate": 2, **bed, **settings}, more=more.format(**settings))
        folder = lab.make("_".join([part, *map(str, settings.values())]), scene, verbs=verbs)
        summary = read_json(folder, "summary")
        for row in reduce(folder, summary):
            keep_row(kept(part), {**settings, **row, "cpu_seconds": round(summary["cpu_seconds"])})
        shutil.rmtree(folder)
    return rows()


def numbers(rows, name, scale=1.0):
    return mean([scale * float(row[name]) for row in rows])


def temperatures(summary):
    """m^2/s^2; 0 where all beads of the kind are in step with the plates."""
    return {f"{name}_{size}": f"{kind[name]:.4g}" for size, kind in zip(("small", "large"), summary["kinds"]) for name in ("T_xy", "T_z")}


def gap(lab):
    bed = {"box": 40, "duration": 10, "frames": 10}
    for phi in DENSE:
        lines = []
        for width in GAPS:
            found = [row for seed in range(1, lab.options.runs + 1)
                     for row in made(lab, "gap", lambda _, summary: [temperatures(summary)], bed, phi=phi, gap=width, seed=seed)]
            lines.append([f"{width:g}", len(found), *(text(numbers(found, f"{name}_{size}", 1e6), digits=1)
                                                     for name in ("T_xy", "T_z") for size in ("small", "large"))])
        table(f"Temperature of each kind against the gap, phi_b = {phi}, 1e-6 m^2/s^2", ["gap, mm", "runs", "T_xy 0.4 mm", "0.56 mm", "T_z 0.4 mm", "0.56 mm"], lines)


def film_of(folder):
    """Times, unwrapped places [frame, bead, axis] in a with the mean of all beads taken off, and the side of the box in a."""
    with h5py.File(folder / "trajectory.h5md") as film:
        beads = film["particles/trajectory"]
        side = beads["box/edges/value"][0, 0, 0]
        places = beads["position/value"][:, :, :2] + side * beads["image/value"][:, :, :2]
        times = beads["box/edges/time"][()]
    places -= (places - places[0]).mean(axis=1, keepdims=True)
    return times, places / A, side / A


def neighbours(places, side):
    """Pairs (i, j), both ways, that share an edge of the Delaunay triangulation of the periodic plane."""
    inside, number = places % side, np.arange(len(places))
    shifts = [(i * side, j * side) for i in (-1, 0, 1) for j in (-1, 0, 1)]
    points, bead = np.concatenate([inside + shift for shift in shifts]), np.tile(number, 9)
    near = (np.abs(points - side / 2) < side / 2 + 8).all(axis=1)
    edges = Delaunay(points[near]).simplices[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2)
    pairs = bead[near][np.concatenate([edges, edges[:, ::-1]])]
    ours = (np.abs(points[near][np.concatenate([edges[:, 0], edges[:, 1]])] - side / 2) <= side / 2).all(axis=1)
    return np.unique(pairs[ours & (pairs[:, 0] != pairs[:, 1])], axis=0)


def square_displacements(folder, summary):
    """<|d|^2> and that of d - mean d of the neighbours at the origin, a^2: the latter has no part of waves longer than a cage."""
    times, places, side = film_of(folder)
    step = times[1] - times[0]
    for waited in WAITED:
        free, caged = np.zeros((2, len(LAGS)))
        for origin in np.round(np.linspace(waited - WAITED[0], waited - WAITED[0] + 2, ORIGINS, endpoint=False) / step).astype(int):
            i, j = neighbours(places[origin], side).T
            count = np.bincount(i, minlength=places.shape[1])[:, None]
            for k, lag in enumerate(LAGS):
                moved = places[origin + round(lag / step)] - places[origin]
                around = np.stack([np.bincount(i, moved[j, axis], len(moved)) for axis in (0, 1)], axis=1) / count
                free[k] += (moved**2).sum(axis=1).mean() / ORIGINS
                caged[k] += ((moved - around) ** 2).sum(axis=1).mean() / ORIGINS
        yield {"waited": waited, **temperatures(summary), "psi6": f"{summary['psi6']:.4f}",
               **{f"{name}_{lag:g}": f"{value:.5g}" for name, values in (("msd", free), ("cage", caged)) for lag, value in zip(LAGS, values)}}


def slope(rows, name, first, last):
    """d log / d log of the mean over runs between two lags, and the jackknife's error: 1 is free diffusion, 0 a plateau."""
    values = np.array([[float(row[f"{name}_{lag:g}"]) for lag in (first, last)] for row in rows])
    def of(chosen):
        low, high = values[chosen].mean(axis=0)
        return np.log(high / low) / np.log(last / first)
    return of(np.full(len(values), True)), leave_one_out(of, len(values))


def solid(lab):
    bed, lines = {"box": 78, "duration": 40, "frames": 0.05}, []
    for phi in DENSITIES:
        found = [row for seed in range(1, lab.options.runs + 1) for row in made(lab, "solid", square_displacements, bed, phi=phi, seed=seed)]
        for waited in WAITED:
            rows = [row for row in found if float(row["waited"]) == waited]
            lines.append([f"{phi:.2f}", f"{waited:g}", len(rows), *(text(numbers(rows, name), digits=3) for name in ("msd_1", "msd_10", "cage_1", "cage_10")),
                          *(text(slope(rows, "cage", *lags)) for lags in ((0.2, 1.0), (2.0, 18.0))),
                          *(text(numbers(rows, name, 1e6), digits=1) for name in ("T_xy_small", "T_xy_large"))])
    table("Mean-square displacement, a^2, box of 78 a, gap 1.55 mm",
          ["phi_b", "waited, s", "runs", "1 s", "10 s", "of the cage, 1 s", "10 s", "slope 0.2 to 1 s", "2 to 18 s", "T_xy 0.4 mm", "0.56 mm, 1e-6 m^2/s^2"], lines)


def wake(folder, summary):
    """Speed, and U_x on the rod's line, means over 10 to 20 a behind it and ahead."""
    x, u = columns(folder / "profile_Ux_x.csv", "x", "value")
    measured = json.loads((folder / "measure.json").read_text(encoding="utf-8"))["displacement"]
    yield {"speed": f"{summary['rods'][0]['mean_speed'] / A:.4f}", "speed_measured": f"{measured['mean_speed']:.4f}",
           **{name: f"{u[(sign * x >= 10) & (sign * x <= 20)].mean():.4f}" for name, sign in (("behind", -1), ("ahead", 1))}}


def walk(lab):
    bed, lines = {"box": 78, "equilibrate": 10, "duration": 20, "frames": 0.1}, []
    for phi in (0.66, 0.84):
        for thick in THICK:
            more, verbs = (WALKER, ("dem", "measure")) if thick == max(THICK) else (WALKER.partition("[measure]")[0], ("dem",))
            reduce = wake if thick == max(THICK) else lambda _, summary: [{"speed": f"{summary['rods'][0]['mean_speed'] / A:.4f}", "speed_measured": "",
                                                                          "behind": "", "ahead": ""}]
            found = [row for seed in range(1, lab.options.runs + 1)
                     for row in made(lab, "walk", reduce, bed, verbs, more, phi=phi, thick=thick, seed=seed)]
            lines.append([f"{phi:.2f}", f"{thick:g}", len(found), text(numbers(found, "speed")),
                          *(text(numbers(found, name), digits=3) if found[0][name] else "-" for name in ("behind", "ahead"))])
    table("A walking rod, gap 1.55 mm, thin end 0.8 mm, 4.5 mm long", ["phi_b", "thick end, mm", "runs", "speed, a/s", "U_x 10 to 20 a behind, a", "ahead, a"], lines)


PARTS = {"gap": gap, "solid": solid, "walk": walk}

if __name__ == "__main__":
    arguments = parser(__doc__, "report", "threads", "keep", "runs", parts=PARTS).parse_args()
    arguments.runs = arguments.runs or 4
    run_parts(arguments, PARTS)
