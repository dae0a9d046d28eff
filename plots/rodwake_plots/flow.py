"""Mean velocity of the beads as seen from a rod: arrows of unit length, coloured by speed (paper, Figs. bead_drag a, c)."""

from typing import NamedTuple

import numpy as np
from matplotlib.colors import Normalize

from . import bed, bed_run, canvas, displacement, style, words
from .bed_run import FIELDS, SUMMARY, TRAJECTORY
from .errors import PlotError
from .frames import Frame, with_images
from .schema import Kind

FLOW_NAMES = ("vx", "vy", "sigma_x", "sigma_y", "count")
MOST_ARROWS = 40, 24  # across the window of one or two panels, of more
WIDE_RANGE = 20.0  # of speeds: more than this is drawn on a logarithmic scale
SIGNIFICANT = 3.0  # standard errors


class Field(NamedTuple):
    x: np.ndarray
    y: np.ndarray
    v: np.ndarray      # complex: vx + i vy; nan where no bead came
    clear: np.ndarray  # where |v| stands out from its error

    @property
    def speed(self):
        return np.abs(self.v)


def draw_flow(run, spec):
    parts = bed_run.holders(run, FIELDS, "flow")
    across = MOST_ARROWS[len(parts) > 2]
    fields = [read_flow(part, run, spec, across) for part in parts]
    window = tuple((min(getattr(field, name).min() for field in fields), max(getattr(field, name).max() for field in fields))
                   for name in ("x", "y"))
    figure, axes_list = canvas.panel_grid(parts, np.ptp(window[1]) / np.ptp(window[0]), bar=0.8)
    norm, extend = scale(fields)
    for axes, field in zip(axes_list, fields):
        canvas.window(axes, *window)
        arrows(axes, field, field.clear, norm, 1.0)
        image = arrows(axes, field, ~field.clear, norm, 0.45)
        displacement.draw_rod(axes, run)
        axes.tick_params(direction="out", top=False, right=False)
    canvas.label_panels(axes_list, parts, r"$x/a$", r"$y/a$", spec.title)
    canvas.colour_bar(figure, image, axes_list, r"mean speed ($\mathrm{mm/s}$)", extend=extend, pad=0.015, aspect=32)
    return figure


def read_flow(part, run, spec, across):
    x, y, vx, vy, sigma_x, sigma_y, count = part.grid("flow", *FLOW_NAMES)
    columns, rows = (bed_run.inside_window(values, asked, bed_run.bead_radius(run)) for values, asked in ((x, spec.x), (y, spec.y)))
    step = max(1, int(np.ceil(max(columns.sum(), rows.sum()) / across)))
    crop = np.ix_(rows, columns)
    factor = bed_run.mm_per_s(run)
    v, weight = factor * (vx + 1j * vy)[crop], np.nan_to_num(count[crop])
    variance = factor ** 2 * (sigma_x ** 2 + sigma_y ** 2)[crop] / 2
    x, y, v, variance = coarse(x[columns], y[rows], v, variance, weight, step)
    if not np.isfinite(v).any():
        raise PlotError(f"{part.folder / FIELDS}: /flow has no bin with beads inside the window: nothing to draw")
    return Field(x, y, v, np.abs(v) > SIGNIFICANT * np.sqrt(variance))


def coarse(x, y, v, variance, weight, step):
    """Means over step by step bins, weighted by the beads seen; nan where none was."""
    rows, columns = len(y) // step, len(x) // step

    def blocks(values):
        return values[:rows * step, :columns * step].reshape(rows, step, columns, step).sum(axis=(1, 3))
    total = blocks(weight)
    empty = total == 0
    total[empty] = 1
    mean = np.where(empty, np.nan, blocks(weight * np.where(weight > 0, v, 0)) / total)
    spread = blocks(weight ** 2 * np.where(weight > 0, variance, 0)) / total ** 2
    middles = (part[:count * step].reshape(count, step).mean(axis=1) for part, count in ((x, columns), (y, rows)))
    return *middles, mean, spread


def scale(fields):
    """Linear unless the speeds that stand out from their errors span far more than a decade."""
    speeds = np.concatenate([field.speed[np.isfinite(field.v)] for field in fields])
    clear = np.concatenate([field.speed[field.clear] for field in fields])
    top = np.percentile(speeds, 99.7) or 1.0
    if clear.size > 20 and np.percentile(clear, 99) > WIDE_RANGE * np.percentile(clear, 5):
        return canvas.log_norm(speeds)
    return Normalize(0, top), "max" if (speeds > top).any() else "neither"


def arrows(axes, field, which, norm, part):
    """`part` of the full width."""
    rows, columns = np.nonzero(which & np.isfinite(field.v) & (field.speed > 0))
    v = field.v[rows, columns]
    spacing = field.x[1] - field.x[0] if field.x.size > 1 else 1.0
    return axes.quiver(field.x[columns], field.y[rows], (v / np.abs(v)).real, (v / np.abs(v)).imag, np.abs(v), norm=norm,
                       cmap=style.FIELD_MAP, pivot="middle", angles="xy", units="xy", scale_units="xy", scale=1 / (0.85 * spacing),
                       width=0.13 * spacing * part, headwidth=4, headlength=4.5, headaxislength=4, minlength=0, zorder=3)


def caption_flow(run, spec):
    parts = bed_run.holders(run, FIELDS, "flow")
    text = ("Direction of the beads' mean velocity in the frame that moves and turns with the rod, thin end towards +<i>x</i>, and by "
            f"colour its size; thin arrows: less than {SIGNIFICANT:g} standard errors. Beads at rest in the box have velocity 0. "
            f"{displacement.drawn(run)} {canvas.describe_panels(parts, lambda part: near(part, bed_run.mm_per_s(run)))}").rstrip()
    return text + bed_run.not_measured(run, FIELDS, "flow")


def near(part, mm_per_s):
    speed = part.number("flow", "near_speed")
    return "" if speed is None else f"Mean speed within 6 <i>a</i> of the rod: {words.number(mm_per_s * float(speed), 3)} mm/s."


# Beads around the rod at the start of the run, and where they are at its end (paper, Figs. bead_drag b, d).

MARKED = "marked.csv"
PURPLE, PALE = "#7b3294", "#d9d9d4"
MARKED_MARGIN = 4.0  # of the window, a
NEAR = 14.0   # a; a rod within this of the marked beads is in the picture


class View(NamedTuple):
    """In bead radii, drift of the bed included, unwrapped around the marked beads."""
    frame: Frame
    first: np.ndarray   # [marked][2]
    last: np.ndarray    # [marked][2]
    marked: np.ndarray  # their numbers among the beads
    a: float


def draw_dragged(run, spec):
    parts = bed_run.holders(run, MARKED)
    views = [read_marked(part) for part in parts]
    windows = [marked_window(run, spec, view) for view in views]
    figure, axes_list = canvas.panel_grid(parts, max(np.ptp(y) / np.ptp(x) for x, y in windows), share=False)
    for axes, view, window in zip(axes_list, views, windows):
        canvas.window(axes, *window)
        paint_marked(axes, view, window)
        axes.set_facecolor("#f8f8f6")
        axes.tick_params(direction="out", top=False, right=False)
    canvas.label_panels(axes_list, parts, r"$x/a$", r"$y/a$", spec.title)
    for axes in axes_list:  # each has a window of its own
        axes.tick_params(labelbottom=True, labelleft=True)
    return figure


def read_marked(part):
    granular, path = part.granular, part.folder / MARKED
    number, *places = part.table(MARKED, "bead", "x0", "y0", "x1", "y1")
    with granular.trajectory(TRAJECTORY) as trajectory:
        frame = trajectory.frame(-1)
        source = trajectory.path
    number = number.astype(int)
    if number.min() < 0 or number.max() >= len(frame.beads):
        raise PlotError(f"{path}: marks bead {number.max()}, but {source} holds beads 0 to {len(frame.beads) - 1}")
    first, last = np.column_stack(places[:2]), np.column_stack(places[2:])
    return View(frame, *drifted(path, source, frame, number, first, last, granular.a), number, granular.a)


def drifted(path, source, frame, number, first, last, a):
    """The drift of the bed, which marked.csv leaves out, put back: both places as the stored frame has them."""
    box = frame.box / a
    away = frame.beads[number, :2] / a - last
    drift = away[0] + np.median((away - away[0] + box / 2) % box - box / 2, axis=0)
    off = (away - drift + box / 2) % box - box / 2
    if np.median(np.hypot(*off.T)) > 1.0:
        raise PlotError(f"{path}: its beads are not where the last frame of {source} has them: the two are not of the same run")
    return first + drift, last + drift + off


def marked_window(run, spec, view):
    asked = tuple(tuple(edge / view.a for edge in pair) for pair in (spec.x, spec.y))
    seen = np.concatenate([view.first, view.last])
    seen = np.concatenate([seen, *rods_near(view, seen)])
    return tuple(pair or (values.min() - MARKED_MARGIN, values.max() + MARKED_MARGIN) for pair, values in zip(asked, seen.T))


def rods_near(view, seen):
    """Spheres [n][2] of the rods that are not far from the marked beads, in the images nearest to them."""
    box, middle = view.frame.box / view.a, (seen.min(axis=0) + seen.max(axis=0)) / 2
    for rod in view.frame.rods:
        spheres = rod.spheres[:, :2] / view.a
        spheres = spheres - box * np.round((spheres.mean(axis=0) - middle) / box)
        if np.all(np.abs(spheres.mean(axis=0) - middle) < np.ptp(seen, axis=0) / 2 + NEAR):
            yield spheres


def paint_marked(axes, view, window):
    frame, a = view.frame, view.a
    others = np.ones(len(frame.beads), dtype=bool)
    others[view.marked] = False
    centres, index = with_images(frame.beads[others, :2] / a, frame.radii[others] / a, frame.box / a, window)
    bed.discs(axes, centres, frame.radii[others][index] / a, facecolors=PALE, edgecolors="#a5a5a0", linewidths=0.4)
    radii = frame.radii[view.marked] / a
    bed.discs(axes, view.last, radii, facecolors=PURPLE, edgecolors="white", linewidths=0.4, zorder=2.5)
    bed.rods_from_above(axes, frame, a, window)
    bed.discs(axes, view.first, radii, facecolors="none", edgecolors=PURPLE, linewidths=0.7, alpha=0.65, zorder=4.5)


def caption_dragged(run, spec):
    parts = bed_run.holders(run, MARKED)
    return ("The bed from above in the last stored frame, circles at true size. Purple: the beads that were near the rod in the first "
            "frame; rings: where they were then, moved along with the drift of the whole bed. "
            f"{canvas.describe_panels(parts, moved)}{bed_run.not_measured(run, MARKED)}")


def moved(part):
    view = read_marked(part)
    away = words.number(float(np.median(np.hypot(*(view.last - view.first).T))), 2)
    time = bed.clock(view.frame.time, view.frame.time)
    share = part.estimate("flow", "drag_share")
    text = f"{part.granular.which(TRAJECTORY)}<i>t</i> = {time} s: the {len(view.marked)} marked beads moved by {away} <i>a</i> (median)"
    return f"{text}; fraction of the rod's path by which they were carried along: {words.with_error(*share[:2])}." if share else text + "."


def is_dragged(run):
    """Frames are not kept of every measured run."""
    marked = [part for part in bed_run.parts_of(run) if part.has(MARKED)]
    return bool(marked) and all(part.has(SUMMARY) and part.granular.has_all_beads(TRAJECTORY) for part in marked)


KINDS = {
    "flow": Kind(draw=draw_flow, caption=caption_flow, there=lambda run: bed_run.some_hold(run, "flow")),
    "dragged": Kind(draw=draw_dragged, caption=caption_dragged, there=is_dragged),
}
