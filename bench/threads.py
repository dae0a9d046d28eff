#!/usr/bin/python3
"""What threads that nobody asked for cost or gain: the default of -j over -j 1, alone and beside a busy process.

    bench/threads.py [--program PATH] [--rounds N] [--only WORD] [--quick]

Beds at phi_b = 0.80 shaken with Gamma = 7, and rods as in scenes/crowd.toml. Whole processes are timed, start and files included;
-j 1 and the default take turns, so that both meet the same machine. The ratio is the median of those of the turns; it should be at
most 1.05. Beside: a process that never waits on all cores but one. Prints Markdown; takes some five minutes on two cores.
"""

import argparse
import math
import os
import statistics
import subprocess
import sys
import tempfile
import time
from contextlib import contextmanager
from pathlib import Path

import measure

BEDS = {500: 6.0, 1549: 4.5, 6110: 0.9, 24440: 0.2, 100000: 0.1}  # beads: simulated s, about a second on one thread each
RODS = {100: 10.0, 1000: 0.6}  # rods: f/(mu v0)


def bed_command(folder, beads, duration):
    scene = folder / f"{beads}.toml"
    scene.write_text(measure.bed_scene(beads, 78 * measure.BEAD_RADIUS * math.sqrt(beads / 1549)))
    return ["dem", str(scene), "-s", "granular.equilibrate=0", "-s", f"granular.duration={duration}"]


def rods_command(rods, t_end):
    return ["rods", str(measure.SOURCE / "scenes" / "crowd.toml"), "-s", f"rods_random.count={rods}", "-s", f"rods_run.t_end={t_end}",
            "-s", f"rods_random.extent={2.33 * math.sqrt(rods):.3g}", "-s", "rods_order.from=0", "-s", f"rods_run.output_interval={t_end / 10}"]


@contextmanager
def busy(processes):
    hogs = [subprocess.Popen([sys.executable, "-c", "while True: pass"]) for _ in range(processes)]
    try:
        yield
    finally:
        for hog in hogs:
            hog.kill()
            hog.wait()


def timed(command):
    """Wall and system seconds."""
    start = time.monotonic()
    child = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
    said = child.stderr.read()
    _, status, used = os.wait4(child.pid, 0)
    child.returncode = os.waitstatus_to_exitcode(status)
    if child.returncode != 0:
        raise measure.Problem(f"{' '.join(command)}\nended with {child.returncode}:\n{said.decode()[-2000:]}")
    return time.monotonic() - start, used.ru_stime


def compare(command, rounds):
    """Cells: -j 1, s; default, s; its system time, s; ratio."""
    turns = []
    for turn in range(rounds + 1):  # the first warms up
        ways = {"one": [*command, "-j", "1"], "default": command}
        turns.append({way: timed(ways[way]) for way in (ways if turn % 2 else reversed(ways))})
    one, default = ([turn[way][0] for turn in turns[1:]] for way in ("one", "default"))
    system = statistics.median(turn["default"][1] for turn in turns[1:])
    ratio = statistics.median(b / a for a, b in zip(one, default))
    return [f"{statistics.median(one):.3g}", f"{statistics.median(default):.3g}", f"{system:.2g}", f"{ratio:.2f}"]


def cases(folder, share):
    beds = {f"{beads} beads": bed_command(folder, beads, share * duration) for beads, duration in BEDS.items()}
    return beds | {f"{rods} rods": rods_command(rods, share * t_end) for rods, t_end in RODS.items()}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", help="rodwake to measure [build/release/rodwake]")
    parser.add_argument("--rounds", type=int, default=5, help="turns of each case [5]")
    parser.add_argument("--only", default="", help="cases with this word, \"rods\"")
    parser.add_argument("--quick", action="store_true", help="a tenth of each run: a trial, not a measurement")
    options = parser.parse_args()
    program = measure.find_program(options.program)
    print(*measure.conditions(), *measure.version_lines(program), "", sep="\n", flush=True)
    head = ["-j 1, s", "default, s", "its system time, s", "ratio"]
    measure.print_table(["", *(f"{when}: {name}" for when in ("alone", "beside") for name in head)], [])
    with tempfile.TemporaryDirectory() as name:
        for case, command in cases(Path(name), 0.1 if options.quick else 1.0).items():
            if options.only not in case:
                continue
            command = [str(program), *command, "--quiet", "--force", "-o", str(Path(name) / command[0])]
            alone = compare(command, options.rounds)
            with busy(max(1, os.cpu_count() - 1)):
                beside = compare(command, options.rounds)
            print("| " + " | ".join([case, *alone, *beside]) + " |", flush=True)


if __name__ == "__main__":
    measure.main(main)
