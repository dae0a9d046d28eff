"""The files of a scan: scan.json, scan.csv, and where they are there cells.csv, boundary.csv and the trajectories of scan.h5."""

import html
import re
from dataclasses import dataclass, field
from functools import cached_property
from typing import NamedTuple

import numpy as np
from matplotlib.ticker import MaxNLocator, SymmetricalLogLocator

from . import canvas, errors, files, fit_words, schema, style, words
from .errors import PlotError

SUMMARY, POINTS, CELLS, BOUNDARY, SAMPLES = "scan.json", "scan.csv", "cells.csv", "boundary.csv", "scan.h5"
CRITICAL = "critical.csv"
OUTCOMES = ("contact", "pursuit", "escape", "undecided", "orbit", "bound", "finished")  # the last of beds without a pair
CAPTURED = ("contact", "pursuit", "orbit", "bound")
CERTIFICATES = ("verified", "checked", "open")  # how well an outcome is known


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
        self.record = files.Record(folder / SUMMARY)
        for key in ("certificates", "certified_area"):  # version 0.3 wrote proved
            if isinstance(self.record.get(key), dict):
                self.record[key] = {"verified" if name == "proved" else name: share for name, share in self.record[key].items()}
        with files.reading(folder / SUMMARY, "an axis"):
            self.axes = [axis_of(axis, self.record.get("bead_radius")) for axis in self.record.need("axes")]
        if not self.axes:
            raise PlotError(f"{folder / SUMMARY}: a scan without axes")

    @property
    def design(self):
        return str(self.record.need("design"))

    @property
    def of_beds(self):
        """Points are granular runs; scan.csv has their means, lengths in a and times in s."""
        return self.record.get("subject") == "beds"

    @property
    def runs(self):
        """Of each point; 1 where points are not repeated."""
        return int(self.record.get("runs") or 1)

    def runs_that_end(self, outcome):
        """Of all points, of those that did not fail."""
        return int((self.record.get("outcomes") or {}).get(outcome) or 0)

    @property
    def path(self):
        return self.folder / POINTS

    @cached_property
    def columns(self):
        """{name: numbers, or a list of words}, in the order of the file."""
        choices = [axis.key for axis in self.axes if axis.is_choice]
        found = files.read_csv(self.path, ("outcome", "status", "certificate", *choices), needed=[axis.key for axis in self.axes] + ["outcome", "status"])
        if "certificate" in found:
            found["certificate"] = ["verified" if name == "proved" else name for name in found["certificate"]]
        if not found["outcome"]:
            raise PlotError(f"{self.path}: holds no points: nothing to draw")
        return found

    def numbers(self, name):
        """A column of numbers; what it holds of failed points too."""
        values = self.columns[name]
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

    @property
    def is_critical(self):
        """The points are the coarse pass of critical values of the last axis."""
        return (self.folder / CRITICAL).is_file()

    @cached_property
    def boundary(self):
        """Curves in their order; none without the file. Of critical values their branches."""
        path = self.folder / BOUNDARY
        if self.is_critical:
            return self._branches()
        if not path.is_file():
            return []
        found = files.read_csv(path, text=("between",))
        keys = [found[axis.key] for axis in self.axes]
        curve, error = found["curve"], found.get("error", np.empty(0))
        rows = [np.flatnonzero(curve == one) for one in np.unique(curve)]
        return [Curve(found["between"][row[0]], np.stack([key[row] for key in keys], axis=-1), error[row] if error.size else error)
                for row in rows]

    def _branches(self):
        path, (*others, solved) = self.folder / CRITICAL, self.axes
        if len(others) != 1 or others[0].is_choice:
            return []
        found = files.read_csv(path, text=("kind", "below", "above"), needed=[others[0].key, "value", "low", "high", "branch"])
        places = np.stack([found[others[0].key], found["value"]], axis=-1)
        error = (found["high"] - found["low"]) / 2 / abs(solved.high - solved.low)
        rows = [np.flatnonzero(found["branch"] == one) for one in np.unique(found["branch"])]
        rows = [row[np.argsort(places[row, 0], kind="stable")] for row in rows]
        return [Curve(f"{found['below'][row[0]]}, {found['above'][row[0]]}", places[row], error[row]) for row in rows]

    @property
    def has_cells(self):
        return self.design == "adaptive" and (self.folder / CELLS).is_file()

    @cached_property
    def cells(self):
        """(lows, highs) [cell][axis] in even coordinates, outcomes (index; -1: mixed, or none)."""
        path = self.folder / CELLS
        found = files.read_csv(path, text=("outcome", "certificate"))
        sides = [np.stack([axis.even(found[f"{axis.key}_{end}"]) for axis in self.axes], axis=-1)
                 for end in ("from", "to")]
        names = found["outcome"]
        lows, highs = np.minimum(*sides), np.maximum(*sides)  # an axis may run downwards
        return lows, highs, np.array([OUTCOMES.index(name) if name in OUTCOMES else -1 for name in names], dtype=np.int8)

    @cached_property
    def open_cells(self):
        """[cell]: whether it is not known to have one outcome; none of a scan that was not asked for certificates."""
        area = self.record.get("certified_area") or {}
        if not (area.get("verified") or area.get("checked")):
            return np.zeros(len(self.cells[2]), dtype=bool)
        found = files.read_csv(self.folder / CELLS, text=("outcome", "certificate"), needed=["certificate"])
        return np.array([name == "open" for name in found["certificate"]])

    @cached_property
    def samples(self):
        """None where no trajectories were stored."""
        path = self.folder / SAMPLES
        if not path.is_file():
            return None
        with files.open_hdf5(path) as file:
            if "trajectories" not in file or not len(file["trajectories"]):
                return None
            point, *parts = (np.asarray(files.dataset(file, f"trajectories/{name}")) for name in Samples._fields)
        found = Samples(point.astype(np.int64), *(part.astype(float) for part in parts))
        return found if len(found.point) else None


# An axis of a scan: what it is called, in what it is even, and how it stands in a figure.

PREFIXED = ("m", "s", "m/s", "N")
WIDE_LIST = 25  # listed values that span more than this factor, and are positive, stand on a logarithmic axis
FEW_TICKS = 7    # listed values that have a tick each
PLACES = re.compile(r"(?:granular\.)?rods\.(\d+)\.(position\.([01])|heading)")


@dataclass(frozen=True)
class Axis:
    key: str
    keys: tuple        # tied to the first: their values are those of the axis times `factors`
    factors: tuple
    symbol: str        # TeX without dollars; or words, if it is no TeX
    unit: str
    scale: str         # linear, log or choice
    low: float         # in the numbers of the file; of a choice -0.5 ...
    high: float
    values: tuple      # as listed; of a choice words
    factor: float = field(default=1.0)  # shown is the number of the file times this
    prefix: str = ""

    @property
    def is_tex(self):
        return style.is_mathtext(f"${self.symbol}$")

    @property
    def name(self):
        """For a figure."""
        return f"${self.symbol}$" if self.is_tex else style.literal(self.symbol)

    @property
    def is_choice(self):
        return self.scale == "choice"

    @property
    def sign(self):
        """Of a logarithmic axis: its ends have the same."""
        return -1.0 if self.high < 0 else 1.0

    def even(self, values):
        """Coordinates of numbers of the file in which the axis is even."""
        values = np.asarray(values, dtype=float)
        with np.errstate(divide="ignore", invalid="ignore"):
            return self.sign * np.log10(self.sign * values) if self.scale == "log" else values

    def back(self, places):
        places = np.asarray(places)
        return self.sign * 10.0 ** (self.sign * places) if self.scale == "log" else places

    @property
    def span(self):
        """Length of the axis in even coordinates."""
        return float(self.even(self.high) - self.even(self.low)) or 1.0

    @property
    def label(self):
        """For a figure, with its unit."""
        if self.factor == 1.0 and self.unit in words.REDUCED and self.is_tex:
            return f"${self.symbol}{words.REDUCED[self.unit]}$"
        if self.unit in PREFIXED:
            return rf"{self.name} ($\mathrm{{{self.prefix}{self.unit}}}$)"
        return self.name + (f" ({fit_words.unit_math(self.unit)})" if self.unit not in ("", "1") else "")

    def equals(self, value):
        """`x_1 = 3 f/mu` as mathtext; of a choice its word."""
        if self.is_choice:
            return f"{self.key.rpartition('.')[2].replace('_', ' ')}: {style.safe(self.values[int(value)])}"
        unit = rf"\ \mathrm{{{self.prefix}{self.unit}}}" if self.unit in PREFIXED else (
            r"\ " + fit_words.unit_math(self.unit).strip("$") if self.unit not in ("", "1") else "")
        value_text = f"= {words.math_number(float(value) * self.factor)}{unit}$"
        return f"${self.symbol} {value_text}" if self.is_tex else f"{self.name} ${value_text}"

    @property
    def name_html(self):
        return words.tex_html(self.symbol.replace(r"\ ", " ")) if self.is_tex else words.escape(self.symbol)

    @property
    def unit_html(self):
        prefix = {r"\mu ": "µ"}.get(self.prefix, self.prefix)
        return prefix + fit_words.unit_html(self.unit)

    def equals_text(self, value):
        """`κ = 3` as plain text; the axis has the unit."""
        name = html.unescape(re.sub("<[^>]*>", "", self.name_html))
        return f"{name}: {self.values[int(value)]}" if self.is_choice else f"{name} = {value * self.factor:.4g}"

    def equals_html(self, value):
        if self.is_choice:
            return f"{self.name_html}: {words.escape(self.values[int(value)])}"
        return words.equation(self.name_html, float(value) * self.factor, self.unit_html)

    def set_scale(self, axis):
        set_scale = getattr(axis.axes, f"set_{axis.axis_name}scale")
        if self.scale != "log":
            set_scale("linear")
        elif self.sign > 0:
            set_scale("log")
        else:  # the part of a symmetric one that is logarithmic
            set_scale("symlog", linthresh=-self.high / 10 * self.factor)

    def dress(self, axis, low, high):
        """Scale, limits (in numbers of the file), ticks and label of a matplotlib axis."""
        self.set_scale(axis)
        axis.axes.set(**{f"{axis.axis_name}lim": (low * self.factor, high * self.factor)})
        if self.scale == "log" and self.sign > 0:
            canvas.plain_ticks(axis, low * self.factor, high * self.factor)
            canvas.plain_decades(axis, low * self.factor, high * self.factor)
        elif self.scale == "log":
            axis.set_major_locator(SymmetricalLogLocator(axis.get_transform()))
            axis.set_minor_locator(SymmetricalLogLocator(axis.get_transform(), subs=range(2, 10)))
            canvas.plain_decades(axis, -high * self.factor, -low * self.factor)
        elif self.is_choice:
            axis.set_ticks(range(len(self.values)), [style.safe(value) for value in self.values])
            axis.set_tick_params(length=0)
        elif 1 < len(self.values) <= FEW_TICKS:
            axis.set_ticks([value * self.factor for value in self.values])
        else:
            axis.set_major_locator(MaxNLocator(7, steps=[1, 2, 5, 10]))
        axis.set_label_text(self.label)


def axis_of(record, bead_radius=None):
    """An entry of scan.json; lengths of beds are shown in a."""
    key, values = record["key"], tuple(record.get("values") or ())
    low, high = (values[0], values[-1]) if values else (record["from"], record["to"])
    if isinstance(low, str):
        return Axis(key, (key,), (1.0,), symbol_of(key, record), "", "choice", -0.5, len(values) - 0.5, values)
    low, high = map(float, (min(values), max(values)) if values else (min(low, high), max(low, high)))
    spacing, unit = record.get("spacing", "linear"), record.get("unit") or ""
    log = spacing == "log" or (spacing == "listed" and low > 0 and high > WIDE_LIST * low)
    factor, prefix = axis_factor(unit, max(abs(low), abs(high)), log)
    if unit == "m" and bead_radius:
        factor, prefix, unit = 1.0 / bead_radius, "", "a"
    return Axis(key, tuple(record.get("keys") or (key,)), tuple(record.get("factors") or (1.0,)), symbol_of(key, record), unit,
                "log" if log and low * high > 0 else "linear", low, high, values, factor, prefix)


def axis_factor(unit, extent, log):
    """(factor, prefix) of SI lengths, times, speeds and forces."""
    return words.prefix_for(extent) if unit in PREFIXED and not log else (1.0, "")


def symbol_of(key, record):
    """TeX: as the scene calls it, of starts x_1 and the like, as the program says, else the name of the key."""
    if record.get("label"):
        return said_if_plain(str(record["label"]), key)
    found = PLACES.fullmatch(key)
    if found:
        return rf"{'xy'[int(found[3])] if found[3] else chr(92) + 'theta'}_{{{found[1]}}}"
    if record.get("symbol"):
        return str(record["symbol"])
    table, _, name = key.rpartition(".")
    known = schema.KEYS.get((table, name), {}).get("symbol")
    return known or r"\mathrm{%s}" % re.sub(r"[^\w.+-]", "?", name).replace("_", r"\ ")


def said_if_plain(label, key):
    if not style.is_mathtext(f"${label}$"):
        errors.say_once(f"scan axis {key}: label = \"{label}\" is not TeX that figures can show; it is shown as plain text")
    return label


def shown_window(axis, asked, name):
    """Limits of a figure in numbers of the file: as asked for, else the whole axis."""
    if not asked:
        return axis.low, axis.high
    if axis.scale == "log" and any(axis.sign * end <= 0 for end in asked):
        raise PlotError(f"{name} = [{asked[0]:g}, {asked[1]:g}]: the axis {axis.key} is logarithmic: numbers of its sign only")
    return tuple(map(float, asked))


def margin(axis, share):
    """The axis's ends moved outwards by this part of its length."""
    if axis.is_choice:
        return axis.low, axis.high
    low, high = axis.even(axis.low), axis.even(axis.high)
    return tuple(float(axis.back(place)) for place in (low - share * axis.span, high + share * axis.span))
