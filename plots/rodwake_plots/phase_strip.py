"""Phase diagram of a scan with one axis: a strip of outcomes, and above it a number, its points in the colours of the outcomes."""

import numpy as np
from matplotlib.colors import LogNorm

from . import canvas, phase_panel, ranges, scan_axis, scan_columns, scan_outcomes, scan_raster, scan_words, style

NUMBERS = ("final_separation", "delta_y", "time")  # the first that the scan has is drawn above the strip of outcomes


def draw(run, spec):
    scan, column = run.scan, column_of(run, spec)
    figure = canvas.figure(style.SINGLE + 1.2, 3.3 if column else 1.5)
    upper, strip = figure.subplots(2, 1, sharex=True, height_ratios=(7, 1)) if column else (None, figure.subplots())
    low, high = window(scan, spec)
    if column:
        curve(upper, run, spec, column)
        scan.axes[0].dress(upper.xaxis, low, high)
        upper.tick_params(labelbottom=False)
        upper.set_xlabel("")
    paint(strip, scan)
    scan.axes[0].dress(strip.xaxis, low, high)
    strip.set_yticks([])
    strip.tick_params(which="both", top=False, direction="out")
    top = upper or strip
    legend = scan_outcomes.handles(scan.outcome, int(scan.failed.sum()), False)
    top.legend(handles=legend, title=scan_outcomes.title(scan.outcome), loc="upper left", bbox_to_anchor=(1.0, 1.02), frameon=False,
               fontsize=9, title_fontsize=9, handlelength=1.3, handleheight=1.1, alignment="left")
    canvas.heading(top, style.safe(spec.title) or scan_words.fixed_title(run))
    return figure


def column_of(run, spec):
    """What stands above the strip; empty: nothing that the scan has."""
    if spec.colour != "outcome":
        return spec.colour
    there = (name for name in NUMBERS if name in run.scan.columns)
    return next((name for name in there if np.isfinite(scan_columns.values(run.scan, name)).any()), "")


def window(scan, spec):
    axis = scan.axes[0]
    if spec.x:
        return scan_axis.shown_window(axis, spec.x, "x")
    edges = cell_edges(scan)
    return axis.back(edges[0]), axis.back(edges[-1])


def cell_edges(scan):
    """Around the points, but none beyond the ends of an axis that was refined."""
    edges = scan_raster.edges(scan_raster.steps(scan.places[:, 0])[0])
    if scan.design == "grid":
        return edges
    return np.clip(edges, scan.axes[0].even(scan.axes[0].low), scan.axes[0].even(scan.axes[0].high))


def paint(axes, scan):
    axis = scan.axes[0]
    _, number = scan_raster.steps(scan.places[:, 0])
    codes = np.full(number.max() + 1, -1, dtype=np.int8)
    codes[number] = scan.outcome
    x = axis.back(cell_edges(scan)) * axis.factor
    mesh = axes.pcolormesh(x, [0, 1], np.zeros((1, len(codes))), shading="flat", rasterized=len(codes) > 2000)
    mesh.set_array(None)
    mesh.set_facecolor(scan_outcomes.painted(codes) / 255)
    if scan.failed.any():
        axes.plot(scan.place(0)[scan.failed] * axis.factor, np.full(scan.failed.sum(), 0.5), **scan_outcomes.FAILED, markersize=4.5,
                  markeredgewidth=1.0)


def curve(axes, run, spec, name):
    scan = run.scan
    values = scan_columns.values(scan, name)
    factor, label = scan_columns.label(run, name, np.nanmax(np.abs(values), initial=0.0))
    norm, _, _ = scan_columns.scaling(name, values * factor)
    x, y = scan.place(0) * scan.axes[0].factor, values * factor
    axes.plot(*scan_outcomes.alike(x, y, scan.outcome), color=style.GREY, linewidth=0.6, zorder=1)
    axes.scatter(x, y, s=min(phase_panel.size(len(x)), 16), c=scan_outcomes.painted(scan.outcome) / 255, edgecolors=(0, 0, 0, 0.5),
                 linewidths=0.25, zorder=2)
    if isinstance(norm, LogNorm):
        axes.set_yscale("log")
        ranges.plain_ticks(axes.yaxis, norm.vmin, norm.vmax)
    if scan_columns.quantity(name).signed:
        axes.axhline(0, color=style.GREY, linewidth=0.6, zorder=0)
    if spec.y:
        axes.set_ylim(*spec.y)
    axes.set_ylabel(label)
