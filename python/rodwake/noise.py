"""Ensembles of runs with noise."""

from __future__ import annotations

from typing import Any, Optional

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _core, arguments
from ._core import Medium
from .errors import InputError
from .rods import MOST_STEPS, motion

Floats = NDArray[np.float64]
MOST_RUNS = 10_000_000


class NoiseResult:
    """How the runs of an ensemble ended, and how rods turned and spread in them: R runs, N rods, T times. Lengths in f/mu, times in
    f/(mu v0), angles in rad."""

    def __init__(self, core: Any, contact_distance: Optional[float]) -> None:
        self.contact_distance = contact_distance  #: f/mu (None: contact is not detected)
        self.outcomes: NDArray[np.str_] = np.array(core.outcomes())  #: (R,): 'contact', 'bound', 'orbit', 'pursuit', 'escape', 'undecided' or 'failed'
        self.times: Floats = core.times()  #: (R,): of contact, else the end of the run
        self.min_separations: Floats = core.min_separations()  #: (R,); infinite for a single rod
        self.pairs: NDArray[np.int64] = core.pairs()  #: (R, 2): the rods that the outcome is about; -1 for a single rod
        capture = core.capture()
        self.capture_probability: Optional[float] = capture[0] if capture else None  #: share of contact, bound, orbit and pursuit (None: single rod)
        self.capture_interval: Optional[tuple[float, float]] = capture[1:] if capture else None  #: its 95 % interval (Wilson)
        self.t: Floats = core.t()  #: (T,): the output times, the end among them
        self.runs_at_time: NDArray[np.int64] = core.runs_at_time().astype(np.int64)  #: (T,): runs that got there; contact ends a run
        self.mean_square_displacement: Floats  #: (T, N): of those runs; NaN where none did
        self.mean_square_displacement_error: Floats  #: (T, N): standard error; NaN where fewer than two did
        self.mean_square_displacement, self.mean_square_displacement_error = core.mean_square_displacement()
        self.heading_correlation: Floats  #: (T, N): mean of cos(theta(t) - theta(0))
        self.heading_correlation_error: Floats  #: (T, N)
        self.heading_correlation, self.heading_correlation_error = core.heading_correlation()
        self.time_step: float = core.time_step  #: longest step taken
        self.failure: str = core.failure  #: why the first run that failed did ('': none)

    def __repr__(self) -> str:
        text = ""
        if self.capture_probability is not None and self.capture_interval is not None:
            low, high = self.capture_interval
            text = f", capture probability {self.capture_probability:.3g} ({low:.3g} to {high:.3g})"
        if self.contact_distance is None and (self.pairs >= 0).any():
            text += "; no contact_distance: rods that meet run into the singularity of their fields"
        return f"<NoiseResult: {len(self.outcomes)} runs{text}>"


def simulate_noise(poses: ArrayLike, medium: Optional[Medium] = None, *, rotational_diffusion: float, translational_diffusion: float = 0.0,
                   runs: int = 100, capture_error: Optional[float] = None, most_runs: int = 10_000, seed: int = 1,
                   time_step: Optional[float] = None, kappa: float = 0.0, gamma1: float = 0.0,
                   gamma2: float = 0.0, t_end: float, output_times: Optional[ArrayLike] = None, contact_distance: Optional[float] = None,
                   threads: int = 1, max_steps: int = 1_000_000) -> NoiseResult:
    """Runs rods many times with white noise on their headings and positions (docs/noise.md).

    With the output times of a scene (0 included) the result is the same as from its [noise], for any number of threads. Failed runs are
    counted and end an ensemble that has `capture_error`. Invalid input raises InputError.

    Parameters
    ----------
    poses, medium, kappa, gamma1, gamma2, t_end, contact_distance, max_steps
        As for `simulate`.
    rotational_diffusion : float
        D_r, rad^2 mu v0/f.
    translational_diffusion : float
        D_t along each axis, f v0/mu.
    runs : int
        Runs of the ensemble. Run k does not depend on their number.
    capture_error : float, optional
        Runs are added, up to `most_runs`, until half the interval of the capture probability is at most this.
    most_runs : int
        Limit for `capture_error`.
    seed : int
        Seed of the noise.
    time_step : float, optional
        Longest step, f/(mu v0). Default: the rule that `rodwake check` prints.
    output_times : array_like, optional
        As for `simulate`. The noise depends on them: other times give other runs.
    threads : int
        Threads that share the runs.

    Returns
    -------
    NoiseResult
    """
    given = motion(poses, medium, kappa, gamma1, gamma2, t_end, output_times, contact_distance)
    error = arguments.maybe("capture_error", capture_error, least=1e-4, most=0.5)
    if error is not None and len(given[0]) < 2:
        raise InputError("capture_error: captures need two rods and more")
    return NoiseResult(_core.simulate_noise(
        *given, arguments.number("rotational_diffusion", rotational_diffusion, least=0), arguments.number("translational_diffusion",
        translational_diffusion, least=0), arguments.whole("runs", runs, 1, MOST_RUNS), error, arguments.whole("most_runs", most_runs, 1, MOST_RUNS),
        arguments.maybe("time_step", time_step, above=0), arguments.whole("seed", seed, 0), arguments.threads(threads),
        arguments.whole("max_steps", max_steps, 1, MOST_STEPS)), given[-1])
