"""Elastic constants from a static push: a Gaussian body force that goes with the bed, +b and -b from the same start."""

import math

import h5py
import numpy as np
from scipy.optimize import least_squares

from lab import table, text

from . import sound
from .bed import A, PERIOD, bed

WIDTH = 4.0             # a
FRAMES = 0.0997         # s; 997 steps of the bed: every phase of the plates comes
SECONDS, AFTER = 60.0, 2.0
# a^3/s^2, force over mass per area, of which a free rod has 29700 and one held at 1 mm/s 23700: directions of the push, 0 along x, 1 along y
FORCES = {8000.0: (0, 1), 24000.0: (0,)}
MODES = 3               # |m|, |n|
BLOCKS = 8


def cost():
    return 2 * sum(map(len, FORCES.values())) * (SECONDS + 2) * 1549


def run(lab, force, along_y, sign, drag):
    peak = sign * force / (2 * math.pi * WIDTH**2)      # a/s^2
    drift = sign * force / (drag * 78.0 * 77.5)         # a/s: where it goes is only to be near
    keys = (f'[granular.body_force]\nkind = "gaussian"\nacceleration = {peak * A:.8g}\ndirection = {math.pi / 2 if along_y else 0.0:.15g}\n'
            f'width = "{WIDTH} a"\nspeed = {drift * A:.8g}\n')
    name = f"static_{'y' if along_y else 'x'}_{force:.0f}_{'plus' if sign > 0 else 'minus'}"
    return lab.make(name, bed(lab.seconds(SECONDS), keys, frames=FRAMES, formats='["h5md"]')), drift


class Frames:
    """Places relative to the centre of mass and velocities of the beads, a and a/s."""

    def __init__(self, folder):
        with h5py.File(folder / "trajectory.h5md") as file:
            group = file["particles/trajectory"]
            beads = group["species"][()] == 0
            edges = group["box/edges/value"][0]
            self.box = np.array([edges[0, 0], edges[1, 1]]) / A
            self.time = group["position/time"][()]
            place = group["position/value"][:, beads, :2] / A + group["image/value"][:, beads, :2] * self.box
            self.velocity = group["velocity/value"][:, beads, :2] / A
        self.centre = place.mean(axis=1)
        self.place = place - self.centre[:, None, :]


def share_hopped(frames):
    return np.mean([hopped(place - frames.place[0]).mean() for place in frames.place[frames.time >= AFTER]])


def modes(box):
    found = [(m, n) for m in range(MODES + 1) for n in range(-MODES, MODES + 1) if (m, n) > (0, 0) and m * m + n * n <= MODES**2]
    return 2 * np.pi * np.array(found) / box


def hopped(u, spacing=2.13):
    """Beads more than half a spacing from where they began."""
    return np.hypot(u[..., 0], u[..., 1]) > spacing / 2


def amplitudes(frames, q):
    """u_q of each frame, mean of u exp(-i q.R) over the beads that did not hop, R the places in the first frame."""
    start = frames.place[0]
    waves = np.exp(-1j * start @ q.T)
    out = []
    for place in frames.place:
        u = place - start
        kept = ~hopped(u)
        out.append(waves[kept].T @ u[kept] / kept.sum())
    return np.array(out)  # [frame][mode][component]


def response(pair, q, direction, drift):
    """(U_+ - U_-)/2 of unit force over mass per area, block by block: [block][mode][component]; centres as the bed sees them."""
    found = []
    for frames, sign in zip(pair, (1, -1)):
        late = frames.time >= AFTER
        u = amplitudes(frames, q)[late]
        # the force's centre, relative to the centre of mass: it starts in the middle of the box and goes at `drift`
        way = np.zeros((late.sum(), 2))
        way[:, direction] = sign * drift * frames.time[late]
        centre = frames.box / 2 + way - frames.centre[late]
        phase = np.exp(-1j * centre @ q.T)
        blocks = np.array_split(np.arange(late.sum()), BLOCKS)
        found.append((np.array([u[b].mean(axis=0) for b in blocks]), np.array([phase[b].mean(axis=0) for b in blocks])))
    (plus, plus_phase), (minus, minus_phase) = found
    phase = (plus_phase + minus_phase) / 2
    return (plus - minus) / 2 / phase[:, :, None]  # what stands still, as if the force stood at the origin


def predicted(constants, q, direction, force, box):
    """C(q)^-1 F_q of a Gaussian, over the area of the box, [mode][component]."""
    c11, c22, c12, c66 = constants
    x, y = q.T
    xx, yy, xy = c11 * x**2 + c66 * y**2, c66 * x**2 + c22 * y**2, (c12 + c66) * x * y
    push = force * np.exp(-(x**2 + y**2) * WIDTH**2 / 2) / box.prod()
    determinant = xx * yy - xy**2
    return np.stack([yy * push, -xy * push] if direction == 0 else [-xy * push, xx * push], axis=1) / determinant[:, None]


def fit(cases):
    """c11, c22, c12, c66 from [(q, direction, force, box, [block][mode][component])], errors by leaving out blocks."""
    def solve(without):
        means, sigmas = [], []
        for *_, data in cases:
            kept = np.delete(data, without, axis=0) if without is not None else data
            means.append(kept.mean(axis=0).real)
            sigmas.append(data.real.std(axis=0, ddof=1) / math.sqrt(BLOCKS))

        def residuals(log):
            return np.concatenate([((predicted(np.exp(log), q, d, f, box) - m) / smooth(s)).ravel()
                                   for (q, d, f, box, _), m, s in zip(cases, means, sigmas)])
        found = least_squares(residuals, np.log([4e4, 4e4, 1.5e4, 1.3e4]))
        return np.exp(found.x), 2 * found.cost, found.fun.size - 4
    best, chi2, dof = solve(None)
    left = np.array([solve(b)[0] for b in range(BLOCKS)])
    return best, np.sqrt((BLOCKS - 1) / BLOCKS * ((left - left.mean(axis=0)) ** 2).sum(axis=0)), chi2, dof


def smooth(sigma):
    """Errors of 8 blocks scatter: no mode may count more than the typical one of its component by chance."""
    return np.maximum(sigma, 0.7 * np.median(sigma, axis=0))


def temperature(all_frames):
    """T(q)/T_xy of the first modes and T_xy at ten phases of the plates."""
    sums = np.zeros((10, 4))
    for frames in all_frames:
        q = 2 * np.pi * np.array([[1, 0], [0, 1]]) / frames.box
        bins = (10 * (frames.time / PERIOD % 1)).astype(int) % 10
        v = frames.velocity - frames.velocity.mean(axis=1)[:, None, :]
        for k, b in enumerate(bins):
            j = np.exp(-1j * q @ frames.place[k].T) @ v[k] / math.sqrt(v.shape[1])
            sums[b] += [1, (v[k] ** 2).mean(), (abs(j[0, 0]) ** 2 + abs(j[1, 1]) ** 2) / 2, (abs(j[0, 1]) ** 2 + abs(j[1, 0]) ** 2) / 2]
    return sums


def show_temperature(all_frames):
    sums = np.array([temperature([frames]) for frames in all_frames])
    total = sums.sum(axis=0)
    left = total - sums
    rows = []
    n = len(all_frames)
    for b in range(10):
        row = [f"{b / 10:.1f} to {(b + 1) / 10:.1f}", f"{total[b, 1] / total[b, 0] * A * A * 1e5:.3f}"]
        for branch in (2, 3):
            shares = left[:, b, branch] / left[:, b, 1]
            error = math.sqrt((n - 1) / n * ((shares - shares.mean()) ** 2).sum())
            row.append(text((total[b, branch] / total[b, 1], error)))
        rows.append(row)
    table("Temperature of the first modes by the phase of the plates (period 5 ms)", ["phase", "T_xy, 1e-5 m^2/s^2", "T_L/T_xy", "T_T/T_xy"], rows)


def part(lab):
    at_rest = sound.constants(sound.run(lab))
    scale = sound.density(sound.run(lab)) * A * A * 1e3
    rows, all_frames = [], []
    from .push import constants as steady  # which uses Frames from here
    waves, inertia = steady(lab, sound.run(lab))
    rows.append([f"sound, inertia m* = {text(inertia)}", *(text((waves[name][0], waves[name][0] * math.hypot(waves[name][1] / waves[name][0],
                 inertia[1] / inertia[0])), scale) for name in ("c11", "c22", "c12", "c66")), "", ""])
    rows.append(["sound, mass of the beads", *(text(at_rest[name], scale) for name in ("c11", "c22", "c12", "c66")), "", ""])
    for force, directions in FORCES.items():
        cases, shares = [], []
        for direction in directions:
            runs = [run(lab, force, direction, sign, at_rest["zeta"][0]) for sign in (1, -1)]
            pair = [Frames(folder) for folder, _ in runs]
            all_frames += pair
            shares += map(share_hopped, pair)
            q = modes(pair[0].box)
            cases.append((q, direction, force, pair[0].box, response(pair, q, direction, runs[0][1])))
        best, errors, chi2, dof = fit(cases)
        rows.append([f"push, f/rho = {force:.0f} a^3/s^2"] + [text((v, e), scale) for v, e in zip(best, errors)]
                    + [f"{chi2:.0f} ({dof})", f"{max(shares):.0e}"])
    table("Elastic constants of the same bed: by sound and by a static push", ["route", "C11, mN/m", "C22", "C12", "C66", "chi2 (dof)", "beads that hopped, at most"], rows)
    show_temperature(all_frames)
