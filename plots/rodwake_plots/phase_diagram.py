"""Phase diagram of a scan: outcomes, or a number, over its axes; of three axes a panel a slice, of one a strip."""

import math
from typing import NamedTuple

import numpy as np
from matplotlib.cm import ScalarMappable
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.colors import LogNorm
from matplotlib.patches import Patch

from . import canvas, scan_columns, scan_raster, scan_run, scan_words, style
from .errors import PlotError
from .scan_run import OUTCOMES
from .schema import Kind, Spec

OUTCOME = "outcome"
OVERLAYS = ("time", "final_separation", "non_reciprocity")


def draw(run, spec):
    scan = run.scan
    if len(scan.axes) == 1:
        return draw_strip(run, spec)
    parts = scan_words.slices(scan, spec.slices)
    drawing = drawing_of(run, spec)
    figure, panels = layout(len(parts), spec.colour != OUTCOME)
    for index, (axes, part) in enumerate(zip(panels, parts)):
        draw_panel(axes, drawing, part)
        canvas.heading(axes, part.title)
        if len(parts) > 1:
            canvas.letter(axes, index)
        label(axes, index, len(parts))
    columns = across(len(parts))
    last = panels[columns - 1]
    if spec.colour == OUTCOME:
        legend(last, scan, drawing.boundary)
    else:
        colour_bar(figure, panels, run, spec)
        notes(panels[columns * ((len(parts) - 1) // columns)], scan, spec, drawing)
    title = style.safe(spec.title) or scan_words.fixed_title(run)
    if len(parts) > 1:
        figure.suptitle(title, fontsize=10.5)
    else:
        canvas.heading(panels[0], style.safe(spec.title) or ",  ".join(filter(None, (parts[0].title, title))))
    return figure


def drawing_of(run, spec):
    scan = run.scan
    leaves = scan_raster.Leaves(scan) if scan.has_cells and len(scan.axes) in (2, 3) else None
    x, y = panel_windows(scan, spec)
    boundary = spec.boundary and bool(scan.boundary) and len(scan.axes) == 2 and (
        "critical values" if scan.is_critical else "traced boundary")
    return Drawing(scan, look_of(run, spec), x, y, boundary, spec.cells, leaves)


def look_of(run, spec):
    if spec.colour == OUTCOME:
        return Look()
    values = scan_columns.values(run.scan, spec.colour)
    factor, _ = scan_columns.unit(run, spec.colour, extent(values))
    norm, _, colours = scan_columns.scaling(spec.colour, values * factor)
    return Look(np.ma.filled(norm(np.ma.masked_invalid(values * factor)), np.nan), colours)


def extent(values):
    return max((abs(value) for value in values[values == values]), default=1.0)


def layout(count, bar):
    """Two or three panels a row; a single one has room for its legend beside it."""
    if count == 1:
        figure = canvas.figure(4.7 if bar else 5.0, 3.75 if bar else 3.4)
        return figure, [figure.subplots()]
    columns = across(count)
    rows = math.ceil(count / columns)
    figure = canvas.figure(style.WIDE, (2.75 if columns == 2 else 2.1) * rows + 0.5)
    grid = figure.subplots(rows, columns, squeeze=False, sharex=True, sharey=True).ravel()
    for spare in grid[count:]:
        spare.set_axis_off()
    return figure, list(grid)


def across(count):
    """Panels a row."""
    return count if count < 4 else 2 if count == 4 else 3


def label(axes, index, count):
    """Numbers at the left and under the lowest panels."""
    if count == 1:
        return
    lowest, leftmost = index + across(count) >= count, index % across(count) == 0
    axes.tick_params(which="both", labelbottom=lowest, labelleft=leftmost)
    axes.set(**{name: "" for name, there in (("xlabel", lowest), ("ylabel", leftmost)) if not there})


def legend(axes, scan, boundary):
    """Beside the panel, under what capture means."""
    handles = scan_columns.outcome_handles(scan.outcome, int(scan.failed.sum()), boundary)
    canvas.beside(axes, handles, [one.get_label() for one in handles], title=scan_columns.outcomes_title(scan.outcome),
                  loc="upper left", bbox_to_anchor=(1.0, 1.015), frameon=False, fontsize=9, title_fontsize=9, handlelength=1.3,
                  handleheight=1.1, alignment="left", labelspacing=0.55)


def colour_bar(figure, panels, run, spec):
    values = scan_columns.values(run.scan, spec.colour)
    factor, text = scan_columns.label(run, spec.colour, extent(values))
    norm, ends, colours = scan_columns.scaling(spec.colour, values * factor)
    canvas.colour_bar(figure, ScalarMappable(norm, colours), panels, text, extend=ends, pad=0.02, aspect=28)


def notes(axes, scan, spec, drawing):
    """What is not in the colour bar, under the panel."""
    lacking = ~np.isfinite(drawing.look.places) & ~scan.failed
    pursuit = scan.outcome == OUTCOMES.index("pursuit")
    found = []
    for name, colour, there in (("pursuit", scan_columns.COLOURS["pursuit"], lacking & pursuit),
                                ("not captured" if scan_columns.quantity(spec.colour, scan).of else "no value", scan_columns.NOTHING,
                                 lacking & ~pursuit)):
        if there.any():
            found.append(Patch(facecolor=colour, edgecolor=style.GREY, linewidth=0.4, label=name))
    found += scan_columns.outcome_handles(scan.outcome[:0], int(scan.failed.sum()), drawing.boundary)
    if found:
        axes.legend(handles=found, loc="upper left", bbox_to_anchor=(-0.02, -0.19), borderaxespad=0.0,
                    ncol=2 if len(found) == 4 else 3, frameon=False, fontsize=9, handlelength=1.3, handleheight=1.1, columnspacing=1.4)


def hover_marks(run, spec, figure):
    """Each point with its outcome, or the number that is shown, in the panel of its slice."""
    scan = run.scan
    if len(scan.axes) == 1:
        return
    values = None if spec.colour == OUTCOME else scan_columns.values(scan, spec.colour)
    for axes, part in zip(figure.axes, scan_words.slices(scan, spec.slices)):
        for row in np.flatnonzero(part.rows):
            text = "failed" if scan.failed[row] else OUTCOMES[scan.outcome[row]] if scan.outcome[row] >= 0 else "not evaluated"
            text += f", {scan_columns.quantity(spec.colour, scan).name} {values[row]:.4g}" if values is not None and np.isfinite(values[row]) else ""
            places = [float(scan.place(index)[row]) for index in (0, 1)]
            at = ", ".join(axis.equals_text(place) for axis, place in zip(scan.axes, places))
            yield axes, *(place * axis.factor for axis, place in zip(scan.axes, places)), f"{at}: {text}".replace("-", "−")


def caption(run, spec):
    return scan_words.caption(run, spec)


def defaults(run):
    scan = run.scan
    found = [Spec("phase_diagram", "phase_diagram", colour=OUTCOME)]
    if len(scan.axes) == 2:
        found += [Spec(f"phase_{name}", "phase_diagram", colour=name) for name in (*OVERLAYS, "delta_y") if has_numbers(scan, name)]
    return found


def has_numbers(scan, name):
    try:
        scan_columns.scaling(name, scan_columns.values(scan, name))
    except PlotError:
        return False
    return True


# One panel of a phase diagram: cells, or points where a scan has no cells; boundaries, failed points.

CASING = dict(color="white", linewidth=1.8, alpha=0.7)  # between numbers a line alone would vanish
OUTLINE = dict(color="#000000", linewidth=0.25, alpha=0.45)
HATCH = dict(facecolors="none", edgecolors=(0, 0, 0, 0.3), linewidths=0.0, hatch="//////")


class Look(NamedTuple):
    """What colours a panel: outcomes, or numbers."""
    places: np.ndarray = None  # of each point on the colour map, 0 to 1; nan: no number; None: outcomes
    map: object = None

    def rgba(self, codes, places):
        """Bytes; transparent where there is no point, or a failed one."""
        if self.places is None:
            return scan_columns.painted(codes)
        made = self.map(np.ma.masked_invalid(places), bytes=True)
        lacking = ~np.isfinite(places)
        made[lacking] = scan_columns.without_number(codes[lacking])
        made[codes < 0] = 0
        return made


class Drawing(NamedTuple):
    """A scan, and what of it is wanted; x and y are the window in numbers of the file."""
    scan: object
    look: Look
    x: tuple
    y: tuple
    boundary: str | bool  # the name of its lines; False: none are drawn
    outlines: bool
    leaves: object  # scan_raster.Leaves, or None

    @property
    def numbers(self):
        return np.full(len(self.scan.failed), np.nan) if self.look.places is None else self.look.places


def draw_panel(axes, drawing, part):
    paint = paint_leaves if drawing.leaves else paint_grid if is_grid(drawing.scan) else paint_points
    for axis, one, window in zip((axes.xaxis, axes.yaxis), drawing.scan.axes, (drawing.x, drawing.y)):
        one.dress(axis, *window)
    axes.tick_params(which="both", direction="out", top=False, right=False)
    paint(axes, drawing, part)
    if drawing.outlines and drawing.leaves:
        outlines(axes, drawing, part)
    if drawing.leaves and len(drawing.scan.axes) == 2 and drawing.scan.open_cells.any():
        hatch_open(axes, drawing)
    if drawing.boundary:
        draw_boundary(axes, drawing)
    draw_failed(axes, drawing, part)


def is_grid(scan):
    """Whether the points of a panel have cells around them: a scan of choices alone has too."""
    return scan.design == "grid"


def paint_leaves(axes, drawing, part):
    """A picture in even coordinates under the axes, which may be logarithmic."""
    scan = drawing.scan
    window = [axis.even(ends) for axis, ends in zip(scan.axes, (drawing.x, drawing.y))]
    picture = scan_raster.of_leaves(drawing.leaves, scan.outcome, drawing.numbers, window, part.at)
    under = axes.inset_axes([0, 0, 1, 1], zorder=0.5)
    under.set_axis_off()
    under.imshow(drawing.look.rgba(picture.codes, picture.values), extent=picture.extent, origin="lower", aspect="auto",
                 interpolation="antialiased")
    under.set(xlim=window[0], ylim=window[1])


def paint_grid(axes, drawing, part):
    scan, rows = drawing.scan, part.rows
    made = scan_raster.of_grid(scan.places[rows, :2], scan.outcome[rows], drawing.numbers[rows])
    x, y = (axis.back(edges) * axis.factor for axis, edges in zip(scan.axes, (made.x, made.y)))
    mesh = axes.pcolormesh(x, y, np.zeros(made.codes.shape), rasterized=True, zorder=0.5, shading="flat")
    mesh.set_array(None)
    mesh.set_facecolor(drawing.look.rgba(made.codes, made.values).reshape(-1, 4) / 255)
    for axis, line, edges in zip(scan.axes, (axes.axvline, axes.axhline), (x, y)):
        for edge in edges[1:-1] if axis.is_choice else ():
            line(edge, color="white", linewidth=2)


def paint_points(axes, drawing, part):
    scan = drawing.scan
    rows = np.flatnonzero(part.rows & ~scan.failed)
    rows = rows[np.random.default_rng(0).permutation(len(rows))]  # so that none of the outcomes lies on top
    x, y = (scan.place(index)[rows] * scan.axes[index].factor for index in (0, 1))
    axes.scatter(x, y, s=mark_size(len(rows)), c=drawing.look.rgba(scan.outcome[rows], drawing.numbers[rows]) / 255, linewidths=0.25,
                 edgecolors=(0, 0, 0, 0.35) if len(rows) < 4000 else "none", zorder=1, rasterized=len(rows) > 2000)


def mark_size(count):
    """Points squared: many points are small."""
    return float(np.clip(16000 / max(count, 1), 1.5, 30))


def outlines(axes, drawing, part):
    """Edges of the leaves, in the numbers of the file."""
    low, high, *_ = drawing.leaves.sliced(part.at)
    lattice, scan = drawing.leaves.lattice, drawing.scan
    ends = [lattice.origin[:2] + lattice.size[:2] * side[:, :2] for side in (low, high)]
    (left, bottom), (right, top) = ([axis.back(side[:, index]) * axis.factor for index, axis in enumerate(scan.axes[:2])] for side in ends)
    across = np.stack([np.stack([left, bottom], -1), np.stack([right, bottom], -1)], axis=1)
    upwards = np.stack([np.stack([left, bottom], -1), np.stack([left, top], -1)], axis=1)
    axes.add_collection(LineCollection(np.concatenate([across, upwards]), **OUTLINE, zorder=0.8, rasterized=True), autolim=False)


def hatch_open(axes, drawing):
    """Cells that are not known to have one outcome."""
    scan = drawing.scan
    lows, highs, _ = scan.cells
    ends = [[axis.back(side[scan.open_cells, index]) * axis.factor for index, axis in enumerate(scan.axes)] for side in (lows, highs)]
    (left, bottom), (right, top) = ends
    corners = np.stack([np.stack(corner, -1) for corner in ((left, bottom), (right, bottom), (right, top), (left, top))], axis=1)
    axes.add_collection(PolyCollection(corners, **HATCH, zorder=0.7), autolim=False)


def draw_boundary(axes, drawing):
    factors = [axis.factor for axis in drawing.scan.axes[:2]]
    lines = [curve.places[:, :2] * factors for curve in drawing.scan.boundary]
    for look, order in ((CASING, 2), (scan_columns.BOUNDARY, 2.1))[drawing.look.places is None:]:
        axes.add_collection(LineCollection(lines, capstyle="round", joinstyle="round", **look, zorder=order), autolim=False)


def draw_failed(axes, drawing, part):
    scan = drawing.scan
    rows = np.flatnonzero(part.rows & scan.failed)
    if rows.size:
        x, y = (scan.place(index)[rows] * scan.axes[index].factor for index in (0, 1))
        axes.plot(x, y, **scan_columns.FAILED, markersize=np.clip(60 / np.sqrt(rows.size), 2, 5), markeredgewidth=0.9, zorder=3)


def panel_windows(scan, spec):
    """Limits of the two axes in numbers of the file; cells of a grid reach half a cell beyond its ends."""
    found = []
    for index, (axis, asked) in enumerate(zip(scan.axes, (spec.x, spec.y))):
        room = 0.0
        if scan.design == "grid":
            edges = scan_raster.edges(scan_raster.steps(scan.places[:, index])[0])
            room = max(axis.even(axis.low) - edges[0], edges[-1] - axis.even(axis.high)) / axis.span
        elif scan.design != "adaptive":
            room = 0.02
        found.append(scan_run.shown_window(axis, asked, "xy"[index]) if asked else scan_run.margin(axis, max(room, 0.0)))
    return found


# Phase diagram of a scan with one axis: a strip of outcomes, and above it a number, its points in the colours of the outcomes.

NUMBERS = ("final_separation", "delta_y", "time")  # the first that the scan has is drawn above the strip of outcomes


def draw_strip(run, spec):
    scan, column = run.scan, column_of(run, spec)
    figure = canvas.figure(style.SINGLE + 1.2, 3.3 if column else 1.5)
    upper, strip = figure.subplots(2, 1, sharex=True, height_ratios=(7, 1)) if column else (None, figure.subplots())
    low, high = strip_window(scan, spec)
    if column:
        strip_curve(upper, run, spec, column)
        scan.axes[0].dress(upper.xaxis, low, high)
        upper.tick_params(labelbottom=False)
        upper.set_xlabel("")
    paint_strip(strip, scan)
    scan.axes[0].dress(strip.xaxis, low, high)
    strip.set_yticks([])
    strip.tick_params(which="both", top=False, direction="out")
    top = upper or strip
    legend(top, scan, False)
    canvas.heading(top, style.safe(spec.title) or scan_words.fixed_title(run))
    return figure


def column_of(run, spec):
    """What stands above the strip; empty: nothing that the scan has."""
    if spec.colour != "outcome":
        return spec.colour
    there = (name for name in NUMBERS if name in run.scan.columns)
    return next((name for name in there if np.isfinite(scan_columns.values(run.scan, name)).any()), "")


def strip_window(scan, spec):
    axis = scan.axes[0]
    if spec.x:
        return scan_run.shown_window(axis, spec.x, "x")
    edges = cell_edges(scan)
    return axis.back(edges[0]), axis.back(edges[-1])


def cell_edges(scan):
    """Around the points, but none beyond the ends of an axis that was refined."""
    edges = scan_raster.edges(scan_raster.steps(scan.places[:, 0])[0])
    if scan.design == "grid":
        return edges
    return np.clip(edges, scan.axes[0].even(scan.axes[0].low), scan.axes[0].even(scan.axes[0].high))


def paint_strip(axes, scan):
    axis = scan.axes[0]
    _, number = scan_raster.steps(scan.places[:, 0])
    codes = np.full(number.max() + 1, -1, dtype=np.int8)
    codes[number] = scan.outcome
    x = axis.back(cell_edges(scan)) * axis.factor
    mesh = axes.pcolormesh(x, [0, 1], np.zeros((1, len(codes))), shading="flat", rasterized=len(codes) > 2000)
    mesh.set_array(None)
    mesh.set_facecolor(scan_columns.painted(codes) / 255)
    if scan.failed.any():
        axes.plot(scan.place(0)[scan.failed] * axis.factor, np.full(scan.failed.sum(), 0.5), **scan_columns.FAILED, markersize=4.5,
                  markeredgewidth=1.0)


def strip_curve(axes, run, spec, name):
    scan = run.scan
    values = scan_columns.values(scan, name)
    factor, label = scan_columns.label(run, name, np.nanmax(np.abs(values), initial=0.0))
    norm, _, _ = scan_columns.scaling(name, values * factor)
    x, y = scan.place(0) * scan.axes[0].factor, values * factor
    axes.plot(*scan_columns.alike(x, y, scan.outcome), color=style.GREY, linewidth=0.6, zorder=1)
    axes.scatter(x, y, s=min(mark_size(len(x)), 16), c=scan_columns.painted(scan.outcome) / 255, edgecolors=(0, 0, 0, 0.5),
                 linewidths=0.25, zorder=2)
    if isinstance(norm, LogNorm):
        axes.set_yscale("log")
        canvas.plain_ticks(axes.yaxis, norm.vmin, norm.vmax)
    if scan_columns.quantity(name).signed:
        axes.axhline(0, color=style.GREY, linewidth=0.6, zorder=0)
    if spec.y:
        axes.set_ylim(*spec.y)
    axes.set_ylabel(label)


KINDS = {"phase_diagram": Kind(draw=draw, caption=caption, hover_marks=hover_marks, defaults=defaults)}
