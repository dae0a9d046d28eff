"""A Gaussian body force that moves through the bed without a rod: what the medium itself answers, with drag, inertia and viscosity."""

import math

import numpy as np
from scipy.optimize import least_squares

from lab import estimate, table, text, read_json

from . import push, sound, static
from .bed import A, bed

FORCE = 24000.0              # a^3/s^2, force over mass per area: that of a rod held at 1 mm/s, four fifths of a free one's
SEEDS = {2.8: 6, 10.0: 6, 15.0: 6}  # runs at each speed, a/s; at the slowest drag hardly shows
SECONDS, BLOCKS = 60.0, 8             # blocks of each run
FRAMES = 0.1997               # s; every phase of the plates


def cost():
    return sum(SEEDS.values()) * (SECONDS + 2) * 1549


def modes(box):
    """Without those across the way: there what the crystal had at the start stays in step with the force."""
    q = static.modes(box)
    return q[q[:, 0] > 0]


def answer(frames, q, speed):
    """U_q in the frame of the force, block by block, [block][mode][component], and its speed against the bed."""
    late = frames.time >= static.AFTER
    u = static.amplitudes(frames, q)[late]
    time = frames.time[late]
    centre = frames.box / 2 - frames.centre[late]
    centre[:, 0] += speed * time
    turned = u * np.exp(1j * centre @ q.T)[:, :, None]
    drift = (frames.centre[late][-1, 0] - frames.centre[late][0, 0]) / (time[-1] - time[0])
    return np.array([turned[b].mean(axis=0) for b in np.array_split(np.arange(len(time)), BLOCKS)]), speed - drift


def predicted(constants, zeta, viscosity, q, speed, box, inertia):
    """[C(q) - i zeta v q_x - m* v^2 q_x^2 - i nu v q_x q^2]^-1 F_q over the area, mass per area 1."""
    c11, c22, c12, c66 = constants
    x, y = q.T
    motion = -1j * zeta * speed * x - inertia * speed**2 * x**2 - 1j * viscosity * speed * x * (x**2 + y**2)
    xx, yy, xy = c11 * x**2 + c66 * y**2 + motion, c66 * x**2 + c22 * y**2 + motion, (c12 + c66) * x * y
    push = FORCE * np.exp(-(x**2 + y**2) * static.WIDTH**2 / 2) / box.prod()
    return np.stack([yy * push, -xy * push], axis=1) / (xx * yy - xy**2)[:, None]


def fit(data, constants, viscosity, q, speed, box, inertia):
    """Amplitude and drag, errors by leaving out blocks."""
    sigma = np.hypot(data.real.std(axis=0, ddof=1), data.imag.std(axis=0, ddof=1)) / math.sqrt(2 * len(data))
    sigma = static.smooth(sigma)

    def solve(kept):
        mean = kept.mean(axis=0)

        def residuals(p):
            off = ((p[0] * predicted(constants, p[1], viscosity, q, speed, box, inertia) - mean) / sigma).ravel()
            return np.concatenate([off.real, off.imag])
        found = least_squares(residuals, [1.0, 11.0], x_scale=[1.0, 10.0])
        return found.x, 2 * found.cost, found.fun.size - 2
    best, chi2, dof = solve(data)
    left = np.array([solve(np.delete(data, b, axis=0))[0] for b in range(len(data))])
    n = len(data)
    return best, np.sqrt((n - 1) / n * ((left - left.mean(axis=0)) ** 2).sum(axis=0)), chi2, dof


def part(lab):
    at_rest, inertia = push.constants(lab, sound.run(lab))
    constants = [at_rest[name][0] for name in ("c11", "c22", "c12", "c66")]
    viscosity = inertia[0] * estimate(read_json(sound.run(lab), "measure")["phonons"]["viscosity_T"])[0]
    rows = []
    for speed, seeds in SEEDS.items():
        data, through = [], []
        for seed in range(1, lab.count(seeds) + 1):
            keys = (f'seed = {seed}\n[granular.body_force]\nkind = "gaussian"\nacceleration = {FORCE / (2 * math.pi * static.WIDTH**2) * A:.8g}\n'
                    f'width = "{static.WIDTH} a"\nspeed = {speed * A:.8g}\n')
            frames = static.Frames(lab.make(f"moving_{speed:g}_{seed}", bed(lab.seconds(SECONDS), keys, frames=FRAMES, formats='["h5md"]')))
            q = modes(frames.box)
            blocks, against = answer(frames, q, speed)
            data.append(blocks)
            through.append(against)
        best, errors, chi2, dof = fit(np.concatenate(data), constants, viscosity, q, np.mean(through), frames.box, inertia[0])
        rows.append([f"{speed:g}", f"{np.mean(through):.2f}", *(text((v, e), digits=d) for v, e, d in zip(best, errors, (3, 1))), f"{chi2:.0f} ({dof})"])
    rows.append(["uniform push", "", "", text(at_rest["zeta"], digits=1), ""])
    table(f"A moving Gaussian force without a rod, f/rho = {FORCE:.0f} a^3/s^2; elastic constants and shear viscosity held at those of sound, times m*",
          ["speed, a/s", "through the bed, a/s", "amplitude over prediction", "drag rate, 1/s", "chi2 (dof)"], rows)
