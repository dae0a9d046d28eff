#!/usr/bin/python3
"""What calling rodwake from Python costs beside the same calls from C++, in turns in one process; memory over many calls.

    bench/python_calls.py [--build build/release] [--quick]

Prints the rows of studies/reports/house.md ("Python"). Times are the least of the repetitions, on one thread.
"""

import argparse
import ctypes
import gc
import resource
import sys
import tempfile
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np

NUMBERS = ctypes.POINTER(ctypes.c_double)
POSES = np.array([[0, 2.5, 0], [0, -2.5, 0]])


def seconds(work, runs=1):
    start = time.perf_counter()
    for _ in range(runs):
        work()
    return (time.perf_counter() - start) / runs


def least(repetitions, **calls):
    """Of each call, taken in turns."""
    taken = [{name: call() for name, call in calls.items()} for _ in range(repetitions)]
    return {name: min(one[name] for one in taken) for name in calls}


def strain(rodwake, plain, options):
    count = 100_000 if options.quick else 1_000_000
    x, y = np.random.default_rng(1).uniform(-20, 20, (2, count))
    medium, out = rodwake.Medium(), np.zeros(3 * count)
    at = [array.ctypes.data_as(NUMBERS) for array in (x, y)]
    size, eta, xi = ctypes.c_size_t(count), ctypes.c_double(1.0), ctypes.c_double(1.0)
    took = least(options.repetitions, into=lambda: plain.strain_into(*at, size, eta, xi, out.ctypes.data_as(NUMBERS)),
                 anew=lambda: plain.strain_anew(*at, size, eta, xi), python=lambda: seconds(lambda: rodwake.strain(x, y, medium)))
    same = np.array_equal(rodwake.strain(x, y, medium)[:, 0, 1], out[count:2 * count])
    print(f"| strain at {count} points, ms | {1e3 * took['anew']:.2f} ({1e3 * took['into']:.2f} into memory that is there) | {1e3 * took['python']:.2f} "
          f"| {took['python'] / took['anew']:.2f} times ({took['python'] / took['into']:.2f}) | {'same bits' if same else 'OTHER BITS'} |")


def pair(rodwake, plain, options):
    medium, runs = rodwake.Medium(), 5  # short turns, of which some find the machine quiet
    took = least(40 * options.repetitions, plain=lambda: plain.pair(ctypes.c_long(runs)),
                 python=lambda: seconds(lambda: rodwake.simulate(POSES, medium, kappa=0.5, t_end=60.0, contact_distance=0.1, output_times=[]), runs))
    print(f"| a pair to contact, us | {1e6 * took['plain']:.1f} | {1e6 * took['python']:.1f} | {1e6 * (took['python'] - took['plain']):+.1f} us | |")


def scans(rodwake, options):
    """Points of a scan by threads of the library, by a pool of Python's, and by Dask."""
    count = 32 if options.quick else 100
    axes = {"coupling.kappa": np.geomspace(0.1, 100, count), "rods.1.position.0": np.linspace(-6, 6, count)}
    scene = rodwake.Scene.load(Path(__file__).resolve().parents[1] / "scenes/pair.toml")

    def run(executor):
        with tempfile.TemporaryDirectory() as folder:
            took = seconds(lambda: rodwake.scan(scene, axes, executor=executor, folder=Path(folder) / "scan", threads=2))
            return took, (Path(folder) / "scan/scan.csv").read_bytes()

    ours, table = run(None)
    rows = [("threads of the library", ours, table)]
    with ThreadPoolExecutor(2) as pool:
        rows.append(("ThreadPoolExecutor(2)", *run(pool)))
    try:
        from distributed import Client, LocalCluster
    except ImportError:
        print("Dask is not installed", file=sys.stderr)
    else:
        with tempfile.TemporaryDirectory() as folder, LocalCluster(2, threads_per_worker=1, dashboard_address=None, local_directory=folder) as cluster:
            with Client(cluster) as client:
                rows.append(("Dask LocalCluster, 2 workers", *run(client)))
    print(f"\n| {count**2} points by | s | scan.csv |\n|---|---|---|")
    for name, took, other in rows:
        print(f"| {name} | {took:.2f} | {'same bytes' if other == table else 'OTHER BYTES'} |")


def leaks(rodwake, options):
    """Resident memory after many calls against that after the first tenth: what is lost each time shows."""
    medium, calls = rodwake.Medium(), 1000 if options.quick else 10_000
    x, y = np.random.default_rng(2).uniform(-9, 9, (2, 1000))
    scene = rodwake.Scene.parse('schema = 1\n[granular]\nbeads = 30\nbox = "16 a"\nduration = "1 s"\n')

    def bad():
        try:
            rodwake.Medium(eta=-5)
        except rodwake.InputError:
            pass

    run = rodwake.simulate(POSES, medium, kappa=0.5, t_end=4.0, output_times=np.arange(5.0))
    track = rodwake.Track(run.t, run.poses, 1.0, 1.0)
    kinds = {"strain of 1000 points": (1, lambda: rodwake.strain(x, y, medium)), "simulate": (1, lambda: rodwake.simulate(
        POSES, medium, kappa=0.5, t_end=2.0, output_times=[]).poses), "integrate with a function and an event": (10, lambda: rodwake.integrate(
            lambda t, y: -y, [1.0], [1.0], events=[rodwake.Event(lambda t, y: y[0] - 0.5)])), "Medium refused": (1, bad),
             "Scene.load and set": (10, lambda: scene.copy().set("granular.seed", 3)), "Bed, 10 steps": (10, lambda: rodwake.Bed(scene).advance(steps=10)),
             "fit_rods": (100, lambda: rodwake.fit_rods([track], ["kappa"], fixed={"eta": 1.0, "alpha": 1.0}, start={"kappa": 0.4}))}
    print(f"\n| {calls} calls of (dearer ones fewer) | calls | memory grows by, kB |\n|---|---|---|")
    for name, (share, call) in kinds.items():
        memory = []
        for part in range(10):
            for _ in range(calls // share // 10):
                call()
            gc.collect()
            memory.append(int(Path("/proc/self/statm").read_text().split()[1]) * resource.getpagesize() // 1024)
        print(f"| {name} | {calls // share} | {memory[-1] - memory[0]} |")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", default="build/release", type=Path)
    parser.add_argument("--quick", action="store_true", help="a trial, not a measurement")
    options = parser.parse_args()
    options.repetitions = 3 if options.quick else 25
    sys.path.insert(0, str(options.build.resolve() / "python"))
    import rodwake
    plain = ctypes.CDLL(options.build.resolve() / "bench/libbench_python_calls.so")
    for function in plain.strain_into, plain.strain_anew, plain.pair:
        function.restype = ctypes.c_double
    print("| call | C++ | Python | Python beside C++ | results |\n|---|---|---|---|---|")
    strain(rodwake, plain, options)
    pair(rodwake, plain, options)
    scans(rodwake, options)
    leaks(rodwake, options)


if __name__ == "__main__":
    main()
