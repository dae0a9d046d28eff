"""Cells of fits: profiles of a known wake with too few points, no noise, sigmas of any size, and bounds that bite."""

import csv
import io
import itertools
import json
import random

from .lab import Cell, not_finite

LIMIT = 60.0
TRUE = {"f_over_mu": 2.2, "eta": 1.3, "xi": 22.0}
METHODS = ("slsqp", "bobyqa", "nelder-mead", "lbfgs", "mma")
PLACES = [-39.5 + k for k in range(37)] + [4.0 + k for k in range(16)]


def wake(lab, places):
    """U_x of the true wake on the axis."""
    text = "x,y,xi,eta\n" + "".join(f"{x!r},0.0,{TRUE['xi']!r},{TRUE['eta']!r}\n" for x in places)
    rows = csv.DictReader(io.StringIO(lab.run("field", "--points", "-", limit=10.0, text=text).stdout))
    return [TRUE["f_over_mu"] * float(row["Ux"]) for row in rows]


def profile(lab, places, sigma=None, noise=0.0):
    random_ = random.Random(lab.seed)
    rows = [(x, u + noise * random_.gauss(0.0, 1.0)) for x, u in zip(places, wake(lab, places))]
    head, end = ("x,value,sigma\n", lambda k: f",{sigma(k) if callable(sigma) else sigma!r}\n") if sigma else ("x,value\n", lambda _: "\n")
    lab.write("ux.csv", head + "".join(f"{x!r},{value!r}{end(k)}" for k, (x, value) in enumerate(rows)))


def cell(lab, group, name, keys, recovered=None, eta=2.0):
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
            yield cell(lab, "few points", f"{count} points, sigma {sigma}", "")


def perfect_data(lab):
    """No noise: parameters come back to the digits that chi2 at rounding leaves."""
    profile(lab, PLACES, 0.004)
    for method in METHODS:
        for polish in ("true", "false"):
            yield cell(lab, "perfect data", f"{method}, polish {polish}", f'method = "{method}"\npolish = {polish}',
                       1e-6 if polish == "true" else None)
    profile(lab, PLACES)
    yield cell(lab, "perfect data", "sigma unknown", "", 1e-6)


def sigmas(lab):
    """Twelve decades: equal in all points, and from point to point."""
    for exponent in range(-9, 4):
        profile(lab, PLACES, 10.0**exponent)
        yield cell(lab, "sigmas", f"all 1e{exponent}", "", 1e-6 if exponent < 0 else None)
    profile(lab, PLACES, lambda k: 10.0**(-9 + 12 * k / (len(PLACES) - 1)))
    yield cell(lab, "sigmas", "1e-9 to 1e3 in one profile", "")
    profile(lab, PLACES, lambda k: 10.0**(3 - 12 * k / (len(PLACES) - 1)))
    yield cell(lab, "sigmas", "1e3 to 1e-9 in one profile", "")


def at_bounds(lab):
    """Bounds that shut out the true values, that touch them, that leave no room; starts on bounds."""
    profile(lab, PLACES, 0.004, 0.004)
    bounds = {"below": (1e-3, 0.5), "touching": (1.3, 50.0), "narrow": (1.3, 1.3 * (1 + 1e-12)), "wide": (1e-6, 1e6), "start on it": (2.0, 50.0)}
    for (name, (low, high)), method in itertools.product(bounds.items(), METHODS):
        yield cell(lab, "bounds", f"eta {name}, {method}", f'method = "{method}"\nbounds = {{ eta = [{low!r}, {high!r}] }}',
                   eta=min(max(2.0, low), high))


GROUPS = {"few points": few_points, "perfect data": perfect_data, "sigmas": sigmas, "bounds": at_bounds}


def run(lab):
    for name, make in GROUPS.items():
        if lab.quick and name != "few points":
            continue
        lab.batch(f"fits: {name}", lambda: make(lab))
