"""Ranges that a singular point cannot spoil."""

import numpy as np
from matplotlib.colors import LogNorm
from matplotlib.ticker import FuncFormatter, LogFormatterSciNotation, LogLocator, NullFormatter

from .errors import PlotError

DECADES = 4.5  # more than this below the top is drawn as "less"


def nice(value, up):
    """The next 1, 2 or 5 times a power of ten, at or beyond `value`."""
    decade = 10.0 ** np.floor(np.log10(value))
    steps = np.array([1, 2, 5, 10]) * decade
    return steps[steps >= value * (1 - 1e-9)][0] if up else steps[steps <= value * (1 + 1e-9)][-1]


def log_norm(*arrays):
    """(norm, extend) for positive values over many decades, from percentiles."""
    values = np.concatenate([np.ravel(array) for array in arrays])
    values = values[np.isfinite(values) & (values > 0)]
    if values.size == 0:
        raise PlotError("nothing to draw on a log scale: no positive values")
    top = nice(np.percentile(values, 99.7), up=True)
    bottom = nice(max(np.percentile(values, 3), top / 10 ** DECADES), up=False)
    bottom = min(bottom, top / 10)
    below, above = bool((values < bottom).any()), bool((values > top).any())
    return LogNorm(bottom, top), {(0, 0): "neither", (1, 0): "min", (0, 1): "max", (1, 1): "both"}[below, above]


def log_bar(figure, image, axes, extend, label, **place):
    """A colour bar with labelled decades; 2 and 5 are labelled too when there are few decades."""
    bar = figure.colorbar(image, ax=axes, extend=extend, extendfrac=0.03, **place)
    few = np.log10(image.norm.vmax / image.norm.vmin) < 2
    axis = bar.ax.xaxis if bar.orientation == "horizontal" else bar.ax.yaxis
    axis.set_major_locator(LogLocator(subs=(1, 2, 5) if few else (1,), numticks=20))
    plain = few and image.norm.vmin >= 1e-2 and image.norm.vmax < 1e4  # 5 is read faster than 5 x 10^0
    axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}") if plain
                             else LogFormatterSciNotation(labelOnlyBase=False, minor_thresholds=(np.inf, np.inf)))
    bar.ax.tick_params(which="both", direction="in")
    bar.set_label(label)
    return bar


def plain_ticks(axis, low, high):
    """1, 2, 5 in plain digits on a logarithmic axis of few decades."""
    if high < 100 * low and 1e-3 < low and high < 1e4:
        axis.set_major_locator(LogLocator(subs=(1, 2, 5)))
        axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
        axis.set_minor_formatter(NullFormatter())


def plain_decades(axis, low, high):
    """0.1, 1, 10 where powers of ten would be longer to read; few decades have their numbers from plain_ticks."""
    if high >= 100 * low and 1e-3 <= low and high < 2e4:
        axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}".replace("-", "−")))


def linear_limits(values, trusted, below=0.06, above=0.06):
    """Limits from the trusted values only, with zero in view and room (a part of the range) on both sides."""
    kept = values[trusted & np.isfinite(values)]
    if kept.size == 0:
        raise PlotError("nothing to draw: no finite values")
    low, high = min(kept.min(), 0.0), max(kept.max(), 0.0)
    size = (high - low) or 1.0
    return low - below * size, high + above * size
