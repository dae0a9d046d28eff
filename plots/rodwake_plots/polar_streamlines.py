"""Streamlines of gamma1 lap u + gamma2 grad div u over its magnitude (paper, Fig. sup_ufield), a panel per pair."""

import math
import string

import numpy as np

from . import canvas, field_map, ranges, style, words
from .field_map import draw_rod, grid_of, paint
from .spec import Spec

LINES = 0.85  # density of streamlines; 1 is matplotlib's 30 across


def draw(run, spec):
    grid = grid_of(run.result, spec)
    fields = [polar_field(run.result, grid, *pair) for pair in spec.gammas]
    norm, extend = ranges.log_norm(*(np.hypot(*vector) for vector in fields))
    figure, panels = layout(grid, len(fields))
    for index, (axes, pair, vector) in enumerate(zip(panels, spec.gammas, fields)):
        image = panel(axes, grid, vector, norm)
        letter = rf"({string.ascii_lowercase[index % 26]})  " if len(fields) > 1 else ""
        canvas.heading(axes, letter + pair_label(*pair))
    label = rf"$|\gamma_1\nabla^2\mathbf{{u}}+\gamma_2\nabla\nabla\cdot\mathbf{{u}}|$  (${run.result.units.gradient_unit()}$)"
    ranges.log_bar(figure, image, panels, extend, label, **bar_place(panels, grid))
    figure.suptitle(field_map.heading_of(run, spec.title), fontsize=10.5)
    return figure


def bar_place(panels, grid):
    """Beside the panels, or below them where they are too low for the label."""
    rows = panels[0].get_subplotspec().get_gridspec().nrows
    if rows == 1 and len(panels) > 1 and grid.aspect < 0.8:
        return dict(location="bottom", shrink=0.6, aspect=40, pad=0.04)
    return dict(pad=0.015, aspect=25 * rows)


def polar_field(result, grid, gamma1, gamma2):
    lap, grad = (("lapx", "lapy"), ("gradx_tr", "grady_tr"))
    return tuple(gamma1 * result.grid(l)[grid.crop] + gamma2 * result.grid(g)[grid.crop] for l, g in zip(lap, grad))


def layout(grid, count):
    columns = min(count, 3 if grid.aspect > 0.45 else 2 if grid.aspect > 0.25 else 1)
    if count % columns:  # no lone panel beside a hole if two columns come out even
        columns = next(c for c in (columns, 2, 1) if c <= columns and (count % c == 0 or c == 1))
    rows = math.ceil(count / columns)
    width = style.WIDE if columns > 1 else style.SINGLE
    height = rows * ((width - 1.2) / columns * grid.aspect + 0.45) + (0.9 if grid.aspect < 0.8 else 0.3)
    figure = canvas.figure(width, height)
    axes = figure.subplots(rows, columns, squeeze=False, sharex=True, sharey=True)
    for row in axes:
        row[0].set_ylabel(grid.ylabel)
    return figure, list(axes.ravel())


def panel(axes, grid, vector, norm):
    magnitude = np.hypot(*vector)
    image = paint(axes, grid, magnitude, norm)
    # Unit vectors: the integrator's step follows the length, which spans decades here.
    with np.errstate(invalid="ignore", divide="ignore"):
        unit = [np.ma.masked_invalid(part / magnitude) for part in vector]
    # Recomputed axes: streamplot wants them evenly spaced to the last bit.
    x, y = (np.linspace(axis[0], axis[-1], axis.size) for axis in (grid.x, grid.y))
    axes.streamplot(x, y, *unit, color="white", linewidth=0.75, arrowsize=0.7, arrowstyle="-|>",
                    density=density(grid), minlength=0.2)
    canvas.window(axes, (grid.x[0], grid.x[-1]), (grid.y[0], grid.y[-1]))  # streamplot rescales
    draw_rod(axes, grid)
    axes.label_outer()
    return image


def density(grid):
    """Lines as dense along x as along y on paper."""
    return tuple(LINES * part for part in ((1.0, grid.aspect) if grid.aspect < 1 else (1.0 / grid.aspect, 1.0)))


def pair_label(gamma1, gamma2):
    return rf"$\gamma_1/v_0={words.math_number(gamma1)},\ \gamma_2/v_0={words.math_number(gamma2)}$"


def caption(run, spec):
    return ("Streamlines of <i>γ</i><sub>1</sub>∇²<b>u</b> + <i>γ</i><sub>2</sub>∇∇·<b>u</b> around one rod at the origin that "
            "heads along +<i>x</i>, over its magnitude (colour, log scale). " + field_map.medium_note(run))


def defaults(run):
    return [Spec("polar_streamlines", "polar_streamlines")] if run.result.has("/field/grid") else []
