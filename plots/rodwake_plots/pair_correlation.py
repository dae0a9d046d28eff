"""The beads' pair correlation g(r); its first minimum is where neighbours end."""

import numpy as np

from . import canvas, curves, measured, style, words
from .errors import PlotError
from .spec import Spec

FILE = "gr.csv"
SHOWN = 20.0  # a


def draw(run, spec):
    parts = measured.holders(run, FILE)
    figure, axes = curves.panel(len(parts))
    axes.axhline(1, color=style.GREY, linewidth=0.6)
    window = window_of(run, spec)
    tops = [draw_one(axes, part, colour, window) for part, colour in zip(parts, curves.colours(len(parts)))]
    for part, colour in zip(parts, curves.colours(len(parts))) if len(parts) <= curves.MOST_INSIDE else ():
        mark_minimum(axes, part, colour)
    axes.set(xlim=window or (0, min(SHOWN, axes.dataLim.x1)), ylim=(0, 1.08 * max(tops)), xlabel=r"$r/a$", ylabel=r"$g(r)$")
    curves.legend(axes, loc="upper right" if len(parts) <= curves.MOST_INSIDE else "center left")
    canvas.heading(axes, style.safe(spec.title))
    return figure


def window_of(run, spec):
    return tuple(edge / run.granular.a for edge in spec.x)


def draw_one(axes, part, colour, window):
    """Returns the highest value shown."""
    r, g, sigma = part.table(FILE, "r", "g", "sigma")
    shown = (r >= window[0]) & (r <= window[1]) if window else r <= SHOWN
    if not np.isfinite(g[shown]).any():
        raise PlotError(f"{part.folder / FILE}: holds no r inside the window: nothing to draw")
    curves.band(axes, r, g, measured.known(sigma), colour, part.label)
    return np.nanmax(g[shown])


def mark_minimum(axes, part, colour):
    r, g = part.table(FILE, "r", "g")
    minimum = part.number("order", "g_minimum")
    if minimum is not None:
        axes.annotate("", (minimum, np.interp(minimum, r, g)), (0, 20), textcoords="offset points", annotation_clip=True, zorder=4,
                      arrowprops=dict(arrowstyle="-|>", color=colour, linewidth=1.1, shrinkA=0, shrinkB=1))


def caption(run, spec):
    parts = measured.holders(run, FILE)
    text = ("Pair correlation <i>g</i>(<i>r</i>) of the beads: pairs at distance <i>r</i> over those of an ideal gas of the same density "
            "in the box; band: standard error. First minimum")
    told = [(part, part.number("order", "g_minimum")) for part in parts]
    where = ", ".join(f"{words.number(value, 3)} <i>a</i>{of(part)}" for part, value in told if value is not None)
    arrow = " (arrow)" if len(parts) <= curves.MOST_INSIDE else ""
    return f"{text}{arrow}: {where or 'not found'}.{measured.not_measured(run, FILE)}"


def of(part):
    return f" ({words.label_html(part.label)})" if part.label else ""


def defaults(run):
    return [Spec("pair_correlation", "pair_correlation")] if measured.some(run, FILE) else []
