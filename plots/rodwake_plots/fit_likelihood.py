"""How chi2 rises as one parameter is moved and the others follow: the 95 % interval, and what the curvature says."""

import math

import numpy as np

from . import canvas, curves, fit_words, ranges, style, words
from .errors import PlotError
from .fit_result import RISE_95
from .spec import Spec

TOP = 3.2  # of the threshold: as far up as is drawn


class Likelihood:
    """value and the rise of chi2, in units in which 95 % is at RISE_95."""

    def __init__(self, fit, name):
        found = fit.likelihood.get(name) if name else next(iter(fit.likelihood.values()), None)
        if not isinstance(found, dict):
            known = ", ".join(fit.likelihood) or "none"
            raise PlotError(f'{fit.path}: no likelihood of "{name}" (there is: {known}); name it in fit.likelihood')
        self.parameter = fit.parameters.get(name or next(iter(fit.likelihood)))
        if self.parameter is None:
            raise PlotError(f'{fit.path}: likelihood of "{name}", which is not in parameters')
        try:
            self.value, chi2 = (np.array(found.get(key), dtype=float) for key in ("value", "chi2"))
        except (TypeError, ValueError) as error:
            raise PlotError(f"{fit.path}: likelihood.{self.parameter.name} is not two rows of numbers") from error
        if self.value.ndim != 1 or self.value.shape != chi2.shape or np.isfinite(chi2).sum() < 2:
            raise PlotError(f"{fit.path}: likelihood.{self.parameter.name} holds less than two points: nothing to draw")
        kept = np.isfinite(self.value) & np.isfinite(chi2)
        self.value, chi2 = self.value[kept], chi2[kept]
        best = fit.number(fit.told, "objective", chi2.min())
        self.rise = (chi2 - min(best, chi2.min())) / (fit.number(fit.told, "error_factor", 1.0) or 1.0) ** 2
        self.low, self.high = fit.number(found, "low", -math.inf), fit.number(found, "high", math.inf)

    @property
    def log(self):
        return self.parameter.log and self.value.min() > 0 and self.value.max() > 3 * self.value.min()

    def parabola(self, x):
        """Of the curvature at the best value; symmetric in the logarithm of a parameter searched there. None if flat."""
        at, error = self.parameter.value, self.parameter.error
        if not (math.isfinite(error) and error > 0):
            return None
        return (np.log(x / at) * at / error) ** 2 if self.parameter.log and at > 0 else ((x - at) / error) ** 2


def draw(run, spec):
    like = Likelihood(run.fit, spec.parameter)
    figure, axes = curves.panel(1)
    axes.set_xscale("log" if like.log else "linear")
    low, high = like.value.min(), like.value.max()
    x = np.geomspace(low, high, 400) if like.log else np.linspace(low, high, 400)
    axes.axvspan(max(like.low, low), min(like.high, high), color=style.LINE, alpha=0.12, linewidth=0, label="95 % interval")
    axes.axhline(RISE_95, **curves.FAINT)
    axes.axvline(like.parameter.value, color=style.GREY, linewidth=0.6, zorder=1)
    parabola = like.parabola(x)
    if parabola is not None:
        axes.plot(x, parabola, color="#d55e00", linewidth=1.1, linestyle=(0, (5, 3)), label="curvature at the best value")
    axes.plot(like.value, like.rise, "o-", color=style.LINE, markersize=3.2, linewidth=1.2, label="others refitted")
    top = min(max(like.rise.max(), 1.3 * RISE_95), TOP * RISE_95)
    axes.set(xlim=(low, high), ylim=(-0.03 * top, 1.05 * top), xlabel=fit_words.quantity(like.parameter), ylabel=r"rise of $\chi^2$")
    if like.log:
        ranges.plain_ticks(axes.xaxis, low, high)
    curves.legend(axes, loc="upper center")
    axes.annotate(f"{words.number(RISE_95, 3)}", (0.62, RISE_95), (0, 2), xycoords=axes.get_yaxis_transform(), textcoords="offset points",
                  ha="center", va="bottom", fontsize=8.5, color=style.GREY)
    canvas.heading(axes, style.safe(spec.title))
    return figure


def caption(run, spec):
    like = Likelihood(run.fit, spec.parameter)
    one = like.parameter
    text = (f"Rise of <i>χ</i>² above its minimum as {fit_words.symbol_html(one.name)} is held at other values and the other free "
            f"parameters are fitted again. Shaded: 95 % interval, {fit_words.interval_html(like.low, like.high, one.unit)}, where the rise "
            f"stays below {words.number(RISE_95, 3)} (level line). ")
    if like.parabola(np.array([one.value])) is not None:
        text += f"Broken: what the curvature at the best value, {fit_words.value(one)}, says. "
    if run.fit.number(run.fit.told, "error_factor", 1.0) != 1.0:
        text += "The errors of the data are not known: the rise is in units of <i>χ</i>² per degree of freedom. "
    return text


def defaults(run):
    return [Spec(f"fit_likelihood_{name}", "fit_likelihood", parameter=name) for name in run.fit.likelihood]
