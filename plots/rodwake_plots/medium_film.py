"""Frames of a dynamic medium, medium_film.h5, and how one is drawn: |u| by colour, rods as needles with what they walked."""

from dataclasses import dataclass

import matplotlib
import numpy as np
from matplotlib import patheffects
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.colors import Normalize

from . import canvas, files, movie, style, words
from .errors import PlotError
from .frames import with_images, wrapped_path
from .schema import Kind

FILE = "medium_film.h5"
COLOURS = matplotlib.colormaps["magma"]
ROD_COLOURS = ["#5fd3f3", "#b4e34d", "#ffffff", "#ffb3de"]  # seen on all of it
NEEDLE = 0.042        # length over the longer side of the window
FEW = 12              # rods of colours of their own, with trails from the start
TRAIL = 4.0           # time units behind each of many
TOP = 99.8            # percentile of all values that the colours reach to


@dataclass(frozen=True)
class Frame:
    t: float
    size: np.ndarray  # |u| [y][x]


class MediumFilm:
    """The frames in a file, which is open for as long as the `with` block lasts. Lengths and times as stored."""

    def __init__(self, run):
        self.path = run.path / FILE
        self.file = files.open_hdf5(self.path)
        self.t, self.x, self.rod_x, self.rod_y, self.theta = (
            np.asarray(files.dataset(self.file, place)[()]) for place in ("t", "x", "rods/x", "rods/y", "rods/theta"))
        self.ux, self.uy = (files.dataset(self.file, name) for name in ("ux", "uy"))
        if not len(self.t) or self.ux.shape != (len(self.t), len(self.x), len(self.x)):
            raise PlotError(f"{self.path}: /ux has shape {self.ux.shape}: no frames of {len(self.t)} times on {len(self.x)} x {len(self.x)} points")
        self.box = (self.x[1] - self.x[0]) * len(self.x)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.file.close()

    def __len__(self):
        return len(self.t)

    def frame(self, number):
        return Frame(self.t[number], np.hypot(self.ux[number], self.uy[number]))

    def top(self):
        """Where the colours end: single points next to a rod do not set it."""
        looked_at = np.unique(np.linspace(0, len(self) - 1, min(len(self), 12)).astype(int))
        return np.percentile([self.frame(number).size for number in looked_at], TOP) or 1.0

    def window(self, spec):
        """The figure's, or the box."""
        whole = (self.x[0], self.x[0] + self.box)
        return spec.x or whole, spec.y or whole


def periodic_part(film, size, window):
    """(values, extent for imshow) of the points that cover the window, each a cell with its place in the middle."""
    step = film.box / len(film.x)
    first, last = (np.array([edge(pair[k] - film.x[0]) for pair in window]) for k, edge in
                   ((0, lambda way: int(np.floor(way / step)) - 1), (1, lambda way: int(np.ceil(way / step)) + 1)))
    columns, rows = (np.arange(first[axis], last[axis] + 1) for axis in (0, 1))
    part = size[np.ix_(rows % len(film.x), columns % len(film.x))]
    edges = [film.x[0] + step * at for at in (columns[0] - 0.5, columns[-1] + 0.5, rows[0] - 0.5, rows[-1] + 0.5)]
    return part, edges


class Panel:
    """One panel, which can be shown frame after frame."""

    def __init__(self, axes, film, window, length, top):
        self.axes, self.film, self.window, self.length = axes, film, window, length
        self.many = film.rod_x.shape[1] > FEW
        self.colours = np.array(["white"] if self.many else ROD_COLOURS)[np.arange(film.rod_x.shape[1]) % (1 if self.many else len(ROD_COLOURS))]
        part, extent = periodic_part(film, film.frame(0).size, window)
        self.image = axes.imshow(part, origin="lower", extent=np.multiply(extent, length.factor), cmap=COLOURS, norm=Normalize(0, top * length.factor),
                                 interpolation="bicubic", zorder=0)
        self.trails = axes.add_collection(LineCollection([], zorder=2, capstyle="butt"), autolim=False)
        self.needles = axes.add_collection(PolyCollection([], zorder=3, edgecolors="black", linewidths=0.3 if self.many else 0.7,
                                                          facecolors="white", joinstyle="round"), autolim=False)
        canvas.window(axes, *(tuple(edge * length.factor for edge in pair) for pair in window))
        axes.tick_params(direction="out", top=False, right=False)

    def show(self, number):
        film = self.film
        part, _ = periodic_part(film, film.frame(number).size, self.window)
        self.image.set_data(part * self.length.factor)
        self.show_trails(number)
        self.show_needles(number)

    def show_trails(self, number):
        film, segments, colours = self.film, [], []
        since = np.searchsorted(film.t, film.t[number] - TRAIL) if self.many else 0
        for rod in range(film.rod_x.shape[1]):
            path = np.stack([part[since:number + 1, rod] for part in (film.rod_x, film.rod_y)], axis=-1)
            for piece in self.pieces(path):
                alpha = np.linspace(0.05, 0.55 if self.many else 0.9, len(piece)) if len(piece) else []
                segments += [piece]
                colours += [matplotlib.colors.to_rgba(self.colours[rod], a) for a in alpha]
        self.trails.set(segments=np.concatenate(segments) * self.length.factor if segments else [], colors=colours,
                        linewidths=0.6 if self.many else 1.6)

    def pieces(self, path):
        """Steps [n][2][2] of a path in the box, and their images in the window."""
        if len(path) < 2:
            return
        inside = wrapped_path(*(path - self.film.x[0]).T, self.film.box) + self.film.x[0]
        steps = np.stack([inside[:-1], inside[1:]], axis=1)
        steps = steps[np.isfinite(steps).all(axis=(1, 2))]
        for shift in self.shifts():
            yield steps + shift

    def shifts(self):
        """Boxes of the window away from that of the grid."""
        turns = [np.arange(np.floor((low - self.film.x[0]) / self.film.box), np.ceil((high - self.film.x[0]) / self.film.box))
                 for low, high in self.window]
        return [self.film.box * np.array([x, y]) for x in turns[0] for y in turns[1]]

    def show_needles(self, number):
        film = self.film
        length = NEEDLE * max(np.ptp(pair) for pair in self.window) * (0.6 if self.many else 1.0)
        places = np.stack([film.rod_x[number], film.rod_y[number]], axis=-1) - film.x[0]
        low_high = tuple(tuple(edge - film.x[0] for edge in pair) for pair in self.window)
        centres, index = with_images(places, np.full(len(places), length), (film.box, film.box), low_high)
        cosine, sine = np.cos(film.theta[number][index]), np.sin(film.theta[number][index])
        outline = length * canvas.ROD_OUTLINE
        turned = np.stack([outline[:, 0] * cosine[:, None] - outline[:, 1] * sine[:, None],
                           outline[:, 0] * sine[:, None] + outline[:, 1] * cosine[:, None]], axis=-1)
        self.needles.set_verts((turned + centres[:, None] + film.x[0]) * self.length.factor)
        self.needles.set_facecolor(self.colours[index])


def clock(axes, text):
    """The time in a corner of the picture."""
    return axes.text(0.03, 0.965, text, transform=axes.transAxes, ha="left", va="top", color="white", zorder=5,
                     path_effects=[patheffects.withStroke(linewidth=2.0, foreground="#00000088")])


def describe_rods(film):
    rods = film.rod_x.shape[1]
    trail = f"what they walked in the {TRAIL:g} time units before" if rods > FEW else "their paths"
    return f"{rods} rods as needles, thin end forward, with {trail}" if rods > 1 else "a rod as a needle, thin end forward, with its path"


# Film of a dynamic medium: its displacement |u| by colour, the rods as needles; mp4 by ffmpeg if there is one, else an animated GIF.

DPI = 120


def write_medium_film(run, spec):
    """Paths written: the film, and its last picture as name.png."""
    with MediumFilm(run) as film:
        return movie.write_film(run, spec, Pictures(run, spec, film))


class Pictures(movie.Film):
    def __init__(self, run, spec, film):
        self.film, self.units = film, run.units
        window = film.window(spec)
        length = self.units.length("x", max(map(abs, window[0] + window[1])))
        top = film.top()
        self.time = self.units.time("t", film.t[-1])
        aspect = np.ptp(window[1]) / np.ptp(window[0])
        figure = canvas.figure(5.6, min(4.6 * aspect, 7.0) + 0.6)
        self.axes = figure.subplots()
        self.panel = Panel(self.axes, film, window, length, top)
        label_axes(self.axes, self.units, window)
        colour_bar(figure, [self.axes], self.panel, self.units, top)
        canvas.heading(self.axes, style.safe(spec.title))
        self.clock = clock(self.axes, "")
        self.lay_out(figure, len(film), DPI)

    def show(self, number):
        number %= len(self.film)
        self.panel.show(number)
        self.clock.set_text(self.units.equals(self.time, "t", self.film.t[number]))


def label_axes(axes, units, window):
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


def caption_medium_film(run, spec):
    with MediumFilm(run) as film:
        found = movie.film_of(run, spec)
        name = f"figures/{words.escape(found[0].name)}: d" if found else "D"
        return (f"{name}isplacement |<b>u</b>| of the medium, of the fields of all rods together, by colour (the top {100 - TOP:.1f} % of the values are "
                f"beyond the scale); {describe_rods(film)}. {len(film)} pictures from <i>t</i> = {words.number(film.t[0])} to "
                f"{words.number(film.t[-1])} {run.units.time_html()}, {spec.fps} a second. The box of side {words.number(film.box)} "
                f"{run.units.length_html()} is periodic.")


# The displacement |u| of a dynamic medium and its rods at four times, from the first frame of the film to the last.

INSTANTS = 4


def draw_medium_instants(run, spec):
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
            label_axes(axes, units, window)
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


def caption_medium_instants(run, spec):
    with MediumFilm(run) as film:
        times = ", ".join(words.number(film.t[number]) for number in instants(film))
        return (f"Displacement |<b>u</b>| of the medium at <i>t</i> = {times} {run.units.time_html()}, of the fields of all rods together, on one "
                f"colour scale; {describe_rods(film)}.")


KINDS = {
    "medium_film": Kind(write=write_medium_film, caption=caption_medium_film),
    "medium_instants": Kind(draw=draw_medium_instants, caption=caption_medium_instants, there=lambda run: (run.path / FILE).is_file()),
}
