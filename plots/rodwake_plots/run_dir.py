"""A run directory as the figures see it: the result file, the resolved scene and the small JSON records."""

import json
import tomllib
from pathlib import Path

from .errors import MissingError, PlotError
from .fit_result import FILE as FIT
from .fit_result import FitResult
from .granular_run import SUMMARY, GranularRun
from .result import Result
from .scan_run import TOLD as SCAN
from .scan_run import ScanRun
from .units import Units


class RunDir:
    """Opens result.h5, unless the run is a granular one, a fit, a scan or a tradeoff alone, for as long as the `with` block lasts."""

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
        self._scan = ScanRun(self.path) if (self.path / SCAN).is_file() else None
        self.medium = self._json("medium.json")  # of the rods, where it was fitted
        self.tradeoff = self._json("tradeoff.json")
        self.rods_order = self._json("rods_order.json")
        alone = (self._granular or self._fit or self._scan or self.tradeoff) and not (self.path / "result.h5").is_file()
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
    def result(self):
        if self._result is None:
            raise MissingError(self.path / "result.h5", "no such file: this run holds no field and no rods of the theory")
        return self._result

    @property
    def granular(self):
        if self._granular is None:
            status = (self.provenance or {}).get("status", "unknown")
            stopped = status in ("unfinished", "interrupted", "failed")
            why = f"this run is {status}; the same rodwake command goes on with it" if stopped else "this run holds no beads"
            raise MissingError(self.path / SUMMARY, f"no such file: {why}")
        return self._granular

    @property
    def has_fit(self):
        return self._fit is not None

    @property
    def fit(self):
        if self._fit is None:
            raise MissingError(self.path / FIT, "no such file: this run has fitted nothing; [fit] in the scene and rodwake fit write it")
        return self._fit

    @property
    def has_scan(self):
        return self._scan is not None

    @property
    def scan(self):
        if self._scan is None:
            raise MissingError(self.path / SCAN, "no such file: this run has scanned nothing; [scan] in the scene and rodwake scan write it")
        return self._scan

    @property
    def has_tradeoff(self):
        return self.tradeoff is not None

    @property
    def holds_tradeoff_alone(self):
        return set((self.provenance or {}).get("stages", ())) == {"tradeoff"}

    @property
    def units(self):
        if self.has_result:
            return self.result.units
        return Units("si" if self.has_granular else self.scene.get("units", "reduced"))

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
        if not path.is_file():
            return None
        try:
            return json.loads(path.read_text(encoding="utf-8"))
        except ValueError as error:
            raise PlotError(f"{path}: not valid JSON: {error}") from error
