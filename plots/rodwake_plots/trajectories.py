"""Paths of the rods, coloured by time (paper, Figs. attraction b, pletraj, nonreciptheory a); a panel per variant."""

import math
import string

from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize

from . import canvas, curves, path_panel, style, words
from .errors import MissingError
from .paths import lie_on_each_other, mark_interval, seen_until, window_of
from .spec import Spec

FLAT = 0.6  # windows flatter than this have the colour bar below
PARAMETERS = "eta", "alpha", "kappa", "gamma1", "gamma2"


def draw(run, spec):
    runs, units = runs_of(run.result), run.result.units
    window = window_of(runs, spec)
    last = seen_until(runs, window)
    extent = max(map(abs, window.x + window.y))
    length, time = units.length("x", extent), units.time("t", last)
    look = path_panel.Look(length.factor, time.factor, Normalize(0, last * time.factor or 1.0), mark_interval(last),
                           lie_on_each_other(runs, window))
    overlay = spec.overlay and len(runs) > 1
    figure, grid = layout(window, 1 if overlay else len(runs))
    panels = list(grid.ravel())
    label_axes(grid, len(panels) if overlay else len(runs), length.label, units.length("y", extent).label)
    if overlay:
        figure.set_figheight(figure.get_figheight() - (0.9 if window.aspect < FLAT else 0.0))  # no colour bar below
        overlaid(panels[0], runs, units, window, look)
        canvas.heading(panels[0], "\n".join(filter(None, (style.safe(spec.title), shared(units, runs)))))
        return figure
    for index, (axes, one) in enumerate(zip(panels, runs)):
        title(axes, units, one, spec, index if len(runs) > 1 else None)
        path_panel.draw(axes, one, window, look)
    for index, spare in enumerate(panels[len(runs):]):
        spare.set_axis_off()
        if index == 0:
            path_panel.key(spare, look, time.label)
    if not look.apart:
        colour_bar(figure, panels, look.norm, time.label, window, any(one.t[-1] > last * (1 + 1e-9) for one in runs))
    if len(runs) > 1:
        figure.suptitle("\n".join(filter(None, (style.safe(spec.title), shared(units, runs)))), fontsize=10.5)
    return figure


def overlaid(axes, runs, units, window, look):
    """A colour for each run, and a legend."""
    canvas.window(axes, *(tuple(look.length * edge for edge in pair) for pair in (window.x, window.y)))
    for run, colour in zip(runs, curves.colours(len(runs))):
        axes.plot([], [], color=colour, label=f"{style.safe(run.label)}: {outcome_line(units, run)}")
        for rod in range(run.x.shape[1]):
            x, y = run.x[:, rod] * look.length, run.y[:, rod] * look.length
            axes.plot(x, y, color=colour, linewidth=1.3, scalex=False, scaley=False)
            for index, mark in ((0, path_panel.hollow), (-1, path_panel.filled)):
                mark(axes, x[index], y[index], run.theta[index, rod], colour)
    axes.figure.legend(loc="upper center", bbox_to_anchor=(0.5, 0.0), frameon=False, fontsize=8.5, handlelength=1.6)


def runs_of(result):
    runs = result.runs()
    if not runs:
        raise MissingError(result.path, "group /rods is missing: no trajectories to draw")
    return runs


def layout(window, count):
    """Panels of equal scale; columns chosen so that the figure is neither a tower nor a ribbon."""
    columns = best_columns(window.aspect, count)
    rows = math.ceil(count / columns)
    flat = window.aspect < FLAT
    width = style.WIDE if columns > 1 else style.SINGLE + 0.5
    inner = (width - (0.6 if flat else 1.3)) / columns - 0.1
    height = rows * (inner * window.aspect + 0.6) + (1.0 if flat else 0.3)
    figure = canvas.figure(width, height)
    return figure, figure.subplots(rows, columns, squeeze=False, sharex=True, sharey=True)


def best_columns(aspect, count):
    def cost(columns):
        rows = math.ceil(count / columns)
        holes = rows * columns - count
        return abs(math.log(rows * aspect / columns / 0.65)) + 0.6 * holes
    return min(range(1, min(count, 3) + 1), key=cost)


def label_axes(grid, count, xlabel, ylabel):
    """Numbers and labels at the left and under the lowest panel of each column."""
    columns = grid.shape[1]
    for index, axes in enumerate(grid.ravel()[:count]):
        lowest, leftmost = index + columns >= count, index % columns == 0
        axes.tick_params(labelbottom=lowest, labelleft=leftmost)
        axes.set_xlabel(xlabel if lowest else "")
        axes.set_ylabel(ylabel if leftmost else "")


def title(axes, units, run, spec, index):
    if index is None:
        canvas.heading(axes, "\n".join(filter(None, (style.safe(spec.title) or outcome_line(units, run), shared(units, [run])))))
        return
    letter = f"({string.ascii_lowercase[index % 26]})"
    canvas.heading(axes, f"{letter}  {style.safe(run.label)}\n{outcome_line(units, run)}")
    axes.title.set_fontsize(9.5)


def shared(units, runs):
    """Medium and couplings that all runs have, for the head of the figure; couplings that are zero go without saying."""
    told = [key for key in PARAMETERS if key in runs[0].attrs and len({one.attrs.get(key) for one in runs}) == 1]
    return ",  ".join(f"${units.parameter(key, runs[0].attrs[key], 3)}$" for key in told if runs[0].attrs[key] or key in ("eta", "alpha"))


def outcome_line(units, run):
    if "time" not in run.attrs:
        return run.outcome
    return f"{run.outcome}, {units.equals(units.time('t', run.attrs['time']), 't', run.attrs['time'])}"


def colour_bar(figure, panels, norm, label, window, more):
    flat = window.aspect < FLAT and len(panels) <= 2
    place = dict(location="bottom", shrink=0.75, aspect=40, pad=0.03) if flat else dict(pad=0.015, aspect=30)
    bar = figure.colorbar(ScalarMappable(norm, style.TIME_MAP), ax=panels, extendfrac=0.03, extend="max" if more else "neither", **place)
    bar.set_label(label)
    bar.ax.tick_params(direction="in")


def caption(run, spec):
    runs, units = runs_of(run.result), run.result.units
    interval = words.number(mark_interval(seen_until(runs, window_of(runs, spec))))
    rods = runs[0].x.shape[1]
    text = f"Paths of {rods} rods" if rods > 1 else "Path of one rod"
    overlay = spec.overlay and len(runs) > 1
    apart = lie_on_each_other(runs, window_of(runs, spec)) and not overlay
    text += ", of all variants in one panel: hollow mark at the start, filled at the end. " if overlay else ""
    if overlay:
        return text + " ".join(f"{words.label_html(one.label)}: {outcome_words(units, one)}." for one in runs)
    text += ", coloured by rod and moved apart by about a line's width where they would hide each other" if apart else ", coloured by time"
    text += f": hollow mark at the start, filled at the end, small marks every {interval} {units.time_html()}; the thin end points forward. "
    if any(run.samples for run in runs):
        text += "Thin lines: the same rods in draws of the measured field's errors. "
    if len(runs) == 1:
        outcome = outcome_words(units, runs[0])
        return text + outcome[0].upper() + outcome[1:] + ". " + parameters(units, runs[0])
    told = (f"{words.label_html(one.label)}: {outcome_words(units, one)}." for one in runs)
    return text + " ".join(f"({string.ascii_lowercase[i % 26]}) {one}" for i, one in enumerate(told))


def outcome_words(units, run):
    parts = [words.escape(run.outcome)]
    if "time" in run.attrs:
        parts[0] += " at " + words.equation("<i>t</i>", run.attrs["time"], units.time_html(), digits=6)
    if "min_separation" in run.attrs:
        parts.append(f"closest approach {words.number(run.attrs['min_separation'])} {units.length_html()}")
    return ", ".join(parts)


def parameters(units, run):
    """With units, as HTML."""
    known = [f'<span class="eq">{words.tex_html(units.parameter(key, run.attrs[key]))}</span>' for key in PARAMETERS if key in run.attrs]
    return ", ".join(known) + "." if known else ""


def defaults(run):
    return [Spec("trajectories", "trajectories")] if run.result.has("/rods") else []
