"""trajectory.h5md and last_period.h5md behind plain arrays: beads and rods of one frame, SI units."""

from dataclasses import dataclass

import numpy as np

from . import hdf5
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
    box: np.ndarray       # sides in x and y
    beads: np.ndarray     # [bead][3], x and y inside the box
    velocity: np.ndarray  # of the beads
    radii: np.ndarray     # of the beads
    rods: tuple


class Trajectory:
    """Open for as long as the `with` block lasts."""

    def __init__(self, path):
        self.path = path
        self.file = hdf5.open_file(path)
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
        self.time = np.asarray(hdf5.dataset(self.file, f"{GROUP}/position/time"), dtype=float)
        self.frames = len(hdf5.dataset(self.file, f"{GROUP}/position/value"))
        if self.frames == 0 or len(self.time) != self.frames:
            raise PlotError(f"{self.path}: holds {self.frames} frames at {len(self.time)} times: nothing to draw")
        self.species = np.asarray(hdf5.dataset(self.file, f"{GROUP}/species"))
        self.radius = np.asarray(hdf5.dataset(self.file, f"{GROUP}/radius"), dtype=float)
        shape, count = hdf5.dataset(self.file, f"{GROUP}/position/value").shape, self.species.size
        if shape[1:] != (count, 3) or self.radius.shape != (count,):
            raise PlotError(f"{self.path}: position, species and radius are of {shape[1:]}, {count} and "
                            f"{self.radius.size} particles; expected [particle][3] and one number each")

    def holds_all_beads(self):
        """Beads are numbered from 0 on; files of others need not number them."""
        number = self.file.get(f"{GROUP}/id/value")
        beads = self.species == 0
        return number is None or not beads.any() or int(np.asarray(number[0])[beads].max()) + 1 == np.count_nonzero(beads)

    def parameter(self, name):
        return hdf5.parameter(self.file, name)

    def _value(self, place, index):
        return np.asarray(hdf5.dataset(self.file, place)[index], dtype=float)

    def index(self, frame):
        """Frames are numbered from 0, or from the end as -1, -2, ..."""
        if not -self.frames <= frame < self.frames:
            raise PlotError(f"{self.path}: holds frames 0 to {self.frames - 1}, not frame {frame}; -1 is the last")
        return frame % self.frames

    def frame(self, number):
        at = self.index(number)
        box = sides(self._value(f"{GROUP}/box/edges/value", at))
        position, velocity = (self._value(f"{GROUP}/{name}/value", at) for name in ("position", "velocity"))
        bead = self.species == BEAD
        rods = self._rods(at, position[~bead], self.radius[~bead], box) if not bead.all() else ()
        return Frame(float(self.time[at]), box, position[bead], velocity[bead], self.radius[bead], rods)

    def _rods(self, at, spheres, radii, box):
        owner = self.parameter("rod_of_sphere")
        centres = self._value(f"{RODS}/position/value", at)
        axes = body_axis(self._value(f"{RODS}/orientation/value", at))
        if owner.shape != radii.shape or owner.max() >= len(centres):
            raise PlotError(f"{self.path}: /parameters/rod_of_sphere does not tell the rods of its {radii.size} spheres")
        return tuple(Rod(axis, whole(spheres[owner == rod], centre, box), radii[owner == rod])
                     for rod, (centre, axis) in enumerate(zip(centres, axes)))


def sides(edges):
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
