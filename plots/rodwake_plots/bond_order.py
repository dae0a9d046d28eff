"""Decay of the bond-orientational order g_B(r) on logarithmic axes (paper, Fig. hop b)."""

import numpy as np

from . import canvas, curves, measured, ranges, style, words
from .errors import PlotError
from .spec import Spec

FILE = "gB.csv"
LOWEST = 1e-3  # what is smaller is noise in any run that fits a disk


def draw(run, spec):
    parts = measured.holders(run, FILE)
    figure, axes = curves.panel(len(parts), 3.3)
    tables = [read(part) for part in parts]
    lowest = bottom(tables)
    for part, (r, g, sigma), colour in zip(parts, tables, curves.colours(len(parts))):
        curves.band(axes, r, g, sigma, colour, label(part), lowest=lowest / 10)
    guide(axes, tables)
    axes.set(xscale="log", yscale="log", ylim=(lowest, 1.3), xlabel=r"$r/a$", ylabel=r"$g_B(r)$")
    window = tuple(edge / run.granular.a for edge in spec.x)
    axes.set_xlim(window or (min(r[0] for r, _, _ in tables), max(r[-1] for r, _, _ in tables)))
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_major_locator(ranges.LogLocator(subs=(1, 2, 5)))
        axis.set_major_formatter("{x:g}")
        axis.set_minor_formatter("")
    curves.legend(axes, **(dict(loc="lower left") if len(parts) <= curves.MOST_INSIDE else {}))
    canvas.heading(axes, style.safe(spec.title))
    return figure


def read(part):
    r, g, sigma = part.table(FILE, "r", "gB", "sigma")
    kept = (r > 0) & np.isfinite(g)
    if not (g[kept] > 0).any():
        raise PlotError(f"{part.folder / FILE}: holds no g_B > 0 at any r > 0: nothing to draw on a log scale")
    return r[kept], g[kept], measured.known(sigma[kept])


def bottom(tables):
    """Under the smallest value that stands out from its error."""
    clear = np.concatenate([g[(g > 0) & ~(g < 2 * sigma)] for _, g, sigma in tables])
    least = clear.min() if clear.size else LOWEST
    return max(LOWEST, min(ranges.nice(0.7 * least, up=False), 0.5))


def guide(axes, tables):
    """At the edge of the hexatic phase g_B falls as r^(-1/4); drawn over the curves."""
    left, right = min(r[0] for r, _, _ in tables), max(r[-1] for r, _, _ in tables)
    top = max(np.interp(left, r, g) for r, g, _ in tables)
    r = np.array([left, right])
    axes.plot(r, top * (r / left) ** -0.25, label=r"$r^{-1/4}$", **curves.FAINT)


def label(part):
    """The part's label and how its order decays."""
    kind = part.told("order", "class") or "not classified"
    exponent = part.estimate("order", "exponent")
    if kind == "algebraic" and exponent is not None:
        kind += rf", $\eta_6 = {exponent.value:.2g}$"
    return f"{part.label}: {kind}" if part.label else kind


def caption(run, spec):
    parts = measured.holders(run, FILE)
    told = " ".join(reason(part) for part in parts)
    return ("Correlation <i>g<sub>B</sub></i>(<i>r</i>) of the beads' bond orders <i>ψ</i><sub>6</sub> at distance <i>r</i>, over all "
            "pairs; band: standard error. Broken line: <i>r</i><sup>−1/4</sup>, the steepest power law of a hexatic phase. "
            f"{told}{measured.not_measured(run, FILE)}".rstrip())


def reason(part):
    phase, why = part.told("order", "phase"), part.told("order", "reason")
    if not phase:
        return ""
    who = f"{words.label_html(part.label)}: {words.escape(phase)}" if part.label else words.escape(str(phase).capitalize())
    return f"{who} ({words.escape(str(why).rstrip('.'))})." if why else f"{who}."


def defaults(run):
    return [Spec("bond_order", "bond_order")] if measured.some(run, FILE) else []
