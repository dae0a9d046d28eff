"""Paths of the rods, coloured by time (paper, Figs. attraction b, pletraj, nonreciptheory a); a panel per variant."""

import math
import string

import matplotlib.patheffects as patheffects
import numpy as np
from matplotlib.cm import ScalarMappable
from matplotlib.collections import LineCollection
from matplotlib.colors import Normalize

from . import canvas, glyphs, style, words
from .errors import PlotError
from .paths import mark_interval, mark_times, pose, seen_until, window_of

MOST_LABELS = 12  # more rods than this and the numbers would hide the paths


def draw(run, spec):
    runs = runs_of(run.result)
    window = window_of(runs, spec)
    length = run.result.units.length("x", max(map(abs, window.x + window.y)))
    last = seen_until(runs, window)
    time = run.result.units.time("t", last)
    norm = Normalize(0, last * time.factor)
    figure, panels = layout(window, len(runs))
    for axes, one in zip(panels, runs):
        panel(axes, one, window, length.factor, time.factor, norm, mark_interval(last))
        title(axes, run.result.units, one, spec, len(runs), runs.index(one))
    label_axes(run.result.units, panels, max(map(abs, window.x + window.y)))
    colour_bar(figure, panels, norm, time.label, window, any(one.t[-1] > last * (1 + 1e-9) for one in runs))
    if spec.title and len(runs) > 1:
        figure.suptitle(style.safe(spec.title), fontsize=11)
    return figure


def runs_of(result):
    runs = result.runs()
    if not runs:
        raise PlotError(f"{result.path}: group /rods is missing: no trajectories to draw")
    return runs


def layout(window, count):
    """Panels of equal scale; columns chosen so that the figure is neither a tower nor a ribbon."""
    columns = best_columns(window.aspect, count)
    rows = math.ceil(count / columns)
    flat = window.aspect < 0.6
    width = style.WIDE if columns > 1 else style.SINGLE + 0.5
    inner = (width - (0.6 if flat else 1.3)) / columns - 0.1
    height = rows * (inner * window.aspect + 0.6) + (1.0 if flat else 0.3)
    figure = canvas.figure(width, height)
    axes = list(figure.subplots(rows, columns, squeeze=False, sharex=True, sharey=True).ravel())
    for unused in axes[count:]:
        unused.remove()
    for index in range(max(0, count - columns), count):  # the lowest panel of each column keeps its numbers
        axes[index].tick_params(labelbottom=True)
    return figure, axes[:count]


def best_columns(aspect, count):
    def cost(columns):
        rows = math.ceil(count / columns)
        holes = rows * columns - count
        return abs(math.log(rows * aspect / columns / 0.65)) + 0.6 * holes
    return min(range(1, min(count, 3) + 1), key=cost)


def panel(axes, run, window, factor, time_factor, norm, interval):
    for rod in range(run.x.shape[1]):
        path(axes, run, rod, factor, time_factor, norm)
        marks(axes, run, rod, factor, interval)
    for rod in range(run.x.shape[1] if run.x.shape[1] <= MOST_LABELS else 0):
        name_rod(axes, run, rod, factor)
    canvas.window(axes, *(tuple(factor * edge for edge in pair) for pair in (window.x, window.y)))


def path(axes, run, rod, factor, time_factor, norm):
    points = np.stack([run.x[:, rod], run.y[:, rod]], axis=-1) * factor
    pieces = np.stack([points[:-1], points[1:]], axis=1)
    middle = (run.t[:-1] + run.t[1:]) / 2 * time_factor
    lines = LineCollection(pieces, array=middle, cmap=style.TIME_MAP, norm=norm, linewidths=2.0, capstyle="round", zorder=2)
    axes.add_collection(lines, autolim=False)


def marks(axes, run, rod, factor, interval):
    """Heading at equal times (small), at the start (hollow) and at the end (filled)."""
    colour = style.ROD_COLOURS[rod % len(style.ROD_COLOURS)]
    for time in mark_times(run, interval):
        x, y, theta = pose(run, rod, time)
        glyphs.rod(axes, x * factor, y * factor, theta, 9, facecolor=colour, edgecolor="white", linewidth=0.4, zorder=3)
    for index, face in ((0, "white"), (-1, colour)):
        place = run.x[index, rod] * factor, run.y[index, rod] * factor, run.theta[index, rod]
        glyphs.rod(axes, *place, 15, facecolor=face, edgecolor=colour, linewidth=1.2, zorder=4)


def name_rod(axes, run, rod, factor):
    """The rod's number behind its start, where its own path does not pass."""
    theta = run.theta[0, rod]
    axes.annotate(str(rod + 1), (run.x[0, rod] * factor, run.y[0, rod] * factor), (-14 * math.cos(theta), -14 * math.sin(theta)),
                  textcoords="offset points", ha="center", va="center", fontsize=10, annotation_clip=True, zorder=5,
                  color=style.ROD_COLOURS[rod % len(style.ROD_COLOURS)],
                  path_effects=[patheffects.withStroke(linewidth=2, foreground="white")])


def title(axes, units, run, spec, count, index):
    if count == 1:
        canvas.heading(axes, style.safe(spec.title) or outcome_line(units, run))
        return
    letter = f"({string.ascii_lowercase[index % 26]})"
    canvas.heading(axes, f"{letter}  {style.safe(run.label)}\n{outcome_line(units, run)}")
    axes.title.set_fontsize(9.5)


def outcome_line(units, run):
    if "time" not in run.attrs:
        return run.outcome
    time = units.time("t", run.attrs["time"])
    value = words.number(run.attrs["time"] * time.factor)
    unit = time.label.split("$ ", 1)[1].strip("()") if units.si else ""
    left = "t" if units.si else time.label.strip("$")
    return f"{run.outcome}, ${left} = {value}$ {unit}".rstrip()


def label_axes(units, panels, extent):
    for axes in panels:
        axes.set_xlabel(units.length("x", extent).label)
        axes.set_ylabel(units.length("y", extent).label)
        axes.label_outer()
        axes.locator_params(nbins=6)


def colour_bar(figure, panels, norm, label, window, more):
    flat = window.aspect < 0.6 and len(panels) <= 2
    place = dict(location="bottom", shrink=0.75, aspect=40, pad=0.03) if flat else dict(pad=0.015, aspect=30)
    bar = figure.colorbar(ScalarMappable(norm, style.TIME_MAP), ax=panels, extend="max" if more else "neither", **place)
    bar.set_label(label)
    bar.ax.tick_params(direction="in")


def caption(run, spec):
    runs, units = runs_of(run.result), run.result.units
    interval = words.number(mark_interval(seen_until(runs, window_of(runs, spec))))
    rods = runs[0].x.shape[1]
    text = (f"Paths of {rods} rods, coloured by time: hollow mark at the start, filled at the end, small marks every "
            f"{interval} {units.time_html()}; the thin end points forward. " if rods > 1 else "Path of one rod, coloured by time. ")
    if len(runs) > 1:
        text += " ".join(f"({string.ascii_lowercase[i % 26]}) {words.label_html(one.label)}: {outcome_words(units, one)}."
                         for i, one in enumerate(runs))
        return text
    return text + outcome_words(units, runs[0]).capitalize() + ". " + parameters(runs[0])


def outcome_words(units, run):
    parts = [words.escape(run.outcome)]
    if "time" in run.attrs:
        parts[0] += f" at <i>t</i> = {words.number(run.attrs['time'])} {units.time_html()}"
    if "min_separation" in run.attrs:
        parts.append(f"closest approach {words.number(run.attrs['min_separation'])} {units.length_html()}")
    return ", ".join(parts)


def parameters(run):
    symbols = {"eta": "<i>η</i>", "alpha": "<i>α</i>", "kappa": "<i>κ</i>", "gamma1": "<i>γ</i><sub>1</sub>", "gamma2": "<i>γ</i><sub>2</sub>"}
    known = [f"{symbol} = {words.number(run.attrs[key])}" for key, symbol in symbols.items() if key in run.attrs]
    return ", ".join(known) + "." if known else ""
