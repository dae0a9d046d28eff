#!/usr/bin/python3
"""One profile fit (f_over_mu, eta, xi; 100 points), by rodwake and by scipy.optimize.least_squares, in turns on one core.

    bench/wake_fit.py [--programs build/release/bench] [--repetitions 21] [--noise 0.02]

Both fit the same file by the same model (infinite plane) from the same start. SciPy gets the model in vectorised NumPy with scaled Bessel
functions, once with difference quotients and once with this script's analytic derivatives. Prints Markdown.
"""

import argparse
import json
import os
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
from scipy.optimize import least_squares
from scipy.special import kve

SOURCE = Path(__file__).resolve().parent.parent
TRUTH, START = (2.2, 1.3, 22.0), (1.0, 1.0, 10.0)


def decay(c, x, r, order):
    """exp(-c x) K_order(c r), without overflow."""
    return np.exp(-c * (x + r)) * kve(order, c * r)


def slope(c, x, r):
    """d/dx of G = exp(-c x) K0(c r) on the axis."""
    return -c * (decay(c, x, r, 0) + x / r * decay(c, x, r, 1))


def U_x(p, x):
    """U_x(x, 0) of the infinite plane; p = f/mu, ln eta, ln xi."""
    f, eta, xi = p[0], np.exp(p[1]), np.exp(p[2])
    r, shear = np.abs(x), 0.5 / xi
    longitudinal = shear / (1.0 + eta)
    return f / (2.0 * np.pi) * (decay(shear, x, r, 0) + xi * (slope(shear, x, r) - slope(longitudinal, x, r)))


def slope_by_c(c, x, r):
    """d/dc of slope: G depends on c x and c r alone, so c d/dc (dG/dx) = dG/dx + x d2G/dx2 on the axis."""
    K0, K1, sign = decay(c, x, r, 0), decay(c, x, r, 1), x / r
    second = c * c * (K0 + 2.0 * sign * K1 + (K0 + K1 / (c * r)))
    return (slope(c, x, r) + x * second) / c


def derivatives(p, x):
    f, eta, xi = p[0], np.exp(p[1]), np.exp(p[2])
    r, shear = np.abs(x), 0.5 / xi
    longitudinal = shear / (1.0 + eta)
    by_eta = f / (2.0 * np.pi) * xi * slope_by_c(longitudinal, x, r) * longitudinal / (1.0 + eta)
    by_c = x * slope(shear, x, r) / shear
    by_xi = f / (2.0 * np.pi) * (by_c * -shear / xi + slope(shear, x, r) - slope(longitudinal, x, r)
                                 + xi * (slope_by_c(shear, x, r) * -shear + slope_by_c(longitudinal, x, r) * longitudinal) / xi)
    return np.stack([U_x(p, x) / f, by_eta * eta, by_xi * xi], axis=1)


def check_derivatives(x):
    p = np.array([1.7, 0.3, 2.5])
    numeric = np.stack([(U_x(p + d, x) - U_x(p - d, x)) / 2e-6 for d in 1e-6 * np.eye(3)], axis=1)
    worst = np.abs(numeric - derivatives(p, x)).max() / np.abs(numeric).max()
    if worst > 1e-7:
        sys.exit(f"the derivatives given to SciPy are wrong by {worst:.1e}")


def by_scipy(x, value, sigma, method, analytic):
    start = np.array([START[0], np.log(START[1]), np.log(START[2])])
    jac = {"jac": lambda p: derivatives(p, x) / sigma[:, None]} if analytic else {}
    found = least_squares(lambda p: (U_x(p, x) - value) / sigma, start, method=method, xtol=1e-12, ftol=1e-12, gtol=1e-12, **jac)
    return [found.x[0], np.exp(found.x[1]), np.exp(found.x[2])], 2.0 * found.cost, found.nfev


def timed(repetitions, call):
    times = []
    for _ in range(repetitions):
        start = time.perf_counter()
        answer = call()
        times.append(1e3 * (time.perf_counter() - start))
    return statistics.median(times), answer


def by_rodwake(program, file, method, repetitions):
    out = subprocess.run([program, file, method, str(repetitions)], capture_output=True, text=True, check=True)
    found = json.loads(out.stdout)
    return found["milliseconds"], (found["values"], found["chi2"], found["evaluations"])


def row(name, milliseconds, answer):
    values, chi2, evaluations = answer
    print(f"| {name} | {milliseconds:.3g} | {evaluations} | {values[0]:.6f} | {values[1]:.5f} | {values[2]:.5f} | {chi2:.6f} |")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--programs", default=SOURCE / "build" / "release" / "bench", type=Path)
    parser.add_argument("--repetitions", type=int, default=21)
    parser.add_argument("--noise", type=float, default=0.01)
    options = parser.parse_args()
    os.environ["OMP_NUM_THREADS"] = os.environ["OPENBLAS_NUM_THREADS"] = "1"
    x = np.linspace(-50.0, 50.0, 100)
    check_derivatives(x)
    exact = U_x((TRUTH[0], np.log(TRUTH[1]), np.log(TRUTH[2])), x)
    value = exact + options.noise * np.random.default_rng(1).standard_normal(x.size)
    sigma = np.full(x.size, options.noise)
    print("| fit | ms (median) | evaluations | f/mu | eta | xi | chi2 |\n|---|---|---|---|---|---|---|")
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "profile.csv"
        np.savetxt(file, np.stack([x, value, sigma], axis=1), delimiter=",", header="x,value,sigma", comments="", fmt="%.17g")
        for method in ("slsqp", "lbfgs", "mma", "bobyqa"):
            row(f"rodwake {method}, polished", *by_rodwake(options.programs / "bench_wake_fit", file, method, options.repetitions))
    for method, analytic in (("lm", False), ("lm", True), ("trf", False), ("trf", True)):
        name = f"scipy least_squares {method}, {'analytic' if analytic else 'difference'} Jacobian"
        row(name, *timed(options.repetitions, lambda m=method, a=analytic: by_scipy(x, value, sigma, m, a)))


if __name__ == "__main__":
    main()
