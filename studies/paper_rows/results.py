"""Reads the files of run directories."""

import csv
import json

import numpy as np


def table(path):
    lines = [line for line in path.read_text(encoding="utf-8").splitlines() if not line.startswith("#")]
    return list(csv.DictReader(lines))


def columns(path, *names):
    rows = table(path)
    return tuple(np.array([float(row[name] or "nan") for row in rows]) for name in names)


def read_json(folder, name):
    return json.loads((folder / f"{name}.json").read_text(encoding="utf-8"))


def cases(folder):
    """(row of series.csv, folder) of the scene and its variants."""
    return [(row, folder if row["name"] == "scene" else folder / "variants" / row["name"]) for row in table(folder / "series.csv")]


def estimate(entry):
    """(value, error) of an entry with both; the error of one run is unknown."""
    return entry["value"], float("nan") if entry["error"] is None else entry["error"]
