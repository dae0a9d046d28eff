"""Exceptions. `InputError` is also a ValueError, `RunError` a RuntimeError. An argument of the wrong type raises TypeError."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Sequence


class Error(Exception):
    """Base of all exceptions. The text names the fault, what is legal and what to do next."""


class InputError(Error, ValueError):
    """An argument cannot be used."""


class RunError(Error, RuntimeError):
    """The computation could not finish (an unwritable folder, a failed solve), or a file of a run is damaged or missing."""


@dataclass(frozen=True)
class Problem:
    """An error in a scene and its position in the file: line and column from 1 (0: no single position)."""

    file: str
    line: int
    column: int
    key: str
    message: str


class SceneError(InputError):
    """A scene is invalid. The text and `problems` list all of its errors."""

    def __init__(self, message: str, problems: Sequence[Problem] = ()) -> None:
        super().__init__(message, problems)
        self.problems = list(problems)

    def __str__(self) -> str:
        return str(self.args[0])
