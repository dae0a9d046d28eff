"""Drag of the plates: a uniform push without a rod, momentum of rods over drift, damping of slow modes; and where rods' momentum goes."""

import h5py
import numpy as np

from lab import estimate, ratio, table, text, read_json

from . import monopole, push, sound, static
from .bed import A, bed, combined, rod

ONLY_DRAG = (2.0, 8.0)      # mm/s; the other speeds are those of the maps
NEAR_SECONDS = 20.0
RINGS = (0, 6, 10, 16, 24, 60)  # a


def cost():
    rods = len(ONLY_DRAG) * (monopole.HEARD_SECONDS + 2) * sound.SOUND_COST
    return push.cost() + (rods + NEAR_SECONDS) * 1549


def uniform_row(lab, drift):
    speed, acceleration = push.drift(lab, drift)
    return [f"uniform push, {acceleration:g} a/s^2", text(speed, digits=3), text(ratio((acceleration, 0.0), speed)), "", ""]


def rod_row(lab, speed):
    heard = [monopole.heard(lab, speed)]
    folders = heard if speed in ONLY_DRAG else monopole.folders(lab, speed)
    label = "free rod" if speed is None else f"rod at {speed:g} mm/s"
    return [label, text(combined(folders, "mechanics", "drift"), digits=3), text(combined(folders, "mechanics", "drag_rate")),
            text(combined(heard, "phonons", "drag_rate")), text(combined(heard, "phonons", "c_T"), digits=1)]


def part(lab):
    at_rest = read_json(sound.run(lab), "measure")["phonons"]
    rows = [["bed at rest", "0", "", text(estimate(at_rest["drag_rate"])), text(estimate(at_rest["c_T"]), digits=1)]]
    rows += [uniform_row(lab, drift) for drift in push.DRIFTS]
    rows += [rod_row(lab, speed) for speed in (*monopole.SPEEDS, *ONLY_DRAG)]
    table("Drag of the plates on the bed", ["case", "drift of the bed, a/s", "drag rate from momentum, 1/s", "from the damping of slow modes, 1/s",
                                             "c_T in that bed, a/s"], rows)
    table("Inertia of the bed", ["drag rate from uniform pushes, 1/s", "from the damping of slow modes, 1/s", "inertia over mass m*",
                                                "a sphere that rolls without slip"],
          [[text(push.drag(lab)), text(estimate(at_rest["drag_rate"])), text(push.inertia(lab), digits=3), "1.4"]])
    near(lab)


def near(lab):
    """Beads around a rod at 4 mm/s, by their distance: how fast they go, how hot they are, what part of all their momentum they have."""
    scene = bed(lab.seconds(NEAR_SECONDS), rods=rod(4.0), frames=0.1, formats='["h5md"]')
    folder = lab.make("near_4", scene)
    frames = static.Frames(folder)
    with h5py.File(folder / "trajectory.h5md") as file:
        group = file["particles/trajectory_rods"]
        rods = group["position/value"][:, 0, :2] / A
    first = int(np.argmax(frames.time >= 2.0))
    sums = np.zeros((len(RINGS) - 1, 4))
    for k in range(first, len(frames.time) - 1):
        r = frames.place[k] + frames.centre[k] - rods[k]
        r -= frames.box * np.round(r / frames.box)
        along = np.maximum(np.abs(r[:, 0]) - 5.0, 0.0)  # distance to the rod's axis, not to its middle
        ring = np.digitize(np.hypot(along, r[:, 1]), RINGS) - 1
        step = (frames.place[k + 1, :, 0] + frames.centre[k + 1, 0]) - (frames.place[k, :, 0] + frames.centre[k, 0])
        v = frames.velocity[k]
        for b in range(len(sums)):
            inside = ring == b
            sums[b] += [inside.sum(), step[inside].sum(), ((v[inside] - v[inside].mean(axis=0)) ** 2).sum() / 2 if inside.any() else 0.0, 0]
    count = len(frames.time) - 1 - first
    seconds = frames.time[-1] - frames.time[first]
    rows = [[f"{low} to {high}", f"{s[0] / count:.0f}", f"{s[1] * count / s[0] / seconds:+.2f}", f"{s[1] / sums[:, 1].sum():.3f}",
             f"{s[2] / s[0] * A * A * 1e5:.2f}"] for low, high, s in zip(RINGS, RINGS[1:], sums)]
    table("Beads by their distance from a rod at 4 mm/s", ["distance, a", "beads", "mean velocity along it, a/s", "share of all momentum",
                                                           "T_xy, 1e-5 m^2/s^2"], rows)
