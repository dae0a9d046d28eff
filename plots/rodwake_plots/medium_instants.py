"""The displacement |u| of a dynamic medium and its rods at four times, from the first frame of the film to the last."""

import numpy as np

from . import canvas, style, words
from .medium_film import colour_bar, label
from .medium_frames import FILE, MediumFilm, Panel, clock, rods_told
from .spec import Spec

INSTANTS = 4


def draw(run, spec):
    with MediumFilm(run) as film:
        units, window, chosen = run.units, film.window(spec), instants(film)
        extent = max(map(abs, window[0] + window[1]))
        length, time, top = units.length("x", extent), units.time("t", film.t[-1]), film.top()
        columns = 2 if len(chosen) > 1 else 1
        rows = -(-len(chosen) // columns)
        side = 3.0 if columns > 1 else 4.2
        figure = canvas.figure(columns * side + 1.0, rows * side * np.ptp(window[1]) / np.ptp(window[0]) + 0.4)
        grid = figure.subplots(rows, columns, squeeze=False, sharex=True, sharey=True)
        panels = list(grid.ravel())
        for axes, number in zip(panels, chosen):
            panel = Panel(axes, film, window, length, top)
            panel.show(number)
            clock(axes, units.equals(time, "t", film.t[number]))
            label(axes, units, window)
            axes.label_outer()
        for spare in panels[len(chosen):]:
            spare.set_axis_off()
        colour_bar(figure, panels, panel, units, top)
        if spec.title:
            figure.suptitle(style.safe(spec.title), fontsize=10.5)
        return figure


def instants(film):
    """Numbers of frames, equally spaced in time."""
    return np.unique(np.linspace(0, len(film) - 1, INSTANTS).round().astype(int))


def caption(run, spec):
    with MediumFilm(run) as film:
        times = ", ".join(words.number(film.t[number]) for number in instants(film))
        return (f"Displacement |<b>u</b>| of the medium at <i>t</i> = {times} {run.units.time_html()}, of the fields of all rods together, on one "
                f"colour scale; {rods_told(film)}.")


def defaults(run):
    return [Spec("medium_instants", "medium_instants")] if (run.path / FILE).is_file() else []
