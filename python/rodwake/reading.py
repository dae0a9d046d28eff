"""Reading the files of a run. A damaged file is a RunError that names it, whatever error the reader raises."""

from __future__ import annotations

import contextlib
import csv
import io
import json
import re
from pathlib import Path
from typing import Any, Iterator, Mapping

import numpy as np

from .errors import Error, RunError, SceneError


@contextlib.contextmanager
def reading(path: Path, form: str) -> Iterator[None]:
    """Around everything that trusts a file (or folder) of a run: exceptions inside are its fault. Errors of rodwake pass, but for those of
    a scene, which in a run is a file like the others."""
    try:
        yield
    except Error as error:
        if not isinstance(error, SceneError):
            raise
        raise RunError(f"{path}: damaged {form}: {error}") from error
    except Exception as error:
        raise RunError(f"{path}: {_why(error, form)}") from error


def _why(error: Exception, form: str) -> str:
    if isinstance(error, OSError) and error.strerror:
        return f"cannot be read: {error.strerror}"
    if isinstance(error, RecursionError):
        return f"damaged {form}: nested too deeply"
    if isinstance(error, UnicodeDecodeError):
        return f"damaged {form}: not UTF-8 text"
    cause = error.args[0] if isinstance(error, KeyError) and error.args else error  # as text it would be quoted
    return f"damaged {form}: {cause or type(error).__name__}"


def read_json(path: Path) -> Any:
    """By the standard, which has neither NaN nor Infinity."""
    def refuse(word: str) -> None:
        raise ValueError(f"{word} is no number of JSON")

    with reading(path, "JSON"):
        return json.loads(path.read_text(encoding="utf-8"), parse_constant=refuse)


def read_record(path: Path) -> dict[str, Any]:
    """A JSON file that holds an object."""
    found = read_json(path)
    if not isinstance(found, dict):
        raise RunError(f"{path}: damaged JSON: not an object")
    return found


def read_table(path: Path, units: Mapping[str, str]) -> Any:
    """A CSV file as a pandas DataFrame, or without pandas as a NumPy structured array. `units`: of the columns that it must have."""
    try:
        import pandas
    except ImportError:
        pandas = None
    with reading(path, "CSV"):
        lines = _lines(path, units)
        if pandas is None:
            table: Any = np.atleast_1d(np.genfromtxt(lines, delimiter=",", names=True, dtype=None, encoding="utf-8", deletechars=""))
        else:
            table = pandas.read_csv(io.StringIO("".join(lines)), float_precision="round_trip", index_col=False)
        for name, unit in units.items():
            if len(table) and unit not in ("", "1") and np.asarray(table[name]).dtype.kind in "OSU":
                raise ValueError(f"column {name!r} (in {unit}) holds what is no number")
        return table


def _lines(path: Path, units: Mapping[str, str]) -> list[str]:
    """Header and rows, as they are in the file. pandas fills short rows up, and takes a column too many for an index."""
    with path.open(encoding="utf-8", newline="") as file:
        lines = [line for line in file if not line.startswith("#")]
    if not lines or not lines[-1].endswith("\n"):
        raise ValueError("cut off" if lines else "empty")
    cells = csv.reader(lines)
    header = next(cells)
    for number, row in enumerate(cells, 1):
        if len(row) != len(header) and row:  # a missing number alone in its row leaves an empty line
            raise ValueError(f"row {number} has {len(row)} values for {len(header)} columns")
    missing = [name for name in units if name not in header]
    if missing:
        raise ValueError(f"column {missing[0]!r} is missing")
    if "certificate" in header:  # version 0.3 wrote proved where verified stands now
        lines = [re.sub(r",proved(?=[,\r\n])", ",verified", line) for line in lines]
    return lines


@contextlib.contextmanager
def open_hdf5(path: Path) -> Iterator[Any]:
    import h5py
    with reading(path, "HDF5"):
        try:
            file = h5py.File(path, "r")
        except BlockingIOError:  # a process that the writer forked keeps its lock, though results are never changed, only replaced
            file = h5py.File(path, "r", locking=False)
        with file:
            yield file
