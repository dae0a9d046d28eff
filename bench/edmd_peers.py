#!/usr/bin/python3
"""Collisions a CPU second: rodwake's granular simulator and event-driven molecular dynamics (EDMD), one core each, in turns.

    bench/edmd_peers.py --edmd PROGRAM [--program PATH] [--rounds N] [--core K] [--quick]

EDMD is an event-driven code for hard spheres that was made for speed (F. Smallenburg, Eur. Phys. J. E 45, 22 (2022); MIT
licence; github.com/FSmallenburg/EDMD). It is not shipped: fetch it, build the variant `Single` as its README says and name
the program. It is run unchanged, with its defaults (a thermostat among them, which sets velocities of some spheres anew).

The same: number of spheres, volume fraction, equal masses and radii, elastic, smooth, no gravity. Not the same: EDMD's spheres
are in a periodic cube; rodwake's are in a layer 3 radii high between plates that stand still, on which they bounce too, and keep
spins, which nothing changes here. EDMD orders all events exactly; rodwake takes steps, in which the rms speed of a component
brings a sphere 0.005 radii, which gives about as many collisions a sphere and step as in the shaken bed at its default step; its
rate goes with the step. Counted are collisions of two spheres on both sides; rodwake's bounces off the plates stand beside them.

Both programs are pinned to one core and take turns. The start and a warm-up are left out on both sides.

Prints Markdown. Compare on a quiet machine; --quick only shows that everything works.
"""

import argparse
import json
import math
import os
import re
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path

import measure

GAP = 3.0  # of the plates, radii
PHI_B = [0.5, 0.7, 0.8]
EDGES = [7, 16, 30]  # of cubes of 4 n^3 spheres; as in dem_bench.cpp
TICK = os.sysconf("SC_CLK_TCK")


def options():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--edmd", required=True, help="EDMD's program, variant Single, as its makefile builds it")
    parser.add_argument("--program", type=Path, default=measure.SOURCE / "build/release/bench/bench_dem",
                        help="rodwake's benchmark [build/release/bench/bench_dem]")
    parser.add_argument("--rounds", type=int, default=3, help="repeats of each program [3]")
    parser.add_argument("--core", type=int, default=max(os.sched_getaffinity(0)), help="core to pin to [the last one]")
    parser.add_argument("--quick", action="store_true", help="one short round of the smallest: a trial, not a measurement")
    chosen = parser.parse_args()
    if chosen.quick:
        chosen.rounds = 1
    if chosen.rounds < 1:
        parser.error("--rounds must be positive")
    chosen.edmd = Path(chosen.edmd).resolve()
    if not os.access(chosen.edmd, os.X_OK):
        parser.error(f"--edmd {chosen.edmd}: no such program")
    return chosen


def volume_fraction(phi_b):
    """Of spheres that cover phi_b of a layer."""
    return 4.0 / 3.0 * phi_b / GAP


def write_crystal(path, edge, fraction):
    """4 edge^3 spheres of diameter 1 on a face-centred cubic lattice."""
    side = (4 * edge**3 * math.pi / 6 / fraction) ** (1 / 3)
    places = [((i + a) * side / edge, (j + b) * side / edge, (k + c) * side / edge) for i in range(edge) for j in range(edge)
              for k in range(edge) for a, b, c in ((0.25, 0.25, 0.25), (0.75, 0.75, 0.25), (0.75, 0.25, 0.75), (0.25, 0.75, 0.75))]
    lines = [f"{len(places)}", f"{side!r} {side!r} {side!r}"] + [f"a {x!r} {y!r} {z!r} 0.5" for x, y, z in places]
    path.write_text("\n".join(lines) + "\n")


def cpu_of(pid):
    fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / TICK


def edmd_rate(program, folder, edge, phi_b, core, seconds):
    """Collisions a CPU second; the program is stopped when it has run long enough."""
    write_crystal(folder / "init.sph", edge, volume_fraction(phi_b))
    command = ["taskset", "-c", str(core), "stdbuf", "-oL", str(program)]
    points = []  # CPU, collisions, at each of its lines: once a unit of time
    with subprocess.Popen(command, cwd=folder, stdout=subprocess.PIPE, text=True) as run:
        for line in run.stdout:
            if found := re.match(r"Simtime: ([\d.]+), Collisions: (\d+)", line):
                points.append((cpu_of(run.pid), int(found[2])))
                if float(found[1]) >= 6 and points[-1][0] - points[0][0] > seconds:
                    break
        run.kill()
    if len(points) < 2:
        raise measure.Problem(f"{program}: printed no times and collisions; is it EDMD's variant Single?")
    warm, last = points[min(5, len(points) // 2)], points[-1]
    if not last[0] > warm[0]:
        raise measure.Problem(f"{program}: ended after {last[0]:.2f} s of CPU, before anything could be measured")
    return (last[1] - warm[1]) / (last[0] - warm[0])


def rodwake_rates(program, edge, phi_b, core, seconds):
    """Collisions of two spheres and bounces off the plates a CPU second; collisions a sphere and step."""
    command = ["taskset", "-c", str(core), str(program), f"--benchmark_filter=^elastic/{4 * edge**3}/{phi_b:g}$",
               f"--benchmark_min_time={seconds}", "--benchmark_format=json"]
    found = json.loads(measure.run(command))["benchmarks"]
    if len(found) != 1 or "error_message" in found[0]:
        raise measure.Problem(f"{' '.join(command)}: nothing was measured: {found}")
    return found[0]["collisions"], found[0]["bounces"], found[0]["a_step"]


def compare():
    chosen = options()
    for name, package in (("taskset", "util-linux"), ("stdbuf", "coreutils")):
        measure.need_command(name, package)
    measure.check_cores([chosen.core])
    seconds = 0.3 if chosen.quick else 3.0
    print("## Elastic spheres: rodwake and EDMD on one core\n")
    for line in measure.conditions():
        print(f"- {line}")
    print(f"- {chosen.rounds} rounds on core {chosen.core}, {seconds:g} s of CPU each\n", flush=True)
    rows = []
    with tempfile.TemporaryDirectory() as name:
        for edge in EDGES[:1] if chosen.quick else EDGES:
            for phi_b in PHI_B:
                ours, theirs = [], []
                for _ in range(chosen.rounds):
                    ours.append(rodwake_rates(chosen.program, edge, phi_b, chosen.core, seconds))
                    theirs.append(edmd_rate(chosen.edmd, Path(name), edge, phi_b, chosen.core, seconds))
                collisions, bounces, a_step = zip(*ours)
                ratios = [a / b for a, b in zip(collisions, theirs)]
                rows.append([4 * edge**3, f"{volume_fraction(phi_b):.3f}", *(measure.spread([1e-6 * rate for rate in rates])
                             for rates in (collisions, bounces, theirs)), f"{statistics.median(a_step):.4f}", measure.spread(ratios)])
                print(f"  {rows[-1]}", file=sys.stderr, flush=True)
    measure.print_table(["spheres", "volume fraction", "rodwake: collisions a CPU us", "and bounces", "EDMD: collisions a CPU us",
                         "rodwake: collisions a sphere and step", "rodwake / EDMD"], rows)
    print("\nMedian (min - max).")


if __name__ == "__main__":
    measure.main(compare)
