"""Rotational noise: the paper's theory leaves it out, its beds have it."""

from math import isfinite, log, nan, sqrt

import numpy as np

from . import judge, results
from .bed_pairs import A, CRYSTAL, half_box
from .entry import Row, Run, Subject

HEADING = Run("rod_noise", "rod_noise.toml", (), ("granular.runs=2", "granular.duration=24 s"))
CAPTURE = Run("capture_noise", "capture_noise.toml", (), ("noise.capture_error=0.15",))
KAPPA, LOST = 10.0, 0.5
HALF_BOX = 39.0  # a


def diffusion(folder):
    return results.read_json(folder, "measure")["heading_diffusion"]


def curve(folder, kappa):
    """[(D_r, probability, low, high)] of one coupling, by D_r."""
    keys = ("noise.rotational_diffusion", "capture_probability", "capture_probability_low", "capture_probability_high")
    return sorted(tuple(float(row[key]) for key in keys) for row in results.table(folder / "scan.csv")
                  if row["status"] == "ok" and float(row["coupling.kappa"]) == kappa)


def half_lost(points):
    """D_r at which half the captures are lost, by a straight line in log D_r; None if that is not in the scan."""
    for (one, p, *_), (other, q, *_) in zip(points, points[1:]):
        if p >= LOST > q:
            return one * (other / one) ** ((p - LOST) / (p - q))
    return None


def at(points, D):
    """(probability, error) at D_r, by straight lines in log D_r between the points; the error is a half interval over 1.96."""
    places = [log(place) for place, *_ in points]
    p, low, high = (float(np.interp(log(D), places, [point[k] for point in points])) for k in (1, 2, 3))
    return p, (high - low) / 2 / 1.96


def captured_in_noise(bed, scan):
    """With the bed's D_r; its error counts by the captures at one error more and less."""
    D, error = results.estimate(diffusion(bed)["rotational_diffusion"])
    points = curve(scan, KAPPA)
    if not (isfinite(error) and D > 2 * error and points):
        return judge.unknown("D_r of the bed is not known well enough", judge.with_error(D, error))
    (p, noise), spread = at(points, D), abs(at(points, D + error)[0] - at(points, max(D - error, 1e-12))[0]) / 2
    half = half_lost(points)
    found = judge.at_least(p, sqrt(noise**2 + spread**2), LOST)
    half_text = f"; half are lost at D_r = {half:.2g}" if half else ""
    return judge.Judged(found.verdict, f"{found.ours} of the runs are captured at D_r = {judge.with_error(D, error)} v₀μ/f{half_text}", found.difference)


def free_spread(D, speed, time):
    """Standard deviation of the separation across the heading of two rods that walk side by side for a time, each turned by its noise
    alone: y'' = v theta', so var y = 2 D v^2 t^3/3 of each rod while it turns little."""
    return sqrt(4 / 3 * D * speed**2 * time**3)


def averaged(bed, pair):
    """The error that the scatter of the runs leaves in a mean of 50, against half of what the pair does; beside it the scatter that free
    diffusion at the measured D_r would make."""
    change, _ = half_box(pair)
    runs = [float(row["half_box_separation_change"]) / A for row in results.table(pair / "runs.csv") if row.get("half_box_separation_change")]
    if len(runs) < 3:
        return judge.unknown("fewer than three runs came half a box")
    spread = float(np.std(runs, ddof=1))
    diffusion_record = diffusion(bed)
    D, speed = (results.estimate(diffusion_record[key])[0] for key in ("D_r", "speed"))
    found = judge.at_most(spread / sqrt(50), spread / sqrt(50) / sqrt(2 * (len(runs) - 1)), abs(change) / 2, "a")
    free = free_spread(D, speed, HALF_BOX / speed) if D > 0 and speed > 0 else nan
    return judge.Judged(found.verdict, f"the mean of 50 is uncertain by {found.ours}: runs spread by {spread:.1f} a, headings that diffuse freely would "
                        f"spread them by {free:.1f} a", found.difference)


NOISE = Subject("Rotational noise", (
    Row("noise_capture", "theory section, which leaves noise out", "15 a apart at κf/(μv₀) = 10 (η = 1.3, α = 0.1): captured, also with the noise of a rod "
        "in the bed, φ_b = 0.78", captured_in_noise, (HEADING, CAPTURE), ("diffusion",),
        "Rods that move side by side turn slowly at first: a small angle separates them before their wakes take hold."),
    Row("noise_average", "text at Fig. 1", "50 runs average over the rotational noise, φ_b = 0.78 (to half of Δy)", averaged, (HEADING, CRYSTAL),
        (), "Headings diffuse freely for a few seconds only: then the lattice holds them (docs/estimators.md)."),
))
