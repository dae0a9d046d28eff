#!/usr/bin/python3
"""Whether certificates of outcomes are ever wrong, and how many outcomes have one: the tables of studies/reports/rods.md.

    studies/validate_certificates.py [--program build/release/rodwake] [--only straight,turning,diagrams,narrow] [--points N] [--quick] [--keep DIR]

straight  encounters of rods that walk straight and miss contact, or make it, by 1e-12 to 0.1 of the contact distance, after 3 to 30 of it
          and after 1e6, half of each; against the closed form in long double, by 30 digits where that is in doubt. The first
          2000 by SciPy's solve_ivp with an event too, the first 20 000 by CVODES and odeint (`--peers build/release/bench/bench_grazing`).
turning   pairs at rtol 1e-4, 1e-6 and 1e-8 against rtol 1e-12. Half of them with a contact distance that they miss or make by 1e-9 to 0.1
          of it; kappa from 0.1 to 1000, gammas, alpha from 0.01 to 10, eta from -0.999 to 10, contact distances down to 1e-6. Points that
          take more than a fifth of a second, rods that circle each other closely, are left out.
diagrams  the shipped phase diagrams: shares of points and of area, and what certificates cost.
narrow    pairs near eta = -1, whose longitudinal wakes are narrow: how many end elsewhere than with rtol 1e-11, where two methods agree on that;
          a hundredth of the points.
"""

import csv
import math
import subprocess
import time
from pathlib import Path

import mpmath
import numpy as np
from lab import SOURCE, parser, rows, run_parts, table, read_json
from scipy.integrate import solve_ivp

DECADES = (1e-12, 1e-10, 1e-8, 1e-6, 1e-3, 0.1)
KEYS = ["rods.1.position.0", "rods.1.position.1", "rods.0.heading", "rods.1.heading", "rods_run.contact_distance", "rods_run.t_end"]
MEDIUM = ["coupling.kappa", "coupling.gamma1", "coupling.gamma2", "medium.alpha", "medium.eta"]
SCENE = """schema = 1
{medium}
[[rods]]
position = [0.0, 0.0]
heading = 0.0
[[rods]]
position = [0.0, 5.0]
heading = 0.0
[rods_run]
t_end = 40.0
contact_distance = 1e-6
rtol = {rtol}
method = "{method}"
[scan]
design = "list"
file = "{points}"
trajectories = 0
time_limit = {limit}
certificates = {certificates}
"""
WITH_MEDIUM = "[medium]\neta = 1.0\nalpha = 1.0\n[coupling]\nkappa = 1.0\n"


def scan(lab, name, keys, points, medium="", rtol="1e-6", certificates="true", method="auto", limit=0.2):
    with open(lab.folder / f"{name}.csv", "w", encoding="utf-8", newline="") as file:
        csv.writer(file).writerows([keys, *([repr(float(value)) for value in point] for point in points)])
    text = SCENE.format(medium=medium, rtol=rtol, method=method, limit=limit, points=lab.folder / f"{name}.csv", certificates=certificates)
    return rows(lab.make(name, text, verbs=("scan",), good=(0, 3)) / "scan.csv")


def signed_margins(random, count, least, most):
    return np.exp(random.uniform(math.log(least), math.log(most), count)) * random.choice([-1.0, 1.0], count)


# Straight walkers


def straight_points(random, count):
    margins = signed_margins(random, count, DECADES[0], DECADES[-1])
    ahead = np.where(np.arange(count) % 2 == 0, np.exp(random.uniform(math.log(3.0), math.log(30.0), count)), 1e6)
    first = random.uniform(-3, 3, count)
    second = first + random.uniform(0.2, 3.0, count)
    vx, vy = np.cos(second) - np.cos(first), np.sin(second) - np.sin(first)
    v = np.hypot(vx, vy)
    nearest = 1.0 + margins
    x, y = -nearest * vy / v - ahead * vx, nearest * vx / v - ahead * vy
    return np.stack([x, y, first, second, np.ones(count), 1.5 * ahead], axis=-1)


def margins_of(points):
    """Smallest separation less the contact distance: by long double, and by 30 digits where that is in doubt."""
    x, y, first, second, contact, t_end = points.astype(np.longdouble).T
    vx, vy = np.cos(second) - np.cos(first), np.sin(second) - np.sin(first)
    t = np.clip(-(x * vx + y * vy) / (vx * vx + vy * vy), 0, t_end)
    margins = np.hypot(x + vx * t, y + vy * t) - contact
    doubt = np.abs(margins) < 1e-17 * np.hypot(x, y)
    found = margins.astype(float)
    found[doubt] = [exact_margin(*point) for point in points[doubt]]
    return found


def exact_margin(x, y, first, second, contact, t_end):
    """Smallest separation less the contact distance."""
    x, y, first, second, contact, t_end = map(mpmath.mpf, (x, y, first, second, contact, t_end))
    vx, vy = mpmath.cos(second) - mpmath.cos(first), mpmath.sin(second) - mpmath.sin(first)
    t = min(max(-(x * vx + y * vy) / (vx * vx + vy * vy), 0), t_end)
    return float(mpmath.sqrt((x + vx * t) ** 2 + (y + vy * t) ** 2) - contact)


def scipy_meets(point, rtol):
    x, y, first, second, contact, t_end = point
    v = np.array([math.cos(second) - math.cos(first), math.sin(second) - math.sin(first)])

    def apart(t, d):
        return math.hypot(*d) - contact
    apart.terminal = True
    return solve_ivp(lambda t, d: v, (0.0, t_end), [x, y], events=apart, rtol=rtol, atol=rtol).status == 1


def by_others(lab, points):
    """{solver: whether it sees a contact}, of the first points."""
    found = {f"SciPy's solve_ivp, RK45 with an event, rtol {rtol:g}": [scipy_meets(point, rtol) for point in points[:2000]] for rtol in (1e-6, 1e-10)}
    if lab.options.peers.is_file():
        file = lab.folder / "peers.csv"
        np.savetxt(file, points[:20_000], delimiter=",", fmt="%.17g")
        done = subprocess.run([lab.options.peers, file], capture_output=True, text=True, check=True)
        seen = np.array([line.split() for line in done.stdout.splitlines()], dtype=int).astype(bool)
        for k, name in enumerate(("CVODES, Adams, its root finder, rtol 1e-6", "CVODES, Adams, its root finder, rtol 1e-10",
                                  "odeint's dopri5, sign after each step, rtol 1e-6", "odeint's dopri5, sign after each step, rtol 1e-10")):
            found[name] = seen[:, k]
    return found


def straight(lab):
    mpmath.mp.dps = 30
    count = 2000 if lab.quick else lab.options.points
    points = straight_points(np.random.default_rng(lab.options.seed), count)
    found = scan(lab, "straight", KEYS, points, certificates="false")
    margins, far = margins_of(points), np.arange(count) % 2 == 1
    meets = margins < 0.0
    said = np.array([row["outcome"] == "contact" for row in found])
    proved = np.array([row["certificate"] == "verified" for row in found])
    lines = []
    for away, of_away in (("3 to 30", ~far), ("1e6", far)):
        for low, high in zip((0.0, *DECADES[:-1]), DECADES):
            of = of_away & (np.abs(margins) >= low) & (np.abs(margins) < high)
            if of.any():
                lines.append((away, f"{low:g} to {high:g}", of.sum(), (of & meets & ~said).sum(), (of & ~meets & said).sum(),
                              f"{proved[of].mean():.2%}", (of & proved & (said != meets)).sum()))
    table(f"Straight walkers, {count} encounters", ("contact distances away", "margin", "encounters", "contacts missed", "contacts made up",
                                                    "verified", "verified and wrong"), lines)
    lines = []
    for name, seen in {"rodwake": said[:20_000], **by_others(lab, points)}.items():
        seen = np.asarray(seen)
        of = meets[:len(seen)]
        lines.append((name, len(seen), of.sum(), (of & ~seen).sum(), (~of & seen).sum()))
    table("The same by others", ("", "encounters", "contacts there are", "missed", "made up"), lines)


# Rods that turn


def turning_points(random, count):
    r, where = random.uniform(0.5, 6.0, count), random.uniform(-math.pi, math.pi, count)
    polar = random.random(count) < 0.5
    eta = np.where(random.random(count) < 0.25, -1.0 + np.exp(random.uniform(math.log(1e-3), 0.0, count)),
                   np.exp(random.uniform(math.log(0.1), math.log(10.0), count)))
    kappa = signed_margins(random, count, 0.1, 1000.0)
    gammas = [np.where(polar, random.uniform(-10, 10, count), 0.0) for _ in range(2)]
    alpha = np.exp(random.uniform(math.log(0.01), math.log(10.0), count))
    tiny = np.exp(random.uniform(math.log(1e-6), math.log(0.1), count))
    return np.stack([r * np.cos(where), r * np.sin(where), random.uniform(-3, 3, count), random.uniform(-3, 3, count), tiny,
                     np.full(count, 40.0), kappa, *gammas, alpha, eta], axis=-1)


def turning(lab):
    keys, count = KEYS + MEDIUM, 200 if lab.quick else max(lab.options.points // 10, 200)
    random = np.random.default_rng(lab.options.seed)
    points = turning_points(random, count)
    free = scan(lab, "free", keys, np.where(np.arange(len(keys)) == 4, 1e-6, points), WITH_MEDIUM, "1e-12", "false")
    margins = signed_margins(random, count, 1e-9, 0.1)
    for k in range(0, count, 2):  # the others keep theirs
        start = math.hypot(*points[k, :2])
        nearest = float(free[k]["min_separation"] or "nan") * (1.0 + margins[k])
        if free[k]["outcome"] != "contact" and 1e-6 < nearest < start:
            points[k, 4] = nearest
    for rtol in ("1e-4", "1e-6", "1e-8"):
        run = scan(lab, f"run_{rtol}", keys, points, WITH_MEDIUM, rtol)
        exact = scan(lab, "exact", keys, points, WITH_MEDIUM, "1e-12", "false")
        tell(points, run, exact, rtol)


def tell(points, run, exact, rtol):
    lines = []
    for name, chosen in (("contact grazed", slice(0, None, 2)), ("any", slice(1, None, 2))):
        pairs = [(a, b, point) for a, b, point in zip(run[chosen], exact[chosen], points[chosen]) if a["status"] == b["status"] == "ok"]
        for certificate in ("verified", "checked", "open"):
            of = [(a["outcome"] != b["outcome"], point) for a, b, point in pairs if a["certificate"] == certificate]
            wrong = [point for differs, point in of if differs]
            lines.append((name, certificate, len(of), f"{len(of) / len(pairs):.1%}", len(wrong)))
            if certificate != "open":
                for point in wrong[:5]:
                    print("  wrong:", *map(repr, map(float, point)))
    table(f"Rods that turn, rtol {rtol}, against 1e-12", ("pairs", "certificate", "number", "share", "outcome wrong"), lines)


def diagrams(lab):
    lines = []
    for scene in ["phase_perpendicular"] if lab.quick else sorted(path.stem for path in (SOURCE / "scenes").glob("phase_*.toml")):
        seconds = []
        for key in ("false", "true"):
            began = time.monotonic()
            text = (SOURCE / "scenes" / f"{scene}.toml").read_text(encoding="utf-8")
            out = lab.make(f"{scene}_{key}", text, f"scan.certificates={key}", *(["scan.resolution=64"] if lab.quick else []), verbs=("scan",), good=(0, 3))
            seconds.append(time.monotonic() - began)
        points, area = (read_json(out, "scan")[key] for key in ("certificates", "certified_area"))
        total = sum(points.values())
        lines.append((scene, total, *(f"{points[name] / total:.1%}" for name in points), *(f"{area[name]:.1%}" for name in area),
                      *(f"{one:.1f}" for one in seconds)))
    table("Shipped diagrams", ("scene", "points", "verified", "checked", "open", "area verified", "checked", "open", "seconds without", "with"), lines)


# Narrow wakes


def narrow_points(random, count):
    r, where = random.uniform(0.5, 6.0, count), random.uniform(-math.pi, math.pi, count)
    couplings = random.uniform(-3, 3, (3, count))
    eta = -1.0 + np.exp(random.uniform(math.log(1e-7), math.log(1e-2), count))
    return np.stack([r * np.cos(where), r * np.sin(where), random.uniform(-3, 3, count), random.uniform(-3, 3, count), np.full(count, 0.1),
                     np.full(count, 30.0), *couplings, np.ones(count), eta], axis=-1)


def ends_of(found):
    """(time, last separation and angle, turns of both) of each, NaN where a run did not end."""
    names = ("time", "final_separation", "final_angle", "turn0", "turn1")
    return np.array([[float(row[name]) if row["status"] == "ok" else math.nan for name in names] for row in found])


def narrow(lab):
    points = narrow_points(np.random.default_rng(lab.options.seed), 100 if lab.quick else lab.options.points // 100)
    found = {(method, rtol): ends_of(scan(lab, f"{method}_{rtol}", KEYS + MEDIUM, points, WITH_MEDIUM, rtol, "false", method, 3.0))
             for method, rtol in (("bdf", "1e-11"), ("erk", "1e-11"), ("erk", "1e-6"), ("erk", "1e-8"), ("bdf", "1e-6"), ("bdf", "1e-8"))}
    exact = found["bdf", "1e-11"]
    known = np.abs(found["erk", "1e-11"] - exact).max(axis=1) < 1e-6
    lines = [(method, rtol, known.sum(), (~(np.abs(ends - exact).max(axis=1) < 1e-4) & known).sum()) for (method, rtol), ends in found.items()]
    table(f"Pairs near eta = -1, of {len(points)}", ("method", "rtol", "known", "off by more than 1e-4"), lines)


PARTS = {"straight": straight, "turning": turning, "diagrams": diagrams, "narrow": narrow}

if __name__ == "__main__":
    found = parser(__doc__, "report", "quick", "keep", "threads", "seed", parts=PARTS)
    found.add_argument("--points", type=int, default=100_000, help="number of straight encounters; of pairs that turn a tenth [100000]")
    found.add_argument("--peers", type=Path, default=SOURCE / "build/release/bench/bench_grazing", help="other solvers' events, if it is there")
    run_parts(found.parse_args(), PARTS)
