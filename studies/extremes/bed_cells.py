"""Cells of granular beds, small, short ones, one setting at a time out of the ordinary; and of fits: profiles of a known wake with too few
points, no noise, sigmas of any size, and bounds that bite."""

import itertools
import json
import math
import random

from lab import rows_of

from .cells import Cell, not_finite

LIMIT = 60.0    # s a bed or a fit
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
BEDS = {
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


def bed_ended(lab, done):
    """Status, verdict and note of a bed that ran to its end."""
    table, text = lab.text("bed", "table.csv"), lab.text("bed", "summary.json")
    if (found := not_finite(table) or not_finite(text)):
        return f"not finite: {found}", "bad", ""
    summary = json.loads(text)
    note = f"T_xy {summary['T_xy']:.1e}, T_z {summary['T_z']:.1e} m^2/s^2"
    if summary.get("absorbing_state"):
        return "absorbing state", "good", note
    if summary["gamma"] == 0.0:
        return "at rest", "good", note
    speed = summary["gamma"] * 9.81 / (2.0 * math.pi * summary["frequency"])
    if summary["beads"] > 1 and float(rows_of(table)[-1]["T_xy"]) < 1e-12 * speed**2:
        return "unnamed: T_xy is 0 and nothing says so", "bad", note
    return "finished", "good", note


def bed_cell(lab, group, settings, rod=None, density="phi_b = 0.7"):
    if any(s.startswith("granular.beads") for s in settings):
        density = ""
    lab.write("bed.toml", SCENE.format(density=density) + (ROD.format(kind=rod[0], at=rod[1]) if rod else ""))
    done = lab.run("dem", "bed.toml", "-o", "bed", "--force", "--quiet", "-j", "1", *[f"-s{s}" for s in settings], limit=LIMIT)
    name = ", ".join(settings) + (f"; {rod[0]} rod" if rod else "")
    if done.code == 0:
        status, verdict, note = bed_ended(lab, done)
    else:
        (status, verdict), note = done.refused(), done.stderr.strip()[-200:]
    return Cell(f"beds: {group}", name or "defaults", status, verdict, done.seconds, None, note)


QUICK = ("frequency", "gap")


def run_beds(lab):
    for group, cases in BEDS.items():
        if lab.quick:
            cases = cases[2:4] if group in QUICK else []
        lab.batch(f"beds: {group}", lambda: [bed_cell(lab, group, settings) for settings in cases])
        if not lab.quick and group in ("gamma", "frequency", "gap", "box", "restitution", "friction"):
            lab.batch(f"beds: {group}, rod", lambda: [bed_cell(lab, group, settings, ("motile", 8)) for settings in cases])
    if not lab.quick:
        lab.batch("beds: rod shape", lambda: [bed_cell(lab, "rod shape", settings, (kind, at)) for kind, at, settings in ROD_SHAPES])


# Fits.

TRUE = {"f_over_mu": 2.2, "eta": 1.3, "xi": 22.0}
METHODS = ("slsqp", "bobyqa", "nelder-mead", "lbfgs", "mma")
PLACES = [-39.5 + k for k in range(37)] + [4.0 + k for k in range(16)]


def wake(lab, places):
    """U_x of the true wake on the axis."""
    text = "x,y,xi,eta\n" + "".join(f"{x!r},0.0,{TRUE['xi']!r},{TRUE['eta']!r}\n" for x in places)
    answer = lab.run("field", "--points", "-", limit=10.0, text=text).stdout
    return [TRUE["f_over_mu"] * float(row["Ux"]) for row in rows_of(answer)]


def profile(lab, places, sigma=None, noise=0.0):
    random_ = random.Random(lab.seed)
    rows = [(x, u + noise * random_.gauss(0.0, 1.0)) for x, u in zip(places, wake(lab, places))]
    head, end = ("x,value,sigma\n", lambda k: f",{sigma(k) if callable(sigma) else sigma!r}\n") if sigma else ("x,value\n", lambda _: "\n")
    lab.write("ux.csv", head + "".join(f"{x!r},{value!r}{end(k)}" for k, (x, value) in enumerate(rows)))


def fit_cell(lab, group, name, keys, recovered=None, eta=2.0):
    """`recovered`: largest relative error of the parameters that is allowed, None: nothing is known of them."""
    lab.write("fit.toml", 'schema = 1\n[fit]\nparameters = ["f_over_mu", "eta", "xi"]\nstart = { f_over_mu = 1.5, '
              f'eta = {eta!r}, xi = 15.0 }}\n' + keys + '\n[[fit.profiles]]\nfile = "ux.csv"\n')
    done = lab.run("fit", "fit.toml", "-o", "fit", "--force", "--quiet", "-j", "1", limit=LIMIT)
    if done.code not in (0, 3):
        status, verdict = done.refused()
        return Cell(f"fits: {group}", name, status, verdict, done.seconds, None, done.stderr.strip()[-200:])
    text = lab.text("fit", "fit.json")
    if (found := not_finite(text)):
        return Cell(f"fits: {group}", name, f"not finite: {found}", "bad", done.seconds)
    fit = json.loads(text)
    status = str(fit.get("termination") or "unnamed: no termination")
    error = None
    if recovered:
        error = max(abs(fit["parameters"][p]["value"] / TRUE[p] - 1.0) for p in TRUE) / recovered
    verdict = "bad" if status.startswith("unnamed") else "differs" if error is not None and not error <= 1.0 else "good"
    return Cell(f"fits: {group}", name, status, verdict, done.seconds, error, "; ".join(fit.get("remarks", []))[:200])


def few_points(lab):
    """As many points as parameters, one fewer, one, none; sigma known or not."""
    for count in (2, 3) if lab.quick else (0, 1, 2, 3, 4):
        for sigma in (None, 0.004):
            profile(lab, PLACES[::12][:count], sigma)
            yield fit_cell(lab, "few points", f"{count} points, sigma {sigma}", "")


def perfect_data(lab):
    """No noise: parameters come back to the digits that chi2 at rounding leaves."""
    profile(lab, PLACES, 0.004)
    for method in METHODS:
        for polish in ("true", "false"):
            yield fit_cell(lab, "perfect data", f"{method}, polish {polish}", f'method = "{method}"\npolish = {polish}',
                       1e-6 if polish == "true" else None)
    profile(lab, PLACES)
    yield fit_cell(lab, "perfect data", "sigma unknown", "", 1e-6)


def sigmas(lab):
    """Twelve decades: equal in all points, and from point to point."""
    for exponent in range(-9, 4):
        profile(lab, PLACES, 10.0**exponent)
        yield fit_cell(lab, "sigmas", f"all 1e{exponent}", "", 1e-6 if exponent < 0 else None)
    profile(lab, PLACES, lambda k: 10.0**(-9 + 12 * k / (len(PLACES) - 1)))
    yield fit_cell(lab, "sigmas", "1e-9 to 1e3 in one profile", "")
    profile(lab, PLACES, lambda k: 10.0**(3 - 12 * k / (len(PLACES) - 1)))
    yield fit_cell(lab, "sigmas", "1e3 to 1e-9 in one profile", "")


def at_bounds(lab):
    """Bounds that shut out the true values, that touch them, that leave no room; starts on bounds."""
    profile(lab, PLACES, 0.004, 0.004)
    bounds = {"below": (1e-3, 0.5), "touching": (1.3, 50.0), "narrow": (1.3, 1.3 * (1 + 1e-12)), "wide": (1e-6, 1e6), "start on it": (2.0, 50.0)}
    for (name, (low, high)), method in itertools.product(bounds.items(), METHODS):
        yield fit_cell(lab, "bounds", f"eta {name}, {method}", f'method = "{method}"\nbounds = {{ eta = [{low!r}, {high!r}] }}',
                   eta=min(max(2.0, low), high))


FITS = {"few points": few_points, "perfect data": perfect_data, "sigmas": sigmas, "bounds": at_bounds}


def run_fits(lab):
    for name, make in FITS.items():
        if lab.quick and name != "few points":
            continue
        lab.batch(f"fits: {name}", lambda: make(lab))
