"""Measured profiles of the displacement and the fit to them, a panel each (paper, Figs. ufield2 and newcal)."""

import math

from matplotlib.lines import Line2D

from . import canvas, fit_caption, fit_panel, fit_words, style
from .errors import PlotError
from .spec import Spec


def draw(run, spec):
    views = chosen(run.fit, spec)
    figure, panels = layout(len(views), spec.residuals)
    for index, (view, (axes, strip)) in enumerate(zip(views, panels)):
        fit_panel.draw(axes, run.fit, view, window_of(view.profile, spec))
        (strip or axes).set_xlabel(fit_words.axis(view.profile.get("along", "x"), run.fit.unit))
        axes.set_ylabel(fit_words.axis(f"U_{fit_words.line(view.profile)[0]}", run.fit.unit))
        title(axes, run.fit.unit, view, spec.title, index if len(views) > 1 else None)
        if strip:
            fit_panel.residuals(strip, run.fit, view)
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
    return [fit_panel.View(profile, fit.points(profile), fit.curve(profile)) for profile in wanted]


def title(axes, unit, view, asked, index):
    """What is shown; of a profile that was not fitted, by what the data exceed the prediction."""
    shown = fit_words.line_math(view.profile, unit)
    lines = [style.safe(asked) or shown if index is None else f"{fit_words.letter(index)}  {shown}"]
    if fit_words.predicted(view.profile):
        found = fit_words.excess(view.profile)
        more = rf": data = ${fit_words.plain_math(fit_words.excess_html(found))}$ × theory" if found else ""
        lines.append(f"prediction{more}")
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
        handles.append(Line2D([], [], marker="o", markersize=3.6, linestyle="none", color=fit_panel.LEFT_OUT, markerfacecolor="white",
                              label="left out"))
    handles.append(Line2D([], [], color=style.LINE, linewidth=1.5, label="fit"))
    for index, one in enumerate(fit.compared):
        handles.append(Line2D([], [], color=fit_panel.COMPARED[index % 5], linestyle=fit_panel.DASHES[index % 3], linewidth=1.2,
                              label=style.safe(str(one.get("name", index)))))
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
    return fit_caption.of(run.fit, chosen(run.fit, spec), spec)


def defaults(run):
    return [Spec("fit", "fit")] if run.fit.profiles else []
