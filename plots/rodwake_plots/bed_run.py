"""The files of a granular run: summary.json, and for each run of an ensemble its tables and trajectories."""

import math
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import NamedTuple

import numpy as np

from . import files, words
from .errors import MissingError, PlotError
from .frames import Trajectory

SUMMARY, TABLE, TRACKS = "summary.json", "table.csv", "tracks.csv"
FILM, ROD_TRACKS, FILM_FRAME = "tracks.json", "rod_tracks.csv", "film_frame.csv"
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
        self.summary = files.Record(folder / SUMMARY)
        self.need = self.summary.need
        self.members = sorted(path for path in folder.glob("runs/*") if path.is_dir()) or [folder]
        with files.reading(self.summary.path, "bead_radius, phi_b or box"):
            self.a, self.phi_b = self.need("bead_radius") + 0, self.need("phi_b") + 0
            self.sides = np.broadcast_to(np.asarray(self.need("box"), dtype=float).ravel()[:2], 2)
        self.container = self.summary.get("container")
        # with a wall nothing has images: in a box of twice the sides the nearest image is the thing itself
        self.box = 2 * self.sides if self.container else self.sides

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

    def has_all_beads(self, name):
        return self.has(name) and self.stores_all_beads(name)

    def which(self, name):
        """Tells, for a caption, whose trajectory is drawn."""
        return "" if self.single else f"Run {words.escape(int_of(self.holders(name)[0].name))} of {len(self.members)}. "

    def tables(self):
        """table.csv of each run."""
        found = [files.read_csv(member / TABLE) for member in (self.holders(TABLE) or self.members)]
        for table in found:
            if table["t"].size == 0:
                raise PlotError(f"{table.path}: holds no rows: nothing to draw")
        return found

    def tracks(self):
        return [track(member / TRACKS) for member in (self.holders(TRACKS) or self.members)]


class FilmRods:
    """The rods of a film, where a figure wants those of a run of a bed."""
    container = None

    def __init__(self, folder):
        self.folder = folder
        record = files.Record(folder / FILM)
        with files.reading(record.path, "box or bead_radius"):
            self.a, self.sides = record.need("bead_radius") + 0, np.asarray(record.need("box"), dtype=float)
        self.is_periodic = record.get("window") == "periodic"
        self.box = self.sides if self.is_periodic else 2 * self.sides
        self.phi_b, self.lengths = record.get("phi_b"), [one.get("length") for one in record.get("rod_tracks") or []]

    def holders(self, name):
        return [self.folder] if self.has(name) else []

    def has(self, name):
        return name == TRACKS and (self.folder / ROD_TRACKS).is_file()

    def tracks(self):
        """Where all rods are known."""
        found = track(self.folder / ROD_TRACKS)
        known = np.isfinite(found.theta).all(axis=1)
        if not known.any():
            raise PlotError(f"{found.path}: in no frame are all rods known: nothing to draw")
        return [replace(found, t=found.t[known], **{name: getattr(found, name)[known] for name in ("x", "y", "theta", "speed")})]


def int_of(name):
    return name.lstrip("0") or name


def track(path):
    columns = files.read_csv(path)
    t = columns["t"]
    if "x0" not in columns:
        raise PlotError(f"{path}: holds no rods: nothing to draw")
    kept = t >= -1e-9 * np.abs(t).max(initial=0.0)  # a first time of -1e-17 is 0
    if not kept.any():
        raise PlotError(f"{path}: holds no rows from t = 0 on: nothing to draw")
    rods = sum(f"x{rod}" in columns for rod in range(len(columns)))
    parts = (np.stack([columns[f"{name}{rod}"][kept] for rod in range(rods)], axis=-1)
             for name in ("x", "y", "theta", "speed"))
    return Track(path, t[kept], *parts)


# The files of a measured run: of a scene with variants one set for the scene itself and one in variants/<name> each.

RESULTS, FIELDS, SERIES = "measure.json", "measure.h5", "series.csv"
# What variants differ in: symbol, unit after a number, words.
AGAINST = {"phi_b": (r"\phi_b", "", "<i>φ<sub>b</sub></i>"), "d0": ("d_0", r"\,a", "the starting separation <i>d</i><sub>0</sub>"),
           "imposed_speed": ("v", r"\,\mathrm{mm/s}", "the imposed speed <i>v</i>")}


class Estimate(NamedTuple):
    value: float
    error: float  # standard error; nan: unknown
    samples: int


class Part:
    """The scene itself or one variant."""

    def __init__(self, name, label, folder):
        self.name, self.label, self.folder = name, label, folder

    def has(self, name):
        return (self.folder / name).is_file()

    def table(self, name, *columns):
        """The columns in that order, one row at least; empty cells are nan."""
        return files.read_columns(self.folder / name, *columns)

    def has_group(self, group):
        """Whether measure.h5 is there and holds the group."""
        if not self.has(FIELDS):
            return False
        with files.open_hdf5(self.folder / FIELDS) as file:
            return group in file

    @cached_property
    def results(self):
        path = self.folder / RESULTS
        if not path.is_file():
            raise MissingError(path, "no such file: rodwake measure writes it")
        return files.Record(path)

    def value(self, table, key):
        """A plain value of measure.json; None where it was not measured."""
        found = self.results.get(table, {})
        with files.reading(self.folder / RESULTS, f"{table}.{key}"):
            for step in key.split("."):  # "chi2.algebraic"
                found = found.get(step) if found is not None else None
        return found

    def number(self, table, key):
        value = self.value(table, key)
        with files.reading(self.folder / RESULTS, f"{table}.{key}"):
            return None if value is None else value + 0

    def estimate(self, table, key):
        """None where it was not measured."""
        found = self.value(table, key)
        with files.reading(self.folder / RESULTS, f"{table}.{key}"):
            if found is None or found["value"] is None:
                return None
            return Estimate(found["value"] + 0, math.nan if found["error"] is None else found["error"] + 0, found.get("samples", 0))

    def grid(self, group, *names):
        """x, y and the named datasets [y][x] of a group of measure.h5."""
        path = self.folder / FIELDS
        with files.open_hdf5(path) as file:
            x, y, *fields = (np.asarray(files.dataset(file, f"{group}/{name}"), dtype=float) for name in ("x", "y", *names))
        for name, field in zip(names, fields):
            if field.shape != (y.size, x.size):
                raise PlotError(f"{path}: /{group}/{name} has shape {field.shape}, expected {(y.size, x.size)}")
        return x, y, *fields

    @property
    def a(self):
        """Bead radius, m."""
        return (self.results.get("units") or {}).get("a") or self.granular.a

    @cached_property
    def granular(self):
        if self.has(FILM):
            return FilmRods(self.folder)
        if not self.has(SUMMARY):
            raise PlotError(f"{self.folder / SUMMARY}: no such file: this run is not finished; the same rodwake command resumes it")
        return GranularRun(self.folder)


def parts_of(run):
    variants = run.scene.get("variants", [])
    found = [Part(one["name"], one.get("label") or one["name"], run.path / "variants" / one["name"]) for one in variants]
    return [Part("", distinct_label(run) if found else "", run.path), *found]


def holders(run, name, group=None):
    """The parts that have this file, and in it this group; if none has, the error names it."""
    found = [part for part in parts_of(run) if (part.has_group(group) if group else part.has(name))]
    if not found:
        lacking = f"/{group} is missing" if group and (run.path / name).is_file() else "no such file"
        raise MissingError(run.path / name, f"{lacking}: this run has not measured it; ask for it in [measure] and run "
                           "rodwake measure on the stored frames, or the scene again")
    return found


def some(run, name):
    """Whether a part has this file."""
    return any(part.has(name) for part in parts_of(run))


def some_hold(run, group):
    return any(part.has_group(group) for part in parts_of(run))


def not_measured(run, name, group=None):
    """For a caption: which variants lack the file."""
    lacking = [words.label_html(part.label) for part in parts_of(run) if not (part.has_group(group) if group else part.has(name))]
    return f" Not measured: {', '.join(lacking)}." if lacking else ""


def describe_each(parts, describe):
    """For a caption: the description of each part, after its label."""
    described = ((part, describe(part)) for part in parts)
    return "; ".join(f"{words.label_html(part.label) + ': ' if part.label else ''}{text}" for part, text in described if text)


def of_measure(key, unit, factor=1.0, measure="microrheology"):
    """A function that writes a value of measure.json with its error."""
    def describe(part):
        found = part.estimate(measure, key)
        return f"{words.with_error(*found[:2], factor)} {unit}" if found else ""
    return describe


def bead_radius(run):
    """In m, of a bed or of tracks."""
    return run.scene["tracks"]["bead_radius"] if run.has_tracks else run.granular.a


def mm_per_s(run):
    """What a speed in a/s, as the files of measures have it, is multiplied by to be in mm/s, as figures have it."""
    return 1e3 * bead_radius(run)


def series(run):
    """The columns of series.csv, its speeds in mm/s."""
    columns = files.read_csv(run.path / SERIES, text=("name",))
    columns.update({name: columns[name] * mm_per_s(run) for name in ("speed", "speed_error", "imposed_speed") if name in columns})
    return columns


def distinct_label(run):
    """Label of the scene itself: that in which its variants differ."""
    if not (run.path / SERIES).is_file():
        return "as written"
    columns = series(run)
    differing = [key for key in AGAINST if key in columns and len({f"{value:.4g}" for value in columns[key]}) > 1]
    return ", ".join(f"${AGAINST[key][0]} = {columns[key][0]:.3g}{AGAINST[key][1]}$" for key in differing
                     if np.isfinite(columns[key][0])) or "as written"


def known_errors(sigma):
    """Errors as they can be drawn: nan where unknown."""
    return np.where(sigma > 0, sigma, np.nan)


def inside_window(values, asked, a):
    """Which places (in a) lie in a figure's window (in the resolved scene: m); all without one."""
    return (values >= asked[0] / a) & (values <= asked[1] / a) if asked else np.ones(values.size, dtype=bool)
