"""The one-sided wake of a weak force that moves fast: many screening lengths fit in the box.

Eight seeds at 50 a/s, three each at 35 and 25 a/s, once through the box from rest; the mean displacement of the beads that did not hop, in
the frame of the force, beside the theory without a free parameter. Speeds and the places in screening lengths were set before the first run;
the way (from 400 a on), the limit of a hop (half a spacing) and the band of the axis with one seed looked at; the mask (beyond 12 a) and the
recipe of the decay length before the other seeds were.
"""

import math
from pathlib import Path

import h5py
import numpy as np

from lab import columns, leave_one_out, mean, table, text

from .bed import A

STORED = Path(__file__).with_suffix("")  # reduced runs of an earlier time: studies/medium/tail
FORCE, WIDTH = 24000.0, 4.0              # a^3/s^2 over the mass of a unit area, a
SPACING = math.sqrt(2 * math.pi / (0.8 * math.sqrt(3)))
SIDES = np.array([437, 84 * math.sqrt(3)]) * SPACING
FROM = 400.0                             # a of way
HOP = 0.5 * SPACING
BINS = (155, 103 // 3)                   # along x; rows of three 103rds of the box
ROWS = 5                                 # on each side of the axis
SEEDS = {50: 8, 35: 3, 25: 3}
DENSITY = 0.8 * 4 / 3 * A * 2700         # kg/m^2
CONSTANTS = {"C11": (9.75, 0.05), "C22": (9.83, 0.06), "C12": (2.69, 0.07), "C66": (3.55, 0.03)}  # mN/m, by strain of the box
DRAG, INERTIA = 13.94, 1.316             # 1/s of a uniform push; m* of the bed at rest
NEAR = 12.0                              # a: nearer is left out of the amplitude


def scene(speed, seed):
    return f"""schema = 1
[granular]
seed = {seed}
phi_b = 0.80
box = ["{SIDES[0]:.12g} a", "{SIDES[1]:.12g} a"]
start = "lattice"
equilibrate = "2 s"
duration = "{SIDES[0] / speed:.6g} s"
[granular.body_force]
kind = "gaussian"
acceleration = {FORCE / (2 * math.pi * WIDTH**2) * A:.8g}
width = "{WIDTH} a"
speed = {speed * A:.8g}
[granular.output]
formats = ["h5md"]
last_period = false
checkpoint = "600 s"
frames = "0.1997 s"
"""


def frames_of(run):
    """Times, and places without jumps in a, of a trajectory."""
    with h5py.File(run / "trajectory.h5md") as file:
        group = file["particles/trajectory"]
        edges = group["box/edges/value"][0] / A
        for k, time in enumerate(group["position/time"][()]):
            yield time, group["position/value"][k, :, :2] / A + group["image/value"][k, :, :2] * np.diag(edges)[:2]


def reduced(run, speed):
    """Sums over the frames: beads, U_x, U_y by bins [rows, columns] around the force."""
    start, sums = None, np.zeros((3, 2 * ROWS + 1, BINS[0]))
    height = 3 * SIDES[1] / 103
    for time, place in frames_of(run):
        middle = place.mean(axis=0)
        place = place - middle
        if time <= 0:
            start = place
            continue
        if speed * time < FROM or speed * time >= 900.0:
            continue
        moved = place - start
        kept = np.hypot(*moved.T) < HOP
        seen = start[kept] + middle - (SIDES / 2 + [speed * time, 0.0])
        seen -= SIDES * np.round(seen / SIDES)
        column = ((seen[:, 0] / SIDES[0] + 0.5) * BINS[0]).astype(int) % BINS[0]
        row = np.round(seen[:, 1] / height).astype(int) + ROWS
        inside = (row >= 0) & (row <= 2 * ROWS)
        np.add.at(sums, (slice(None), row[inside], column[inside]), np.vstack([np.ones(inside.sum()), moved[kept][inside].T]))
    return sums


def write(file, sums):
    x, y = bins()
    with file.open("w", newline="") as out:
        out.write("x,y,beads,Ux,Uy\n")
        for j, i in np.ndindex(sums.shape[1:]):
            beads, ux, uy = sums[:, j, i]
            out.write(f"{x[i]:.2f},{y[j]:.2f},{beads:.0f},{ux / beads:.4f},{uy / beads:.4f}\n")


def bins():
    return ((np.arange(BINS[0]) + 0.5) / BINS[0] - 0.5) * SIDES[0], np.arange(-ROWS, ROWS + 1) * 3 * SIDES[1] / 103


def fields(lab, speed):
    """U [seed, component, row, column]: of stored runs, else made now and kept with the other runs."""
    files = []
    for seed in range(1, lab.count(SEEDS[speed]) + 1):
        file = STORED / f"{speed}_{seed}.csv"
        if not file.is_file():
            file = lab.folder / file.name
            if not file.is_file():
                write(file, reduced(lab.make(f"tail_{speed}_{seed}", scene(speed, seed)), speed))
        files.append(file)
    return read(files)


def read(files):
    return np.array([columns(file, "Ux", "Uy") for file in files]).reshape(len(files), 2, 2 * ROWS + 1, BINS[0])


def of_stored_runs(speed):
    """What sides_and_decay tells of them and its errors, and of the theory of their mean: three arrays."""
    measured = read(sorted(STORED.glob(f"{speed}_*.csv")))
    return *with_jackknife(measured, lambda u: sides_and_decay(u, screening(speed))), sides_and_decay(theory(speed), screening(speed))


def theory(speed, from_rest=True):
    """U [component, row, column] of the mean over the frames, or of the steady state.

    m* u'' + zeta u' + D(q) u = F(q) exp(-i q_x v t) for each wave vector of the box; the force begins at t = 0 in a medium at rest."""
    mode = np.meshgrid(*(2 * np.pi * np.arange(-n, n + 1) / side for n, side in zip((300, 100), SIDES)), indexing="ij")
    qx, qy = (q.ravel()[q.size // 2 + 1:] for q in mode)  # half of them: U is real
    c11, c22, c12, c66 = (CONSTANTS[name][0] * 1e-3 / DENSITY / A**2 for name in ("C11", "C22", "C12", "C66"))
    stiffness = np.array([[c11 * qx**2 + c66 * qy**2, (c12 + c66) * qx * qy], [(c12 + c66) * qx * qy, c66 * qx**2 + c22 * qy**2]])
    square, vector = np.linalg.eigh(stiffness.transpose(2, 0, 1))
    push = FORCE * np.exp(-0.5 * (qx**2 + qy**2) * WIDTH**2) / SIDES.prod()
    phase = 1j * (qx * speed)[:, None]
    steady = push[:, None] * vector[:, 0, :] / (square - DRAG * phase + INERTIA * phase**2)
    if from_rest:
        steady = steady * (1 + lasting(phase, square, speed))
    amplitude = np.einsum("mck,mk->mc", vector, steady) * (np.sinc(qx * SIDES[0] / BINS[0] / 2 / np.pi) *
                                                           np.sinc(qy * 3 * SIDES[1] / 103 / 2 / np.pi))[:, None]
    x, y = bins()
    return 2 * np.real(np.einsum("mc,my,mx->cyx", amplitude, np.exp(1j * np.outer(qy, y)), np.exp(1j * np.outer(qx, x)), optimize=True))


def lasting(phase, square, speed):
    """What is left of the start, over the steady amplitude: its mean from FROM to 900 a of way."""
    root = np.sqrt(DRAG**2 - 4 * INERTIA * square + 0j)
    first, last = FROM / speed, 900.0 / speed
    total = 0
    for rate, other in (((-DRAG + root) / (2 * INERTIA), (-DRAG - root) / (2 * INERTIA)), ((-DRAG - root) / (2 * INERTIA), (-DRAG + root) / (2 * INERTIA))):
        decay = rate + phase
        total = total + (phase + other) / (rate - other) * (np.exp(decay * last) - np.exp(decay * first)) / (decay * (last - first))
    return total


def screening(speed):
    return CONSTANTS["C66"][0] * 1e-3 / DENSITY / A**2 / (DRAG * speed)


def sides_and_decay(field, xi):
    """Of U [component, row, column]: U_x on the axis at 2 xi behind and ahead, slope behind from 3 to 8 xi, local decay length ahead.

    The length: of an exponential through U_x less its mean from 4 to 8 xi ahead, from NEAR over one xi. NaN where a logarithm has none.
    It is local: the exponential of the theory, exp(-x/((1 + eta) xi)), sets in beyond (1 + eta) xi, where U_x is below its errors."""
    x, _ = bins()
    axis = field[0, ROWS]
    behind, ahead = (np.interp(2 * xi * side, x, axis) for side in (-1, 1))
    far = (x > -8 * xi) & (x < -3 * xi)
    near = (x > NEAR) & (x < NEAR + xi)
    rest = axis - axis[(x > 4 * xi) & (x < 8 * xi)].mean()
    return np.array([behind, ahead, slope(np.log(-x[far]), axis[far]), -1 / slope(x[near], rest[near])])


def slope(x, y):
    """Of log y against x."""
    return np.polyfit(x, np.log(y), 1)[0] if (y > 0).all() else math.nan


def amplitude(field, model):
    """Of the model in the field, beyond NEAR, bins alike."""
    x, y = bins()
    far = np.hypot(*np.meshgrid(x, y)) > NEAR
    data, shape = field[:, far].ravel(), model[:, far].ravel()
    return data @ shape / (shape @ shape), far


def with_jackknife(fields_, what):
    """A number, or several, of the mean of the fields; its error from leaving one out."""
    return what(fields_.mean(axis=0)), leave_one_out(lambda kept: what(fields_[kept].mean(axis=0)), len(fields_))


def shown(value, digits):
    return text((value, math.nan), digits=digits) if math.isfinite(value) else "changes sign"


def row(lab, speed):
    measured, models, xi = fields(lab, speed), (theory(speed), theory(speed, from_rest=False)), screening(speed)
    far = amplitude(models[0], models[0])[1]
    scatter = measured[:, :, far].var(axis=0, ddof=1).mean(axis=1, keepdims=True) / len(measured)
    chi2 = ((measured.mean(axis=0) - models[0])[:, far] ** 2 / scatter).sum()
    of_models = [sides_and_decay(model, xi) for model in models]
    cells = []
    for k, (value, error) in enumerate(zip(*with_jackknife(measured, lambda u: sides_and_decay(u, xi)))):
        digits = (3, 3, 2, 1)[k]
        found = text((value, error), digits=digits) if math.isfinite(error) else "changes sign"
        cells.append(f"{found} ({'; '.join(shown(one[k], digits) for one in of_models)})")
    scale = with_jackknife(measured, lambda u: amplitude(u, models[0])[0])
    return [f"{speed} ({len(measured)})", f"{xi:.1f}", text(scale, digits=3), *cells, f"{chi2:.0f} ({2 * far.sum()})"]


def part(lab):
    table("Wake of a moving force", ["speed, a/s (runs)", "xi, a", "amplitude over prediction", "U_x at 2 xi behind, a (theory; steady)", "ahead",
                                     "slope behind, 3 to 8 xi", "local decay length ahead, 12 a to 12 a + xi, a", "chi2 (bins)"], [row(lab, speed) for speed in SEEDS])
    x, _ = bins()
    both = [(fields(lab, speed)[:, 0, ROWS], theory(speed)[0, ROWS]) for speed in SEEDS]
    lines = []
    for low in (-240, -180, -120, -90, -60, -30, 12, 30, 60, 120):
        there = (x >= low) & (x < low + 18)
        cells = [(text(mean(u[:, there].mean(axis=1)), digits=3), f"{model[there].mean():.3f}") for u, model in both]
        lines.append([f"{low} to {low + 18}", *(cell for pair in cells for cell in pair)])
    table("U_x on its axis", ["x, a", *(head for speed in SEEDS for head in (f"{speed} a/s", "theory"))], lines)


def cost():
    """Beads times simulated seconds."""
    return sum(runs * 73416 * (2.0 + SIDES[0] / speed) for speed, runs in SEEDS.items())
