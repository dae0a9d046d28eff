"""Paths of rods and those of the fitted equations of motion, with what is left between them."""

import numpy as np
from matplotlib.lines import Line2D

from . import canvas, fit_words, path_panel, style, words
from .errors import PlotError
from .spec import Spec

MOST_MARKS = 40  # a path
MOST_COLUMNS = 3


def draw(run, spec):
    found = read(run.fit)
    columns = min(len(found), MOST_COLUMNS)
    rows = -(-len(found) // columns)
    figure = canvas.figure(style.WIDE if columns > 1 else style.SINGLE + 0.6, rows * 4.6 + 0.3)
    grid = figure.add_gridspec(3 * rows, columns, height_ratios=[2.6, 1, 1] * rows)
    for index, (name, paths) in enumerate(found):
        row, column = divmod(index, columns)
        top = figure.add_subplot(grid[3 * row, column])
        above = figure.add_subplot(grid[3 * row + 1, column])
        below = figure.add_subplot(grid[3 * row + 2, column], sharex=above)
        reduced = in_reduced_units(run, index)
        draw_paths(top, paths, reduced)
        draw_residuals(above, below, paths, reduced, column == 0)
        canvas.heading(top, f"{fit_words.letter(index)}  {style.safe(name)}" if len(found) > 1 else style.safe(spec.title or name))
    handles = [Line2D([], [], marker="o", markersize=3.4, linestyle="none", color=style.GREY, label="data"),
               Line2D([], [], color=style.GREY, linewidth=1.3, label="fit")]
    figure.legend(handles=handles, loc="upper center", bbox_to_anchor=(0.5, 0.0), ncols=2, frameon=False, fontsize=9)
    if spec.title and len(found) > 1:
        figure.suptitle(style.safe(spec.title), fontsize=11)
    return figure


def read(fit):
    if not fit.trajectories:
        raise PlotError(f"{fit.path}: holds no trajectories; a fit to profiles is drawn by kind fit")
    return [(str(one.get("name", "")), fit.paths(one)) for one in fit.trajectories]


def in_reduced_units(run, index):
    """Else the file has units of its own, of which the scene tells the size alone."""
    asked = run.scene.get("fit", {}).get("trajectories", [])
    return index < len(asked) and all(asked[index].get(key, 1.0) == 1.0 for key in ("f_over_mu", "speed"))


def axis(symbol, reduced, unit=r"\,\mu/f"):
    return f"${symbol}{unit if reduced else ''}$"


def draw_paths(axes, paths, reduced):
    _, data, model = paths
    every = -(-data.shape[0] // MOST_MARKS)
    for rod in range(data.shape[1]):
        colour = path_panel.colour_of(rod)
        axes.plot(data[::every, rod, 0], data[::every, rod, 1], "o", color=colour, markersize=2.8, markeredgewidth=0)
        axes.plot(model[:, rod, 0], model[:, rod, 1], color=colour, linewidth=1.2)
        axes.annotate(str(rod), data[0, rod, :2], (-7, 0), textcoords="offset points", ha="center", va="center", color=colour, fontsize=9)
    axes.set_aspect("equal", adjustable="datalim")
    axes.margins(0.12)
    axes.set(xlabel=axis("x", reduced), ylabel=axis("y", reduced))


def draw_residuals(above, below, paths, reduced, named):
    """Data minus fit: along x filled, along y hollow, and of the heading."""
    t, data, model = paths
    for axes in (above, below):
        axes.axhline(0, color=style.GREY, linewidth=0.6, zorder=1)
    for rod in range(data.shape[1]):
        colour = path_panel.colour_of(rod)
        left = data[:, rod] - model[:, rod]
        look = dict(color=colour, markersize=2.6, markeredgewidth=0.6, linestyle="none")
        above.plot(t, left[:, 0], "o", **look)
        above.plot(t, left[:, 1], "o", markerfacecolor="white", **look)
        below.plot(t, turned(left[:, 2]), "o", **look)
    above.tick_params(labelbottom=False)
    below.set_xlabel(axis("t", reduced, r"\,\mu v_0/f"))
    for axes in (above, below):
        low, high = axes.get_ylim()
        size = max(-low, high) or 1.0
        axes.set_ylim(-size, size)
    above.set_ylabel(axis(r"(\Delta x, \Delta y)", reduced) if named else "", fontsize=9)
    below.set_ylabel(r"$\Delta\theta$ / rad" if named else "", fontsize=9)


def turned(angle):
    """Into (-pi, pi]: a full turn is no difference."""
    return np.angle(np.exp(1j * angle))


def caption(run, spec):
    found = read(run.fit)
    text = ("Paths of the rods (points, numbered at their starts) and those of the fitted equations of motion (lines); below, data minus fit "
            "against time: along <i>x</i> (filled), along <i>y</i> (hollow), and of the headings. ")
    for index, (one, _) in enumerate(zip(run.fit.trajectories, found)):
        length = "<i>f</i>/<i>μ</i>" if in_reduced_units(run, index) else "in the unit of the file"
        parts = [f"{name} {words.number(run.fit.number(one, key), 3)} {unit}" for key, name, unit in (
            ("rms_position", "positions", length), ("rms_heading", "headings", "rad")) if one.get(key) is not None]
        if parts:
            text += f"{fit_words.letter(index) + ' ' if len(found) > 1 else ''}Root mean square of what is left: {', '.join(parts)}. "
    return text


def defaults(run):
    return [Spec("fit_trajectories", "fit_trajectories")] if run.fit.trajectories else []
