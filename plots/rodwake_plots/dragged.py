"""Beads around the rod at the start of the run, and where they are at its end (paper, Figs. bead_drag b, d)."""

from typing import NamedTuple

import numpy as np

from . import bed, canvas, measured, panels, words
from .errors import PlotError
from .granular_run import SUMMARY, TRAJECTORY
from .h5md import Frame
from .periodic import with_images
from .spec import Spec

FILE = "marked.csv"
PURPLE, PALE = "#7b3294", "#d9d9d4"
MARGIN = 4.0  # of the window, a
NEAR = 14.0   # a; a rod within this of the marked beads is in the picture


class View(NamedTuple):
    """In bead radii, drift of the bed included, unwrapped around the marked beads."""
    frame: Frame
    first: np.ndarray   # [marked][2]
    last: np.ndarray    # [marked][2]
    marked: np.ndarray  # their numbers among the beads
    a: float


def draw(run, spec):
    parts = measured.holders(run, FILE)
    views = [read(part) for part in parts]
    windows = [window_of(run, spec, view) for view in views]
    figure, axes_list = panels.grid(parts, max(np.ptp(y) / np.ptp(x) for x, y in windows), share=False)
    for axes, view, window in zip(axes_list, views, windows):
        canvas.window(axes, *window)
        paint(axes, view, window)
        axes.set_facecolor("#f8f8f6")
        axes.tick_params(direction="out", top=False, right=False)
    panels.label(axes_list, parts, r"$x/a$", r"$y/a$", spec.title)
    for axes in axes_list:  # each has a window of its own
        axes.tick_params(labelbottom=True, labelleft=True)
    return figure


def read(part):
    granular, path = part.granular, part.folder / FILE
    number, *places = part.table(FILE, "bead", "x0", "y0", "x1", "y1")
    with granular.trajectory(TRAJECTORY) as trajectory:
        frame = trajectory.frame(-1)
        source = trajectory.path
    number = number.astype(int)
    if number.min() < 0 or number.max() >= len(frame.beads):
        raise PlotError(f"{path}: marks bead {number.max()}, but {source} holds beads 0 to {len(frame.beads) - 1}")
    first, last = np.column_stack(places[:2]), np.column_stack(places[2:])
    return View(frame, *drifted(path, source, frame, number, first, last, granular.a), number, granular.a)


def drifted(path, source, frame, number, first, last, a):
    """The drift of the bed, which marked.csv leaves out, put back: both places as the stored frame has them."""
    box = frame.box / a
    away = frame.beads[number, :2] / a - last
    drift = away[0] + np.median((away - away[0] + box / 2) % box - box / 2, axis=0)
    off = (away - drift + box / 2) % box - box / 2
    if np.median(np.hypot(*off.T)) > 1.0:
        raise PlotError(f"{path}: its beads are not where the last frame of {source} has them: the two are not of the same run")
    return first + drift, last + drift + off


def window_of(run, spec, view):
    asked = tuple(tuple(edge / view.a for edge in pair) for pair in (spec.x, spec.y))
    seen = np.concatenate([view.first, view.last])
    seen = np.concatenate([seen, *rods_near(view, seen)])
    return tuple(pair or (values.min() - MARGIN, values.max() + MARGIN) for pair, values in zip(asked, seen.T))


def rods_near(view, seen):
    """Spheres [n][2] of the rods that are not far from the marked beads, in the images nearest to them."""
    box, middle = view.frame.box / view.a, (seen.min(axis=0) + seen.max(axis=0)) / 2
    for rod in view.frame.rods:
        spheres = rod.spheres[:, :2] / view.a
        spheres = spheres - box * np.round((spheres.mean(axis=0) - middle) / box)
        if np.all(np.abs(spheres.mean(axis=0) - middle) < np.ptp(seen, axis=0) / 2 + NEAR):
            yield spheres


def paint(axes, view, window):
    frame, a = view.frame, view.a
    others = np.ones(len(frame.beads), dtype=bool)
    others[view.marked] = False
    centres, index = with_images(frame.beads[others, :2] / a, frame.radii[others] / a, frame.box / a, window)
    bed.discs(axes, centres, frame.radii[others][index] / a, facecolors=PALE, edgecolors="#a5a5a0", linewidths=0.4)
    radii = frame.radii[view.marked] / a
    bed.discs(axes, view.last, radii, facecolors=PURPLE, edgecolors="white", linewidths=0.4, zorder=2.5)
    bed.rods_from_above(axes, frame, a, window)
    bed.discs(axes, view.first, radii, facecolors="none", edgecolors=PURPLE, linewidths=0.7, alpha=0.65, zorder=4.5)


def caption(run, spec):
    parts = measured.holders(run, FILE)
    return ("The bed from above in the last stored frame, circles at true size. Purple: the beads that were near the rod in the first "
            "frame; rings: where they were then, moved along with the drift of the whole bed. "
            f"{panels.told(parts, moved)}{measured.not_measured(run, FILE)}")


def moved(part):
    view = read(part)
    away = words.number(float(np.median(np.hypot(*(view.last - view.first).T))), 2)
    time = bed.clock(view.frame.time, view.frame.time)
    share = part.estimate("flow", "drag_share")
    text = f"{part.granular.which(TRAJECTORY)}<i>t</i> = {time} s: the {len(view.marked)} marked beads moved by {away} <i>a</i> (median)"
    return f"{text}; share of the rod's way that they were carried along: {words.with_error(*share[:2])}." if share else text + "."


def defaults(run):
    """Frames are not kept of every measured run."""
    marked = [part for part in measured.parts(run) if part.has(FILE)]
    there = marked and all(part.has(SUMMARY) and part.granular.has(TRAJECTORY) and part.granular.stores_all_beads(TRAJECTORY) for part in marked)
    return [Spec("dragged", "dragged")] if there else []
