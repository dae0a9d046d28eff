"""Fields that rods leave in the medium, at many points at once.

Points are given by x and y, arrays of one shape or of shapes that broadcast to one (...). Without `rods` the field is that of one
rod at the origin that walks along +x; `rods` is an array (N, 3) of x, y and heading (rad), whose fields add up. Units: lengths f/mu.
Components are those of the lab frame. `threads` share the points; the result does not depend on them. A point at a rod, where
fields are singular, raises InputError.
"""

from __future__ import annotations

from typing import Callable, Optional

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _core
from ._core import Medium

Floats = NDArray[np.float64]
_ORIGIN = np.zeros((1, 3))


def _field(evaluate: Callable[..., Floats], x: ArrayLike, y: ArrayLike, medium: Medium, rods: Optional[ArrayLike], threads: int,
           shape: tuple[int, ...]) -> Floats:
    x, y = np.asarray(x, dtype=float), np.asarray(y, dtype=float)
    if x.shape != y.shape:
        x, y = np.broadcast_arrays(x, y)
    values = evaluate(x, y, medium, _ORIGIN if rods is None else rods, threads)
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
