"""Scenes: the TOML files that the program runs."""

from __future__ import annotations

import logging
import os
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any, Callable, Optional, Union

from . import _core, arguments, shipped
from .errors import InputError, RunError
from .runs import Run, open_run
from .toml import toml

Folder = Union[str, "os.PathLike[str]"]
Progress = Callable[[str, float, float, str], None]
LONGEST_COMMAND = 10_000  # characters; trajectories hold it as an attribute of HDF5, which ends at 64 KiB
_log = logging.getLogger("rodwake")


class Scene:
    """A scene that was read and checked. `load` reads a file, `parse` a text. An invalid scene raises SceneError, which lists all
    errors. Copies, pickled ones too, do not read the file again."""

    def __init__(self, text: str, name: str, changes: tuple[tuple[str, Any], ...] = (), in_file: bool = False) -> None:
        self._text, self._name, self._changes, self._in_file = text, name, changes, in_file
        self._core = self._read(changes)

    @classmethod
    def load(cls, path: Folder) -> Scene:
        """The scene in a TOML file."""
        name = arguments.path("path", path, "the name of a TOML file")
        _core.read_scene(name, [])  # tells what is wrong with the file, or with the scene in it
        return cls(Path(name).read_bytes().decode(), name, in_file=True)

    @classmethod
    def parse(cls, text: str, name: str = "scene") -> Scene:
        """The scene in a text; `name` stands for its file in messages, and files are looked for beside it."""
        return cls(arguments.kind("text", text, str, "the text of a scene"), arguments.kind("name", name, str, "a text"))

    def _read(self, changes: tuple[tuple[str, Any], ...]) -> Any:
        settings = [f"{key}={toml(value, key)}" for key, value in changes]
        for text in (self._text, *settings):
            if any("\ud800" <= letter <= "\udfff" for letter in text):  # what Python makes of a name that is not UTF-8
                raise InputError(f"{text[:300]!a}: a scene is UTF-8 and cannot hold this name; put the scene in the folder of the file, or rename the folder")
        return _core.parse_scene(self._text, self._name, settings)

    def set(self, key: Union[str, Mapping[str, Any]], value: Any = None) -> Scene:
        """Sets a key as `-s key=value` does, and returns the scene: set("coupling.kappa", 3.0), set("rods.1.position.0", 2.0),
        set("rods_run.t_end", "5 s"). Plain numbers are in the scene's own units. Keys that depend on each other are set together:
        set({"scan.resolution": 128, "scan.axes.0.count": 32}). An invalid value raises SceneError and changes nothing."""
        arguments.kind("key", key, (str, Mapping), "the name of a key, or a mapping of keys and values")
        changes = (*self._changes, *(key.items() if isinstance(key, Mapping) else [(key, value)]))
        self._core, self._changes = self._read(changes), changes
        return self

    def copy(self) -> Scene:
        """Another scene like this, to set keys of."""
        return Scene(*self._given())

    def __reduce__(self) -> Any:
        return Scene, self._given()

    def _given(self) -> tuple[str, str, tuple[tuple[str, Any], ...], bool]:
        return self._text, self._name, self._changes, self._in_file

    def __eq__(self, other: object) -> bool:
        """Whether both have the same file and the same value of every key."""
        return isinstance(other, Scene) and (self.path, self.to_toml()) == (other.path, other.to_toml())

    @property
    def path(self) -> str:
        """File of the scene, or its name."""
        return str(self._core.path)

    @property
    def title(self) -> str:
        """Title; may be empty."""
        return str(self._core.title)

    @property
    def stages(self) -> list[str]:
        """Stages of a run, in order: 'granular', 'measure', 'fit', 'field', 'rods', 'order', 'scan'."""
        return list(self._core.stages())

    def to_toml(self) -> str:
        """The scene with every default written out. Scene.parse reads the same scene from it."""
        return str(self._core.to_toml())

    def check(self, folder: Folder = ".", *, cost: bool = False) -> str:
        """Describes what will be modelled, what will not, and why. `cost` adds an estimate of the cost, which takes about half a
        second. Raises InputError for a scene that cannot be run. Data files are also searched in `folder`."""
        return _core.check(self._core, arguments.path("folder", folder), 0, bool(cost), shipped.converter())

    def run(self, folder: Folder, *, stages: Union[str, Iterable[str], None] = None, threads: int = 0, seed: Optional[int] = None,
            force: bool = False, progress: Optional[Progress] = None) -> Run:
        """Runs the scene into a folder as `rodwake run` does, without figures, and opens the results.

        Messages go to the logger 'rodwake'. Ctrl-C ends the run at its next step and raises KeyboardInterrupt; the same call
        resumes. Raises RunError if a stage failed.

        Parameters
        ----------
        folder : path
            Run folder.
        stages : str or iterable of str, optional
            Some of the scene's stages. Default: all.
        threads : int
            Up to 1024; 0: one per core. Results do not depend on it.
        seed : int, optional
            Replaces the seeds of the scene.
        force : bool
            Replace results in the folder. Otherwise a finished run is returned.
        progress : callable, optional
            Called a few times per second as progress(what, value, end, unit). An exception that it raises ends the run.

        Returns
        -------
        Run
        """
        names = [stages] if isinstance(stages, str) else None
        if stages is not None and names is None:
            names = [arguments.kind("stages", name, str, "names of stages") for name in arguments.kind("stages", stages, Iterable, "names of stages")]
            if not names:
                raise InputError(f"stages = {stages!r}: give one at least; the scene has {', '.join(self.stages)}")
        return self._run(folder, names, threads, None if seed is None else arguments.whole("seed", seed, 0), force, progress)

    def _run(self, folder: Folder, stages: Optional[list[str]], threads: int, seed: Optional[int], force: bool,
             progress: Optional[Progress], execute: Optional[Callable[..., None]] = None) -> Run:
        """`execute` evaluates the points of a scan: see scans.py."""
        folder, threads = Path(arguments.path("folder", folder)), arguments.threads(threads)
        if progress is not None:
            arguments.function("progress", progress)
        command = self._command(folder, stages=stages, seed=seed)
        errors: list[str] = []  # the folder, and its log, may be gone before anyone looks

        def log(level: int, text: str) -> None:
            errors.extend([text] if level >= logging.ERROR else [])
            _log.log(level, text)

        end = _core.run(self._core, folder, stages, threads, seed, bool(force), command, log, progress, execute, shipped.converter())
        if end == "failed":
            raise RunError(f"{folder}: the run failed: {'; '.join(errors) or 'see its log.txt'}")
        return open_run(folder)

    def _command(self, folder: Folder, **options: Any) -> str:
        """What makes the run again, for provenance.json."""
        changes = "".join(f".set({key!r}, {value!r})" for key, value in self._changes)
        given = "".join(f", {name}={value!r}" for name, value in options.items() if value is not None)
        made = f"load({self.path!r})" if self._in_file else f"parse({self._text!r}, {self._name!r})"
        if len(made + changes) > LONGEST_COMMAND:
            made, changes = f"load({os.path.join(folder, 'scene.toml')!r})", ""  # the same scene, as the run has written it
        return f"rodwake.Scene.{made}{changes}.run({os.fspath(folder)!r}{given})"

    def __repr__(self) -> str:
        return f"<Scene {self.path!r}: {', '.join(self.stages)}>"
