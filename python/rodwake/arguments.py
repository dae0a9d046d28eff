"""Arguments as users give them. What cannot be used raises InputError, a thing of another kind TypeError; both name the argument.

Every array of a user comes in through `array`, `gaps`, `vector`, `poses` or `rows`: they know of masks, which NumPy's conversions drop.
"""

from __future__ import annotations

import math
import operator
import os
from typing import Any, Mapping, Optional, Union

import numpy as np
from numpy.typing import NDArray

from .errors import InputError

Floats = NDArray[np.float64]
MOST_THREADS = 1024
_ma: Any = np.ma  # whose functions have no types
_LONGEST = 200  # characters of a value in a message


def shown(value: object) -> str:
    text = repr(value)
    return text if len(text) <= _LONGEST else f"{text[:_LONGEST]}..."


def is_masked(value: Any) -> bool:
    """Any of it."""
    return bool(_ma.is_masked(value))


def _as_float(value: Any) -> Optional[float]:
    """None if it is no number: text, booleans, times and masked values are none, though most of them turn into one."""
    try:
        given = np.asarray(value)
        if given.size != 1 or given.dtype.kind not in "iufO" or isinstance(given.item(), (bool, str, bytes)) or is_masked(value):
            return None
        return float(value)
    except (TypeError, ValueError, OverflowError):
        return None


def number(name: str, value: Any, *, above: float = -math.inf, least: float = -math.inf, most: float = math.inf) -> float:
    """A finite number in a range."""
    given = value if type(value) is float else _as_float(value)
    if given is not None and math.isfinite(given) and given > above and least <= given <= most:
        return given
    low = f" above {above:g}" if above > -math.inf else f" of {least:g} or more" if least > -math.inf else ""
    raise InputError(f"{name} = {shown(value)}: must be a finite number{low}{f' up to {most:g}' if most < math.inf else ''}")


def maybe(name: str, value: Any, **limits: float) -> Optional[float]:
    """The same, or None."""
    return None if value is None else number(name, value, **limits)


def sides(name: str, value: Any) -> Optional[tuple[float, float]]:
    """Of a periodic box: None, one or two."""
    if value is None:
        return None
    both = isinstance(value, (list, tuple, np.ndarray)) and getattr(value, "ndim", 1) == 1 and len(value) == 2
    x, y = (number(name, side, above=0) for side in (value if both else (value, value)))
    return x, y


def whole(name: str, value: Any, least: int, most: int = 2**63 - 1) -> int:
    """A whole number in a range."""
    try:
        no_number = isinstance(value, (bool, np.bool_, np.timedelta64)) or is_masked(value)
        given = least - 1 if no_number else operator.index(value)
    except TypeError:
        given = least - 1
    if least <= given <= most:
        return given
    raise InputError(f"{name} = {shown(value)}: must be a whole number from {least} to {'2^63 - 1' if most == 2**63 - 1 else most}")


def threads(value: Any, least: int = 0) -> int:
    return whole("threads", value, least, MOST_THREADS)


def array(name: str, value: Any, shape: str = "numbers", *, finite: bool = False) -> Floats:
    """Numbers as an array of floats, none of them masked. `shape` tells in words what is expected."""
    given, masked = _split(name, value, shape)
    if masked.any():
        raise InputError(f"{name}: {np.count_nonzero(masked)} of {masked.size} values are masked: leave them out")
    if finite and not np.isfinite(given).all():
        raise InputError(f"{name}: {given[~np.isfinite(given)][0]}: expected {shape}, all finite")
    return given


def gaps(name: str, value: Any, shape: str = "numbers") -> Floats:
    """The same with NaN where it is masked, for what may have gaps."""
    given, masked = _split(name, value, shape)
    return np.where(masked, np.nan, given) if masked.any() else given


def rows(name: str, columns: Mapping[str, tuple[Any, int]], shape: str) -> list[Floats]:
    """Columns of data, each with its number of axes, less the rows in which something is masked."""
    parts = [_split(f"{name}.{key}", value, "numbers") for key, (value, _) in columns.items()]
    shapes = [given.shape for given, _ in parts]
    if [len(one) for one in shapes] != [axes for _, axes in columns.values()] or len({one[0] for one in shapes}) > 1:
        raise InputError(f"{name}: expected {shape}; {', '.join(columns)} have the shapes {', '.join(map(str, shapes))}")
    kept = ~np.logical_or.reduce([masked.any(axis=tuple(range(1, masked.ndim))) for _, masked in parts])
    return [given[kept] for given, _ in parts]


def vector(name: str, value: Any, shape: str) -> Floats:
    """(n,); with axes of length 1 beside the one it has."""
    given = array(name, value, shape)
    if given.size and max(given.shape, default=1) != given.size:
        raise InputError(f"{name}: expected {shape}; got an array of shape {given.shape}")
    return given.ravel()


def poses(name: str, value: Any) -> Floats:
    """(N, 3)"""
    wanted = "an array of shape (N, 3): x, y and heading of each rod"
    given = array(name, value, wanted, finite=True)
    if given.ndim != 2 or given.shape[1] != 3:
        raise InputError(f"{name}: expected {wanted}; got one of shape {given.shape}")
    return given


def _split(name: str, value: Any, shape: str) -> tuple[Floats, NDArray[np.bool_]]:
    """Numbers, and where they are masked; what lies below a mask may be anything."""
    try:
        has_mask = _has_mask(value)
        given = np.asarray(_bare(value) if has_mask else value)
        masked = _mask(value) if has_mask else np.broadcast_to(np.False_, given.shape)
    except (ValueError, RecursionError) as error:
        raise InputError(f"{name}: expected {shape}, not {shown(value)}: {error}") from error
    if given.dtype.kind == "O":  # fractions, whole numbers beyond 64 bits
        floats = [0.0 if hidden else _as_float(one) for one, hidden in zip(given.flat, masked.flat)]
        given = given if None in floats else np.array(floats, dtype=float).reshape(given.shape)
    if given.dtype.kind not in "iuf":
        raise InputError(f"{name}: expected {shape}, not {shown(value) if given.dtype.kind == 'O' else f'{given.dtype.name} ({shown(value)})'}")
    return given.astype(float, copy=False), masked


def _has_mask(value: Any) -> bool:
    """Also of lists of masked arrays, whose masks NumPy drops."""
    return isinstance(value, np.ma.MaskedArray) or (isinstance(value, (list, tuple)) and any(map(_has_mask, value)))


def _bare(value: Any) -> Any:
    return [_bare(one) for one in value] if isinstance(value, (list, tuple)) else _ma.getdata(value)


def _mask(value: Any) -> NDArray[np.bool_]:
    found: NDArray[np.bool_] = np.array([_mask(one) for one in value]) if isinstance(value, (list, tuple)) else _ma.getmaskarray(value)
    return found


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
