"""Initial-value problems of your own, and those of rods with your events and terms."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Callable, Literal, Optional, Sequence, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _core
from ._core import RodEquations
from .errors import InputError

Floats = NDArray[np.float64]
Rate = Callable[[float, Floats], ArrayLike]


@dataclass(frozen=True)
class Event:
    """A root to be found: when value(t, y) crosses zero in this direction. A terminal one ends the run there."""

    value: Callable[[float, Floats], float]
    name: str = ""
    direction: Literal["any", "rising", "falling"] = "any"
    terminal: bool = False


@dataclass(frozen=True)
class Hit:
    """An event that was found."""

    event: int  # its number among the events
    time: float
    y: Floats  # (n,)


@dataclass(frozen=True)
class OdeResult:
    """Solution of an initial-value problem."""

    t: Floats  # (T,): those of the times that were reached
    y: Floats  # (T, n): the state at these times
    final_time: float  # the last time, that of a terminal event, or of a failure
    final_y: Floats  # (n,)
    hits: list[Hit]  # in order of time
    status: str  # 'reached_end', 'stopped_at_event' or 'failed'
    message: str  # the same in words, with the cause of a failure
    statistics: dict[str, int]  # steps, rhs_evaluations, ...


def integrate(rhs: Union[RodEquations, Rate], y0: Optional[ArrayLike] = None, times: ArrayLike = (), *, start: float = 0.0,
              events: Sequence[Event] = (), jacobian: Optional[Rate] = None, method: str = "adams", rtol: float = 1e-8,
              atol: Optional[float] = None, max_steps: int = 1_000_000, max_step: float = 0.0) -> OdeResult:
    """Integrates dy/dt = rhs(t, y) from y0 at `start` to the last of `times`.

    rhs        a function of time and state (n,) that returns dy/dt (n,), or RodEquations
    y0         (n,); None: the poses of RodEquations
    times      (T,), increasing: when the state is kept
    jacobian   function that returns d rhs_i/d y_j, (n, n), for method 'bdf'; None: differences, or that of RodEquations
    method     'adams' (many smooth problems), 'bdf' (stiff ones) or 'erk' (explicit Runge-Kutta)
    rtol, atol tolerances of the local error of each component; atol is rtol/100 unless given
    max_step   longest step; 0: any

    A solve that fails is a value, with status 'failed'. What rhs, jacobian or an event raises is raised here.
    """
    if y0 is None:
        if not isinstance(rhs, RodEquations):
            raise InputError("y0 is missing: only RodEquations have a state of their own")
        y0 = rhs.y0
    found = _core.solve(rhs, y0, times, start, jacobian, [(event.name, event.value, event.direction, event.terminal) for event in events],
                        method, rtol, atol, max_steps, max_step)
    t, y, final_time, final_y, hits, status, message, statistics = found
    return OdeResult(t, y, final_time, final_y, [Hit(*hit) for hit in hits], status, message, statistics)
