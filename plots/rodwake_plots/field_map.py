"""What the two maps of the field share: the window of the grid, the colour map, the rod."""

from dataclasses import dataclass

import numpy as np

from . import canvas, glyphs, style, words
from .errors import PlotError


@dataclass(frozen=True)
class Grid:
    """The part of /field/grid inside a figure's window, in axis units."""
    x: np.ndarray
    y: np.ndarray
    crop: tuple
    xlabel: str
    ylabel: str

    @property
    def aspect(self):
        return np.ptp(self.y) / np.ptp(self.x)


def grid_of(result, spec):
    x, y = result.grid("x"), result.grid("y")
    columns, rows = _inside(x, spec.x), _inside(y, spec.y)
    extent = max(np.abs(x[columns]).max(), np.abs(y[rows]).max())
    xs, ys = result.units.length("x", extent), result.units.length("y", extent)
    return Grid(x[columns] * xs.factor, y[rows] * ys.factor, np.ix_(rows, columns), xs.label, ys.label)


def _inside(values, window):
    found = np.arange(values.size)
    if window:
        found = np.flatnonzero((values >= window[0]) & (values <= window[1]))
    if found.size < 8:
        raise PlotError("fewer than 8 grid points inside the window")
    return found


def paint(axes, grid, values, norm):
    """The colour map; the masked singular point takes the colour of the top."""
    filled = np.where(np.isfinite(values), np.clip(values, norm.vmin, None), norm.vmax)
    image = axes.pcolormesh(grid.x, grid.y, filled, norm=norm, cmap=style.FIELD_MAP, shading="gouraud", rasterized=True)
    canvas.window(axes, (grid.x[0], grid.x[-1]), (grid.y[0], grid.y[-1]))
    axes.set_xlabel(grid.xlabel)
    axes.tick_params(direction="out", top=False, right=False)
    return image


def draw_rod(axes, grid):
    if grid.x[0] < 0 < grid.x[-1] and grid.y[0] < 0 < grid.y[-1]:
        glyphs.at_origin(axes)


def heading_of(run, title):
    """The title asked for, else the medium's numbers."""
    medium = run.result.attributes("/medium")
    return style.safe(title) or ",  ".join(f"${run.result.units.parameter(key, medium[key], 3)}$" for key in ("eta", "alpha") if key in medium)


def medium_note(run):
    """The medium's numbers for a caption."""
    medium, units = run.result.attributes("/medium"), run.result.units
    unit = {"xi": units.length_html()}
    parts = [words.equation(words.symbol(key), medium[key], unit.get(key, "")) for key in ("eta", "alpha", "xi") if key in medium]
    return ", ".join(parts) + "." if parts else ""
