"""One panel of a phase diagram: cells, or points where a scan has no cells; boundaries, failed points."""

from typing import NamedTuple

import numpy as np
from matplotlib.collections import LineCollection

from . import scan_axis, scan_outcomes, scan_raster

CASING = dict(color="white", linewidth=1.8, alpha=0.7)  # between numbers a line alone would vanish
OUTLINE = dict(color="#000000", linewidth=0.25, alpha=0.45)


class Look(NamedTuple):
    """What colours a panel: outcomes, or numbers."""
    places: np.ndarray = None  # of each point on the colour map, 0 to 1; nan: no number; None: outcomes
    map: object = None

    def rgba(self, codes, places):
        """Bytes; transparent where there is no point, or a failed one."""
        if self.places is None:
            return scan_outcomes.painted(codes)
        made = self.map(np.ma.masked_invalid(places), bytes=True)
        lacking = ~np.isfinite(places)
        made[lacking] = scan_outcomes.without_number(codes[lacking])
        made[codes < 0] = 0
        return made


class Drawing(NamedTuple):
    """A scan, and what of it is wanted; x and y are the window in numbers of the file."""
    scan: object
    look: Look
    x: tuple
    y: tuple
    boundary: bool
    outlines: bool
    leaves: object  # scan_raster.Leaves, or None

    @property
    def numbers(self):
        return np.full(len(self.scan.failed), np.nan) if self.look.places is None else self.look.places


def draw(axes, drawing, part):
    paint = leaves if drawing.leaves else grid if is_grid(drawing.scan) else points
    for axis, one, window in zip((axes.xaxis, axes.yaxis), drawing.scan.axes, (drawing.x, drawing.y)):
        one.dress(axis, *window)
    axes.tick_params(which="both", direction="out", top=False, right=False)
    paint(axes, drawing, part)
    if drawing.outlines and drawing.leaves:
        outlines(axes, drawing, part)
    if drawing.boundary:
        boundary(axes, drawing)
    failed(axes, drawing, part)


def is_grid(scan):
    """Whether the points of a panel have cells around them: a scan of choices alone has too."""
    return scan.design == "grid"


def leaves(axes, drawing, part):
    """A picture in even coordinates under the axes, which may be logarithmic."""
    scan = drawing.scan
    window = [axis.even(ends) for axis, ends in zip(scan.axes, (drawing.x, drawing.y))]
    picture = scan_raster.of_leaves(drawing.leaves, scan.outcome, drawing.numbers, window, part.at)
    under = axes.inset_axes([0, 0, 1, 1], zorder=0.5)
    under.set_axis_off()
    under.imshow(drawing.look.rgba(picture.codes, picture.values), extent=picture.extent, origin="lower", aspect="auto",
                 interpolation="antialiased")
    under.set(xlim=window[0], ylim=window[1])


def grid(axes, drawing, part):
    scan, rows = drawing.scan, part.rows
    made = scan_raster.of_grid(scan.places[rows, :2], scan.outcome[rows], drawing.numbers[rows])
    x, y = (axis.back(edges) * axis.factor for axis, edges in zip(scan.axes, (made.x, made.y)))
    mesh = axes.pcolormesh(x, y, np.zeros(made.codes.shape), rasterized=True, zorder=0.5, shading="flat")
    mesh.set_array(None)
    mesh.set_facecolor(drawing.look.rgba(made.codes, made.values).reshape(-1, 4) / 255)
    for axis, line, edges in zip(scan.axes, (axes.axvline, axes.axhline), (x, y)):
        for edge in edges[1:-1] if axis.is_choice else ():
            line(edge, color="white", linewidth=2)


def points(axes, drawing, part):
    scan = drawing.scan
    rows = np.flatnonzero(part.rows & ~scan.failed)
    rows = rows[np.random.default_rng(0).permutation(len(rows))]  # so that none of the outcomes lies on top
    x, y = (scan.place(index)[rows] * scan.axes[index].factor for index in (0, 1))
    axes.scatter(x, y, s=size(len(rows)), c=drawing.look.rgba(scan.outcome[rows], drawing.numbers[rows]) / 255, linewidths=0.25,
                 edgecolors=(0, 0, 0, 0.35) if len(rows) < 4000 else "none", zorder=1, rasterized=len(rows) > 2000)


def size(count):
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


def boundary(axes, drawing):
    factors = [axis.factor for axis in drawing.scan.axes[:2]]
    lines = [curve.places[:, :2] * factors for curve in drawing.scan.boundary]
    for look, order in ((CASING, 2), (scan_outcomes.BOUNDARY, 2.1))[drawing.look.places is None:]:
        axes.add_collection(LineCollection(lines, capstyle="round", joinstyle="round", **look, zorder=order), autolim=False)


def failed(axes, drawing, part):
    scan = drawing.scan
    rows = np.flatnonzero(part.rows & scan.failed)
    if rows.size:
        x, y = (scan.place(index)[rows] * scan.axes[index].factor for index in (0, 1))
        axes.plot(x, y, **scan_outcomes.FAILED, markersize=np.clip(60 / np.sqrt(rows.size), 2, 5), markeredgewidth=0.9, zorder=3)


def windows(scan, spec):
    """Limits of the two axes in numbers of the file; cells of a grid reach half a cell beyond its ends."""
    found = []
    for index, (axis, asked) in enumerate(zip(scan.axes, (spec.x, spec.y))):
        room = 0.0
        if scan.design == "grid":
            edges = scan_raster.edges(scan_raster.steps(scan.places[:, index])[0])
            room = max(axis.even(axis.low) - edges[0], edges[-1] - axis.even(axis.high)) / axis.span
        elif scan.design != "adaptive":
            room = 0.02
        found.append(scan_axis.shown_window(axis, asked, "xy"[index]) if asked else scan_axis.margin(axis, max(room, 0.0)))
    return found
