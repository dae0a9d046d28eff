"""Elastic constants and drag of the bed at rest by sound."""

import math

from lab import estimate, table, text, read_json

from .bed import A, SOUND_COST, bed

SECONDS, RUNS = 60.0, 3
INTERVAL = 3.7e-3  # s; 37 steps of the bed, of which a period of the plates has 50: every phase comes


def cost():
    return RUNS * (SECONDS + 6) * 1549 * SOUND_COST


def run(lab, name="sound", interval=INTERVAL, seconds=SECONDS, runs=RUNS, box="fit", keys=""):
    block = 4.0 if lab.seconds(seconds) >= 20 else 0.5
    measure = f'phonons = true\nphonon_interval = "{interval} s"\nblock = "{block} s"\n'
    scene = bed(lab.seconds(seconds), keys, measure, frames=round(30 * interval, 6), runs=lab.count(runs), box=box, equilibrate=6.0)
    return lab.make(name, scene)


def density(folder):
    """Mass of the beads per area, kg/m^2."""
    return read_json(folder, "measure")["phonons"]["density"]


def constants(folder):
    """c11, c22, c12, c66 in a^2/s^2 and zeta in 1/s (mass per area 1), of the bare mass, each (value, error), from measure.json."""
    found = read_json(folder, "measure")["phonons"]
    scale = 1.0 / (density(folder) * A * A)
    out = {name.lower(): tuple(scale * one for one in estimate(found[name + "_bare"])) for name in ("C11", "C22", "C12", "C66")}
    out["zeta"] = estimate(found["drag_rate"])
    return out


def show(title, folders, inertia=1.0):
    rows = []
    for label, folder in folders:
        found = read_json(folder, "measure")["phonons"]
        row = [label]
        for name in ("C11", "C22", "C12", "C66"):
            row.append(text(estimate(found[name + "_bare"]), 1e3 * inertia))
        row += [text(estimate(found["eta"])), text(estimate(found["c_T"]), 1, 1), text(estimate(found["drag_rate"])),
                text(estimate(found["viscosity_L"]), 1, 0) + ", " + text(estimate(found["viscosity_T"]), 1, 0)]
        rows.append(row)
    table(title, ["bed", "C11, mN/m", "C22", "C12", "C66", "eta", "c_T, a/s", "drag rate, 1/s", "viscosities L, T, a^2/s"], rows)


def isotropy(folder):
    """C11 = C22 and C66 = (C11 - C12)/2 in a crystal with triangular symmetry."""
    c = constants(folder)
    (a, da), (b, db), (p, dp), (s, ds) = (c[name] for name in ("c11", "c22", "c12", "c66"))
    mean = (a + b) / 2
    table("An unstrained triangular crystal is isotropic", ["C11/C22", "(C11 + C22 - 2 C12)/4 over C66"],
          [[text((a / b, a / b * math.hypot(da / a, db / b)), digits=3),
            text(((mean - p) / 2 / s, math.hypot(da / 4, db / 4, dp / 2, ds * (mean - p) / 2 / s) / s), digits=3)]])


def part(lab):
    at_rest = run(lab)
    show("Sound in an unstrained bed at rest, phi_b = 0.80, frames at all phases of the plates", [("78 a", at_rest)])
    isotropy(at_rest)
