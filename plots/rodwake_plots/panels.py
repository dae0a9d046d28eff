"""Panels of equal scale, one for each part of a scene with variants."""

import math
import string

from . import canvas, style

MOST_COLUMNS = 3


def grid(parts, aspect, bar=0.0, share=True):
    """(figure, list of axes) for windows of this height over width, with room for a colour bar."""
    count = len(parts)
    columns = min(count, 2 if count == 4 else MOST_COLUMNS)
    rows = math.ceil(count / columns)
    width = {1: style.SINGLE + 0.4, 2: style.WIDE}.get(columns, style.WIDE + 1.0)
    inner = (width - 0.6 - bar) / columns - 0.1
    height = rows * (min(inner * aspect, 7.0) + (0.3 if count > 1 else 0.1)) + 0.6
    figure = canvas.figure(width, height)
    axes = figure.subplots(rows, columns, squeeze=False, sharex=share, sharey=share).ravel()
    for spare in axes[count:]:
        spare.set_axis_off()
    return figure, list(axes[:count])


def label(axes_list, parts, xlabel, ylabel, title=""):
    """Names over the panels, axis labels at the left and below."""
    columns = axes_list[0].get_subplotspec().get_gridspec().ncols
    for index, (axes, part) in enumerate(zip(axes_list, parts)):
        lowest, leftmost = index + columns >= len(parts), index % columns == 0
        axes.set_xlabel(xlabel if lowest else "")
        axes.set_ylabel(ylabel if leftmost else "")
        axes.tick_params(labelbottom=lowest, labelleft=leftmost)
        if len(parts) > 1:
            canvas.heading(axes, f"({string.ascii_lowercase[index % 26]})  {style.safe(part.label)}")
    if len(parts) == 1:
        canvas.heading(axes_list[0], style.safe(title))
    elif title:
        axes_list[0].figure.suptitle(style.safe(title), fontsize=11)


def told(parts, of):
    """`of(part)` of each panel as one line for a caption."""
    if len(parts) == 1:
        return of(parts[0])
    return " ".join(f"({string.ascii_lowercase[index % 26]}) {of(part)}" for index, part in enumerate(parts))
