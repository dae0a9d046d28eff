"""Phase diagram of a scan: outcomes, or a number, over its axes; of three axes a panel a slice, of one a strip."""

import math

import numpy as np
from matplotlib.cm import ScalarMappable
from matplotlib.colors import LogNorm
from matplotlib.patches import Patch

from . import canvas, phase_panel, phase_strip, ranges, scan_columns, scan_outcomes, scan_raster, scan_slices, scan_words, style
from .errors import PlotError
from .scan_run import OUTCOMES
from .spec import Spec

OUTCOME = "outcome"
OVERLAYS = ("time", "final_separation", "non_reciprocity")


def draw(run, spec):
    scan = run.scan
    if len(scan.axes) == 1:
        return phase_strip.draw(run, spec)
    parts = scan_slices.slices(scan, spec.slices)
    drawing = drawing_of(run, spec)
    figure, panels = layout(len(parts), spec.colour != OUTCOME)
    for index, (axes, part) in enumerate(zip(panels, parts)):
        phase_panel.draw(axes, drawing, part)
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
    x, y = phase_panel.windows(scan, spec)
    boundary = spec.boundary and bool(scan.boundary) and len(scan.axes) == 2
    return phase_panel.Drawing(scan, look_of(run, spec), x, y, boundary, spec.cells, leaves)


def look_of(run, spec):
    if spec.colour == OUTCOME:
        return phase_panel.Look()
    values = scan_columns.values(run.scan, spec.colour)
    factor, _ = scan_columns.unit(run, spec.colour, extent(values))
    norm, _, colours = scan_columns.scaling(spec.colour, values * factor)
    return phase_panel.Look(np.ma.filled(norm(np.ma.masked_invalid(values * factor)), np.nan), colours)


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
    axes.legend(handles=scan_outcomes.handles(scan.outcome, int(scan.failed.sum()), boundary), title=scan_outcomes.title(scan.outcome),
                loc="upper left", bbox_to_anchor=(1.0, 1.015), frameon=False, fontsize=9, title_fontsize=9, handlelength=1.3,
                handleheight=1.1, alignment="left", labelspacing=0.55)


def colour_bar(figure, panels, run, spec):
    values = scan_columns.values(run.scan, spec.colour)
    factor, text = scan_columns.label(run, spec.colour, extent(values))
    norm, ends, colours = scan_columns.scaling(spec.colour, values * factor)
    mapped, place = ScalarMappable(norm, colours), dict(pad=0.02, aspect=28)
    if isinstance(norm, LogNorm):
        ranges.log_bar(figure, mapped, panels, ends, text, **place)
        return
    bar = figure.colorbar(mapped, ax=panels, extend=ends, extendfrac=0.03, **place)
    bar.set_label(text)
    bar.ax.tick_params(direction="in")


def notes(axes, scan, spec, drawing):
    """What is not in the colour bar, under the panel."""
    lacking = ~np.isfinite(drawing.look.places) & ~scan.failed
    pursuit = scan.outcome == OUTCOMES.index("pursuit")
    found = []
    for name, colour, there in (("pursuit", scan_outcomes.COLOURS["pursuit"], lacking & pursuit),
                                ("not captured" if scan_columns.quantity(spec.colour, scan).of else "no value", scan_outcomes.NOTHING,
                                 lacking & ~pursuit)):
        if there.any():
            found.append(Patch(facecolor=colour, edgecolor=style.GREY, linewidth=0.4, label=name))
    found += scan_outcomes.handles(scan.outcome[:0], int(scan.failed.sum()), drawing.boundary)
    if found:
        axes.legend(handles=found, loc="upper left", bbox_to_anchor=(-0.02, -0.19), borderaxespad=0.0,
                    ncol=2 if len(found) == 4 else 3, frameon=False, fontsize=9, handlelength=1.3, handleheight=1.1, columnspacing=1.4)


def hover_marks(run, spec, figure):
    """Each point with its outcome, or the number that is shown, in the panel of its slice."""
    scan = run.scan
    if len(scan.axes) == 1:
        return
    values = None if spec.colour == OUTCOME else scan_columns.values(scan, spec.colour)
    for axes, part in zip(figure.axes, scan_slices.slices(scan, spec.slices)):
        for row in np.flatnonzero(part.rows):
            told = "failed" if scan.failed[row] else OUTCOMES[scan.outcome[row]] if scan.outcome[row] >= 0 else "not evaluated"
            told += f", {scan_columns.quantity(spec.colour, scan).name} {values[row]:.4g}" if values is not None and np.isfinite(values[row]) else ""
            places = [float(scan.place(index)[row]) for index in (0, 1)]
            at = ", ".join(axis.equals_text(place) for axis, place in zip(scan.axes, places))
            yield axes, *(place * axis.factor for axis, place in zip(scan.axes, places)), f"{at}: {told}".replace("-", "−")


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
