#!/usr/bin/python3
"""Time of one strain of one source at one target, and of all pairs of rods: rodwake, Boost, GSL and SciPy in one run.

Runs build/release/bench/bench_kernel and the same closed form in SciPy (whole arrays of 4096 points); prints Markdown.
"""

import argparse
import json
import os
import subprocess
import time

ETA, XI, POINTS = 1.3, 1.0, 4096


def scipy_nanoseconds(seconds):
    """Best of the repetitions within that time, or None without SciPy."""
    try:
        import numpy
        from scipy.special import k0, k1
    except ImportError:
        return None
    x, y = numpy.random.default_rng(2).uniform(-5.0, 5.0, (2, POINTS))
    nu, c = 1.0 / (1.0 + ETA), 0.5 / XI

    def strain():
        r = numpy.hypot(x, y)
        cosine, sine = x / r, y / r
        h, both = sine * sine - cosine * cosine, []
        for a in (c, nu * c):
            decay = numpy.exp(-a * x)
            both.append((a, decay * k0(a * r), decay * k1(a * r)))
        yy, xy = [], []
        for a, e0, e1 in both:
            yy.append(a * a * sine * sine * e0 + h * a * e1 / r)
            xy.append(a * a * sine * e1 + cosine * sine * (a * a * e0 + 2.0 * a * e1 / r))
        trace = -nu * nu * c * (both[1][1] + cosine * both[1][2])
        return XI * (yy[0] - yy[1]), trace, -c * sine * both[0][2] + 2.0 * XI * (xy[0] - xy[1])

    best, end = float("inf"), time.perf_counter() + seconds
    while time.perf_counter() < end:
        begin = time.perf_counter()
        strain()
        best = min(best, time.perf_counter() - begin)
    return 1e9 * best / POINTS


def benchmark(program, seconds):
    command = [program, f"--benchmark_min_time={seconds}", "--benchmark_format=json"]
    return json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)["benchmarks"]


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--program", default="build/release/bench/bench_kernel")
    parser.add_argument("--quick", action="store_true", help="a trial, not a measurement")
    arguments = parser.parse_args()
    seconds = 0.05 if arguments.quick else 0.5
    before = os.getloadavg()[0]
    runs = benchmark(arguments.program, seconds)
    print("| one strain | CPU, ns |\n|---|---|")
    for run in runs:
        if "s_per_point" in run:
            print(f"| {run['name']} | {1e9 * run['s_per_point']:.1f} |")
    scipy = scipy_nanoseconds(seconds)
    if scipy is not None:
        print(f"| SciPy, arrays | {scipy:.1f} |")
    print("\n| all pairs | rods | CPU, ms | share worked out |\n|---|---|---|---|")
    for run in runs:
        if "share" in run:
            _, kind, rods = run["name"].split("/")
            print(f"| {kind} | {rods} | {run['cpu_time']:.1f} | {run['share']:.2f} |")
    print(f"\nLoad before and after: {before:.1f}, {os.getloadavg()[0]:.1f}")


if __name__ == "__main__":
    main()
