"""Small measured runs for the tests and for looking at figures: the files of `rodwake measure`, shapes but little physics."""

import json
import math
from pathlib import Path

import h5py
import numpy as np

from made_up_granular import A, SPACING, Bed, write_csv, write_granular

PHASES = (("exponential", "liquid"), ("algebraic", "hexatic"), ("long-range", "crystal"))
BOX = 78.0  # a, of the fields
PATTERN = json.loads(Path(__file__).with_name("data").joinpath("measure.json").read_text(encoding="utf-8"))
SMALL = dict(columns=14, rows=16)
SOUND = {"Lx": 244.0, "Ly": 209.0, "Ld": 215.0, "Tx": 118.0, "Ty": 118.0, "Td": 134.0}  # a/s
D_R, JITTER = 0.04, 0.05  # rad^2/s, rad
RATE = 20.0               # 1/s, v^2/D of a rod that drifts and diffuses
DRAG, VISCOSITY = 11.0, (540.0, 130.0)  # 1/s; a^2/s, longitudinal and transverse


def estimate(value, error=0.05, samples=12):
    return {"value": value, "error": error, "samples": samples}


def phase_of(phi):
    return 0 if phi < 0.72 else 1 if phi < 0.75 else 2


def results(phi):
    """The program's own measure.json with the numbers of longer runs, which depend on the area fraction."""
    decay, phase = PHASES[phase_of(phi)]
    return laid_over(PATTERN, {
        "phi_b": phi,
        "order": {"psi6": estimate(psi6(phi), 0.004), "local_psi6": estimate(0.9, 0.002), "neighbours": estimate(5.9, 0.01), "cutoff": 2.98,
                  "g_minimum": 2.98, "class": decay, "phase": phase, "exponent": estimate(0.2, 0.03), "length": estimate(7.0, 0.6),
                  "reason": f"chi2 of the {decay} decay is 14.2 for 17 degrees of freedom"},
        "microrheology": {"stiffness": estimate(stiffness(phi), 0.02), "spring": estimate(3.2e-6, 1e-7), "s_low": 0.2, "s_high": 0.8,
                          "temperature": 5.3e-5, "kernel_low": 0.1, "kernel_high": 100.0},
        "flow": {"drag": estimate(2.1, 0.4), "drag_share": estimate(0.06, 0.01), "near_speed": 0.31},
        "displacement": {"method": "phase", "reference": "box", "blocks": 24, "frames": 2400, "mean_speed": 2.9,
                         "row_angle": 0.0, "contrast": 310.0, "block_correlation": 0.12, "offset": [0.01, -0.002]},
        "pairs": {"half_box_change": estimate(-3.1, 0.6, 50), "not_there": 2, "non_reciprocity": estimate(0.4, 0.1, 50),
                  "turn_rear": estimate(0.3, 0.05), "turn_front": estimate(0.1, 0.04), "contact": 12, "pursuit": 5, "escape": 30, "undecided": 3},
        "force": {"force": estimate(2.1e-6, 4e-8), "thrust": estimate(2.2e-6, 5e-8), "speed": estimate(3.0, 0.03)},
        "phonons": {**{f"c_{name}": estimate(speed, 1.5) for name, speed in SOUND.items()}, "c_T": estimate(118.0, 1.2),
                    "drag_rate": estimate(DRAG, 0.6), "viscosity_L": estimate(VISCOSITY[0], 20.0), "viscosity_T": estimate(VISCOSITY[1], 9.0),
                    "temperature": estimate(5.4e-5, 1e-6), "coldest": 0.22, "eta": estimate(2.1, 0.1), "C66": estimate(3.71e-3, 1e-4), "C66_bare": estimate(2.92e-3, 4e-5),
                    "inertia": estimate(1.27, 0.03)},
        "heading_diffusion": {"D_r": estimate(D_R, 1e-3), "D_r_cosine": estimate(D_R, 1e-3), "jitter": JITTER, "lag_low": 0.125,
                              "lag_high": 1.25, "cosine_amplitude": math.exp(-JITTER**2), "rotational_diffusion": estimate(0.0176, 2e-3)},
        "mechanics": {"drift": estimate(0.11, 0.01), "drag_rate": estimate(DRAG, 0.4), "screening_length": estimate(490.0, 30.0),
                      "decay_rate": estimate(10.5, 0.4), "inertia": estimate(1.27, 0.05), "used_inertia": estimate(1.27, 0.05)},
    })


UNKNOWN = {"value": None, "error": None, "samples": None}


def laid_over(pattern, changes):
    """A copy with these values, each of which the pattern has under that name: a made-up name is an error. What the pattern does
    not know (null) may be an estimate."""
    if set(changes) - set(pattern):
        raise KeyError(f"not written by rodwake measure: {sorted(set(changes) - set(pattern))}")
    return {key: laid_over(UNKNOWN if old is None else old, changes[key]) if isinstance(changes.get(key), dict) else changes.get(key, old)
            for key, old in pattern.items()}


def psi6(phi):
    return 0.05 + 0.85 / (1 + np.exp(-(phi - 0.715) / 0.008))


def stiffness(phi):
    return max(0.0, 40 * (phi - 0.7))


def write_order(folder, phi, random):
    r = np.arange(0.025, BOX / 2, 0.05)
    rings = [(SPACING * np.sqrt(n), m, 0.12 + 0.02 * n) for n, m in ((1, 6), (3, 6), (4, 6), (7, 12), (9, 6), (12, 6), (13, 12))]
    peaks = sum(m / (2 * np.pi * at * width * np.sqrt(2 * np.pi)) * 4.7 * np.exp(-((r - at) / width) ** 2 / 2) for at, m, width in rings)
    g = peaks * np.exp(-r / 12) + (1 - np.exp(-((r / 6) ** 4)))
    write_csv(folder / "gr.csv", {"r": r, "g": g * (1 + 0.01 * random.standard_normal(r.size)), "sigma": 0.02 * g + 0.001})
    r = np.arange(2.5, BOX / 2)
    g = [0.5 * np.exp(-r / 5), 0.6 * r ** -0.2, 0.55 + 0.2 / r][phase_of(phi)]
    sigma = 0.004 * np.sqrt(r)
    write_csv(folder / "gB.csv", {"r": r, "gB": g + sigma * random.standard_normal(r.size), "sigma": sigma, "pairs": 1e4 * r})


def write_motion(folder, phi, random):
    lag = np.geomspace(0.05, 20, 40)
    msd = 0.4 * lag / (1 + lag) + max(0.0, 0.74 - phi) * lag + 0.05
    write_csv(folder / "msd.csv", {"lag": lag, "msd": msd, "sigma": 0.03 * msd * np.sqrt(lag), "origins": 800 / lag})
    s = np.geomspace(0.1, 2, 12)
    write_csv(folder / "stiffness.csv", {"s": s, "value": stiffness(phi) + 0.3 * s, "sigma": 0.02 + 0 * s})
    write_kernel(folder, phi)


def write_kernel(folder, phi):
    """A Maxwell element; a drag is given in the crystal only."""
    s = np.geomspace(0.05, 250, 40)
    kernel, drag, inertia = 1e-5 + 3e-3 * s / (s + 1), 3e-5 * s, 2.1e-6 * s ** 2
    given = 1.0 if phase_of(phi) == 2 else np.nan
    write_csv(folder / "memory_kernel.csv", {"s": s, "total": kernel + drag + inertia, "total_error": 0.05 * kernel, "bias": 0.01 * kernel,
                                             "with_drag": kernel + drag, "kernel": given * kernel, "kernel_error": given * 0.06 * kernel})


def write_modes(folder, random):
    modes = [(m, n, branch) for m in range(5) for n in range(5) if 0 < m * m + n * n <= 16 for branch in (0, 1)]
    m, n, branch = np.array(modes).T
    q = 2 * np.pi / BOX * np.hypot(m, n)
    direction = np.where(n == 0, "x", np.where(m == 0, "y", "d"))
    speed = np.array([SOUND["LT"[b] + d] for b, d in zip(branch, direction)])
    omega, gamma = speed * q, DRAG + np.take(VISCOSITY, branch) * q ** 2
    T = 5.4e-5 * np.minimum(1, 0.2 + np.where(branch == 0, 4, 1.3) * q)
    noise = random.standard_normal((2, q.size))
    write_csv(folder / "phonons.csv", {
        "m": m, "n": n, "branch": branch, "q": q, "direction": np.degrees(np.arctan2(n, m)), "polarisation": 0 * q,
        "omega": omega * (1 + 0.01 * noise[0]), "omega_error": 0.01 * omega, "gamma": gamma * (1 + 0.05 * noise[1]), "gamma_error": 0.05 * gamma,
        "temperature": T, "temperature_error": 0.03 * T, "displacement": T / omega ** 2, "displacement_error": 0.04 * T / omega ** 2,
        "omega_static": omega, "omega_static_error": 0.02 * omega, "share": 0.95 + 0 * q})


def write_heading(folder, random):
    lag = np.unique(np.geomspace(1, 125, 30).astype(int)) * 0.01
    square, cosine = (2 * JITTER**2 + 2 * D_R * lag, np.exp(-JITTER**2 - D_R * lag))
    noise = 1 + 0.01 * random.standard_normal((2, lag.size))
    write_csv(folder / "heading.csv", {"lag": lag, "square": square * noise[0], "square_error": 0.02 * square, "cosine": cosine * noise[1],
                                       "cosine_error": 0.01 + 0 * lag, "origins": 1000 - 100 * lag})


def wake(x, y):
    """A displacement that falls slowly behind and fast ahead."""
    r = np.hypot(x, y) + 1.0
    return 0.9 * np.exp(-(x + r) / 12) / np.sqrt(r), 0.5 * y / r * np.exp(-r / 10) * np.sign(x + 1e-9)


def write_fields(folder, phi, random):
    x = np.arange(-39.0, 39.0)
    X, Y = np.meshgrid(x, x)
    Ux, Uy = wake(X, Y)
    count = np.where((np.abs(X + 1) < 4) & (np.abs(Y) < 1.2), 0, 400.0)
    sigma = np.full(X.shape, 0.01)
    with h5py.File(folder / "measure.h5", "w") as file:
        for name, values in {"x": x, "y": x, "Ux": Ux + 0.01 * random.standard_normal(X.shape), "sigma_x": sigma, "sigma_y": sigma,
                             "Uy": Uy + 0.01 * random.standard_normal(X.shape), "count": count, "coherence": 0.8 + 0 * X}.items():
            file[f"displacement/{name}"] = values
        x = np.arange(-39.0, 39.0, 2.0)
        X, Y = np.meshgrid(x, x)
        pole = 12 * (1 if phi < 0.75 else 0.05) / (X + 1j * Y + 2.5j * (abs(Y) < 1)) ** 2
        noise = 0.01 * (random.standard_normal(X.shape) + 1j * random.standard_normal(X.shape))
        v = pole.conj() + noise
        for name, values in {"x": x, "y": x, "vx": v.real, "vy": v.imag, "sigma_x": 0.01 + 0 * X, "sigma_y": 0.01 + 0 * X,
                             "unit_x": (v / abs(v)).real, "unit_y": (v / abs(v)).imag, "count": 90.0 * (np.hypot(X, Y) > 1)}.items():
            file[f"flow/{name}"] = values


def write_profiles(folder, random):
    place = np.arange(-38.0, 39.0)
    for component, along, at in (("Ux", "x", 0.0), ("Ux", "y", 0.0), ("Uy", "x", 4.0), ("Uy", "y", 0.0)):
        values = wake(*((place, at) if along == "x" else (at, place)))[component == "Uy"]
        sigma = 0.02 + 0 * place
        write_csv(folder / f"profile_{component}_{along}.csv",
                  {"x": place, "value": values + sigma * random.standard_normal(place.size), "sigma": sigma, "count": 400 + 0 * place})


def write_marked(folder, bed):
    """The beads within 6 a of the start of the first rod, as write_trajectory has them in its frames."""
    trajectory = next(folder.glob("trajectory.h5md"), None) or folder / "runs/0001/trajectory.h5md"
    with h5py.File(trajectory) as file:
        group = file["particles/trajectory"]
        beads = group["species"][()] == 0
        place = (group["position/value"][()] + group["image/value"][()] * [*bed.box, 0])[:, beads, :2] / A
    near = np.flatnonzero(np.hypot(*(place[0] - np.array(bed.starts[0]) / A).T) < 6)
    write_csv(folder / "marked.csv", {"bead": near, "x0": place[0, near, 0], "y0": place[0, near, 1], "x1": place[-1, near, 0] + 0.3,
                                      "y1": place[-1, near, 1] - 0.2})


def write_pairs(folder, runs=3):
    rows = [f"{run + 1},15,{'' if run == 1 else -2.5 + run},-3,0.2,0.1,0,0.4,11,{run % 3},9.5,0" for run in range(runs)]
    names = ("run,separation,half_box_change,last_change,turn0,turn1,leader,non_reciprocity,min_separation,outcome,outcome_time,"
             "perpendicular")
    (folder / "pairs.csv").write_text("\n".join(["# lengths in bead radii", names, *rows]) + "\n")


def write_part(folder, phi=0.8, runs=1, seed=1, figures="", rods=2, pairs=True):
    """A granular run with everything that can be measured of it."""
    random = np.random.default_rng(seed)
    folder.mkdir(parents=True, exist_ok=True)
    write_granular(folder, runs=runs, rods=rods, frames=3, figures=figures, **SMALL)
    (folder / "measure.json").write_text(json.dumps(results(phi)))
    write_order(folder, phi, random)
    write_motion(folder, phi, random)
    write_modes(folder, random)
    if rods:
        write_fields(folder, phi, random)
        write_profiles(folder, random)
        write_heading(folder, random)
        write_marked(folder, Bed(rods=rods, **SMALL))
    if rods == 2 and pairs:
        write_pairs(folder, runs)


def write_series(path, phis, speeds=None, distances=None):
    """A row for the scene, called "scene", and one a variant; speeds or distances make those what the rows differ in."""
    rows = []
    for index, phi in enumerate(phis):
        speed = "" if speeds is None else speeds[index]
        d0 = "" if distances is None else distances[index]
        force = ("", "") if speeds is None else ((1.5 + 0.3 * speed + 0.04 * (-1) ** index) * 1e-6, 4e-8)
        rows.append(["scene" if index == 0 else f"v{index}", phi, d0, speed, psi6(phi), 0.005, 0.2, "" if index == 0 else 0.02,
                     phase_of(phi), stiffness(phi), 0.02, 40 * (0.75 - phi), 0.7, 50, 0.3, 0.1, *force, speed, "" if speeds is None else 0.01,
                     118.0, 1.2, 0.011, 2e-4, 0.0085, 2e-4, 0.0026, 1e-4, DRAG, 0.4, 490.0, 30.0, D_R, 1e-3, 0.008, 1e-3])
    names = ("name,phi_b,d0,imposed_speed,psi6,psi6_error,exponent,exponent_error,class,stiffness,stiffness_error,delta_y,"
             "delta_y_error,runs,non_reciprocity,non_reciprocity_error,force,force_error,speed,speed_error,"
             "c_T,c_T_error,C11,C11_error,C22,C22_error,C66,C66_error,drag_rate,drag_rate_error,screening_length,screening_length_error,D_r,D_r_error,"
             "diffusion_per_length,diffusion_per_length_error")
    lines = [",".join(map(str, row)) for row in rows]
    path.write_text("\n".join(["# bead radii, s, N", names, *lines]) + "\n")


def variants(names, labels=None):
    lines = [f"label = '{label}'\n" for label in labels] if labels else [""] * len(names)
    return "".join(f'[[variants]]\nname = "{name}"\n{label}set = {{ "granular.seed" = 2 }}\n' for name, label in zip(names, lines))


def write_measured(folder, phis=(0.8,), runs=1, figures="", rods=2, pairs=True, labels=None):
    """The scene with the first area fraction, its variants v1, v2, ... with the others."""
    names = [f"v{index}" for index in range(1, len(phis))]
    write_part(folder, phis[0], runs, 1, variants(names, labels) + figures, rods, pairs)
    for index, (name, phi) in enumerate(zip(names, phis[1:])):
        write_part(folder / "variants" / name, phi, runs, 2 + index, "", rods, pairs)
    if names:
        write_series(folder / "series.csv", phis)
