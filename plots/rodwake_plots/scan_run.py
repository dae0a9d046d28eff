"""The files of a scan: scan.json, scan.csv, and where they are there cells.csv, boundary.csv and the trajectories of scan.h5."""

import json
from functools import cached_property
from typing import NamedTuple

import numpy as np

from . import csv_columns, hdf5, scan_axis
from .errors import PlotError

TOLD, POINTS, CELLS, BOUNDARY, SAMPLES = "scan.json", "scan.csv", "cells.csv", "boundary.csv", "scan.h5"
OUTCOMES = ("contact", "pursuit", "escape", "undecided", "finished")  # the last of beds without a pair
CAPTURED = ("contact", "pursuit")
MIXED = "mixed"


class Curve(NamedTuple):
    """A piece of a boundary: places [point][axis] in numbers of the file."""
    between: str
    places: np.ndarray
    error: np.ndarray  # in fractions of the axis


class Samples(NamedTuple):
    """Stored trajectories: rows of scan.csv, t[sample][time], x, y, theta [sample][time][rod]."""
    point: np.ndarray
    t: np.ndarray
    x: np.ndarray
    y: np.ndarray
    theta: np.ndarray


class ScanRun:
    def __init__(self, folder):
        self.folder = folder
        self.told = self._told(folder / TOLD)
        self.axes = [scan_axis.from_json(axis, folder / TOLD, self.told.get("bead_radius")) for axis in self.need("axes")]
        if not self.axes:
            raise PlotError(f"{folder / TOLD}: a scan without axes")

    def _told(self, path):
        try:
            found = json.loads(path.read_text(encoding="utf-8"))
        except ValueError as error:
            raise PlotError(f"{path}: not valid JSON: {error}") from error
        if not isinstance(found, dict):
            raise PlotError(f"{path}: not a JSON object")
        return found

    def need(self, key):
        if self.told.get(key) is None:
            raise PlotError(f"{self.folder / TOLD}: {key} is missing")
        return self.told[key]

    @property
    def design(self):
        return str(self.need("design"))

    @property
    def of_beds(self):
        """Points are granular runs; scan.csv has their means, lengths in a and times in s."""
        return self.told.get("subject") == "beds"

    @property
    def runs(self):
        """Of each point; 1 where points are not repeated."""
        return int(self.told.get("runs") or 1)

    def runs_that_end(self, outcome):
        """Of all points, of those that did not fail."""
        return int((self.told.get("outcomes") or {}).get(outcome) or 0)

    @property
    def path(self):
        return self.folder / POINTS

    @cached_property
    def columns(self):
        """{name: numbers, or a list of words}, in the order of the file."""
        choices = [axis.key for axis in self.axes if axis.is_choice]
        names = dict.fromkeys(csv_columns.parts(self.path)[0])
        for name in (*(axis.key for axis in self.axes), "outcome", "status"):
            csv_columns.column(self.path, names, name)
        found = csv_columns.read_with_gaps(self.path, text=("outcome", "status", *choices))
        if not found["outcome"]:
            raise PlotError(f"{self.path}: holds no points: nothing to draw")
        return found

    def numbers(self, name):
        """A column of numbers; what it holds of failed points too."""
        values = csv_columns.column(self.path, self.columns, name)
        if isinstance(values, list):
            raise PlotError(f"{self.path}: column {name} holds words, not numbers")
        return values

    @cached_property
    def outcome(self):
        """Index into OUTCOMES; -1: none."""
        return self._coded(self.columns["outcome"], OUTCOMES, "outcome")

    def _coded(self, cells, names, column):
        code = {name: index for index, name in enumerate(names)} | {"": -1}
        try:
            return np.array([code[cell] for cell in cells], dtype=np.int8)
        except KeyError as error:
            raise PlotError(f"{self.path}: {column} {error} is none of {', '.join(names)}") from error

    @cached_property
    def failed(self):
        return np.array([status != "ok" for status in self.columns["status"]])

    def place(self, index):
        """Numbers of an axis, a row a point; of a choice the index of the word."""
        axis = self.axes[index]
        return self._coded(self.columns[axis.key], axis.values, axis.key).astype(float) if axis.is_choice else self.numbers(axis.key)

    @cached_property
    def places(self):
        """[point][axis], in coordinates in which the axes are even."""
        return np.stack([axis.even(self.place(index)) for index, axis in enumerate(self.axes)], axis=-1)

    @cached_property
    def boundary(self):
        """Curves in their order; none without the file."""
        path = self.folder / BOUNDARY
        if not path.is_file():
            return []
        found = csv_columns.read_with_gaps(path, text=("between",))
        keys = [csv_columns.column(path, found, axis.key) for axis in self.axes]
        curve, error = csv_columns.column(path, found, "curve"), found.get("error", np.empty(0))
        rows = [np.flatnonzero(curve == one) for one in np.unique(curve)]
        return [Curve(found["between"][row[0]], np.stack([key[row] for key in keys], axis=-1), error[row] if error.size else error)
                for row in rows]

    @property
    def has_cells(self):
        return self.design == "adaptive" and (self.folder / CELLS).is_file()

    @cached_property
    def cells(self):
        """(lows, highs) [cell][axis] in even coordinates, outcomes (index; -1: mixed, or none)."""
        path = self.folder / CELLS
        found = csv_columns.read_with_gaps(path, text=("outcome",))
        sides = [np.stack([axis.even(csv_columns.column(path, found, f"{axis.key}_{end}")) for axis in self.axes], axis=-1)
                 for end in ("from", "to")]
        names = csv_columns.column(path, found, "outcome")
        lows, highs = np.minimum(*sides), np.maximum(*sides)  # an axis may run downwards
        return lows, highs, np.array([OUTCOMES.index(name) if name in OUTCOMES else -1 for name in names], dtype=np.int8)

    @cached_property
    def samples(self):
        """None where no trajectories were stored."""
        path = self.folder / SAMPLES
        if not path.is_file():
            return None
        with hdf5.open_file(path) as file:
            if "trajectories" not in file or not len(file["trajectories"]):
                return None
            point, *parts = (np.asarray(hdf5.dataset(file, f"trajectories/{name}")) for name in Samples._fields)
        found = Samples(point.astype(np.int64), *(part.astype(float) for part in parts))
        count = len(found.point)
        if not (found.t.shape[:1] == (count,) and found.t.ndim == 2 and all(
                part.shape[:2] == found.t.shape and part.ndim == 3 and part.shape == found.x.shape for part in found[2:])):
            raise PlotError(f"{path}: /trajectories holds datasets of unequal shape")
        if count and not (0 <= found.point.min() and found.point.max() < len(self.failed)):
            raise PlotError(f"{path}: /trajectories/point names a row that {POINTS} does not have")
        return found if count else None
