"""Elastic constants from the pressure of strained boxes: the same crystal in a box a little longer or shorter along x or y.

    C_1x = -d p_xx/d e_x,  C_2x = -d p_yy/d e_x,  C_1y, C_2y likewise        (1: xx, 2: yy; e: strain of one side)

These are the constants that waves have too, whatever the pressure p itself is (stress-strain coefficients: Wallace, Phys. Rev. 162,
776, 1967), but for the inertia, of which pressure knows nothing. A crystal with an elastic energy has C_1y = C_2x; a driven one need not.
"""

import json

import numpy as np

from lab import mean, table, text

from .bed import HEAD, bed

STRAINS = (0.004, 0.008)
SECONDS, RUNS = 20.0, 6


def cost():
    return (1 + 4 * len(STRAINS)) * RUNS * (SECONDS + 4) * 1549


def run(lab, e_x=0.0, e_y=0.0):
    """The bed at rest, or the same number of beads in a box whose sides are those of the bed at rest times 1 + e."""
    if e_x == e_y == 0.0:
        return lab.make("strain_0", bed(lab.seconds(SECONDS), runs=lab.count(RUNS), frames=1.0, equilibrate=4.0))
    rest = summary(run(lab))
    x, y = (side * (1 + e) for side, e in zip(rest["box"], (e_x, e_y)))
    scene = (f'{HEAD}beads = {rest["beads"]}\nbox = [{x!r}, {y!r}]\nstart = "lattice"\nequilibrate = "4 s"\n'
             f'duration = "{lab.seconds(SECONDS):.6g} s"\nruns = {lab.count(RUNS)}\n'
             '[granular.output]\nformats = []\nlast_period = false\nframes = "1 s"\n')
    return lab.make(f"strain_{1e3 * e_x:g}_{1e3 * e_y:g}", scene)


def summary(folder):
    return json.loads((folder / "summary.json").read_text())


def pressures(folder):
    """p_xx, p_yy of each run, N/m: [run][part]."""
    runs = np.genfromtxt(folder / "runs.csv", delimiter=",", names=True)
    return np.stack([runs["p_xx"], runs["p_yy"]], axis=1)


def slopes(stretched, squeezed, strain):
    """-dp_xx/de, -dp_yy/de with errors, from [run][part] at +strain and -strain."""
    out = []
    for part in (0, 1):
        (plus, plus_error), (minus, minus_error) = mean(stretched[:, part]), mean(squeezed[:, part])
        out.append(((minus - plus) / (2 * strain), np.hypot(plus_error, minus_error) / (2 * strain)))
    return out


def constants(lab, strain):
    """C11, C22, C12 (of e_y), C21 (of e_x), N/m, each (value, error)."""
    (c11, c21), (c12, c22) = (slopes(pressures(run(lab, *(strain * axis))), pressures(run(lab, *(-strain * axis))), strain)
                              for axis in np.eye(2))
    return c11, c22, c12, c21


def shear(c11, c22, c12, c21):
    """(C11 + C22 - C12 - C21)/4: C66 if the crystal is isotropic. C11 and C21 come from the same runs; their errors are taken as apart."""
    return (c11[0] + c22[0] - c12[0] - c21[0]) / 4, np.sqrt(sum(e * e for _, e in (c11, c22, c12, c21))) / 4


def part(lab):
    rest = summary(run(lab))
    p = rest["pressure"]
    table("Pressure of the bed at rest, phi_b = 0.80", ["p_xx, mN/m", "p_yy", "p_xy", "T_xy, 1e-5 m^2/s^2"],
          [[*(text((p[name], p[name + "_error"]), 1e3, 3) for name in ("xx", "yy", "xy")), text((rest["T_xy"], rest["T_xy_error"]), 1e5, 3)]])
    rows = []
    for strain in STRAINS:
        found = constants(lab, strain)
        hot = [summary(run(lab, *(sign * strain * axis)))["T_xy"] / rest["T_xy"] for axis in np.eye(2) for sign in (1, -1)]
        rows.append([f"+-{100 * strain:g} %", *(text(one, 1e3) for one in (*found, shear(*found))), f"{min(hot):.3f} to {max(hot):.3f}"])
    table("Elastic constants by strain of the box", ["strain", "C11, mN/m", "C22", "C12 (strain along y)", "C21 (along x)", "(C11 + C22 - C12 - C21)/4",
                                                     "T_xy over that at rest"], rows)
