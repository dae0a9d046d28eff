"""The bed from above as a film: mp4 by ffmpeg if there is one, else an animated GIF by Pillow."""

import contextlib
import io
import os
import shutil
import subprocess
import tempfile

import matplotlib
import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.cm import ScalarMappable
from matplotlib.colors import ListedColormap, Normalize

from . import bed, bodies, canvas, errors, files, style, words
from .bed_run import TRAJECTORY
from .errors import PlotError
from .trajectories import grown, runs_of, span
from .schema import Kind

DPI = 160
QUALITY = "20"  # constant rate factor of x264: no visible loss
ENDINGS = {".mp4": "video/mp4", ".gif": "image/gif"}


def write_movie(run, spec):
    """Paths written: the film, and its last picture as name.png."""
    with run.granular.trajectory(TRAJECTORY) as trajectory:
        return write_film(run, spec, BedFilm(run, spec, trajectory))


def write_film(run, spec, film):
    """The same of any film: pictures to iterate over, their width and height, and save_still(path)."""
    ending, encode = (".mp4", by_ffmpeg) if shutil.which("ffmpeg") else (".gif", by_pillow)
    still = run.figures_dir / f"{spec.name}.png"
    with files.replacing(still.with_suffix(ending)) as temporary:
        encode(temporary, film, spec.fps)
    for old in set(ENDINGS) - {ending}:
        still.with_suffix(old).unlink(missing_ok=True)
    film.save_still(still)
    return [still.with_suffix(ending), still]


class Film:
    """Pictures, drawn one by one by show(number) on a figure whose layout is made once."""

    def lay_out(self, figure, count, dpi):
        self.figure, self.count = figure, count
        figure.set_dpi(dpi)
        self.canvas = FigureCanvasAgg(figure)
        self.show(0)
        self.canvas.draw()
        figure.set_layout_engine("none")
        self.height, self.width = (size // 2 * 2 for size in np.asarray(self.canvas.buffer_rgba()).shape[:2])  # x264 wants even

    def __iter__(self):
        """[row][column][red, green, blue] of each."""
        for number in range(self.count):
            self.show(number)
            self.canvas.draw()
            yield np.ascontiguousarray(np.asarray(self.canvas.buffer_rgba())[:self.height, :self.width, :3])

    def save_still(self, path):
        self.show(-1)
        canvas.save(self.figure, path)


class BedFilm(Film):
    def __init__(self, run, spec, trajectory):
        self.run, self.spec, self.trajectory = run, spec, trajectory
        self.cutoff = trajectory.parameter("order_cutoff")
        figure, self.axes = bed.snapshot_stage(run, spec)
        self.artists = []
        self.lay_out(figure, trajectory.frames, DPI)

    def show(self, number):
        frame = self.trajectory.frame(number)
        for artist in self.artists:
            artist.remove()
        self.artists = bed.paint_snapshot(self.axes, self.run, self.spec, frame, self.cutoff)
        canvas.heading(self.axes, bed.heading_text(self.run, self.spec, frame.time, self.trajectory.time[-1]))


def by_ffmpeg(path, film, fps):
    command = ["ffmpeg", "-loglevel", "error", "-nostdin", "-y", "-f", "rawvideo", "-pix_fmt", "rgb24",
               "-s", f"{film.width}x{film.height}", "-r", str(fps), "-i", "-", "-c:v", "libx264", "-crf", QUALITY,
               "-pix_fmt", "yuv420p", "-movflags", "+faststart", "-f", "mp4", str(path.absolute())]  # "-x/film.mp4" is no option
    with tempfile.TemporaryFile() as log, subprocess.Popen(command, stdin=subprocess.PIPE, stdout=log, stderr=log) as process:
        with errors.undoing(lambda: kill(process)):
            with contextlib.suppress(BrokenPipeError), process.stdin:  # ffmpeg tells why it stopped
                for picture in film:
                    process.stdin.write(picture.tobytes())
            code = process.wait()
        log.seek(0)
        output = log.read().decode(errors="replace").strip()
    if code != 0 or output:  # a full disk is reported as an error, and may end well all the same
        raise PlotError(f"ffmpeg made no film: {output or f'exit code {code}'}")


def kill(process):
    """And wait until it writes no more; by the system's call, for the signal may have come while Popen held its lock."""
    process.kill()
    os.waitpid(process.pid, 0)


def by_pillow(path, film, fps):
    from PIL import Image
    pictures, out = (Image.fromarray(picture).quantize(128) for picture in film), io.BytesIO()
    next(pictures).save(out, format="GIF", save_all=True, append_images=pictures, duration=round(1000 / fps), loop=0)
    path.write_bytes(out.getvalue())


def film_of(run, spec):
    """(path, media type) of the film in the run directory, or None."""
    paths = ((run.figures_dir / (spec.name + ending), kind) for ending, kind in ENDINGS.items())
    return next(((path, kind) for path, kind in paths if path.is_file()), None)


def caption_movie(run, spec):
    with run.granular.trajectory(TRAJECTORY) as trajectory:
        count, last = trajectory.frames, trajectory.time[-1]
        cutoff = float(trajectory.parameter("order_cutoff"))
        first = trajectory.frame(0)
    found = film_of(run, spec)
    name = f"figures/{words.escape(found[0].name)}: t" if found else "T"
    return (f"{run.granular.which(TRAJECTORY)}{name}he bed from above, {count} pictures from "
            f"<i>t</i> = {bed.clock(first.time, last)} s to {bed.clock(last, last)} s, {spec.fps} a second"
            f"{bed.describe_rods(first)}. {bed.describe_colours(run, spec, cutoff)}")


# Film of the rods of the theory, coloured by heading: mp4 by ffmpeg if there is one, else an animated GIF.

RODS_DPI = 130
TRAIL = 8  # stored times behind a rod
HEADINGS = Normalize(-180, 180)
HEADING_MAP = ListedColormap(0.85 * matplotlib.colormaps["twilight"](np.linspace(0, 1, 256))[:, :3], name="headings")  # seen on white


def write_rods_movie(run, spec):
    """Paths written: the film, and its last picture as name.png."""
    return write_film(run, spec, RodsFilm(run, spec))


class RodsFilm(Film):
    def __init__(self, run, spec):
        self.rods, self.units, self.spec = runs_of(run.result)[0], run.result.units, spec
        window = rods_window(self.rods, spec, bodies.reach(run))
        self.length = self.units.length("x", max(map(abs, window[0] + window[1])))
        self.time = self.units.time("t", self.rods.t[-1])
        figure, self.axes = rods_stage(window, self.length, self.units)
        self.trails = matplotlib.collections.LineCollection([], colors=style.GREY, linewidths=0.5, alpha=0.5, zorder=2)
        self.axes.add_collection(self.trails, autolim=False)
        self.run, self.bodies = run, None
        if bodies.has_bodies(run):
            self.bodies = bodies.add(self.axes, run, self.rods.x[0], self.rods.y[0], self.rods.theta[0], self.length.factor,
                                     self.colours(0), zorder=3)
        self.arrows = None if self.bodies else self.axes.quiver(*self.places(0), *self.directions(0), self.headings(0), cmap=HEADING_MAP, norm=HEADINGS, pivot="mid",
                                       angles="xy", units="dots", scale_units="dots", scale=1 / 11, width=2.6, headwidth=3.4, headlength=4,
                                       headaxislength=3.6, zorder=3)
        self.lay_out(figure, len(self.rods.t), RODS_DPI)

    def places(self, frame):
        return self.rods.x[frame] * self.length.factor, self.rods.y[frame] * self.length.factor

    def directions(self, frame):
        return np.cos(self.rods.theta[frame]), np.sin(self.rods.theta[frame])

    def headings(self, frame):
        return (np.degrees(self.rods.theta[frame]) + 180) % 360 - 180

    def colours(self, frame):
        return HEADING_MAP(HEADINGS(self.headings(frame)))

    def show(self, frame):
        frame %= len(self.rods.t)
        if self.bodies:
            at = self.rods.x[frame], self.rods.y[frame], self.rods.theta[frame]
            self.bodies.set_offsets(self.length.factor * bodies.centres(self.run, *at))
            counts = [len(bodies.discs(self.run, rod)[0]) for rod in range(len(at[0]))]
            self.bodies.set_facecolors(np.repeat(self.colours(frame), counts, axis=0))
        else:
            self.arrows.set_offsets(np.column_stack(self.places(frame)))
            self.arrows.set_UVC(*self.directions(frame), self.headings(frame))
        since = max(0, frame - TRAIL)
        self.trails.set_segments(np.stack(self.places(slice(since, frame + 1)), axis=-1).swapaxes(0, 1))
        title = style.safe(self.spec.title) + ", " if self.spec.title else ""
        canvas.heading(self.axes, title + self.units.equals(self.time, "t", self.rods.t[frame]))


def rods_window(rods, spec, reach=0.0):
    """What the scene asks for, or all places with a margin."""
    x, y = span(rods.x), span(rods.y)
    margin = max(0.03 * max(np.ptp(x), np.ptp(y)) or 1.0, reach)
    return spec.x or grown(x, margin), spec.y or grown(y, margin)


def rods_stage(window, length, units):
    """Figure and axes with everything but the rods."""
    x, y = (tuple(edge * length.factor for edge in pair) for pair in window)
    aspect = min(max(np.ptp(y) / np.ptp(x), 0.3), 1.5)
    figure = canvas.figure(6.4, 5.2 * aspect + 0.7)
    axes = figure.subplots()
    canvas.window(axes, x, y)
    axes.set(xlabel=length.label, ylabel=units.length("y", max(map(abs, window[0] + window[1]))).label)
    canvas.colour_bar(figure, ScalarMappable(HEADINGS, HEADING_MAP), axes, "heading (°)", pad=0.02, aspect=32, ticks=[-180, -90, 0, 90, 180])
    return figure, axes


def caption_rods_movie(run, spec):
    rods, units = runs_of(run.result)[0], run.result.units
    found = film_of(run, spec)
    name = f"figures/{words.escape(found[0].name)}: " if found else ""
    drawn = "with their bodies to scale" if bodies.has_bodies(run) else "as arrows"
    return (f"{name}{rods.x.shape[1]} rods {drawn}, coloured by heading, with what they walked since {TRAIL} pictures before; {len(rods.t)} "
            f"pictures from <i>t</i> = {words.number(rods.t[0])} to {words.number(rods.t[-1])} {units.time_html()}, {spec.fps} a second.")


KINDS = {
    "movie": Kind(write=write_movie, caption=caption_movie),
    "rods_movie": Kind(write=write_rods_movie, caption=caption_rods_movie),
}
