"""A uniform push on the whole bed: drag of the plates, and with the damping of slow modes its inertia.

    rho b = zeta V              steady: drag rate zeta/rho = b/V, whatever the inertia is
    rho* dV/dt = -zeta V        a slow mode that is left alone decays at zeta/rho*

rho* = m* rho, m* >= 1: beads bounce on the floor and roll, so what moves them has to spin them too, m* = 7/5 for spheres that never
slip and 1.32 with the spin that is measured. Sound likewise has the speed sqrt(C/rho*). So elastic constants are m* rho c^2.
"""

import numpy as np

from lab import mean, ratio, weighted

from . import sound, static
from .bed import A, bed

DRIFTS = (0.5, 2.0, 5.0)    # a/s, about
SECONDS, AFTER, BLOCKS = 40.0, 1.0, 8
GUESS = 11.0                # 1/s, drag rate that the accelerations are made with


def cost():
    return len(DRIFTS) * (SECONDS + 2) * 1549


def drift(lab, speed):
    """((a/s, error), acceleration in a/s^2) of a push that makes the bed drift at about this speed."""
    acceleration = GUESS * speed
    keys = f'[granular.body_force]\nkind = "uniform"\nacceleration = {acceleration * A:.8g}\n'
    frames = static.Frames(lab.make(f"uniform_{speed:g}", bed(lab.seconds(SECONDS), keys, frames=0.25, formats='["h5md"]')))
    late = frames.time >= AFTER
    time, x = frames.time[late], frames.centre[late, 0]
    cuts = np.linspace(0, len(time) - 1, BLOCKS + 1).astype(int)
    return mean(np.diff(x[cuts]) / np.diff(time[cuts])), acceleration


def drag(lab):
    """zeta/rho, 1/s."""
    found = [drift(lab, speed) for speed in DRIFTS]
    return weighted([ratio((acceleration, 0.0), speed) for speed, acceleration in found])


def inertia(lab):
    """m*."""
    return ratio(drag(lab), sound.constants(sound.run(lab))["zeta"])


def constants(lab, sound_run):
    """c11, c22, c12, c66 (a^2/s^2) and zeta (1/s) of a steady field, mass of the beads per area 1, and m*; each (value, error).

    Errors of the constants are those of the sound; that of m*, which they share, is separate.
    """
    factor = inertia(lab)
    scaled = {name: (factor[0] * one[0], factor[0] * one[1]) for name, one in sound.constants(sound_run).items() if name != "zeta"}
    return scaled | {"zeta": drag(lab)}, factor
