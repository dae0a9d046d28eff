"""Measured profiles of the displacement and the fit to them, a panel each (paper, Figs. 7 and 8)."""

import math
from typing import NamedTuple

import numpy as np
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator

from . import canvas, fit_prediction, fit_words, style, words
from .errors import PlotError
from .schema import Kind


def draw(run, spec):
    views = chosen(run.fit, spec)
    figure, panels = layout(len(views), spec.residuals)
    for index, (view, (axes, strip)) in enumerate(zip(views, panels)):
        draw_panel(axes, run.fit, view, window_of(view.profile, spec))
        (strip or axes).set_xlabel(fit_words.axis(view.profile.get("along", "x"), run.fit.unit))
        axes.set_ylabel(fit_words.axis(f"U_{fit_words.line(view.profile)[0]}", run.fit.unit))
        title(axes, run.fit.unit, view, spec.title, index if len(views) > 1 else None)
        if strip:
            draw_residuals(strip, run.fit, view)
    canvas.align_headings([[axes for axes, _ in panels[row:row + 2]] for row in range(0, len(panels), 2)])
    key(figure, run.fit, views)
    if spec.title and len(views) > 1:
        figure.suptitle(style.safe(spec.title), fontsize=11)
    return figure


def chosen(fit, spec):
    """The wanted profiles with their tables."""
    if not fit.profiles:
        raise PlotError(f"{fit.path}: holds no profiles; a fit to trajectories is drawn by kind fit_trajectories")
    for index in spec.profiles:
        if not 0 <= index < len(fit.profiles):
            raise PlotError(f"{fit.path}: holds {len(fit.profiles)} profiles, from 0; there is no profile {index}")
    wanted = [fit.profiles[index] for index in spec.profiles] or fit.profiles
    return [View(profile, fit.points(profile), fit.curve(profile)) for profile in wanted]


def title(axes, unit, view, asked, index):
    """What is shown; for a profile that was not fitted, how far off the prediction is."""
    shown = fit_words.line_math(view.profile, unit)
    lines = [style.safe(asked) or shown if index is None else f"{words.letter(index)}  {shown}"]
    if fit_words.predicted(view.profile):
        size = fit_prediction.rms(view.points, view.points.used)[0]
        lines.append("predicted, not fitted" + (rf": rms ${words.math_number(size, 2)}\,\sigma$" if math.isfinite(size) else ""))
    canvas.heading(axes, "\n".join(lines))


def window_of(profile, spec):
    return spec.x if profile.get("along") == "x" else spec.y


def layout(count, strips):
    """Figure and for each panel its axes and, under it, those of the residuals or None."""
    columns = min(count, 2)
    rows = math.ceil(count / columns)
    figure = canvas.figure(style.WIDE if columns > 1 else style.SINGLE + 0.5, rows * (3.35 if strips else 2.5) + 0.45)
    ratios = [3, 1] * rows if strips else [1] * rows
    grid = figure.add_gridspec(len(ratios), columns, height_ratios=ratios)
    panels = []
    for index in range(count):
        row, column = divmod(index, columns)
        axes = figure.add_subplot(grid[row * (2 if strips else 1), column])
        strip = figure.add_subplot(grid[2 * row + 1, column], sharex=axes) if strips else None
        axes.tick_params(labelbottom=not strips)
        panels.append((axes, strip))
    return figure, panels


def key(figure, fit, views):
    """One legend for all panels, below them."""
    handles = [Line2D([], [], marker="o", markersize=3.6, linestyle="none", color=style.INK, label="data")]
    if any((~view.points.used).any() for view in views):
        handles.append(Line2D([], [], marker="o", markersize=3.6, linestyle="none", color=LEFT_OUT, markerfacecolor="white",
                              label="left out"))
    handles.append(Line2D([], [], color=style.LINE, linewidth=1.5, label="prediction" if all(fit_words.predicted(view.profile) for view in views) else "fit"))
    for index, one in enumerate(fit.compared):
        handles.append(Line2D([], [], color=style.OTHERS[index % 5], linestyle=DASHES[index % 3], linewidth=1.2,
                              label=style.label(str(one.get("name", index)))))
    columns = min(len(handles), 5 if len(views) > 1 else 3)
    figure.legend(handles=handles, loc="upper center", bbox_to_anchor=(0.5, 0.0), ncols=columns, frameon=False, fontsize=9, handlelength=2.2)


def hover_marks(run, spec, figure):
    """Each point with its error and what the theory says there, in the panel of its profile."""
    panels = [axes for axes in figure.axes if axes.get_title()]
    for axes, view in zip(panels, chosen(run.fit, spec)):
        component, along, _ = fit_words.line(view.profile)
        for x, value, sigma, model, used in zip(*view.points):
            error = f" ± {sigma:.2g}" if math.isfinite(sigma) else ""
            yield (axes, x, value, f"{along} = {x:.4g}: U{component} = {value:.3g}{error}, theory {model:.3g} {run.fit.unit}"
                   f"{'' if used else ' (left out)'}".replace("-", "−"))


def caption(run, spec):
    return caption_of(run.fit, chosen(run.fit, spec), spec)


# One measured profile and the fit to it, and what is left between them.

DASHES = [(0, (5, 3)), (0, (1.5, 2)), (0, (6, 2, 1.5, 2))]
LEFT_OUT = "#9a9a9a"
REACH = 2.5  # a comparison beyond this times the range of the data is cut off


class View(NamedTuple):
    """What a panel shows."""
    profile: dict
    points: object
    curve: object


def draw_panel(axes, fit, view, window):
    points, curve = view.points, view.curve
    axes.axhline(0, color=style.GREY, linewidth=0.6, zorder=1)
    shade_core(axes, fit)
    for index, values in enumerate(curve.compared):
        draw_line(axes, fit, *broken(fit, view, values), color=style.OTHERS[index % 5], linestyle=DASHES[index % 3], linewidth=1.2, zorder=2.5)
    x, model = modelled(fit, view)
    band = broken(fit, view, curve.band)[1]
    axes.fill_between(x, model - band, model + band, color=style.LINE, alpha=0.25, linewidth=0, zorder=2)
    draw_line(axes, fit, x, model, color=style.LINE, linewidth=1.5, zorder=4)
    draw_data(axes, points, points.value, points.sigma)
    axes.set_xlim(*(window or span(points.x)))
    axes.set_ylim(*panel_limits(view, window))


def draw_line(axes, fit, x, values, **look):
    """Faint within the core, where the theory makes no claim."""
    inside = np.abs(x) < fit.number(fit.record, "core", 0.0)
    if inside.any():
        axes.plot(x, values, **{**look, "linewidth": 0.8, "alpha": 0.45})
    axes.plot(x, np.where(inside, np.nan, values), **look)


def span(x):
    low, high = x.min(), x.max()
    room = 0.02 * (high - low) or 1.0
    return low - room, high + room


def draw_data(axes, points, value, sigma):
    look = dict(markersize=3.0, elinewidth=0.7, capsize=0)
    for kept, colour, inside in ((points.used, style.INK, style.INK), (~points.used, LEFT_OUT, "white")):
        if kept.any():
            canvas.points(axes, points.x[kept], value[kept], sigma[kept], colour, markerfacecolor=inside, markeredgewidth=0.7, **look)


def shade_core(axes, fit):
    core = fit.number(fit.record, "core", 0.0)
    if core > 0:
        axes.axvspan(-core, core, color=style.GREY, alpha=0.08, linewidth=0, zorder=0)


def broken(fit, view, values):
    """No line across the position of the force, where the field is singular, nor within a fifth of the core around it."""
    x = view.curve.x
    if view.profile.get("at") != 0 or not x.min() < (at := force_at(fit, view)) < x.max():
        return x, values
    split = np.searchsorted(x, at)
    values = np.where(np.abs(x - at) < 0.2 * fit.number(fit.record, "core", 0.0), np.nan, values)
    return np.insert(x, split, at), np.insert(values, split, np.nan)


def modelled(fit, view):
    """The fitted curve; of maps with moments, which tell nothing near the rod, beyond the core alone."""
    x, model = broken(fit, view, view.curve.model)
    return x, np.where(np.abs(x) < fit.number(fit.record, "core", 0.0), np.nan, model) if fit.maps else model


def force_at(fit, view):
    known = fit.parameters.get("x0")
    return known.value if known and view.profile.get("along") == "x" else 0.0


def panel_limits(view, window):
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


def strip_reach(values, used, least):
    """Of the strip to both sides: all residuals, but those left out of the fit up to twice the others."""
    fitted, every = (np.abs(one[np.isfinite(one)]).max(initial=least) for one in (values[used], values))
    return min(every, 2 * fitted) or 1.0


def draw_residuals(axes, fit, view):
    """Data minus fit in standard errors; in the profiles' unit where the errors are not known."""
    points = view.points
    known = bool(np.isfinite(points.sigma).any())
    values = (points.value - points.model) / (points.sigma if known else 1.0)
    axes.axhline(0, color=style.GREY, linewidth=0.6, zorder=1)
    shade_core(axes, fit)
    if known:
        axes.axhspan(-1, 1, color=style.LINE, alpha=0.12, linewidth=0, zorder=0)
    size = strip_reach(values, points.used, 3.0 if known else 0.0)
    beyond = np.abs(values) > size
    draw_data(axes, points, np.where(beyond, np.nan, values), np.full(values.size, np.nan))
    for sign, mark in ((1, "^"), (-1, "v")):  # too far off for the strip: at its edge
        far = beyond & (np.sign(values) == sign)
        axes.plot(points.x[far], np.full(far.sum(), sign * 1.08 * size), mark, color=LEFT_OUT, markersize=3.4, zorder=3)
    axes.set_ylim(-1.2 * size, 1.2 * size)
    axes.yaxis.set_major_locator(MaxNLocator(4, steps=[1, 2, 5, 10]))
    axes.set_ylabel(r"(data $-$ fit)/$\sigma$" if known else fit_words.axis(r"(\mathrm{data}-\mathrm{fit})", fit.unit), fontsize=8.5)


# Captions of figures of a fit.

def caption_of(fit, views, spec):
    text = "Displacement of the medium around a rod that heads along +<i>x</i>: data (points"
    known = any(np.isfinite(view.points.sigma).any() for view in views)
    text += ", bars: standard error" if known else ", of unknown error"
    text += f") and the theory of an isotropic medium (lines). {fitted_to(fit)}: {fit_words.medium_values(fit) or fit_words.values(fit.parameters.values())}. "
    if any(np.nanmax(view.curve.band, initial=0.0) > 0 for view in views):
        text += "Shaded: one standard error of the curve, from the noise of the data. "
    if spec.residuals:
        text += "Below each panel the residuals" + (" in standard errors; triangles at the edge: beyond it. " if known else "; triangles at the edge: beyond it. ")
    core = fit.number(fit.record, "core", 0.0)
    text += f"Points within {words.equation('', core, fit_words.unit_html(fit.unit)).replace(' = ', '')} were left out. " if core > 0 else ""
    text += "".join(describe_panel(index, view, len(views), fit) for index, view in enumerate(views))
    text += "".join(not_shown(fit, one) for one in fit.profiles if all(one is not view.profile for view in views))
    return text + "".join(compared(fit, one) for one in fit.compared)


def fitted_to(fit):
    """Which profiles the parameters come from."""
    names = [fit_words.line_html(one, fit.unit) for one in fit.profiles if not fit_words.predicted(one)]
    return "Fitted to " + words.listed(names or ["maps" if fit.maps else "trajectories"])


def describe_panel(index, view, count, fit):
    """Of one panel: whether it is a prediction, and how good."""
    if not fit_words.predicted(view.profile):
        return ""
    name, found = f"{words.letter(index)} " if count > 1 else "", fit_prediction.html(fit, view.profile)
    return f"{name}{fit_words.line_html(view.profile, fit.unit)} was predicted, not fitted{f': {found}' if found else ''}. "


def not_shown(fit, profile):
    """How good the prediction of a profile without a panel is, by its name."""
    found = fit_prediction.html(fit, profile) if fit_words.predicted(profile) else ""
    return f'{words.label_html(str(profile.get("name", "")))} was predicted, not fitted: {found}. ' if found else ""


def compared(fit, one):
    given = one.get("values") or {}
    known = ", ".join(words.equation(fit_words.symbol_html(name), value, unit_of(fit, name)) for name, value in given.items())
    return f"For comparison, {words.label_html(str(one.get('name', '')))}: {known}. "


def unit_of(fit, name):
    if name in fit.derived:
        return fit_words.unit_html(fit.derived[name][2])
    return fit_words.unit_html(fit.parameters[name].unit) if name in fit.parameters else ""


KINDS = {"fit": Kind(draw=draw, caption=caption, hover_marks=hover_marks, there=lambda run: run.fit.profiles)}
