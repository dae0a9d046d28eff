"""Samples of a fit's parameters: each by itself and in pairs, along the chains, and what they predict beside the data."""

import math

import numpy as np
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.ticker import MaxNLocator

from . import canvas, fit, fit_words, style, words
from .schema import Kind

MOST = 7  # parameters in pairs; starts of tracks are the first to go
PRIOR = dict(color=style.GREY, linewidth=1.0, linestyle=(0, (5, 3)))
MASSES = 0.865, 0.393  # held by an ellipse of two and of one standard deviations
BINS = 36


def shown(run):
    """The parameters of the figures, the starts of tracks left out where there are too many."""
    found = run.posterior.parameters
    if len(found) > MOST:
        found = [one for one in found if not fit_words.pose_of(one.name)] or found
    return found[:MOST]


class Axis:
    """Range, scale and coordinate of a parameter: its logarithm where it is searched there or the samples go over decades."""

    def __init__(self, one, values, fitted):
        low, high = np.percentile(values, [0.1, 99.9])
        self.one, self.values, self.fitted = one, values.ravel(), fitted
        self.log = low > 0 and high > 8 * low
        low, high = self.to(low), self.to(high)
        room = 0.15 * (high - low) or 0.1 * abs(high) or 1.0
        ends = [low, high]
        if fitted and self.sees(fitted.value) and low - 6 * room < self.to(fitted.value) < high + 6 * room:
            ends.append(self.to(fitted.value))
        bounds = [self.to(end) if math.isfinite(end) and self.sees(end) else math.nan for end in (one.prior.low, one.prior.high)]
        self.low, self.high = np.fmax(min(ends) - room, bounds[0]), np.fmin(max(ends) + room, bounds[1])

    def sees(self, value):
        return not self.log or value > 0

    def to(self, value):
        return np.log(value) if self.log else value

    def back(self, value):
        return np.exp(value) if self.log else value

    @property
    def limits(self):
        return self.back(self.low), self.back(self.high)

    def density(self, of, x):
        """Per unit of the coordinate."""
        return of(x) * (x if self.log else 1.0)

    def error(self):
        """Standard error of the fit, and whether it is one of the logarithm."""
        one = self.fitted
        known = one and math.isfinite(one.error) and one.error > 0
        return (one.error, one.log and one.value > 0) if known else (math.nan, False)

    def moved(self, t):
        """The value t standard errors from the optimum, symmetric where the fit was."""
        error, log = self.error()
        return self.fitted.value * np.exp(t * error / self.fitted.value) if log else self.fitted.value + t * error


def axes_of(run):
    chains = run.posterior.chains()
    return [Axis(one, chains[one.name], run.fit.parameters.get(one.name)) for one in shown(run)]


def draw_corner(run, spec):
    all_axes = axes_of(run)
    count = len(all_axes)
    figure = canvas.figure(max(style.SINGLE, min(style.WIDE + 1, 1.35 * count + 1.2)), max(3.0, min(style.WIDE + 1, 1.35 * count + 1.0)))
    grid = figure.subplots(count, count, squeeze=False)
    for row in range(count):
        for column in range(count):
            axes = grid[row][column]
            if column > row:
                axes.set_axis_off()
            elif column == row:
                draw_one(axes, all_axes[row])
            else:
                draw_pair(axes, all_axes[column], all_axes[row], correlation(run, all_axes[column], all_axes[row]))
            if column <= row:
                dress(axes, all_axes[column], all_axes[row] if column < row else None, row == count - 1, column == 0)
    key(figure, all_axes)
    if spec.title:
        figure.suptitle(style.safe(spec.title), fontsize=11)
    return figure


def dress(axes, across, up, lowest, leftmost):
    axes.set_xlim(*across.limits)
    scale(axes.xaxis, across)
    if up:
        axes.set_ylim(*up.limits)
        scale(axes.yaxis, up)
    axes.tick_params(labelbottom=lowest, labelleft=leftmost and up is not None, labelsize=8)
    axes.set_xlabel(fit_words.quantity(across.one) if lowest else "")
    axes.set_ylabel(fit_words.quantity(up.one) if leftmost and up else "")


def scale(axis, of):
    if of.log:
        axis.axes.set(**{f"{axis.axis_name}scale": "log"})
        canvas.plain_ticks(axis, *of.limits)
        canvas.plain_decades(axis, *of.limits)
    else:
        axis.set_major_locator(MaxNLocator(4, steps=[1, 2, 5, 10], prune="both"))


def draw_one(axes, one):
    edges = np.linspace(one.low, one.high, BINS + 1)
    height, _ = np.histogram(one.to(one.values), edges)
    height = height / (one.values.size * (edges[1] - edges[0]))
    axes.stairs(height, one.back(edges), fill=True, color=style.LINE, alpha=0.3)
    axes.stairs(height, one.back(edges), color=style.LINE, linewidth=1.0)
    x = one.back(np.linspace(one.low, one.high, 300))
    axes.plot(x, one.density(one.one.prior.density, x), **PRIOR)
    if math.isfinite(one.error()[0]):
        t = np.linspace(-5, 5, 201)
        at = one.moved(t)
        kept = at > 0 if one.log else np.isfinite(at)
        slope = np.gradient(one.to(at[kept]), t[kept])
        axes.plot(at[kept], np.exp(-t[kept] ** 2 / 2) / (math.sqrt(2 * math.pi) * np.abs(slope)), color=style.OTHERS[0], linewidth=1.0)
    if one.fitted:
        axes.axvline(one.fitted.value, color=style.OTHERS[0], linewidth=0.7)
    axes.set_ylim(0, 1.15 * height.max())
    axes.set_yticks([])


def draw_pair(axes, across, up, correlated):
    x, y = np.linspace(across.low, across.high, BINS + 1), np.linspace(up.low, up.high, BINS + 1)
    found, _, _ = np.histogram2d(across.to(across.values), up.to(up.values), [x, y])
    found = smooth(found)
    levels = sorted({level_of(found, mass) for mass in MASSES})
    centres = [one.back((edges[1:] + edges[:-1]) / 2) for one, edges in ((across, x), (up, y))]
    axes.contourf(*centres, found.T, [*levels, found.max() * 1.001], colors=[style.LINE] * len(levels), alpha=0.28)
    axes.contourf(*centres, found.T, [levels[-1], found.max() * 1.001], colors=[style.LINE], alpha=0.35)
    axes.contour(*centres, found.T, levels, colors=style.LINE, linewidths=0.8)
    if across.fitted and up.fitted:
        axes.plot(across.fitted.value, up.fitted.value, "+", color=style.OTHERS[0], markersize=7, markeredgewidth=1.2)
        if math.isfinite(across.error()[0] * up.error()[0] * correlated):
            t = np.linspace(0, 2 * math.pi, 200)
            for size in (1, 2):
                a, b = size * np.cos(t), size * (correlated * np.cos(t) + math.sqrt(max(0.0, 1 - correlated ** 2)) * np.sin(t))
                axes.plot(across.moved(a), up.moved(b), color=style.OTHERS[0], linewidth=0.9)


def correlation(run, one, other):
    names = [each.name for each in run.fit.free]
    known = one.one.name in names and other.one.name in names
    return run.fit.correlation[names.index(one.one.name)][names.index(other.one.name)] if known else math.nan


def smooth(counts):
    """By a narrow Gaussian, over as many cells as the samples need to make a smooth line."""
    width = 1.1
    kernel = np.exp(-(np.arange(-4, 5) / width) ** 2 / 2)
    kernel /= kernel.sum()
    for axis in (0, 1):
        counts = np.apply_along_axis(np.convolve, axis, counts, kernel, mode="same")
    return counts


def level_of(density, mass):
    """Above it lies this part of all."""
    ranked = np.sort(density.ravel())[::-1]
    return ranked[min(np.searchsorted(np.cumsum(ranked), mass * ranked.sum()), ranked.size - 1)]


def key(figure, all_axes):
    handles = [Patch(facecolor=style.LINE, edgecolor=style.LINE, alpha=0.4, label="samples"), Line2D([], [], label="prior", **PRIOR)]
    if any(one.fitted for one in all_axes):
        handles.append(Line2D([], [], color=style.OTHERS[0], linewidth=1.0, marker="+", markersize=7, label="least squares"))
    figure.legend(handles=handles, loc="upper right", bbox_to_anchor=(0.985, 0.985), frameon=False, fontsize=9) if len(all_axes) > 1 else (
        figure.legend(handles=handles, loc="upper center", bbox_to_anchor=(0.5, 0.0), ncols=3, frameon=False, fontsize=9))


def describe_parameters(run, parameters):
    return ", ".join(f'<span class="eq">{fit_words.symbol_html(one.name)} = '
                     f"{fit_words.with_unit(words.with_error(one.mean, one.sd), one.unit)}</span>" for one in parameters)


def caption_corner(run, spec):
    parameters = shown(run)
    text = f"Posterior of the parameters, mean and standard deviation: {describe_parameters(run, parameters)}. "
    if len(parameters) > 1:
        text += "Shaded: regions that hold 39 % and 86 % of the samples, as ellipses of one and two standard deviations do. "
    text += "Broken: the priors. Orange: the least-squares optimum and its standard errors. "
    left = len(run.posterior.parameters) - len(parameters)
    return text + (f"{left} more {'parameters are' if left > 1 else 'parameter is'} not shown. " if left else "")


# Along the chains.

def draw_trace(run, spec):
    chains, parameters = run.posterior.chains(), shown(run)
    figure = canvas.figure(style.WIDE, 1.25 * len(parameters) + 0.7)
    panels = figure.subplots(len(parameters), 2, squeeze=False, sharey="row", width_ratios=[5, 1])
    for (axes, side), one in zip(panels, parameters):
        values = chains[one.name]
        across = Axis(one, values, None)
        edges = np.linspace(across.low, across.high, BINS + 1)
        for index, (chain, colour) in enumerate(zip(values, canvas.colours(len(values)))):
            axes.plot(np.arange(chain.size), chain, color=colour, linewidth=0.4, alpha=0.8, zorder=2 + 0.1 * index)
            height, _ = np.histogram(across.to(chain), edges)
            side.stairs(height, across.back(edges), orientation="horizontal", color=colour, linewidth=0.8)
        axes.set_xlim(0, values.shape[1] - 1)
        axes.set_ylim(*across.limits)
        scale(axes.yaxis, across)
        axes.set_ylabel(fit_words.quantity(one))
        side.set_xlim(0, None)
        side.set_xticks([])
        canvas.heading(axes, rf"$\hat R$ = {one.rhat:.4f}, {one.ess:.0f} effective samples")
        axes.tick_params(labelbottom=one is parameters[-1])
    panels[-1][0].set_xlabel("draw")
    if spec.title:
        figure.suptitle(style.safe(spec.title), fontsize=11)
    return figure


def caption_trace(run, spec):
    count = run.posterior.record.get("chains", "?")
    accepted = run.posterior.record.get("accepted") or []
    text = f"Samples of each parameter along the {words.number(count)} chains, a colour each, and their distributions. "
    return text + (f"Of the steps {100 * min(accepted):.0f} to {100 * max(accepted):.0f} % were taken. " if accepted else "")


# What the samples predict beside the data.

BAND = dict(color=style.LINE, linewidth=0)
NEAREST = 0.2  # of the core: closer to the singular place nothing is drawn


def draw_predictive(run, spec):
    views = fit.chosen(run.fit, spec)
    figure, panels = fit.layout(len(views), False)
    for index, (view, (axes, _)) in enumerate(zip(views, panels)):
        number = next(at for at, one in enumerate(run.fit.profiles) if one is view.profile)
        draw_bands(axes, run, view, run.posterior.table("curve", number))
        axes.set_xlabel(fit_words.axis(view.profile.get("along", "x"), run.fit.unit))
        axes.set_ylabel(fit_words.axis(f"U_{fit_words.line(view.profile)[0]}", run.fit.unit))
        fit.title(axes, run.fit.unit, view, spec.title, index if len(views) > 1 else None)
    band_key(figure)
    if spec.title and len(views) > 1:
        figure.suptitle(style.safe(spec.title), fontsize=11)
    return figure


def draw_bands(axes, run, view, table):
    x, at = table["x"], fit.force_at(run.fit, view)
    near = (np.abs(x - at) < max(NEAREST * run.fit.number(run.fit.record, "core", 0.0), 0.02 * np.ptp(x))) & (view.profile.get("at") == 0)
    column = {name: np.where(near, np.nan, table[name]) for name in ("median", "low", "high", "noise_low", "noise_high")}
    axes.axhline(0, color=style.GREY, linewidth=0.6, zorder=1)
    fit.shade_core(axes, run.fit)
    axes.fill_between(x, column["noise_low"], column["noise_high"], alpha=0.15, zorder=2, **BAND)
    axes.fill_between(x, column["low"], column["high"], alpha=0.4, zorder=3, **BAND)
    axes.plot(x, column["median"], color=style.LINE, linewidth=1.2, zorder=4)
    fit.draw_data(axes, view.points, view.points.value, np.full(view.points.value.size, np.nan))
    axes.set_xlim(*fit.span(view.points.x))
    axes.set_ylim(*fit.panel_limits(view, None))


def band_key(figure, colour=style.LINE):
    look = dict(color=colour, linewidth=0)
    handles = [Line2D([], [], marker="o", markersize=3.6, linestyle="none", color=style.INK, label="data"),
               Patch(alpha=0.55, label="posterior, 95 %", **look), Patch(alpha=0.15, label="with the noise of the data, 95 %", **look)]
    figure.legend(handles=handles, loc="upper center", bbox_to_anchor=(0.5, 0.0), ncols=3, frameon=False, fontsize=9)


def caption_predictive(run, spec):
    return "Data (points) and what the samples of the posterior predict. " + BANDS


BANDS = ("Dark: 95 % of the predictions. Light: where 95 % of data with the given errors should lie; a model that leaves many more outside does not "
         "describe them. ")


def draw_predictive_tracks(run, spec):
    tracks = run.fit.trajectories
    figure = canvas.figure(style.WIDE + 1, 2.0 * len(tracks) + 0.7)
    panels = figure.subplots(len(tracks), 3, squeeze=False, sharex="row")
    for index, (line, track) in enumerate(zip(panels, tracks)):
        table = run.posterior.table("trajectory", index)
        for coordinate, (axes, name) in enumerate(zip(line, ("x", "y", r"\theta"))):
            draw_track(axes, table, coordinate)
            canvas.heading(axes, (f"{words.letter(index)}  {style.safe(str(track.get('name', '')))}: " if coordinate == 0 and len(tracks) > 1 else "")
                           + f"${name}$")
            axes.set_xlabel("$t$" if index == len(tracks) - 1 else "")
        line[0].set_ylabel("data − median")
    band_key(figure, style.GREY)
    if spec.title:
        figure.suptitle(style.safe(spec.title), fontsize=11)
    return figure


def draw_track(axes, table, coordinate):
    axes.axhline(0, color=style.GREY, linewidth=0.6, zorder=1)
    rods = np.unique(table["rod"])
    for rod, mark in zip(rods, canvas.MARKS * len(rods)):
        kept = (table["rod"] == rod) & (table["coordinate"] == coordinate)
        t, median = table["t"][kept], table["median"][kept]
        colour = style.ROD_COLOURS[int(rod) % len(style.ROD_COLOURS)]
        for low, high, shade, alpha in (("noise_low", "noise_high", style.GREY, 0.22 / len(rods)), ("low", "high", colour, 0.3)):
            axes.fill_between(t, table[low][kept] - median, table[high][kept] - median, color=shade, alpha=alpha, linewidth=0, zorder=2)
        axes.plot(t, table["data"][kept] - median, mark, color=colour, markersize=2.6, zorder=3)
    axes.yaxis.set_major_locator(MaxNLocator(4, steps=[1, 2, 5, 10]))


def caption_predictive_tracks(run, spec):
    return "Residuals of the tracks from the posterior median, one colour per rod: positions in the unit of the file, headings in rad. " + BANDS


KINDS = {
    "posterior": Kind(draw=draw_corner, caption=caption_corner, there=lambda run: run.has_posterior),
    "posterior_trace": Kind(draw=draw_trace, caption=caption_trace, there=lambda run: run.has_posterior),
    "posterior_predictive": Kind(draw=draw_predictive, caption=caption_predictive, there=lambda run: run.has_posterior and run.fit.profiles),
    "posterior_trajectories": Kind(draw=draw_predictive_tracks, caption=caption_predictive_tracks,
                                   there=lambda run: run.has_posterior and run.fit.trajectories),
}
