"""Initial-value problems of your own, and rods with your events and terms."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Callable, Literal, Optional, Sequence, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _core, arguments
from ._core import RodEquations
from .errors import InputError

Floats = NDArray[np.float64]
Rate = Callable[[float, Floats], ArrayLike]


@dataclass(frozen=True)
class Event:
    """A root to be found: when value(t, y) crosses zero in this direction, or first reaches it. A terminal one ends the run there.

    Inside each step the value is sampled until a polynomial of the order of the method predicts it. What is narrower than a third of
    a step and shows in no sample, as a short pulse, is lost; it is found with a max_step below its width, with one of `times` in it, or
    by candidate_time(t_before, y_before, t, y), which is called once a step with its ends and returns a time inside to look at, or None.
    """

    value: Callable[[float, Floats], float]
    name: str = ""
    direction: Literal["any", "rising", "falling"] = "any"
    terminal: bool = False
    candidate_time: Optional[Callable[[float, Floats, float, Floats], Optional[float]]] = None


@dataclass(frozen=True)
class Hit:
    """An event that was found."""

    event: int  #: its number among the events
    time: float
    y: Floats  #: (n,)


@dataclass(frozen=True)
class OdeResult:
    """Solution of an initial-value problem."""

    t: Floats  #: (T,): the output times up to the end
    y: Floats  #: (T, n): the state at these times
    final_time: float  #: the last time, of a terminal event or of a failure
    final_y: Floats  #: (n,)
    hits: list[Hit]  #: in order of time
    status: str  #: 'reached_end', 'stopped_at_event' or 'failed'
    message: str  #: the same in words, with the cause of a failure
    statistics: dict[str, int]  #: steps, rhs_evaluations, ...


def _check(name: str, given: object, legal: bool, wanted: str) -> None:
    if not legal:
        raise InputError(f"{name} is {given!r}: expected {wanted}")


def _check_event(name: str, event: Event) -> None:
    _check(name, event, isinstance(event, Event), "rodwake.Event(value, ...), where value is a function of (t, y)")
    _check(f"{name}.value", event.value, callable(event.value), "a function of (t, y)")
    _check(f"{name}.name", event.name, isinstance(event.name, str), "a text")
    _check(f"{name}.direction", event.direction, isinstance(event.direction, str), "'any', 'rising' or 'falling'")
    _check(f"{name}.terminal", event.terminal, isinstance(event.terminal, (bool, np.bool_)), "True or False")
    _check(f"{name}.candidate_time", event.candidate_time, event.candidate_time is None or callable(event.candidate_time),
           "a function of (t_before, y_before, t, y), or None")


def integrate(rhs: Union[RodEquations, Rate], y0: Optional[ArrayLike] = None, times: ArrayLike = (), *, start: float = 0.0,
              events: Sequence[Event] = (), jacobian: Optional[Rate] = None, method: str = "adams", rtol: float = 1e-8,
              atol: Optional[float] = None, max_steps: int = 1_000_000, max_step: float = 0.0) -> OdeResult:
    """Integrates dy/dt = rhs(t, y) from `y0` at `start` to the last of `times`.

    A solve that fails does not raise: its status is 'failed'. Exceptions of `rhs`, `jacobian` and events are raised here. If they
    return anything but real numbers, InputError is raised.

    Parameters
    ----------
    rhs : callable or RodEquations
        Function of time and state (n,) that returns dy/dt (n,).
    y0 : array_like, shape (n,), optional
        State at the start. Default: the poses of RodEquations.
    times : array_like, shape (T,)
        Increasing times at which the state is kept.
    start : float
        Time at which the solve starts.
    events : sequence of Event
        Roots to find.
    jacobian : callable, optional
        Function of time and state that returns d rhs_i/d y_j, (n, n), for method 'bdf'. Default: from RodEquations, or finite
        differences.
    method : str
        'adams' (smooth problems), 'bdf' (stiff ones) or 'erk' (explicit Runge-Kutta).
    rtol, atol : float
        Tolerances of the local error of each component. The default of `atol` is rtol/100.
    max_steps : int
        Steps after which the solve fails.
    max_step : float
        Longest step, for short pulses of `rhs` or an event that a step could miss. 0: no limit.

    Returns
    -------
    OdeResult
    """
    _check("rhs", rhs, callable(rhs), "a function of (t, y), or RodEquations")
    _check("jacobian", jacobian, jacobian is None or callable(jacobian), "a function of (t, y)")
    _check("method", method, isinstance(method, str), "'adams', 'bdf' or 'erk'")
    _check("events", events, isinstance(events, Sequence), "a list of rodwake.Event")
    for number, event in enumerate(events):
        _check_event(f"events[{number}]", event)
    if y0 is None:
        if not isinstance(rhs, RodEquations):
            raise InputError("y0 is missing: only RodEquations have a state of their own")
        y0 = rhs.y0
    state = (arguments.array("y0", y0, "x, y and heading of each rod").ravel() if isinstance(rhs, RodEquations)
             else arguments.vector("y0", y0, "a list of real numbers"))
    found = _core.solve(rhs, state, arguments.vector("times", times, "a list of real numbers"), arguments.number("start", start), jacobian,
                        [(event.name, event.value, event.direction, bool(event.terminal), event.candidate_time) for event in events],
                        method, arguments.number("rtol", rtol, above=0), arguments.maybe("atol", atol, above=0),
                        arguments.whole("max_steps", max_steps, 1), arguments.number("max_step", max_step, least=0))
    t, y, final_time, final_y, hits, status, message, statistics = found
    return OdeResult(t, y, final_time, final_y, [Hit(*hit) for hit in hits], status, message, statistics)
