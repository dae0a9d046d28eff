"""A small posterior for the tests and for looking at figures: the files of `rodwake fit` with [fit.posterior]."""

import json

import numpy as np

from made_up_fit import UNITS
from made_up_granular import write_csv

PRIORS = {"f_over_mu": {"kind": "normal", "low": 0.0, "high": 6.0, "mean": 2.0, "sd": 1.0}, "eta": {"kind": "log_uniform", "low": 0.05, "high": 50.0},
          "xi": {"kind": "uniform", "low": 1.0, "high": 100.0}}


def samples(chains=4, draws=500, seed=3):
    """Bent where the ellipse of made_up_fit is straight: {name: [chain][draw]}."""
    random = np.random.default_rng(seed)
    a, b, c = random.standard_normal((3, chains, draws))
    return {"f_over_mu": 2.2 + 0.06 * a, "eta": 1.31 * np.exp(0.12 * (0.6 * a + 0.8 * b)), "xi": 21.6 + 1.9 * (-0.5 * a + 0.6 * b + 0.6 * c) + 0.5 * a**2}


def write_posterior(folder, profiles=(), tracks=0, **changes):
    """Beside the files of write_fit; `profiles`: indices of those with a band."""
    found = samples()
    chain, draw = np.indices(next(iter(found.values())).shape)
    write_csv(folder / "posterior.csv", {"chain": chain.ravel(), "draw": draw.ravel(), **{name: one.ravel() for name, one in found.items()},
                                         "log_likelihood": 0.0 * chain.ravel()})
    for index in profiles:
        x = np.linspace(-38.5, 38.5, 201)
        middle = 0.3 * np.exp(-np.abs(x) / 16.0)
        write_csv(folder / f"posterior_curve_{index}.csv", {"x": x, "median": middle, "low": middle - 0.01, "high": middle + 0.01,
                                                            "noise_low": middle - 0.05, "noise_high": middle + 0.05})
    for index in range(tracks):
        t, rod, coordinate = (one.ravel() for one in np.meshgrid(np.arange(30.0), [0.0, 1.0], [0.0, 1.0, 2.0], indexing="ij"))
        data = 0.02 * np.random.default_rng(5).standard_normal(t.size)
        write_csv(folder / f"posterior_trajectory_{index}.csv",
                  {"t": t, "rod": rod, "coordinate": coordinate, "data": data + t, "median": t, "low": t - 0.002 * t**0.5, "high": t + 0.002 * t**0.5,
                   "noise_low": t - 0.04, "noise_high": t + 0.04})
    record = {"parameters": {name: marginal(name, one) for name, one in found.items()}, "log_evidence": {"value": -123.4, "stderr": 0.02},
            "samples": "posterior.csv", "chains": 4, "accepted": [0.4, 0.41, 0.39, 0.42], "seed": 1, "remarks": [], "provenance": {}} | changes
    (folder / "posterior.json").write_text(json.dumps(record))
    return record


def marginal(name, values):
    q025, median, q975 = np.percentile(values, [2.5, 50, 97.5])
    return {"mean": values.mean(), "sd": values.std(), "median": median, "q025": q025, "q975": q975, "rhat": 1.0012, "ess": 1900.0,
            "unit": UNITS[name], "prior": PRIORS[name]}
