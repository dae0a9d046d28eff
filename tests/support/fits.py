"""Made-up wakes for the tests of rodwake fit, and what its files hold."""

import csv
import json

import numpy as np
from rodwake import ProgramTest

FIT = """schema = 1
[fit]
parameters = ["f_over_mu", "eta", "xi"]
start = { f_over_mu = 1.5, eta = 2.0, xi = 15.0 }
[[fit.profiles]]
file = "ux.csv"
"""

PRIORS = """[fit.posterior]
evidence = true
samples = 4000
[fit.posterior.priors]
f_over_mu = { kind = "normal", mean = 2.0, sd = 1.0 }
eta = { kind = "log_uniform", low = 0.05, high = 50.0 }
xi = { kind = "uniform", low = 1.0, high = 200.0 }
"""

TRUE = {"f_over_mu": 2.2, "eta": 1.3, "xi": 22.0}
SIGMA = 0.004
X = np.concatenate([np.arange(-39.5, -3.0), np.arange(4.0, 20.0)])
FIELD = "[field]\nx = [-5, 3]\ny = [-2, 2]\nnx = 25\nny = 13\n[[field.cuts]]\nfrom = -5\nto = 3\ncount = 9\n"
FITTED = "[medium]\nfitted = true\n"

KEYS = {
    "fit": {"parameters", "derived", "free", "correlation", "chi2", "dof", "residuals", "sigma_known", "probability", "error_factor",
            "rms", "objective", "loss", "termination", "reason", "distance", "evaluations", "algorithm", "rank", "flat", "remarks",
            "same_optimum", "starts", "likelihood", "profiles", "trajectories", "maps", "systematics", "misfit", "compare", "length_unit", "box", "core", "heading",
            "independent_spacing", "seed", "provenance"},
    "parameter": {"value", "stderr", "low", "high", "free", "fixed", "tied_to", "at_bound", "unit", "start", "bounds", "log"},
    "profile": {"name", "medium", "file", "component", "along", "at", "role", "points", "used", "independent", "data", "curve", "chi2", "excess"},
    "start": {"index", "start", "end", "objective", "termination", "evaluations"},
    "compare": {"name", "values", "chi2", "profiles"},
}


def columns(file):
    """A CSV file by column; empty fields are nan."""
    rows = list(csv.DictReader(file.read_text().splitlines()))
    return {name: np.array([float(row[name] or "nan") for row in rows]) for name in rows[0]}


def profile_text(places, values, sigma):
    return "x,value,sigma\n" + "".join(f"{float(x)!r},{float(v)!r},{sigma!r}\n" for x, v in zip(places, values))


def wake(test, places, at, component, along, box, *, f_over_mu, eta, xi, f2d_over_mu=0.0, x0=0.0, offset=0.0, offset_y=0.0):
    """The field of a rod along a line, by `rodwake field --points`."""
    x, y = (places, np.full(len(places), at)) if along == "x" else (np.full(len(places), at), places)
    rows = "".join(f"{float(a) - x0!r},{float(b)!r},{xi!r},{eta!r},{'' if box is None else box}\n" for a, b in zip(x, y))
    test.write("points.csv", "x,y,xi,eta,L\n" + rows)
    field = list(csv.DictReader(test.expect(0, "field", "--points", "points.csv").stdout.splitlines()))
    monopole, dipole = (np.array([float(row[name + component]) for row in field]) for name in ("", "dip"))
    return f_over_mu * monopole + f2d_over_mu * dipole + (offset if component == "Ux" else offset_y)


def compare_fits(test, found, expected):
    """All that is found is the same to the last bit."""
    for key in sorted(set(found) | set(expected)):
        test.assertEqual(found.get(key), expected.get(key), key)


class FitTest(ProgramTest):
    def setUp(self):
        super().setUp()
        self.random = np.random.default_rng(5)

    def make_profile(self, name="ux.csv", places=X, at=0.0, component="Ux", along="x", box=None, sigma=SIGMA, **terms):
        """Writes a profile of known parameters with noise; returns its values without."""
        exact = wake(self, places, at, component, along, box, **{**TRUE, **terms})
        self.write(name, profile_text(places, exact + sigma * self.random.standard_normal(len(places)), sigma))
        return exact

    def fit(self, text, *arguments, code=0, out="out"):
        self.write("fit.toml", text)
        done = self.expect(code, "fit", "fit.toml", "-o", out, *arguments)
        return json.loads((self.folder / out / "fit.json").read_text()), done

    def assert_recovered(self, found, true):
        """Within four standard errors: a chance of 1e-4 each, and the noise is the same every time."""
        for name, value in true.items():
            one = found["parameters"][name]
            self.assertLess(abs(one["value"] - value), 4.0 * one["stderr"], name)
