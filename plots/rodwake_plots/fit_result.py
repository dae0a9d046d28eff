"""The files of a fit: fit.json and its tables. An error or bound of null is infinite, a sigma of 0 unknown: nan here."""

import json
import math
from typing import NamedTuple

import numpy as np

from . import files, words
from .errors import PlotError

FILE = "fit.json"
RISE_95 = 3.841459  # of chi2 of one parameter


class Parameter(NamedTuple):
    name: str
    value: float
    error: float  # inf: the data do not fix it; nan: it has none, being fixed, tied or held by a bound
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
        try:
            self.told = json.loads(self.path.read_text(encoding="utf-8"))
        except ValueError as error:
            raise PlotError(f"{self.path}: not valid JSON: {error}") from error
        if not isinstance(self.told, dict):
            raise PlotError(f"{self.path}: not a JSON object")
        self.parameters = {name: self._parameter(name, one) for name, one in self._table("parameters").items()}
        if not self.parameters:
            raise PlotError(f"{self.path}: parameters is missing or empty")
        self.free = [self._known(name) for name in self._list("free")]
        self.unit = str(self.told.get("length_unit") or "a")

    @property
    def profiles(self):
        return self._tables("profiles")

    @property
    def trajectories(self):
        return self._tables("trajectories")

    @property
    def maps(self):
        return self._tables("maps")

    @property
    def systematics(self):
        """{name of a parameter: {curvature, held, masks, jackknife, total}}; nothing where none was asked for."""
        return dict(self._table("systematics").get("errors") or {})

    @property
    def compared(self):
        return self._tables("compare")

    @property
    def starts(self):
        return self._tables("starts")

    @property
    def flat(self):
        return self._tables("flat")

    @property
    def likelihood(self):
        return self._table("likelihood")

    @property
    def remarks(self):
        return [str(one) for one in self._list("remarks")]

    @property
    def derived(self):
        """{name: (value, error, unit)}."""
        return {name: (self.number(one, "value"), self.number(one, "stderr", math.inf), str(one.get("unit") or ""))
                for name, one in self._table("derived").items()}

    @property
    def correlation(self):
        """In the order of `free`."""
        count = len(self.free)
        try:
            matrix = np.array(self._list("correlation"), dtype=float)
        except (TypeError, ValueError) as error:
            raise PlotError(f"{self.path}: correlation is not a matrix of numbers") from error
        if count and matrix.shape != (count, count):
            raise PlotError(f"{self.path}: correlation has shape {matrix.shape}, expected {(count, count)}")
        return matrix

    def number(self, table, key, absent=math.nan):
        """A number of fit.json; `absent` for null or nothing."""
        value = table.get(key)
        if value is None:
            return absent
        if not words.is_number(value):
            raise PlotError(f'{self.path}: {key} is "{value}", not a number')
        return float(value)

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
        if columns.size * rows.size != x.size:
            raise PlotError(f"{self.path}: the map {one.get('name', '')} is not a full grid")
        Ux, Uy, model_x, model_y, used = (values.reshape(rows.size, columns.size) for values in (*rest, used))
        return Map(columns, rows, (Ux, Uy), (model_x, model_y), used > 0)

    def paths(self, trajectory):
        """t, data and model as [time][rod][x, y, theta]."""
        rods = int(self.number(trajectory, "rods", 0))
        if rods < 1:
            raise PlotError(f"{self.path}: a trajectory without rods")
        names = [f"{name}{rod}" for rod in range(rods) for name in ("x", "y", "theta")]
        t, *rest = self._columns(trajectory, "data", "t", *names, *(f"model_{name}" for name in names))
        values = np.stack(rest, axis=-1).reshape(t.size, 2, rods, 3)
        return t, values[:, 0], values[:, 1]

    def _columns(self, record, key, *names):
        if not isinstance(record.get(key), str):
            raise PlotError(f"{self.path}: {key} of {record.get('name', 'a profile')} is missing")
        path = self.path.parent / record[key]
        found = files.read_csv_with_gaps(path)
        columns = [files.csv_column(path, found, name) for name in names]
        if columns[0].size == 0:
            raise PlotError(f"{path}: holds no rows: nothing to draw")
        return columns

    def _parameter(self, name, one):
        if not isinstance(one, dict) or one.get("value") is None:
            raise PlotError(f"{self.path}: parameters.{name} has no value")
        held = bool(one.get("at_bound")) or not one.get("free")
        low, high = (list(one.get("bounds") or []) + [None, None])[:2]
        return Parameter(name, self.number(one, "value"), self.number(one, "stderr", math.nan if held else math.inf),
                         self.number(one, "low", -math.inf), self.number(one, "high", math.inf), bool(one.get("free")),
                         bool(one.get("fixed")), str(one.get("tied_to") or ""), str(one.get("at_bound") or ""), str(one.get("unit") or ""),
                         self.number(one, "start"), (-math.inf if low is None else low, math.inf if high is None else high),
                         bool(one.get("log")))

    def _known(self, name):
        if name not in self.parameters:
            raise PlotError(f'{self.path}: free names "{name}", which is not in parameters')
        return self.parameters[name]

    def _table(self, key):
        return self._of(dict, key, "table")

    def _list(self, key):
        return self._of(list, key, "list")

    def _tables(self, key):
        found = self._list(key)
        if not all(isinstance(one, dict) for one in found):
            raise PlotError(f"{self.path}: {key} is not a list of tables")
        return found

    def _of(self, kind, key, name):
        found = self.told.get(key)
        if found is None:
            return kind()
        if not isinstance(found, kind):
            raise PlotError(f"{self.path}: {key} is not a {name}")
        return found
