"""Choices about paths that a figure and its caption must make alike: window, marks, time range."""

from typing import NamedTuple

import numpy as np

from .errors import PlotError

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


def window_of(runs, spec):
    """The figure's window, or all paths with a margin in a box of sane shape."""
    x = span(np.concatenate([run.x.ravel() for run in runs]))
    y = span(np.concatenate([run.y.ravel() for run in runs]))
    margin = (0.09 if len(runs) == 1 else 0.13) * max(x[1] - x[0], y[1] - y[0]) or 1.0
    x, y = grown(x, margin), grown(y, margin)
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


def pose(run, rod, time):
    return tuple(np.interp(time, run.t, part[:, rod]) for part in (run.x, run.y, np.unwrap(run.theta, axis=0)))
