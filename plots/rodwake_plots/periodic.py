"""Drawing in a periodic box: discs that stick out of an edge and paths that leave through one."""

import numpy as np


def images(x, reach, side, window):
    """(x, index) of every copy, `side` apart, of a disc of radius `reach` that shows in the window along one axis."""
    turns = np.arange(np.floor((window[0] - np.max(reach, initial=0)) / side), np.ceil((window[1] + np.max(reach, initial=0)) / side) + 1)
    copies = (x % side)[:, None] + turns * side
    seen = (copies > window[0] - reach[:, None]) & (copies < window[1] + reach[:, None])
    return copies[seen], np.nonzero(seen)[0]


def with_images(points, reach, box, window):
    """(points [n][2], index) of every periodic copy that shows in the window ((x0, x1), (y0, y1))."""
    x, index = images(points[:, 0], reach, box[0], window[0])
    y, again = images(points[index, 1], reach[index], box[1], window[1])
    return np.column_stack([x[again], y]), index[again]


def wrapped_path(x, y, box):
    """The path [n][2] inside the box: cut where it crosses an edge (a nan between the pieces), drawn up to the edge."""
    points = np.stack([x, y], axis=-1) / box
    if len(points) < 2:
        return points % 1 * box
    at = np.union1d(np.arange(len(points)), crossings(points))
    fine = np.stack([np.interp(at, np.arange(len(points)), part) for part in points.T], axis=-1)
    cell = np.floor((fine[:-1] + fine[1:]) / 2)
    pieces = np.stack([fine[:-1] - cell, fine[1:] - cell, np.full_like(cell, np.nan)], axis=1)
    follows = np.all(cell[1:] == cell[:-1], axis=1)
    kept = np.ones((len(cell), 3), dtype=bool)
    kept[:-1, 2] = ~follows
    kept[1:, 0] = ~follows
    kept[-1, 2] = False
    return pieces[kept] * box


def crossings(points):
    """Where, counted in points and parts of the way to the next, the path meets a line x or y = whole number."""
    found = [np.empty(0)]
    for part in points.T:
        low, high = np.minimum(part[:-1], part[1:]), np.maximum(part[:-1], part[1:])
        for k in np.flatnonzero(np.floor(high) > np.floor(low)):
            lines = np.arange(np.floor(low[k]) + 1, np.floor(high[k]) + 1)
            found.append(k + (lines - part[k]) / (part[k + 1] - part[k]))
    return np.concatenate(found)
