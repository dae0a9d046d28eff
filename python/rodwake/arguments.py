"""Arguments as users give them. What cannot be used raises InputError, a thing of another kind TypeError; both name the argument."""

from __future__ import annotations

import math
import numbers
import operator
import os
from typing import Any, Optional, Union

import numpy as np
from numpy.typing import NDArray

from .errors import InputError

MOST_THREADS = 1024
_LONGEST = 200  # characters of a value in a message


def shown(value: object) -> str:
    text = repr(value)
    return text if len(text) <= _LONGEST else f"{text[:_LONGEST]}..."


def number(name: str, value: Any, *, above: float = -math.inf, least: float = -math.inf, most: float = math.inf) -> float:
    """A finite number in a range."""
    given = math.nan
    if type(value) is float:
        given = value
    elif not isinstance(value, (bool, np.bool_, str, bytes)):
        try:
            given = math.nan if np.iscomplexobj(value) else float(value)
        except (TypeError, ValueError, OverflowError):
            pass
    if math.isfinite(given) and given > above and least <= given <= most:
        return given
    low = f" above {above:g}" if above > -math.inf else f" of {least:g} or more" if least > -math.inf else ""
    raise InputError(f"{name} = {shown(value)}: must be a finite number{low}{f' up to {most:g}' if most < math.inf else ''}")


def maybe(name: str, value: Any, **limits: float) -> Optional[float]:
    """The same, or None."""
    return None if value is None else number(name, value, **limits)


def whole(name: str, value: Any, least: int, most: int = 2**63 - 1) -> int:
    """A whole number in a range."""
    try:
        given = least - 1 if isinstance(value, (bool, np.bool_)) else operator.index(value)
    except TypeError:
        given = least - 1
    if least <= given <= most:
        return given
    raise InputError(f"{name} = {shown(value)}: must be a whole number from {least} to {'2^63 - 1' if most == 2**63 - 1 else most}")


def threads(value: Any, least: int = 0) -> int:
    return whole("threads", value, least, MOST_THREADS)


def array(name: str, value: Any, shape: str = "") -> NDArray[np.float64]:
    """Numbers as an array of floats; NaN where a masked array is masked. `shape` tells in words what is expected."""
    wanted = f"{name}: expected {shape or 'numbers'}"
    try:
        given = np.asarray(value)
    except ValueError as error:
        raise InputError(f"{wanted}, not {shown(value)}: {error}") from error
    if given.dtype.kind == "O" and all(isinstance(one, numbers.Real) and not isinstance(one, bool) for one in given.flat):
        given = np.array([number(name, one) for one in given.flat]).reshape(given.shape)  # fractions, whole numbers beyond 64 bits
    if given.dtype.kind not in "iuf":
        raise InputError(f"{wanted}, not {given.dtype.name} ({shown(value)})" if given.dtype.kind != "O" else f"{wanted}, not {shown(value)}")
    floats: NDArray[np.float64] = given.astype(float, copy=False)
    return np.where(value.mask, np.nan, floats) if isinstance(value, np.ma.MaskedArray) else floats


def poses(name: str, value: Any) -> NDArray[np.float64]:
    """(N, 3)"""
    wanted = "an array of shape (N, 3): x, y and heading of each rod"
    given = array(name, value, wanted)
    if given.ndim != 2 or given.shape[1] != 3:
        raise InputError(f"{name}: expected {wanted}; got one of shape {given.shape}")
    return given


def kind(name: str, value: Any, kinds: Union[type, tuple[type, ...]], wanted: str) -> Any:
    if not isinstance(value, kinds):
        raise TypeError(f"{name}: expected {wanted}, not {type(value).__name__} ({shown(value)})")
    return value


def medium(name: str, value: Any) -> Any:
    """A Medium, or None."""
    from ._core import Medium
    return None if value is None else kind(name, value, Medium, "a rodwake.Medium or None")


def path(name: str, value: Any, what: str = "the name of a folder") -> str:
    given: str = os.fspath(kind(name, value, (str, os.PathLike), what))
    return given


def function(name: str, value: Any) -> Any:
    if not callable(value):
        raise TypeError(f"{name}: expected a function, not {type(value).__name__} ({shown(value)})")
    return value
