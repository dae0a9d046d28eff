"""Where the starts of a search ended: the objective over its best, and the parameters, in the order of the objective."""

import math

import numpy as np

from . import canvas, fit_words, ranges, style, words
from .errors import PlotError
from .spec import Spec

SAME, SAME_AT_ZERO = 1e-4, 1e-8  # relative and absolute: starts within this of the best reached the same optimum
BELOW = 1e-3  # of that: smaller differences are drawn there


class Ends:
    """The starts that gave a finite objective, best first."""

    def __init__(self, fit):
        ranked = sorted((fit.number(one, "objective", math.inf), index) for index, one in enumerate(fit.starts))
        if len(ranked) < 2:
            raise PlotError(f"{fit.path}: holds {'one start' if ranked else 'no starts'}: nothing to compare; set fit.starts above 1")
        found = [(objective, fit.starts[index]) for objective, index in ranked if math.isfinite(objective)]
        if not found:
            raise PlotError(f"{fit.path}: no start has a finite objective: nothing to draw")
        self.failed = len(ranked) - len(found)
        self.over = np.array([one[0] for one in found]) - found[0][0]
        self.same = SAME * abs(found[0][0]) + SAME_AT_ZERO
        self.best = self.over <= self.same
        self.fit, self.starts = fit, [one[1] for one in found]

    def values(self, which, name):
        return np.array([self.fit.number(one.get(which) or {}, name) for one in self.starts])


def draw(run, spec):
    ends = Ends(run.fit)
    free = run.fit.free
    columns = min(1 + len(free), 2 if len(free) in (1, 3) else 3)
    rows = math.ceil((1 + len(free)) / columns)
    figure = canvas.figure(style.WIDE, rows * 2.3 + 0.3)
    panels = list(figure.subplots(rows, columns, squeeze=False, sharex=True).ravel())
    waterfall(panels[0], ends)
    for axes, parameter in zip(panels[1:], free):
        end_values(axes, ends, parameter)
    for index, axes in enumerate(panels):
        if index > len(free):
            axes.set_axis_off()
            continue
        lowest = index + columns > len(free)
        axes.tick_params(labelbottom=lowest)
        axes.set_xlabel("start, by objective" if lowest else "")
        axes.xaxis.get_major_locator().set_params(integer=True)
    if spec.title:
        figure.suptitle(style.safe(spec.title), fontsize=11)
    return figure


def marks(axes, ends, values):
    rank = 1 + np.arange(values.size)
    size = 4.2 if values.size <= 40 else 2.8
    axes.plot(rank[~ends.best], values[~ends.best], "o", color=style.GREY, markerfacecolor="white", markersize=size, markeredgewidth=0.8)
    axes.plot(rank[ends.best], values[ends.best], "o", color=style.LINE, markersize=size, markeredgewidth=0)


def waterfall(axes, ends):
    lowest = BELOW * ends.same
    axes.axhspan(lowest / 3, ends.same, color=style.LINE, alpha=0.1, linewidth=0)
    marks(axes, ends, np.maximum(ends.over, lowest))
    axes.set_yscale("log")
    axes.set_ylim(lowest / 3, 5 * max(ends.over.max(), ends.same))
    axes.set_ylabel("objective over the best")
    axes.annotate(f"the same optimum: {ends.best.sum()} of {ends.best.size + ends.failed}", (0.04, ends.same), (0, -4),
                  xycoords=axes.get_yaxis_transform(), textcoords="offset points", va="top", color=style.LINE, fontsize=8.5)


def end_values(axes, ends, parameter):
    """Ends as marks, starts as ticks, bounds as lines where they are in sight."""
    starts, found = ends.values("start", parameter.name), ends.values("end", parameter.name)
    rank = 1 + np.arange(found.size)
    axes.plot(rank, starts, "_", color=style.GREY, alpha=0.55, markersize=5, markeredgewidth=0.8)
    marks(axes, ends, found)
    both = np.concatenate([starts, found])
    both = both[np.isfinite(both)]
    if parameter.log and both.size and both.min() > 0:
        axes.set_yscale("log")
        low, high = both.min() / 1.5, both.max() * 1.5
        ranges.plain_ticks(axes.yaxis, low, high)
    else:
        size = np.ptp(both) if both.size else 0.0
        room = 0.12 * size or 0.1 * abs(both).max(initial=0.0) or 1.0
        low, high = (both.min() - room, both.max() + room) if both.size else (-1.0, 1.0)
    for bound in parameter.bounds:
        if low <= bound <= high:
            axes.axhline(bound, color=style.GREY, linewidth=0.8, linestyle=(0, (5, 3)), zorder=1)
    axes.set_ylim(low, high)
    axes.set_ylabel(fit_words.quantity(parameter))


def caption(run, spec):
    ends = Ends(run.fit)
    text = (f"The {words.number(len(run.fit.starts))} starts of the search, best first: by what the objective at the end of each exceeds the "
            "best, and the values there. Filled: reached the same optimum, that is, within the shaded range; hollow: ended elsewhere; "
            "bars: where they started. ")
    bounded = any(map(math.isfinite, sum((one.bounds for one in run.fit.free), ())))
    text += "Broken lines: bounds, where they are in sight. " if bounded else ""
    return text + (f"{ends.failed} {'starts' if ends.failed > 1 else 'start'} failed." if ends.failed else "")


def defaults(run):
    return [Spec("fit_starts", "fit_starts")] if len(run.fit.starts) > 1 else []
