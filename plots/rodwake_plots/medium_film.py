"""Film of a dynamic medium: its displacement |u| by colour, the rods as needles; mp4 by ffmpeg if there is one, else an animated GIF."""

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg

from . import canvas, movie, style, words
from .medium_frames import TOP, MediumFilm, Panel, clock, rods_told

DPI = 120


def write(run, spec):
    """Paths written: the film, and its last picture as name.png."""
    with MediumFilm(run) as film:
        return movie.write_film(run, spec, Film(run, spec, film))


class Film:
    """The pictures, drawn one by one on a figure whose layout is made once."""

    def __init__(self, run, spec, film):
        self.film, self.units = film, run.units
        window = film.window(spec)
        length = self.units.length("x", max(map(abs, window[0] + window[1])))
        top = film.top()
        self.time = self.units.time("t", film.t[-1])
        aspect = np.ptp(window[1]) / np.ptp(window[0])
        self.figure = canvas.figure(5.6, min(4.6 * aspect, 7.0) + 0.6)
        self.figure.set_dpi(DPI)
        self.axes = self.figure.subplots()
        self.panel = Panel(self.axes, film, window, length, top)
        label(self.axes, self.units, window)
        colour_bar(self.figure, [self.axes], self.panel, self.units, top)
        canvas.heading(self.axes, style.safe(spec.title))
        self.clock = clock(self.axes, "")
        self.canvas = FigureCanvasAgg(self.figure)
        self.show(0)
        self.canvas.draw()
        self.figure.set_layout_engine("none")
        self.height, self.width = (size // 2 * 2 for size in np.asarray(self.canvas.buffer_rgba()).shape[:2])  # x264 wants even

    def show(self, number):
        number %= len(self.film)
        self.panel.show(number)
        self.clock.set_text(self.units.equals(self.time, "t", self.film.t[number]))

    def __iter__(self):
        """[row][column][red, green, blue] of each frame."""
        for number in range(len(self.film)):
            self.show(number)
            self.canvas.draw()
            yield np.ascontiguousarray(np.asarray(self.canvas.buffer_rgba())[:self.height, :self.width, :3])

    def save_still(self, path):
        self.show(-1)
        canvas.save(self.figure, path)


def label(axes, units, window):
    extent = max(map(abs, window[0] + window[1]))
    axes.set(xlabel=units.length("x", extent).label, ylabel=units.length("y", extent).label)


def colour_bar(figure, panels, panel, units, top):
    """|u| has a length unit of its own size: in SI it is much smaller than the box."""
    size = units.length(r"|\mathbf{u}|", top)
    scale = size.factor / panel.length.factor
    bar = figure.colorbar(panel.image, ax=panels, pad=0.02, aspect=32, extend="max", extendfrac=0.03,
                          format=lambda value, _: f"{value * scale:.3g}")
    bar.set_label(size.label)
    bar.ax.tick_params(direction="in", color="white")


def caption(run, spec):
    with MediumFilm(run) as film:
        found = movie.film_of(run, spec)
        name = f"figures/{words.escape(found[0].name)}: d" if found else "D"
        return (f"{name}isplacement |<b>u</b>| of the medium, of the fields of all rods together, by colour (the top {100 - TOP:.1f} % of the values are "
                f"beyond the scale); {rods_told(film)}. {len(film)} pictures from <i>t</i> = {words.number(film.t[0])} to "
                f"{words.number(film.t[-1])} {run.units.time_html()}, {spec.fps} a second. The box of side {words.number(film.box)} "
                f"{run.units.length_html()} is periodic.")


def defaults(_):
    """Only where a scene asks for it, or plot --film."""
    return []
