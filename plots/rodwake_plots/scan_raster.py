"""Leaves of a refinement, and points of a grid, as pictures over two axes of a scan; even coordinates throughout."""

from typing import NamedTuple

import numpy as np

from .errors import PlotError

ON_LATTICE = 1e-4  # a point this near to a corner (in finest cells) is the corner: numbers of files have 17 digits
JUMP = 0.4         # of the colour map: numbers that differ by more over a cell have jumped, and are not joined
LARGEST = 2048     # pixels a side: three times what a figure has


class Picture(NamedTuple):
    """codes and values are [row along the second axis][column along the first]."""
    extent: tuple      # left, right, bottom, top
    codes: np.ndarray  # outcomes; -1: none
    values: np.ndarray  # nan: none


class Lattice:
    """The finest cells of a refinement: places become whole numbers."""

    def __init__(self, lows, highs):
        self.origin = lows.min(axis=0)
        self.size = (highs - lows).min(axis=0)
        self.count = np.rint((highs.max(axis=0) - self.origin) / self.size).astype(np.int64)

    def number(self, places):
        """Nearest lattice places, and how far off they are at most."""
        exact = (places - self.origin) / self.size
        found = np.rint(exact).astype(np.int64)
        return found, np.abs(exact - found).max(axis=-1)

    def around(self, window):
        """First and last lattice places of the two axes that hold the window, inside the lattice."""
        ends = [(np.asarray(side) - self.origin[:2]) / self.size[:2] for side in zip(*window)]
        first = np.clip(np.floor(ends[0] + ON_LATTICE).astype(np.int64), 0, self.count[:2] - 1)
        return first, np.clip(np.ceil(ends[1] - ON_LATTICE).astype(np.int64), first + 1, self.count[:2])

    def flat(self, numbers):
        return np.ravel_multi_index(tuple(np.moveaxis(numbers, -1, 0)), tuple(self.count + 1), mode="clip")


class Leaves:
    """The leaves with the rows of the points at their corners."""

    def __init__(self, scan):
        lows, highs, self.outcome = scan.cells
        if not len(lows):
            raise PlotError(f"{scan.folder / 'cells.csv'}: holds no cells")
        self.lattice = Lattice(lows, highs)
        self.low, self.high = self.lattice.number(lows)[0], self.lattice.number(highs)[0]
        self.corners = self._corners(scan.places)

    def _corners(self, places):
        """[leaf][corner] rows of points, -1 where none stands there; bit i of a corner's number: at the upper end of axis i."""
        numbers, off = self.lattice.number(places)
        inside = (off < ON_LATTICE) & (numbers >= 0).all(axis=1) & (numbers <= self.lattice.count).all(axis=1)
        rows = np.flatnonzero(inside)
        flat, first = np.unique(self.lattice.flat(numbers[rows]), return_index=True)
        dimensions = self.low.shape[1]
        found = np.empty((len(self.low), 2 ** dimensions), dtype=np.int64)
        for corner in range(2 ** dimensions):
            at_upper = np.array([bool(corner >> axis & 1) for axis in range(dimensions)])
            wanted = self.lattice.flat(np.where(at_upper, self.high, self.low))
            place = np.minimum(np.searchsorted(flat, wanted), len(flat) - 1)
            found[:, corner] = np.where(flat[place] == wanted, rows[first[place]], -1) if len(flat) else -1
        return found

    def sliced(self, at):
        """At this place of the third axis: lows, highs, the four corner rows of the nearer and of the farther side, the weight of the
        farther, outcomes."""
        if self.low.shape[1] == 2:
            return self.low, self.high, self.corners, self.corners, 0.0, self.outcome
        place = np.clip((at - self.lattice.origin[2]) / self.lattice.size[2], 0, self.lattice.count[2] * (1 - 1e-12))
        here = (self.low[:, 2] <= place) & (place < self.high[:, 2])
        low, high, corners = self.low[here], self.high[here], self.corners[here]
        share = ((place - low[:, 2]) / (high[:, 2] - low[:, 2]))[:, None]
        near = np.where(share < 0.5, corners[:, :4], corners[:, 4:])
        far = np.where(share < 0.5, corners[:, 4:], corners[:, :4])
        return low[:, :2], high[:, :2], near, far, np.minimum(share, 1 - share), self.outcome[here]


def of_leaves(leaves, codes, values, window, at=None):
    """Outcomes by the nearest corner; numbers (0 to 1) between corners that are alike, else by the nearest corner too. The window is
    (low, high) of each axis, in even coordinates."""
    low, high, near, far, weight, outcome = leaves.sliced(at)
    first, last = leaves.lattice.around(window)
    seen = (low < last).all(axis=1) & (high > first).all(axis=1)
    low, high, near, far, outcome = (part[seen] for part in (low, high, near, far, outcome))
    at_corner = with_nothing(codes, -1)[near]
    at_corner = np.where(near < 0, outcome[:, None], at_corner)
    number = between(with_nothing(values, np.nan), near, far, weight if np.isscalar(weight) else weight[seen])
    alike = (at_corner == at_corner[:, :1]).all(axis=1) & (np.ptp(number, axis=1) <= JUMP)
    count = np.minimum(2 * (last - first), LARGEST)
    step = (last - first) / count
    picture = np.full(count[::-1], -1, dtype=np.int8), np.full(count[::-1], np.nan, dtype=np.float32)
    begin, end = (np.clip(np.ceil((side - first) / step - 0.5).astype(np.int64), 0, count) for side in (low, high))
    for extent in np.unique(end - begin, axis=0):
        of = np.flatnonzero((end - begin == extent).all(axis=1))
        if extent.all():
            share = [(first[axis] + (begin[of, axis, None] + np.arange(extent[axis]) + 0.5) * step[axis] - low[of, axis, None])
                     / (high - low)[of, axis, None] for axis in (0, 1)]
            paint(picture, begin[of], extent, share, at_corner[of], number[of], alike[of])
    ends = [leaves.lattice.origin[:2] + side * leaves.lattice.size[:2] for side in (first, last)]
    return Picture((ends[0][0], ends[1][0], ends[0][1], ends[1][1]), *picture)


def with_nothing(values, nothing):
    """So that row -1 is nothing."""
    return np.append(values, values.dtype.type(nothing))


def between(values, near, far, weight):
    """Numbers at the four corners of the slice; those of one side alone where the other is unlike."""
    one, other = values[near], values[far]
    mixed = one + weight * (other - one)
    return np.where(np.abs(other - one) <= JUMP, mixed, one)  # neither where it jumps nor towards nothing


def paint(picture, begin, extent, share, codes, numbers, alike):
    """Leaves that cover as many pixels across and up; `share` is how far along each its pixels are, [axis][leaf][pixel]."""
    column, row = (begin[:, axis, None] + np.arange(extent[axis]) for axis in (0, 1))
    place = row[:, :, None], column[:, None, :]
    x, y = share[0][:, None, :], share[1][:, :, None]
    nearest = (x > 0.5) + 2 * (y > 0.5)
    leaf = np.arange(len(codes))[:, None, None]
    picture[0][place] = codes[leaf, nearest]
    a, b, c, d = (numbers[:, corner, None, None] for corner in range(4))
    smooth = (a * (1 - x) + b * x) * (1 - y) + (c * (1 - x) + d * x) * y
    picture[1][place] = np.where(alike[:, None, None], smooth, numbers[leaf, nearest])


class Grid(NamedTuple):
    """edges in even coordinates; codes and values as in a Picture."""
    x: np.ndarray
    y: np.ndarray
    codes: np.ndarray
    values: np.ndarray


def of_grid(places, codes, values):
    """Cells around the points of a grid, places[point][2]; a place without a point has neither outcome nor number."""
    (x, column), (y, row) = (steps(places[:, axis]) for axis in (0, 1))
    made = np.full((len(y), len(x)), -1, dtype=np.int8), np.full((len(y), len(x)), np.nan)
    made[0][row, column], made[1][row, column] = codes, values
    return Grid(edges(x), edges(y), *made)


def steps(places):
    """Distinct places in order, equal to rounding, and which of them each is."""
    found, number = np.unique(places, return_inverse=True)
    apart = np.concatenate([[True], np.diff(found) > 1e-9 * (np.ptp(found) or 1.0)])
    return found[apart], (np.cumsum(apart) - 1)[number]


def edges(places):
    """Half-way between the places, and as far outside the last ones."""
    if len(places) == 1:
        return np.array([places[0] - 0.5, places[0] + 0.5])
    middle = (places[1:] + places[:-1]) / 2
    return np.concatenate([[2 * places[0] - middle[0]], middle, [2 * places[-1] - middle[-1]]])
