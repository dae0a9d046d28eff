"""Fixed points of a pair over one number of it: rodwake.pair_branches, drawn by rodwake.plots.branches."""

import numpy as np

from . import canvas, schema, style, words

LINES = (True, "-", "stable"), (False, "--", "unstable")


def of_branches(branches, title=""):
    """Distance and turning rate against the number; folds are dots."""
    figure = canvas.figure(style.WIDE, 3.0)
    panels = figure.subplots(1, 2)
    over = schema.PHYSICS[branches[0].over]
    unit = words.REDUCED.get(over.get("unit", {}).get("reduced", ""), "")
    for index, (axes, name) in enumerate(zip(panels, ("separation", "omega"))):
        for branch, colour in zip(branches, np.resize(style.COLOURS, len(branches))):
            values, is_stable = getattr(branch, name), np.array([point.stable for point in branch.equilibria])
            for wanted, line, _ in LINES:
                shown = is_stable == wanted
                shown[:-1] |= is_stable[1:] == wanted  # up to the first point of the next piece
                axes.plot(branch.parameter, np.where(shown, values, np.nan), line, color=colour)
            axes.plot(branch.parameter[branch.folds], values[branch.folds], "o", color=colour, markersize=4)
        every = np.concatenate([getattr(branch, name) for branch in branches])
        if (positive := every[every > 0]).size and positive.max() > 100 * positive.min():
            axes.set_yscale("log")  # without pairs that do not turn
        axes.set_xlabel(f"${over['symbol']}{unit}$")
        canvas.letter(axes, index)
    panels[0].set_ylabel(r"distance, $f/\mu$")
    panels[1].set_ylabel(r"turning rate, $\mu v_0/f$")
    panels[0].legend(handles=[panels[0].plot([], [], line, color=style.INK, label=label)[0] for _, line, label in LINES])
    canvas.heading(panels[0], title)
    return figure
