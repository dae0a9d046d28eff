"""A run directory as the figures see it: the result file, the resolved scene and the small JSON records."""

import json
import tomllib
from pathlib import Path

from .errors import PlotError
from .result import Result


class RunDir:
    """Opens result.h5 for as long as the `with` block lasts."""

    def __init__(self, path):
        self.path = Path(path)
        if not self.path.is_dir():
            raise PlotError(f"{path}: no such run directory")
        self.scene_text = self._text("scene.toml")
        self.scene = self._toml(self.scene_text)
        self.outcome = self._json("outcome.json")
        self.provenance = self._json("provenance.json")
        self.log = self._text("log.txt") if (self.path / "log.txt").is_file() else ""
        self.result = Result(self.path / "result.h5")
        if self.result.has("/rods") and self.outcome is None:
            self.result.close()
            raise PlotError(f"{self.path / 'outcome.json'}: missing, but result.h5 holds rods")

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.result.close()

    @property
    def figures_dir(self):
        return self.path / "figures"

    @property
    def title(self):
        return self.scene.get("title") or self.result.title or self.path.resolve().name

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
