"""Rods that walk at speed v0 and turn in each other's wakes."""

from __future__ import annotations

from typing import Any, Callable, Optional, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _core, arguments
from ._core import Medium, RodEquations, RodResult
from .errors import InputError

Floats = NDArray[np.float64]
Motion = tuple[Floats, Optional[Medium], float, float, float, float, Optional[Floats], Optional[float]]
MOST_STEPS = 10**12


def motion(poses: Any, medium: Any, kappa: Any, gamma1: Any, gamma2: Any, t_end: Any, output_times: Any, contact_distance: Any) -> Motion:
    """The arguments that simulate and simulate_noise have in common, checked."""
    times = None if output_times is None else arguments.array("output_times", output_times, "a list of times within [0, t_end]")
    if times is not None and times.ndim != 1:
        raise InputError(f"output_times: expected a list of times within [0, t_end]; got an array of shape {times.shape}")
    couplings = [arguments.number(name, value, least=-1e12, most=1e12) for name, value in (("kappa", kappa), ("gamma1", gamma1), ("gamma2", gamma2))]
    return (arguments.poses("poses", poses), arguments.medium("medium", medium), couplings[0], couplings[1], couplings[2], arguments.number("t_end", t_end, above=0), times,
            arguments.maybe("contact_distance", contact_distance, above=0))


def simulate(poses: ArrayLike, medium: Optional[Medium] = None, *, kappa: float = 0.0, gamma1: float = 0.0, gamma2: float = 0.0,
             t_end: float, output_times: Optional[ArrayLike] = None, contact_distance: Optional[float] = None, method: str = "auto",
             form: str = "angle", rtol: float = 1e-8, atol: Optional[float] = None, max_steps: int = 1_000_000) -> RodResult:
    """Runs rods from `poses`, an array (N, 3) of x, y (f/mu) and heading (rad), to t_end (f/(mu v0)) or to contact.

    medium            None: rods walk straight
    kappa             how strongly a rod turns to the extensional axis of the strain, v0 mu/f
    gamma1, gamma2    how strongly it turns to lap u and to grad div u, v0
    output_times      (T,), increasing, within [0, t_end]: when poses are kept; t_end is added if it is missing. None: 0, t_end/200,
                      2 t_end/200, ... t_end, as in a scene; []: the end alone, which is quicker where only the outcome matters
    contact_distance  two rods that come this close end the run, f/mu; None: they do not, and where they meet, in the singularity
                      of their fields, the solve fails
    method            'auto', 'bdf', 'adams' or 'erk'; `form`: 'angle', 'director' or 'dae' (docs/numerics.md)
    rtol, atol        tolerances of the solver; atol is rtol/100 unless given

    The result is that of `rodwake rods` for a scene with these values, to the last bit. A solve that fails is a value, with
    status 'failed' and the cause in `message`; input that cannot be used raises InputError.
    """
    return _core.simulate(*motion(poses, medium, kappa, gamma1, gamma2, t_end, output_times, contact_distance),
                          arguments.kind("method", method, str, "'auto', 'bdf', 'adams' or 'erk'"),
                          arguments.kind("form", form, str, "'angle', 'director' or 'dae'"), arguments.number("rtol", rtol, above=0),
                          arguments.maybe("atol", atol, above=0), arguments.whole("max_steps", max_steps, 1, MOST_STEPS))


def _rates(value: Any, size: int) -> Floats:
    wanted = f"a function that returns {size} numbers"
    rates = arguments.array("law", value, wanted).ravel()
    if rates.size != size:
        raise InputError(f"law: expected {wanted}; it returned {rates.size}")
    return rates


def classify(t: ArrayLike, poses: ArrayLike, medium: Optional[Medium] = None, *, contact_distance: Optional[float] = None,
             law: Union[RodEquations, Callable[[float, Floats], ArrayLike], None] = None) -> RodResult:
    """How rods ended that moved like this, by the criteria of simulate and the program: for rods with a turning law of their own.

    t                 (T,), f/(mu v0), rising; of rows at one time the first counts
    poses             (T, N, 3) of x, y (f/mu) and heading (rad), or the states (T, 3 N) of integrate. Rods walk at speed v0
    medium            of which the box matters; None: infinite plane, and rods that do not follow each other (no pursuit)
    contact_distance  two rods that come this close are in contact, f/mu; None: contact is not told
    law               function that returns dy/dt (3 N,) of the time and the state (3 N,), for how fast rods turn; None: by differences

    The result has t and poses up to contact, outcome, time, pair, min_separation, turn and reason, as that of simulate. Between rows
    places follow a cubic: give some hundred rows a run, the last of them where the solve ended. Headings may jump by 2 pi and places by
    the box.
    """
    times = arguments.array("t", t, "a list of times that rise")
    rows = arguments.array("poses", poses, "an array of shape (T, N, 3), or (T, 3 N)")
    if times.ndim != 1 or rows.ndim not in (2, 3) or len(rows) != len(times) or rows[:1].size % 3 or (rows.ndim == 3 and rows.shape[2] != 3):
        raise InputError(f"t and poses: expected shapes (T,) and (T, N, 3) or (T, 3 N); got {times.shape} and {rows.shape}")
    new = np.append(True, np.diff(times) != 0)[:len(times)]
    times, rows = times[new], rows[new].reshape(int(new.sum()), -1, 3)
    if len(times) < 2 or rows.shape[1] < 1 or not (np.isfinite(times).all() and np.isfinite(rows).all() and (np.diff(times) > 0).all()):
        raise InputError("t and poses: expected two rows and more of one rod and more, of finite numbers at times that rise")
    arguments.medium("medium", medium)
    rows = rows.copy()
    rows[..., 2] = np.unwrap(rows[..., 2], axis=0)
    sides = medium.periodic if medium is not None else None
    if sides is not None:
        for axis, side in enumerate(sides if isinstance(sides, tuple) else (sides, sides)):
            rows[..., axis] = np.unwrap(rows[..., axis], axis=0, period=side)
    if law is None:
        turning = np.gradient(rows[..., 2], times, axis=0, edge_order=2 if len(times) > 2 else 1)
    else:
        arguments.function("law", law)
        turning = np.array([_rates(law(time, row.ravel()), row.size)[2::3] for time, row in zip(times.tolist(), rows)])
    return _core.classify(times, rows, turning, medium, arguments.maybe("contact_distance", contact_distance, above=0))
