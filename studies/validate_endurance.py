#!/usr/bin/python3
"""Endurance of beds: 10^9 bounces off plates over a grid of restitution and shaking; studies/reports/granular.md has the table.

    studies/validate_endurance.py [--program build/release/rodwake] [--bounces 1e9] [--minutes 30] [--keep DIR] [--quick] [--report]

Beds of beads, a motile and an apolar rod, in turns periodic and in a dish, every coefficient of restitution e, gamma times gravity.
They run one after the other, setting by setting, those that bounce again and again, until there are so many bounces or the time is
over. Each must go on at a bounded
cost, lose no body, and take no more energy than plates can give. A run that the guard of the time step stops is no bounce and runs
again with the step that the message advises. --keep has a CSV file for each setting with a row for each run: the same command adds
to them. Prints Markdown; exit code 1 if anything was wrong.

Impulses of plates are the program's own count (rodwake info final.rwc). A bead at rest on a plate gets one each step, so they count as
bounces only in the settings of bouncing(), where at least 85 of 100 are. Energy: an impulse P of a plate that moves at V at most does at most the work
V P, and impacts only lose, so between two rows of table.csv energy rises by at most V times the impulse of both plates.
"""

import math
import re
import shutil
import sys
import time

import h5py
import numpy as np

from lab import columns, keep_row, kept_rows, parser, run_parts, table, read_json

RESTITUTIONS = (0, 0.3, 0.6, 0.9, 0.99)
GAMMAS = (0.5, 1, 3, 7, 20, 50)
A, GAP, FREQUENCY, GRAVITY = 0.4e-3, 1.2e-3, 200.0, 9.81  # of the scene, SI
RUN_SECONDS = 15.0  # of CPU time a run
SLOW = 10.0         # us of wall clock a body and step: usual is 0.02 to 0.5, beside other work
SCENE = """schema = 1
[granular]
phi_b = 0.6
{place}
{step}
equilibrate = "0.5 s"
duration = "{duration} s"
[granular.plates]
gamma = {gamma}
[granular.contacts]
particle_particle = {{ friction = 0.05, restitution = {e} }}
rod_wall = {{ friction = 0.03, restitution = {e} }}
bead_wall = {{ friction = 0.2, restitution = {e} }}
[granular.output]
frames = "{frames} s"
table = "3.7 ms"
formats = ["h5md"]
last_period = false
[[granular.rods]]
position = ["18 a", "18 a"]
[[granular.rods]]
kind = "apolar"
position = ["44 a", "44 a"]
heading = "90 deg"
"""
PLACES = ('box = "62 a"', 'container = { radius = "31 a" }')
SIDE = 62 * A


def bouncing(e, gamma):
    """Whether impulses of plates are bounces: by a build that counted both, 86 to 100 of 100 here, at most 58 elsewhere."""
    return e**2 * gamma > 0.9


def plate_speed(gamma):
    return gamma * GRAVITY / (2 * math.pi * FREQUENCY)


def speed_alone(e, gamma):
    """Largest speed of a bead that meets plates only: what it has after falling through the whole gap, times e, and 1 + e plates'."""
    fall = 2 * GRAVITY * (GAP - 2 * A + 2 * gamma * GRAVITY / (2 * math.pi * FREQUENCY) ** 2)
    speed = 0.0
    for _ in range(10000):
        speed = math.sqrt((e * speed + (1 + e) * plate_speed(gamma)) ** 2 + fall)
    return speed


# What is wrong with a run.


def lost(out, gamma, dish):
    """(deepest of all spheres in a plate or wall in all frames, in bead radii; frames; what is not finite or was lost)."""
    with h5py.File(out / "trajectory.h5md") as file:
        group = file["particles/trajectory"]
        radius = group["radius"][()]
        times = group["box/edges/time"][()]
        position, velocity = group["position/value"], group["velocity/value"]
        deepest, wrong = 0.0, ""
        for k, t in enumerate(times):
            x = position[k].astype(float)
            if not (np.isfinite(x).all() and np.isfinite(velocity[k]).all()):
                return deepest, k, f"not finite at {t:g} s"
            floor = gamma * GRAVITY / (2 * math.pi * FREQUENCY) ** 2 * math.cos(2 * math.pi * FREQUENCY * t)
            depth = np.maximum(floor + radius - x[:, 2], x[:, 2] + radius - floor - GAP)
            if dish:
                depth = np.maximum(depth, np.hypot(x[:, 0] - SIDE / 2, x[:, 1] - SIDE / 2) + radius - SIDE / 2)
            elif (x[:, :2] < 0).any() or (x[:, :2] > SIDE).any():
                wrong = f"outside of the box at {t:g} s"
            deepest = max(deepest, depth.max() / A)
        return deepest, len(times), wrong or ("a body has left" if deepest > 0.5 else "")


def energy_of(out, e, gamma):
    """(largest rise of the energy between two rows over what plates can give, largest kinetic energy over that of all mass at the full speed of a bead alone)."""
    energy, kinetic, floor, lid = columns(out / "table.csv", "energy", "kinetic", "floor_impulse", "lid_impulse")
    given = plate_speed(gamma) * (np.diff(floor) - np.diff(lid))
    rounding = 1e-12 * np.abs(energy[1:])  # of sums over all bodies
    with h5py.File(out / "trajectory.h5md") as file:
        is_bead = file["particles/trajectory/species"][()] == 0
        mass = file["particles/trajectory/mass"][is_bead].sum() + file["particles/trajectory_rods/mass"][()].sum()
    return (np.diff(energy) / (given + rounding)).max(), kinetic[1:].max() / (0.5 * mass * speed_alone(e, gamma) ** 2)


def slowest(out, bodies, step):
    """Wall-clock time a body and step, us, in the slowest of twenty stretches."""
    line = re.compile(r"\d+-\d+-\d+ (\d+):(\d+):([\d.]+) info: +(-?\d+\.\d{3}) ")
    found = [line.match(text) for text in (out / "log.txt").read_text().splitlines()]
    at = np.array([[3600 * int(m[1]) + 60 * int(m[2]) + float(m[3]), float(m[4])] for m in found if m])
    at = at[np.diff(at[:, 1], prepend=-1.0) > 0]
    return (np.diff(at[:, 0]) % 86400 / np.diff(at[:, 1])).max() * step / bodies * 1e6


def impulses(lab, out):
    text = re.search(r"^impulses: (.*)$", lab.call("info", out / "final.rwc").stdout, re.MULTILINE)[1]
    return {name: int(count) for name, count in (one.rsplit(" ", 1) for one in text.split(", "))}


# Runs of a setting.


def run(lab, e, gamma, rows):
    """The row of one more run."""
    sound = [row for row in rows if row["ended"] == "finished"]
    seed, dish, step = len(rows) + 1, len(rows) % 2, rows[-1]["next_step"] if rows else ""
    cost = float(sound[-1]["cpu"]) / float(sound[-1]["simulated"]) if sound else None
    duration = 2.0 if cost is None else max(1.0, round((0.5 if lab.quick else RUN_SECONDS) / cost, 1))
    scene = SCENE.format(place=PLACES[dish], step=f'time_step = "{step} s"' if step else "", duration=duration, gamma=gamma, e=e,
                         frames=duration / 50)
    lab.write("endurance.toml", scene)
    out = lab.folder / "run"
    shutil.rmtree(out, ignore_errors=True)
    done = lab.call("dem", "endurance.toml", "-o", out, "--quiet", "-j", 1, "--seed", seed, good=(), timeout=3600)
    row = {"seed": seed, "dish": dish, "step": step, "ended": "finished", "wrong": "", "next_step": step}
    advice = re.search(r"try ([\d.e-]+) s in a new folder", done.stderr)
    if done.returncode == 1 and advice:
        return {**row, "ended": "guard: " + re.search(r"\): (.*?)\. The", done.stderr)[1], "next_step": advice[1]}
    if done.returncode != 0:
        return {**row, "ended": f"exit code {done.returncode}", "wrong": done.stderr.strip()[-200:]}
    return {**row, **judged(lab, out, e, gamma, dish)}


COUNTS = ("bead-plate", "rod-plate", "bead-bead", "bead-rod", "rod-rod", "bead-wall", "rod-wall")


def judged(lab, out, e, gamma, dish):
    s, counts = read_json(out, "summary"), impulses(lab, out)
    deepest, frames, wrong = lost(out, gamma, dish)
    rise, kinetic = energy_of(out, e, gamma)
    slow = slowest(out, s["beads"] + 2, s["time_step"])
    problems = [wrong, "energy" if rise > 1 or kinetic > 1 else "", "slow" if slow > SLOW else ""]
    return {"step": s["time_step"], "simulated": s["simulated_time"] + 0.5, "cpu": s["cpu_seconds"], "beads": s["beads"],
            **{name: counts[name] for name in COUNTS}, "frames": frames, "deepest": deepest, "rise": rise, "kinetic": kinetic,
            "slowest": slow, "overlap": s["max_overlap"], "wrong": "; ".join(filter(None, problems))}


FIELDS = ("seed", "dish", "step", "ended", "next_step", "simulated", "cpu", "beads", *COUNTS, "frames", "deepest", "rise", "kinetic",
          "slowest", "overlap", "wrong")


def one_more(lab, e, gamma):
    path = lab.folder / f"e{e}_gamma{gamma}.csv"
    row = run(lab, e, gamma, kept_rows(path))
    keep_row(path, {name: row.get(name, "") for name in FIELDS})
    if row["wrong"]:
        print(f"e = {e}, gamma = {gamma}, seed {row['seed']}: {row['wrong']}", file=sys.stderr, flush=True)
        shutil.copytree(lab.folder / "run", lab.folder / f"wrong_e{e}_gamma{gamma}_{row['seed']}", dirs_exist_ok=True)


# The table.


def number(row, key):
    return float(row[key] or 0)


def summary(e, gamma, rows):
    good = [row for row in rows if row["ended"] == "finished"]
    if not good:
        return [e, gamma, 0, "", "", "", "", "", "", "", len(rows), sum(bool(row["wrong"]) for row in rows)]
    total = {key: sum(number(row, key) for row in good) for key in ("simulated", "cpu", "bead-plate", "rod-plate")}
    impulses_given = total["bead-plate"] + total["rod-plate"]
    most = {key: max(number(row, key) for row in good) for key in ("deepest", "rise", "kinetic", "slowest", "overlap")}
    per_step = total["bead-plate"] / sum(number(row, "simulated") / number(row, "step") * number(row, "beads") for row in good)
    return [e, gamma, f"{total['simulated']:.0f}", f"{impulses_given:.2e}", f"{per_step:.2f}",
            f"{1e6 * total['cpu'] / impulses_given:.2f}",
            f"{most['slowest']:.2f}", f"{most['deepest']:.3f}", f"{most['rise']:.3f}", f"{most['kinetic']:.3f}",
            len(rows) - len(good), sum(bool(row["wrong"]) for row in rows)]


HEAD = ["e", "Gamma", "simulated, s", "impulses of plates", "a bead and step", "CPU us each", "slowest, us a body and step", "deepest, a",
        "energy risen / most", "kinetic / most", "stopped by the guard", "wrong"]


def bounces_of(e, gamma, rows):
    return sum(number(row, "bead-plate") + number(row, "rod-plate") for row in rows) if bouncing(e, gamma) else 0


def main():
    reader = parser(__doc__, "report", "quick", "keep", parts=("all",))
    reader.add_argument("--bounces", type=float, default=1e9)
    reader.add_argument("--minutes", type=float, default=60.0, help="after which no run begins [60]")
    options = reader.parse_args()
    grid = [(e, gamma) for e in RESTITUTIONS for gamma in GAMMAS]
    end = time.monotonic() + 60 * options.minutes
    found = []

    def endurance(lab):
        def kept(e, gamma):
            return kept_rows(lab.folder / f"e{e}_gamma{gamma}.csv")
        for e, gamma in grid * (1 if lab.quick else 1000):
            if len(kept(e, gamma)) >= 2 and not bouncing(e, gamma):  # both shapes: at rest no more will happen
                continue
            if time.monotonic() > end or sum(bounces_of(*one, kept(*one)) for one in grid) >= options.bounces:
                break
            one_more(lab, e, gamma)
        found.extend((e, gamma, kept(e, gamma)) for e, gamma in grid)
        table(f"{sum(bounces_of(*one) for one in found):.3e} bounces", HEAD, [summary(*one) for one in found])

    run_parts(options, {"all": endurance})
    return 1 if any(row["wrong"] for *_, rows in found for row in rows) else 0


if __name__ == "__main__":
    sys.exit(main())
