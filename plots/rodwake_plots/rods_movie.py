"""Film of the rods of the theory, coloured by heading: mp4 by ffmpeg if there is one, else an animated GIF."""

import matplotlib
import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.cm import ScalarMappable
from matplotlib.colors import ListedColormap, Normalize

from . import canvas, movie, style, words
from .paths import grown, span
from .trajectories import runs_of

DPI = 130
TRAIL = 8  # stored times behind a rod
HEADINGS = Normalize(-180, 180)
HEADING_MAP = ListedColormap(0.85 * matplotlib.colormaps["twilight"](np.linspace(0, 1, 256))[:, :3], name="headings")  # seen on white


def write(run, spec):
    """Paths written: the film, and its last picture as name.png."""
    return movie.write_film(run, spec, Film(run, spec))


class Film:
    """The pictures, drawn one by one on a figure whose layout is made once."""

    def __init__(self, run, spec):
        self.rods, self.units, self.spec = runs_of(run.result)[0], run.result.units, spec
        window = window_of(self.rods, spec)
        self.length = self.units.length("x", max(map(abs, window[0] + window[1])))
        self.time = self.units.time("t", self.rods.t[-1])
        self.figure, self.axes = stage(window, self.length, self.units)
        self.figure.set_dpi(DPI)
        self.canvas = FigureCanvasAgg(self.figure)
        self.trails = matplotlib.collections.LineCollection([], colors=style.GREY, linewidths=0.5, alpha=0.5, zorder=2)
        self.axes.add_collection(self.trails, autolim=False)
        self.arrows = self.axes.quiver(*self.places(0), *self.directions(0), self.headings(0), cmap=HEADING_MAP, norm=HEADINGS, pivot="mid",
                                       angles="xy", units="dots", scale_units="dots", scale=1 / 11, width=2.6, headwidth=3.4, headlength=4,
                                       headaxislength=3.6, zorder=3)
        self.show(0)
        self.canvas.draw()
        self.figure.set_layout_engine("none")
        self.height, self.width = (size // 2 * 2 for size in np.asarray(self.canvas.buffer_rgba()).shape[:2])  # x264 wants even

    def places(self, frame):
        return self.rods.x[frame] * self.length.factor, self.rods.y[frame] * self.length.factor

    def directions(self, frame):
        return np.cos(self.rods.theta[frame]), np.sin(self.rods.theta[frame])

    def headings(self, frame):
        return (np.degrees(self.rods.theta[frame]) + 180) % 360 - 180

    def show(self, frame):
        frame %= len(self.rods.t)
        self.arrows.set_offsets(np.column_stack(self.places(frame)))
        self.arrows.set_UVC(*self.directions(frame), self.headings(frame))
        since = max(0, frame - TRAIL)
        self.trails.set_segments(np.stack(self.places(slice(since, frame + 1)), axis=-1).swapaxes(0, 1))
        title = style.safe(self.spec.title) + ", " if self.spec.title else ""
        canvas.heading(self.axes, title + self.units.equals(self.time, "t", self.rods.t[frame]))

    def __iter__(self):
        """[row][column][red, green, blue] of each stored time."""
        for frame in range(len(self.rods.t)):
            self.show(frame)
            self.canvas.draw()
            yield np.ascontiguousarray(np.asarray(self.canvas.buffer_rgba())[:self.height, :self.width, :3])

    def save_still(self, path):
        self.show(-1)
        canvas.save(self.figure, path)


def window_of(rods, spec):
    """What the scene asks for, or all places with a margin."""
    x, y = span(rods.x), span(rods.y)
    margin = 0.03 * max(np.ptp(x), np.ptp(y)) or 1.0
    return spec.x or grown(x, margin), spec.y or grown(y, margin)


def stage(window, length, units):
    """Figure and axes with everything but the rods."""
    x, y = (tuple(edge * length.factor for edge in pair) for pair in window)
    aspect = min(max(np.ptp(y) / np.ptp(x), 0.3), 1.5)
    figure = canvas.figure(6.4, 5.2 * aspect + 0.7)
    axes = figure.subplots()
    canvas.window(axes, x, y)
    axes.set(xlabel=length.label, ylabel=units.length("y", max(map(abs, window[0] + window[1]))).label)
    bar = figure.colorbar(ScalarMappable(HEADINGS, HEADING_MAP), ax=axes, pad=0.02, aspect=32, ticks=[-180, -90, 0, 90, 180])
    bar.set_label("heading (°)")
    bar.ax.tick_params(direction="in")
    return figure, axes


def caption(run, spec):
    rods, units = runs_of(run.result)[0], run.result.units
    found = movie.film_of(run, spec)
    name = f"figures/{words.escape(found[0].name)}: " if found else ""
    return (f"{name}{rods.x.shape[1]} rods as arrows, coloured by heading, with what they walked since {TRAIL} pictures before; {len(rods.t)} "
            f"pictures from <i>t</i> = {words.number(rods.t[0])} to {words.number(rods.t[-1])} {units.time_html()}, {spec.fps} a second.")


def defaults(_):
    """Only where a scene asks for it."""
    return []
