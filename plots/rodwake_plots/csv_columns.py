"""A CSV file of numbers as named columns; lines that begin with # are comments."""

import csv
import re

import numpy as np

from .errors import MissingError, PlotError

GAP = re.compile(r"(?:^|(?<=,))[ \t]*(?=,|$)")  # an empty cell


def read(path):
    """{name: values}; a file with a header alone gives empty columns."""
    names, lines = parts(path)
    try:
        values = np.loadtxt(lines, delimiter=",", ndmin=2) if lines else np.empty((0, len(names)))
    except ValueError as error:
        raise PlotError(f"{path}: not a table of numbers: {error}") from error
    if values.shape[1] != len(names):
        raise PlotError(f"{path}: {len(names)} names in its first line, {values.shape[1]} numbers in the others")
    return dict(zip(names, values.T))


def read_with_gaps(path, text=()):
    """The same where cells may be empty, which become nan; columns named in `text` are lists of strings."""
    names, lines = parts(path)
    for line in lines:
        if cells(line) != len(names):
            raise PlotError(f"{path}: {len(names)} names in its first line, {cells(line)} values in another")
    words = [index for index, name in enumerate(names) if name in text]
    numbers = [index for index in range(len(names)) if index not in words]
    try:
        found = dict(zip(words, columns(lines, words, str).tolist())) | dict(zip(
            numbers, columns([GAP.sub("nan", line) for line in lines], numbers, float)))
    except ValueError as error:
        raise PlotError(f"{path}: not a table of numbers: {error}") from error
    return {name: found[index] for index, name in enumerate(names)}


def cells(line):
    return len(next(csv.reader([line]))) if '"' in line else line.count(",") + 1


def columns(lines, wanted, kind):
    """[column][row]; a scan has millions of cells, so this is left to numpy."""
    if not lines or not wanted:
        return np.empty((len(wanted), len(lines)), dtype=kind)
    return np.loadtxt(lines, delimiter=",", usecols=wanted, dtype=kind, comments=None, quotechar='"', ndmin=2).T


def parts(path):
    """Names of the columns, and the other lines."""
    if not path.is_file():
        raise MissingError(path, "no such file")
    with path.open(encoding="utf-8", errors="replace") as file:
        lines = [line for line in file if line.strip() and not line.startswith("#")]
    return [name.strip() for name in (lines[0] if lines else "").split(",")], lines[1:]


def column(path, columns, name):
    if name not in columns:
        raise PlotError(f"{path}: column {name} is missing")
    return columns[name]
