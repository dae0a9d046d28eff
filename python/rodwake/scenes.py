"""Scenes: the TOML files that the program runs."""

from __future__ import annotations

import json
import logging
import os
from pathlib import Path
from typing import Any, Callable, Iterable, Optional, Union

from . import _core
from .runs import Run, open_run

Folder = Union[str, "os.PathLike[str]"]
Progress = Callable[[str, float, float, str], None]
_log = logging.getLogger("rodwake")


def _toml(value: Any) -> str:
    """A value as a scene file has it. Strings may have a unit ("5 s")."""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        return json.dumps(value, ensure_ascii=False)
    if hasattr(value, "tolist"):  # of NumPy
        value = value.tolist()
    if isinstance(value, (list, tuple)):
        return f"[{', '.join(_toml(one) for one in value)}]"
    if isinstance(value, (int, float)):
        return repr(value)
    raise TypeError(f"a scene holds numbers, strings, true, false and lists of them, not {type(value).__name__}")


class Scene:
    """A scene that was read and checked. Immutable: `set` gives another one.

    Scene.load reads a file, Scene.parse a text. What is wrong with a scene raises SceneError, which lists all its problems.
    """

    def __init__(self, core: Any, read: Callable[[list[str]], Any], changes: tuple[tuple[str, Any], ...]) -> None:
        self._core, self._read, self._changes = core, read, changes

    @classmethod
    def load(cls, path: Folder) -> Scene:
        """The scene in a TOML file."""

        def read(changes: list[str]) -> Any:
            return _core.read_scene(path, changes)

        return cls(read([]), read, ())

    @classmethod
    def parse(cls, text: str, name: str = "scene") -> Scene:
        """The scene in a text; `name` stands for its file in messages, and files are looked for beside it."""

        def read(changes: list[str]) -> Any:
            return _core.parse_scene(text, name, changes)

        return cls(read([]), read, ())

    def set(self, key: str, value: Any) -> Scene:
        """The scene with another value for a key, as `-s key=value` has it: set("coupling.kappa", 3.0),
        set("rods.1.position.0", 2.0), set("rods_run.t_end", "5 s"). Plain numbers are in the scene's own units."""
        changes = (*self._changes, (key, value))
        return Scene(self._read([f"{key}={_toml(value)}" for key, value in changes]), self._read, changes)

    @property
    def path(self) -> str:
        """The file it came from, or its name."""
        return str(self._core.path)

    @property
    def title(self) -> str:
        return str(self._core.title)

    @property
    def stages(self) -> list[str]:
        """What a run of it does, in order: 'granular', 'measure', 'fit', 'field', 'rods', 'order', 'scan'."""
        return list(self._core.stages())

    def to_toml(self) -> str:
        """The scene with every default written out. Scene.parse reads the same scene from it."""
        return str(self._core.to_toml())

    def check(self, folder: Folder = ".", *, cost: bool = False) -> str:
        """What will be modelled, what will not and why; with `cost` also how long it will take, which is measured for about half a
        second. Raises InputError for what cannot be modelled. Data files are also looked for in `folder`."""
        return _core.check(self._core, folder, 0, cost)

    def run(self, folder: Folder, *, stages: Optional[Iterable[str]] = None, threads: int = 0, seed: Optional[int] = None,
            force: bool = False, progress: Optional[Progress] = None) -> Run:
        """Runs the scene into a folder as `rodwake run` does, figures aside, and opens the results.

        stages    some of those the scene has; None: all
        threads   0: one for each core; results do not depend on it
        seed      replaces those of the scene
        force     do again what the folder holds already; else a finished run is refused
        progress  called some times a second as progress(what, value, end, unit); what it raises ends the run

        Messages go to the logger 'rodwake' of the module logging. Ctrl-C ends the run at its next step and raises
        KeyboardInterrupt; what was computed is kept, and the same call goes on from there. Raises RunError if a stage failed.
        """
        names = None if stages is None else list(stages)
        end = _core.run(self._core, folder, names, threads, seed, force, self._command(folder, stages=names), _log.log, progress)
        if end == "failed":
            from .errors import RunError
            raise RunError(f"{folder}: the run failed; {Path(folder) / 'log.txt'} tells why")
        return open_run(folder)

    def _command(self, folder: Folder, **options: Any) -> str:
        """What makes the run again, for provenance.json."""
        changes = "".join(f".set({key!r}, {value!r})" for key, value in self._changes)
        given = "".join(f", {name}={value!r}" for name, value in options.items() if value is not None)
        return f"rodwake.Scene.load({self.path!r}){changes}.run({os.fspath(folder)!r}{given})"

    def __repr__(self) -> str:
        return f"<Scene {self.path!r}: {', '.join(self.stages)}>"
