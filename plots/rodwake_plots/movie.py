"""The bed from above as a film: mp4 by ffmpeg if there is one, else an animated GIF by Pillow."""

import contextlib
import io
import os
import shutil
import subprocess
import tempfile

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg

from . import bed, canvas, files, snapshot, stop, words
from .errors import PlotError
from .granular_run import TRAJECTORY

DPI = 160
QUALITY = "20"  # constant rate factor of x264: no visible loss
ENDINGS = {".mp4": "video/mp4", ".gif": "image/gif"}


def write(run, spec):
    """Paths written: the film, and its last picture as name.png."""
    with run.granular.trajectory(TRAJECTORY) as trajectory:
        return write_film(run, spec, Film(run, spec, trajectory))


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
    """The pictures, drawn one by one on a figure whose layout is made once."""

    def __init__(self, run, spec, trajectory):
        self.run, self.spec, self.trajectory = run, spec, trajectory
        self.cutoff = trajectory.parameter("order_cutoff")
        self.figure, self.axes = snapshot.stage(run, spec)
        self.figure.set_dpi(DPI)
        self.canvas = FigureCanvasAgg(self.figure)
        self.artists = []
        self.show(0)
        self.canvas.draw()
        self.figure.set_layout_engine("none")
        self.height, self.width = (size // 2 * 2 for size in np.asarray(self.canvas.buffer_rgba()).shape[:2])  # x264 wants even

    def show(self, number):
        frame = self.trajectory.frame(number)
        for artist in self.artists:
            artist.remove()
        self.artists = snapshot.paint(self.axes, self.run, self.spec, frame, self.cutoff)
        canvas.heading(self.axes, bed.heading_text(self.run, self.spec, frame.time, self.trajectory.time[-1]))

    def __iter__(self):
        """[row][column][red, green, blue] of each frame."""
        for number in range(self.trajectory.frames):
            self.show(number)
            self.canvas.draw()
            yield np.ascontiguousarray(np.asarray(self.canvas.buffer_rgba())[:self.height, :self.width, :3])

    def save_still(self, path):
        self.show(-1)
        canvas.save(self.figure, path)


def by_ffmpeg(path, film, fps):
    command = ["ffmpeg", "-loglevel", "error", "-nostdin", "-y", "-f", "rawvideo", "-pix_fmt", "rgb24",
               "-s", f"{film.width}x{film.height}", "-r", str(fps), "-i", "-", "-c:v", "libx264", "-crf", QUALITY,
               "-pix_fmt", "yuv420p", "-movflags", "+faststart", "-f", "mp4", str(path)]
    with tempfile.TemporaryFile() as log, subprocess.Popen(command, stdin=subprocess.PIPE, stdout=log, stderr=log) as process:
        with stop.undoing(lambda: kill(process)):
            with contextlib.suppress(BrokenPipeError), process.stdin:  # ffmpeg tells why it stopped
                for picture in film:
                    process.stdin.write(picture.tobytes())
            code = process.wait()
        log.seek(0)
        told = log.read().decode(errors="replace").strip()
    if code != 0 or told:  # a disk that is full is told as an error, and may end well all the same
        raise PlotError(f"ffmpeg made no film: {told or f'exit code {code}'}")


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


def caption(run, spec):
    with run.granular.trajectory(TRAJECTORY) as trajectory:
        count, last = trajectory.frames, trajectory.time[-1]
        cutoff = float(trajectory.parameter("order_cutoff"))
        first = trajectory.frame(0)
    found = film_of(run, spec)
    name = f"figures/{words.escape(found[0].name)}: t" if found else "T"
    return (f"{run.granular.which(TRAJECTORY)}{name}he bed from above, {count} pictures from "
            f"<i>t</i> = {bed.clock(first.time, last)} s to {bed.clock(last, last)} s, {spec.fps} a second"
            f"{snapshot.rods_told(first)}. {snapshot.colours_told(run, spec, cutoff)}")


def defaults(_):
    """Only where a scene asks for it: it takes longer than all the rest."""
    return []
