"""result.h5 behind plain Python types. Whatever is missing is named with its full place in the file."""

from dataclasses import dataclass, replace

import numpy as np

from . import hdf5
from .errors import MissingError, PlotError
from .units import Units

SCHEMA = 1


@dataclass(frozen=True)
class Cut:
    along: str  # "x" or "y": the coordinate that varies
    at: float   # the other coordinate
    s: np.ndarray
    Ux: np.ndarray
    Uy: np.ndarray


@dataclass(frozen=True)
class Run:
    """One integration of the rods; x, y, theta are [time][rod]; samples of a measured field's errors [sample][time][rod]."""
    name: str
    label: str
    outcome: str
    attrs: dict
    t: np.ndarray
    x: np.ndarray
    y: np.ndarray
    theta: np.ndarray
    samples: tuple = ()  # x and y of them; NaN where one has ended


TOLD = "kappa", "gamma1", "gamma2", "alpha", "eta"  # what runs differ in, in this order


def told_apart(run, runs, units):
    """The parameters in which the runs differ, as a label for a run that has none."""
    differing = [key for key in TOLD if len({one.attrs.get(key) for one in runs}) > 1]
    return ", ".join(f"${units.parameter(key, run.attrs[key])}$" for key in differing if key in run.attrs) or "as written"


def plain(value):
    """HDF5 strings arrive as bytes or str, scalars as numpy types."""
    if isinstance(value, bytes):
        return value.decode("utf-8", errors="replace")
    return value.item() if isinstance(value, (np.generic, np.ndarray)) and np.size(value) == 1 else value


class Result:
    def __init__(self, path):
        self.path = path
        self.file = hdf5.open_file(path)
        self._check_schema()
        self.units = Units(self.attribute("/", "units"))
        self.title = self.attribute("/", "title", "")
        self.version = self.attribute("/", "rodwake_version", "unknown")

    def _check_schema(self):
        schema = self.attribute("/", "schema")
        if schema != SCHEMA:
            raise PlotError(f"{self.path}: schema {schema}, this program reads schema {SCHEMA}")

    def close(self):
        self.file.close()

    def has(self, place):
        return place in self.file

    def attributes(self, place):
        if not self.has(place):
            return {}
        return {key: plain(value) for key, value in self.file[place].attrs.items()}

    def attribute(self, place, name, *default):
        found = self.attributes(place)
        if name in found:
            return found[name]
        if default:
            return default[0]
        raise PlotError(f"{self.path}: attribute {name} of {place} is missing")

    def error(self, place, why):
        """For what is missing: of a group that is there it is lost, else it was not computed."""
        lost = place.rsplit("/", 1)[0] in self.file
        return PlotError(f"{self.path}: {why}") if lost else MissingError(self.path, why)

    def data(self, place):
        if not self.has(place):
            raise self.error(place, f"dataset {place} is missing")
        return np.asarray(self.file[place][()], dtype=float)

    def grid(self, name):
        """A dataset of /field/grid, checked against the axes."""
        values = self.data(f"/field/grid/{name}")
        if name not in ("x", "y"):
            shape = (self.data("/field/grid/y").size, self.data("/field/grid/x").size)
            if values.shape != shape:
                raise PlotError(f"{self.path}: /field/grid/{name} has shape {values.shape}, expected {shape}")
        return values

    def cut_count(self):
        return len(self.file["/field/cuts"]) if self.has("/field/cuts") else 0

    def cut(self, index):
        place = f"/field/cuts/{index}"
        if not self.has(place):
            raise self.error(place, f"{place} is missing (the file holds {self.cut_count()} cuts)")
        along, at = self.attribute(place, "along"), self.attribute(place, "at")
        if along not in ("x", "y"):
            raise PlotError(f'{self.path}: along of {place} is "{along}", neither x nor y')
        return Cut(along, at, *(self.data(f"{place}/{name}") for name in ("s", "Ux", "Uy")))

    def runs(self):
        """Every run of the rods, in legend order."""
        if not self.has("/rods"):
            return []
        names = sorted(self.file["/rods"], key=lambda name: self.attribute(f"/rods/{name}", "order", 0))
        runs = [self.run(name) for name in names]
        return [replace(run, label=run.label or told_apart(run, runs, self.units)) for run in runs]

    def run(self, name):
        place = f"/rods/{name}"
        t, x, y, theta = (self.data(f"{place}/{part}") for part in ("t", "x", "y", "theta"))
        if not (x.shape == y.shape == theta.shape and x.ndim == 2 and len(x) == len(t) > 0):
            raise PlotError(f"{self.path}: {place} holds x, y, theta of unequal or empty shape")
        label = self.attribute(place, "label", "") or ("" if name == "scene" else name)
        samples = tuple(self.data(f"{place}/ensemble/{part}") for part in "xy") if self.has(f"{place}/ensemble") else ()
        return Run(name, label, self.attribute(place, "outcome"), self.attributes(place), t, x, y, theta, samples)
