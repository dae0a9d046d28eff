"""The files of a fit: fit.json and its tables. An error or bound of null is infinite, a sigma of 0 unknown: nan here."""

import math
from typing import NamedTuple

import numpy as np

from . import files

FILE = "fit.json"
MODELS = "models.json"
RISE_95 = 3.841459  # of chi2 of one parameter


class Parameter(NamedTuple):
    name: str
    value: float
    error: float  # the whole one; inf: the data do not fix it; nan: it has none, being fixed, tied or at a bound
    low: float    # 95 % interval
    high: float
    free: bool
    fixed: bool
    tied_to: str
    at_bound: str  # "", "lower", "upper"
    unit: str
    start: float
    bounds: tuple  # of floats, infinite without a bound
    log: bool
    curvature: float  # the part of the error that follows from the noise of the data


class Points(NamedTuple):
    x: np.ndarray
    value: np.ndarray
    sigma: np.ndarray  # nan: unknown
    model: np.ndarray
    used: np.ndarray   # false: left out of the fit


class Curve(NamedTuple):
    x: np.ndarray
    model: np.ndarray
    band: np.ndarray   # nan: unknown
    compared: list


class Map(NamedTuple):
    x: np.ndarray
    y: np.ndarray
    data: tuple        # U_x and U_y as [row y][column x]; nan: no data
    model: tuple
    used: np.ndarray   # false: left out of the fit


class FitResult:
    def __init__(self, folder):
        self.path = folder / FILE
        self.record = files.Record(self.path)
        # {name of a parameter: {curvature, held, masks, jackknife, total}}; empty without
        self.systematics = (self.record.get("systematics") or {}).get("errors") or {}
        with files.reading(self.path, "parameters or free"):
            self.parameters = {name: self._parameter(name, one) for name, one in self.record["parameters"].items()}
            self.free = [self.parameters[name] for name in self.record.get("free") or []]
        self.unit = str(self.record.get("length_unit") or "a")
        self.profiles, self.trajectories, self.maps, self.compared, self.starts, self.flat, self.remarks = (
            self.record.get(key) or [] for key in ("profiles", "trajectories", "maps", "compare", "starts", "flat", "remarks"))
        self.likelihood = self.record.get("likelihood") or {}
        self.misfit = self.record.get("misfit") or {}
        rivals = folder / MODELS
        self.weighed = files.Record(rivals) if rivals.is_file() else None

    @property
    def models(self):
        """Of models.json, the one with the most weight first; those whose fit failed last."""
        with files.reading(self.path.parent / MODELS, "models"):
            found = list(self.weighed["models"]) if self.weighed is not None else []
            return sorted(found, key=lambda one: -self.number(one, "weight", -1.0))

    @property
    def derived(self):
        """{name: (value, error, unit)}."""
        return {name: (self.number(one, "value"), self._whole(name, self.number(one, "stderr", math.inf)), str(one.get("unit") or ""))
                for name, one in (self.record.get("derived") or {}).items()}

    @property
    def correlation(self):
        """In the order of `free`."""
        with files.reading(self.path, "correlation"):
            return np.array(self.record.get("correlation") or [], dtype=float).reshape(len(self.free), len(self.free))

    def number(self, table, key, absent=math.nan):
        """A number of fit.json; `absent` for null or nothing."""
        value = table.get(key)
        with files.reading(self.path, key):
            return absent if value is None else float(value)

    def points(self, profile):
        x, value, sigma, model, used = self._columns(profile, "data", "x", "value", "sigma", "model", "used")
        return Points(x, value, np.where(sigma > 0, sigma, np.nan), model, used > 0)

    def curve(self, profile):
        names = ["x", "model", "band", *(f"compare_{index}" for index in range(len(self.compared)))]
        x, model, band, *compared = self._columns(profile, "curve", *names)
        return Curve(x, model, np.where(np.isfinite(band) & (band >= 0), band, np.nan), compared)

    def map(self, one):
        x, y, *rest, used = self._columns(one, "data", "x", "y", "Ux", "Uy", "model_Ux", "model_Uy", "used")
        columns, rows = np.unique(x), np.unique(y)
        with files.reading(self.path, f"the map {one.get('name', '')}"):
            Ux, Uy, model_x, model_y, used = (values.reshape(rows.size, columns.size) for values in (*rest, used))
        return Map(columns, rows, (Ux, Uy), (model_x, model_y), used > 0)

    def paths(self, trajectory):
        """t, data and model as [time][rod][x, y, theta]."""
        rods = int(self.number(trajectory, "rods"))
        names = [f"{name}{rod}" for rod in range(rods) for name in ("x", "y", "theta")]
        t, *rest = self._columns(trajectory, "data", "t", *names, *(f"model_{name}" for name in names))
        values = np.stack(rest, axis=-1).reshape(t.size, 2, rods, 3)
        return t, values[:, 0], values[:, 1]

    def _columns(self, record, key, *names):
        with files.reading(self.path, key):
            path = self.path.parent / record[key]
        return files.read_columns(path, *names)

    def _parameter(self, name, one):
        held = bool(one.get("at_bound")) or not one.get("free")
        low, high = (list(one.get("bounds") or []) + [None, None])[:2]
        value, curvature, log = float(one["value"]), self.number(one, "stderr", math.nan if held else math.inf), bool(one.get("log"))
        error = self._whole(name, curvature)
        ends = self.number(one, "low", -math.inf), self.number(one, "high", math.inf)
        return Parameter(name, value, error, *(interval(value, error, log) if error > curvature else ends), bool(one.get("free")),
                         bool(one.get("fixed")), str(one.get("tied_to") or ""), str(one.get("at_bound") or ""), str(one.get("unit") or ""),
                         self.number(one, "start"), (-math.inf if low is None else low, math.inf if high is None else high),
                         log, curvature)

    def _whole(self, name, curvature):
        """With what held constants, masks and runs add, where the fit knows it."""
        total = (self.systematics.get(name) or {}).get("total")
        return float(total) if isinstance(total, (int, float)) and math.isfinite(curvature) else curvature


def interval(value, error, log):
    """95 %, in the logarithm of what was searched there."""
    reach = math.sqrt(RISE_95) * error
    return (value * math.exp(-reach / value), value * math.exp(min(reach / value, 700.0))) if log and value > 0 else (value - reach, value + reach)
