"""Outcomes have the same colours in every figure, and marks in every legend."""

import numpy as np
from matplotlib.colors import to_rgba
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from . import style
from .scan_run import CAPTURED, OUTCOMES

# Two blues are one family: capture. Any two of these and white differ by more than 30 (CIE Lab) with full and with any reduced colour
# vision; tests/plots/test_scan_colours.py has the numbers.
COLOURS = {"contact": "#14589c", "pursuit": "#69b8ec", "escape": "#f5cb76", "undecided": "#a3a19c",
           "finished": "#6f8f7a"}  # the last stands alone
NOTHING = "#e4e4e1"  # where there is no number
CAPTURE = "capture = contact or pursuit"
BOUNDARY = dict(color=style.INK, linewidth=0.6)
FAILED = dict(marker="x", color="#b3261e", linestyle="none")


def rgba(colour):
    """Four bytes."""
    return np.round(255 * np.array(to_rgba(colour))).astype(np.uint8)


def painted(codes):
    """Bytes of the colours of outcomes; transparent where there is none."""
    table = np.array([*(rgba(COLOURS[name]) for name in OUTCOMES), (0, 0, 0, 0)], dtype=np.uint8)
    return table[codes]  # -1 is the last


def without_number(codes):
    """Where a number is shown: pursuit as itself, which is capture without a time of its own, the others as nothing."""
    table = np.array([rgba(COLOURS[name] if name == "pursuit" else NOTHING) for name in (*OUTCOMES, "")], dtype=np.uint8)
    return table[codes]


def alike(x, y, codes):
    """Points in order along x with gaps where the outcome changes, as plot() takes them: no line joins what differs."""
    order = np.argsort(x, kind="stable")
    x, y, codes = (np.asarray(part)[order] for part in (x, y, codes))
    changes = np.flatnonzero(np.diff(codes)) + 1
    return np.insert(x, changes, np.nan), np.insert(y, changes, np.nan)


def handles(codes, failed, boundary):
    """Legend entries: the outcomes that occur, failed points with their number, the boundary."""
    there = [name for index, name in enumerate(OUTCOMES) if (codes == index).any()]
    found = [Patch(facecolor=COLOURS[name], edgecolor="white", linewidth=0.4, label=name) for name in there]
    if boundary:
        found.append(Line2D([], [], **BOUNDARY, label="traced boundary"))
    if failed:
        found.append(Line2D([], [], **FAILED, markersize=4.5, markeredgewidth=1.1, label=f"failed ({failed})"))
    return found


def title(codes):
    """Of the legend: what capture means, where there is some."""
    return CAPTURE if any((codes == OUTCOMES.index(name)).any() for name in CAPTURED) else ""
