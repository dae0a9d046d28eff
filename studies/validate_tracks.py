#!/usr/bin/python3
"""What a camera makes of a bed's numbers: the tables of docs/validation_tracks.md.

    studies/validate_tracks.py [--program build/release/rodwake] [--only coverage] [--quick] [--keep DIR]

coverage: a bed of 1549 beads at 0.78, whose numbers are known, filmed by 50 cameras: 10 % of the spots lost, numbers that break at gaps,
an error of 0.05 a in each coordinate, half of the box in the picture, each camera turned by another angle. How far are its numbers from
the bed's, and do its errors say so? Some 10 CPU minutes. --quick: 3 cameras over a short bed, whose numbers mean nothing.
"""

import numpy as np

from lab import columns, mean, parser, run_parts, table, told

CAMERAS, LONGEST = 50, 64  # lags in frames
BED = """schema = 1
title = "A bed to film"
[granular]
phi_b = 0.78
box = "78 a"
equilibrate = "4 s"
duration = "{duration} s"
[granular.output]
frames = "0.005 s"
formats = ["h5md"]
last_period = false
[measure]
order = true
order_interval = "0.1 s"
microrheology = true
block = "0.5 s"
"""
SAME = ("measure.order_interval=0.1 s", "measure.block=0.5 s", "measure.s_low=2", "measure.s_high=10")


def deviations(films, bed):
    """For each number (of a camera, its error, of the bed, its error): rows of the table."""
    for name, of in (("psi6", ("order", "psi6")), ("local psi6", ("order", "local_psi6")), ("neighbours", ("order", "neighbours")),
                     ("stiffness, 1/a^2", ("microrheology", "stiffness"))):
        found = [film["measure"][of[0]][of[1]] for film in films]
        yield name, [one["value"] for one in found], [one["error"] for one in found], bed["measure"][of[0]][of[1]]["value"]
    for lag in (4, 16, LONGEST):
        yield (f"MSD over {lag * 5} ms, a^2", [film["msd"][0][lag_row(film, lag)] for film in films], [film["msd"][1][lag_row(film, lag)] for film in films],
               bed["msd"][0][lag_row(bed, lag)])


def lag_row(case, frames):
    return int(np.argmin(np.abs(case["lag"] - 0.005 * frames)))


def case_of(folder):
    lag, msd, sigma = columns(folder / "msd.csv", "lag", "msd", "sigma")
    r, g = columns(folder / "gr.csv", "r", "g")
    return {"measure": told(folder, "measure"), "lag": lag, "msd": (msd, sigma), "r": r, "g": g}


def film(lab, bed, number):
    folder = f"camera_{number}"
    lab.call("camera", bed, "-o", folder, "--pixel", "0.0625 a", "--noise", "0.05 a", "--lost", "0.1", "--view", "0.5", "--turned", 7 * number,
             "--seed", number + 1, "--memory", "2", "--force", "--quiet")
    text = (lab.folder / folder / "camera.toml").read_text(encoding="utf-8").replace('file = "tracks.csv"', f'file = "{lab.folder / folder / "tracks.csv"}"')
    found = case_of(lab.make(f"film_{number}", text, *SAME, "tracks.localisation=auto", verbs=("measure",)))
    (lab.folder / folder / "tracks.csv").unlink()
    return found


def coverage(lab):
    duration = 2 if lab.quick else 8
    bed = lab.make("bed", BED.format(duration=duration), *SAME[2:], verbs=("dem", "measure"))
    truth = case_of(bed)
    films = [film(lab, bed, number) for number in range(3 if lab.quick else CAMERAS)]
    rows = []
    for name, values, errors, true in deviations(films, truth):
        values, errors = np.array(values), np.array(errors, dtype=float)
        pulls = (values - true) / errors
        rows.append([name, f"{true:.5g}", f"{values.mean():.5g} +- {values.std(ddof=1):.2g}", f"{np.mean(errors):.2g}",
                     f"{np.mean(np.abs(pulls) < 1):.0%}", f"{np.mean(np.abs(pulls) < 2):.0%}"])
    table(f"{len(films)} cameras over one bed: 10 % of the spots lost, 0.05 a of error, a quarter of the area seen",
          ["number", "of the bed", "of the cameras, +- their scatter", "error told", "truth within 1 error", "within 2"], rows)
    localisation = mean([one["measure"]["microrheology"]["localisation"]["value"] for one in films])
    beyond = (truth["r"] > 5.0) & (truth["r"] < 0.45 * 39)
    worst = [np.max(np.abs(np.interp(truth["r"], one["r"], one["g"]) - truth["g"])[beyond] / truth["g"].max()) for one in films]
    rms = [np.sqrt(np.mean((np.interp(truth["r"], one["r"], one["g"]) - truth["g"])[beyond] ** 2)) for one in films]
    table("The same", ["", "found", "true"],
          [["localisation, a", f"{localisation[0]:.4f} +- {localisation[1]:.4f}", "0.0500"],
           ["g(r) beyond the first peak, rms difference", f"{np.mean(rms):.3f}", "0"],
           ["largest, over the highest peak", f"{np.max(worst):.3f}", "0"]])


PARTS = {"coverage": coverage}

if __name__ == "__main__":
    run_parts(parser(__doc__, "quick", "keep", parts=PARTS).parse_args(), PARTS)
