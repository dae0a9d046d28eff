"""What makes the wake at imposed speeds less one-sided than drag: a force spread along the rod's row, or the medium's viscosity?

The steady field of elastic/anisotropic.hpp, with one more source: a uniform line force from the rod to a distance L ahead of it or
behind it. To the mean of the runs' maps beyond the first mask of the monopole fits, the amplitudes of the rod, of that line, both
dipoles and an offset are fitted, everything else held. A row that is pushed along ahead would take a positive share of the force.
Viscosity: what chi2 changes by with that of sound, without the line.
"""

import math

import h5py
import numpy as np

from lab import estimate, table, text, read_json

from . import monopole, push, scaling, sound
from .bed import A

LENGTHS = (20.0, 40.0, 75.0)     # a, of the line; half the box is 77
INDEPENDENT = (2.0 / 4.2) ** 2   # values a bin is worth: bins of 2 a, independent_spacing of the fits


def cost():
    return scaling.cost(155)


class Medium:
    """The field of a medium in its box at places (x, y): 6.5/w is the largest wave vector that a source of width w needs."""

    def __init__(self, x, y, constants, zeta, rho, viscosity, speed, width=2.0):
        lx, ly = (len(places) * (places[1] - places[0]) for places in (x, y))
        qx, qy = (2 * math.pi / side * np.arange(-math.ceil(most), math.ceil(most) + 1)
                  for side, most in ((side, 6.5 / width * side / (2 * math.pi)) for side in (lx, ly)))
        X, Y = qx[:, None], qy[None, :]
        c11, c22, c12, c66 = constants
        motion = -1j * zeta * speed * X - rho * speed**2 * X**2 - 1j * viscosity * speed * X * (X**2 + Y**2)
        xx, yy, xy = c11 * X**2 + c66 * Y**2 + motion, c66 * X**2 + c22 * Y**2 + motion, (c12 + c66) * X * Y
        rest = (X == 0) & (Y == 0)
        smooth = np.where(rest, 0.0, np.exp(-(X**2 + Y**2) * width**2 / 2)) / np.where(rest, 1.0, xx * yy - xy**2) / (lx * ly)
        self.inverse, self.X, self.Y = np.array([[yy, -xy], [-xy, xx]]) * smooth, X, Y
        self.ex, self.ey = np.exp(1j * np.outer(x, qx)), np.exp(1j * np.outer(y, qy))

    def field(self, along, across):
        """(U_x, U_y), each [row y][column x], of forces in q space."""
        found = [row[0] * along + row[1] * across for row in self.inverse]
        return np.array([(self.ex @ one @ self.ey.T).real.T for one in found])

    def line(self, low, high):
        """A force of 1 along x, spread from low to high."""
        spread = np.sinc(self.X * (high - low) / (2 * math.pi)) * np.exp(-1j * self.X * (low + high) / 2)
        return self.field(spread, 0 * spread)

    def dipoles(self):
        nothing = 0 * self.X * self.Y
        return [self.field(-1j * self.X + nothing, nothing), self.field(nothing, -1j * self.Y + nothing)]

    def moments(self, order):
        """Of the two moments of an order from 2 on that show outside the rod: f_x by x^n/n! and by x^(n-2) y^2/(n-2)!/2!, over their signs.
        The stiffness matrix times any (a_x, a_y) q_x^j q_y^k is a source that shows nowhere, which takes all other moments off."""
        nothing = 0 * self.X * self.Y
        return [self.field((-1j) ** order * self.X ** (order - across) * self.Y**across + nothing, nothing) for across in (0, 2)]


def maps(folders):
    found = []
    for folder in folders:
        group = h5py.File(folder / "measure.h5")["displacement"]
        found.append({name: group[name][()] for name in ("x", "y", "Ux", "Uy", "sigma_x", "sigma_y")})
    return found


class Data:
    """Means over runs of the bins that the mask leaves."""

    def __init__(self, found, mask=monopole.MASKS[0], independent=INDEPENDENT):
        self.x, self.y = found[0]["x"], found[0]["y"]
        X, Y = np.meshgrid(self.x, self.y)
        strip, radius = mask
        self.independent = independent
        self.kept = (np.abs(Y) >= strip) & (np.hypot(X, Y) >= radius)
        self.kept &= np.all([np.isfinite(one[name]) for one in found for name in ("Ux", "Uy", "sigma_x", "sigma_y")], axis=0)
        self.values = self.column([np.mean([one[name] for one in found], axis=0) for name in ("Ux", "Uy")])
        self.sigma = self.column([np.sqrt(np.mean([one[name] ** 2 for one in found], axis=0) / len(found) / independent)
                                  for name in ("sigma_x", "sigma_y")])

    def column(self, pair):
        return np.concatenate([one[self.kept] for one in pair])

    def fit(self, fields):
        """(coefficients, chi2, degrees of freedom); chi2 of bins that share noise, so as many degrees as they are worth."""
        offset = [np.ones(self.kept.shape), np.zeros(self.kept.shape)]
        matrix = np.stack([self.column(one) for one in (*fields, offset)], axis=1) / self.sigma[:, None]
        found = np.linalg.lstsq(matrix, self.values / self.sigma, rcond=None)[0]
        left = self.values / self.sigma - matrix @ found
        return found, left @ left, self.independent * len(left) - len(found)


def with_line(found, medium, force, length):
    """Share of the predicted force that the line takes, its error by leaving out runs, and chi2."""
    half = monopole.ROD_LENGTH / 2
    fields = [force * medium.line(-half, half), *medium.dipoles()] + ([] if length is None else [force * medium.line(min(0.0, length), max(0.0, length))])

    def share(keep):
        return Data([one for one, kept in zip(found, keep) if kept]).fit(fields)[0][0 if length is None else 3]
    best, chi2, dof = Data(found).fit(fields)
    every = np.ones(len(found), dtype=bool)
    return share(every), scaling.leave_one_out(share, len(found)), chi2, dof, best


def part(lab):
    waves = sound.run(lab, "sound_155", seconds=scaling.SOUND_SECONDS, runs=1, box="fit 155 a")
    (constants, inertia), density = push.constants(lab, waves), sound.density(waves)
    elastic = [constants[name][0] for name in ("c11", "c22", "c12", "c66")]
    heard = inertia[0] * estimate(read_json(waves, "measure")["phonons"]["viscosity_T"])[0]
    rows = []
    for variant, label in scaling.CASES:
        folders = scaling.case_folders(lab, 155, variant)
        found = maps(folders)
        force, through = monopole.signed(folders, float(label) * 0.4)
        media = [Medium(found[0]["x"], found[0]["y"], elastic, constants["zeta"][0], inertia[0], one, through) for one in (0.0, heard)]
        source = force[0] / density / A**3
        amplitude, error, chi2, dof, best = with_line(found, media[0], source, None)
        cells = [label, text((amplitude, error)), f"{best[1] / source:.0f}", f"{best[2] / source:.0f}", f"{chi2:.0f} ({dof:.0f})"]
        for length in (*LENGTHS, -LENGTHS[1]):
            share, error, less, _, _ = with_line(found, media[0], source, length)
            cells.append(f"{text((share, error))} ({less:.0f})")
        rows.append([*cells, f"{with_line(found, media[1], source, None)[2] - chi2:+.0f}"])
    table(f"A force spread along the row, as share of the whole prediction (chi2), and viscosity; by sound it is {heard:.0f} a^2/s",
          ["speed, a/s", "no line: amplitude", "P_xx/f, a", "P_yy/f, a", "chi2 (dof)", *(f"line of {length:g} a ahead" for length in LENGTHS),
           f"of {LENGTHS[1]:g} a behind", "change of chi2 by the viscosity of sound"], rows)
