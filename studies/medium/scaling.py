"""The wake at imposed speeds in boxes of 155 a and 310 a: how far drag screens it, how one-sided it is, how it falls."""

import math

import h5py
import numpy as np

from lab import mean, ratio, table, text

from . import monopole, push, sound
from .bed import combined

CASES = (("", "2.8"), ("v_5", "5"), ("v_10", "10"), ("v_15", "15"))  # variants of scenes/wake_scaling.toml, a/s
SOUND_SECONDS = 24.0
SECONDS = {155: 60.0, 310: 30.0}  # of each run, by the size of the box
SEEDS = {155: 6, 310: 1}          # runs
SPACING = {155: 2.0, 310: 4.0}    # a, of the maps, and width of the source
SLIPPED = 0.53          # a, a quarter of the lattice spacing: no elastic displacement is as large so far out
BESIDE = (10.0, 16.0)   # a: |y| of the strips in which profiles along x are taken


def cost(size=155):
    waves = (SOUND_SECONDS + 6) * sound.SOUND_COST * (155 / 78) ** 2
    per_bead = 1.8 if size > 200 else 1.0  # a large bed does not fit into the caches
    return (SEEDS[size] * len(CASES) * (SECONDS[size] + 2) * (size / 78) ** 2 * per_bead + waves) * 1549


def run(lab, size, seed):
    return lab.make(f"scaling_{size}_{seed}", "wake_scaling.toml", f"granular.box=fit {size} a", f"granular.duration={lab.seconds(SECONDS[size])} s",
                    f"measure.spacing={SPACING[size]} a",
                    *(["measure.from=0.5 s", "measure.block=0.5 s"] if lab.quick else []), seed=seed)


def case_folders(lab, size, variant):
    """Of the runs whose crystal did not slip away from the row; at least one."""
    whole = [run(lab, size, seed) for seed in range(1, lab.count(SEEDS[size]) + 1)]
    folders = [folder / "variants" / variant if variant else folder for folder in whole]
    return [folder for folder in folders if largest_displacement(folder) < SLIPPED] or folders


def largest_displacement(folder):
    """a, beyond the first mask of the monopole fits."""
    with h5py.File(folder / "measure.h5") as file:
        x, y, u = (file["displacement"][name][()] for name in ("x", "y", "Ux"))
    strip, radius = monopole.MASKS[0]
    beyond = (np.abs(y)[:, None] >= strip) & (np.hypot(x[None, :], y[:, None]) >= radius)
    return np.nanmax(np.abs(u[beyond]))


def columns(path):
    lines = [line for line in path.read_text().splitlines() if not line.startswith("#")]
    values = np.array([[float(v or "nan") for v in line.split(",")] for line in lines[1:]])
    return {key: values[:, i] for i, key in enumerate(lines[0].split(","))}


def maps_mean(lab, name, folders, component):
    """Over the runs: each has its own fit_map file."""
    found = [columns(lab.folder / name / f"fit_map_{k}.csv") for k in range(len(folders))]
    inside = (np.abs(found[0]["y"]) >= BESIDE[0]) & (np.abs(found[0]["y"]) <= BESIDE[1])
    x = np.unique(found[0]["x"][inside])
    return x, np.array([[np.nanmean(one[component][inside & (one["x"] == place)]) for place in x] for one in found])


def side(x, profiles, sign, low, high):
    """Mean of each run over low to high ahead (+) or behind (-)."""
    here = (sign * x >= low) & (sign * x <= high)
    return profiles[:, here].mean(axis=1)


def asymmetry(x, profiles, low=15.0, high=35.0):
    """Behind over ahead of U_x less its value half a box away, of the mean over the runs, and its error."""
    far = profiles[:, np.abs(x) > 0.9 * np.abs(x).max()].mean(axis=1)
    behind, ahead = (side(x, profiles, sign, low, high) - far for sign in (-1, 1))
    return behind.mean() / ahead.mean(), leave_one_out(lambda keep: behind[keep].mean() / ahead[keep].mean(), len(behind))


def leave_one_out(function, n):
    if n < 2:
        return math.nan
    left = np.array([function(np.arange(n) != k) for k in range(n)])
    return math.sqrt((n - 1) / n * ((left - left.mean()) ** 2).sum())


def slope(x, profiles, low=12.0, high=40.0):
    """d ln U_x/d ln |x| behind."""
    here = (-x >= low) & (-x <= high)

    def of(keep):
        u = profiles[keep][:, here].mean(axis=0)
        good = u > 0
        return np.polyfit(np.log(-x[here][good]), np.log(u[good]), 1)[0] if good.sum() > 3 else math.nan
    whole = np.ones(len(profiles), dtype=bool)
    return of(whole), leave_one_out(of, len(profiles))


def fitted_drag(lab, name, folders, through, constants, inertia, force, density, width, parameters=monopole.MONOPOLE):
    """The drag rate at which chi2 is least, which may be below 0: from a parabola through three held values, for each run by itself."""
    found = []
    for k, folder in enumerate(folders):
        chi2, held = [], constants["zeta"][0] * np.array([0.0, 1.0, 2.0])
        for step, zeta in enumerate(held):
            keys = monopole.held(constants | {"zeta": (zeta, 1.0)}, inertia, force, density, ("force",))
            scene = monopole.scene([folder / "measure.h5"], through, keys, parameters, pairs=monopole.MASKS[:1], width=width)
            chi2.append(lab.fit(f"{name}_drag_{k}_{step}", scene)["chi2"])
        found.append(vertex(held, chi2))
    return mean(found)


def vertex(x, y):
    """Where the parabola through three points is least."""
    a, b, _ = np.polyfit(x, y, 2)
    return -b / (2 * a)


def shown(zeta):
    """Below 0 the parabola's vertex is far outside its three points, so its place means no more than its side."""
    return text(zeta, digits=1) if zeta[0] >= 0 else "< 0"


def below(zeta, drag):
    """By how many errors a fitted drag lies below the measured one; with 6 runs 95 % is 2.6 errors, with 4 runs 3.2."""
    return f"{(drag[0] - zeta[0]) / math.hypot(zeta[1], drag[1]):.1f}" if math.isfinite(zeta[1]) else "-"


def least_reach(zeta, c66):
    """xi v that the fitted drag allows, within two errors; no bound where one run tells no error."""
    most = zeta[0] + 2 * zeta[1]
    return (c66[0] / most if most > 0 else math.inf, math.nan)


def part(lab, size=155):
    waves = sound.run(lab, "sound_155", seconds=SOUND_SECONDS, runs=1, box="fit 155 a")  # the bed of 310 a has the same density
    sound.show("Sound in an unstrained bed of 155 a at rest", [("155 a", waves)])
    (constants, inertia), density = push.constants(lab, waves), sound.density(waves)
    rows, shapes = [], []
    for variant, label in CASES:
        folders = case_folders(lab, size, variant)
        speed = float(label) * 0.4
        force, _ = monopole.signed(folders, speed)
        found, _, through = monopole.fit(lab, f"fit_{size}_{label}", folders, speed, constants, inertia, density, SPACING[size])
        amplitude = found["systematics"]["errors"]["amplitude"]
        zeta = fitted_drag(lab, f"fit_{size}_{label}", folders, through, constants, inertia, force, density, SPACING[size])
        rows.append([label, f"{len(folders)} of {lab.count(SEEDS[size])}", f"{through:.2f}", text(force, 1e6), text(combined(folders, "mechanics", "drag_rate")),
                     text((amplitude["value"], amplitude["total"])), shown(zeta), below(zeta, constants["zeta"]), text(least_reach(zeta, constants["c66"]), digits=0),
                     text(ratio(constants["c66"], constants["zeta"]), digits=0),
                     f"{found['chi2']:.0f} ({found['dof']})"])
        x, data = maps_mean(lab, f"fit_{size}_{label}", folders, "Ux")
        _, model = maps_mean(lab, f"fit_{size}_{label}", folders, "model_Ux")
        shapes.append([label, text(asymmetry(x, data)), f"{asymmetry(x, model)[0]:.2f}",
                       text(slope(x, data)), f"{slope(x, model)[0]:.2f}"])
    table(f"Wake at imposed speeds, unstrained box of {size} a", ["speed, a/s", "runs that did not slip", "through the bed, a/s", "force, uN", "drag rate from momentum, 1/s",
          "amplitude", "drag rate that fits the maps, 1/s", "errors below that of a uniform push", "xi v of it, a^2/s, at least (two errors)", "xi v of sound and drag", "chi2 (dof)"], rows)
    table(f"Beside the rod's row ({BESIDE[0]:g} to {BESIDE[1]:g} a), U_x behind over ahead and slope behind, box of {size} a",
          ["speed, a/s", "behind over ahead, 15 to 35 a", "theory", "slope behind, 12 to 40 a", "theory"], shapes)
