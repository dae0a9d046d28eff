#!/usr/bin/python3
"""What a camera makes of a bed's numbers: the tables of docs/validation_tracks.md.

    studies/validate_tracks.py [--program build/release/rodwake] [--only coverage] [--quick] [--keep DIR]

coverage: a bed of 1549 beads at 0.78, whose numbers are known, filmed by 50 cameras: 10 % of the spots lost, numbers that break at gaps,
an error of 0.05 a in each coordinate, half of the box's area in the picture, each camera turned by another angle. How far are its numbers
from the bed's, and from those of the same picture without faults, and do its errors say so? Some 10 CPU minutes. --quick: 3 cameras over
a short bed, whose numbers mean nothing.
"""

import numpy as np

from lab import columns, parser, run_parts, table, told

CAMERAS, INTERVAL, LAGS = 50, 0.005, (4, 16, 64)  # s; frames
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


def numbers(case):
    """{name: (value, error)}."""
    measured = case["measure"]
    found = {"psi6": measured["order"]["psi6"], "stiffness, 1/a^2": measured["microrheology"]["stiffness"]}
    values = {name: (one["value"], one["error"]) for name, one in found.items()}
    for lag in LAGS:
        row = int(np.argmin(np.abs(case["lag"] - INTERVAL * lag)))
        values[f"MSD over {1e3 * INTERVAL * lag:.0f} ms, a^2"] = tuple(column[row] for column in case["msd"])
    return values


def case_of(folder):
    lag, msd, sigma = columns(folder / "msd.csv", "lag", "msd", "sigma")
    r, g = columns(folder / "gr.csv", "r", "g")
    return {"measure": told(folder, "measure"), "lag": lag, "msd": (msd, sigma), "r": r, "g": g}


def film(lab, bed, number, name, *faults):
    """Of one camera; its tracks are removed."""
    folder = f"{name}_{number}"
    if not (lab.folder / f"film_{folder}" / "measure.json").is_file():
        lab.call("camera", bed, "-o", folder, "--pixel", "0.0625 a", "--view", "0.7", "--turned", 7 * number, *faults, "--force", "--quiet")
        camera = lab.folder / folder
        text = (camera / "camera.toml").read_text(encoding="utf-8").replace('file = "tracks.csv"', f'file = "{camera / "tracks.csv"}"')
        lab.make(f"film_{folder}", text, *SAME, verbs=("measure",))
        (camera / "tracks.csv").unlink()
    return case_of(lab.folder / f"film_{folder}")


def share(values, errors, truth, most):
    return f"{np.mean(np.abs((values - truth) / errors) < most):.0%}"


def rms_of_g(case, other):
    beyond = (other["r"] > 5.0) & (other["r"] < 25.0)
    return np.sqrt(np.mean((np.interp(other["r"], case["r"], case["g"]) - other["g"])[beyond] ** 2))


def coverage(lab):
    bed = lab.make("bed", BED.format(duration=2 if lab.quick else 8), *SAME[2:], verbs=("dem", "measure"))
    truth, count = case_of(bed), 3 if lab.quick else CAMERAS
    clear = [film(lab, bed, number, "clear") for number in range(count)]
    films = [film(lab, bed, number, "camera", "--noise", "0.05 a", "--lost", "0.1", "--memory", "2", "--seed", number + 1) for number in range(count)]
    rows = []
    for name, (true, _) in numbers(truth).items():
        values, errors = np.array([numbers(one)[name] for one in films], dtype=float).T
        pictures = np.array([numbers(one)[name][0] for one in clear])
        rows.append([name, f"{true:.4g}", f"{pictures.mean():.4g}", f"{values.mean():.4g} +- {values.std(ddof=1):.1g}", f"{np.mean(errors):.2g}",
                     *(f"{share(values, errors, of, 1)}, {share(values, errors, of, 2)}" for of in (true, pictures))])
    table(f"{count} cameras over one bed: 10 % of the spots lost, an error of 0.05 a, half of the area seen",
          ["number", "of the bed", "of the pictures without faults", "of the cameras, +- their scatter", "error told", "bed within 1, 2 errors",
           "picture within 1, 2"], rows)
    far = np.mean([rms_of_g(one, truth) for one in films])
    print(f"g(r) from 5 to 25 a: rms difference from the bed's {far:.4f} (pictures without faults {np.mean([rms_of_g(one, truth) for one in clear]):.4f})")


PARTS = {"coverage": coverage}

if __name__ == "__main__":
    run_parts(parser(__doc__, "quick", "keep", parts=PARTS).parse_args(), PARTS)
