"""A CSV file of numbers as named columns; lines that begin with # are comments."""

import csv

import numpy as np

from .errors import PlotError


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
    rows = list(csv.reader(lines))
    for row in rows:
        if len(row) != len(names):
            raise PlotError(f"{path}: {len(names)} names in its first line, {len(row)} values in another")
    columns = dict(zip(names, map(list, zip(*rows)) if rows else [[] for _ in names]))
    try:
        return {name: cells if name in text else np.array([float(cell) if cell.strip() else np.nan for cell in cells])
                for name, cells in columns.items()}
    except ValueError as error:
        raise PlotError(f"{path}: not a table of numbers: {error}") from error


def parts(path):
    """Names of the columns, and the other lines."""
    if not path.is_file():
        raise PlotError(f"{path}: no such file")
    with path.open(encoding="utf-8", errors="replace") as file:
        lines = [line for line in file if line.strip() and not line.startswith("#")]
    return [name.strip() for name in (lines[0] if lines else "").split(",")], lines[1:]


def column(path, columns, name):
    if name not in columns:
        raise PlotError(f"{path}: column {name} is missing")
    return columns[name]
