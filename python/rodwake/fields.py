"""Fields that rods leave in the medium, at many points at once.

Points are given by x and y, arrays of one shape or of shapes that broadcast to one (...). Without `rods` it is the field of one
rod at the origin that moves along +x; `rods` is an array (N, 3) of x, y and heading (rad), whose fields add up. Units: lengths f/mu.
Components are in the lab frame. `threads` share the points; the result does not depend on them.

At a rod, and in a box at its images, fields are singular: there the result is NaN, and a RuntimeWarning counts the points.
Where x or y is NaN, infinite or masked it is NaN without a warning.
"""

from __future__ import annotations

from typing import Callable, NamedTuple, Optional

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _core, arguments
from ._core import Medium
from .errors import InputError

Floats = NDArray[np.float64]
_ORIGIN = np.zeros((1, 3))


def _field(evaluate: Callable[..., Floats], x: ArrayLike, y: ArrayLike, medium: Medium, rods: Optional[ArrayLike], threads: int,
           shape: tuple[int, ...]) -> Floats:
    x, y = arguments.gaps("x", x), arguments.gaps("y", y)
    if x.shape != y.shape:
        try:
            x, y = np.broadcast_arrays(x, y)
        except ValueError:
            raise InputError(f"x has the shape {x.shape} and y {y.shape}: they must broadcast to one; for a grid give x and y[:, None]") from None
    arguments.kind("medium", medium, Medium, "a rodwake.Medium")
    sources = _ORIGIN if rods is None else arguments.poses("rods", rods)
    values = evaluate(x, y, medium, sources, arguments.threads(threads))
    return values.reshape(x.shape + shape)


def displacement(x: ArrayLike, y: ArrayLike, medium: Medium, *, rods: Optional[ArrayLike] = None, threads: int = 1) -> Floats:
    """U, array (..., 2) in f/mu: how far the medium has moved."""
    return _field(_core.displacement, x, y, medium, rods, threads, (2,))


def strain(x: ArrayLike, y: ArrayLike, medium: Medium, *, rods: Optional[ArrayLike] = None, threads: int = 1) -> Floats:
    """(grad U + grad U^T)/2, array (..., 2, 2), dimensionless: it turns apolar rods. Its trace is div U."""
    return _field(_core.strain, x, y, medium, rods, threads, (2, 2))


def laplacian(x: ArrayLike, y: ArrayLike, medium: Medium, *, rods: Optional[ArrayLike] = None, threads: int = 1) -> Floats:
    """lap U, array (..., 2) in mu/f: the vector that polar rods follow with gamma1."""
    return _field(_core.laplacian, x, y, medium, rods, threads, (2,))


def grad_div(x: ArrayLike, y: ArrayLike, medium: Medium, *, rods: Optional[ArrayLike] = None, threads: int = 1) -> Floats:
    """grad div U, array (..., 2) in mu/f: the vector that polar rods follow with gamma2."""
    return _field(_core.grad_div, x, y, medium, rods, threads, (2,))


def dipole(x: ArrayLike, y: ArrayLike, medium: Medium, *, rods: Optional[ArrayLike] = None, threads: int = 1) -> Floats:
    """Field of a force dipole across the rod (forces +-f2 at +-d/2 to its sides, d -> 0), array (..., 2) in f2 d/mu per length."""
    return _field(_core.dipole, x, y, medium, rods, threads, (2,))


class Wakes(NamedTuple):
    """Fields of the other rods at each of N rods, in a periodic box also of its own images. Lab components."""

    displacement: Floats  #: (N, 2), f/mu
    strain: Floats  #: (N, 2, 2), dimensionless
    strain_gradient: Floats  #: (N, 2, 2, 2), mu/f: [a, k, i, j] is d strain_ij/d x_k at rod a
    laplacian: Floats  #: (N, 2), mu/f
    grad_div: Floats  #: (N, 2), mu/f


def wakes(poses: ArrayLike, medium: Medium) -> Wakes:
    """The fields in which rods at `poses` turn, for turning laws of your own: `poses` is (N, 3), or the state (3 N,) of integrate.

    The theory's law is theta' = z.[n x (kappa strain.n + gamma1 laplacian + gamma2 grad_div)], n the heading of the rod. Two rods in
    one position raise InputError.
    """
    given = arguments.array("poses", poses, "an array of shape (N, 3) or (3 N,): x, y and heading of each rod")
    flat = given.ndim == 1 and given.size > 0 and given.size % 3 == 0
    return Wakes(*_core.wakes(arguments.poses("poses", given.reshape(-1, 3) if flat else given),
                              arguments.kind("medium", medium, Medium, "a rodwake.Medium")))
