"""Correlations of the errors of the fitted parameters."""

import math

import numpy as np

from . import canvas, files, fit_words, style, words
from .errors import PlotError
from .fit_result import RISE_95
from .schema import Kind, Spec

CORRELATIONS = "RdBu_r"


MOST_WITH_STARTS = 12  # parameters with which starts of tracks are shown too


def draw_fit_correlation(run, spec):
    return of_matrix([one.name for one in run.fit.free], read_correlation(run.fit), style.safe(spec.title))


def of_matrix(free, matrix, title=""):
    """nan where a correlation is not known."""
    if len(free) > MOST_WITH_STARTS:
        kept = [index for index, name in enumerate(free) if not fit_words.pose_of(name)]
        free, matrix = [free[index] for index in kept], matrix[np.ix_(kept, kept)]
    count = len(free)
    size = min(max(1.6, 0.62 * count), 6.0)
    figure = canvas.figure(size + 1.5, size + 0.75)
    axes = figure.subplots()
    image = axes.imshow(matrix, cmap=CORRELATIONS, vmin=-1, vmax=1)
    names = [f"${fit_words.symbol(name)}$" for name in free]
    axes.set_xticks(range(count), names)
    axes.set_yticks(range(count), names)
    axes.tick_params(length=0, labelsize=11)
    for (row, column), value in np.ndenumerate(matrix):
        if math.isfinite(value):
            axes.annotate(correlation_number(value), (column, row), ha="center", va="center", fontsize=9 if count < 7 else 7.5,
                          color="white" if abs(value) > 0.6 else style.INK)
        else:
            axes.annotate("–", (column, row), ha="center", va="center", color=style.GREY)
    canvas.colour_bar(figure, image, axes, "correlation", ticks=[-1, -0.5, 0, 0.5, 1], fraction=0.05, pad=0.04)
    canvas.heading(axes, title)
    return figure


def read_correlation(fit):
    """nan where a parameter has no error: its correlations are not known."""
    if len(fit.free) < 2:
        raise PlotError(f"{fit.path}: {'one free parameter' if fit.free else 'no free parameter'}: no correlations to draw")
    matrix = fit.correlation.copy()
    lacking = [not math.isfinite(one.error) for one in fit.free]
    matrix[lacking, :] = np.nan
    matrix[:, lacking] = np.nan
    return matrix


def correlation_number(value):
    """Two digits; more where it would round to 1 and is not."""
    for digits in (2, 3, 4):
        text = f"{value:.{digits}f}"
        if abs(float(text)) < 1 or abs(value) == 1:
            break
    return ("1" if value == 1 else "−1" if value == -1 else text).replace("-", "−")


def caption_fit_correlation(run, spec):
    lacking = [fit_words.symbol_html(one.name) for one in run.fit.free if not math.isfinite(one.error)]
    text = "Correlations of the errors of the fitted parameters. "
    return text + (f"Blank: {', '.join(lacking)} {'have' if len(lacking) > 1 else 'has'} no finite error. " if lacking else "")


# How chi2 rises as one parameter is moved and the others follow: the 95 % interval, and what the curvature says.

LIKELIHOOD_TOP = 3.2  # of the threshold: as far up as is drawn


class Likelihood:
    """value and the rise of chi2, in units in which 95 % is at RISE_95."""

    def __init__(self, fit, name):
        name = name or next(iter(fit.likelihood), "")
        if name not in fit.likelihood:
            known = ", ".join(fit.likelihood) or "none"
            raise PlotError(f'{fit.path}: no likelihood of "{name}" (there is: {known}); name it in fit.likelihood')
        with files.reading(fit.path, f"likelihood.{name}"):
            self.parameter, found = fit.parameters[name], fit.likelihood[name]
            self.value, chi2 = (np.array(found[key], dtype=float).reshape(len(found["value"])) for key in ("value", "chi2"))
        if np.isfinite(chi2).sum() < 2:
            raise PlotError(f"{fit.path}: likelihood.{name} holds less than two points: nothing to draw")
        kept = np.isfinite(self.value) & np.isfinite(chi2)
        self.value, chi2 = self.value[kept], chi2[kept]
        best = fit.number(fit.record, "objective", chi2.min())
        self.rise = (chi2 - min(best, chi2.min())) / (fit.number(fit.record, "error_factor", 1.0) or 1.0) ** 2
        self.low, self.high = fit.number(found, "low", -math.inf), fit.number(found, "high", math.inf)

    @property
    def log(self):
        return self.parameter.log and self.value.min() > 0 and self.value.max() > 3 * self.value.min()

    def parabola(self, x):
        """Of the curvature at the best value; symmetric in the logarithm of a parameter searched there. None if flat."""
        at, error = self.parameter.value, self.parameter.curvature
        if not (math.isfinite(error) and error > 0):
            return None
        return (np.log(x / at) * at / error) ** 2 if self.parameter.log and at > 0 else ((x - at) / error) ** 2


def draw_fit_likelihood(run, spec):
    like = Likelihood(run.fit, spec.parameter)
    figure, axes = canvas.curve_panel(1)
    axes.set_xscale("log" if like.log else "linear")
    low, high = like.value.min(), like.value.max()
    x = np.geomspace(low, high, 400) if like.log else np.linspace(low, high, 400)
    axes.axvspan(max(like.low, low), min(like.high, high), color=style.LINE, alpha=0.12, linewidth=0, label="95 % interval")
    axes.axhline(RISE_95, **canvas.FAINT)
    axes.axvline(like.parameter.value, color=style.GREY, linewidth=0.6, zorder=1)
    parabola = like.parabola(x)
    if parabola is not None:
        axes.plot(x, parabola, color=style.OTHERS[0], linewidth=1.1, linestyle=(0, (5, 3)), label="curvature at the best value")
    axes.plot(like.value, like.rise, "o-", color=style.LINE, markersize=3.2, linewidth=1.2, label="others refitted")
    top = min(max(like.rise.max(), 1.3 * RISE_95), LIKELIHOOD_TOP * RISE_95)
    axes.set(xlim=(low, high), ylim=(-0.03 * top, 1.05 * top), xlabel=fit_words.quantity(like.parameter), ylabel=r"rise of $\chi^2$")
    if like.log:
        canvas.plain_ticks(axes.xaxis, low, high)
    canvas.legend(axes, loc="upper center")
    axes.annotate(f"{words.number(RISE_95, 3)}", (0.62, RISE_95), (0, 2), xycoords=axes.get_yaxis_transform(), textcoords="offset points",
                  ha="center", va="bottom", fontsize=8.5, color=style.GREY)
    canvas.heading(axes, style.safe(spec.title))
    return figure


def caption_fit_likelihood(run, spec):
    like = Likelihood(run.fit, spec.parameter)
    one = like.parameter
    text = (f"Rise of <i>χ</i>² above its minimum as {fit_words.symbol_html(one.name)} is held at other values and the other free "
            f"parameters are fitted again. Shaded: 95 % interval, {fit_words.interval_html(like.low, like.high, one.unit)}, where the rise "
            f"stays below {words.number(RISE_95, 3)} (level line). ")
    if like.parabola(np.array([one.value])) is not None:
        text += f"Broken: parabola from the curvature at the best value, {fit_words.value(one)}. "
    if run.fit.number(run.fit.record, "error_factor", 1.0) != 1.0:
        text += "The errors of the data are unknown: the rise is in units of <i>χ</i>² per degree of freedom. "
    return text


def defaults_fit_likelihood(run):
    return [Spec(f"fit_likelihood_{name}", "fit_likelihood", parameter=name) for name in run.fit.likelihood]


# Where the starts of a search ended: the objective over its best, and the parameters, in the order of the objective.

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


def draw_fit_starts(run, spec):
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


def start_marks(axes, ends, values):
    rank = 1 + np.arange(values.size)
    size = 4.2 if values.size <= 40 else 2.8
    axes.plot(rank[~ends.best], values[~ends.best], "o", color=style.GREY, markerfacecolor="white", markersize=size, markeredgewidth=0.8)
    axes.plot(rank[ends.best], values[ends.best], "o", color=style.LINE, markersize=size, markeredgewidth=0)


def waterfall(axes, ends):
    lowest = BELOW * ends.same
    axes.axhspan(lowest / 3, ends.same, color=style.LINE, alpha=0.1, linewidth=0)
    start_marks(axes, ends, np.maximum(ends.over, lowest))
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
    start_marks(axes, ends, found)
    both = np.concatenate([starts, found])
    both = both[np.isfinite(both)]
    if parameter.log and both.size and both.min() > 0:
        axes.set_yscale("log")
        low, high = both.min() / 1.5, both.max() * 1.5
        canvas.plain_ticks(axes.yaxis, low, high)
    else:
        size = np.ptp(both) if both.size else 0.0
        room = 0.12 * size or 0.1 * abs(both).max(initial=0.0) or 1.0
        low, high = (both.min() - room, both.max() + room) if both.size else (-1.0, 1.0)
    for bound in parameter.bounds:
        if low <= bound <= high:
            axes.axhline(bound, color=style.GREY, linewidth=0.8, linestyle=(0, (5, 3)), zorder=1)
    axes.set_ylim(low, high)
    axes.set_ylabel(fit_words.quantity(parameter))


def caption_fit_starts(run, spec):
    ends = Ends(run.fit)
    text = (f"The {words.number(len(run.fit.starts))} starts of the search, best first: excess of the final objective over the best, and the "
            "final values. Filled: the same optimum, that is, within the shaded range; hollow: ended elsewhere; "
            "bars: where they started. ")
    bounded = any(map(math.isfinite, sum((one.bounds for one in run.fit.free), ())))
    text += "Broken lines: bounds, where they are in sight. " if bounded else ""
    return text + (f"{ends.failed} {'starts' if ends.failed > 1 else 'start'} failed." if ends.failed else "")


KINDS = {
    "fit_likelihood": Kind(draw=draw_fit_likelihood, caption=caption_fit_likelihood, defaults=defaults_fit_likelihood),
    "fit_correlation": Kind(draw=draw_fit_correlation, caption=caption_fit_correlation, there=lambda run: len(run.fit.free) > 1),
    "fit_starts": Kind(draw=draw_fit_starts, caption=caption_fit_starts, there=lambda run: len(run.fit.starts) > 1),
}
