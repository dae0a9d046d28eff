#!/usr/bin/python3
"""Posterior and evidence of fits against known answers: the tables of docs/validation_fitting.md, "Posterior and evidence".

    studies/validate_posterior.py [--program build/release/rodwake] [--only exact,grid,speed,calibration] [--quick] [-j 2]

exact: a linear model with normal errors against its closed form, by many samples. grid: three parameters that are not linear against sums
over a grid. speed: effective samples a second beside emcee (python3-emcee) on the same density, both on one thread, CPU time.
calibration: data sets made from the prior; ranks of the truth among the samples must be uniform, and with a planted fault must not. The
Python package is taken from beside the program (build/release/python). --quick: few samples and sets, whose numbers mean nothing.
"""

import math
import sys
import time
from pathlib import Path

import numpy as np
from scipy.stats import chi2

from lab import parser, run_parts, table

SIGMA = 0.02


def package(lab):
    sys.path.insert(0, str(Path(lab.program).parent / "python"))
    import rodwake  # pylint: disable=import-outside-toplevel
    return rodwake


def wake(rodwake, places, f_over_mu, eta, xi, offset=0.0):
    return f_over_mu * rodwake.displacement(places, 1.0, rodwake.Medium(eta=eta, xi=xi))[:, 0] + offset


def profile(rodwake, places, values, sigma=SIGMA):
    return rodwake.Profile(places, values, np.full(places.size, sigma), component="Ux", along="x", at=1.0)


def made_up(rodwake, count, sigma=SIGMA, seed=7):
    """Of f/mu = 2.2, eta = 1.3, xi = 22, with noise."""
    places = np.linspace(-38.0, 38.0, count)
    return places, wake(rodwake, places, 2.2, 1.3, 22.0, 0.01) + sigma * np.random.default_rng(seed).normal(size=count)


# Closed form.


def exact(lab):
    rodwake = package(lab)
    places, values = made_up(rodwake, 40)
    samples = 4000 if lab.quick else 100000
    found = rodwake.posterior(profiles=[profile(rodwake, places, values)], parameters=["f_over_mu", "offset"], fixed={"eta": 1.3, "xi": 22.0},
                              priors={"f_over_mu": {"kind": "uniform", "low": -10.0, "high": 10.0},
                                      "offset": {"kind": "uniform", "low": -1.0, "high": 1.0}}, samples=samples, threads=lab.threads)
    design = np.stack([wake(rodwake, places, 1.0, 1.3, 22.0), np.ones(places.size)], axis=1) / SIGMA
    covariance = np.linalg.inv(design.T @ design)
    mean = covariance @ design.T @ values / SIGMA
    left = np.sum((values / SIGMA - design @ mean) ** 2)
    evidence = (-left / 2 - places.size * math.log(SIGMA * math.sqrt(2 * math.pi)) + math.log(2 * math.pi)
                + 0.5 * math.log(np.linalg.det(covariance)) - math.log(20.0 * 2.0))
    errors = np.sqrt(np.diag(covariance))
    drawn = np.array([found.samples[name].ravel() for name in ("f_over_mu", "offset")])
    rows = [[f"mean of {name}, in errors", f"{(one.mean - true) / error:+.4f}", f"{1 / math.sqrt(one.ess):.4f}"]
            for (name, one), true, error in zip(found.parameters.items(), mean, errors)]
    apart = np.cov(drawn) / np.outer(errors, errors) - covariance / np.outer(errors, errors)
    rows += [["covariance, largest difference in errors squared", f"{np.abs(apart).max():.4f}", f"{math.sqrt(2 / drawn.shape[1]):.4f}"],
             ["log evidence", f"{found.log_evidence[0] - evidence:+.4f}", f"{found.log_evidence[1]:.4f}"]]
    default = rodwake.FitProblem(profiles=[profile(rodwake, places, values)], parameters=["f_over_mu", "offset"], fixed={"eta": 1.3, "xi": 22.0},
                                 priors={"f_over_mu": {"kind": "uniform", "low": -10.0, "high": 10.0},
                                         "offset": {"kind": "uniform", "low": -1.0, "high": 1.0}}).posterior()
    rows.append(["log evidence, 4000 samples", f"{default.log_evidence[0] - evidence:+.4f}", f"{default.log_evidence[1]:.4f}"])
    table(f"Linear model, {samples} samples: differences from the closed form", ["what", "difference", "its Monte-Carlo error"], rows)


# A grid.

PRIORS = {"f_over_mu": {"kind": "normal", "mean": 2.0, "sd": 1.0, "low": 0.0, "high": 6.0},
          "eta": {"kind": "log_uniform", "low": 0.1, "high": 20.0}, "xi": {"kind": "uniform", "low": 5.0, "high": 60.0}}
NAMES = list(PRIORS)


def grid(lab):
    rodwake = package(lab)
    places, values = made_up(rodwake, 30, 3 * SIGMA)
    problem = rodwake.FitProblem(profiles=[profile(rodwake, places, values, 3 * SIGMA)], parameters=NAMES, priors=PRIORS,
                                 samples=4000 if lab.quick else 40000, threads=lab.threads)
    count = 30 if lab.quick else 100
    middles = [(np.arange(count) + 0.5) / count for _ in NAMES]
    axes = [6.0 * middles[0], 0.1 * 200.0 ** middles[1], 5.0 + 55.0 * middles[2]]
    cells = np.stack([one.ravel() for one in np.meshgrid(*axes, indexing="ij")], axis=1)
    volume = 6.0 * 55.0 * cells[:, 1] * math.log(200.0) / count**3
    density = problem.log_density(cells)
    weight = np.exp(density - density.max()) * volume
    evidence = density.max() + math.log(weight.sum())
    weight /= weight.sum()
    found, rows = problem.posterior(), []
    for k, (name, one) in enumerate(found.parameters.items()):
        mean = weight @ cells[:, k]
        sd = math.sqrt(weight @ (cells[:, k] - mean) ** 2)
        rows.append([name, f"{mean:.4g} +- {sd:.3g}", f"{one.mean:.4g} +- {one.sd:.3g}", f"{(one.mean - mean) / sd * math.sqrt(one.ess):+.1f}",
                     f"{one.rhat:.4f}", f"{one.ess:.0f}"])
    rows.append(["log evidence", f"{evidence:.4f}", f"{found.log_evidence[0]:.4f} +- {found.log_evidence[1]:.4f}",
                 f"{(found.log_evidence[0] - evidence) / found.log_evidence[1]:+.1f}", "", ""])
    table(f"Three parameters, 30 points of poor data: a grid of {count}^3 and samples", ["what", "grid", "samples", "difference in Monte-Carlo errors",
                                                                                       "R-hat", "effective samples"], rows)


# Speed.


def speed(lab):
    import emcee  # pylint: disable=import-outside-toplevel
    rodwake = package(lab)
    places, values = made_up(rodwake, 100)
    problem = rodwake.FitProblem(profiles=[profile(rodwake, places, values)], parameters=NAMES, priors=PRIORS, threads=1)
    best = rodwake.fit_wake([profile(rodwake, places, values)], NAMES)
    centre = np.array([best.parameters[name].value for name in NAMES])
    began = time.process_time()
    density = problem.log_density(np.repeat(centre[None], 4000, axis=0))
    each = (time.process_time() - began) / density.size
    began = time.process_time()
    found = problem.posterior()
    ours = time.process_time() - began
    least = min(one.ess for one in found.parameters.values())
    walkers, steps = 32, 500 if lab.quick else 5000
    start = centre * (1 + 0.01 * np.random.default_rng(1).normal(size=(walkers, 3)))
    sampler = emcee.EnsembleSampler(walkers, 3, problem.log_density, vectorize=True)
    sampler.random_state = np.random.RandomState(1).get_state()  # pylint: disable=no-member
    began = time.process_time()
    sampler.run_mcmc(start, steps)
    theirs = time.process_time() - began
    most = sampler.get_autocorr_time(quiet=True).max()
    kept = sampler.get_chain(discard=int(5 * most), flat=True)
    count = kept.shape[0] / most
    rows = [["rodwake.posterior, with fit and evidence", f"{ours:.2f}", f"{least:.0f}", f"{least / ours:.0f}",
             f"R-hat {max(one.rhat for one in found.parameters.values()):.4f}, log evidence +- {found.log_evidence[1]:.3f}"],
            [f"emcee, {walkers} walkers, {steps} steps", f"{theirs:.2f}", f"{count:.0f}", f"{count / theirs:.0f}", f"autocorrelation {most:.0f} steps"]]
    table(f"Three parameters, 100 points ({1e6 * each:.0f} us an evaluation), one thread", ["sampler", "CPU s", "effective samples", "of them a CPU second",
                                                                                         ""], rows)
    apart = [(one.mean - kept[:, k].mean()) / (one.sd * math.hypot(one.ess**-0.5, count**-0.5)) for k, one in enumerate(found.parameters.values())]
    print(f"means apart, in Monte-Carlo errors of both: {', '.join(f'{one:+.1f}' for one in apart)}")


# Calibration by simulation (Talts et al. 2018).

BINS, DRAWS = 20, 99


def drawn(random, priors):
    """Values from the priors."""
    values = {}
    for name, prior in priors.items():
        low, high = prior["low"], prior["high"]
        values[name] = low * (high / low) ** random.uniform() if prior["kind"] == "log_uniform" else random.uniform(low, high)
    return values


WAKE = {"f_over_mu": {"kind": "uniform", "low": 0.5, "high": 4.0}, "eta": {"kind": "log_uniform", "low": 0.3, "high": 6.0},
        "xi": {"kind": "log_uniform", "low": 6.0, "high": 60.0}}
PAIR = {"kappa": {"kind": "uniform", "low": 0.2, "high": 2.0}, "gamma1": {"kind": "uniform", "low": -0.5, "high": 0.5}}
START, TIMES = [[0.0, 2.5, 0.1], [0.0, -2.5, -0.1]], np.linspace(0.0, 6.0, 9)


def wake_set(rodwake, random, fault):
    places = np.linspace(-38.0, 38.0, 20)
    truth = drawn(random, WAKE)
    values = wake(rodwake, places, **truth) + SIGMA * random.normal(size=places.size)
    if fault == "sign":
        truth["f_over_mu"] = 4.5 - truth["f_over_mu"]
    data = profile(rodwake, places, values, 0.5 * SIGMA if fault == "sigma halved" else SIGMA)
    return truth, {"profiles": [data], "parameters": list(WAKE), "priors": WAKE,
                   "bounds": {name: [prior["low"], prior["high"]] for name, prior in WAKE.items()}, "start": {name: 2.0 if name != "xi" else 20.0 for name in WAKE}}


def pair_set(rodwake, random, fault):
    truth = drawn(random, PAIR)
    path = rodwake.simulate(START, rodwake.Medium(eta=1.3, alpha=0.5), t_end=TIMES[-1], output_times=TIMES, **truth)
    size = np.array([0.02, 0.02, 0.01])
    poses = path.poses + size * random.normal(size=path.poses.shape)
    poses[0] = path.poses[0]
    if fault == "sign":
        truth["gamma1"] *= -1
    told = size * (0.5 if fault == "sigma halved" else 1.0)
    data = rodwake.Track(TIMES, poses, sigma_position=told[0], sigma_heading=told[2], start_poses="exact")
    return truth, {"tracks": [data], "parameters": list(PAIR), "priors": PAIR, "fixed": {"eta": 1.3, "alpha": 0.5},
                   "bounds": {name: [prior["low"], prior["high"]] for name, prior in PAIR.items()}, "start": {"kappa": 1.0, "gamma1": 0.1}}


def ranks(lab, rodwake, make, sets, fault):
    """{parameter: how often the truth was in each of the bins}."""
    counts = {}
    for index in range(sets):
        random = np.random.default_rng([index, 11])
        truth, keys = make(rodwake, random, fault)
        found = rodwake.posterior(**keys, chains=2, samples=4 * (DRAWS + 1), evidence=False, threads=lab.threads, seed=index + 1)
        for name, value in truth.items():
            some = found.samples[name].ravel()[::4][:DRAWS]
            counts.setdefault(name, np.zeros(BINS))[int(np.sum(some < value)) * BINS // (DRAWS + 1)] += 1
    return counts


def calibration(lab):
    rodwake = package(lab)
    rows = []
    for name, make, sets in (("wakes of 20 points", wake_set, 1000), ("trajectories of two rods, 8 rows", pair_set, 1000)):
        for fault, share in (("", 1.0), ("sigma halved", 0.2), ("sign", 0.2)):
            count = int((40 if lab.quick else sets) * share)
            began, found = time.process_time(), ranks(lab, rodwake, make, count, fault)
            chances = {one: chi2.sf(np.sum((each - count / BINS) ** 2) / (count / BINS), BINS - 1) for one, each in found.items()}
            rows.append([name, fault or "none", count, ", ".join(f"{one} {p:.2g}" for one, p in chances.items()), f"{time.process_time() - began:.0f}"])
            print(f"  ({name}, {fault or 'no fault'}: {rows[-1][3]})", file=sys.stderr, flush=True)
    table("Ranks of the truth among the samples: probability of so large a chi2 if they are uniform", ["data", "planted fault", "sets", "probability",
                                                                                                     "CPU s"], rows)


PARTS = {"exact": exact, "grid": grid, "speed": speed, "calibration": calibration}

if __name__ == "__main__":
    run_parts(parser(__doc__, "quick", "threads", parts=PARTS).parse_args(), PARTS)
