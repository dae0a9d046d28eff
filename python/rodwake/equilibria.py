"""Steady long-time states of two rods: fixed points of a pair's flow, and their branches.

Two rods in each other's steady wakes are a flow in three numbers, the pose (x, y, h) of rod 1 in the frame of rod 0. Lengths in f/mu,
times in f/(mu v0), angles in rad. Equations and errors: include/rodwake/rods/pair_equilibria.hpp and pair_branches.hpp.
"""

from __future__ import annotations

import csv
import os
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Sequence, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _core, arguments
from ._core import Medium
from .errors import InputError

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class PairEquilibrium:
    """A fixed point of a pair's flow.

    Attributes
    ----------
    kind : str
        'orbit': both rods on one circle; 'parallel': side by side or in echelon, walking straight; 'in_line': one behind the other, in
        an interval of distances whose stability is the same.
    pose : tuple of float
        x, y and heading of rod 1 in the frame of rod 0, for omega > 0 and rod 0 in front. In line at the geometric mean of the interval.
    separation : float or tuple of float
        Distance of the rods, f/mu; in line the two ends of the interval.
    omega : float
        Rate at which the pair turns, rad v0 mu/f; 0 unless it orbits.
    eigenvalues : tuple of complex
        Of the flow's Jacobian at `pose`, v0 mu/f, the largest real part first; in line one of them is 0, along the line.
    stable : bool
        Whether all real parts are negative, in line but for the one along the line.
    """

    kind: str
    pose: tuple[float, float, float]
    separation: Union[float, tuple[float, float]]
    omega: float
    eigenvalues: tuple[complex, complex, complex]
    stable: bool


@dataclass(frozen=True, eq=False)
class PairBranch:
    """A family of fixed points, followed over one number of the pair.

    Attributes
    ----------
    over : str
        The number that varies.
    parameter : ndarray, shape (n,)
        Its values along the branch; it turns round at folds.
    equilibria : list of PairEquilibrium
        n of them.
    folds : list of int
        Rows at which two families merge, exact to rounding: `parameter[folds]`.
    ends : tuple of str
        Why the branch stops there: 'range' (of the parameter), 'distance' (of the search), 'opposite' (orbits in which the rods are
        opposite each other branch off), 'in_line', 'closed', or 'lost' (Newton's method failed).
    """

    over: str
    parameter: Floats
    equilibria: list[PairEquilibrium]
    folds: list[int]
    ends: tuple[str, str]

    @property
    def separation(self) -> Floats:
        """(n,): distance of the rods, f/mu."""
        return np.array([point.separation for point in self.equilibria])

    @property
    def omega(self) -> Floats:
        """(n,): turning rate of the pair, rad v0 mu/f."""
        return np.array([point.omega for point in self.equilibria])

    @property
    def growth(self) -> Floats:
        """(n,): largest real part of the eigenvalues, v0 mu/f; negative where stable."""
        return np.array([point.eigenvalues[0].real for point in self.equilibria])


def _named(found: Any) -> PairEquilibrium:
    kind, pose, ends, omega, eigenvalues, stable = found
    x, y, h = pose
    first, second, third = eigenvalues
    return PairEquilibrium(kind, (x, y, h), ends if kind == "in_line" else ends[0], omega, (first, second, third), stable)


def _pair(medium: Any, kappa: Any, gamma1: Any, gamma2: Any) -> tuple[Medium, float, float, float]:
    numbers = [arguments.number(name, value, least=-1e12, most=1e12) for name, value in (("kappa", kappa), ("gamma1", gamma1), ("gamma2", gamma2))]
    return arguments.kind("medium", medium, Medium, "a rodwake.Medium"), numbers[0], numbers[1], numbers[2]


def pair_equilibria(medium: Medium, *, kappa: float = 0.0, gamma1: float = 0.0, gamma2: float = 0.0) -> list[PairEquilibrium]:
    """All fixed points of a pair's flow with a separation of 0.001 to 30 screening lengths.

    Parameters
    ----------
    medium : Medium
        On the infinite plane.
    kappa, gamma1, gamma2 : float
        Couplings as for `simulate`, gammas of the laplacian basis.

    Returns
    -------
    list of PairEquilibrium
        Orbits and parallel pairs, once for all mirror images and exchanges of the rods, by separation; then intervals in line.

    Examples
    --------
    >>> [(e.kind, e.stable) for e in rodwake.pair_equilibria(rodwake.Medium(alpha=0.3), kappa=23)]
    [('orbit', True), ('orbit', False), ('in_line', False), ('in_line', True)]
    """
    return [_named(found) for found in _core.pair_equilibria(*_pair(medium, kappa, gamma1, gamma2))]


def pair_branches(medium: Medium, over: str, least: float, most: float, *, kappa: float = 0.0, gamma1: float = 0.0,
                  gamma2: float = 0.0) -> list[PairBranch]:
    """Orbits and parallel pairs followed over one number, by pseudo-arclength, with their folds.

    Parameters
    ----------
    medium, kappa, gamma1, gamma2
        As for `pair_equilibria`; of these the number in `over` is not read.
    over : str
        'kappa', 'gamma1', 'gamma2', 'eta' or 'alpha'.
    least, most : float
        Its range. Branches that live between two of 17 values evenly spread over it are not seen.

    Returns
    -------
    list of PairBranch

    Examples
    --------
    >>> branch, = rodwake.pair_branches(rodwake.Medium(), "kappa", 20, 30)
    >>> branch.parameter[branch.folds]
    array([22.940713])
    """
    low, high = arguments.number("least", least, least=-1e12, most=1e12), arguments.number("most", most, least=-1e12, most=1e12)
    found = _core.pair_branches(*_pair(medium, kappa, gamma1, gamma2), arguments.kind("over", over, str, "the name of a number"), low, high)
    return [PairBranch(over, np.array(parameter), [_named(point) for point in points], folds, ends) for parameter, points, folds, ends in found]


def write_branches(path: Union[str, "os.PathLike[str]"], branches: Sequence[PairBranch]) -> Path:
    """Writes branches as CSV, one row per fixed point.

    Parameters
    ----------
    path : path
        File to write.
    branches : sequence of PairBranch
        Columns: branch (number from 0), kind, the number that varies, x, y and heading of rod 1 in the frame of rod 0, separation,
        omega, growth (largest real part of the eigenvalues), stable and fold (1 or 0).

    Returns
    -------
    Path
        The file.
    """
    if len({branch.over for branch in branches}) != 1:
        raise InputError("branches: expected one or more branches over the same number")
    target = Path(arguments.path("path", path, "the name of a file"))
    with open(target, "w", encoding="utf-8", newline="") as file:
        rows = csv.writer(file, lineterminator="\n")
        rows.writerow(["branch", "kind", branches[0].over, "x", "y", "heading", "separation", "omega", "growth", "stable", "fold"])
        for number, branch in enumerate(branches):
            for row, (value, point) in enumerate(zip(branch.parameter.tolist(), branch.equilibria)):
                rows.writerow([number, point.kind, value, *point.pose, point.separation, point.omega, point.eigenvalues[0].real, int(point.stable),
                               int(row in branch.folds)])
    return target


def pair_flow(pose: ArrayLike, medium: Medium, *, kappa: float = 0.0, gamma1: float = 0.0, gamma2: float = 0.0) -> tuple[Floats, Floats]:
    """The flow of a pair at a pose, for eigenvalues of your own, for example in line at one distance.

    Parameters
    ----------
    pose : array_like, shape (3,)
        x, y and heading of rod 1 in the frame of rod 0.
    medium, kappa, gamma1, gamma2
        As for `pair_equilibria`.

    Returns
    -------
    tuple of ndarray
        Time derivatives of the pose, (3,), and their derivatives by the pose, (3, 3).
    """
    at = arguments.array("pose", pose, "three numbers: x, y and heading of rod 1 in the frame of rod 0")
    if at.shape != (3,):
        raise InputError(f"pose: expected three numbers, x, y and heading of rod 1 in the frame of rod 0; got an array of shape {at.shape}")
    return _core.pair_flow(at.tolist(), *_pair(medium, kappa, gamma1, gamma2))
