"""Displacement maps, the fitted field of the orthotropic medium, and what is left; bins that were not fitted are hatched."""

import numpy as np
from matplotlib.colors import Normalize

from . import canvas, fit_words, style, words
from .errors import PlotError
from .spec import Spec

COLUMNS = ("data", "fit", "data − fit")
MAP = "RdBu_r"


def draw(run, spec):
    x, y, used, rows, count = read(run.fit)
    figure = canvas.figure(style.WIDE, style.WIDE * 0.64 * np.ptp(y) / np.ptp(x) + 0.9)
    panels = figure.subplots(2, len(COLUMNS), sharex=True, sharey=True)
    for letter, line, (data, model) in zip("xy", panels, rows):
        norm = scale(data[used])
        for axes, values in zip(line, (data, model, data - model)):
            image = axes.pcolormesh(x, y, values, norm=norm, cmap=MAP, shading="nearest", rasterized=True)
            hatch(axes, x, y, used)
            axes.set_aspect("equal")
        bar = figure.colorbar(image, ax=list(line), pad=0.015, aspect=18, extend="both")
        bar.set_label(f"$U_{letter}$ / {fit_words.words_of(run.fit.unit)}")
        bar.ax.tick_params(direction="in")
        line[0].set_ylabel(fit_words.axis("y", run.fit.unit))
    for axes, title in zip(panels[0], COLUMNS):
        canvas.heading(axes, title)
    for axes in panels[1]:
        axes.set_xlabel(fit_words.axis("x", run.fit.unit))
    if spec.title:
        figure.suptitle(style.safe(spec.title), fontsize=11)
    return figure


def read(fit):
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


def scale(values):
    """Of what was fitted; the masked ridge may be beyond it."""
    values = values[np.isfinite(values)]
    top = np.percentile(np.abs(values), 99.5) if values.size else 1.0
    return Normalize(-(top or 1.0), top or 1.0)


def hatch(axes, x, y, used):
    if used.all():
        return
    axes.contourf(x, y, np.where(used, 0.0, 1.0), levels=[0.5, 1.5], colors="none", hatches=["////"])
    axes.contour(x, y, np.where(used, 0.0, 1.0), levels=[0.5], colors=style.INK, linewidths=0.7)


def caption(run, spec):
    count, total = read(run.fit)[-1], len(run.fit.maps)
    told = [f"{fit_words.symbol_html(one.name)} = {fit_words.value(one)}" for one in run.fit.free]
    text = "Measured displacement around the rod, which heads along +<i>x</i>; the fitted steady field of an orthotropic medium in the periodic box; "
    text += "and what is left, in the same colours. Hatched: not fitted, masked or without data. "
    if total > 1:
        text += f"Means of {words.number(count)} maps. " if count == total else f"Means of {count} of the {total} maps, those on one grid. "
    return text + (f"Fitted: {', '.join(told)}. " if told else "")


def defaults(run):
    return [Spec("fit_map", "fit_map")] if run.fit.maps else []
