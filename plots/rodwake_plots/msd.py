"""Mean-square displacement of the beads, drift removed, on logarithmic axes."""

import numpy as np

from . import canvas, curves, measured, style, words
from .errors import PlotError
from .spec import Spec

FILE = "msd.csv"


def draw(run, spec):
    parts = measured.holders(run, FILE)
    figure, axes = curves.panel(len(parts), 3.3)
    tables = [read(part) for part in parts]
    for part, (lag, value, sigma), colour in zip(parts, tables, curves.colours(len(parts))):
        curves.band(axes, lag, value, sigma, colour, part.label, lowest=value.min() / 10)
    guide(axes, tables)
    low, high = (edge(value[:2].min() if edge is min else value.max() for _, value, _ in tables) for edge in (min, max))
    axes.set(xscale="log", yscale="log", ylim=(low / 2, 2 * high), xlabel=r"$t$ (s)", ylabel=r"$\Delta(t)$ ($a^2$)")
    curves.legend(axes, **(dict(loc="upper left") if len(parts) <= curves.MOST_INSIDE else {}))
    canvas.heading(axes, style.safe(spec.title))
    return figure


def read(part):
    lag, value, sigma = part.table(FILE, "lag", "msd", "sigma")
    kept = (lag > 0) & (value > 0)
    if not kept.any():
        raise PlotError(f"{part.folder / FILE}: holds no displacement > 0 at any lag > 0: nothing to draw on a log scale")
    return lag[kept], value[kept], measured.known(sigma[kept])


def guide(axes, tables):
    """Slope 1, free diffusion, up to over the end of the highest curve."""
    lag, value, _ = max(tables, key=lambda table: table[1][-1])
    t = np.array([max(lag[0], lag[-1] / 8), lag[-1]])
    axes.plot(t, 1.5 * value[-1] / lag[-1] * t, label=r"$\propto t$", **curves.FAINT)


def caption(run, spec):
    text = ("Mean-square displacement <i>Δ</i>(<i>t</i>) of the beads in the plane, the mean of all beads taken off; band: standard error; "
            "broken line: slope 1, free diffusion.")
    told = [(part, part.estimate("microrheology", "stiffness")) for part in measured.holders(run, FILE)]
    found = "; ".join(f"{words.label_html(part.label) + ': ' if part.label else ''}{words.with_error(*one[:2])} <i>a</i><sup>−2</sup>"
                      for part, one in told if one)
    stiffness = f" Stiffness 1/(<i>s</i> Δ̃(<i>s</i>)) for <i>s</i> → 0: {found}." if found else ""
    return text + stiffness + measured.not_measured(run, FILE)


def defaults(run):
    return [Spec("msd", "msd")] if measured.some(run, FILE) else []
