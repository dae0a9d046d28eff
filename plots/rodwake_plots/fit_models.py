"""Rival models of the same data: how far each is behind the best, by several criteria, and its weight."""

import math

import numpy as np

from . import canvas, fit_words, style, words
from .errors import PlotError
from .fit_result import MODELS
from .schema import Kind

CRITERIA = (("aic", "AIC", "o"), ("bic", "BIC", "s"))
LINEAR = 2.0  # of the axis, around 0; beyond it is logarithmic


def draw(run, spec):
    models = drawn(run.fit)
    rank = np.arange(len(models))
    figure = canvas.figure(style.WIDE, 0.42 * len(models) + 1.3)
    axes = figure.subplots()
    for index, ((key, label, mark), colour) in enumerate(zip(CRITERIA, style.CURVES)):
        axes.plot(behind(run.fit, models, key), rank + 0.12 * (index - 1), mark, color=colour, markersize=5, label=label)
    validations = [one.get("cross_validation") or {} for one in models]
    lost = np.array([-2 * run.fit.number(one, "difference") for one in validations])
    error = np.array([2 * run.fit.number(one, "difference_stderr") for one in validations])
    if np.isfinite(lost).any():
        axes.errorbar(lost, rank + 0.14, xerr=np.nan_to_num(error), fmt="D", color=style.INK, markersize=4, linewidth=0.9, label="cross-validation, −2 ln")
    axes.axvline(0, **canvas.FAINT)
    axes.set_xscale("symlog", linthresh=LINEAR, linscale=0.6)
    axes.set_yticks(rank, [name_of(run.fit, one) for one in models])
    axes.set_ylim(len(models) - 0.5, -0.5)
    axes.set_xlabel("behind the best")
    canvas.legend(axes, loc="upper right")
    canvas.heading(axes, style.safe(spec.title))
    return figure


def drawn(fit):
    models = [one for one in fit.models if math.isfinite(fit.number(one, "aic"))]
    if not models:
        raise PlotError(f"{fit.path.parent / MODELS}: holds no model that was fitted; name some in [[fit.models]]")
    return models


def behind(fit, models, key):
    values = np.array([fit.number(one, key) for one in models])
    return values - np.nanmin(values)


def name_of(fit, one):
    return f"{style.safe(str(one.get('name', '')))}  ({weight_of(fit, one)})"


def weight_of(fit, one):
    weight = fit.number(one, "weight")
    return "< 0.001" if weight < 0.001 else f"{weight:.3f}"


def caption(run, spec):
    fit = run.fit
    source = "evidence" if fit.weighed.get("weight_from") == "evidence" else "AIC"
    text = (f"Model comparison: distance from the best model in AIC and BIC, and in cross-validation, where each eighth of the data is predicted by a fit of the rest "
            f"(−2 times the difference of the log-likelihoods, with its standard error). In brackets: weights by {source}. ")
    chances = [f"{words.escape(str(one.get('name', '')))} {fit_words.chance_html(fit.number(one.get('misfit') or {}, 'probability'))}" for one in drawn(fit)]
    return text + f"Goodness of fit, probability of so large a deviation if the model is right: {', '.join(chances)}."


KINDS = {"fit_models": Kind(draw=draw, caption=caption, there=lambda run: run.fit.weighed is not None)}
