#!/usr/bin/python3
"""A scan of a pair, 10 000 points of kappa and start, by rodwake (threads, MPI ranks), SciPy and odeint in one run.

    bench/scan_peers.py [--program build/release/rodwake] [--side 100] [--repetitions 3] [--quick]

All solve the same equations to rtol = atol = 1e-6, up to contact or t = 60, alpha = eta = 1. SciPy: solve_ivp with LSODA and an event,
processes by multiprocessing, scaled Bessel functions. odeint: dopri5 on threads (peers/odeint_scan.cpp), contact looked for after each
step; SciPy gets every tenth point. Rodwake finds all endings, limits steps so that no meeting is stepped over, and keeps a ledger. Prints Markdown: medians of wall time
in turns, speed-up, and at how many points contact is not what rodwake finds.
"""

import argparse
import csv
import math
import os
import statistics
import subprocess
import tempfile
import time
from multiprocessing import Pool
from pathlib import Path

import measure
import numpy as np
from scipy.integrate import solve_ivp
from scipy.special import kve

SCENE = """schema = 1
[medium]
eta = 1.0
alpha = 1.0
[coupling]
kappa = 1.0
[[rods]]
position = [0.0, 0.0]
[[rods]]
position = [0.0, -4.0]
heading = "90 deg"
[rods_run]
t_end = 60.0
contact_distance = 0.1
rtol = 1e-6
[scan]
trajectories = 0
[[scan.axes]]
key = "coupling.kappa"
from = 0.1
to = 100.0
spacing = "log"
count = {side}
[[scan.axes]]
key = "rods.1.position.0"
from = -6.0
to = 6.0
count = {side}
"""
TENTH = 10  # which points SciPy gets, so that it takes minutes
TOLERANCE, T_END, CONTACT = 1e-6, 60.0, 0.1
SHEAR, ORDERS = 0.5, np.array([[0], [1], [2]])
RATES = np.array([SHEAR, 0.5 * SHEAR])  # c of G_T and G_L at alpha = eta = 1
MPI_AS_ROOT = {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}


def strain(x, y):
    """xx, xy, yy at (x, y) from a rod that heads along x; f/mu = 1."""
    r = math.hypot(x, y)
    cos, sin, c = x / r, y / r, RATES
    K0, K1, K2 = np.exp(-c * (x + r)) * kve(ORDERS, c * r)
    gxx = c * c * (K0 + 2.0 * cos * K1 + cos * cos * K2) - c * K1 / r
    gxy = c * c * sin * (K1 + cos * K2)
    gyy = c * c * sin * sin * K2 - c * K1 / r
    xx, xy, yy = (g[0] - g[1] for g in (gxx, gxy, gyy))
    first = -SHEAR * np.array([K0[0] + cos * K1[0], sin * K1[0]])
    return (first[0] + xx) / (2.0 * math.pi), (0.5 * first[1] + xy) / (2.0 * math.pi), yy / (2.0 * math.pi)


def turning(s, rod, kappa):
    at, other = 3 * rod, 3 - 3 * rod
    dx, dy, heading = s[at] - s[other], s[at + 1] - s[other + 1], s[other + 2]
    cos, sin = math.cos(heading), math.sin(heading)
    xx, xy, yy = strain(cos * dx + sin * dy, cos * dy - sin * dx)
    nx, ny = math.cos(s[at + 2] - heading), math.sin(s[at + 2] - heading)
    return kappa * (nx * (xy * nx + yy * ny) - ny * (xx * nx + xy * ny))


def rates(_, s, kappa):
    return [math.cos(s[2]), math.sin(s[2]), turning(s, 0, kappa), math.cos(s[5]), math.sin(s[5]), turning(s, 1, kappa)]


def distance(_, s, kappa):
    return math.hypot(s[0] - s[3], s[1] - s[4]) - CONTACT


distance.terminal = True


def meets(point):
    kappa, x = point
    start = [0.0, 0.0, 0.0, x, -4.0, 0.5 * math.pi]
    run = solve_ivp(rates, (0.0, T_END), start, method="LSODA", rtol=TOLERANCE, atol=TOLERANCE, events=distance, args=(kappa,))
    return run.status == 1


def by_scipy(points, processes):
    with Pool(processes) as pool:
        return pool.map(meets, points, chunksize=50)


def by_odeint(program, file, right_hand_side, threads):
    return [line == "contact" for line in measure.run([program, file, right_hand_side, str(threads)]).splitlines()]


def by_rodwake(command, folder):
    measure.run([*map(str, command), "-o", str(folder), "--force", "--quiet"], env={**os.environ, **MPI_AS_ROOT})
    with open(folder / "scan.csv", encoding="utf-8") as file:
        return [row["outcome"] == "contact" for row in csv.DictReader(file)]


def points_of(folder):
    with open(folder / "scan.csv", encoding="utf-8") as file:
        return [(float(row["coupling.kappa"]), float(row["rods.1.position.0"])) for row in csv.DictReader(file)]


def contenders(options, folder, points):
    """Name, processes or threads, call; the first decides what contact is."""
    program, scene = measure.find_program(options.program), folder / "scan.toml"
    odeint = program.parent / "bench" / "bench_odeint_scan"
    scan = (program, "scan", scene, "-j")
    ranks = ("mpiexec", "--oversubscribe", "-n")
    for n in (1, 2):
        yield "rodwake, threads", n, lambda n=n: by_rodwake((*scan, n), folder / "out")
    for n in (1, 2):
        yield "rodwake, ranks", n, lambda n=n: by_rodwake((*ranks, n, *scan[:3]), folder / "out")
    for side in ("rodwake", "plain"):
        for n in (1, 2):
            yield f"odeint dopri5, {side} right-hand side", n, lambda s=side, n=n: by_odeint(odeint, folder / "points.csv", s, n)
    for n in (1, 2):
        yield "SciPy LSODA, multiprocessing", n, lambda n=n: by_scipy(points[::TENTH], n)


def timed(call):
    start = time.perf_counter()
    answer = call()
    return time.perf_counter() - start, answer


def table(found):
    alone = {name: statistics.median(times) for name, n, times, _ in found if n == 1}
    whole = found[0][3]
    rows = []
    for name, n, times, met in found:
        median = statistics.median(times)
        truth = whole if len(met) == len(whole) else whole[::TENTH]
        rows.append((name, n, measure.spread(times), f"{1e6 * median / len(met):.3g}", f"{alone[name] / median:.2f}",
                     f"{median / len(met) / (alone['rodwake, threads'] / len(whole)):.3g}", sum(a != b for a, b in zip(met, truth))))
    measure.print_table(("by", "processes", "wall s", "us a point", "speed-up", "time / rodwake alone", "other contact"), rows)


def compare():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", help="a Release build; default build/release/rodwake")
    parser.add_argument("--side", type=int, default=100, help="points along each axis")
    parser.add_argument("--repetitions", type=int, default=3)
    parser.add_argument("--quick", action="store_true", help="a trial: 20 points a side, once")
    options = parser.parse_args()
    side, repetitions = (20, 1) if options.quick else (options.side, options.repetitions)
    os.environ["OMP_NUM_THREADS"] = os.environ["OPENBLAS_NUM_THREADS"] = "1"
    print("\n".join(measure.conditions()), end="\n\n")
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "scan.toml").write_text(SCENE.format(side=side), encoding="utf-8")
        by_rodwake((measure.find_program(options.program), "scan", folder / "scan.toml"), folder / "out")
        points = points_of(folder / "out")
        (folder / "points.csv").write_text("".join(f"{kappa!r},{x!r}\n" for kappa, x in points), encoding="utf-8")
        found = [(name, n, [], call) for name, n, call in contenders(options, folder, points)]
        answers = {}
        for _ in range(repetitions):
            for name, n, times, call in found:
                seconds, answers[name, n] = timed(call)
                times.append(seconds)
        table([(name, n, times, answers[name, n]) for name, n, times, _ in found])


if __name__ == "__main__":
    measure.main(compare)
