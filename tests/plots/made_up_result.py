"""A small result that looks like a wake, for the tests: shapes, not physics."""

import h5py
import numpy as np

SCENE = """
schema = 1
title = "Rods & <wakes>"
[medium]
eta = 1.0
xi = 1.0
[coupling]
kappa = 0.5
[[rods]]
position = [0.0, 2.5]
heading = 0.0
"""

LINE = """
[[figures]]
name = "line"
kind = "cut"
cut = 0
"""

PATHS = """
[[figures]]
name = "paths"
kind = "trajectories"
"""

ALL_KINDS = LINE + PATHS + """
[[figures]]
name = "axis"
kind = "extensional_axis"
[[figures]]
name = "streams"
kind = "polar_streamlines"
gammas = [[1.0, -1.0]]
x = [-4.0, 4.0]
[[figures]]
name = "scaled"
kind = "cut"
cut = 0
sqrt_scaled = true
"""


def write_field(file):
    x, y = np.linspace(-6, 6, 31), np.linspace(-4, 4, 21)
    X, Y = np.meshgrid(x, y)
    r = np.hypot(X, Y)
    r[r == 0] = np.nan  # the masked origin
    grid = file.create_group("field/grid")
    grid["x"], grid["y"] = x, y
    for name in ("Ux", "Uy", "exx", "exy", "eyy", "gradx_tr", "lapy"):
        grid[name] = X / r**3
    for name in ("grady_tr", "lapx"):
        grid[name] = Y / r**3
    grid["axis_angle"], grid["axis_value"] = np.arctan2(Y, X) / 2, np.exp(-(r + X) / 2) / r
    cut = file.create_group("field/cuts/0")
    cut.attrs["along"], cut.attrs["at"] = "x", 0.0
    s = np.linspace(-20, 10, 301)
    with np.errstate(divide="ignore"):
        cut["s"], cut["Ux"], cut["Uy"] = s, np.where(s < 0, 1, np.exp(-s)) / np.sqrt(np.abs(s)), 0 * s


def write_run(file, name, order, bend):
    run = file.create_group(f"rods/{name}")
    run.attrs.update(label=np.bytes_(f"run {name}"), order=order, outcome="contact", time=10.0, min_separation=0.1,
                     eta=1.0, alpha=1.0, kappa=bend, gamma1=0.0, gamma2=0.0)
    t = np.linspace(0, 10, 51)
    run["t"], run["x"] = t, np.stack([t, t], axis=-1)
    run["y"] = np.stack([2.5 - bend * t**2, -2.5 + bend * t**2], axis=-1)
    run["theta"] = np.stack([-2 * bend * t, 2 * bend * t], axis=-1)


def write_result(folder, variants=0, units="reduced"):
    with h5py.File(folder / "result.h5", "w") as file:
        file.attrs.update(schema=1, rodwake_version="0.1.0", title="", units=units)
        file.create_group("medium").attrs.update(eta=1.0, xi=1.0, alpha=1.0, nu=0.5)
        write_field(file)
        for order, name in enumerate(["scene"] + [f"variant{i}" for i in range(variants)]):
            write_run(file, name, order, 0.02)
