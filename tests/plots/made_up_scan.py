"""Scans for the tests and for looking at figures: the files of `rodwake scan`, outcomes from formulas, no physics.

Along log10 kappa a tongue of contact widens around a curved middle, a lobe of pursuit lies above it with a sliver of undecided
points at its edge, and a stripe of collision courses crosses everything near x_1 = 5. A third axis, gamma_1, narrows the tongue.
"""

import json

import h5py
import numpy as np

OUTCOMES = ("contact", "pursuit", "escape", "undecided")
KAPPA = {"key": "coupling.kappa", "keys": ["coupling.kappa"], "factors": [1.0], "symbol": "\\kappa", "unit": "mu v0/f",
         "spacing": "log", "from": 0.1, "to": 100.0, "count": 64, "values": []}
PLACE = {"key": "rods.1.position.0", "keys": ["rods.1.position.0"], "factors": [1.0], "symbol": "", "unit": "f/mu",
         "spacing": "linear", "from": -6.0, "to": 6.0, "count": 64, "values": []}
GAMMA = {"key": "coupling.gamma1", "keys": ["coupling.gamma1", "coupling.gamma2"], "factors": [1.0, -1.0], "symbol": "\\gamma_1",
         "unit": "v0", "spacing": "linear", "from": 0.0, "to": 10.0, "count": 5, "values": []}
METHOD = {"key": "rods_run.method", "keys": ["rods_run.method"], "factors": [1.0], "symbol": "", "unit": "", "spacing": "listed",
          "from": 0.0, "to": 0.0, "count": 3, "values": ["bdf", "adams", "erk"]}
PHI = {"key": "granular.phi_b", "keys": ["granular.phi_b"], "factors": [1.0], "symbol": "\\phi_b", "unit": "", "spacing": "linear",
       "from": 0.68, "to": 0.8, "count": 7, "values": []}
APART = {"key": "granular.rods.0.position.1", "keys": ["granular.rods.0.position.1", "granular.rods.1.position.1"],
         "factors": [1.0, -1.0], "symbol": "", "unit": "m", "spacing": "listed", "from": 0.0024, "to": 0.0048, "count": 3,
         "values": [0.0024, 0.0036, 0.0048]}
RESULTS = ("time", "min_separation", "min_separation_time", "turn0", "turn1", "non_reciprocity", "final_separation", "final_angle")
COUNTS = ("steps", "rhs_evaluations", "certificate", "retries")

SCENE = """schema = 1
units = "reduced"
title = "Capture of a rod that crosses a wake"

[medium]
eta = 1.0
xi = 1.0
field = "exact"
# periodic: infinite plane

[coupling]
kappa = 1.0
gamma1 = 0.0
gamma2 = 0.0
polar_basis = "laplacian"

[[rods]]
position = [0.0, 0.0]
heading = 0.0

[[rods]]
position = [0.0, -5.0]
heading = 1.5707963267948966

[rods_run]
t_end = 30.0
# output_interval: t_end / 200
contact_distance = 0.1
method = "auto"
form = "angle"
rtol = 1e-08
# atol: rtol / 100
max_steps = 1000000

"""
BED = """schema = 1
units = "reduced"
title = "Pairs in beds"

[granular]
bead_radius = 0.0004
phi_b = 0.7
box = 0.0312
duration = 40.0
runs = 40

[[granular.rods]]
position = [0.008, 0.0024]
heading = 0.0

[[granular.rods]]
position = [0.008, -0.0024]
heading = 0.0

"""


def middle(u):
    return -0.6 + 0.9 * np.sin(1.2 * u)


def half_width(u, g):
    return np.maximum(0.3 + 0.55 * (u + 1) ** 1.25 - 0.12 * g, 0.05)


def lobe(u, g):
    return 2.4 * np.exp(-((u - 1.35) / 0.62) ** 2) / (1 + 0.1 * g)


def stripe(u):
    return 0.14 + 0.03 * (u + 1)


def edges(u, g=0.0):
    """Between which outcomes, and where, upwards: the boundaries along x_1."""
    top = middle(u) + half_width(u, g)
    return (("escape|contact", middle(u) - half_width(u, g)), ("contact|pursuit", top), ("pursuit|undecided", top + lobe(u, g)),
            ("undecided|escape", top + 1.09 * lobe(u, g)), ("escape|contact", 5 - stripe(u)), ("contact|escape", 5 + stripe(u)))


def outcome_at(kappa, x, g=0.0):
    """Index into OUTCOMES."""
    u = np.log10(kappa)
    places = [place for _, place in edges(u, g)]
    code = np.full(np.broadcast(u, x, g).shape, 2)
    for index, (low, high) in ((0, (0, 1)), (1, (1, 2)), (3, (2, 3)), (0, (4, 5))):
        code[(x > places[low]) & (x < places[high])] = index
    return code


def results_at(kappa, x, g, code):
    """Numbers that are smooth within an outcome; the time is that of contact, which grows towards the edges, else the end of the run."""
    u = np.log10(kappa)
    depth = np.clip(1 - np.abs(x - middle(u)) / half_width(u, g), 1e-3, 1)
    time = np.choose(code, [4 + 6 / (0.4 + kappa ** 0.4) - 2.2 * np.log(depth), 30 + 0 * x, 30 + 0 * x, 30 + 0 * x])
    apart = np.choose(code, [0.1 + 0 * x, 0.6 + 0.5 * np.abs(x - middle(u)), 6 + 3.5 * np.abs(x - middle(u)) + u, 4 + 0.3 * np.abs(x)])
    turn0, turn1 = 0.3 * kappa ** 0.3 * np.tanh(x - middle(u)), 0.4 * kappa ** 0.3 * np.tanh(0.5 * x + u)
    asymmetry = np.tanh(0.55 * (x - 1.6 * u) + 0.08 * g)
    nearest = np.where(code == 0, 0.1, np.minimum(apart, 0.35 * np.abs(x - middle(u)) + 0.3))
    return np.stack([time, nearest, 0.8 * time, turn0, turn1, asymmetry, apart, np.sin(x) * 1.5], axis=-1)


def ends(axis):
    values = axis["values"]
    return (axis["from"], axis["to"]) if not values or isinstance(values[0], str) else (values[0], values[-1])


def even(axis, values):
    return np.log(values) if axis["spacing"] == "log" else values


def back(axis, values):
    return np.exp(values) if axis["spacing"] == "log" else values


def along(axis, count):
    """Values of the axis, `count` of them unless it lists its own; of words their numbers."""
    if axis["values"]:
        return np.arange(len(axis["values"])) if isinstance(axis["values"][0], str) else np.array(axis["values"])
    return back(axis, np.linspace(*even(axis, np.array(ends(axis))), count))


def grid(axes, count):
    found = np.meshgrid(*(along(axis, count) for axis in axes), indexing="ij")
    return np.stack([one.ravel() for one in found], axis=-1)


def scattered(axes, count, seed=1):
    random = np.random.default_rng(seed).random((count, len(axes)))
    low, high = (np.array([even(axis, np.array(ends(axis)))[end] for axis in axes]) for end in (0, 1))
    found = low + (high - low) * random
    return np.stack([back(axis, found[:, i]) for i, axis in enumerate(axes)], axis=-1)


def refined(axes, start, resolution):
    """A quadtree (octree) by the outcomes at the corners: points, and lows and highs of the leaves on the finest lattice."""
    dimensions, leaves = len(axes), []
    step = resolution // start
    low = np.stack(np.meshgrid(*[np.arange(0, resolution, step)] * dimensions, indexing="ij"), axis=-1).reshape(-1, dimensions)
    corner = np.stack(np.meshgrid(*[(0, 1)] * dimensions, indexing="ij"), axis=-1).reshape(-1, dimensions)

    def place(lattice):
        ends_of = [even(axis, np.array(ends(axis))) for axis in axes]
        return np.stack([back(axis, ends_of[i][0] + (ends_of[i][1] - ends_of[i][0]) * (lattice[..., i] / resolution))
                         for i, axis in enumerate(axes)], axis=-1)

    while True:
        codes = codes_of(axes, place(low[:, None, :] + step * corner))
        mixed = (codes != codes[:, :1]).any(axis=1)
        done = ~mixed | (step == 1)
        leaves += [(one, one + step, code if not is_mixed else -1) for one, code, is_mixed in zip(low[done], codes[done, 0], mixed[done])]
        if done.all():
            break
        step //= 2
        low = (low[~done][:, None, :] + step * corner).reshape(-1, dimensions)
    lows, highs = (np.array([leaf[end] for leaf in leaves]) for end in (0, 1))
    lattice = np.unique((lows[:, None, :] + (highs - lows)[:, None, :] * corner).reshape(-1, dimensions), axis=0)
    return place(lattice), place(lows), place(highs), np.array([leaf[2] for leaf in leaves])


def physical(axes, points):
    """kappa, x_1 and gamma_1 of the points, defaults for what is no axis."""
    found = {axis["key"]: points[..., i] for i, axis in enumerate(axes)}
    shape = points.shape[:-1]
    return tuple(np.broadcast_to(found.get(key, default), shape) for key, default in
                 (("coupling.kappa", 8.0), ("rods.1.position.0", 1.5), ("coupling.gamma1", 0.0)))


def codes_of(axes, points):
    return outcome_at(*physical(axes, points))


def path_of(x, code, t):
    """Two rods that walk at unit speed: the first along x, the second from (x, -5) upwards, turning as the outcome has it."""
    turn = (0.32, -0.3, 0.05, -0.1)[code] * np.tanh(0.4 * t) * t / (1 + 0.05 * t)
    heading = np.stack([0.03 * np.sin(0.5 * t + x), np.pi / 2 + turn], axis=-1)
    step = np.diff(t, prepend=t[0])[:, None]
    return (np.array([0.0, x]) + np.cumsum(np.cos(heading) * step, axis=0),
            np.array([0.0, -5.0]) + np.cumsum(np.sin(heading) * step, axis=0), heading)


def write_samples(path, axes, points, codes, times, rows, steps=81):
    with h5py.File(path, "w") as file:
        group = file.create_group("trajectories")
        t = np.linspace(0, 1, steps) * np.where(np.isfinite(times[rows]), times[rows], 30.0)[:, None]
        x = physical(axes, points)[1]
        t[1::2, 3 * steps // 4:] = t[1::2, 3 * steps // 4, None]  # some reach their end early and stay there
        paths = [path_of(x[row], codes[row], one) for row, one in zip(rows, t)]
        group["point"], group["t"] = rows, t
        for index, name in enumerate(("x", "y", "theta")):
            group[name] = np.array([one[index] for one in paths]).reshape(len(rows), steps, 2)


def number(value):
    return "" if np.isnan(value) else f"{value:.17g}"


def write_table(path, names, columns):
    """Columns of numbers or of words."""
    cells = [column if isinstance(column, list) else [number(value) for value in column] for column in columns]
    path.write_text(",".join(names) + "\n" + "".join(",".join(row) + "\n" for row in zip(*cells)))


def words_of(axis, values):
    """A column: that of a choice holds words."""
    choice = axis["values"] and isinstance(axis["values"][0], str)
    return [axis["values"][int(value)] for value in values] if choice else values


def write_points(folder, axes, points, codes, failed):
    results = results_at(*physical(axes, points), codes)
    results[failed] = np.nan
    counts = np.stack([40 + 60 * np.abs(np.sin(results[:, 0])), 700 + 900 * np.abs(np.sin(results[:, 0])), np.zeros(len(points))], axis=-1)
    outcome = ["" if gone else OUTCOMES[code] for code, gone in zip(codes, failed)]
    status = ["not_finite" if gone else "ok" for gone in failed]
    names = [axis["key"] for axis in axes] + ["outcome", "time", "status", *RESULTS[1:], *COUNTS]
    steps, evaluations, retries = np.floor(counts).T
    known = ["" if gone else "checked" for gone in failed]
    numbers = [*results.T[1:], steps, evaluations, known, retries]
    write_table(folder / "scan.csv", names, [words_of(axis, points[:, i]) for i, axis in enumerate(axes)]
                + [outcome, results[:, 0], status] + numbers)
    return results


def write_cells(folder, axes, lows, highs, codes):
    names = [f"{axis['key']}_{end}" for axis in axes for end in ("from", "to")]
    columns = [side[:, i] for i in range(len(axes)) for side in (lows, highs)]
    write_table(folder / "cells.csv", names + ["outcome", "certificate"],
                columns + [["mixed" if code < 0 else OUTCOMES[code] for code in codes], ["open" if code < 0 else "checked" for code in codes]])


def write_boundary(folder, axes):
    u = np.linspace(-1, 2, 400)
    pieces = [(between, u[seen], place[seen]) for between, place in edges(u) for seen in [np.abs(place) <= 6]]
    curve = np.concatenate([np.full(piece.size, index) for index, (_, piece, _) in enumerate(pieces)])
    between = [name for name, piece, _ in pieces for _ in piece]
    found = {"coupling.kappa": 10 ** np.concatenate([piece for _, piece, _ in pieces]),
             "rods.1.position.0": np.concatenate([place for _, _, place in pieces])}
    write_table(folder / "boundary.csv", ["curve", "between", *(axis["key"] for axis in axes), "error"],
                [curve, between, *(found[axis["key"]] for axis in axes), np.full(curve.size, 8e-5)])
    return {"curves": len(pieces), "points": int(curve.size), "tolerance": 1e-4}


def scan_table(design, axes):
    """The end of the resolved scene."""
    lines = ["[scan]", f'design = "{design}"', ""]
    for axis in axes:
        ranges = [f"values = {json.dumps(axis['values'])}"] if axis["values"] else [
            f"from = {axis['from']}", f"to = {axis['to']}", f'spacing = "{axis["spacing"]}"', f"count = {axis['count']}"]
        lines += ["[[scan.axes]]", f'key = "{axis["key"]}"', *ranges, ""]
    return "\n".join(lines)


def summary_of(design, axes, codes, failed, resolution, boundary):
    adaptive = design == "adaptive"
    return {"design": design, "requested": len(codes), "evaluated": len(codes), "failed": int(failed.sum()), "left": 0,
            "wall_seconds": 12.5, "missed_rate": 0.002 if adaptive else None, "missed_rate_high": 0.0058 if adaptive else None,
            "audited": 1500 if adaptive else 0, "missed": 3 if adaptive else 0, "resolution": resolution if adaptive else None,
            "axes": axes, "outcomes": {name: int(((codes == code) & ~failed).sum()) for code, name in enumerate(OUTCOMES)},
            "causes": {"the state is no longer finite": int(failed.sum())} if failed.any() else {}, "rods": 2, "boundary": boundary}


def write_scan(folder, design="adaptive", axes=(KAPPA, PLACE), count=33, start=16, resolution=128, samples=24, failing=0, figures=""):
    """Returns points and outcomes; `count` points an axis of a grid, or in all."""
    folder.mkdir(parents=True, exist_ok=True)
    axes, cells = list(axes), None
    if design == "adaptive":
        points, *cells = refined(axes, start, resolution)
    else:
        points = grid(axes, count) if design == "grid" else scattered(axes, count)
    codes = codes_of(axes, points)
    failed = np.zeros(len(points), dtype=bool)
    failed[np.random.default_rng(2).choice(len(points), failing, replace=False)] = True
    results = write_points(folder, axes, points, codes, failed)
    if cells:
        write_cells(folder, axes, *cells)
    plane = [axis["key"] for axis in axes] in (["coupling.kappa", "rods.1.position.0"], ["rods.1.position.0", "coupling.kappa"])
    boundary = write_boundary(folder, axes) if cells and plane else None
    rows = np.sort(np.random.default_rng(3).choice(np.flatnonzero(~failed), min(samples, int((~failed).sum())), replace=False))
    write_samples(folder / "scan.h5", axes, points, codes, results[:, 0], rows)
    (folder / "scan.json").write_text(json.dumps(summary_of(design, axes, codes, failed, resolution, boundary)))
    (folder / "scene.toml").write_text(SCENE + scan_table(design, axes) + figures)
    (folder / "provenance.json").write_text(json.dumps({"version": "0.1.0", "command": "rodwake scan scene.toml"}))
    return points, codes


def write_bed_scan(folder, axes=(PHI, APART), figures=""):
    """The ensemble of pairs that each point of a scan of beds is; the last point failed."""
    folder.mkdir(parents=True, exist_ok=True)
    axes = list(axes)
    points = grid(axes, PHI["count"])
    phi, apart = points[:, 0], points[:, 1] if len(axes) > 1 else np.full(len(points), 0.0024)
    delta = 2.4 - 5.8 / (1 + np.exp(-(phi - 0.75) / 0.012)) * (0.0024 / apart) ** 0.8 + 0.3 * np.sin(90 * phi)
    contact = 0.5 / (1 + np.exp(-(phi - 0.75) / 0.012))
    columns = [delta, 0.4 + 0.2 * np.abs(np.sin(40 * phi)), contact, 0.3 * contact, 1 - 1.3 * contact, 0 * phi,
               8e-5 - 4e-5 * phi, 1.7e-3 + 0 * phi, 1 / (1 + np.exp(-(phi - 0.71) / 0.008)), np.full(phi.size, 40.0)]
    columns = [np.append(column[:-1], np.nan) for column in columns]
    outcome = ["contact" if share > 0.35 else "escape" for share in contact[:-1]] + [""]
    write_table(folder / "scan.csv", [axis["key"] for axis in axes] + ["outcome", "status", "delta_y", "delta_y_error", *OUTCOMES,
                                                                      "T_xy", "T_z", "psi6", "runs"],
                [*points.T, outcome, ["ok"] * (len(phi) - 1) + ["exception"], *columns])
    codes = np.array([OUTCOMES.index(name) if name else 2 for name in outcome])
    failed = np.arange(len(phi)) == len(phi) - 1
    (folder / "scan.json").write_text(json.dumps(summary_of("grid", axes, codes, failed, None, None) | {"causes": {"overlap": 1}}))
    (folder / "scene.toml").write_text(BED + scan_table("grid", axes) + figures)
    (folder / "provenance.json").write_text(json.dumps({"version": "0.1.0"}))
    return points
