"""Several measured curves in one panel: a colour each, bands of their standard errors, a legend."""

import numpy as np

from . import canvas, style

FEW = ["#0072b2", "#d55e00", "#009e73", "#cc79a7"]
MOST_INSIDE = 4  # with more curves the legend stands beside the panel
MARKS = "osD^vP"
FAINT = dict(color=style.GREY, linewidth=0.8, linestyle=(0, (5, 3)), zorder=1)


def panel(count, height=3.1):
    """Figure and axes; wider where the legend stands beside."""
    figure = canvas.figure(style.SINGLE + (1.2 if count > MOST_INSIDE else 0.3), height)
    return figure, figure.subplots()


def colours(count):
    """Few curves are told apart by hue, many by their place in a sequence."""
    if count <= len(FEW):
        return FEW[:count]
    return [style.TIME_MAP(place) for place in np.linspace(0, 1, count)]


def mark(index):
    return MARKS[index % len(MARKS)]


def band(axes, x, y, sigma, colour, label="", lowest=None):
    """A line and around it one standard error; `lowest` keeps the band on a logarithmic axis."""
    below, above = y - sigma, y + sigma
    if lowest is not None:
        y, below = np.where(y > 0, y, np.nan), np.where(y > 0, np.maximum(below, lowest), np.nan)
    axes.fill_between(x, below, above, color=colour, alpha=0.25, linewidth=0)
    return axes.plot(x, y, color=colour, label=label, linewidth=1.2)[0]


def points(axes, x, y, sigma, colour, label="", marker="o", **look):
    """Marks with error bars; those of unknown error have none."""
    look = dict(markersize=3.6, linestyle="none", elinewidth=0.8, capsize=1.6, capthick=0.8, zorder=3) | look
    return axes.errorbar(x, y, yerr=np.where(np.isfinite(sigma), sigma, 0.0), color=colour, marker=marker, label=label, **look)


def legend(axes, **look):
    """Inside where it is small and finds room, else beside the panel; none without labels."""
    handles, labels = axes.get_legend_handles_labels()
    if not labels:
        return
    place = dict(loc="best") if len(labels) <= MOST_INSIDE + 1 else dict(loc="center left", bbox_to_anchor=(1.01, 0.5))
    axes.legend(handles, [style.safe(label) for label in labels], **(place | dict(
        frameon=True, framealpha=0.8, edgecolor="none", fontsize=8.5, handlelength=1.6, borderaxespad=0.4) | look))
