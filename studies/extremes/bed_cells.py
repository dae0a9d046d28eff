"""Cells of granular beds: small, short ones, one setting at a time out of the ordinary."""

import csv
import json
import math

from .lab import Cell, not_finite

LIMIT = 60.0    # s a bed
SCENE = """schema = 1
[granular]
box = "16 a"
duration = "0.5 s"
equilibrate = "0.5 s"
{density}
[granular.output]
formats = []
"""
ROD = '[[granular.rods]]\nkind = "{kind}"\nposition = ["{at} a", "{at} a"]\n'
FRICTIONS = [f"granular.contacts.{pair}.friction" for pair in ("particle_particle", "rod_wall", "bead_wall")]
RESTITUTIONS = [name.replace("friction", "restitution") for name in FRICTIONS]

# Group: settings of -s, and whether a rod is in the bed. Values that many keys share are set for all.
GROUPS = {
    "gamma": [(f"granular.plates.gamma={g}",) for g in (0, 0.5, 1.0, 1.5, 3, 7, 12, 20, 50, 1000, 10000)],
    "frequency": [(f"granular.plates.frequency={f} Hz",) for f in (10, 50, 100, 150, 200, 300, 1000, 10000, 100000)],
    "density": [(f"granular.phi_b={p}",) for p in (1e-3, 0.05, 0.3, 0.6, 0.7, 0.78, 0.85, 0.9, 0.9069)]
               + [(f"granular.beads={n}",) for n in (0, 1, 2, 3, 200)],
    "restitution": [tuple(f"{name}={e}" for name in RESTITUTIONS) for e in (0, 1e-6, 0.3, 0.9, 1)],
    "friction": [tuple(f"{name}={mu}" for name in FRICTIONS) for mu in (0, 1e-6, 0.05, 1, 1000)],
    "gap": [(f"granular.plates.gap={gap} mm",) for gap in (0.79, 0.8, 0.800001, 0.81, 0.9, 1.1, 1.2, 1.59, 3, 20, 1000)],
    "box": [(f"granular.box={side} a",) for side in (1.9, 2, 2.0001, 2.2, 3, 4, 6, 10)],
    "time step": [(f"granular.time_step={dt} s", "granular.duration=0.1 s") for dt in (1e-6, 5e-6, 5e-5, 2e-4, 5e-4, 1e-3)],
    "start": [("granular.start=random", "granular.equilibrate=0.2 s", f"granular.start_speed={v}") for v in (0, 1e-9, 0.02, 10)],
}
ROD_SHAPES = [(kind, at, settings) for kind in ("motile", "apolar") for at in (8,) for settings in (
    (), ("granular.rods.0.spheres=2",), ("granular.rods.0.spheres=3",), ("granular.rods.0.spheres=64",),
    ("granular.rods.0.length=1.2 mm",), ("granular.rods.0.length=6.3 mm",), ("granular.rods.0.length=20 mm",),
    ("granular.rods.0.imposed_speed=0",), ("granular.rods.0.imposed_speed=1 m/s",),
    ("granular.rods.0.density=1e-3",), ("granular.rods.0.density=1e6",))]


def ended(lab, done):
    """Status, verdict and note of a bed that ran to its end."""
    table, text = lab.text("bed", "table.csv"), lab.text("bed", "summary.json")
    if (found := not_finite(table) or not_finite(text)):
        return f"not finite: {found}", "bad", ""
    summary = json.loads(text)
    note = f"T_xy {summary['T_xy']:.1e}, T_z {summary['T_z']:.1e} m^2/s^2"
    if summary.get("absorbing_state"):
        return "absorbing state", "good", note
    rows = list(csv.DictReader(table.splitlines()))
    if summary["gamma"] == 0.0:
        return "at rest", "good", note
    speed = summary["gamma"] * 9.81 / (2.0 * math.pi * summary["frequency"])
    if summary["beads"] > 1 and float(rows[-1]["T_xy"]) < 1e-12 * speed**2:
        return "unnamed: T_xy is 0 and nothing says so", "bad", note
    return "finished", "good", note


def cell(lab, group, settings, rod=None, density="phi_b = 0.7"):
    if any(s.startswith("granular.beads") for s in settings):
        density = ""
    lab.write("bed.toml", SCENE.format(density=density) + (ROD.format(kind=rod[0], at=rod[1]) if rod else ""))
    done = lab.run("dem", "bed.toml", "-o", "bed", "--force", "--quiet", "-j", "1", *[f"-s{s}" for s in settings], limit=LIMIT)
    name = ", ".join(settings) + (f"; {rod[0]} rod" if rod else "")
    if done.code == 0:
        status, verdict, note = ended(lab, done)
    else:
        (status, verdict), note = done.refused(), done.stderr.strip()[-200:]
    return Cell(f"beds: {group}", name or "defaults", status, verdict, done.seconds, None, note)


QUICK = ("frequency", "gap")


def run(lab):
    for group, cases in GROUPS.items():
        if lab.quick:
            cases = cases[2:4] if group in QUICK else []
        lab.batch(f"beds: {group}", lambda: [cell(lab, group, settings) for settings in cases])
        if not lab.quick and group in ("gamma", "frequency", "gap", "box", "restitution", "friction"):
            lab.batch(f"beds: {group}, rod", lambda: [cell(lab, group, settings, ("motile", 8)) for settings in cases])
    if not lab.quick:
        lab.batch("beds: rod shape", lambda: [cell(lab, "rod shape", settings, (kind, at)) for kind, at, settings in ROD_SHAPES])
