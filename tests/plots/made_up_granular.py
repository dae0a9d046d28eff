"""Small granular runs for the tests and for looking at figures: the files of `rodwake dem`, shapes but no physics."""

import json

import h5py
import numpy as np

A = 4e-4         # bead radius, m
GAP, FREQUENCY, GAMMA = 1.2e-3, 200.0, 7.0
SPACING = 2.12   # of the lattice, in a

SCENE = """
schema = 1
units = "si"
title = "Rods in a bed"
[granular]
phi_b = 0.8
box = 0.0312
start = "lattice"
time_step = 2e-5
duration = 10.0
runs = 1
plates = { gap = 1.2e-3, frequency = 200.0, gamma = 7.0 }
[granular.contacts]
particle_particle = { friction = 0.05, restitution = 0.3 }
rod_wall = { friction = 0.03, restitution = 0.1 }
bead_wall = { friction = 0.2, restitution = 0.3 }
[[granular.rods]]
kind = "motile"
position = [0.008, 0.0186]
heading = 0.0
"""


def lattice(columns, rows):
    """A triangular lattice that closes in its box: points [N][2] and box [2], m."""
    d = SPACING * A
    box = np.array([columns * d, rows * d * np.sqrt(3) / 2])
    i, j = np.meshgrid(np.arange(columns), np.arange(rows))
    return np.stack([(i + j % 2 / 2) * d, j * d * np.sqrt(3) / 2], axis=-1).reshape(-1, 2), box


def rod_spheres(polar=True):
    """Offsets along the axis and radii, m: 12 spheres from 1.1 to 0.8 mm, or 13 that taper to both ends."""
    part = np.linspace(0, 1, 12 if polar else 13)
    radius = (0.55 - 0.15 * (part if polar else abs(2 * part - 1))) * 1e-3
    return (part * 3.55 - 1.8) * 1e-3, radius


class Bed:
    """Beads on a shaken lattice and rods that drive through it along x."""

    def __init__(self, columns=36, rows=42, rods=2, polar=True, shake=0.06, seed=1, beads=True):
        self.random = np.random.default_rng(seed)
        self.points, self.box = lattice(columns, rows)
        self.points = self.points if beads else self.points[:0]
        self.offset, self.radius = rod_spheres(polar)
        self.starts = [(0.3 * self.box[0], self.box[1] * (rod + 1) / (rods + 1)) for rod in range(rods)]
        self.shake = shake

    def rods_at(self, t):
        """Centres [rod][2], unwrapped, and headings."""
        pull = 0.05e-3 * t * np.sign(len(self.starts) - 1 - 2 * np.arange(len(self.starts)))
        return [(x + 1.6e-3 * t, y + dy) for (x, y), dy in zip(self.starts, pull)], [0.3 * np.sin(t / 3)] * len(self.starts)

    def beads_at(self):
        height = GAP / 2 + 0.45 * (GAP / 2 - A) * self.random.standard_normal(len(self.points)).clip(-2, 2)
        shaken = self.points + self.shake * A * self.random.standard_normal(self.points.shape)
        return np.column_stack([shaken, height])

    def free(self, beads, centres, headings):
        """Beads clear of the rods."""
        kept = np.ones(len(beads), dtype=bool)
        for centre, angle in zip(centres, headings):
            away = beads[:, :2] - centre
            away -= self.box * np.round(away / self.box)
            along, across = away @ [np.cos(angle), np.sin(angle)], away @ [-np.sin(angle), np.cos(angle)]
            kept &= np.hypot(np.maximum(abs(along) - 1.8e-3, 0), across) > 0.9e-3
        return kept


def write_trajectory(path, bed, times):
    with h5py.File(path, "w") as file:
        kept = np.ones(len(bed.points), dtype=bool)
        for t in (times[0], times[-1]) if len(times) else ():
            kept &= bed.free(np.column_stack([bed.points, 0 * bed.points[:, 0]]), *bed.rods_at(t))
        frames = [moment(bed, t, kept) for t in times]
        write_particles(file, bed, frames, times, kept.sum())
        write_parameters(file, bed)


def moment(bed, t, kept):
    centres, headings = bed.rods_at(t)
    pieces = [bed.beads_at()[kept]]
    for centre, angle in zip(centres, headings):
        along = bed.offset[:, None] * [np.cos(angle), np.sin(angle)] + centre
        pieces.append(np.column_stack([along, np.full(len(along), GAP / 2)]))
    return np.concatenate(pieces), centres, headings


def write_particles(file, bed, frames, times, beads):
    group, rods, count = file.create_group("particles/trajectory"), file.create_group("particles/trajectory_rods"), len(bed.starts)
    total = beads + count * len(bed.offset)
    unwrapped = np.array([one[0] for one in frames]).reshape(len(times), total, 3)
    box = np.array([*bed.box, GAP])
    image = np.floor(unwrapped / box).astype(int) * [1, 1, 0]
    group["position/value"], group["position/time"] = unwrapped - image * box, np.asarray(times, dtype=float)
    group["position/step"], group["image/value"] = np.arange(len(times)), image
    group["velocity/value"] = 0.04 * bed.random.standard_normal(unwrapped.shape)
    group["species"] = np.repeat([0, 1], [beads, total - beads])
    group["radius"] = np.concatenate([np.full(beads, A)] + [bed.radius] * count)
    group["box/edges/value"] = np.tile(np.diag(box), (len(times), 1, 1))
    angle = np.array([one[2] for one in frames]).reshape(len(times), count)
    centre = np.array([one[1] for one in frames]).reshape(len(times), count, 2)
    rods["position/value"] = np.concatenate([centre, np.full((len(times), count, 1), GAP / 2)], axis=2)
    rods["orientation/value"] = np.stack([np.cos(angle / 2), 0 * angle, 0 * angle, np.sin(angle / 2)], axis=-1)


def write_parameters(file, bed):
    group = file.create_group("parameters")
    amplitude = GAMMA * 9.81 / (2 * np.pi * FREQUENCY) ** 2
    known = {"bead_radius": A, "box": bed.box[0], "gap": GAP, "frequency": FREQUENCY, "gamma": GAMMA, "amplitude": amplitude,
             "order_cutoff": 3.0 * A}
    group.attrs.update(known)
    if bed.starts:
        group["rod_of_sphere"] = np.repeat(np.arange(len(bed.starts)), len(bed.offset))


def write_csv(path, columns):
    np.savetxt(path, np.column_stack(list(columns.values())), delimiter=",", header=",".join(columns), comments="", fmt="%.12g")


def write_table(path, duration, random):
    t = np.arange(-10, round(20 * duration) + 1) / 20
    settle = 1 - np.exp(-(t + 0.5) / 0.15)
    noise = 1 + 0.04 * random.standard_normal((6, t.size))
    write_csv(path, {"t": t, "energy": 9e-6 * (0.7 + 0.3 * settle) * noise[0], "kinetic": 3.2e-6 * settle * noise[1],
                     "T_xy": 5.2e-5 * (0.1 + settle) * noise[2], "T_z": 1.7e-3 * (0.1 + settle) * noise[3],
                     "psi6": 0.9 - 0.1 * settle * noise[4], "contacts": 0 * t + 400,
                     "floor_impulse": np.cumsum(0.05 * 0.016 * noise[5]), "lid_impulse": np.cumsum(-0.05 * 0.0045 * noise[0]),
                     "max_overlap": 1e-6 * settle})


def write_tracks(path, bed, duration):
    t = np.arange(-10, round(20 * duration) + 1) / 20
    columns, wander = {"t": t}, np.zeros(len(t))
    for rod in range(len(bed.starts)):
        wander = np.cumsum(2e-5 * bed.random.standard_normal(len(t)) * (t > 0))
        pose = [bed.rods_at(max(one, 0.0)) for one in t]
        columns |= {f"x{rod}": [p[0][rod][0] for p in pose], f"y{rod}": [p[0][rod][1] for p in pose] + wander,
                    f"z{rod}": 0 * t + GAP / 2, f"theta{rod}": [p[1][rod] for p in pose], f"pitch{rod}": 0 * t,
                    f"speed{rod}": 1.6e-3 + 2e-3 * bed.random.standard_normal(len(t))}
    write_csv(path, columns)


def write_member(folder, bed, duration, frames, trajectory=True):
    folder.mkdir(parents=True, exist_ok=True)
    write_table(folder / "table.csv", duration, bed.random)
    write_tracks(folder / "tracks.csv", bed, duration)
    if trajectory:
        write_trajectory(folder / "trajectory.h5md", bed, np.linspace(0, duration, frames))
        write_trajectory(folder / "last_period.h5md", bed, duration - (50 - np.arange(50)) / 50 / FREQUENCY)


def write_granular(folder, runs=1, rods=2, duration=10.0, frames=4, figures="", **bed):
    beds = [Bed(rods=rods, seed=1 + run, **bed) for run in range(runs)]
    for run, one in enumerate(beds):
        write_member(folder if runs == 1 else folder / f"runs/{run + 1:04d}", one, duration, frames, trajectory=run < 2)
    beads = max(0, len(beds[0].points) - 20 * rods)
    results = [{"kind": "motile" if bed.get("polar", True) else "apolar", "mean_speed": 1.6e-3, "net_turn": 0.02}] * rods
    summary = {"simulated_time": duration, "cpu_seconds": 4.6, "wall_seconds": 4.7, "T_xy": 5.2e-5, "T_z": 1.7e-3, "max_overlap": 0.004,
               "psi6": 0.87, "rods": results, "state_hash": "0123456789abcdef", "beads": beads,
               "phi_b": beads * np.pi * A**2 / np.prod(beds[0].box), "bead_radius": A, "box": list(beds[0].box), "runs": runs}
    (folder / "summary.json").write_text(json.dumps(summary))
    (folder / "provenance.json").write_text(json.dumps({"version": "0.2.0", "libraries": {"HDF5": "1.10"}}))
    (folder / "scene.toml").write_text(SCENE.replace("runs = 1", f"runs = {runs}") + figures)
