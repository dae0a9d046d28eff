"""Extensional principal axis of the traceless strain over its positive eigenvalue (paper, Fig. attraction a)."""

import numpy as np
from matplotlib import patheffects
from matplotlib.collections import LineCollection

from . import canvas, field_map, ranges, style
from .field_map import draw_rod, grid_of, paint
from .spec import Spec

SEGMENTS_ACROSS = 25


def draw(run, spec):
    result = run.result
    grid = grid_of(result, spec)
    angle, value = (result.grid(name)[grid.crop] for name in ("axis_angle", "axis_value"))
    norm, extend = ranges.log_norm(value)
    figure = canvas.figure(style.SINGLE + 0.4, max(style.SINGLE * grid.aspect, 1.6) + 0.6)
    axes = figure.subplots()
    image = paint(axes, grid, value, norm)
    axes.add_collection(segments(grid, angle))
    draw_rod(axes, grid)
    axes.set_ylabel(grid.ylabel)
    canvas.heading(axes, field_map.heading_of(run, spec.title))
    ranges.log_bar(figure, image, axes, extend, r"extensional eigenvalue $\varepsilon_{+}$", pad=0.02, aspect=25)
    return figure


def segments(grid, angle):
    """Headless marks on a square lattice, left out where the rod is drawn."""
    step = grid.x[1] - grid.x[0]
    pitch = max(1, round(np.ptp(grid.x) / SEGMENTS_ACROSS / step)) * step
    x, y, angle = (part.ravel() for part in decimated(grid, angle, pitch))
    kept = np.isfinite(angle) & (np.hypot(x, y) > 0.8 * pitch)
    half = 0.36 * pitch * np.stack([np.cos(angle), np.sin(angle)], axis=-1)[kept]
    middle = np.stack([x, y], axis=-1)[kept]
    edge = patheffects.withStroke(linewidth=1.7, foreground="#00000080")
    ends = np.stack([middle - half, middle + half], axis=1)
    return LineCollection(ends, colors="white", linewidths=0.95, capstyle="round", path_effects=[edge])


def decimated(grid, angle, pitch):
    """The grid points nearest to a lattice of the given pitch, through the origin if it is in view."""
    columns, rows = (nearest(axis, pitch) for axis in (grid.x, grid.y))
    x, y = np.meshgrid(grid.x[columns], grid.y[rows])
    return x, y, angle[np.ix_(rows, columns)]


def nearest(axis, pitch):
    steps = np.arange(np.ceil(axis[0] / pitch + 0.4), np.floor(axis[-1] / pitch - 0.4) + 1) * pitch
    return np.unique([np.abs(axis - step).argmin() for step in steps])


def caption(run, spec):
    return ("Strain around one rod at the origin that heads along +<i>x</i>. Segments: extensional principal axis of the "
            "traceless strain, along which a second rod turns for <i>κ</i> > 0. Colour, log scale: its positive eigenvalue. "
            + field_map.medium_note(run))


def defaults(run):
    return [Spec("extensional_axis", "extensional_axis")] if run.result.has("/field/grid") else []
