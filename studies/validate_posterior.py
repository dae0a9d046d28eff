#!/usr/bin/python3
"""Posterior and evidence of fits against known answers: the tables of studies/reports/fitting.md, "Posterior and evidence".

    studies/validate_posterior.py [--program build/release/rodwake] [--only exact,grid,speed,track_speed,wakes,pairs,wandering] [--quick] [-j 2]
                                 [--keep DIR] [--runs 1000]

exact: a linear model with normal errors against its closed form, by many samples. grid: three parameters that are not linear against sums
over a grid. speed: effective samples a second beside emcee (python3-emcee) on the same density, both on one thread, CPU time.
track_speed: the same of tracks, without emcee. wakes, pairs, wandering: calibration by simulation (Talts et al. 2018): data sets made from the
prior, a fifth as many with a planted fault; ranks of the truth among the samples must be uniform, and with a fault must not. Sets that --keep has
are not made again. The Python package is taken from beside the program (build/release/python). --quick: few samples and sets, whose numbers mean
nothing.
"""

import functools
import math
import sys
import time
from pathlib import Path

import numpy as np
from scipy.stats import chi2

from lab import parser, rows_of, run_parts, table

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


# Calibration by simulation.

BINS, DRAWS, THINNED = 20, 99, 2


def drawn(random, priors):
    """Values from the priors."""
    values = {}
    for name, prior in priors.items():
        low, high = prior["low"], prior["high"]
        values[name] = low * (high / low) ** random.uniform() if prior["kind"] == "log_uniform" else random.uniform(low, high)
    return values


WAKE = {"f_over_mu": {"kind": "uniform", "low": 0.5, "high": 4.0}, "eta": {"kind": "log_uniform", "low": 0.3, "high": 6.0},
        "xi": {"kind": "log_uniform", "low": 6.0, "high": 60.0}}
WANDERING = {"kappa": {"kind": "uniform", "low": 0.2, "high": 2.0}, "D_r": {"kind": "log_uniform", "low": 0.0005, "high": 0.01}}
PAIR = {"kappa": {"kind": "uniform", "low": 0.2, "high": 2.0}, "gamma1": {"kind": "uniform", "low": -0.5, "high": 0.5}}
START, TIMES = [[0.0, 2.5, 0.1], [0.0, -2.5, -0.1]], np.linspace(0.0, 6.0, 9)
CLOSE, CLOSE_SIGMA = [[0.0, 1.2, 0.2], [1.0, -1.2, -0.1]], np.array([0.005, 0.005, 0.0025])  # farther apart, tracks tell little of gamma1


def wake_set(rodwake, random, fault, _):
    places = np.linspace(-38.0, 38.0, 20)
    truth = drawn(random, WAKE)
    values = wake(rodwake, places, **truth) + SIGMA * random.normal(size=places.size)
    if fault == "sign":
        truth["f_over_mu"] = 4.5 - truth["f_over_mu"]
    data = profile(rodwake, places, values, 0.5 * SIGMA if fault == "sigma halved" else SIGMA)
    return truth, {"profiles": [data], "parameters": list(WAKE), "priors": WAKE,
                   "bounds": {name: [prior["low"], prior["high"]] for name, prior in WAKE.items()}, "start": {name: 2.0 if name != "xi" else 20.0 for name in WAKE}}


def pair_set(rodwake, random, fault, _):
    truth = drawn(random, PAIR)
    path = rodwake.simulate(CLOSE, rodwake.Medium(eta=1.3, alpha=0.5), t_end=TIMES[-1], output_times=TIMES, **truth)
    poses = path.poses + CLOSE_SIGMA * random.normal(size=path.poses.shape)
    poses[0] = path.poses[0]
    if fault == "sign":
        truth["gamma1"] *= -1
    sigma = CLOSE_SIGMA * (0.5 if fault == "sigma halved" else 1.0)
    data = rodwake.Track(TIMES, poses, sigma_position=sigma[0], sigma_heading=sigma[2], start_poses="exact")
    return truth, {"tracks": [data], "parameters": list(PAIR), "priors": PAIR, "fixed": {"eta": 1.3, "alpha": 0.5},
                   "bounds": {name: [prior["low"], prior["high"]] for name, prior in PAIR.items()}, "start": {"kappa": 1.0, "gamma1": 0.1}}


def turning(rodwake, poses, kappa, medium):
    """theta' of both rods, of poses (sets, 2, 3) at once."""
    rates = np.empty(poses.shape[:2])
    for a, b in ((0, 1), (1, 0)):
        heading, apart = poses[:, b, 2], poses[:, a, :2] - poses[:, b, :2]
        cos, sin = np.cos(heading), np.sin(heading)
        strain = rodwake.strain(cos * apart[:, 0] + sin * apart[:, 1], cos * apart[:, 1] - sin * apart[:, 0], medium)
        angle = poses[:, a, 2] - heading
        nx, ny = np.cos(angle), np.sin(angle)
        across = strain[:, 1, 0] * nx + strain[:, 1, 1] * ny
        along = strain[:, 0, 0] * nx + strain[:, 0, 1] * ny
        rates[:, a] = kappa * (nx * across - ny * along)
    return rates


def wander(rodwake, random, kappa, diffusion, each=50):
    """Poses (sets, times, 2, 3) by Heun's method with additive noise, `each` steps a row: not the program's own integrator."""
    medium, step = rodwake.Medium(eta=1.3, alpha=0.5), (TIMES[1] - TIMES[0]) / each
    poses = np.repeat(np.array(START)[None], kappa.size, axis=0)
    rows = [poses.copy()]

    def slope(at):
        return np.stack([np.cos(at[..., 2]), np.sin(at[..., 2]), turning(rodwake, at, kappa, medium)], axis=-1)

    for _ in range((TIMES.size - 1) * each):
        kick = np.zeros_like(poses)
        kick[..., 2] = np.sqrt(2 * diffusion * step)[:, None] * random.normal(size=poses.shape[:2])
        first = slope(poses)
        poses = poses + kick + 0.5 * step * (first + slope(poses + step * first + kick))
        rows.append(poses)
    return np.stack(rows[::each], axis=1)


@functools.cache
def wanderers(rodwake):
    random = np.random.default_rng(21)
    truths = [drawn(random, WANDERING) for _ in range(1000)]
    return truths, wander(rodwake, random, np.array([one["kappa"] for one in truths]), np.array([one["D_r"] for one in truths]))


def wandering_set(rodwake, random, fault, index):
    """Rods that diffuse: kappa and D_r from the tracks, poses at the start measured like the others."""
    truths, paths = wanderers(rodwake)
    truth, poses = dict(truths[index]), paths[index] + SIGMA * random.normal(size=paths[index].shape)
    priors, fixed = dict(WANDERING), {"eta": 1.3, "alpha": 0.5}
    if fault == "noise of the rods left out":
        fixed["D_r"] = 0.0
        del truth["D_r"], priors["D_r"]
    sigma = SIGMA * (0.5 if fault == "sigma halved" else 1.0)
    return truth, {"tracks": [rodwake.Track(TIMES, poses, sigma_position=sigma, sigma_heading=sigma)], "parameters": list(priors), "priors": priors,
                   "fixed": fixed, "bounds": {name: [prior["low"], prior["high"]] for name, prior in priors.items()},
                   "start": {name: {"kappa": 1.0, "D_r": 0.003}[name] for name in priors}}


def by_samples(lab, rodwake, truth, keys, index):
    """How many of 99 samples lie below the truth."""
    samples = rodwake.posterior(**keys, chains=2, samples=THINNED * (DRAWS + 1), evidence=False, threads=lab.threads, seed=index + 1).samples
    return {name: int(np.sum(samples[name].ravel()[::THINNED][:DRAWS] < value)) for name, value in truth.items()}


def by_grid(lab, rodwake, truth, keys, _):
    """Hundredths of the posterior below the truth, from a coarse grid and a fine one where that says that there is something: a fortieth of the
    evaluations that samples take."""
    problem = rodwake.FitProblem(**keys, threads=lab.threads)
    low, high, log = (np.array([keys["priors"][name][key] if key != "kind" else keys["priors"][name][key] == "log_uniform" for name in problem.names])
                      for key in ("low", "high", "kind"))
    value = lambda u: np.where(log, low * (high / low) ** u, low + u * (high - low))
    start, end = np.zeros(low.size), np.ones(low.size)
    for count in (14, 24):
        middles = [a + (b - a) * (np.arange(count) + 0.5) / count for a, b in zip(start, end)]
        cells = np.stack([one.ravel() for one in np.meshgrid(*middles, indexing="ij")], axis=1)
        weight = problem.log_likelihood(value(cells))
        weight = np.exp(weight - weight.max())
        there, step = cells[weight > 1e-6], (end - start) / count
        before, start, end = (start, end), np.maximum(there.min(axis=0) - step, 0.0), np.minimum(there.max(axis=0) + step, 1.0)
    weight, found = (weight / weight.sum()).reshape([count] * low.size), {}
    for k, name in enumerate(problem.names):
        below = np.concatenate([[0.0], np.cumsum(weight.sum(axis=tuple(j for j in range(low.size) if j != k)))])
        u = math.log(truth[name] / low[k]) / math.log(high[k] / low[k]) if log[k] else (truth[name] - low[k]) / (high[k] - low[k])
        found[name] = min(DRAWS, int((DRAWS + 1) * np.interp(u, np.linspace(before[0][k], before[1][k], count + 1), below)))
    return found


def ranks(lab, rodwake, name, make, rank, sets, fault):
    """{parameter: ranks of the truth from 0 to 99, a set each}; sets that --keep has are not made again."""
    file = lab.folder / f"ranks_{name}_{fault.replace(' ', '_') or 'right'}.csv"
    found = {}
    for row in rows_of(file.read_text(encoding="utf-8")) if file.is_file() else []:
        found.setdefault(row["parameter"], []).append(int(row["rank"]))
    with file.open("a", encoding="utf-8") as out:
        if not found:
            out.write("set,parameter,rank\n")
        for index in range(max((len(each) for each in found.values()), default=0), sets):
            random = np.random.default_rng([index, 11])
            truth, keys = make(rodwake, random, fault, index)
            for parameter, one in rank(lab, rodwake, truth, keys, index).items():
                found.setdefault(parameter, []).append(one)
                out.write(f"{index},{parameter},{found[parameter][-1]}\n")
            out.flush()
    return {parameter: np.array(each[:sets]) for parameter, each in found.items()}


def chance(each):
    """Of so large a chi2 if ranks are uniform."""
    counts, expected = np.bincount(each * BINS // (DRAWS + 1), minlength=BINS), each.size / BINS
    return chi2.sf(np.sum((counts - expected) ** 2) / expected, BINS - 1)


def track_speed(lab):
    rows = []
    for words, make in (("two rods, 8 rows", pair_set), ("the same of rods that diffuse", wandering_set)):
        _, keys = make(package(lab), np.random.default_rng([0, 11]), "", 0)
        began = time.process_time()
        found = package(lab).posterior(**keys, threads=1)
        took = time.process_time() - began
        rows.append([words, f"{took:.1f}", f"{min(one.ess for one in found.parameters.values()):.0f}", f"{found.log_evidence[1]:.3f}"])
    table("Posteriors of tracks, two parameters, 4000 samples, with fit and evidence",
          ["data", "CPU s", "effective samples", "error of the log evidence"], rows)


def calibrated(name, words, make, faults, rank=by_samples):
    def part(lab):
        rows, sets = [], lab.options.runs or (40 if lab.quick else 1000)
        for fault in ("", *faults):
            began = time.process_time()
            found = ranks(lab, package(lab), name, make, rank, sets // 5 if fault else sets, fault)
            rows.append([fault or "none", next(iter(found.values())).size, ", ".join(f"{one} {chance(each):.2g}" for one, each in found.items()),
                         f"{time.process_time() - began:.0f}"])
        table(f"Ranks of the truth, {words}: probability of so large a chi2 if they are uniform", ["planted fault", "sets", "probability", "CPU s"], rows)
    return part


PARTS = {"exact": exact, "grid": grid, "speed": speed, "track_speed": track_speed,
         "wakes": calibrated("wakes", "wakes of 20 points", wake_set, ("sigma halved", "sign")),
         "pairs": calibrated("pairs", "trajectories of two rods, 8 rows", pair_set, ("sigma halved", "sign")),
         "wandering": calibrated("wandering", "the same of rods that diffuse", wandering_set, ("sigma halved", "noise of the rods left out"), by_grid)}

if __name__ == "__main__":
    run_parts(parser(__doc__, "report", "quick", "threads", "keep", "runs", parts=PARTS).parse_args(), PARTS)
