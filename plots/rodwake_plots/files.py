"""Files: written whole or not at all; read as the program writes them, and anything else is reported with the name of the file."""

import contextlib
import csv
import functools
import json
import os
import re

import h5py
import numpy as np

from . import errors
from .errors import MissingError, PlotError


@contextlib.contextmanager
def replacing(path):
    """A temporary path beside `path`, moved over it only when all went well; the error of a failed write has the name of the file."""
    temporary = path.with_name(f".{path.name}.{os.getpid()}.tmp")
    remove = functools.partial(temporary.unlink, missing_ok=True)
    with errors.undoing(remove):
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            yield temporary
            bring_to_disk(temporary)
            os.replace(temporary, path)
        except OSError as error:
            raise PlotError(f"{path}: cannot be written: {error.strerror or error}") from error
        finally:
            with contextlib.suppress(OSError):
                remove()


def bring_to_disk(path):
    """A disk that is full or broken may say so only now."""
    with open(path, "rb+") as file:
        os.fsync(file.fileno())


def write(path, data):
    """Bytes, or text; what no encoding has, such as half a surrogate pair of a JSON file, becomes a question mark."""
    with replacing(path) as temporary:
        temporary.write_bytes(data.encode("utf-8", "replace") if isinstance(data, str) else data)


@contextlib.contextmanager
def reading(path, what="it"):
    """Whatever goes wrong while what the program wrote is taken apart: the file is not what it was."""
    try:
        yield
    except (AttributeError, LookupError, TypeError, ValueError) as error:
        raise PlotError(f"{path}: {what} is not as rodwake writes it: {type(error).__name__}: {error}") from error


class Record(dict):
    """A JSON object in a file."""

    def __init__(self, path):
        self.path = path
        try:
            found = json.loads(path.read_text(encoding="utf-8"))
        except ValueError as error:
            raise PlotError(f"{path}: not valid JSON: {error}") from error
        if not isinstance(found, dict):
            raise PlotError(f"{path}: not a JSON object")
        super().__init__(found)

    def need(self, key):
        if self.get(key) is None:
            raise PlotError(f"{self.path}: {key} is missing")
        return self[key]


# A CSV file of numbers as named columns; lines that begin with # are comments.

GAP = re.compile(r"(?:^|(?<=,))[ \t]*(?=,|$)")  # an empty cell


class Table(dict):
    """Columns by name, of numbers or lists of strings."""

    def __init__(self, path, columns):
        super().__init__(columns)
        self.path = path

    def __missing__(self, name):
        raise PlotError(f"{self.path}: column {name} is missing")


def read_csv(path, text=(), needed=()):
    """Empty cells become nan; columns named in `text` are lists of strings, those in `needed` are there."""
    names, lines = csv_parts(path)
    list(map(Table(path, zip(names, names)).__getitem__, needed))
    for line in lines:
        if cells(line) != len(names):
            raise PlotError(f"{path}: {len(names)} names in its first line, {cells(line)} values in another")
    words = [index for index, name in enumerate(names) if name in text]
    numbers = [index for index in range(len(names)) if index not in words]
    try:
        found = dict(zip(words, cells_of(lines, words, str).tolist())) | dict(zip(
            numbers, cells_of([GAP.sub("nan", line) for line in lines], numbers, float)))
    except ValueError as error:
        raise PlotError(f"{path}: not a table of numbers: {error}") from error
    return Table(path, ((name, found[index]) for index, name in enumerate(names)))


def read_columns(path, *names):
    """These columns in that order, one row at least; empty cells are nan."""
    found = read_csv(path)
    values = [found[name] for name in names]
    if values[0].size == 0:
        raise PlotError(f"{path}: holds no rows: nothing to draw")
    return values


def cells(line):
    return len(next(csv.reader([line]))) if '"' in line else line.count(",") + 1


def cells_of(lines, wanted, kind):
    """[column][row]; a scan has millions of cells, so this is left to numpy."""
    if not lines or not wanted:
        return np.empty((len(wanted), len(lines)), dtype=kind)
    return np.loadtxt(lines, delimiter=",", usecols=wanted, dtype=kind, comments=None, quotechar='"', ndmin=2).T


def csv_parts(path):
    """Names of the columns, and the other lines."""
    if not path.is_file():
        raise MissingError(path, "no such file")
    with path.open(encoding="utf-8", errors="replace") as file:
        lines = [line for line in file if line.strip() and not line.startswith("#")]
    return [name.strip() for name in (lines[0] if lines else "").split(",")], lines[1:]


# Opening an HDF5 file and taking datasets from it; whatever is missing is named with its full place.

def open_hdf5(path):
    if not path.is_file():
        raise MissingError(path, "no such file")
    try:
        return h5py.File(path, "r")
    except OSError as error:
        raise PlotError(f"{path}: not a readable HDF5 file") from error


def dataset(file, place):
    found = file.get(place)
    if not isinstance(found, h5py.Dataset):
        raise PlotError(f"{file.filename}: dataset /{place} is missing")
    return found


def parameter(file, name):
    """A number, or an array of them, of the group /parameters: a dataset or an attribute of the group."""
    group = file.get("parameters")
    for store in (group, group.attrs) if group is not None else ():
        if name in store:
            return np.asarray(store[name][()] if store is group else store[name])
    raise PlotError(f"{file.filename}: /parameters/{name} is missing")
