#!/usr/bin/python3
"""Mean paths of the rods over the runs of a granular ensemble, for trajectory fits ([[fit.trajectories]]).

    studies/mean_track.py RUN_DIRECTORY [--step 0.5] > pair.csv

Reads runs/*/tracks.csv (or those of one variant: RUN_DIRECTORY/variants/NAME) and prints t,x0,y0,theta0,x1,... from t = 0 to the end of the
shortest run: lengths in bead radii a, times in s. The comment line gives the mean standard errors and the mean speed.
"""

import argparse
import csv
import sys
from pathlib import Path

import numpy as np

BEAD_RADIUS = 4e-4  # m


def track(file, rods):
    names = ["t"] + [f"{name}{rod}" for rod in range(rods) for name in ("x", "y", "theta")]
    rows = csv.DictReader(line for line in file.read_text().splitlines() if not line.startswith("#"))
    return np.array([[float(row[name]) for name in names] for row in rows if float(row["t"]) >= -1e-9])


def rods_of(file):
    header = next(line for line in file.read_text().splitlines() if not line.startswith("#"))
    return header.split(",").count("theta0") + sum(f"theta{i}" in header.split(",") for i in range(1, 1000))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--step", type=float, default=0.5, help="s between the rows that are printed")
    options = parser.parse_args()
    files = sorted(options.folder.glob("runs/*/tracks.csv"))
    if len(files) < 2:
        sys.exit(f"{options.folder}: {len(files)} runs with tracks.csv; a mean with an error needs two")
    rods = rods_of(files[0])
    tracks = [track(file, rods) for file in files]
    shortest = min(len(one) for one in tracks)
    every = max(round(options.step / (tracks[0][1, 0] - tracks[0][0, 0])), 1)
    scale = np.array([1.0] + [BEAD_RADIUS, BEAD_RADIUS, 1.0] * rods)
    all_runs = np.stack([one[:shortest:every] for one in tracks]) / scale
    mean, error = all_runs.mean(0), all_runs.std(0, ddof=1)[1:] / np.sqrt(len(files))
    by_kind = error[:, 1:].reshape(len(error), rods, 3)
    speed = np.mean([np.hypot(*(mean[-1, c:c + 2] - mean[0, c:c + 2])) for c in range(1, 3 * rods, 3)]) / mean[-1, 0]
    print(f"# mean of {len(files)} runs; lengths in bead radii, s; standard errors {by_kind[..., :2].mean():.3g} a and {by_kind[..., 2].mean():.3g} rad; "
          f"mean speed {speed:.4g} a/s")
    print("t," + ",".join(f"{name}{rod}" for rod in range(rods) for name in ("x", "y", "theta")))
    for row in mean:
        print(",".join(f"{value:.17g}" for value in row))


if __name__ == "__main__":
    main()
