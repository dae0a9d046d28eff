"""One panel of paths: lines coloured by time, rods as marks, numbers, and the key to the marks."""

import math
from typing import NamedTuple

import numpy as np
from matplotlib import patheffects
from matplotlib.collections import LineCollection
from matplotlib.colors import Normalize
from matplotlib.transforms import ScaledTranslation

from . import canvas, glyphs, style, words
from .paths import mark_times, pose

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


def draw(axes, run, window, look):
    canvas.window(axes, *(tuple(look.length * edge for edge in pair) for pair in (window.x, window.y)))
    rods = range(run.x.shape[1])
    for rod in rods:
        samples(axes, run, rod, look)
        path(axes, run, rod, look)
        marks(axes, run, rod, look)
    for rod in rods if len(rods) <= MOST_LABELS else ():
        name_rod(axes, run, rod, look.length)


def colour_of(rod):
    return style.ROD_COLOURS[rod % len(style.ROD_COLOURS)]


def samples(axes, run, rod, look):
    """What the errors of a measured field make of the path."""
    for x, y in zip(*run.samples):
        axes.plot(x[:, rod] * look.length, y[:, rod] * look.length, color=colour_of(rod), linewidth=0.5, alpha=0.35, zorder=1,
                  scalex=False, scaley=False)


def path(axes, run, rod, look):
    """Cut into short pieces even where few times were written, so that the colour runs smoothly."""
    if look.apart:
        axes.plot(run.x[:, rod] * look.length, run.y[:, rod] * look.length, color=colour_of(rod), linewidth=1.6, solid_capstyle="round",
                  zorder=2, transform=beside(axes, run, rod), scalex=False, scaley=False)
        return
    t = np.union1d(run.t, np.linspace(run.t[0], run.t[-1], PIECES))
    points = np.stack([np.interp(t, run.t, part[:, rod]) for part in (run.x, run.y)], axis=-1) * look.length
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


def marks(axes, run, rod, look):
    """Heading at equal times (small), at the start (hollow) and at the end (filled)."""
    place = dict(transform=beside(axes, run, rod)) if look.apart else {}
    for time in mark_times(run, look.interval):
        x, y, theta = pose(run, rod, time)
        small(axes, x * look.length, y * look.length, theta, colour_of(rod), **place)
    for index, kind in ((0, hollow), (-1, filled)):
        kind(axes, run.x[index, rod] * look.length, run.y[index, rod] * look.length, run.theta[index, rod], colour_of(rod),
             **place)


def small(axes, x, y, theta, colour, **place):
    glyphs.rod(axes, x, y, theta, MARK, facecolor=colour, edgecolor="white", linewidth=0.3, zorder=3, **place)


def hollow(axes, x, y, theta, colour, **place):
    glyphs.rod(axes, x, y, theta, START, facecolor="white", edgecolor=colour, linewidth=1.1, zorder=4, **place)


def filled(axes, x, y, theta, colour, **place):
    glyphs.rod(axes, x, y, theta, START + 1, facecolor=colour, edgecolor="white", linewidth=0.5, zorder=4, **place)


def name_rod(axes, run, rod, factor):
    """The rod's number behind its start, or beside it where the frame or a path is too near."""
    start = np.array([run.x[0, rod], run.y[0, rod]]) * factor
    for turn in (math.pi, math.pi / 2, -math.pi / 2):
        angle = run.theta[0, rod] + turn
        offset = 12 * np.array([math.cos(angle), math.sin(angle)])
        if free(axes, run, factor, start, offset):
            break
    axes.annotate(str(rod), start, offset, textcoords="offset points", ha="center", va="center", fontsize=10,
                  annotation_clip=True, zorder=5, color=colour_of(rod),
                  path_effects=[patheffects.withStroke(linewidth=2, foreground="white")])


def free(axes, run, factor, start, offset):
    """Whether a number `offset` points from `start` is clear of frame and paths, on the scale before the final layout."""
    low, high = np.array([axes.get_xlim(), axes.get_ylim()]).T
    point = (high[0] - low[0]) / (axes.get_window_extent().width * 72 / axes.figure.dpi)
    place = start + offset * point
    room = 7 * point
    nearest = np.hypot(run.x * factor - place[0], run.y * factor - place[1]).min()
    return bool(np.all(place > low + room) and np.all(place < high - room) and nearest > room)


def key(axes, look, time_label):
    """What the marks mean, where the grid of panels has room to spare."""
    (left, right), (bottom, top) = axes.get_xlim(), axes.get_ylim()
    unit = time_label.strip("$") if "(" not in time_label else r"t"
    rows = [(hollow, "start"), (filled, "end"), (small, rf"every $\Delta {unit} = {words.math_number(look.interval * look.time)}$")]
    for index, (mark, text) in enumerate(rows):
        x, y = left + 0.15 * (right - left), top - (0.3 + 0.2 * index) * (top - bottom)
        mark(axes, x, y, 0.0, style.GREY)
        axes.annotate(text, (x, y), (14, 0), textcoords="offset points", va="center")
