"""The files of a granular run: summary.json, and for each run of an ensemble its tables and trajectories."""

import json
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from . import csv_columns, words
from .errors import PlotError
from .h5md import Trajectory

SUMMARY, TABLE, TRACKS = "summary.json", "table.csv", "tracks.csv"
TRAJECTORY, LAST_PERIOD = "trajectory.h5md", "last_period.h5md"


@dataclass(frozen=True)
class Track:
    """The rods of one run from t = 0 on; x, y, theta, speed are [time][rod], unwrapped, SI units."""
    path: Path
    t: np.ndarray
    x: np.ndarray
    y: np.ndarray
    theta: np.ndarray
    speed: np.ndarray


class GranularRun:
    def __init__(self, folder):
        self.folder = folder
        self.summary = self._summary(folder / SUMMARY)
        self.members = sorted(path for path in folder.glob("runs/*") if path.is_dir()) or [folder]
        self.a = self.number("bead_radius")
        self.phi_b = self.number("phi_b")
        self.box = np.broadcast_to(np.asarray(self.need("box"), dtype=float).ravel()[:2], 2)
        if not (self.a > 0 and np.all(self.box > 0)):
            raise PlotError(f"{folder / SUMMARY}: bead_radius {self.a} and box {self.box} must be positive")

    def _summary(self, path):
        try:
            found = json.loads(path.read_text(encoding="utf-8"))
        except ValueError as error:
            raise PlotError(f"{path}: not valid JSON: {error}") from error
        if not isinstance(found, dict):
            raise PlotError(f"{path}: not a JSON object")
        return found

    def need(self, key):
        if self.summary.get(key) is None:
            raise PlotError(f"{self.folder / SUMMARY}: {key} is missing")
        return self.summary[key]

    def number(self, key):
        value = self.need(key)
        if not isinstance(value, (int, float)) or isinstance(value, bool):
            raise PlotError(f'{self.folder / SUMMARY}: {key} is "{value}", not a number')
        return value

    @property
    def rods(self):
        return self.summary.get("rods") or []

    @property
    def single(self):
        return len(self.members) == 1

    def holders(self, name):
        """The runs that have this file; trajectories may be kept for some runs of an ensemble only."""
        return [member for member in self.members if (member / name).is_file()]

    def has(self, name):
        return bool(self.holders(name))

    def trajectory(self, name):
        """That of the first run that has one."""
        return Trajectory((self.holders(name) or self.members)[0] / name)

    def stores_all_beads(self, name):
        """Whether frames hold every bead (granular.output.every_bead = 1). A file that cannot be read counts: drawing it says why."""
        try:
            with self.trajectory(name) as trajectory:
                return trajectory.holds_all_beads()
        except PlotError:
            return True

    def which(self, name):
        """Tells, for a caption, whose trajectory is drawn."""
        return "" if self.single else f"Run {words.escape(int_of(self.holders(name)[0].name))} of {len(self.members)}. "

    def tables(self):
        """(path, columns) of table.csv of each run."""
        paths = [member / TABLE for member in (self.holders(TABLE) or self.members)]
        found = [(path, csv_columns.read(path)) for path in paths]
        for path, columns in found:
            if csv_columns.column(path, columns, "t").size == 0:
                raise PlotError(f"{path}: holds no rows: nothing to draw")
        return found

    def tracks(self):
        return [track(member / TRACKS) for member in (self.holders(TRACKS) or self.members)]


def int_of(name):
    return name.lstrip("0") or name


def track(path):
    columns = csv_columns.read(path)
    t = csv_columns.column(path, columns, "t")
    if "x0" not in columns:
        raise PlotError(f"{path}: holds no rods: nothing to draw")
    kept = t >= -1e-9 * np.abs(t).max(initial=0.0)  # a first time of -1e-17 is 0
    if not kept.any():
        raise PlotError(f"{path}: holds no rows from t = 0 on: nothing to draw")
    rods = sum(f"x{rod}" in columns for rod in range(len(columns)))
    parts = (np.stack([csv_columns.column(path, columns, f"{name}{rod}")[kept] for rod in range(rods)], axis=-1)
             for name in ("x", "y", "theta", "speed"))
    return Track(path, t[kept], *parts)
