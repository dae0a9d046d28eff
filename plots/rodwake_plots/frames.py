"""trajectory.h5md and last_period.h5md behind plain arrays: beads and rods of one frame, SI units."""

from dataclasses import dataclass

import numpy as np

from . import files
from .errors import PlotError

BEAD = 0  # of species; 1: a sphere of a rod
GROUP, RODS = "particles/trajectory", "particles/trajectory_rods"


@dataclass(frozen=True)
class Rod:
    axis: np.ndarray     # unit vector from the thick to the thin end
    spheres: np.ndarray  # [sphere][3], whole: not cut by the edges of the box
    radii: np.ndarray

    @property
    def tapers(self):
        """Whether its ends differ: an apolar rod has no thin end to point at."""
        along = np.argsort(self.spheres @ self.axis)
        return abs(self.radii[along[0]] - self.radii[along[-1]]) > 1e-6 * self.radii.max()

    @property
    def tip(self):
        ends = self.spheres + self.radii[:, None] * self.axis
        return ends[np.argmax(ends @ self.axis)]


@dataclass(frozen=True)
class Frame:
    time: float
    box: np.ndarray       # sides in x and y of the periodic box; with a wall twice those around it, so that nothing has images
    beads: np.ndarray     # [bead][3], x and y inside the box
    velocity: np.ndarray  # of the beads
    radii: np.ndarray     # of the beads
    rods: tuple


class Trajectory:
    """Open for as long as the `with` block lasts."""

    def __init__(self, path):
        self.path = path
        self.file = files.open_hdf5(path)
        try:
            self._read()
        except Exception:
            self.file.close()
            raise

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.file.close()

    def _read(self):
        self.time = np.asarray(files.dataset(self.file, f"{GROUP}/position/time"), dtype=float)
        self.frames = len(files.dataset(self.file, f"{GROUP}/position/value"))
        if self.frames == 0 or len(self.time) != self.frames:
            raise PlotError(f"{self.path}: holds {self.frames} frames at {len(self.time)} times: nothing to draw")
        self.species = np.asarray(files.dataset(self.file, f"{GROUP}/species"))
        self.radius = np.asarray(files.dataset(self.file, f"{GROUP}/radius"), dtype=float)
        boundary = self.file[f"{GROUP}/box"].attrs.get("boundary", []) if f"{GROUP}/box" in self.file else []
        self.images = 2 if any(part in (b"none", "none") for part in list(boundary)[:2]) else 1  # with a wall the nearest image is the thing itself

    def holds_all_beads(self):
        """Beads are numbered from 0 on; files of others need not number them."""
        number = self.file.get(f"{GROUP}/id/value")
        beads = self.species == 0
        return number is None or not beads.any() or int(np.asarray(number[0])[beads].max()) + 1 == np.count_nonzero(beads)

    def parameter(self, name):
        return files.parameter(self.file, name)

    def _value(self, place, index):
        return np.asarray(files.dataset(self.file, place)[index], dtype=float)

    def index(self, frame):
        """Frames are numbered from 0, or from the end as -1, -2, ..."""
        if not -self.frames <= frame < self.frames:
            raise PlotError(f"{self.path}: holds frames 0 to {self.frames - 1}, not frame {frame}; -1 is the last")
        return frame % self.frames

    def frame(self, number):
        at = self.index(number)
        with files.reading(self.path, f"frame {number}"):
            box = box_sides(self._value(f"{GROUP}/box/edges/value", at)) * self.images
            position, velocity = (self._value(f"{GROUP}/{name}/value", at) for name in ("position", "velocity"))
            bead = self.species == BEAD
            rods = self._rods(at, position[~bead], self.radius[~bead], box) if not bead.all() else ()
            return Frame(float(self.time[at]), box, position[bead], velocity[bead], self.radius[bead], rods)

    def _rods(self, at, spheres, radii, box):
        owner = self.parameter("rod_of_sphere")
        centres = self._value(f"{RODS}/position/value", at)
        axes = body_axis(self._value(f"{RODS}/orientation/value", at))
        return tuple(Rod(axis, whole(spheres[owner == rod], centre, box), radii[owner == rod])
                     for rod, (centre, axis) in enumerate(zip(centres, axes)))


def box_sides(edges):
    """Of the box in x and y, from the three lengths or the matrix of edge vectors that H5MD allows."""
    return (np.diag(edges) if edges.ndim == 2 else edges)[:2]


def whole(spheres, centre, box):
    """The images of the spheres that are nearest to the rod's centre, taken into the box as one piece."""
    away = spheres - centre
    away[:, :2] -= box * np.round(away[:, :2] / box)
    home = centre.copy()
    home[:2] -= box * np.floor(home[:2] / box)
    return home + away


def body_axis(quaternion):
    """The body's x axis in the world; quaternions [rod][w, x, y, z]."""
    w, x, y, z = np.moveaxis(quaternion / np.linalg.norm(quaternion, axis=-1, keepdims=True), -1, 0)
    return np.stack([1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)], axis=-1)


# Drawing in a periodic box: discs that stick out of an edge and paths that leave through one.

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


# Sixfold bond order of the beads as seen from above.

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
