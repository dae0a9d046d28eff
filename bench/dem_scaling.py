#!/usr/bin/python3
"""Cost of rodwake's granular simulator against the number of beads, and what a second thread brings.

    bench/dem_scaling.py [--program PATH] [--rounds N] [--cores K,L] [--sizes N,M,...] [--quick]

Aluminium beads of radius 0.4 mm at phi_b = 0.80 between plates 1.2 mm apart, shaken at 200 Hz with Gamma = 7, no rods; the box
grows with their number. A warm-up is left out as in dem_peers.py, and so is the making of the start. -j 1 is pinned to the
first core, -j 2 to both. CPU is that of all threads. The exponent is the slope of log(CPU per step) over log(beads): 1 if the
cost of a bead does not depend on how many there are.

Prints Markdown. Walls and speed-ups mean something on a quiet machine only; --quick only shows that everything works.
"""

import argparse
import math
import os
import statistics
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

import measure

PHI_B = 0.80


@dataclass
class Effort:
    sizes: list
    rounds: int
    warm: float  # simulated s
    least: float  # simulated s
    bead_steps: float  # timed in one run, if that is longer


FULL = Effort([1500, 5000, 15000, 50000, 100000], 3, 0.1, 0.04, 2e8)
QUICK = Effort([1500, 5000, 15000], 1, 0.02, 0.02, 1e7)


def sizes_from(text):
    sizes = [int(word) for word in text.split(",")]
    if min(sizes) < 1:
        raise ValueError
    return sizes


def options():
    usable = sorted(os.sched_getaffinity(0))
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", help="rodwake to measure [build/release/rodwake]")
    parser.add_argument("--rounds", type=int, help=f"repeats of each size [{FULL.rounds}; quick: {QUICK.rounds}]")
    parser.add_argument("--cores", default=",".join(map(str, usable[-2:][::-1])), help="two to pin to, or one: -j 1 only "
                        "[the last two]")
    parser.add_argument("--sizes", type=sizes_from, help=f"numbers of beads [{','.join(map(str, FULL.sizes))}]")
    parser.add_argument("--quick", action="store_true", help="small sizes, short runs: a trial, not a measurement")
    chosen = parser.parse_args()
    if chosen.rounds is not None and chosen.rounds < 1:
        parser.error("--rounds must be positive")
    try:
        chosen.cores = [int(core) for core in chosen.cores.split(",")]
    except ValueError:
        parser.error(f"--cores {chosen.cores}: must be one or two numbers, for example 0,1")
    if len(set(chosen.cores)) != len(chosen.cores) or len(chosen.cores) > 2:
        parser.error("--cores: must be one number or two different ones")
    return chosen


def box_of(beads):
    return math.sqrt(beads * math.pi * measure.BEAD_RADIUS**2 / PHI_B)


def duration_of(beads, effort):
    return measure.whole_periods(max(effort.least, effort.bead_steps / beads * measure.RODWAKE_STEP))


def per_step(window):
    """CPU and wall of one step, s."""
    steps = window.simulated / measure.RODWAKE_STEP
    return window.cpu / steps, window.wall / steps


def measure_size(program, folder, beads, effort, cores):
    """For each number of threads, (CPU, wall) of a step in each round; thread numbers take turns."""
    scene = folder / "bed.toml"
    scene.write_text(measure.bed_scene(beads, box_of(beads)))
    found = {threads: [] for threads in range(1, len(cores) + 1)}
    for seed in range(1, effort.rounds + 1):
        for threads, results in found.items():
            window = measure.time_dem(program, scene, folder / "run", effort.warm, duration_of(beads, effort), seed,
                                      cores[:threads])
            results.append(per_step(window))
    return found


def table_row(beads, effort, found):
    row = [f"{beads}", f"{duration_of(beads, effort):g}"]
    walls = {}
    for threads, results in found.items():
        cpu, wall = zip(*results)
        walls[threads] = statistics.median(wall)
        row += [measure.spread([1e9 * value / beads for value in cpu]), measure.spread([1e6 * value for value in wall])]
    return row + ([f"{walls[1] / walls[2]:.2f}"] if 2 in walls else [])


def exponent(costs):
    """Slope of log(cost) over log(beads)."""
    return statistics.linear_regression([math.log(n) for n in costs], [math.log(c) for c in costs.values()]).slope


def print_conditions(program, effort, cores):
    print("## rodwake against the number of beads, phi_b = 0.80\n")
    for line in measure.conditions() + measure.version_lines(program):
        print(f"- {line}")
    print(f"- {effort.rounds} rounds; cores {cores}; warm-up {effort.warm:g} s simulated, step {measure.RODWAKE_STEP:g} s")
    shown = measure.dem_command(Path("rodwake"), "bed.toml", "DIR", effort.warm, "TIMED", "ROUND", cores[:1])
    print(f"- {' '.join(shown)} (and once with a duration of one step)\n", flush=True)


def scale():
    chosen = options()
    measure.need_command("taskset", "util-linux")
    measure.check_cores(chosen.cores)
    program = measure.find_program(chosen.program)
    effort = QUICK if chosen.quick else FULL
    effort.rounds = chosen.rounds or effort.rounds
    effort.sizes = chosen.sizes or effort.sizes
    print_conditions(program, effort, chosen.cores)
    rows, costs = [], {threads: {} for threads in range(1, len(chosen.cores) + 1)}
    with tempfile.TemporaryDirectory() as name:
        for beads in effort.sizes:
            found = measure_size(program, Path(name), beads, effort, chosen.cores)
            rows.append(table_row(beads, effort, found))
            for threads, results in found.items():
                costs[threads][beads] = statistics.median(cpu for cpu, _ in results)
            print("  " + " | ".join(rows[-1]), file=sys.stderr, flush=True)
    head = ["beads", "timed s"]
    for threads in costs:
        head += [f"-j {threads}: CPU ns per bead and step", f"-j {threads}: wall us per step"]
    measure.print_table(head + (["speed-up (wall)"] if 2 in costs else []), rows)
    print("\nMedian (min - max).")
    if len(effort.sizes) > 1:
        slopes = ", ".join(f"-j {threads}: {exponent(of):.3f}" for threads, of in costs.items())
        print(f"CPU per step ~ beads^p, p: {slopes}")


if __name__ == "__main__":
    measure.main(scale)
