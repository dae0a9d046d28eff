"""What the benchmark scripts share: the machine in words, runs of rodwake that are timed without their warm-up, tables."""

import datetime
import json
import math
import os
import re
import shutil
import statistics
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

SOURCE = Path(__file__).resolve().parent.parent
BEAD_RADIUS = 0.4e-3  # m
PLATE_PERIOD = 1 / 200  # s
RODWAKE_STEP = 1e-4  # s


class Problem(Exception):
    """Nothing can be measured; the text says why and what to do."""


@dataclass
class Window:
    """Cost of the stretch of a run after the warm-up."""

    simulated: float  # s
    cpu: float  # s
    wall: float  # s
    summary: dict


def find_program(path):
    """The rodwake to measure; only a Release build says anything."""
    program = Path(path).resolve() if path else SOURCE / "build" / "release" / "rodwake"
    if not program.is_file():
        raise Problem(f"{program}: no such program; build it (cmake --preset release && ninja -C build/release) or name "
                      "one with --program")
    if "Release" not in version_lines(program)[-1]:
        raise Problem(f"{program}: is no Release build ({version_lines(program)[-1]})")
    return program


def need_command(name, package):
    if shutil.which(name) is None:
        raise Problem(f"{name}: not found; apt install {package}")


def check_cores(cores):
    usable = os.sched_getaffinity(0)
    missing = [core for core in cores if core not in usable]
    if missing:
        raise Problem(f"core {missing[0]} is not one of the usable ones: {sorted(usable)}")


def version_lines(program):
    """rodwake and its commit; compiler; build type and flags."""
    text = run([str(program), "info"])
    return [re.sub(r"\s+", " ", line) for line in text.splitlines() if re.match(r"(rodwake|compiler|build) ", line)]


def cpu_model():
    found = re.search(r"^model name\s*:\s*(.+)$", Path("/proc/cpuinfo").read_text(), re.MULTILINE)
    return found[1] if found else "unknown"


def conditions():
    """Where and when, before anything was run."""
    load = " ".join(f"{value:.2f}" for value in os.getloadavg())
    return [f"date: {datetime.datetime.now().astimezone():%F %T %z}", f"CPU: {cpu_model()}, {os.cpu_count()} cores",
            f"load before (1, 5, 15 min): {load}"]


def run(command, **options):
    """Output of a command; what it said goes into the error if it fails."""
    done = subprocess.run(command, capture_output=True, text=True, **options)
    if done.returncode != 0:
        raise Problem(f"{' '.join(command)}\nended with {done.returncode}:\n{(done.stdout + done.stderr)[-2000:]}")
    return done.stdout


def bed_scene(beads, box):
    """The bare bed; all else are the defaults of the program. One row of the table in 0.05 s, no frames."""
    return (f"schema = 1\n[granular]\nbeads = {beads}\nbox = {box!r}\nbead_radius = {BEAD_RADIUS!r}\n"
            f"time_step = {RODWAKE_STEP!r}\nduration = 1.0\n[granular.plates]\ngap = 1.2e-3\nfrequency = 200.0\ngamma = 7.0\n"
            "[granular.output]\nformats = []\nlast_period = false\nframes = 1000.0\ntable = 0.05\ncheckpoint = 1e6\n")


def dem_command(program, scene, folder, warm, duration, seed, cores):
    return ["taskset", "-c", ",".join(map(str, cores)), str(program), "dem", str(scene), "-j", str(len(cores)), "--quiet",
            "--force", "--seed", str(seed), "-s", f"granular.equilibrate={warm}", "-s", f"granular.duration={duration}",
            "-o", str(folder)]


def run_dem(command):
    run(command)
    return json.loads((Path(command[-1]) / "summary.json").read_text())


def time_dem(program, scene, folder, warm, duration, seed, cores):
    """The run to the end less the same run (same seed, same steps) that ends one step after its warm-up. The program counts
    from its first step on, so neither has the making of the start in it."""
    first = run_dem(dem_command(program, scene, folder, warm, RODWAKE_STEP, seed, cores))
    whole = run_dem(dem_command(program, scene, folder, warm, duration, seed, cores))
    window = Window(whole["simulated_time"] - first["simulated_time"], whole["cpu_seconds"] - first["cpu_seconds"],
                    whole["wall_seconds"] - first["wall_seconds"], whole)
    if not window.cpu > 0:
        raise Problem(f"the warm-up alone took longer ({first['cpu_seconds']:.3g} s) than the whole run "
                      f"({whole['cpu_seconds']:.3g} s of CPU): time more simulated seconds")
    return window


def whole_periods(time):
    """At least `time`, in whole plate periods, at least one, so that every phase counts alike."""
    return max(1, math.ceil(time / PLATE_PERIOD - 1e-9)) * PLATE_PERIOD


def spread(values, digits=3):
    """median (min - max)"""
    return (f"{statistics.median(values):.{digits}g} ({min(values):.{digits}g} - {max(values):.{digits}g})")


def print_table(head, rows):
    for cells in (head, ["---"] * len(head), *rows):
        print("| " + " | ".join(str(cell) for cell in cells) + " |")


def main(measure):
    """Exit code 1 and one message if nothing can be measured."""
    try:
        measure()
    except Problem as problem:
        sys.exit(f"{Path(sys.argv[0]).name}: {problem}")
