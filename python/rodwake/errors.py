"""Exceptions of rodwake. All are `Error`; `InputError` is a ValueError as well, `RunError` a RuntimeError."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Sequence


class Error(Exception):
    """What rodwake raises. The text says what was found, what is legal and what to do next."""


class InputError(Error, ValueError):
    """What was given cannot be used."""


class RunError(Error, RuntimeError):
    """The input was fine, but the work could not be finished: an unwritable folder, a failed solve."""


@dataclass(frozen=True)
class Problem:
    """One thing that is wrong with a scene: its place in the file (line and column from 1; 0: no single place) and what it is."""

    file: str
    line: int
    column: int
    key: str
    message: str


class SceneError(InputError):
    """A scene cannot be used. The text lists all its problems, and so does `problems`."""

    def __init__(self, message: str, problems: Sequence[Problem] = ()) -> None:
        super().__init__(message, problems)
        self.problems = list(problems)

    def __str__(self) -> str:
        return str(self.args[0])
