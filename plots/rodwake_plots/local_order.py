"""Sixfold bond order of the beads as seen from above.

psi6 of a bead is the mean of exp(6 i angle) over the beads nearer than the cut-off, in the periodic box; 0 without any.
"""

import numpy as np


def psi6(points, box, cutoff):
    """Complex psi6 of each point; points [N][2] anywhere, box [2]."""
    points = np.asarray(points, dtype=float) % box
    sums, counts = np.zeros(len(points), dtype=complex), np.zeros(len(points))
    for others in candidates(points, box, cutoff):
        away = points[others] - points
        away -= box * np.round(away / box)
        square = (away**2).sum(axis=1)
        near = (others >= 0) & (others != np.arange(len(points))) & (square < cutoff**2) & (square > 0)
        bond = np.where(near, (away[:, 0] + 1j * away[:, 1]) / np.sqrt(np.where(near, square, 1.0)), 0)
        sums, counts = sums + bond**6, counts + near
    return sums / np.maximum(counts, 1)


def candidates(points, box, cutoff):
    """Arrays that name for each point one other point, or -1; together they hold all points within the cut-off."""
    cells = np.floor(box / cutoff).astype(int)
    if cells.min() < 3 or len(points) < 10:
        yield from (np.roll(np.arange(len(points)), shift) for shift in range(1, len(points)))
        return
    cell = np.minimum((points / box * cells).astype(int), cells - 1)
    members = occupants(cell[:, 0] * cells[1] + cell[:, 1], cells.prod())
    for step in np.ndindex(3, 3):
        beside = (cell + step - 1) % cells
        yield from members[beside[:, 0] * cells[1] + beside[:, 1]].T


def occupants(cell, count):
    """[cell][place] -> point, or -1."""
    order = np.argsort(cell, kind="stable")
    held = np.bincount(cell, minlength=count)
    place = np.arange(cell.size) - np.repeat(np.cumsum(held) - held, held)
    table = np.full((count, held.max(initial=0)), -1)
    table[cell[order], place] = order
    return table
