"""Correlations of the errors of the fitted parameters."""

import math

import numpy as np

from . import canvas, fit_words, style
from .errors import PlotError
from .spec import Spec

MAP = "RdBu_r"


MOST = 12  # parameters with which starts of tracks are shown too


def draw(run, spec):
    return of_matrix([one.name for one in run.fit.free], read(run.fit), style.safe(spec.title))


def of_matrix(free, matrix, title=""):
    """nan where a correlation is not known."""
    if len(free) > MOST:
        kept = [index for index, name in enumerate(free) if not fit_words.pose_of(name)]
        free, matrix = [free[index] for index in kept], matrix[np.ix_(kept, kept)]
    count = len(free)
    size = min(max(1.6, 0.62 * count), 6.0)
    figure = canvas.figure(size + 1.5, size + 0.75)
    axes = figure.subplots()
    image = axes.imshow(matrix, cmap=MAP, vmin=-1, vmax=1)
    names = [f"${fit_words.symbol(name)}$" for name in free]
    axes.set_xticks(range(count), names)
    axes.set_yticks(range(count), names)
    axes.tick_params(length=0, labelsize=11)
    for (row, column), value in np.ndenumerate(matrix):
        if math.isfinite(value):
            axes.annotate(number(value), (column, row), ha="center", va="center", fontsize=9 if count < 7 else 7.5,
                          color="white" if abs(value) > 0.6 else style.INK)
        else:
            axes.annotate("–", (column, row), ha="center", va="center", color=style.GREY)
    bar = figure.colorbar(image, ax=axes, ticks=[-1, -0.5, 0, 0.5, 1], fraction=0.05, pad=0.04)
    bar.set_label("correlation")
    bar.ax.tick_params(direction="in")
    canvas.heading(axes, title)
    return figure


def read(fit):
    """nan where a parameter has no error: its correlations are not known."""
    if len(fit.free) < 2:
        raise PlotError(f"{fit.path}: {'one free parameter' if fit.free else 'no free parameter'}: no correlations to draw")
    matrix = fit.correlation.copy()
    lacking = [not math.isfinite(one.error) for one in fit.free]
    matrix[lacking, :] = np.nan
    matrix[:, lacking] = np.nan
    return matrix


def number(value):
    """Two digits; more where it would round to 1 and is not."""
    for digits in (2, 3, 4):
        text = f"{value:.{digits}f}"
        if abs(float(text)) < 1 or abs(value) == 1:
            break
    return ("1" if value == 1 else "−1" if value == -1 else text).replace("-", "−")


def caption(run, spec):
    lacking = [fit_words.symbol_html(one.name) for one in run.fit.free if not math.isfinite(one.error)]
    text = "Correlations of the errors of the fitted parameters. "
    return text + (f"Blank: {', '.join(lacking)} {'have' if len(lacking) > 1 else 'has'} no finite error. " if lacking else "")


def defaults(run):
    return [Spec("fit_correlation", "fit_correlation")] if len(run.fit.free) > 1 else []
