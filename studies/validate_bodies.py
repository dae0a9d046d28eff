#!/usr/bin/python3
"""Rods with bodies: what stall_overlap and rtol cost and change, extremes, which contacts of two rods last, crowds with and without wakes.

    studies/validate_bodies.py [--program build/release/rodwake] [--only trade,extremes,bound] [--runs 2] [--quick] [--keep DIR] [--report]

trade     two encounters against stall_overlap s, with the limit s -> 0 of hard rods, and against rtol: error, steps, CPU time. A minute.
extremes  25 cells of bodies and starts, each with the end that it must have; exit code 1 if one has another. Half a minute.
bound     two rods that meet at an angle: `bound` or not against kappa, angle and taper. Writes studies/bodies_bound.csv. A minute.
crowd     1000 and 10^4 rods with wakes for one length (chosen by --only): CPU time of 100 lengths. Some minutes.
crowds    200 rods in a periodic box and 2000 from a square on the plane (chosen by --only): order and clusters against density and kappa, from
          ordered and from random starts. Rows of studies/crowds.csv; runs that have rows are not made again, so another --runs adds
          seeds and --runs 0 shows what there is. 60 CPU seconds a run with wakes.
"""

import math
import resource
import subprocess
import sys

from lab import SOURCE, keep_row, kept_rows, parser, rows, run_parts, table, text as shown, read_json

SCENE = """schema = 1
[medium]
eta = 1.0
alpha = 1.0
[coupling]
kappa = {kappa}
[body]
{body}
{rods}
[rods_run]
t_end = {t_end}
{run}
"""


def rod(x, y, heading, body=""):
    return f"[[rods]]\nposition = [{x!r}, {y!r}]\nheading = {heading!r}\n{body}\n"


def scene(rods, kappa=0.0, t_end=4.0, body="", run=""):
    return SCENE.format(kappa=kappa, body=body, rods="".join(rod(*one) for one in rods), t_end=t_end, run=run)


def cpu():
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def solved(lab, text, *settings):
    """Outcome, last poses and CPU time of a run."""
    began = cpu()
    lab.call("rods", lab.write("run.toml", text), "--quiet", "--force", "-j", 1, "-o", lab.folder / "run", *(f"-s{one}" for one in settings))
    last = rows(lab.folder / "run/rods.csv")[-1]
    return read_json(lab.folder / "run", "outcome"), [float(value) for name, value in last.items() if name != "t"], cpu() - began


def distance(one, other):
    return max(abs(a - b) for a, b in zip(one, other))


# Two rods that cross and turn each other, and two that meet head on, a tenth of their width aside, and slide past.
ENCOUNTERS = {"crossing": scene([(0.0, 0.0, 0.2), (1.6, -1.3, 1.7)], kappa=2.0, t_end=4.0),
              "head on": scene([(0.0, 0.0, 0.0), (2.0, 0.03, math.pi)], t_end=4.0)}
OVERLAPS = (0.1, 0.05, 0.02, 0.01, 3e-3, 1e-3, 3e-4, 1e-4)


def trade(lab):
    lines, tolerances = [], []
    for name, text in ENCOUNTERS.items():
        found = {s: solved(lab, text, f"body.stall_overlap={s}", "rods_run.rtol=1e-8", "rods_run.max_steps=10000000") for s in OVERLAPS}
        # poses are linear in s: overlaps are, at a given force
        (s0, one), (s1, other) = ((s, found[s][1]) for s in OVERLAPS[-2:])
        hard = [b - s1 * (a - b) / (s0 - s1) for a, b in zip(one, other)]
        for s, (outcome, poses, seconds) in found.items():
            solver = outcome["solver"]
            lines.append([name, s, f"{distance(poses, hard):.1e}", f"{distance(poses, hard) / s:.2f}", solver["method"], solver["steps"],
                          solver["error_test_failures"], f"{seconds:.2f}"])
        for s in (0.05, 1e-3):
            exact = solved(lab, text, f"body.stall_overlap={s}", "rods_run.rtol=1e-11")[1]
            for rtol in (1e-3, 1e-4, 1e-6, 1e-8):
                outcome, poses, seconds = solved(lab, text, f"body.stall_overlap={s}", f"rods_run.rtol={rtol}")
                tolerances.append([name, s, rtol, f"{distance(poses, exact):.1e}", outcome["solver"]["method"], outcome["solver"]["steps"],
                                   outcome["solver"]["error_test_failures"], f"{seconds:.2f}"])
    table("Poses at t = 4 against stall_overlap s, rtol 1e-8", ["encounter", "s", "off hard rods, f/mu or rad", "over s", "method", "steps",
                                                              "steps rejected", "CPU s"], lines)
    table("Against rtol", ["encounter", "s", "rtol", "error", "method", "steps", "steps rejected", "CPU s"], tolerances)


def pile(count, kappa=0.0, **keys):
    """Rods that walk to one point from all around."""
    return scene([(2.2 * math.cos(a), 2.2 * math.sin(a), a + math.pi) for a in (2 * math.pi * k / count for k in range(count))], kappa, **keys)


FACING = [(0.0, 0.0, 0.0), (2.0, 0.0, math.pi)]
CROSSING = [(0.0, 0.0, 0.2), (1.6, -1.3, 1.7)]
BEHIND = [(0.0, 0.0, 0.0), (1.3, 0.0, 0.0)]
DISC = "spheres = 1\nlength = 0.4\nthick_diameter = 0.4\nthin_diameter = 0.4"
# name, scene, the end: an outcome, or words of the refusal
CELLS = [
    *((f"crossing, s = {s}", scene(CROSSING, 2.0, body=f"stall_overlap = {s}"), "bound") for s in (0.5, 0.01, 1e-3, 1e-4)),
    *((f"head on, s = {s}", scene(FACING, t_end=1.0, body=f"stall_overlap = {s}"), "bound") for s in (0.5, 0.05, 1e-4)),
    ("head on in wakes, kappa = -100", scene(FACING, -100.0), "bound"),
    ("head on in wakes, kappa = 100", scene(FACING, 100.0, t_end=1.0), "bound"),
    ("crossing, kappa = -100", scene(CROSSING, -100.0), "bound"),
    ("12 rods to one point", pile(12), "bound"),
    ("12 rods to one point, s = 1e-3", pile(12, body="stall_overlap = 1e-3"), "bound"),
    ("12 rods to one point, kappa = 5", pile(12, 5.0), "bound"),
    ("12 rods to one point, kappa = -5", pile(12, -5.0), None),
    ("crossing, b = 1e-3", scene(CROSSING, 2.0, body="mobility_ratio = 1e-3"), None),
    ("crossing, b = 1e3", scene(CROSSING, 2.0, body="mobility_ratio = 1e3"), None),
    ("discs head on", scene(FACING, body=DISC, t_end=2.0), "bound"),
    ("1000 discs a rod", scene(CROSSING, 2.0, body="spheres = 1000"), "bound"),
    ("one behind the other", scene(BEHIND), "undecided"),
    ("far apart", scene([(0.0, 0.0, 0.0), (1e6, 0.0, math.pi)], 2.0), None),
    ("overlap at the start", scene([(0.0, 0.0, 0.0), (1.15, 0.0, math.pi)]), "overlap by"),
    ("one inside the other", scene([(0.0, 0.0, 0.0), (0.1, 0.0, 0.0)]), "overlap by"),
    ("one place", scene([(0.0, 0.0, 0.0), (0.0, 0.0, 1.0)]), "same place"),
    ("rows with gaps", scene(FACING, body="spheres = 4"), "leaves gaps"),
    ("two discs", scene(FACING, body="spheres = 2"), "must be 1 or 3 to 1000"),
    ("s = 0", scene(FACING, body="stall_overlap = 0.0"), ">= 0.0001"),
    ("b = 0", scene(FACING, body="mobility_ratio = 0.0"), ">= 0.001"),
    ("box of two lengths", scene(FACING).replace("alpha = 1.0", "alpha = 1.0\nperiodic = 2.5"), "must exceed 2.5"),
]


def extremes(lab):
    lines, wrong = [], 0
    for name, text, wanted in CELLS:
        began = cpu()
        try:
            done = lab.call("rods", lab.write("cell.toml", text), "--quiet", "--force", "-j", 1, "-o", lab.folder / "cell", good=(), timeout=120)
        except subprocess.TimeoutExpired:
            wrong += 1
            lines.append([name, "**no end in 120 s**", "", "120"])
            continue
        if done.returncode == 0:
            outcome = read_json(lab.folder / "cell", "outcome")
            end, more = outcome["outcome"], f"{outcome['solver']['steps']} steps, gap {outcome['min_gap']:.3g}"
        else:
            end, more = {2: "refused"}.get(done.returncode, f"exit code {done.returncode}"), done.stderr.strip().splitlines()[0].split(".toml:")[-1][-90:]
        good = wanted in done.stderr if end == "refused" and wanted else end == wanted or (wanted is None and done.returncode == 0)
        wrong += not good
        lines.append([name, end if good else f"**{end}**, not {wanted}", more, f"{cpu() - began:.1f}"])
    table("Extremes", ["cell", "end", "", "CPU s"], lines)
    if wrong:
        sys.exit(f"{wrong} cells end otherwise than they must")


KEPT = SOURCE / "studies/bodies_bound.csv"
KAPPAS, ANGLES, THIN = (-5.0, -2.0, 0.0, 2.0, 5.0, 10.0), (20, 45, 70, 95, 120, 145, 170), (0.3, 0.2, 0.1)
OFFSETS = (-0.6, -0.2, 0.2, 0.6)
AWAY = 1.6  # f/mu


def bound(lab):
    """Two rods on courses that cross, the first AWAY from the crossing, the second farther by the offset."""
    keys, points = ("coupling.kappa", "body.thin_diameter", "rods.1.position.0", "rods.1.position.1", "rods.1.heading"), []
    cases = [(kappa, thin, angle) for thin in THIN for kappa in KAPPAS for angle in ANGLES][:20 if lab.quick else None]
    for kappa, thin, angle in cases:
        for offset in OFFSETS:
            heading = math.radians(angle)
            points.append((kappa, thin, AWAY - (AWAY + offset) * math.cos(heading), -(AWAY + offset) * math.sin(heading), heading))
    lab.write("points.csv", ",".join(keys) + "\n" + "".join(",".join(map(repr, point)) + "\n" for point in points))
    text = scene([(0.0, 0.0, 0.0), (0.0, -5.0, 1.0)], 1.0, t_end=15.0, body="spheres = 12", run="rtol = 1e-6") + '[scan]\ndesign = "list"\nfile = "points.csv"\n'
    lab.call("scan", lab.write("scan.toml", text), "--quiet", "--force", "-j", 1, "-o", lab.folder / "scan", good=(0, 3))
    found = rows(lab.folder / "scan/scan.csv")
    if not lab.quick:
        KEPT.unlink(missing_ok=True)
    counted = {}
    for case, start in zip(cases, range(0, len(found), len(OFFSETS))):
        ends = [row["outcome"] for row in found[start:start + len(OFFSETS)]]
        counted[case] = ends.count("bound")
        keep_row(None if lab.quick else KEPT, {"kappa": case[0], "thin_diameter": case[1], "angle": case[2],
                                               **{end: ends.count(end) for end in ("bound", "pursuit", "escape", "undecided")}})
    for thin in sorted({thin for _, thin, _ in cases}):
        table(f"Bound, of {len(OFFSETS)} encounters: thin_diameter {thin}, thick_diameter 0.3", ["kappa", *(f"{angle} deg" for angle in ANGLES)],
              [[kappa, *(counted.get((kappa, thin, angle), "") for angle in ANGLES)] for kappa in KAPPAS])


CROWD = """schema = 1
[medium]
eta = 1.0
alpha = 1.0
[coupling]
kappa = 2.0
[body]
stall_overlap = 0.1
[rods_random]
count = {count}
extent = {extent}
spread = "180 deg"
[rods_run]
t_end = {t_end}
output_interval = {interval}
rtol = 1e-4
precision = "fine"
turning_tolerance = 1e-3
"""


def crowd(lab):
    lines, t_end = [], 0.02 if lab.quick else 1.25
    for count in (1000,) if lab.quick else (1000, 10000):
        text = CROWD.format(count=count, extent=round(math.sqrt(count * 1.25**2 / 0.2), 1), t_end=t_end, interval=t_end / 2)
        for method in ("auto", "erk") if count == 1000 else ("auto",):
            outcome, _, seconds = solved(lab, text, f"rods_run.method={method}")
            solver = outcome["solver"]
            lines.append([count, solver["method"], solver["steps"] / t_end, f"{seconds / t_end:.3g}", f"{seconds / t_end * 125 / 60:.3g}"])
    table("Crowds at 0.2 rods a length squared, s = 0.1, rtol 1e-4", ["rods", "method", "steps a unit of time", "CPU s a unit of time", "CPU min for 100 lengths"], lines)


CROWDS = SOURCE / "studies/crowds.csv"
LENGTH, BOXED, ON_PLANE = 1.25, 200, 2000  # f/mu; numbers of rods
DENSITIES, PLANE_DENSITY = (0.15, 0.3, 0.6), 0.3  # rods on a length squared
STARTS = {"random": "180 deg", "ordered": "5 deg"}
BOX = """schema = 1
[medium]
eta = 1.0
alpha = 1.0
periodic = {side}
field = "table"
[medium.table]
tolerance = 1e-5
[coupling]
kappa = {kappa}
[body]
stall_overlap = 0.1
[rods_random]
count = {count}
extent = {side}
spread = "{spread}"
seed = {seed}
[rods_run]
t_end = 20.0
output_interval = 0.25
rtol = 1e-3
[rods_order]
from = 10.0
"""
PLANE = {'periodic = {side}\nfield = "table"\n[medium.table]\ntolerance = 1e-5\n': "", "rtol = 1e-3\n": 'rtol = 1e-3\nprecision = "fine"\nturning_tolerance = 1e-3\n',
         "t_end = 20.0": "t_end = 10.0", "from = 10.0": "from = 7.5"}


def crowd_scene(place, density, kappa, start, seed):
    lines, count = BOX, BOXED if place == "box" else ON_PLANE
    for old, new in PLANE.items() if place == "plane" else ():
        lines = lines.replace(old, new)
    return lines.format(side=round(LENGTH * math.sqrt(count / density), 3), kappa=kappa, count=count, spread=STARTS[start], seed=seed)


def crowd_row(out):
    """Means of a run and their errors by blocks; `touching`: the share of rods that touch another; fluctuations in cells of about 10 rods."""
    means, sizes = read_json(out, "rods_order"), rows(out / "clusters.csv")
    found = {}
    for name in ("polar", "nematic", "weighted_size", "largest"):
        found |= {name: round(means[name]["value"], 4), f"{name}_error": round(means[name]["error"], 4)}
    cells = min(rows(out / "fluctuations.csv"), key=lambda row: abs(math.log(float(row["rods"]) / 10)))
    found |= {name: round(float(cells[name]), 3) for name in ("fluctuation", "fluctuation_error")}
    alone = sum(float(row["share"]) for row in sizes if row["size"] == "1")
    return found | {"clusters": round(sum(float(row["clusters"]) for row in sizes), 2), "touching": round(1 - alone, 4),
                    "touch_lifetime": round(means.get("touch_lifetime") or math.nan, 3)}


def crowds(lab):
    """The plane, then one seed in the box after the other; of kappa the extremes first."""
    seeds = 2 if lab.options.runs is None else lab.options.runs
    box = [[("box", density, kappa, start, seed) for density in DENSITIES for kappa in kappas for start in STARTS]
           for seed in range(1, seeds + 1) for kappas in ((0.0, 5.0, -5.0), (2.0, -2.0))]
    plane = [("plane", PLANE_DENSITY, kappa, start, 1) for kappa in (0.0, 5.0, -5.0) for start in STARTS if seeds]
    cases = plane + [case for one in box for case in one]
    kept = kept_rows(CROWDS)
    there = {(row["place"], float(row["density"]), float(row["kappa"]), row["start"], int(row["seed"])) for row in kept}
    for case in cases[:2] if lab.quick else cases:
        if case in there:
            continue
        began = cpu()
        row = crowd_row(lab.make("_".join(map(str, case)), crowd_scene(*case), verbs=("rods",)))
        keep_row(None if lab.quick else CROWDS, dict(zip(("place", "density", "kappa", "start", "seed"), case)) | row | {"cpu_seconds": round(cpu() - began)})
    heads = {"box": f"{BOXED} rods in a periodic box", "plane": f"{ON_PLANE} rods from a square on the plane"}
    for place, start in ((place, start) for place in heads for start in STARTS):
        settings = {}
        for row in kept_rows(CROWDS):
            if (row["place"], row["start"]) == (place, start):
                settings.setdefault((float(row["density"]), float(row["kappa"])), []).append(row)
        table(f"{heads[place]}, {start} start", ["rods a length squared", "kappa", "seeds", *CROWD_COLUMNS],
              [[*setting, len(found), *(over_seeds(found, *column) for column in CROWD_COLUMNS.items())] for setting, found in sorted(settings.items())])


# And digits that are shown.
CROWD_COLUMNS = {"polar": 2, "nematic": 2, "touching": 2, "clusters": 0, "weighted_size": 1, "largest": 1, "touch_lifetime": 1,
                 "fluctuation": 2}


def over_seeds(found, name, digits):
    """Mean, and its error by the blocks of each run."""
    values, errors = ([float(row.get(column) or "nan") for row in found] for column in (name, f"{name}_error"))
    return shown((sum(values) / len(values), math.hypot(*errors) / len(errors)), digits=digits)


PARTS = {"trade": trade, "extremes": extremes, "bound": bound, "crowd": crowd, "crowds": crowds}

if __name__ == "__main__":
    run_parts(parser(__doc__, "report", "quick", "keep", "runs", parts=PARTS, chosen=("trade", "extremes", "bound")).parse_args(), PARTS)
