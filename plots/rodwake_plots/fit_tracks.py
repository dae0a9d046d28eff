"""Displacement maps, the fitted field of the orthotropic medium, and the residuals; bins that were not fitted are grey."""

import numpy as np
from matplotlib.colors import Normalize
from matplotlib.lines import Line2D

from . import canvas, fit_words, style, trajectories, words
from .errors import PlotError
from .schema import Kind

COLUMNS = ("data", "fit", "data − fit")
DIFFERENCES = "RdBu_r"
MASKED = "#b8b8b8"


def draw_fit_map(run, spec):
    x, y, used, rows, count = read_maps(run.fit)
    figure = canvas.figure(style.WIDE, style.WIDE * 0.64 * np.ptp(y) / np.ptp(x) + 0.9)
    panels = figure.subplots(2, len(COLUMNS), sharex=True, sharey=True)
    for letter, line, (data, model) in zip("xy", panels, rows):
        norm = map_scale(data[used])
        for axes, values in zip(line, (data, model, data - model)):
            shown = values if values is data else np.where(used, values, np.nan)  # the field is no fit inside the mask
            image = axes.pcolormesh(x, y, shown, norm=norm, cmap=DIFFERENCES, shading="nearest", rasterized=True)
            axes.set_facecolor(MASKED)
            outline(axes, x, y, used)
            axes.set_aspect("equal")
        label = f"$U_{letter}$ / {fit_words.words_of(run.fit.unit)}"
        canvas.colour_bar(figure, image, list(line), label, pad=0.015, aspect=18, extend="both", extendfrac=0.05)
        line[0].set_ylabel(fit_words.axis("y", run.fit.unit))
    for axes, title in zip(panels[0], COLUMNS):
        canvas.heading(axes, title)
    for axes in panels[1]:
        axes.set_xlabel(fit_words.axis("x", run.fit.unit))
    if spec.title:
        figure.suptitle(style.safe(spec.title), fontsize=11)
    return figure


def read_maps(fit):
    """x, y, which bins were fitted, (data, model) of both components and of how many maps they are the mean."""
    if not fit.maps:
        raise PlotError(f"{fit.path}: holds no maps; a fit to profiles is drawn by kind fit")
    maps = [fit.map(one) for one in fit.maps]
    first = maps[0]
    alike = [one for one in maps if one.x.shape == first.x.shape and one.y.shape == first.y.shape
             and np.allclose(one.x, first.x) and np.allclose(one.y, first.y)]
    used = np.any([one.used for one in alike], axis=0)
    if not used.any():
        raise PlotError(f"{fit.path}: no bin of the maps was fitted: nothing to draw")
    return first.x, first.y, used, [(mean([one.data[k] for one in alike]), mean([one.model[k] for one in alike])) for k in (0, 1)], len(alike)


def mean(values):
    """Over the maps that have the bin; nan where none has."""
    values = np.array(values)
    seen = np.isfinite(values)
    return np.where(seen.any(axis=0), np.where(seen, values, 0).sum(axis=0) / np.maximum(seen.sum(axis=0), 1), np.nan)


def map_scale(values):
    """Of what was fitted; the masked ridge may be beyond it."""
    values = values[np.isfinite(values)]
    top = np.percentile(np.abs(values), 99.5) if values.size else 1.0
    return Normalize(-(top or 1.0), top or 1.0)


def outline(axes, x, y, used):
    if used.all():
        return
    axes.contour(x, y, np.where(used, 0.0, 1.0), levels=[0.5], colors=style.INK, linewidths=0.7)


def caption_fit_map(run, spec):
    count, total = read_maps(run.fit)[-1], len(run.fit.maps)
    values = fit_words.medium_values(run.fit) or fit_words.values(run.fit.free)
    text = "Measured displacement around the rod, which heads along +<i>x</i>; the fitted steady field of an "
    text += f"{run.fit.maps[0].get('medium') or 'orthotropic'} medium in the periodic box; "
    text += "and the residuals, in the same colours. Outlined: masked or without data, so not fitted; fit and residuals are grey there. "
    if total > 1:
        text += f"Means of {words.number(count)} maps. " if count == total else f"Means of {count} of the {total} maps, those on one grid. "
    return text + (f"Fitted: {values}. " if values else "")


# Paths of rods and those of the fitted equations of motion, with what is left between them.

MOST_MARKS = 40  # a path
MOST_COLUMNS = 3


def draw_fit_trajectories(run, spec):
    found = read_paths(run.fit)
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
        canvas.heading(top, f"{words.letter(index)}  {style.safe(name)}" if len(found) > 1 else style.safe(spec.title or name))
    handles = [Line2D([], [], marker="o", markersize=3.4, linestyle="none", color=style.GREY, label="data"),
               Line2D([], [], color=style.GREY, linewidth=1.3, label="fit")]
    figure.legend(handles=handles, loc="upper center", bbox_to_anchor=(0.5, 0.0), ncols=2, frameon=False, fontsize=9)
    if spec.title and len(found) > 1:
        figure.suptitle(style.safe(spec.title), fontsize=11)
    return figure


def read_paths(fit):
    if not fit.trajectories:
        raise PlotError(f"{fit.path}: holds no trajectories; a fit to profiles is drawn by kind fit")
    return [(str(one.get("name", "")), fit.paths(one)) for one in fit.trajectories]


def in_reduced_units(run, index):
    """Else the file has units of its own, of which the scene tells the size alone."""
    asked = run.scene.get("fit", {}).get("trajectories", [])
    return index < len(asked) and all(asked[index].get(key, 1.0) == 1.0 for key in ("f_over_mu", "speed"))


def path_axis(symbol, reduced, unit=r"\,\mu/f"):
    return f"${symbol}{unit if reduced else ''}$"


def draw_paths(axes, paths, reduced):
    _, data, model = paths
    every = -(-data.shape[0] // MOST_MARKS)
    for rod in range(data.shape[1]):
        colour = trajectories.colour_of(rod)
        axes.plot(data[::every, rod, 0], data[::every, rod, 1], "o", color=colour, markersize=2.8, markeredgewidth=0)
        axes.plot(model[:, rod, 0], model[:, rod, 1], color=colour, linewidth=1.2)
        axes.annotate(str(rod), data[0, rod, :2], (-7, 0), textcoords="offset points", ha="center", va="center", color=colour, fontsize=9)
    axes.set_aspect("equal", adjustable="datalim")
    axes.margins(0.12)
    axes.set(xlabel=path_axis("x", reduced), ylabel=path_axis("y", reduced))


def draw_residuals(above, below, paths, reduced, named):
    """Data minus fit: along x filled, along y hollow, and of the heading."""
    t, data, model = paths
    for axes in (above, below):
        axes.axhline(0, color=style.GREY, linewidth=0.6, zorder=1)
    for rod in range(data.shape[1]):
        colour = trajectories.colour_of(rod)
        left = data[:, rod] - model[:, rod]
        look = dict(color=colour, markersize=2.6, markeredgewidth=0.6, linestyle="none")
        above.plot(t, left[:, 0], "o", **look)
        above.plot(t, left[:, 1], "o", markerfacecolor="white", **look)
        below.plot(t, turned(left[:, 2]), "o", **look)
    above.tick_params(labelbottom=False)
    below.set_xlabel(path_axis("t", reduced, r"\,\mu v_0/f"))
    for axes in (above, below):
        low, high = axes.get_ylim()
        size = max(-low, high) or 1.0
        axes.set_ylim(-size, size)
    above.set_ylabel(path_axis(r"(\Delta x, \Delta y)", reduced) if named else "", fontsize=9)
    below.set_ylabel(r"$\Delta\theta$ / rad" if named else "", fontsize=9)


def turned(angle):
    """Into (-pi, pi]: a full turn is no difference."""
    return np.angle(np.exp(1j * angle))


def caption_fit_trajectories(run, spec):
    found = read_paths(run.fit)
    text = ("Paths of the rods (points, numbered at their starts) and of the fitted equations of motion (lines); below, data minus fit "
            "against time: along <i>x</i> (filled), along <i>y</i> (hollow), and of the headings. ")
    for index, (one, _) in enumerate(zip(run.fit.trajectories, found)):
        length = "<i>f</i>/<i>μ</i>" if in_reduced_units(run, index) else "in the unit of the file"
        parts = [f"{name} {words.number(run.fit.number(one, key), 3)} {unit}" for key, name, unit in (
            ("rms_position", "positions", length), ("rms_heading", "headings", "rad")) if one.get(key) is not None]
        if parts:
            text += f"{words.letter(index) + ' ' if len(found) > 1 else ''}Root mean square of the residuals: {', '.join(parts)}. "
    return text


KINDS = {
    "fit_map": Kind(draw=draw_fit_map, caption=caption_fit_map, there=lambda run: run.fit.maps),
    "fit_trajectories": Kind(draw=draw_fit_trajectories, caption=caption_fit_trajectories, there=lambda run: run.fit.trajectories),
}
