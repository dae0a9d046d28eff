#!/usr/bin/python3
"""What a camera makes of a bed's numbers: the tables of studies/reports/measure.md.

    studies/validate_tracks.py [--program build/release/rodwake] [--only coverage,heading,pictures] [--quick] [--keep DIR]

coverage: a bed of 1549 beads at 0.78, whose numbers are known, filmed by 50 cameras: 10 % of the spots lost, numbers that break at gaps,
an error of 0.05 a in each coordinate, half of the box's area in the picture, each camera turned by another angle. How far are its numbers
from the bed's, and from those of the same picture without faults, and do its errors say so? Some 10 CPU minutes.
heading: how fast a rod forgets its heading, from 20 films in which it is lost in a tenth of the pictures. Some 2 CPU minutes.
pictures: beads and a rod found again in pictures (examples/film/find_spots.py) beside the tracks of the same film without an error.
--quick: 3 cameras over a short bed, whose numbers mean nothing.
"""

import csv
import math
import subprocess

import numpy as np

from lab import SOURCE, columns, parser, run_parts, table, read_json

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
    return {"measure": read_json(folder, "measure"), "lag": lag, "msd": (msd, sigma), "r": r, "g": g}


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
          ["number", "of the bed", "of the pictures without faults", "of the cameras, +- their scatter", "stated error", "bed within 1, 2 errors",
           "picture within 1, 2"], rows)
    far = np.mean([rms_of_g(one, truth) for one in films])
    print(f"g(r) from 5 to 25 a: rms difference from the bed's {far:.4f} (pictures without faults {np.mean([rms_of_g(one, truth) for one in clear]):.4f})")


WITH_ROD = """schema = 1
title = "A rod to film"
[granular]
phi_b = 0.70
box = "78 a"
equilibrate = "4 s"
duration = "{duration} s"
[[granular.rods]]
kind = "motile"
position = ["39 a", "39 a"]
heading = 0.3
[granular.output]
frames = "0.02 s"
every_bead = {every}
formats = ["h5md"]
last_period = false
"""


def heading(lab):
    keys = ("measure.heading_diffusion=true", "measure.block=4 s")
    bed = lab.make("rod", WITH_ROD.format(duration=10 if lab.quick else 60, every=20), *keys, verbs=("dem", "measure"))
    truth, found = read_json(bed, "measure")["heading_diffusion"]["D_r"], []
    for number in range(3 if lab.quick else 20):
        lab.call("camera", bed, "-o", "rod_film", "--lost", "0.1", "--memory", "2", "--noise", "0.05 a", "--seed", number + 1, "--force", "--quiet")
        text = (lab.folder / "rod_film/camera.toml").read_text(encoding="utf-8").split("[measure]")[0]
        film = lab.make(f"rod_{number}", text.replace('"tracks.csv"', f'"{lab.folder / "rod_film/tracks.csv"}"'), *keys, verbs=("measure",))
        one = read_json(film, "measure")["heading_diffusion"]["D_r"]
        found.append((one["value"], one["error"]))
    values, errors = np.array(found, dtype=float).T  # an error that is not known is no number
    table(f"Heading diffusion from {len(values)} films, the rod lost in a tenth of the pictures",
          ["of the bed, rad^2/s", "of the films, +- their scatter", "stated error", "bed within 1, 2 errors"],
          [[f"{truth['value']:.4g} +- {truth['error']:.2g}", f"{values.mean():.4g} +- {values.std(ddof=1):.1g}", f"{errors.mean():.2g}",
            f"{share(values, errors, truth['value'], 1)}, {share(values, errors, truth['value'], 2)}"]])


def spots(path, kind):
    """[picture]: x, y and heading of each spot."""
    with open(path, encoding="utf-8") as file:
        rows = [row for row in csv.DictReader(file) if row["kind"] == kind]
    found = {}
    for row in rows:
        found.setdefault(int(row["frame"]), []).append([float(row["x"]), float(row["y"]), float(row["theta"] or "nan")])
    return {frame: np.array(places) for frame, places in found.items()}


def beads_found(folder, count, pixel):
    """Errors of coordinates in a, and how many beads were missed and made up; those cut by the edge aside."""
    true, found = (spots(folder / name, "bead") for name in ("tracks.csv", "found.csv"))
    off, missed, made_up = [], 0, 0
    for frame in range(count):
        truth, seen = true[frame][:, :2], found[frame][:, :2]
        apart = np.linalg.norm(seen[:, None] - truth[None], axis=2) * pixel
        good = apart.min(axis=1) < 0.5
        off.append((seen - truth[apart.argmin(axis=1)])[good] * pixel)
        inner = np.all((truth > 2 / pixel) & (truth < truth.max(axis=0) - 2 / pixel), axis=1)
        missed += np.sum(apart.min(axis=0)[inner] > 0.5)
        made_up += np.sum(~good)
    return np.abs(np.concatenate(off)), missed, made_up


def rods_found(folder, count):
    true, found = (spots(folder / name, "rod") for name in ("tracks.csv", "found.csv"))
    both = [frame for frame in range(count) if frame in true and len(found.get(frame, [])) == 1]
    return both, [math.remainder(found[frame][0, 2] - true[frame][0, 2], math.tau) for frame in both], len([one for one in true if one < count])


def pictures(lab):
    count = 4 if lab.quick else 40
    bed, rows = lab.make("pictures", WITH_ROD.format(duration=2, every=1), verbs=("dem",)), []
    for pixel, photons in ((0.05, 1000), (0.1, 1000), (0.1, 100), (0.2, 100)):
        lab.call("camera", bed, "-o", "seen", "--view", "0.7", "--turned", "17", "--pixel", f"{pixel} a", "--photons", photons, "--images", count, "--force", "--quiet")
        folder = lab.folder / "seen"
        subprocess.run(["/usr/bin/python3", SOURCE / "examples/film/find_spots.py", folder], check=True, capture_output=True)
        off, missed, made_up = beads_found(folder, count, pixel)
        both, turned, seen = rods_found(folder, count)
        rows.append([f"{pixel} a", photons, f"{np.median(off) / 0.6745:.4f} a", f"{np.percentile(off, 99):.3f} a", missed, made_up, f"{len(both)} of {seen}",
                     f"{np.sqrt(np.mean(np.square(turned))):.3f} rad" if turned else "none"])
    table(f"Spots found in {count} pictures", ["pixel", "photons of a white pixel", "error of a coordinate", "99 % within", "beads missed", "made up",
                                               "pictures with the rod found", "error of its heading, rms"], rows)


PARTS = {"coverage": coverage, "heading": heading, "pictures": pictures}

if __name__ == "__main__":
    run_parts(parser(__doc__, "report", "quick", "keep", parts=PARTS).parse_args(), PARTS)
