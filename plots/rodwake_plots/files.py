"""Files that are complete or not there: written under another name, brought to the disk, renamed."""

import contextlib
import csv
import functools
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


# A CSV file of numbers as named columns; lines that begin with # are comments.

GAP = re.compile(r"(?:^|(?<=,))[ \t]*(?=,|$)")  # an empty cell


def read_csv(path):
    """{name: values}; a file with a header alone gives empty columns."""
    names, lines = csv_parts(path)
    try:
        values = np.loadtxt(lines, delimiter=",", ndmin=2) if lines else np.empty((0, len(names)))
    except ValueError as error:
        raise PlotError(f"{path}: not a table of numbers: {error}") from error
    if values.shape[1] != len(names):
        raise PlotError(f"{path}: {len(names)} names in its first line, {values.shape[1]} numbers in the others")
    return dict(zip(names, values.T))


def read_csv_with_gaps(path, text=()):
    """The same where cells may be empty, which become nan; columns named in `text` are lists of strings."""
    names, lines = csv_parts(path)
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
    return {name: found[index] for index, name in enumerate(names)}


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


def csv_column(path, columns, name):
    if name not in columns:
        raise PlotError(f"{path}: column {name} is missing")
    return columns[name]


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
