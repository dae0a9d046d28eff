"""Rods that walk at speed v0 and turn in each other's wakes."""

from __future__ import annotations

from typing import Optional

from numpy.typing import ArrayLike

from . import _core
from ._core import Medium, RodResult


def simulate(poses: ArrayLike, medium: Optional[Medium] = None, *, kappa: float = 0.0, gamma1: float = 0.0, gamma2: float = 0.0,
             t_end: float, output_times: Optional[ArrayLike] = None, contact_distance: Optional[float] = None, method: str = "auto",
             form: str = "angle", rtol: float = 1e-8, atol: Optional[float] = None, max_steps: int = 1_000_000) -> RodResult:
    """Runs rods from `poses`, an array (N, 3) of x, y (f/mu) and heading (rad), to t_end (f/(mu v0)) or to contact.

    medium            None: rods walk straight
    kappa             how strongly a rod turns to the extensional axis of the strain, v0 mu/f
    gamma1, gamma2    how strongly it turns to lap u and to grad div u, v0
    output_times      (T,), increasing, within [0, t_end]: when poses are kept; t_end is added if it is missing
    contact_distance  two rods that come this close end the run, f/mu; None: they do not
    method            'auto', 'bdf', 'adams' or 'erk'; `form`: 'angle', 'director' or 'dae' (docs/physics.md)
    rtol, atol        tolerances of the solver; atol is rtol/100 unless given

    The result is that of `rodwake rods` for a scene with these values, to the last bit. A solve that fails is a value, with
    status 'failed' and the cause in `message`; input that cannot be used raises InputError.
    """
    return _core.simulate(poses, medium, kappa, gamma1, gamma2, t_end, output_times, contact_distance, method, form, rtol, atol,
                          max_steps)
