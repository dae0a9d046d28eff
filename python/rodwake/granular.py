"""Granular beds, step by step or with an observer."""

from __future__ import annotations

from typing import Callable, Optional

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _core, arguments
from .errors import InputError
from .scenes import Scene

Floats = NDArray[np.float64]
LONGEST = 1e9  # s, beyond any bed


class Bed:
    """The bed of a scene with [granular], from its start on. SI units: m, s, rad. N beads, R rods.

    The steps are the same as in `rodwake dem`. Beds with `start = "restart"` and the end at `stop_at_travel` need Scene.run. Do not advance
    one bed from two threads at once.

    Parameters
    ----------
    scene : Scene
        With [granular].
    run : int
        Number of the run, from 0: runs of one seed differ by it.
    threads : int
        Results do not depend on it.
    """

    def __init__(self, scene: Scene, *, run: int = 0, threads: int = 1) -> None:
        arguments.kind("scene", scene, Scene, "a rodwake.Scene")
        self._core = _core.Bed(scene._core, arguments.whole("run", run, 0, 2**32 - 1), arguments.threads(threads))

    def advance(self, *, steps: Optional[int] = None, time: Optional[float] = None) -> None:
        """By so many steps or so much time, in whole steps; at most to the end. Without either by one frame of the scene. Raises
        RunError where the bed cannot go on."""
        if steps is not None and time is not None:
            raise InputError("steps and time: give one of them")
        if time is not None:
            steps = round(arguments.number("time", time, above=0, most=LONGEST) / self.time_step)
        if steps is None:
            steps = self._core.frame_every - self.step % self._core.frame_every if self.step >= 0 else -self.step
        if isinstance(steps, int) and steps < 1:
            raise InputError(f"{steps} steps: a bed must advance by at least one")
        self._core.advance(arguments.whole("steps", steps, 1))

    @property
    def step(self) -> int:
        """Steps done since t = 0; negative while the bed settles."""
        return int(self._core.step)

    @property
    def time(self) -> float:
        """s since the bed has settled; negative before."""
        return float(self._core.time)

    @property
    def time_step(self) -> float:
        """s."""
        return float(self._core.time_step)

    @property
    def finished(self) -> bool:
        """Whether the duration of the scene is over."""
        return bool(self._core.finished)

    @property
    def sides(self) -> tuple[float, float]:
        """Of the periodic box along x and y, m; of a container: of the rectangle that it fits into."""
        x, y = self._core.box
        return float(x), float(y)

    @property
    def box(self) -> float:
        """Side of the periodic square, m; a rectangle has `sides`."""
        x, y = self.sides
        if x != y:
            raise ValueError(f"the box is a rectangle of {x} m x {y} m: use sides")
        return x

    @property
    def bead_radius(self) -> float:
        """m."""
        return float(self._core.bead_radius)

    @property
    def positions(self) -> Floats:
        """(N, 3), m, of the beads, unwrapped: one that leaves the box keeps counting."""
        return self._core.positions()

    @property
    def velocities(self) -> Floats:
        """(N, 3), m/s, of the beads."""
        return self._core.velocities()

    @property
    def rods(self) -> Floats:
        """(R, 3): x and y of the centres of mass in m, unwrapped, and the heading of the thin end in rad."""
        return self._core.rods()

    def body_acceleration(self, places: Optional[ArrayLike] = None) -> Floats:
        """(M, 2), m/s^2: what [granular.body_force] gives beads now, at the positions `places`, (M, 2) of x and y in m (None: of the beads).
        Zero before t = 0 and in a bed without that table."""
        wanted = "an array of shape (M, 2) or (M, 3)"
        return self._core.body_acceleration(None if places is None else arguments.array("places", places, wanted, finite=True))

    @property
    def temperatures(self) -> tuple[float, float]:
        """Granular temperatures of the beads in the plane and along z, m^2/s^2."""
        return self._core.temperatures()

    @property
    def psi6(self) -> float:
        """|mean of psi_6|, the bond order of the beads, from 0 to 1."""
        return float(self._core.bond_order())

    @property
    def state_hash(self) -> str:
        """Of every bit of the state, as in summary.json."""
        return f"{self._core.state_hash():016x}"

    def __repr__(self) -> str:
        return f"<Bed: {len(self.positions)} beads, {len(self.rods)} rods, t = {self.time:.6g} s>"


def run_bed(scene: Scene, observer: Callable[[Bed], object], *, every: Optional[float] = None, run: int = 0, threads: int = 1) -> Bed:
    """Runs a bed to the end of its scene and calls the observer at t = 0 and after each `every` seconds (None: the scene's interval of
    frames). An observer that returns True ends the run there. The bed as it is at the end."""
    arguments.function("observer", observer)
    arguments.maybe("every", every, above=0, most=LONGEST)
    bed = Bed(scene, run=run, threads=threads)
    if bed.step < 0:
        bed.advance(steps=-bed.step)
    while observer(bed) is not True and not bed.finished:
        bed.advance(time=every)
    return bed
