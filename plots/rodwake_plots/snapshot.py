"""The bed from above: beads coloured by their sixfold order, rods with an arrow at the thin end."""

import matplotlib
import numpy as np
from matplotlib.cm import ScalarMappable
from matplotlib.colors import ListedColormap, Normalize

from . import bed, canvas, style, words
from .granular_run import TRAJECTORY
from .local_order import psi6
from .periodic import with_images
from .spec import Spec

# The angles repeat every 60 degrees, and so does the map; turned so that rows along x and along y, the usual ones, stand out.
ORIENTATION_MAP = ListedColormap(np.roll(matplotlib.colormaps["twilight"](np.linspace(0, 1, 256)), 64, axis=0), name="rows")
LABELS = {"order": r"local bond order $|\psi_{6,i}|$", "orientation": "direction of the close-packed rows (°)"}


def draw(run, spec):
    with run.granular.trajectory(TRAJECTORY) as trajectory:
        frame = trajectory.frame(spec.frame)
        figure, axes = stage(run, spec)
        paint(axes, run, spec, frame, trajectory.parameter("order_cutoff"))
        canvas.heading(axes, bed.heading_text(run, spec, frame.time, trajectory.time[-1]))
    return figure


def stage(run, spec):
    """Figure and axes with everything but the bed."""
    window = bed.window_of(run, spec)
    aspect = np.ptp(window[1]) / np.ptp(window[0])
    figure = canvas.figure(5.8, min(4.6 * aspect, 7.5) + 0.7)
    axes = figure.subplots()
    canvas.window(axes, *window)
    axes.set(xlabel=r"$x/a$", ylabel=r"$y/a$", facecolor="#f4f4f2")
    axes.tick_params(direction="out", top=False, right=False)
    bed.box_edges(axes, run.granular.box / run.granular.a, window)
    colour_bar(figure, axes, spec)
    return figure, axes


def mapping(spec):
    if spec.colour == "orientation":
        return Normalize(-30, 30), ORIENTATION_MAP
    return Normalize(0, 1), style.FIELD_MAP


def colour_bar(figure, axes, spec):
    bar = figure.colorbar(ScalarMappable(*mapping(spec)), ax=axes, pad=0.02, aspect=32)
    bar.set_label(LABELS[spec.colour])
    if spec.colour == "orientation":
        bar.set_ticks([-30, -20, -10, 0, 10, 20, 30])
    bar.ax.tick_params(direction="in")


def paint(axes, run, spec, frame, cutoff):
    """The bed's artists, for whoever wants to take them away again."""
    a, window = run.granular.a, bed.window_of(run, spec)
    values = shade(spec, psi6(frame.beads[:, :2], frame.box, cutoff))
    centres, index = with_images(frame.beads[:, :2] / a, frame.radii / a, frame.box / a, window)
    norm, colours = mapping(spec)
    beads = bed.discs(axes, centres, frame.radii[index] / a, array=values[index], norm=norm, cmap=colours)
    return [beads, *bed.rods_from_above(axes, frame, a, window)]


def shade(spec, order):
    return np.degrees(np.angle(order)) / 6 if spec.colour == "orientation" else np.abs(order)


def caption(run, spec):
    with run.granular.trajectory(TRAJECTORY) as trajectory:
        frame, cutoff = trajectory.frame(spec.frame), float(trajectory.parameter("order_cutoff"))
        time = bed.clock(frame.time, trajectory.time[-1])
    return (f"{run.granular.which(TRAJECTORY)}The bed from above at <i>t</i> = {time} s, circles at true size: {len(frame.beads)} beads, "
            f"{words.equation('<i>φ<sub>b</sub></i>', run.granular.phi_b)}{rods_told(frame)}. {colours_told(run, spec, cutoff)}")


def rods_told(frame):
    if not frame.rods:
        return ""
    several = len(frame.rods) > 1
    arrow = ", arrows before the thin ends" if several else ", an arrow before its thin end"
    return f", {len(frame.rods)} rod{'s' if several else ''}{arrow if any(rod.tapers for rod in frame.rods) else ''}"


def colours_told(run, spec, cutoff):
    what = ("Colour: the mean of exp(6<i>iθ</i>) over the directions <i>θ</i> to the beads nearer than "
            f"{words.number(cutoff / run.granular.a)} <i>a</i>; ")
    if spec.colour == "orientation":
        return what + "shown is its angle over 6, the direction of the close-packed rows from <i>x</i>."
    return what + "shown is its modulus |<i>ψ</i><sub>6,<i>i</i></sub>|, 1 in a perfect triangular lattice."


def defaults(run):
    return [Spec("snapshot", "snapshot")] if run.granular.has(TRAJECTORY) and run.granular.stores_all_beads(TRAJECTORY) else []
