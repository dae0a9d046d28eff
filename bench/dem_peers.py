#!/usr/bin/python3
"""rodwake's granular simulator against LAMMPS on the same bed, one core each, in turns.

    bench/dem_peers.py [--program PATH] [--rounds N] [--core K] [--skin M] [--quick]

The bed: 1549 aluminium beads of radius a = 0.4 mm in a periodic box of 78 a (phi_b = 0.80) between plates 1.2 mm apart, shaken
at 200 Hz with Gamma = 7; no rods. LAMMPS is the packaged one (apt install lammps; GPL). It is only run, as a program of its
own, never linked. What its soft spheres need besides is in bench/peers/lammps/bed.py.

Both programs are pinned to the same core and run in turns, rodwake first in each round, with a new start each round. A warm-up
of the same simulated time is left out on both sides. Compared is CPU time per simulated second: a shared core spoils wall time.
rodwake: cpu_seconds of summary.json, less that of the same run ended after its warm-up; its samples (every 10 steps) and table
are in it. LAMMPS: user and system time of the process around the timed loop, in which it writes and samples nothing; LAMMPS'
own account (Loop time x CPU use) is printed beside it as a check.

What is compared are the programs as a user installs them. The packaged LAMMPS is built for any x86-64, rodwake's loops take the
widest vectors of the machine; and rigid impulses allow a ten times longer step than the springs do.

Prints Markdown. Compare on a quiet machine; --quick only shows that everything works.
"""

import argparse
import os
import re
import statistics
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

import measure

sys.path.insert(0, str(Path(__file__).resolve().parent / "peers" / "lammps"))
import bed

LAMMPS = Path(__file__).resolve().parent / "peers" / "lammps"


@dataclass
class Times:
    """Simulated seconds, in whole plate periods."""

    warm: float
    rodwake: float
    lammps: float
    sampled: float


@dataclass
class Figures:
    """One program in one round."""

    cpu: float  # s per simulated s
    check: float  # the same by another clock
    T_xy: float  # m^2/s^2
    T_z: float


def options():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", help="rodwake to measure [build/release/rodwake]")
    parser.add_argument("--rounds", type=int, default=5, help="repeats of each program [5]")
    parser.add_argument("--core", type=int, default=max(os.sched_getaffinity(0)), help="core to pin to [the last one]")
    parser.add_argument("--skin", type=float, default=1.5e-4, help="neighbour skin of LAMMPS, m [1.5e-4]")
    parser.add_argument("--quick", action="store_true", help="two short rounds: a trial, not a measurement")
    chosen = parser.parse_args()
    if chosen.rounds < 1 or not chosen.skin > 0:
        parser.error("--rounds and --skin must be positive")
    return chosen


def rodwake_round(program, folder, times, seed, core):
    scene = folder / "bed.toml"
    scene.write_text(measure.bed_scene(bed.BEADS, bed.BOX))
    window = measure.time_dem(program, scene, folder / "rodwake", times.warm, times.rodwake, seed, [core])
    return Figures(window.cpu / window.simulated, window.wall / window.simulated, window.summary["T_xy"],
                   window.summary["T_z"]), window.summary["max_overlap"]


def lammps_command(folder, times, skin, core):
    steps = {"warm": times.warm, "timed": times.lammps, "sampled": times.sampled}
    settings = {name: round(time / bed.STEP) for name, time in steps.items()}
    settings |= {"skin": skin, "clock": LAMMPS / "cpu_seconds.sh", "cpufile": folder / "cpu"}
    words = ["taskset", "-c", str(core), "lmp", "-in", str(LAMMPS / "bed.in"), "-log", str(folder / "log"), "-screen", "none"]
    for name, value in settings.items():
        words += ["-var", name, str(value)]
    # exec keeps the shell's number, so that LAMMPS gets its own
    return ["sh", "-c", 'exec "$@" -var pid $$', "sh", *words]


def lammps_round(folder, times, seed, skin, core):
    bed.write_case(folder, seed)
    (folder / "cpu").unlink(missing_ok=True)
    measure.run(lammps_command(folder, times, skin, core), cwd=folder, env={**os.environ, "OMP_NUM_THREADS": "1"})
    log = (folder / "log").read_text()
    loops = [float(text) for text in re.findall(r"^Loop time of ([\d.e+-]+) on", log, re.MULTILINE)]
    shares = [float(text) for text in re.findall(r"^([\d.]+)% CPU use", log, re.MULTILINE)]
    clock = [float(text) for text in (folder / "cpu").read_text().split()]
    if len(loops) != 3 or len(shares) != 3 or len(clock) != 2:
        raise measure.Problem(f"LAMMPS ran {len(loops)} loops and {len(clock)} clock readings; 3 and 2 were expected")
    cpu, own = clock[1] - clock[0], loops[1] * shares[1] / 100
    if abs(cpu - own) > 0.05 * own + 0.03:  # the process clock ticks every 0.01 s
        raise measure.Problem(f"LAMMPS used {cpu:.3f} s of CPU by the process clock and {own:.3f} s by its own account")
    sampled = (folder / "temperatures.dat").read_text().split("\n")[-2].split()
    return (Figures(cpu / times.lammps, own / times.lammps, float(sampled[1]), float(sampled[2])), log.split("\n")[0])


def print_conditions(program, chosen, times):
    print("## Bed of 1549 beads, no rods: rodwake and LAMMPS on one core\n")
    for line in measure.conditions() + measure.version_lines(program):
        print(f"- {line}")
    print(f"- {chosen.rounds} rounds on core {chosen.core}; warm-up {times.warm:g} s, timed {times.rodwake:g} s (rodwake, step "
          f"{measure.RODWAKE_STEP:g} s) and {times.lammps:g} s (LAMMPS, step {bed.STEP:g} s, kn {bed.KN:g} N/m, skin "
          f"{chosen.skin:g} m)")
    overlap = bed.deepest_overlap(bed.MASS / 2, 0.1) / bed.RADIUS
    print(f"- LAMMPS: a contact of two beads lasts {bed.contact_time(bed.MASS / 2) / bed.STEP:.0f} steps, overlap at 0.1 m/s "
          f"{overlap:.4f} a", flush=True)


def print_commands(program, times, skin, core):
    folder = Path("DIR")
    shown = measure.dem_command(Path("rodwake"), "bed.toml", folder, times.warm, times.rodwake, "ROUND", [core])
    print("\nCommands (in each round; rodwake a second time with a duration of one step):\n\n    " + " ".join(shown))
    words = [Path(word).name if word.startswith("/") else word for word in lammps_command(folder, times, skin, core)[4:]]
    print("    " + " ".join(words) + " -var pid PID")


def print_results(rodwake, lammps):
    rows = [[name, measure.spread([f.cpu for f in figures]), measure.spread([f.check for f in figures]),
             f"{statistics.median(1e6 * step * f.cpu for f in figures):.3g}",
             f"{statistics.median(f.T_xy for f in figures):.3g}", f"{statistics.median(f.T_z for f in figures):.3g}"]
            for name, step, figures in (("rodwake", measure.RODWAKE_STEP, rodwake), ("LAMMPS", bed.STEP, lammps))]
    print("\nMedian (min - max).\n")
    measure.print_table(["", "CPU s per simulated s", "by another clock (rodwake: wall; LAMMPS: loop x CPU use)",
                         "CPU us per step", "T_xy m^2/s^2", "T_z m^2/s^2"], rows)
    ratios = [b.cpu / a.cpu for a, b in zip(rodwake, lammps)]
    ratio = statistics.median(f.cpu for f in lammps) / statistics.median(f.cpu for f in rodwake)
    print(f"\nLAMMPS / rodwake, ratio of the medians: {ratio:.1f} (round by round {min(ratios):.1f} - {max(ratios):.1f})")


def compare():
    chosen = options()
    for name, package in (("lmp", "lammps"), ("taskset", "util-linux")):
        measure.need_command(name, package)
    measure.check_cores([chosen.core])
    program = measure.find_program(chosen.program)
    times = Times(0.2, 4.0, 0.2, 0.05)
    if chosen.quick:
        times, chosen.rounds = Times(0.05, 0.5, 0.025, 0.025), 2
    print_conditions(program, chosen, times)
    rodwake, lammps, overlaps = [], [], []
    with tempfile.TemporaryDirectory() as name:
        for seed in range(1, chosen.rounds + 1):
            figures, overlap = rodwake_round(program, Path(name), times, seed, chosen.core)
            rodwake.append(figures)
            overlaps.append(overlap)
            figures, version = lammps_round(Path(name), times, seed, chosen.skin, chosen.core)
            lammps.append(figures)
            print(f"  round {seed}: rodwake {rodwake[-1].cpu:.4g}, LAMMPS {figures.cpu:.4g} CPU s per simulated s, load "
                  f"{os.getloadavg()[0]:.2f}", file=sys.stderr, flush=True)
    print(f"- {version}, package lammps\n- rodwake: largest overlap of all rounds {max(overlaps):.4f} a")
    print_results(rodwake, lammps)
    print_commands(program, times, chosen.skin, chosen.core)


if __name__ == "__main__":
    measure.main(compare)
