"""Paths of the rods, coloured by time (paper, Figs. 9 b, 11, 12 a); a panel per variant."""

import math
from typing import NamedTuple

import numpy as np
from matplotlib import patheffects
from matplotlib.cm import ScalarMappable
from matplotlib.collections import LineCollection
from matplotlib.colors import Normalize, to_rgba
from matplotlib.transforms import ScaledTranslation

from . import bodies, canvas, schema, style, words
from .errors import MissingError, PlotError
from .schema import Kind

FLAT = 0.6  # windows flatter than this have the colour bar below
PARAMETERS = "eta", "alpha", *schema.COUPLINGS


def draw(run, spec):
    runs, units = runs_of(run.result), run.result.units
    window = window_of(runs, spec, bodies.reach(run))
    last = seen_until(runs, window)
    extent = max(map(abs, window.x + window.y))
    length, time = units.length("x", extent), units.time("t", last)
    look = Look(length.factor, time.factor, Normalize(0, last * time.factor or 1.0), mark_interval(last),
                lie_on_each_other(runs, window), run if bodies.has_bodies(run) else None)
    overlay = spec.overlay and len(runs) > 1
    figure, grid = layout(window, 1 if overlay else len(runs))
    panels = list(grid.ravel())
    canvas.outer_labels(panels[:len(panels) if overlay else len(runs)], grid.shape[1], length.label, units.length("y", extent).label)
    if overlay:
        figure.set_figheight(figure.get_figheight() - (0.9 if window.aspect < FLAT else 0.0))  # no colour bar below
        overlaid(panels[0], runs, units, window, look)
        canvas.heading(panels[0], "\n".join(filter(None, (style.safe(spec.title), shared(units, runs)))))
        return figure
    for index, (axes, one) in enumerate(zip(panels, runs)):
        title(axes, units, one, spec, index if len(runs) > 1 else None)
        draw_panel(axes, one, window, look)
    for index, spare in enumerate(panels[len(runs):]):
        spare.set_axis_off()
        if index == 0:
            marks_key(spare, look, time.label)
    if not look.apart:
        colour_bar(figure, panels, look.norm, time.label, window, any(one.t[-1] > last * (1 + 1e-9) for one in runs))
    if len(runs) > 1:
        figure.suptitle("\n".join(filter(None, (style.safe(spec.title), shared(units, runs)))), fontsize=10.5)
    return figure


def overlaid(axes, runs, units, window, look):
    """A colour for each run, and a legend."""
    canvas.window(axes, *(tuple(look.length * edge for edge in pair) for pair in (window.x, window.y)))
    for run, colour in zip(runs, canvas.colours(len(runs))):
        axes.plot([], [], color=colour, label=f"{style.label(run.label)}: {outcome_line(units, run)}")
        for rod in range(run.x.shape[1]):
            x, y = (look.length * part for part in path(run, rod, fine_times(run)))
            axes.plot(x, y, color=colour, linewidth=1.3, scalex=False, scaley=False)
            for index, mark in ((0, hollow), (-1, filled)):
                mark(axes, x[index], y[index], run.theta[index, rod], colour)
    axes.figure.legend(loc="upper center", bbox_to_anchor=(0.5, 0.0), frameon=False, fontsize=8.5, handlelength=1.6)


def runs_of(result):
    runs = result.runs()
    if not runs:
        raise MissingError(result.path, "group /rods is missing: no trajectories to draw")
    return runs


def layout(window, count):
    """Panels of equal scale; columns chosen so that the figure is neither a tower nor a ribbon."""
    columns = best_columns(window.aspect, count)
    rows = math.ceil(count / columns)
    flat = window.aspect < FLAT
    width = style.WIDE if columns > 1 else style.SINGLE + 0.5
    inner = (width - (0.6 if flat else 1.3)) / columns - 0.1
    height = rows * (inner * window.aspect + 0.6) + (1.0 if flat else 0.3)
    figure = canvas.figure(width, height)
    return figure, figure.subplots(rows, columns, squeeze=False, sharex=True, sharey=True)


def best_columns(aspect, count):
    def cost(columns):
        rows = math.ceil(count / columns)
        holes = rows * columns - count
        return abs(math.log(rows * aspect / columns / 0.65)) + 0.6 * holes
    return min(range(1, min(count, 3) + 1), key=cost)


def title(axes, units, run, spec, index):
    if index is None:
        canvas.heading(axes, "\n".join(filter(None, (style.safe(spec.title) or outcome_line(units, run), shared(units, [run])))))
        return
    letter = words.letter(index)
    canvas.heading(axes, f"{letter}  {style.safe(run.label)}\n{outcome_line(units, run)}")
    axes.title.set_fontsize(9.5)


def shared(units, runs):
    """Medium and couplings that all runs have, for the head of the figure; couplings that are zero go without saying."""
    keys = [key for key in PARAMETERS if key in runs[0].attrs and len({one.attrs.get(key) for one in runs}) == 1]
    return ",  ".join(f"${units.parameter(key, runs[0].attrs[key], 3)}$" for key in keys if runs[0].attrs[key] or key in ("eta", "alpha"))


def outcome_line(units, run):
    if "time" not in run.attrs:
        return run.outcome
    return f"{run.outcome}, {units.equals(units.time('t', run.attrs['time']), 't', run.attrs['time'])}"


def colour_bar(figure, panels, norm, label, window, more):
    flat = window.aspect < FLAT and len(panels) <= 2
    place = dict(location="bottom", shrink=0.75, aspect=40, pad=0.03) if flat else dict(pad=0.015, aspect=30)
    canvas.colour_bar(figure, ScalarMappable(norm, style.TIME_MAP), panels, label, extend="max" if more else "neither", **place)


def caption(run, spec):
    runs, units = runs_of(run.result), run.result.units
    interval = words.number(mark_interval(seen_until(runs, window_of(runs, spec))))
    rods = runs[0].x.shape[1]
    text = f"Paths of {rods} rods" if rods > 1 else "Path of one rod"
    overlay = spec.overlay and len(runs) > 1
    apart = lie_on_each_other(runs, window_of(runs, spec)) and not overlay
    text += ", of all variants in one panel: hollow mark at the start, filled at the end. " if overlay else ""
    if overlay:
        return text + " ".join(f"{words.label_html(one.label)}: {outcome_words(units, one)}." for one in runs)
    text += ", coloured by rod and moved apart by about a line's width where they would hide each other" if apart else ", coloured by time"
    text += f": hollow mark at the start, filled at the end, small marks every {interval} {units.time_html()}; the thin end points forward. "
    if any(run.samples for run in runs):
        text += "Thin lines: the same rods in fields drawn from the errors of the measured field. "
    if len(runs) == 1:
        outcome = outcome_words(units, runs[0])
        return text + outcome[0].upper() + outcome[1:] + ". " + parameters(units, runs[0])
    outcomes = (f"{words.label_html(one.label)}: {outcome_words(units, one)}." for one in runs)
    return text + " ".join(f"{words.letter(i)} {one}" for i, one in enumerate(outcomes))


def outcome_words(units, run):
    parts = [words.escape(run.outcome)]
    if "time" in run.attrs:
        parts[0] += " at " + words.equation("<i>t</i>", run.attrs["time"], units.time_html(), digits=6)
    if "min_separation" in run.attrs:
        parts.append(f"closest approach {words.number(run.attrs['min_separation'])} {units.length_html()}")
    return ", ".join(parts)


def parameters(units, run):
    """With units, as HTML."""
    known = [f'<span class="eq">{words.tex_html(units.parameter(key, run.attrs[key]))}</span>' for key in PARAMETERS if key in run.attrs]
    return ", ".join(known) + "." if known else ""


# Choices about paths that a figure and its caption must make alike: window, marks, time range.

NARROWEST, TALLEST = 0.3, 1.5  # height over width of a window fitted to the data
MARKS = 6                      # about so many heading marks along a path
LINE = 0.006                   # width of a drawn line over the longer side of the window
MOST_ON_EACH_OTHER = 0.15      # of a path; crossings and a meeting at the end stay below


class Window(NamedTuple):
    x: tuple
    y: tuple

    @property
    def aspect(self):
        return (self.y[1] - self.y[0]) / (self.x[1] - self.x[0])

    def holds(self, x, y):
        return (self.x[0] <= x) & (x <= self.x[1]) & (self.y[0] <= y) & (y <= self.y[1])


def window_of(runs, spec, reach=0.0):
    """The figure's window, or all paths with a margin in a box of sane shape, `reach` the half length of the longest body."""
    x = span(np.concatenate([run.x.ravel() for run in runs]))
    y = span(np.concatenate([run.y.ravel() for run in runs]))
    margin = (0.09 if len(runs) == 1 else 0.13) * max(x[1] - x[0], y[1] - y[0]) or 1.0
    x, y = grown(x, max(margin, reach)), grown(y, max(margin, reach))
    if (y[1] - y[0]) < NARROWEST * (x[1] - x[0]):
        y = widened(y, NARROWEST * (x[1] - x[0]))
    if (y[1] - y[0]) > TALLEST * (x[1] - x[0]):
        x = widened(x, (y[1] - y[0]) / TALLEST)
    return Window(spec.x or x, spec.y or y)


def lie_on_each_other(runs, window):
    """Whether, in some run, a good part of a rod's path hides that of another, whenever each was there."""
    near = LINE * max(window.x[1] - window.x[0], window.y[1] - window.y[0])
    return any(share_hidden(run, window, one, other, near) > MOST_ON_EACH_OTHER for run in runs
               for one in range(min(run.x.shape[1], 12)) for other in range(min(run.x.shape[1], 12)) if one != other)


def share_hidden(run, window, one, other, near):
    """Part of the visible path of rod `one` that is within `near` of rod `other`'s."""
    here, there = (evenly(run.x[:, rod], run.y[:, rod]) for rod in (one, other))
    here = here[window.holds(*here.T)]
    if len(here) == 0 or len(there) == 0:
        return 0.0
    away = np.linalg.norm(here[:, None] - there[None], axis=-1).min(axis=1)
    return float((away < near).mean())


def evenly(x, y, count=400):
    """Points [n][2] at equal distances along a path; none of a rod that stays where it is."""
    kept = np.isfinite(x) & np.isfinite(y)
    x, y = x[kept], y[kept]
    way = np.concatenate([[0.0], np.cumsum(np.hypot(np.diff(x), np.diff(y)))]) if x.size else np.zeros(1)
    if not way[-1] > 0:
        return np.empty((0, 2))
    places = np.linspace(0.0, way[-1], count)
    return np.stack([np.interp(places, way, x), np.interp(places, way, y)], axis=-1)


def span(values):
    values = values[np.isfinite(values)]
    if values.size == 0:
        raise PlotError("the paths hold no finite positions")
    return float(values.min()), float(values.max())


def grown(pair, margin):
    return pair[0] - margin, pair[1] + margin


def widened(pair, size):
    middle = sum(pair) / 2
    return middle - size / 2, middle + size / 2


def seen_until(runs, window):
    """The last time at which any rod is in view: the end of the time colours."""
    last = [run.t[window.holds(run.x, run.y).any(axis=1)] for run in runs]
    return max((times[-1] for times in last if times.size and times[-1] > 0), default=max(run.t[-1] for run in runs))


def mark_interval(last):
    """A round time that puts about MARKS marks on a path."""
    decade = 10.0 ** np.floor(np.log10(last / MARKS)) if last > 0 else 1.0
    return float(min((step * decade for step in (1, 2, 2.5, 5, 10)), key=lambda step: abs(last / step - MARKS)))


def mark_times(run, interval):
    """Multiples of the interval, clear of the start and end marks."""
    times = np.arange(1, np.floor(run.t[-1] / interval) + 1) * interval
    return times[times < run.t[-1] - 0.3 * interval]


def path(run, rod, times):
    """x and y at these times: cubics between the rows along the headings there, since a rod walks along its heading. An orbit of few
    rows a turn is round."""
    x, y, theta = run.x[:, rod], run.y[:, rod], np.unwrap(run.theta[:, rod])
    at = np.clip(np.searchsorted(run.t, times, side="right") - 1, 0, len(run.t) - 2)
    u = (times - run.t[at]) / (run.t[at + 1] - run.t[at])
    half = np.diff(theta) / 2
    # the length of the arc over that of its chord; rows more than a turn apart tell no arc
    arc = np.hypot(np.diff(x), np.diff(y)) * np.where(np.abs(half) < 1.5, 1 / np.sinc(half / np.pi), 1)
    found = []
    for values, along in ((x, np.cos(theta)), (y, np.sin(theta))):
        first, last = arc[at] * along[at], arc[at] * along[at + 1]
        step = values[at + 1] - values[at]
        found.append(values[at] + u * (first + u * (3 * step - 2 * first - last + u * (first + last - 2 * step))))
    return found


def pose(run, rod, time):
    x, y = path(run, rod, np.atleast_1d(float(time)))
    return x[0], y[0], np.interp(time, run.t, np.unwrap(run.theta[:, rod]))


# One panel of paths: lines coloured by time, rods as marks, numbers, and the key to the marks.

MOST_LABELS = 12  # more rods than this and the numbers would hide the paths
PIECES = 200
START, MARK = 12, 9  # lengths of the marks in points
APART = 3.4          # points between paths that would hide each other


class Look(NamedTuple):
    """Scale factors of the axes and what all panels share."""
    length: float
    time: float
    norm: Normalize
    interval: float
    apart: bool = False  # paths lie on each other: coloured by rod and moved apart, not coloured by time
    bodies: object = None  # the run directory, where rods have bodies: drawn to scale, and paths go straight from row to row


def draw_panel(axes, run, window, look):
    canvas.window(axes, *(tuple(look.length * edge for edge in pair) for pair in (window.x, window.y)))
    rods = range(run.x.shape[1])
    for rod in rods:
        samples(axes, run, rod, look)
        draw_path(axes, run, rod, look)
        if not look.bodies:
            draw_marks(axes, run, rod, look)
    for index, alpha in ((0, 0.4), (-1, 0.9)) if look.bodies else ():
        bodies.add(axes, look.bodies, run.x[index], run.y[index], run.theta[index], look.length,
                   [to_rgba(colour_of(rod)) for rod in rods], alpha=alpha, zorder=4)
    for rod in rods if len(rods) <= MOST_LABELS else ():
        name_rod(axes, run, rod, look.length)


def fine_times(run):
    """Those of the rows and as many between two that a turn of 0.1 rad is a piece of its own."""
    turn = np.abs(np.diff(np.unwrap(run.theta, axis=0), axis=0)).max(axis=1)
    pieces = np.clip(np.ceil(turn / 0.1), np.ceil(PIECES / len(turn)), 40).astype(int)
    inner = [np.linspace(first, last, count, endpoint=False) for first, last, count in zip(run.t[:-1], run.t[1:], pieces)]
    return np.concatenate([*inner, run.t[-1:]])


def colour_of(rod):
    return style.ROD_COLOURS[rod % len(style.ROD_COLOURS)]


def samples(axes, run, rod, look):
    """What the errors of a measured field make of the path."""
    for x, y in zip(*run.samples):
        axes.plot(x[:, rod] * look.length, y[:, rod] * look.length, color=colour_of(rod), linewidth=0.5, alpha=0.35, zorder=1,
                  scalex=False, scaley=False)


def draw_path(axes, run, rod, look):
    """Cut into short pieces even where few times were written, so that the colour runs smoothly."""
    if look.apart:
        x, y = path(run, rod, fine_times(run))
        axes.plot(x * look.length, y * look.length, color=colour_of(rod), linewidth=1.6, solid_capstyle="round", zorder=2,
                  transform=beside(axes, run, rod), scalex=False, scaley=False)
        return
    t = run.t if look.bodies else fine_times(run)
    points = np.stack((run.x[:, rod], run.y[:, rod]) if look.bodies else path(run, rod, t), axis=-1) * look.length
    pieces = np.stack([points[:-1], points[1:]], axis=1)
    middle = (t[:-1] + t[1:]) / 2 * look.time
    axes.add_collection(LineCollection(pieces, array=middle, cmap=style.TIME_MAP, norm=look.norm, linewidths=2.0,
                                       capstyle="round", zorder=2), autolim=False)


def beside(axes, run, rod):
    """Data coordinates moved to one side of the rods' way, by rod."""
    rods = run.x.shape[1]
    way = np.mean([run.x[-1] - run.x[0], run.y[-1] - run.y[0]], axis=1)
    left = np.array([-way[1], way[0]]) / (math.hypot(*way) or 1.0)
    step = APART * ((rods - 1) / 2 - rod) / 72  # of an inch
    return axes.transData + ScaledTranslation(*(step * left), axes.figure.dpi_scale_trans)


def draw_marks(axes, run, rod, look):
    """Heading at equal times (small), at the start (hollow) and at the end (filled)."""
    place = dict(transform=beside(axes, run, rod)) if look.apart else {}
    for time in mark_times(run, look.interval):
        x, y, theta = pose(run, rod, time)
        small(axes, x * look.length, y * look.length, theta, colour_of(rod), **place)
    for index, kind in ((0, hollow), (-1, filled)):
        kind(axes, run.x[index, rod] * look.length, run.y[index, rod] * look.length, run.theta[index, rod], colour_of(rod),
             **place)


def small(axes, x, y, theta, colour, **place):
    canvas.rod_mark(axes, x, y, theta, MARK, facecolor=colour, edgecolor="white", linewidth=0.3, zorder=3, **place)


def hollow(axes, x, y, theta, colour, **place):
    canvas.rod_mark(axes, x, y, theta, START, facecolor="white", edgecolor=colour, linewidth=1.1, zorder=4, **place)


def filled(axes, x, y, theta, colour, **place):
    canvas.rod_mark(axes, x, y, theta, START + 1, facecolor=colour, edgecolor="white", linewidth=0.5, zorder=4, **place)


def name_rod(axes, run, rod, factor):
    """The rod's number behind its start, or beside it where the frame or a path is too near."""
    start = np.array([run.x[0, rod], run.y[0, rod]]) * factor
    for turn in (math.pi, math.pi / 2, -math.pi / 2):
        angle = run.theta[0, rod] + turn
        offset = 12 * np.array([math.cos(angle), math.sin(angle)])
        if free_place(axes, run, factor, start, offset):
            break
    axes.annotate(str(rod), start, offset, textcoords="offset points", ha="center", va="center", fontsize=10,
                  annotation_clip=True, zorder=5, color=colour_of(rod),
                  path_effects=[patheffects.withStroke(linewidth=2, foreground="white")])


def free_place(axes, run, factor, start, offset):
    """Whether a number `offset` points from `start` is clear of frame and paths, on the scale before the final layout."""
    low, high = np.array([axes.get_xlim(), axes.get_ylim()]).T
    point = (high[0] - low[0]) / (axes.get_window_extent().width * 72 / axes.figure.dpi)
    place = start + offset * point
    room = 7 * point
    nearest = np.hypot(run.x * factor - place[0], run.y * factor - place[1]).min()
    return bool(np.all(place > low + room) and np.all(place < high - room) and nearest > room)


def marks_key(axes, look, time_label):
    """What the marks mean, where the grid of panels has room to spare."""
    (left, right), (bottom, top) = axes.get_xlim(), axes.get_ylim()
    unit = time_label.strip("$") if "(" not in time_label else r"t"
    rows = [(hollow, "start"), (filled, "end"), (small, rf"every $\Delta {unit} = {words.math_number(look.interval * look.time)}$")]
    for index, (mark, text) in enumerate(rows):
        x, y = left + 0.15 * (right - left), top - (0.3 + 0.2 * index) * (top - bottom)
        mark(axes, x, y, 0.0, style.GREY)
        axes.annotate(text, (x, y), (14, 0), textcoords="offset points", va="center")


KINDS = {"trajectories": Kind(draw=draw, caption=caption, there=lambda run: run.result.has("/rods"))}
