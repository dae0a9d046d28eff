"""Rods that move at speed v0 and turn in each other's wakes."""

from __future__ import annotations

from collections.abc import Mapping
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


BODY = {"spheres": 6, "length": 1.25, "thick_diameter": 0.3, "thin_diameter": 0.2, "stall_overlap": 0.05, "mobility_ratio": 1.0}


def _body(given: Any) -> Optional[tuple[float, ...]]:
    """The options of a body in the order of BODY, whose defaults are the same as in a scene."""
    if given is None:
        return None
    if not isinstance(given, Mapping) or set(given) - set(BODY):
        raise InputError(f"body: expected a mapping with some of {', '.join(BODY)}; got {given!r}")
    values = {**BODY, **given}
    return (arguments.whole("body['spheres']", values["spheres"], 1, 1000),
            *(arguments.number(f"body['{name}']", values[name], above=0) for name in list(BODY)[1:]))


def simulate(poses: ArrayLike, medium: Optional[Medium] = None, *, kappa: float = 0.0, gamma1: float = 0.0, gamma2: float = 0.0,
             t_end: float, output_times: Optional[ArrayLike] = None, contact_distance: Optional[float] = None,
             body: Optional[Mapping[str, float]] = None, method: str = "auto",
             form: str = "angle", rtol: float = 1e-8, atol: Optional[float] = None, max_steps: int = 1_000_000) -> RodResult:
    """Integrates the motion of rods to `t_end` or to contact.

    The result is the same as from `rodwake rods` for a scene with these values. A solve that fails does not raise: its status is
    'failed' and `message` has the cause. Invalid input raises InputError.

    Parameters
    ----------
    poses : array_like, shape (N, 3)
        x, y (f/mu) and heading (rad) of each rod at the start.
    medium : Medium, optional
        Without it rods move straight.
    kappa : float
        Rate at which a rod turns towards the extensional axis of the strain, v0 mu/f.
    gamma1, gamma2 : float
        Rates at which it turns towards lap u and grad div u, v0.
    t_end : float
        End of the run, f/(mu v0).
    output_times : array_like, shape (T,), optional
        Increasing times within [0, t_end] at which poses are kept; `t_end` is added if it is missing. Default: 201 times from 0 to
        `t_end`, as in a scene. []: the end only, which is faster.
    contact_distance : float, optional
        Distance of two rods that ends the run, f/mu. Without it rods that meet run into the singularity of their fields, and the
        solve fails.
    body : mapping, optional
        Rods with bodies, as [body] of a scene: any of 'spheres', 'length', 'thick_diameter', 'thin_diameter' (f/mu), 'stall_overlap',
        'mobility_ratio'. {}: the default body. Without it rods are points.
    method : str
        'auto', 'bdf', 'adams' or 'erk' (docs/numerics.md).
    form : str
        Form of the equations: 'angle', 'director' or 'dae'.
    rtol, atol : float
        Tolerances of the solver. The default of `atol` is rtol/100.
    max_steps : int
        Steps after which the solve fails.

    Returns
    -------
    RodResult
    """
    return _core.simulate(*motion(poses, medium, kappa, gamma1, gamma2, t_end, output_times, contact_distance), _body(body),
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
    """Determines the outcome of given trajectories by the criteria of `simulate`, for rods with your own turning law.

    Positions between rows follow a cubic. Give about a hundred rows per run, the last one where the solve ended. Headings may jump by
    2 pi and positions by the box.

    Parameters
    ----------
    t : array_like, shape (T,)
        Rising times, f/(mu v0). Of rows at the same time the first one counts.
    poses : array_like, shape (T, N, 3)
        x, y (f/mu) and heading (rad), or the states (T, 3 N) of `integrate`. Rods move at speed v0.
    medium : Medium, optional
        Only its box matters. Without it the rods are on the infinite plane and do not follow each other (no pursuit).
    contact_distance : float, optional
        Distance at which two rods are in contact, f/mu. Without it contact is not detected.
    law : callable, optional
        Function of time and state (3 N,) that returns dy/dt (3 N,), for turning rates. Without it they are finite differences.

    Returns
    -------
    RodResult
        With t and poses up to contact, outcome, time, pair, min_separation, turn and reason.
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
