"""Which points of a scan a panel shows: all of two axes, those at a value of the third."""

from typing import NamedTuple

import numpy as np

PANELS = 4


class Slice(NamedTuple):
    rows: np.ndarray  # of points
    at: float         # place on the third axis, even coordinates; nan: there is none
    title: str        # mathtext
    html: str


def slices(scan, asked=()):
    """A Slice for each panel."""
    if len(scan.axes) < 3:
        return [Slice(np.ones(len(scan.failed), dtype=bool), np.nan, "", "")]
    axis, places = scan.axes[2], scan.places[:, 2]
    there = np.unique(places)
    at = wanted(scan, axis, there, asked)
    others = at_middle(scan)
    values = axis.back(at)
    return [Slice(others & near(scan, places, one, at), one, axis.equals(value), axis.equals_html(value)) for one, value in zip(at, values)]


def wanted(scan, axis, there, asked):
    """Places of the panels: as asked for or spread over the axis; of a grid and of choices places that it has."""
    if len(asked):
        at = axis.even(np.asarray(asked, dtype=float))
    elif len(there) <= PANELS:
        at = there
    elif scan.design in ("grid", "adaptive"):
        at = np.linspace(there[0], there[-1], PANELS)
    else:  # in the middles of slabs that share the axis
        at = axis.even(axis.low) + (np.arange(PANELS) + 0.5) / PANELS * axis.span
    if scan.design == "grid" or axis.is_choice:
        at = there[np.abs(there[:, None] - at).argmin(axis=0)]
    return list(dict.fromkeys(at.tolist()))


def near(scan, places, one, at):
    """Points of this slice: those there, and of scattered points those up to half-way to the next slice."""
    if scan.design in ("grid", "adaptive") or scan.axes[2].is_choice:
        return np.abs(places - one) <= 1e-9 * scan.axes[2].span
    return np.abs(places - one) <= thickness(scan, at) / 2


def thickness(scan, at):
    """Of the slab of scattered points that a panel shows, in even coordinates."""
    return np.diff(sorted(at)).min() if len(at) > 1 else scan.axes[2].span / PANELS


def at_middle(scan):
    """A fourth axis and further ones stay at their middle values, where points share values."""
    kept = np.ones(len(scan.failed), dtype=bool)
    for index in range(3, len(scan.axes)):
        there = np.unique(scan.places[:, index])
        if scan.design == "grid" or scan.axes[index].is_choice:
            kept &= scan.places[:, index] == there[len(there) // 2]
    return kept


def fixed(scan):
    """(axis, its middle value) of the axes that at_middle holds."""
    for index in range(3, len(scan.axes)):
        there = np.unique(scan.places[:, index])
        if scan.design == "grid" or scan.axes[index].is_choice:
            yield scan.axes[index], float(scan.axes[index].back(there[len(there) // 2]))
