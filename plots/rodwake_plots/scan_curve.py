"""A number of a scan along its first axis, a curve for each value of the others (as the paper's Delta y against phi_b)."""

from typing import NamedTuple

import numpy as np
from matplotlib.colors import LogNorm

from . import canvas, scan_columns, scan_run, scan_words, style, words
from .errors import PlotError
from .scan_run import Axis
from .schema import Kind, Spec

MOST = 9       # more curves than this are thinned out
OF_BEDS = ("delta_y", "last_change", "mean_speed0", "psi6")  # the first of these is drawn unless a scene asks for others
ASIDE = 0.012  # of the axis, between curves with error bars


class Group(NamedTuple):
    """Points that differ along the first axis alone."""
    title: str
    html: str
    x: np.ndarray  # numbers of the file
    y: np.ndarray
    sigma: np.ndarray  # [below, above][point]
    outcome: np.ndarray  # of rods; of beds, whose numbers are means over runs of any outcome, all alike


def draw(run, spec):
    scan, name = run.scan, column(run, spec)
    found, _ = groups(scan, name)
    axis = scan.axes[0]
    figure, axes = canvas.curve_panel(len(found))
    factor, label = scan_columns.label(run, name, max(np.nanmax(np.abs(group.y)) for group in found))
    norm, _, _ = scan_columns.scaling(name, np.concatenate([group.y for group in found]) * factor)
    logarithmic = isinstance(norm, LogNorm)
    axis.dress(axes.xaxis, *window(scan, spec))
    if scan_columns.quantity(name).signed:
        axes.axhline(0, color=style.GREY, linewidth=0.6)
    for index, (group, colour) in enumerate(zip(found, canvas.colours(len(found)))):
        x, y = apart(axis, group, index, len(found)) * axis.factor, group.y * factor
        axes.plot(*scan_columns.alike(x, y, group.outcome), color=colour, linewidth=0.8, alpha=0.6, zorder=2)
        canvas.points(axes, x, y, group.sigma * factor, colour, group.title or None, canvas.curve_mark(index))
    if logarithmic:
        axes.set_yscale("log")
        canvas.plain_ticks(axes.yaxis, *axes.get_ylim())
    failed(axes, scan)
    if spec.y:
        axes.set_ylim(*spec.y)
    axes.set_ylabel(label)
    canvas.legend(axes)
    canvas.heading(axes, style.safe(spec.title) or scan_words.fixed_title(run))
    return figure


def column(run, spec):
    """As asked for; else delta_y of beds and final_separation of rods, or the first that there is."""
    if spec.column:
        scan_columns.values(run.scan, spec.column)
        return spec.column
    there = scan_columns.names(run.scan)
    if not there:
        raise PlotError(f"{run.scan.path}: holds no column of numbers other than its axes: nothing to draw")
    return next((name for name in ("delta_y", "final_separation") if name in there), there[0])


def groups(scan, name):
    """(Groups in the order of the file, how many there would be); points without the number are left out."""
    values = scan_columns.values(scan, name)
    sigma = scan_columns.errors(scan, name)
    others = scan.places[:, 1:]
    kinds, number = np.unique(others, axis=0, return_inverse=True)
    if len(kinds) > MOST and scan.design not in ("grid", "adaptive"):
        kinds, number = kinds[:1], np.zeros(len(values), dtype=int)  # scattered points share no values: they are one cloud
        fixed = [()]
    else:
        fixed = [[(axis, float(axis.back(place))) for axis, place in zip(scan.axes[1:], kind)] for kind in kinds]
    shown = np.unique(np.linspace(0, len(kinds) - 1, min(MOST, len(kinds))).round().astype(int))
    found = []
    for index in shown:
        rows = np.flatnonzero((number.ravel() == index) & np.isfinite(values))
        rows = rows[np.argsort(scan.place(0)[rows], kind="stable")]
        if rows.size:
            title, html = (", ".join(say(axis, value) for axis, value in fixed[index]) for say in (Axis.equals, Axis.equals_html))
            found.append(Group(title, html, scan.place(0)[rows], values[rows], sigma[:, rows], scan.outcome[rows] * (not scan.of_beds)))
    if not found:
        raise PlotError(f"{scan.path}: column {name} holds no numbers: nothing to draw")
    return found, len(kinds)


def apart(axis, group, index, count):
    """Moved a little along the axis, so that bars do not hide each other."""
    if count == 1 or not np.isfinite(group.sigma).any():
        return group.x
    return axis.back(axis.even(group.x) + ASIDE * axis.span * (index - (count - 1) / 2))


def window(scan, spec):
    if spec.x:
        return scan_run.shown_window(scan.axes[0], spec.x, "x")
    return scan_run.margin(scan.axes[0], 0.04)


def failed(axes, scan):
    """Crosses at the foot: where points failed."""
    x = np.unique(scan.place(0)[scan.failed]) * scan.axes[0].factor
    if x.size:
        look = dict(scan_columns.FAILED, markersize=4.5, markeredgewidth=1.0, label=f"failed ({int(scan.failed.sum())})")
        axes.errorbar(x, np.full(x.size, 0.025), transform=axes.get_xaxis_transform(), **look)  # as the curves: last in the legend


def caption(run, spec):
    scan, name = run.scan, column(run, spec)
    found, all_of_them = groups(scan, name)
    shown = scan_columns.quantity(name, scan)
    meaning, unit = scan_columns.meaning(name, scan), scan_columns.unit_html(run, name)
    text = words.escape(shown.name[0].upper() + shown.name[1:]) + (f" in {unit}" if unit else "") + (f" ({meaning})" if meaning else "")
    text += f", against {scan.axes[0].name_html}: {scan_words.points_html(scan)}"
    if any(np.isfinite(group.sigma).any() for group in found):
        text += f"; bars: {'95 % interval' if f'{name}_low' in scan.columns else 'standard error'}" + (", curves moved a little apart along the axis" if len(found) > 1 else "")
    text += "."
    if len(found) < all_of_them:
        text += f" {len(found)} of {scan_words.count(all_of_them)} curves are shown."
    return text + (scan_words.failures_html(scan) + scan_words.left_html(scan) + scan_words.fixed_html(run) + scan_words.ties_html(scan))


def defaults(run):
    there = [name for name in OF_BEDS if name in run.scan.columns and np.isfinite(scan_columns.values(run.scan, name)).any()]
    return [Spec(f"scan_{name}", "scan_curve", column=name) for name in there[:1]]


KINDS = {"scan_curve": Kind(draw=draw, caption=caption, defaults=defaults)}
