"""A granular bed on paper: beads and rods at true size. Axes are in bead radii."""

import math

import numpy as np
from matplotlib import patheffects
from matplotlib.collections import EllipseCollection
from matplotlib.patches import FancyArrowPatch

from . import style
from .periodic import with_images

RIM = "#2b2b2b"
ROD_COLOURS = ["#d55e00", "#cc79a7", "#e69f00", "#56b4e9"]  # of style's, those that stand out from beads coloured by order
ARROW = 4.0  # length of a heading arrow, bead radii
MOST_NUMBERS = 12


def discs(axes, centres, radii, **look):
    """Circles in data units, which zooming and saving at any size leave true; centres [n][2]."""
    look = {"linewidths": 0, "zorder": 2} | look
    made = EllipseCollection(2 * radii, 2 * radii, np.zeros(len(radii)), units="xy", offsets=centres,
                             offset_transform=axes.transData, **look)
    axes.add_collection(made, autolim=False)
    return made


def row_of_discs(axes, centres, radii, colour, zorder):
    """The outline of a row of overlapping discs: all rims first, then all insides over them."""
    rims = discs(axes, centres, radii, facecolors=RIM, edgecolors=RIM, linewidths=1.3, zorder=zorder)
    return [rims, discs(axes, centres, radii, facecolors=colour, zorder=zorder)]


def rod_colour(rod):
    return ROD_COLOURS[rod % len(ROD_COLOURS)]


def rods_from_above(axes, frame, a, window):
    """The spheres of each rod, an arrow before its thin end, and its number where there are several."""
    made, box = [], frame.box / a
    for number, rod in enumerate(frame.rods):
        centres, index = with_images(rod.spheres[:, :2] / a, rod.radii / a, box, window)
        made += row_of_discs(axes, centres, rod.radii[index] / a, rod_colour(number), 3)
        if rod.tapers:
            tips, _ = with_images(rod.tip[None, :2] / a, np.array([ARROW]), box, window)
            made += [arrow(axes, tip, rod.axis[:2]) for tip in tips]
        if 1 < len(frame.rods) <= MOST_NUMBERS:
            middles, _ = with_images(rod.spheres[:, :2].mean(axis=0, keepdims=True) / a, np.zeros(1), box, window)
            made += [rod_number(axes, number, middle) for middle in middles]
    return made


def arrow(axes, tip, axis):
    """Cut off at the frame, as the rod is."""
    shadow = axis / (math.hypot(*axis) or 1.0)
    return axes.add_patch(FancyArrowPatch(
        tip + 0.15 * ARROW * shadow, tip + ARROW * shadow, arrowstyle="-|>,head_length=0.35,head_width=0.2", mutation_scale=10,
        shrinkA=0, shrinkB=0, linewidth=1.4, color="black", zorder=4,
        path_effects=[patheffects.withStroke(linewidth=3.2, foreground="white")]))


def rod_number(axes, number, place):
    return axes.text(*place, str(number), ha="center", va="center_baseline", fontsize=8, weight="bold", color="white", zorder=5,
                     path_effects=[patheffects.withStroke(linewidth=1.2, foreground=RIM)], clip_on=True)


def box_edges(axes, box, window):
    """Broken lines where the box ends, if the window shows more than the box."""
    for line, side, (low, high) in zip((axes.axvline, axes.axhline), box, window):
        for edge in (0, side):
            if low < edge < high:
                line(edge, color=RIM, linewidth=0.8, linestyle=(0, (5, 4)), zorder=6)


def window_of(run, spec):
    """The figure's window (in the resolved scene: m) in bead radii, ((x0, x1), (y0, y1)); the whole box where the scene says nothing."""
    granular = run.granular
    return tuple(tuple(edge / granular.a for edge in asked) if asked else (0.0, side / granular.a)
                 for asked, side in zip((spec.x, spec.y), granular.box))


def density(granular):
    """Area fraction for the head of a figure; a rod alone is between plates, not in a bed."""
    return rf"$\phi_b = {granular.phi_b:.3f}$" if granular.need("beads") else "no beads"


def clock(t, last):
    """A time with as many digits as the run's length deserves."""
    return f"{t:.{max(0, 2 - math.floor(math.log10(last)))}f}" if 0 < last < 1 else f"{t:.2f}"


def heading_text(run, spec, time, last):
    if spec.title:
        return style.safe(spec.title)
    return rf"{density(run.granular)},  $t = {clock(time, last)}$ s"
