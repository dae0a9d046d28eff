"""Designs of `rodwake design`: how much each experiment is expected to tell of which rival made the tracks."""

import json
from pathlib import Path

import numpy as np

from . import canvas, style
from .errors import PlotError

FILE = "design.json"
MOST = 24  # designs in the figure, the best ones


def has_design(folder):
    return (Path(folder) / FILE).is_file()


def write(folder, output=None):
    """Paths of the figures made."""
    folder = Path(folder)
    record = json.loads((folder / FILE).read_text(encoding="utf-8"))
    path = Path(output or folder) / "figures" / "design.png"
    canvas.save(draw(record, folder / FILE), path)
    return [path]


def draw(record, path=FILE):
    designs = [one for one in record["designs"] if one["information"] is not None]
    if not designs:
        raise PlotError(f"{path}: no design has a result")
    designs = sorted(designs, key=lambda one: -one["information"])[:MOST]
    rank, most = np.arange(len(designs)), np.log2(len(record["models"]))
    figure = canvas.figure(style.WIDE, 0.3 * len(designs) + 1.3)
    axes = figure.subplots()
    axes.errorbar([one["information"] for one in designs], rank, xerr=[one["information_stderr"] or 0.0 for one in designs], fmt="o", markersize=4,
                  linewidth=0.9, color=style.LINE)
    axes.axvline(0, **canvas.FAINT)
    axes.axvline(most, color=style.GREY, linewidth=0.7, linestyle=":")
    axes.set_yticks(rank, [words(one) for one in designs], fontsize=8)
    axes.set_ylim(len(designs) - 0.5, -0.5)
    axes.set_xlabel(f"expected information on the model (bits of {most:.3g})")
    return figure


def words(one):
    keys = [f"{key.split('.', 1)[-1]} = {value}" for key, value in one["settings"].items()]
    return style.safe(", ".join([*keys, f"{one['runs']} run{'s' * (one['runs'] != 1)}"]))
