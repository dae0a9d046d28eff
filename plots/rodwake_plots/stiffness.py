"""The curve from which the stiffness of what holds a bead is read off: 1/(s MSD~(s)), extrapolated to s = 0."""

import numpy as np

from . import canvas, curves, measured, style, words
from .errors import PlotError

FILE = "stiffness.csv"


def draw(run, spec):
    parts = measured.holders(run, FILE)
    figure, axes = curves.panel(len(parts))
    axes.axhline(0, color=style.GREY, linewidth=0.6, zorder=1)
    for index, (part, colour) in enumerate(zip(parts, curves.colours(len(parts)))):
        curves.points(axes, *read(part), colour, part.label or None, curves.mark(index))
        extrapolation(axes, part, colour)
    axes.set(xlabel=r"$s$ (1/s)", ylabel=r"$1/(s\,\tilde{\Delta}(s))$ ($a^{-2}$)")
    axes.set_xlim(left=-0.03 * axes.get_xlim()[1])  # room for the marks at s = 0
    curves.legend(axes)
    canvas.heading(axes, style.safe(spec.title))
    return figure


def read(part):
    s, value, sigma = part.table(FILE, "s", "value", "sigma")
    kept = (s > 0) & np.isfinite(value)
    if not kept.any():
        raise PlotError(f"{part.folder / FILE}: holds no value at any s > 0: nothing to draw")
    return s[kept], value[kept], measured.known(sigma[kept])


def extrapolation(axes, part, colour):
    """The value at s = 0 with its error, and a line from it to the end of the window that it was taken from."""
    found, last = part.estimate("microrheology", "stiffness"), part.number("microrheology", "s_high")
    if found is None:
        return
    curves.points(axes, [0.0], [found.value], np.array([found.error]), colour, marker="*", markersize=8, clip_on=False)
    s, value, _ = read(part)
    if last is not None and s[0] <= last <= s[-1]:
        axes.plot([0.0, last], [found.value, np.interp(last, s, value)], color=colour, linewidth=0.8, linestyle=(0, (5, 3)), zorder=2)


def caption(run, _):
    parts = measured.holders(run, FILE)
    found = [(part, part.estimate("microrheology", "stiffness")) for part in parts]
    told = "; ".join(f"{words.label_html(part.label) + ': ' if part.label else ''}{words.with_error(*one[:2])} <i>a</i><sup>−2</sup>"
                     for part, one in found if one)
    return ("Stiffness of what holds a bead, 1/(<i>s</i> Δ̃(<i>s</i>)) with the Laplace transform of the mean-square displacement; bars: "
            "standard error; star: extrapolated to <i>s</i> = 0 from the window up to the end of the broken line"
            f"{', ' + told if told else ''}.{measured.not_measured(run, FILE)}")


def defaults(_):
    """Only where a scene asks for it: the mean-square displacement tells the number in its caption."""
    return []
