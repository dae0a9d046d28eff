"""A granular bed on paper: beads and rods at true size. Axes are in bead radii."""

import math

import matplotlib
import numpy as np
from matplotlib import patheffects
from matplotlib.cm import ScalarMappable
from matplotlib.collections import EllipseCollection
from matplotlib.colors import ListedColormap, Normalize
from matplotlib.patches import Circle, FancyArrowPatch, Polygon, Rectangle

from . import canvas, files, style, trajectories, words
from .bed_run import FILM_FRAME, LAST_PERIOD, ROD_TRACKS, TRAJECTORY, FilmRods, track
from .frames import images, psi6, with_images, wrapped_path
from .schema import Kind

RIM = "#2b2b2b"
ARROW = 4.0  # length of a heading arrow, bead radii
MOST_NUMBERS = 12


def discs(axes, centres, radii, **look):
    """Circles in data units, which zooming and saving at any size leave true; centres [n][2]."""
    look = {"linewidths": 0, "zorder": 2} | look
    made = EllipseCollection(2 * radii, 2 * radii, np.zeros(len(radii)), units="xy", offsets=centres,
                             offset_transform=axes.transData, **look)
    axes.add_collection(made, autolim=False)
    return made


def row_of_discs(axes, centres, radii, colour, zorder):
    """The outline of a row of overlapping discs: all rims first, then all insides over them."""
    rims = discs(axes, centres, radii, facecolors=RIM, edgecolors=RIM, linewidths=1.3, zorder=zorder)
    return [rims, discs(axes, centres, radii, facecolors=colour, zorder=zorder)]


def rod_colour(rod):
    return style.BED_RODS[rod % len(style.BED_RODS)]


def rods_from_above(axes, frame, a, window):
    """The spheres of each rod, an arrow before its thin end, and its number where there are several."""
    made, box = [], frame.box / a
    for number, rod in enumerate(frame.rods):
        centres, index = with_images(rod.spheres[:, :2] / a, rod.radii / a, box, window)
        made += row_of_discs(axes, centres, rod.radii[index] / a, rod_colour(number), 3)
        if rod.tapers:
            tips, _ = with_images(rod.tip[None, :2] / a, np.array([ARROW]), box, window)
            made += [arrow(axes, tip, rod.axis[:2]) for tip in tips]
        if 1 < len(frame.rods) <= MOST_NUMBERS:
            middles, _ = with_images(rod.spheres[:, :2].mean(axis=0, keepdims=True) / a, np.zeros(1), box, window)
            made += [rod_number(axes, number, middle) for middle in middles]
    return made


def arrow(axes, tip, axis):
    """Cut off at the frame, as the rod is."""
    shadow = axis / (math.hypot(*axis) or 1.0)
    return axes.add_patch(FancyArrowPatch(
        tip + 0.15 * ARROW * shadow, tip + ARROW * shadow, arrowstyle="-|>,head_length=0.35,head_width=0.2", mutation_scale=10,
        shrinkA=0, shrinkB=0, linewidth=1.4, color="black", zorder=4,
        path_effects=[patheffects.withStroke(linewidth=3.2, foreground="white")]))


def rod_number(axes, number, place):
    return axes.text(*place, str(number), ha="center", va="center_baseline", fontsize=8, weight="bold", color="white", zorder=5,
                     path_effects=[patheffects.withStroke(linewidth=1.2, foreground=RIM)], clip_on=True)


def bed_edge(axes, granular, window):
    """The wall of a container, or the edges of the periodic box."""
    if not granular.container:
        return box_edges(axes, granular.sides / granular.a, window)
    x, y = granular.sides / granular.a
    wall = Circle((x / 2, y / 2), x / 2) if granular.container == "circle" else Rectangle((0, 0), x, y)
    wall.set(facecolor="none", edgecolor=RIM, linewidth=1.4, zorder=6)
    return axes.add_patch(wall)


def box_edges(axes, box, window):
    """Broken lines where the box ends, if the window shows more than the box."""
    for line, side, (low, high) in zip((axes.axvline, axes.axhline), box, window):
        for edge in (0, side):
            if low < edge < high:
                line(edge, color=RIM, linewidth=0.8, linestyle=(0, (5, 4)), zorder=6)


def window_of(run, spec):
    """The figure's window (in the resolved scene: m) in bead radii, ((x0, x1), (y0, y1)); the whole box where the scene says nothing."""
    granular = FilmRods(run.path) if run.has_tracks else run.granular
    edge = 1.0 if granular.container or run.has_tracks and not granular.is_periodic else 0.0  # so that all of the wall, or of each bead, is seen
    return tuple(tuple(end / granular.a for end in asked) if asked else (-edge, side / granular.a + edge)
                 for asked, side in zip((spec.x, spec.y), granular.sides))


def density(granular):
    """Area fraction for the head of a figure; a rod alone is between plates, not in a bed."""
    return rf"$\phi_b = {granular.phi_b:.3f}$" if granular.need("beads") else "no beads"


def clock(t, last):
    """A time with as many digits as the run's length deserves."""
    return f"{t:.{max(0, 2 - math.floor(math.log10(last)))}f}" if 0 < last < 1 else f"{t:.2f}"


def heading_text(run, spec, time, last):
    if spec.title:
        return style.safe(spec.title)
    return rf"{density(run.granular)},  $t = {clock(time, last)}$ s"


# The bed from above: beads coloured by their sixfold order, rods with an arrow at the thin end.

# The angles repeat every 60 degrees, and so does the map; turned so that rows along x and along y, the usual ones, stand out.
ORIENTATION_MAP = ListedColormap(np.roll(matplotlib.colormaps["twilight"](np.linspace(0, 1, 256)), 64, axis=0), name="rows")
LABELS = {"order": r"local bond order $|\psi_{6,i}|$", "orientation": "direction of the close-packed rows (°)"}


def draw_snapshot(run, spec):
    if run.has_tracks:
        return draw_film_frame(run, spec)
    with run.granular.trajectory(TRAJECTORY) as trajectory:
        frame = trajectory.frame(spec.frame)
        figure, axes = snapshot_stage(run, spec)
        paint_snapshot(axes, run, spec, frame, trajectory.parameter("order_cutoff"))
        canvas.heading(axes, heading_text(run, spec, frame.time, trajectory.time[-1]))
    return figure


def snapshot_stage(run, spec):
    """Figure and axes with everything but the bed."""
    window = window_of(run, spec)
    aspect = np.ptp(window[1]) / np.ptp(window[0])
    figure = canvas.figure(5.8, min(4.6 * aspect, 7.5) + 0.7)
    axes = figure.subplots()
    canvas.window(axes, *window)
    axes.set(xlabel=r"$x/a$", ylabel=r"$y/a$", facecolor="#f4f4f2")
    axes.tick_params(direction="out", top=False, right=False)
    if not run.has_tracks:
        bed_edge(axes, run.granular, window)
        order_bar(figure, axes, spec)
    return figure, axes


def bead_colours(spec):
    if spec.colour == "orientation":
        return Normalize(-30, 30), ORIENTATION_MAP
    return Normalize(0, 1), style.FIELD_MAP


def order_bar(figure, axes, spec):
    bar = canvas.colour_bar(figure, ScalarMappable(*bead_colours(spec)), axes, LABELS[spec.colour], pad=0.02, aspect=32)
    if spec.colour == "orientation":
        bar.set_ticks([-30, -20, -10, 0, 10, 20, 30])


def paint_snapshot(axes, run, spec, frame, cutoff):
    """The bed's artists, for whoever wants to take them away again."""
    a, window = run.granular.a, window_of(run, spec)
    values = bead_values(spec, psi6(frame.beads[:, :2], frame.box, cutoff))
    centres, index = with_images(frame.beads[:, :2] / a, frame.radii / a, frame.box / a, window)
    norm, colours = bead_colours(spec)
    beads = discs(axes, centres, frame.radii[index] / a, array=values[index], norm=norm, cmap=colours)
    return [beads, *rods_from_above(axes, frame, a, window)]


def bead_values(spec, order):
    return np.degrees(np.angle(order)) / 6 if spec.colour == "orientation" else np.abs(order)


# The same of a film: its frame with most beads, and where the rods went.

SLIM = np.array([1.0, 0.5])  # of the rod's outline: films say nothing of its width
PLAIN, UNKNOWN = "#b7c3cc", "#d3d3cf"  # beads of a film without bond order; beads whose own order is not known


def draw_film_frame(run, spec):
    t, *place, order, orientation, radii = files.read_columns(run.path / FILM_FRAME, "t", "x", "y", "psi6", "orientation", "radius")
    film, window = FilmRods(run.path), window_of(run, spec)
    figure, axes = snapshot_stage(run, spec)
    centres, index = with_images(np.stack(place, axis=-1) / film.a, radii / film.a, film.box / film.a, window)
    values = np.degrees(orientation) if spec.colour == "orientation" else order
    values, radii = values[index], radii[index] / film.a
    known, (norm, colours) = np.isfinite(values), bead_colours(spec)
    rim = dict(edgecolors="white", linewidths=0.3)
    discs(axes, centres[~known], radii[~known], facecolors=UNKNOWN if known.any() else PLAIN, **rim)
    if known.any():
        discs(axes, centres[known], radii[known], array=values[known], norm=norm, cmap=colours, **rim)
        order_bar(figure, axes, spec)
    if (run.path / ROD_TRACKS).is_file():
        film_rods(axes, film, track(run.path / ROD_TRACKS), t[0], window)
    labels = ([rf"$\phi_b = {film.phi_b:.3f}$"] if words.is_number(film.phi_b) else []) + [rf"$t = {clock(t[0], run.tracks.get('duration', 0.0))}$ s"]
    canvas.heading(axes, style.safe(spec.title) or ",  ".join(labels))
    return figure


def film_rods(axes, film, rods, t, window):
    """Each rod's path over the whole film, and the rod as it lies in the frame, as long as it is; a mark where its length is not known."""
    at = int(np.argmin(np.abs(rods.t - t)))
    halo = [patheffects.withStroke(linewidth=3.0, foreground="white")]
    for number in range(rods.x.shape[1]):
        colour = rod_colour(number)
        axes.plot(*wrapped_path(rods.x[:, number], rods.y[:, number], film.box).T / film.a, color=colour, linewidth=1.5, zorder=3, path_effects=halo)
        x, y, theta = (part[at, number] for part in (rods.x, rods.y, rods.theta))
        length = film.lengths[number] if number < len(film.lengths) else None
        if not np.isfinite([x, y, theta]).all():
            continue
        heading, reach = np.array([math.cos(theta), math.sin(theta)]), (length or 0.0) / film.a
        for middle in with_images(np.array([[x, y]]) / film.a, np.array([max(reach / 2, 1.0)]), film.box / film.a, window)[0]:
            if not reach:
                trajectories.filled(axes, *middle, theta, colour)
                continue
            outline = reach * SLIM * canvas.ROD_OUTLINE @ np.array([heading, [-heading[1], heading[0]]])
            axes.add_patch(Polygon(middle + outline, facecolor=colour, edgecolor=RIM, linewidth=1.0, zorder=5))
            arrow(axes, middle + reach / 2 * heading, heading)


def caption_film_frame(run, spec):
    t, order, radii = files.read_columns(run.path / FILM_FRAME, "t", "psi6", "radius")
    film = FilmRods(run.path)
    text = (f"The frame of the film with most beads, {t.size}, at <i>t</i> = {clock(t[0], run.tracks.get('duration', 0.0))} s; "
            f"circles {'have the radius <i>a</i>' if np.all(radii == film.a) else 'are at true size'}")
    if film.lengths:
        lines = "paths of the rods over the whole film" if len(film.lengths) > 1 else "the path of the rod over the whole film"
        text += f"; lines: {lines}" + ("; rods are as long as their ends are apart" if any(film.lengths) else "")
    if not np.isfinite(order).any():
        return text + "."
    shown = ("the direction of the close-packed rows from <i>x</i>" if spec.colour == "orientation"
             else "the local bond order |<i>ψ</i><sub>6,<i>i</i></sub>|, 1 in a perfect triangular lattice")
    text += f". Colour: {shown}, with the neighbours of the measured <i>ψ</i><sub>6</sub>"
    return text + ("; grey beads are too near the border for all their neighbours to be visible." if not np.isfinite(order).all() else ".")


def caption_snapshot(run, spec):
    if run.has_tracks:
        return caption_film_frame(run, spec)
    with run.granular.trajectory(TRAJECTORY) as trajectory:
        frame, cutoff = trajectory.frame(spec.frame), float(trajectory.parameter("order_cutoff"))
        time = clock(frame.time, trajectory.time[-1])
    return (f"{run.granular.which(TRAJECTORY)}The bed from above at <i>t</i> = {time} s, circles at true size: {len(frame.beads)} beads, "
            f"{words.equation('<i>φ<sub>b</sub></i>', run.granular.phi_b)}{describe_rods(frame)}. {describe_colours(run, spec, cutoff)}")


def describe_rods(frame):
    if not frame.rods:
        return ""
    several = len(frame.rods) > 1
    arrow = ", arrows before the thin ends" if several else ", an arrow before its thin end"
    return f", {len(frame.rods)} rod{'s' if several else ''}{arrow if any(rod.tapers for rod in frame.rods) else ''}"


def describe_colours(run, spec, cutoff):
    what = ("Colour: the mean of exp(6<i>iθ</i>) over the directions <i>θ</i> to the beads nearer than "
            f"{words.number(cutoff / run.granular.a)} <i>a</i>; ")
    if spec.colour == "orientation":
        return what + "shown is its angle over 6, the direction of the close-packed rows from <i>x</i>."
    return what + "shown is its modulus |<i>ψ</i><sub>6,<i>i</i></sub>|, 1 in a perfect triangular lattice."


# The bed from the side, through a slice, at a few phases of the plates; height and width at the same scale.

PHASES = 5
SLAB = 3.0    # thickness of the slice, a
WIDTH = 44.0  # of the window where the scene says nothing, a
MARGIN = 0.55  # of the plates that is drawn above and below, a
SPEEDS = "RdBu_r"


def draw_side_view(run, spec):
    with run.granular.trajectory(LAST_PERIOD) as trajectory:
        frames = [trajectory.frame(at) for at in phases(trajectory.frames)]
        plates = Plates(trajectory, run.granular.a)
    window, middle = slice_of(run, spec, frames[0])
    norm = speed_norm(frames)
    figure, (clocks, panels) = side_layout(window, plates, len(frames))
    for dial, axes, frame in zip(clocks, panels, frames):
        draw_dial(dial, plates, frame.time)
        draw_panel(axes, run.granular.a, plates, frame, window, middle, norm)
    panels[-1].tick_params(labelbottom=True)
    panels[-1].set_xlabel(r"$x/a$")
    panels[len(panels) // 2].set_ylabel(r"$z/a$")
    if len(frames[0].beads):
        speed_bar(figure, panels, norm)
    figure.suptitle(side_title(run, spec, frames), fontsize=10.5)
    return figure


def phases(frames):
    """Frames at equal parts of the period, fewer if there are fewer."""
    return [round(at) for at in np.arange(min(PHASES, frames)) * frames / min(PHASES, frames)]


class Plates:
    """floor z = A cos(2 pi f t), the lid a gap above; lengths in a."""

    def __init__(self, trajectory, a):
        self.gap, self.amplitude = (float(trajectory.parameter(name)) / a for name in ("gap", "amplitude"))
        self.frequency = float(trajectory.parameter("frequency"))

    def phase(self, time):
        """In turns, 0 to 1."""
        return (self.frequency * time + 1e-9) % 1

    def floor(self, time):
        return self.amplitude * math.cos(2 * math.pi * self.phase(time))


def slice_of(run, spec, frame):
    """(x window, y of the slice's middle) in a: through the first rod, or where the scene's window says."""
    a, sides = run.granular.a, run.granular.sides / run.granular.a
    centre = frame.rods[0].spheres[:, :2].mean(axis=0) / a if frame.rods else sides / 2
    x, y = window_of(run, spec)
    if not spec.x:
        half = min(WIDTH, sides[0]) / 2
        x = (centre[0] - half, centre[0] + half)
    return x, (y[0] + y[1]) / 2 if spec.y else centre[1]


def speed_norm(frames):
    speeds = np.concatenate([frame.velocity[:, 2] for frame in frames])
    top = np.percentile(np.abs(speeds), 98) if speeds.size else 0.0
    return Normalize(-top * 1e3 or -1.0, top * 1e3 or 1.0)  # mm/s


def side_layout(window, plates, count):
    low, high = heights(plates)
    width = style.WIDE - 1.1  # of the panels: the rest goes to dials, numbers and names
    each = width * (high - low) / (window[1] - window[0])
    figure = canvas.figure(style.WIDE + 0.3, count * (each + 0.1) + 1.35)
    grid = figure.subplots(count, 2, squeeze=False, gridspec_kw={"width_ratios": [min(0.13, each / width), 1]})
    for row, axes in enumerate(grid[:, 1]):
        canvas.window(axes, window, (low, high))
        axes.set_yticks([0, round(plates.gap)] if plates.gap >= 1 else [0])
        axes.tick_params(direction="out", top=False, right=False, labelbottom=False)
    return figure, grid.T


def heights(plates):
    return -plates.amplitude - MARGIN, plates.gap + plates.amplitude + MARGIN


def draw_dial(axes, plates, time):
    """Where in the period: one turn of the floor's height with a dot, and the phase in degrees."""
    turn = np.linspace(0, 1, 80)
    axes.plot(turn, np.cos(2 * np.pi * turn), color=style.GREY, linewidth=0.9)
    phase = plates.phase(time)
    axes.plot([phase], [math.cos(2 * math.pi * phase)], "o", color=style.INK, markersize=4.5, clip_on=False)
    axes.text(0.5, 1.45, f"{360 * phase:.0f}°", ha="center", va="bottom", fontsize=9)
    axes.set(xlim=(-0.05, 1.05), ylim=(-1.5, 2.9))
    axes.set_axis_off()


def draw_panel(axes, a, plates, frame, window, middle, norm):
    floor = plates.floor(frame.time)
    low, high = axes.get_ylim()
    for bottom, top in ((low, floor), (floor + plates.gap, high)):
        axes.fill_between(window, bottom, top, color="#b9b9b4", linewidth=0, zorder=1)
    for level in (0, plates.gap):  # where the plates are on average
        axes.axhline(level, color=style.INK, linewidth=0.5, linestyle=(0, (5, 4)), zorder=6)
    draw_beads(axes, a, frame, window, middle, norm)
    draw_rods(axes, a, frame, window, middle)


def across(y, middle, side):
    """Distance from the slice's middle, towards the viewer negative."""
    return y - middle - side * np.round((y - middle) / side)


def draw_beads(axes, a, frame, window, middle, norm):
    """Those in the slice, the far ones first."""
    away = across(frame.beads[:, 1] / a, middle, frame.box[1] / a)
    shown = np.flatnonzero(np.abs(away) < SLAB / 2)
    shown = shown[np.argsort(-away[shown], kind="stable")]
    x, index = images(frame.beads[shown, 0] / a, frame.radii[shown] / a, frame.box[0] / a, window)
    chosen_ones = shown[index]
    centres = np.column_stack([x, frame.beads[chosen_ones, 2] / a])
    discs(axes, centres, frame.radii[chosen_ones] / a, array=frame.velocity[chosen_ones, 2] * 1e3, norm=norm, cmap=SPEEDS,
              edgecolors=RIM, linewidths=0.5)


def draw_rods(axes, a, frame, window, middle):
    """Spheres of rods that reach into the slice, over the beads."""
    for number, rod in enumerate(frame.rods):
        inside = np.abs(across(rod.spheres[:, 1] / a, middle, frame.box[1] / a)) < SLAB / 2
        radii = rod.radii[inside] / a
        x, index = images(rod.spheres[inside, 0] / a, radii, frame.box[0] / a, window)
        row_of_discs(axes, np.column_stack([x, rod.spheres[inside, 2][index] / a]), radii[index], rod_colour(number), 3)


def speed_bar(figure, panels, norm):
    canvas.colour_bar(figure, ScalarMappable(norm, SPEEDS), list(panels), "vertical velocity of the beads (mm/s)", location="bottom", shrink=0.55,
                      aspect=45, pad=0.02, extend="both")


def side_title(run, spec, frames):
    """With the time at the period's start: a period is too short for the clock of the other figures."""
    return style.safe(spec.title) or rf"{density(run.granular)},  from $t = {frames[0].time:.4f}$ s on"


def caption_side_view(run, spec):
    with run.granular.trajectory(LAST_PERIOD) as trajectory:
        plates, frame = Plates(trajectory, run.granular.a), trajectory.frame(0)
    middle = slice_of(run, spec, frame)[1]
    return (f"{run.granular.which(LAST_PERIOD)}The bed from the side in the last period of the plates (from <i>t</i> = "
            f"{frame.time:.4f} s on): beads and rods in the slice |<i>y</i> − {middle:.1f} <i>a</i>| &lt; {SLAB / 2:g} <i>a</i>, "
            f"at true size and shape. Left: the phase of the plates; broken lines: their mean heights. "
            f"{words.equation('<i>A</i>', plates.amplitude)} <i>a</i>, {words.equation('<i>f</i>', plates.frequency, 'Hz')}, "
            f"{words.equation('<i>w</i>', plates.gap)} <i>a</i>.")


KINDS = {
    "snapshot": Kind(draw=draw_snapshot, caption=caption_snapshot,
                     there=lambda run: (run.path / FILM_FRAME).is_file() if run.has_tracks else run.granular.has_all_beads(TRAJECTORY)),
    "side_view": Kind(draw=draw_side_view, caption=caption_side_view, there=lambda run: run.granular.has_all_beads(LAST_PERIOD)),
}
