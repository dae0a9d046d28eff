#!/usr/bin/python3
"""What noise and memory do to two rods in a stable orbit (eta = alpha = 1: lengths in xi); docs/findings.md, section 11, has the numbers.

    PYTHONPATH=build/release/python studies/orbits_disturbed.py [--program build/release/rodwake] [--only noise,memory] [--keep DIR] [-j 2]

noise: headings diffuse, and rods start in the orbit. How many of 40 runs are in it still after 20 times its slowest decay (undecided), what the
others end in, and where none has left the spread of the separation over run 0's second half beside the linear theory's, from
J C + C J^T + 2 D_r B B^T = 0. memory: rods in a dynamic medium (box of 5, forces 0.08 wide), and in its steady wakes: least and largest
separation and turns of rod 0 in the last two units of time. Writes studies/orbits_disturbed_*.csv. Some 5 min.
"""

import math
import sys

import numpy as np
from scipy import linalg

import rodwake
from lab import SOURCE, columns, parser, run_parts, read_json, write_csv

PAIR = """schema = 1
[medium]
eta = 1.0
alpha = 1.0
{medium}
[coupling]
kappa = {kappa}
[[rods]]
position = [0.0, 0.0]
[[rods]]
position = [{x!r}, {y!r}]
heading = {heading!r}
[rods_run]
t_end = {t_end}
output_interval = {every}
contact_distance = {contact}
{more}"""


def stable_orbit(kappa):
    return next(e for e in rodwake.pair_equilibria(rodwake.Medium(), kappa=kappa) if e.kind == "orbit" and e.stable)


def scene(pose, kappa, t_end, every, contact, medium="", more=""):
    x, y, heading = map(float, pose)
    return PAIR.format(medium=medium, kappa=kappa, x=x, y=y, heading=heading, t_end=t_end, every=every, contact=contact, more=more)


def linear_spread(orbit, kappa):
    """Standard deviation of the separation for D_r = 1. Noise of rod 0's heading turns the frame in which rod 1 is."""
    jacobian = rodwake.pair_flow(orbit.pose, rodwake.Medium(), kappa=kappa)[1]
    x, y, _ = orbit.pose
    kicks = np.array([[y, 0.0], [-x, 0.0], [-1.0, 1.0]])
    covariance = linalg.solve_continuous_lyapunov(jacobian, -2.0 * kicks @ kicks.T)
    along = np.array([x, y, 0.0]) / math.hypot(x, y)
    return math.sqrt(along @ covariance @ along)


def separations(folder):
    x0, y0, x1, y1 = columns(folder / "rods.csv", "x0", "y0", "x1", "y1")
    return np.hypot(x1 - x0, y1 - y0)


def noise(lab):
    runs, found = lab.count(40), []
    for kappa in (23.0, 23.5, 24.0):
        orbit = stable_orbit(kappa)
        decay = -orbit.eigenvalues[0].real
        t_end = 20.0 / decay
        for part in (1e-4, 3e-4, 1e-3):
            diffusion = part * decay
            out = lab.make(f"noise_{kappa}_{part:g}", scene(orbit.pose, kappa, t_end, t_end / 2000, 0.1 * orbit.separation, more=f"""[noise]
rotational_diffusion = {diffusion!r}\nruns = {runs}\n"""), verbs=("rods",))
            ends, path = read_json(out, "noise")["endings"], separations(out)
            late = path[len(path) // 2:]
            inside = ends["undecided"] == runs
            found.append({"kappa": kappa, "separation": orbit.separation, "decay": decay, "D_r": diffusion, "t_end": t_end, "runs": runs, "in_orbit": ends["undecided"],
                          **{name: ends[name] for name in ("contact", "pursuit", "escape", "failed")},
                          "spread": late.std() if inside else "", "spread_linear": linear_spread(orbit, kappa) * math.sqrt(diffusion)})
            print("noise:", *(f"{key} {value:.4g}" if isinstance(value, float) else f"{key} {value}" for key, value in found[-1].items()), flush=True)
    save("noise", found)


def memory(lab):
    t_end, found = 3.0 if lab.quick else 5.0, []
    for kappa in (22.0, 23.5):
        for closure in ("steady", "none"):
            medium = f"""field = "dynamic"\n[medium.dynamic]\nbox = 5.0\nforce_width = 0.08\nmodes = 64\nself_field = false\nclosure = "{closure}"\n"""
            out = lab.make(f"memory_{kappa}_{closure}", scene((-0.34, 0.34, -1.49), kappa, t_end, 0.05, 0.02, medium), verbs=("rods",))
            late = slice(-41, None)
            path, heading = separations(out)[late], columns(out / "rods.csv", "theta0")[0][late]
            found.append({"kappa": kappa, "memory": int(closure == "none"), "outcome": read_json(out, "outcome")["outcome"], "least": path.min(),
                          "largest": path.max(), "turns": (heading[-1] - heading[0]) / (2 * math.pi)})
            print("memory:", found[-1], flush=True)
    save("memory", found)


def save(name, found):
    write_csv(SOURCE / "studies" / f"orbits_disturbed_{name}.csv", found, lambda value: f"{value:.6g}" if isinstance(value, float) else value)


if __name__ == "__main__":
    PARTS = {"noise": noise, "memory": memory}
    sys.exit(run_parts(parser(__doc__, "keep", "threads", parts=PARTS).parse_args(), PARTS))
