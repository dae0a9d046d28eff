"""Small fits for the tests and for looking at figures: the files of `rodwake fit`, shapes but no physics."""

import json

import numpy as np

from made_up_granular import write_csv

SCENE = """
schema = 1
title = "A fit"
[fit]
parameters = ["f_over_mu", "eta", "xi"]
start = { f_over_mu = 2.0, eta = 1.0, xi = 10.0 }
core = 8.0
[[fit.profiles]]
file = "profile_Ux_x.csv"
component = "Ux"
along = "x"
at = 0.0
"""
FOUR = (("Ux", "x", 0.0, "fit"), ("Ux", "y", 0.0, "fit"), ("Uy", "x", 4.0, "predict"), ("Uy", "y", 0.0, "predict"))
TWO = (("Ux", "x", 0.0, "predict"), ("Uy", "x", 4.0, "fit"))
UNITS = {"f_over_mu": "a", "eta": "1", "xi": "a", "f2d_over_mu": "a^2", "x0": "a", "amplitude": "1", "p_yy": "F a", "kappa": "v0 mu/f", "heading.0.1": "rad"}


def shape(component, x, y, strength=2.2, length=16.0):
    """Falls slowly behind and fast ahead, with the singularity of the theory; U_y changes its sign on the way."""
    r = np.hypot(x, y)
    with np.errstate(divide="ignore", invalid="ignore"):
        if component == "Ux":
            return strength * 0.28 * np.exp(-(x + r) / length) * (np.log1p(30 / r) + 0.4)
        return strength * 0.2 * np.exp(-(x + r) / length) * x * y / (r + 0.5) ** 2 * np.sign(r)


def places(along, at, s):
    return (s, np.full(s.size, at)) if along == "x" else (np.full(s.size, at), s)


def parameter(value, stderr=0.1, free=True, **more):
    wide = 1.96 * (stderr or 0.0)
    return {"value": value, "stderr": stderr, "low": value - wide if stderr else None, "high": value + wide if stderr else None,
            "free": free, "fixed": not free, "tied_to": "", "at_bound": None, "unit": "", "start": 1.0, "bounds": [None, None], "log": False} | more


def parameters(names=("f_over_mu", "eta", "xi")):
    known = {"f_over_mu": parameter(2.2, 0.06), "eta": parameter(1.31, 0.15, log=True, bounds=[1e-6, 1e6]),
             "xi": parameter(21.6, 1.9, log=True, bounds=[1e-6, 100.0], start=10.0), "f2d_over_mu": parameter(0.1, 0.02),
             "x0": parameter(0.4, 0.1), "amplitude": parameter(0.85, 0.02), "p_yy": parameter(9.1, 0.8), "kappa": parameter(0.5, 0.01), "heading.0.1": parameter(0.01, 0.002)}
    return {name: known[name] | {"unit": UNITS[name]} for name in names}


def starts(names, count, random):
    """Two thirds end at the optimum, the others at another one; the last fails."""
    found = []
    for index in range(count):
        same, failed = index % 3 != 2, count > 4 and index == count - 1
        end = {name: value["value"] * ((1 + 1e-7 * index) if same else 3.0) for name, value in parameters(names).items()}
        found.append({"index": index, "start": {name: value["value"] * 10 ** random.uniform(-1, 1) for name, value in parameters(names).items()},
                      "end": {} if failed else end, "objective": None if failed else 61.3 + (1e-9 * index if same else 40.0 + index),
                      "termination": "failed" if failed else "tolerance reached", "evaluations": 40 + index})
    return found


def likelihood(value, stderr, low=True):
    """Steeper below than the curvature says, flatter above; without an end below if asked for."""
    x = value + stderr * np.linspace(-3, 3, 25)
    t = (x - value) / stderr
    rise = np.where(t < 0, 1.0 if low else 0.05, 0.7) * t ** 2
    return {"value": list(x), "chi2": list(61.3 + rise), "low": value - 1.96 * stderr if low else None, "high": value + 2.34 * stderr}


def write_profile(folder, index, kind, random, compare, known, core, dense=78):
    component, along, at, role = kind
    s = np.linspace(-38.5, 38.5, dense)
    model = shape(component, *places(along, at, s))
    true = model * (2.2 if component == "Uy" and role == "predict" else 1.0)
    sigma = 0.02 + 0.0 * s
    value = true + sigma * random.standard_normal(s.size)
    value = np.where(abs(s) < core, 0.6 * value, value)
    used = (abs(s) >= core).astype(int)
    chi2 = float((((model - value) / sigma) ** 2)[used > 0].sum())
    write_csv(folder / f"fit_profile_{index}.csv", {"x": s, "value": value, "sigma": sigma * known, "model": model,
                                                    "band": 0.01 + 0.03 * abs(model), "residual": (model - value) / sigma, "used": used})
    s = np.linspace(-38.5, 38.5, 401)
    s = s[(s != 0) | (at != 0)]
    model = shape(component, *places(along, at, s))
    others = {f"compare_{one}": shape(component, *places(along, at, s), 2.2 * (one + 2) / 1.4, 10.0) for one in range(compare)}
    write_csv(folder / f"fit_curve_{index}.csv", {"x": s, "model": model, "band": 0.01 + 0.03 * abs(model), **others})
    return {"name": f"profile_{component}_{along}", "file": f"profile_{component}_{along}.csv", "component": component, "along": along,
            "at": at, "role": role, "points": dense, "used": int(used.sum()), "data": f"fit_profile_{index}.csv", "curve": f"fit_curve_{index}.csv",
            "chi2": chi2, "excess": {"scale": 2.2 if component == "Uy" and role == "predict" else 1.01, "stderr": 0.21, "chi2": chi2,
                                     "points": int(used.sum())}}


def write_trajectory(folder, index, random, count=60):
    t = np.linspace(0, 10, count)
    model = {"x0": t, "y0": 2.5 - 0.02 * t ** 2, "theta0": -0.04 * t, "x1": t, "y1": -2.5 + 0.02 * t ** 2, "theta1": 0.04 * t}
    data = {name: values + (0.05 if name[0] != "t" else 0.02) * random.standard_normal(count) for name, values in model.items()}
    write_csv(folder / f"fit_trajectory_{index}.csv", {"t": t, **data, **{f"model_{name}": values for name, values in model.items()}})
    return {"name": "rods", "file": "rods.csv", "rods": 2, "data": f"fit_trajectory_{index}.csv", "rms_position": 0.051, "rms_heading": 0.019}


def write_map(folder, index, strip=8.0):
    """Rows of bins, one of which has no data; a ridge in the strip that is not fitted."""
    x, y = (values.ravel() for values in np.meshgrid(np.arange(-36.0, 36.0, 2.0), np.arange(-33.0, 33.0, 2.0)))
    model = [shape("Ux", x, y + 1e-3), shape("Uy", x, y + 1e-3)]
    random, known = np.random.default_rng(index), np.arange(x.size) != 7
    Ux, Uy = (np.where(known, values + 0.02 * random.standard_normal(x.size), np.nan) for values in model)
    used = known & (abs(y) >= strip)
    write_csv(folder / f"fit_map_{index}.csv", {"x": x, "y": y, "Ux": Ux + 0.3 * (abs(y) < strip), "Uy": Uy, "sigma_x": 0.02 + 0 * x,
                                                "sigma_y": 0.02 + 0 * x, "model_Ux": model[0], "model_Uy": model[1], "known": known * 1,
                                                "used": used * 1})
    return {"name": f"run {index}", "file": f"run{index}.h5", "data": f"fit_map_{index}.csv", "bins": x.size, "used": int(used.sum()),
            "box": [72.0, 66.0], "speed": 2.6, "independent": 1.0, "mirrored": False, "mask": {"strip": strip, "radius": 0.0, "sector": [0, 3.14]},
            "chi2": 1234.5}


def correlation(count):
    """Strong between neighbours, weak and negative farther off."""
    away = abs(np.subtract.outer(np.arange(count), np.arange(count)))
    return np.where(away == 0, 1.0, np.where(away == 1, 0.9973, -0.31)).tolist()


def record(names=("f_over_mu", "eta", "xi"), number_of_starts=12, compare=1, likelihoods=("eta",), **more):
    random, known = np.random.default_rng(3), parameters(names)
    return {"parameters": known, "free": list(names), "derived": {"alpha": {"value": 0.102, "stderr": 0.009, "unit": "1"}},
            "correlation": correlation(len(names)), "chi2": 61.3, "dof": 59, "probability": 0.39, "error_factor": 1.0, "rms": 0.021,
            "objective": 61.3, "loss": "squares", "termination": "converged", "reason": "the polish met its tolerance", "evaluations": 612,
            "algorithm": "slsqp", "rank": len(names), "flat": [], "remarks": [], "same_optimum": 8,
            "starts": starts(names, number_of_starts, random),
            "likelihood": {name: likelihood(known[name]["value"], known[name]["stderr"]) for name in likelihoods},
            "profiles": [], "trajectories": [], "length_unit": "a", "box": None, "core": 8.0, "heading": 0.0, "independent_spacing": 4.2,
            "seed": 1, "compare": [{"name": f"other {one}" if one else "paper", "values": {"f_over_mu": 2.2, "eta": 1.3, "xi": 22.0},
                                    "chi2": 99.1 + one, "profiles": []} for one in range(compare)]} | more


def write_fit(folder, profiles=FOUR, trajectories=0, maps=0, known=1, compare=1, core=8.0, scene=SCENE, figures="", **more):
    """The whole run directory of a fit alone; `more` goes over the record."""
    folder.mkdir(parents=True, exist_ok=True)
    random = np.random.default_rng(1)
    (folder / "scene.toml").write_text(scene + figures)
    (folder / "provenance.json").write_text(json.dumps({"version": "0.1.0", "status": "finished"}))
    results = record(compare=compare, core=core, **more)
    results["profiles"] = [write_profile(folder, index, kind, random, compare, known, core) for index, kind in enumerate(profiles)]
    results["trajectories"] = [write_trajectory(folder, index, random) for index in range(trajectories)]
    results["maps"] = [write_map(folder, index) for index in range(maps)]
    for one in results["compare"]:
        one["profiles"] = [{"chi2": 1.6 * own["chi2"], "excess": own["excess"]} for own in results["profiles"]]
    (folder / "fit.json").write_text(json.dumps(results))
    return results
