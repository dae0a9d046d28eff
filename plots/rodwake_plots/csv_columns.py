"""A CSV file of numbers as named columns."""

import numpy as np

from .errors import PlotError


def read(path):
    """{name: values}; a file with a header alone gives empty columns."""
    if not path.is_file():
        raise PlotError(f"{path}: no such file")
    with path.open(encoding="utf-8", errors="replace") as file:
        names = [name.strip() for name in file.readline().split(",")]
        lines = [line for line in file if line.strip()]
    try:
        values = np.loadtxt(lines, delimiter=",", ndmin=2) if lines else np.empty((0, len(names)))
    except ValueError as error:
        raise PlotError(f"{path}: not a table of numbers: {error}") from error
    if values.shape[1] != len(names):
        raise PlotError(f"{path}: {len(names)} names in its first line, {values.shape[1]} numbers in the others")
    return dict(zip(names, values.T))


def column(path, columns, name):
    if name not in columns:
        raise PlotError(f"{path}: column {name} is missing")
    return columns[name]
