"""The bed from the side, through a slice, at a few phases of the plates; height and width at the same scale."""

import math

import numpy as np
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize

from . import bed, canvas, style, words
from .granular_run import LAST_PERIOD
from .periodic import images
from .spec import Spec

PHASES = 5
SLAB = 3.0    # thickness of the slice, a
WIDTH = 44.0  # of the window where the scene says nothing, a
MARGIN = 0.55  # of the plates that is drawn above and below, a
SPEEDS = "RdBu_r"


def draw(run, spec):
    with run.granular.trajectory(LAST_PERIOD) as trajectory:
        frames = [trajectory.frame(at) for at in chosen(trajectory.frames)]
        plates = Plates(trajectory, run.granular.a)
    window, middle = slice_of(run, spec, frames[0])
    norm = speed_norm(frames)
    figure, (clocks, panels) = layout(window, plates, len(frames))
    for dial, axes, frame in zip(clocks, panels, frames):
        draw_dial(dial, plates, frame.time)
        draw_panel(axes, run.granular.a, plates, frame, window, middle, norm)
    panels[-1].tick_params(labelbottom=True)
    panels[-1].set_xlabel(r"$x/a$")
    panels[len(panels) // 2].set_ylabel(r"$z/a$")
    if len(frames[0].beads):
        colour_bar(figure, panels, norm)
    figure.suptitle(title(run, spec, frames), fontsize=10.5)
    return figure


def chosen(frames):
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
    a, box = run.granular.a, frame.box / run.granular.a
    centre = frame.rods[0].spheres[:, :2].mean(axis=0) / a if frame.rods else box / 2
    x, y = bed.window_of(run, spec)
    if not spec.x:
        half = min(WIDTH, box[0]) / 2
        x = (centre[0] - half, centre[0] + half)
    return x, (y[0] + y[1]) / 2 if spec.y else centre[1]


def speed_norm(frames):
    speeds = np.concatenate([frame.velocity[:, 2] for frame in frames])
    top = np.percentile(np.abs(speeds), 98) if speeds.size else 0.0
    return Normalize(-top * 1e3 or -1.0, top * 1e3 or 1.0)  # mm/s


def layout(window, plates, count):
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
    bed.discs(axes, centres, frame.radii[chosen_ones] / a, array=frame.velocity[chosen_ones, 2] * 1e3, norm=norm, cmap=SPEEDS,
              edgecolors=bed.RIM, linewidths=0.5)


def draw_rods(axes, a, frame, window, middle):
    """Spheres of rods that reach into the slice, over the beads."""
    for number, rod in enumerate(frame.rods):
        inside = np.abs(across(rod.spheres[:, 1] / a, middle, frame.box[1] / a)) < SLAB / 2
        radii = rod.radii[inside] / a
        x, index = images(rod.spheres[inside, 0] / a, radii, frame.box[0] / a, window)
        bed.row_of_discs(axes, np.column_stack([x, rod.spheres[inside, 2][index] / a]), radii[index], bed.rod_colour(number), 3)


def colour_bar(figure, panels, norm):
    bar = figure.colorbar(ScalarMappable(norm, SPEEDS), ax=list(panels), location="bottom", shrink=0.55, aspect=45, pad=0.02, extend="both",
                          extendfrac=0.03)
    bar.set_label(r"vertical velocity of the beads (mm/s)")
    bar.ax.tick_params(direction="in")


def title(run, spec, frames):
    """With the time at the period's start: a period is too short for the clock of the other figures."""
    return style.safe(spec.title) or rf"{bed.density(run.granular)},  from $t = {frames[0].time:.4f}$ s on"


def caption(run, spec):
    with run.granular.trajectory(LAST_PERIOD) as trajectory:
        plates, frame = Plates(trajectory, run.granular.a), trajectory.frame(0)
    middle = slice_of(run, spec, frame)[1]
    return (f"{run.granular.which(LAST_PERIOD)}The bed from the side in the last period of the plates (from <i>t</i> = "
            f"{frame.time:.4f} s on): beads and rods in the slice |<i>y</i> − {middle:.1f} <i>a</i>| &lt; {SLAB / 2:g} <i>a</i>, "
            f"at true size and shape. Left: the phase of the plates; broken lines: their mean heights. "
            f"{words.equation('<i>A</i>', plates.amplitude)} <i>a</i>, {words.equation('<i>f</i>', plates.frequency, 'Hz')}, "
            f"{words.equation('<i>w</i>', plates.gap)} <i>a</i>.")


def defaults(run):
    return [Spec("side_view", "side_view")] if run.granular.has(LAST_PERIOD) and run.granular.stores_all_beads(LAST_PERIOD) else []
