#!/usr/bin/python3
"""Validation of the granular simulator: every number of docs/validation_granular.md that comes from a bed.

    studies/validate_granular.py [--program build/release/rodwake] [--only lone,beads,order,bed,steps,pairs,impacts,force,yield] [--quick]
                               [-j 2] [--keep DIR]

Prints Markdown. Each line gives mean +- standard error, the number of runs and what was asked. --quick: few and short runs, to
see that everything works; its numbers mean little.
"""

import argparse
import csv
import json
import math
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy

SOURCE = Path(__file__).resolve().parent.parent
BOX = 'box = "78 a"\n'
UNSTRAINED = 'box = "fit"\n'
QUIET = "[granular.output]\nformats = []\nlast_period = false\n"


class Lab:
    """Runs scenes and reads their summaries."""

    def __init__(self, options, folder):
        self.program, self.threads, self.quick = options.program, options.j, options.quick
        self.folder, self.count = Path(folder), 0

    def run(self, keys, rods="", runs=1):
        self.count += 1
        scene = self.folder / f"{self.count:03d}.toml"
        runs = min(runs, 2) if self.quick else runs
        scene.write_text(f"schema = 1\n[granular]\nruns = {runs}\n{keys}{QUIET}{rods}")
        out = self.folder / f"{self.count:03d}"
        command = [self.program, "dem", str(scene), "-o", str(out), "-j", str(self.threads), "--quiet"]
        done = subprocess.run(command, capture_output=True, text=True)
        if done.returncode != 0:
            sys.exit(f"{' '.join(command)}: exit code {done.returncode}\n{done.stderr}\n{scene.read_text()}")
        return json.loads((out / "summary.json").read_text()), out

    def seconds(self, value):
        return f'"{value / 10 if self.quick else value} s"'


def rod(x, y, kind="motile", extra=""):
    return f'[[granular.rods]]\nkind = "{kind}"\nposition = ["{x} a", "{y} a"]\n{extra}'


def table(title, head, rows):
    print(f"\n### {title}\n\n| " + " | ".join(head) + " |\n|" + "---|" * len(head))
    for row in rows:
        print("| " + " | ".join(row) + " |", flush=True)
    print(flush=True)


def with_error(value, error, scale=1.0, digits=3):
    return f"{scale * value:.{digits}f} +- {scale * error:.{digits}f}"


def impacts(lab):
    data = SOURCE / "tests/granular/data/stronge_impacts.csv"
    lines = [line for line in data.read_text().splitlines() if not line.startswith("#")]
    wanted = list(csv.DictReader(lines))
    answer = subprocess.run([lab.program, "impact", "--cases", str(data)], capture_output=True, text=True, check=True)
    worst = 0.0
    for given, got in zip(wanted, csv.DictReader(answer.stdout.splitlines()), strict=True):
        size = math.hypot(*(float(given[k]) for k in ("Px", "Py", "Pz")))
        worst = max(worst, math.hypot(*(float(given[k]) - float(got[k]) for k in ("Px", "Py", "Pz"))) / size)
    table("Single impacts", ["cases", "largest error of P, of |P|", "asked"], [[str(len(wanted)), f"{worst:.1e}", "1e-9"]])


def lone(lab):
    cases = [("motile", "", 16, "2 to 4"), ("apolar", "", 64, "0 within 2 errors"), ("motile", 'taper = "stepwise"\n', 16, "")]
    rows = []
    for kind, shape, runs, asked in cases:
        for dt in ("5e-6", "1e-5", "2e-5", "5e-5", "1e-4"):
            keys = f'beads = 0\n{BOX}time_step = "{dt} s"\nequilibrate = "0.1 s"\nduration = {lab.seconds(5)}\n'
            s, _ = lab.run(keys, rod(39, 39, kind, shape), runs)
            r = s["rods"][0]
            name = kind + (", stepwise" if shape else "")
            rows.append([name, dt, with_error(r["mean_speed"], r["mean_speed_error"], 1e3, 4), str(s["runs"]), asked])
    table("Lone rod at Gamma = 7, + = thin end first", ["rod", "dt, s", "speed, mm/s", "runs", "asked"], rows)


def beads(lab):
    rows = []
    for dt in ("5e-6", "1e-5", "2e-5", "5e-5", "1e-4"):
        keys = f'phi_b = 0.80\n{BOX}time_step = "{dt} s"\nequilibrate = "0.5 s"\nduration = {lab.seconds(2)}\n'
        s, _ = lab.run(keys, runs=8)
        rows.append([dt, with_error(s["T_xy"], s["T_xy_error"], 1e5), with_error(s["T_z"], s["T_z_error"], 1e3, 4),
                     f'{s["max_overlap"]:.4f}', str(s["runs"])])
    rows.append(["soft spheres, stiff limit", "5.2", "1.69", "", ""])
    table("Beads alone, phi_b = 0.80", ["dt, s", "T_xy, 1e-5 m^2/s^2", "T_z, 1e-3 m^2/s^2", "largest overlap, a", "runs"], rows)


def order(lab):
    rows = []
    for phi in (0.66, 0.68, 0.70, 0.71, 0.72, 0.73, 0.74, 0.76, 0.78, 0.80):
        row = [f"{phi:.2f}"]
        for start, equilibrate, duration in (("lattice", 8, 8), ("random", None, 8)):
            wait = "" if equilibrate is None and not lab.quick else f"equilibrate = {lab.seconds(equilibrate or 2)}\n"
            keys = f'phi_b = {phi}\n{BOX}start = "{start}"\n{wait}duration = {lab.seconds(duration)}\n'
            s, _ = lab.run(keys, runs=4)
            row.append(with_error(s["psi6"], s["psi6_error"]))
        rows.append(row)
    table("Order: psi_6 over 8 s, 4 runs each", ["phi_b", "from the lattice (8 s before)", "from a random start (default wait)"], rows)


def bed(lab):
    rows = []
    for phi in (0.70, 0.76, 0.80):
        keys = f"phi_b = {phi}\n{BOX}duration = {lab.seconds(10)}\n"
        s, _ = lab.run(keys, rod(20, 39), 16)
        r = s["rods"][0]
        rows.append([f"{phi:.2f}", with_error(r["mean_speed"], r["mean_speed_error"], 1e3),
                     with_error(r["force"], r["force_error"], 1e6), str(s["runs"])])
    table("One rod in the bed, 10 s", ["phi_b", "speed, mm/s", "force on the beads, uN", "runs"], rows)


def steps(lab):
    rows = []
    for phi, runs in ((0.70, 16), (0.80, 32)):  # in the crystal a rod's speed scatters more
        for dt in ("1.25e-5", "2.5e-5", "5e-5", "1e-4"):
            keys = f'phi_b = {phi}\n{BOX}time_step = "{dt} s"\nduration = {lab.seconds(10)}\n'
            s, _ = lab.run(keys, rod(20, 39), runs)
            r = s["rods"][0]
            rows.append([f"{phi:.2f}", dt, with_error(r["mean_speed"], r["mean_speed_error"], 1e3),
                         with_error(s["T_xy"], s["T_xy_error"], 1e5), with_error(s["T_z"], s["T_z_error"], 1e3, 4),
                         f'{s["cpu_seconds"] / (s["runs"] * (s["simulated_time"] + 0.5)):.3f}', str(s["runs"])])
    table("What the time step changes: one rod in the bed, 10 s",
          ["phi_b", "dt, s", "speed, mm/s", "T_xy, 1e-5 m^2/s^2", "T_z, 1e-3 m^2/s^2", "CPU s per simulated s", "runs"], rows)


def pairs(lab):
    rows = []
    cases = [("motile", 0.70, 0), ("motile", 0.78, 0), ("motile", 0.70, 90), ("motile", 0.78, 90),
             ("apolar", 0.70, 0), ("apolar", 0.78, 0)]
    for kind, phi, angle in cases:
        moving = kind == "motile"
        stop = 'stop_at_travel = "39.01 a"\n' if moving and not lab.quick else ""
        keys = (f'phi_b = {phi}\n{BOX}orientation = "{angle} deg"\n{stop}'
                f"duration = {lab.seconds(60 if moving else 14)}\n")
        s, out = lab.run(keys, rod(20, 46.5, kind) + rod(20, 31.5, kind), 50)
        pair, a = s["pair"], s["bead_radius"]
        if moving and "half_box_separation_change" in pair:
            change, error = pair["half_box_separation_change"], pair["half_box_separation_change_error"]
        else:
            change, error = pair["separation_change"], pair["separation_change_error"]
        sigma = abs(change) / error if error else float("nan")
        rows.append([kind, f"{phi:.2f}", str(angle), with_error(change, error, 1 / a, 2), f"{sigma:.1f}",
                     f'{pair.get("half_box_time", s["simulated_time"]):.1f}', f'{pair["half_box_runs"]}/{s["runs"]}'])
    table("Two rods side by side, 15 a apart: change of their separation over half the box (apolar: in 14 s)",
          ["rods", "phi_b", "lattice turned by", "change, a", "in errors", "time, s", "runs that got there"], rows)


def force(lab):
    rows = []
    for speed in (0.25, 0.5, 1.0, 2.0, 4.0):
        keys = f"phi_b = 0.80\n{BOX}duration = {lab.seconds(10)}\n"
        s, _ = lab.run(keys, rod(20, 39, extra=f'imposed_speed = "{speed} mm/s"\n'), 8)
        r = s["rods"][0]
        rows.append([f"{speed:g}", with_error(r["force"], r["force_error"], 1e6), str(s["runs"])])
    table("Force on the beads of a rod held at a speed, phi_b = 0.80, 10 s", ["speed, mm/s", "force, uN", "runs"], rows)


def crossing(thrust, force):
    """Speed at which two straight lines through (v, f, error) meet, with the error of their coefficients carried on."""
    lines = [numpy.polyfit(v, f, 1, w=1 / error, cov="unscaled") for v, f, error in (numpy.array(t).T for t in (thrust, force))]
    (slope, at_rest), (c, f0) = lines[0][0], lines[1][0]
    v = (at_rest - f0) / (c - slope)
    gradient = numpy.array([v, 1.0]) / (c - slope)
    return v, math.sqrt(sum(gradient @ covariance @ gradient for _, covariance in lines))


def yielding(lab):
    """Thrust of a lone rod held at a speed against the force that the bed takes at it: where they are equal it should walk."""
    speeds, rows, summary = (0.5, 1.0, 1.5, 2.0, 2.5), [], []
    held = {}
    for phi in (None, 0.70, 0.80):
        bed = f"beads = 0\n{BOX}" if phi is None else f"phi_b = {phi}\n{UNSTRAINED}"
        for speed in (0.0, *speeds) if phi is None else speeds:
            keys = f"{bed}equilibrate = \"0.5 s\"\nduration = {lab.seconds(10)}\n"
            s, _ = lab.run(keys, rod(20, 39, extra=f'imposed_speed = "{speed} mm/s"\n'), 16)
            r = s["rods"][0]
            held.setdefault(phi, []).append([speed] + [1e6 * r[k] for k in ("thrust", "thrust_error", "force", "force_error")])
            rows.append(["none" if phi is None else f"{phi:.2f}", f"{speed:g}", with_error(r["thrust"], r["thrust_error"], 1e6),
                         with_error(r["force"], r["force_error"], 1e6)])
    table("Thrust of the plates on a rod held at a speed, and its force on the beads, 10 s, 16 runs",
          ["phi_b", "speed, mm/s", "thrust, uN", "force, uN"], rows)
    lone = [point[:3] for point in held[None]]
    for phi in (0.70, 0.80):
        s, _ = lab.run(f"phi_b = {phi}\n{UNSTRAINED}duration = {lab.seconds(10)}\n", rod(20, 39), 16)
        r = s["rods"][0]
        force, own = [[p[0], p[3], p[4]] for p in held[phi]], [p[:3] for p in held[phi]]
        summary.append([f"{phi:.2f}", with_error(*crossing(lone, force)), with_error(*crossing(own, force)),
                        with_error(r["mean_speed"], r["mean_speed_error"], 1e3), with_error(r["thrust"], r["thrust_error"], 1e6),
                        with_error(r["force"], r["force_error"], 1e6)])
    table("Speed from thrust = force, and the free rod's",
          ["phi_b", "lone rod's thrust, mm/s", "thrust in the bed, mm/s", "free, mm/s", "its thrust, uN", "its force, uN"], summary)


PARTS = {"impacts": impacts, "lone": lone, "beads": beads, "order": order, "bed": bed, "steps": steps, "pairs": pairs,
         "force": force, "yield": yielding}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", default=str(SOURCE / "build/release/rodwake"))
    parser.add_argument("--only", default=",".join(PARTS), help="parts, comma-separated: " + ", ".join(PARTS))
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("-j", type=int, default=2, help="threads")
    parser.add_argument("--keep", help="folder for the runs; otherwise they are removed")
    options = parser.parse_args()
    parts = options.only.split(",")
    unknown = [part for part in parts if part not in PARTS]
    if unknown:
        parser.error(f"no such part: {', '.join(unknown)}; there are {', '.join(PARTS)}")
    with tempfile.TemporaryDirectory() as scratch:
        folder = Path(options.keep or scratch)
        folder.mkdir(parents=True, exist_ok=True)
        lab = Lab(options, folder)
        version = subprocess.run([options.program, "--version"], capture_output=True, text=True, check=True).stdout.strip()
        print(f"{version}, {time.strftime('%Y-%m-%d')}" + (" (quick: numbers mean little)" if options.quick else ""))
        for part in parts:
            began = time.monotonic()
            PARTS[part](lab)
            print(f"({part}: {time.monotonic() - began:.0f} s)", flush=True)


if __name__ == "__main__":
    main()
