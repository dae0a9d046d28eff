"""A run directory as the figures see it: the result file, the resolved scene and the small JSON records."""

import tomllib
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from . import files, schema
from .bed_run import GranularRun, SUMMARY
from .errors import MissingError, PlotError
from .fit_result import FILE as FIT, FitResult
from .posterior_result import FILE as POSTERIOR, PosteriorResult
from .scan_run import ScanRun, SUMMARY as SCAN
from .words import Units


class RunDir:
    """Opens result.h5, unless the run is a granular one, a fit or a scan alone, for as long as the `with` block lasts."""

    def __init__(self, path, output=None):
        self.path = Path(path)
        self.output = Path(output or path)  # of figures and pages
        if not self.path.is_dir():
            raise PlotError(f"{path}: no such run directory")
        self.scene_text = self._text("scene.toml")
        self.scene = self._toml(self.scene_text)
        self.outcome = self._json("outcome.json")
        self.provenance = self._json("provenance.json")
        self.log = self._text("log.txt") if (self.path / "log.txt").is_file() else ""
        self._granular = GranularRun(self.path) if (self.path / SUMMARY).is_file() else None
        self._fit = FitResult(self.path) if (self.path / FIT).is_file() else None
        self._posterior = PosteriorResult(self.path) if (self.path / POSTERIOR).is_file() else None
        self._scan = ScanRun(self.path) if (self.path / SCAN).is_file() else None
        self.medium = self._json("medium.json")  # of the rods, where it was fitted
        self.rods_order = self._json("rods_order.json")
        self.tracks = self._json("tracks.json")
        alone = (self._granular or self.tracks or self._fit or self._scan) and not (self.path / "result.h5").is_file()
        self._result = None if alone else Result(self.path / "result.h5")
        if self.has_result and self.result.has("/rods") and self.outcome is None:
            self.result.close()
            raise PlotError(f"{self.path / 'outcome.json'}: missing, but result.h5 holds rods")

    def __enter__(self):
        return self

    def __exit__(self, *_):
        if self.has_result:
            self.result.close()

    @property
    def has_result(self):
        return self._result is not None

    @property
    def has_granular(self):
        return self._granular is not None

    @property
    def has_tracks(self):
        """Measures of what a camera saw, without a bed."""
        return self.tracks is not None

    @property
    def result(self):
        return self._there(self._result, "result.h5", "this run holds no field and no rods of the theory")

    @property
    def granular(self):
        status = (self.provenance or {}).get("status", "unknown")
        stopped = status in ("unfinished", "interrupted", "failed")
        return self._there(self._granular, SUMMARY, f"this run is {status}; the same rodwake command resumes it" if stopped else
                           "this run holds no beads")

    @property
    def has_fit(self):
        return self._fit is not None

    @property
    def fit(self):
        return self._there(self._fit, FIT, "this run has fitted nothing; [fit] in the scene and rodwake fit write it")

    @property
    def has_posterior(self):
        return self._posterior is not None and self.has_fit

    @property
    def posterior(self):
        return self._there(self._posterior, POSTERIOR, "this run holds no posterior; [fit.posterior] in the scene and rodwake fit write it")

    @property
    def has_scan(self):
        return self._scan is not None

    @property
    def scan(self):
        return self._there(self._scan, SCAN, "this run has scanned nothing; [scan] in the scene and rodwake scan write it")

    def _there(self, found, name, why):
        if found is None:
            raise MissingError(self.path / name, f"no such file: {why}")
        return found

    @property
    def units(self):
        if self.has_result:
            return self.result.units
        return Units("si" if self.has_granular or self.has_tracks else self.scene.get("units", "reduced"))

    @property
    def version(self):
        return self.result.version if self.has_result else str((self.provenance or {}).get("version", "unknown"))

    def has_lost(self, file):
        """The run wrote the file, and it is gone."""
        name, manifest = file.relative_to(self.path).as_posix(), self._json("manifest.json") or {}
        return name in manifest.get("files", {}) and not file.exists()

    @property
    def figures_dir(self):
        folder = self.output / "figures"
        if folder.is_symlink():  # what it leads to is not the run's
            raise PlotError(f"{folder}: is a link, and rodwake does not write through links: remove it, or choose another folder with -o")
        return folder

    @property
    def title(self):
        return self.scene.get("title") or (self.has_result and self.result.title) or self.path.resolve().name

    def _text(self, name):
        path = self.path / name
        if not path.is_file():
            raise PlotError(f"{path}: no such file")
        return path.read_text(encoding="utf-8", errors="replace")

    def _toml(self, text):
        try:
            return tomllib.loads(text)
        except tomllib.TOMLDecodeError as error:
            raise PlotError(f"{self.path / 'scene.toml'}: not valid TOML: {error}") from error

    def _json(self, name):
        path = self.path / name
        return files.Record(path) if path.is_file() else None


# result.h5 behind plain Python types. Whatever is missing is named with its full place in the file.

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


def distinct_label(run, runs, units):
    """The parameters in which the runs differ, as a label for a run that has none."""
    differing = [key for key in (*schema.COUPLINGS, "alpha", "eta") if len({one.attrs.get(key) for one in runs}) > 1]
    return ", ".join(f"${units.parameter(key, run.attrs[key])}$" for key in differing if key in run.attrs) or "as written"


def plain(value):
    """HDF5 strings arrive as bytes or str, scalars as numpy types."""
    if isinstance(value, bytes):
        return value.decode("utf-8", errors="replace")
    return value.item() if isinstance(value, (np.generic, np.ndarray)) and np.size(value) == 1 else value


class Result:
    def __init__(self, path):
        self.path = path
        self.file = files.open_hdf5(path)
        if (found := self.attribute("/", "schema")) != SCHEMA:
            raise PlotError(f"{path}: schema {found}, this program reads schema {SCHEMA}")
        self.units = Units(self.attribute("/", "units"))
        self.title = self.attribute("/", "title", "")
        self.version = self.attribute("/", "rodwake_version", "unknown")

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
        """A dataset of /field/grid."""
        return self.data(f"/field/grid/{name}")

    def cut_count(self):
        return len(self.file["/field/cuts"]) if self.has("/field/cuts") else 0

    def cut(self, index):
        place = f"/field/cuts/{index}"
        if not self.has(place):
            raise self.error(place, f"{place} is missing (the file holds {self.cut_count()} cuts)")
        along, at = self.attribute(place, "along"), self.attribute(place, "at")
        if along not in ("x", "y"):  # it becomes part of a page
            raise PlotError(f'{self.path}: along of {place} is "{along}", neither x nor y')
        return Cut(along, at, *(self.data(f"{place}/{name}") for name in ("s", "Ux", "Uy")))

    def runs(self):
        """Every run of the rods, in legend order."""
        if not self.has("/rods"):
            return []
        names = sorted(self.file["/rods"], key=lambda name: self.attribute(f"/rods/{name}", "order", 0))
        runs = [self.run(name) for name in names]
        return [replace(run, label=run.label or distinct_label(run, runs, self.units)) for run in runs]

    def run(self, name):
        place = f"/rods/{name}"
        t, x, y, theta = (self.data(f"{place}/{part}") for part in ("t", "x", "y", "theta"))
        label = self.attribute(place, "label", "") or ("" if name == "scene" else name)
        samples = tuple(self.data(f"{place}/ensemble/{part}") for part in "xy") if self.has(f"{place}/ensemble") else ()
        return Run(name, label, self.attribute(place, "outcome"), self.attributes(place), t, x, y, theta, samples)
