#!/usr/bin/python3
"""The paper's experiments, simulated as they were done: in a dish of 13 cm with a wall, from random starts, seen by a camera.

    studies/validate_dish.py [--program build/release/rodwake] [--only pairs,pursuit,still] [--runs 12] [-j 2] [--keep DIR]

pairs     two rods side by side, 18 and 24 a apart, at 0.70 and 0.78, over half the dish; some 3 CPU minutes a run, 48 runs
pursuit   perpendicular starts 26 a apart at 0.78; 2 CPU minutes a run
still     beads without rods from 0.62 to 0.78: order and stiffness; 1 CPU minute a run, two runs a density

What is kept of a run is a row of studies/dish.csv; runs that have a row are not made again, so another --runs adds to them. Each run is
filmed by `rodwake camera` (an error of 0.05 a, 5 % of the spots lost) and measured from its tracks. Prints the tables of
studies/reports/measure.md, and the rows of docs/paper.md are judged from the same file.
"""

import math
import shutil

import numpy as np

from lab import columns, keep_row, kept_rows, mean, parser, run_parts, table, text, read_json
from paper_rows.dish import CONTACT, KEPT

DENSITIES, DISTANCES = (0.70, 0.78), (18, 24)
STILL, STILL_RUNS = (0.62, 0.66, 0.68, 0.70, 0.72, 0.74, 0.76, 0.78), 2
A, RADIUS = 4e-4, 162.5
BED = """schema = 1
title = "The paper's dish"
[granular]
phi_b = {phi}
start = "random"
duration = "{duration} s"
equilibrate = "5 s"
seed = {seed}
{more}
[granular.container]
kind = "circle"
radius = "162.5 a"
[granular.output]
frames = "{frames} s"
table = "0.02 s"
formats = ["h5md"]
last_period = false
every_bead = {every}
"""
ROD = """[[granular.rods]]
kind = "motile"
position = ["{} a", "{} a"]
heading = "{} deg"
"""


def bed(phi, seed, duration, frames=0.1, every=100, rods=(), more=""):
    scene = BED.format(phi=phi, seed=seed, duration=duration, frames=frames, every=every, more=more)
    return scene + "".join(ROD.format(*rod) for rod in rods)


def film(lab, folder):
    """As a laboratory has it: the folder of the film."""
    lab.call("camera", folder, "--pixel", "0.05 a", "--noise", "0.05 a", "--lost", "0.05", "--force", "--quiet")
    return folder / "camera"


def rods_of(folder):
    """[rod]: (time, x, y, heading) of a film, lengths in a."""
    frame, x, y, theta = columns(folder / "tracks.csv", "frame", "x", "y", "theta")
    scene = (folder / "camera.toml").read_text(encoding="utf-8")
    rate, pixel = (float(next(line for line in scene.splitlines() if line.startswith(key)).split("=")[1].split("#")[0]) for key in ("frames_per_second", "pixel"))
    number = columns(folder / "tracks.csv", "particle")[0]
    is_rod = np.isfinite(theta)
    first = sorted(set(number[is_rod]), key=lambda one: np.flatnonzero(is_rod & (number == one))[0])
    return [tuple(column[is_rod & (number == one)] * factor for column, factor in ((frame, 1 / rate), (x, pixel / A), (y, pixel / A), (theta, 1.0)))
            for one in first]


def made(lab, kind, name, text, reduce, **settings):
    """The row of a run: kept, or made now."""
    seed = settings["seed"]
    for row in kept_rows(KEPT):
        if row["kind"] == kind and all(float(row[key]) == float(value) for key, value in settings.items()):
            return row
    folder = lab.make(name, text, verbs=("dem",))
    row = {"kind": kind, "phi": settings.get("phi", 0.78), "distance": settings.get("distance", 0), "seed": seed, **reduce(lab, folder),
           "cpu_seconds": round(read_json(folder, "summary")["cpu_seconds"])}
    keep_row(KEPT, row)
    shutil.rmtree(folder)
    return row


def no_values():
    return dict.fromkeys(("change", "closest", "turn0", "turn1", "psi6", "stiffness", "stiffness_error"), "")


def of_rods(lab, folder):
    """How far the rods have come apart across their way, how near they came, how far each has turned."""
    first, second = rods_of(film(lab, folder))[:2]
    both, i, j = np.intersect1d(first[0], second[0], return_indices=True)
    x, y = first[1][i] - second[1][j], first[2][i] - second[2][j]
    turns = [np.unwrap(rod[3]) for rod in (first, second)]
    return {**no_values(), "change": f"{(y[-1] - y[0]) * math.copysign(1, y[0]):.3f}", "closest": f"{np.hypot(x, y).min():.3f}",
            **{f"turn{k}": f"{turn[-1] - turn[0]:.4f}" for k, turn in enumerate(turns)}}


def of_beads(lab, folder):
    camera = film(lab, folder)
    window = f"tracks.window={{ circle = [{RADIUS * A}, {RADIUS * A}, {150 * A}] }}"
    lab.call("measure", camera / "camera.toml", "-o", camera / "out", "-s", window, "-s", "measure.block=2 s", "-s", "measure.order_interval=2 s", "--force", "--quiet")
    found = read_json(camera / "out", "measure")
    psi6, stiffness = found["order"]["psi6"]["value"], found["microrheology"]["stiffness"]
    return {**no_values(), "psi6": f"{psi6:.4f}", "stiffness": f"{stiffness['value']:.5g}", "stiffness_error": f"{stiffness['error']:.3g}"}


def pairs(lab):
    middle, rows = RADIUS, []
    for phi in DENSITIES:
        for distance in DISTANCES:
            found = []
            for seed in range(1, lab.options.runs + 1):
                rods = [(0.5 * RADIUS, middle + side * distance / 2, 0) for side in (1, -1)]
                scene = bed(phi, seed, 60, rods=rods, more=f'stop_at_travel = "{RADIUS} a"')
                found.append(made(lab, "pair", f"pair_{phi:.2f}_{distance}_{seed}", scene, of_rods, phi=phi, distance=distance, seed=seed))
            change = mean([float(row["change"]) for row in found])
            near = sum(float(row["closest"]) < CONTACT for row in found)
            rows.append([f"{phi:.2f}", f"{distance} a", len(found), text(change, digits=1), f"{near}"])
    table("Two rods side by side in the dish, over half its diameter", ["phi_b", "apart at the start", "runs", "change of separation, a", "came to contact"], rows)


def pursuit(lab):
    found = []
    for seed in range(1, lab.options.runs + 1):
        rods = [(130, 175.5, 0), (140, 149.5, 90)]
        found.append(made(lab, "pursuit", f"pursuit_{seed}", bed(0.78, seed, 30, rods=rods), of_rods, seed=seed))
    turns = [(abs(float(row["turn0"])), abs(float(row["turn1"]))) for row in found]
    near = sum(float(row["closest"]) < CONTACT for row in found)
    table("Perpendicular starts 26 a apart in the dish, phi_b = 0.78", ["runs", "came to contact", "turn of the rod along x, rad", "of the other"],
          [[len(found), near, *(text(mean(column)) for column in zip(*turns))]])


def still(lab):
    rows = []
    for phi in STILL:
        found = [made(lab, "still", f"still_{phi:.2f}_{seed}", bed(phi, seed, 8, frames=0.02, every=1), of_beads, phi=phi, seed=seed)
                 for seed in range(1, min(STILL_RUNS, lab.options.runs) + 1)]
        stiffness = mean([float(row["stiffness"]) for row in found])
        rows.append([f"{phi:.2f}", len(found), f"{mean([float(row['psi6']) for row in found])[0]:.3f}", text(stiffness, digits=3),
                     f"{np.mean([float(row['stiffness_error']) for row in found]):.2g}"])
    table("Beads in the dish: order and stiffness", ["phi_b", "runs", "psi6", "stiffness, 1/a^2, +- between runs", "stated error"], rows)


PARTS = {"pairs": pairs, "pursuit": pursuit, "still": still}

if __name__ == "__main__":
    arguments = parser(__doc__, "report", "threads", "keep", "runs", parts=PARTS).parse_args()
    arguments.runs = arguments.runs or 12
    run_parts(arguments, PARTS)
