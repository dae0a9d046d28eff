"""One measured profile and the fit to it, and what is left between them."""

from typing import NamedTuple

import numpy as np
from matplotlib.ticker import MaxNLocator

from . import curves, fit_words, style

COMPARED = ["#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9"]
DASHES = [(0, (5, 3)), (0, (1.5, 2)), (0, (6, 2, 1.5, 2))]
LEFT_OUT = "#9a9a9a"
REACH = 2.5  # a comparison beyond this times the range of the data is cut off


class View(NamedTuple):
    """What a panel shows."""
    profile: dict
    points: object
    curve: object


def draw(axes, fit, view, window):
    points, curve = view.points, view.curve
    axes.axhline(0, color=style.GREY, linewidth=0.6, zorder=1)
    shade_core(axes, fit)
    for index, values in enumerate(curve.compared):
        line(axes, fit, *broken(fit, view, values), color=COMPARED[index % 5], linestyle=DASHES[index % 3], linewidth=1.2, zorder=2.5)
    x, model = broken(fit, view, curve.model)
    band = broken(fit, view, curve.band)[1]
    axes.fill_between(x, model - band, model + band, color=style.LINE, alpha=0.25, linewidth=0, zorder=2)
    line(axes, fit, x, model, color=style.LINE, linewidth=1.5, zorder=4)
    data(axes, points, points.value, points.sigma)
    axes.set_xlim(*(window or span(points.x)))
    axes.set_ylim(*limits(view, window))


def line(axes, fit, x, values, **look):
    """Faint within the core, where the theory makes no claim."""
    inside = np.abs(x) < fit.number(fit.told, "core", 0.0)
    if inside.any():
        axes.plot(x, values, **{**look, "linewidth": 0.8, "alpha": 0.45})
    axes.plot(x, np.where(inside, np.nan, values), **look)


def span(x):
    low, high = x.min(), x.max()
    room = 0.02 * (high - low) or 1.0
    return low - room, high + room


def data(axes, points, value, sigma):
    look = dict(markersize=3.0, elinewidth=0.7, capsize=0)
    for kept, colour, inside in ((points.used, style.INK, style.INK), (~points.used, LEFT_OUT, "white")):
        if kept.any():
            curves.points(axes, points.x[kept], value[kept], sigma[kept], colour, markerfacecolor=inside, markeredgewidth=0.7, **look)


def shade_core(axes, fit):
    core = fit.number(fit.told, "core", 0.0)
    if core > 0:
        axes.axvspan(-core, core, color=style.GREY, alpha=0.08, linewidth=0, zorder=0)


def broken(fit, view, values):
    """No line across the place of the force, where the field is singular, nor within a fifth of the core around it."""
    x = view.curve.x
    if view.profile.get("at") != 0 or not x.min() < (at := force_at(fit, view)) < x.max():
        return x, values
    split = np.searchsorted(x, at)
    values = np.where(np.abs(x - at) < 0.2 * fit.number(fit.told, "core", 0.0), np.nan, values)
    return np.insert(x, split, at), np.insert(values, split, np.nan)


def force_at(fit, view):
    known = fit.parameters.get("x0")
    return known.value if known and view.profile.get("along") == "x" else 0.0


def limits(view, window):
    """From data and fit at the fitted places; a comparison that is far off, or a singularity, does not spoil the range."""
    points, curve = view.points, view.curve
    if window:
        seen = (points.x >= window[0]) & (points.x <= window[1])
        points = type(points)(*(column[seen] for column in points)) if seen.any() else points
    sigma = np.nan_to_num(points.sigma)
    trusted = points.used if points.used.any() else np.ones(points.x.size, dtype=bool)
    ends = np.concatenate([points.value, points.model[trusted], (points.value - sigma)[trusted], (points.value + sigma)[trusted], [0.0]])
    low, high = ends[np.isfinite(ends)].min(), ends[np.isfinite(ends)].max()
    size = (high - low) or 1.0
    low, high = wider(low, high, [np.interp(points.x[trusted], curve.x, values) for values in curve.compared])
    return low - 0.06 * size, high + 0.10 * size


def wider(low, high, compared):
    size = high - low
    found = np.concatenate([*compared, [low, high]])
    found = found[np.isfinite(found)]
    return max(found.min(), low - (REACH - 1) * size), min(found.max(), high + (REACH - 1) * size)


def reach(values, used, least):
    """Of the strip to both sides: all residuals, but those left out of the fit up to twice the others."""
    fitted, every = (np.abs(one[np.isfinite(one)]).max(initial=least) for one in (values[used], values))
    return min(every, 2 * fitted) or 1.0


def residuals(axes, fit, view):
    """Data minus fit in standard errors; in the profiles' unit where the errors are not known."""
    points = view.points
    known = bool(np.isfinite(points.sigma).any())
    values = (points.value - points.model) / (points.sigma if known else 1.0)
    axes.axhline(0, color=style.GREY, linewidth=0.6, zorder=1)
    shade_core(axes, fit)
    if known:
        axes.axhspan(-1, 1, color=style.LINE, alpha=0.12, linewidth=0, zorder=0)
    size = reach(values, points.used, 3.0 if known else 0.0)
    beyond = np.abs(values) > size
    data(axes, points, np.where(beyond, np.nan, values), np.full(values.size, np.nan))
    for sign, mark in ((1, "^"), (-1, "v")):  # too far off for the strip: at its edge
        far = beyond & (np.sign(values) == sign)
        axes.plot(points.x[far], np.full(far.sum(), sign * 1.08 * size), mark, color=LEFT_OUT, markersize=3.4, zorder=3)
    axes.set_ylim(-1.2 * size, 1.2 * size)
    axes.yaxis.set_major_locator(MaxNLocator(4, steps=[1, 2, 5, 10]))
    axes.set_ylabel(r"(data $-$ fit)/$\sigma$" if known else fit_words.axis(r"(\mathrm{data}-\mathrm{fit})", fit.unit), fontsize=8.5)
