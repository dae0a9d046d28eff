"""Mean velocity of the beads as seen from a rod: arrows of unit length, coloured by speed (paper, Figs. bead_drag a, c)."""

from typing import NamedTuple

import numpy as np
from matplotlib.colors import LogNorm, Normalize

from . import canvas, measured, panels, ranges, rod_outline, style, words
from .errors import PlotError
from .measured import FIELDS
from .spec import Spec

NAMES = ("vx", "vy", "sigma_x", "sigma_y", "count")
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


def draw(run, spec):
    parts = measured.holders(run, FIELDS, "flow")
    across = MOST_ARROWS[len(parts) > 2]
    fields = [read(part, run, spec, across) for part in parts]
    window = tuple((min(getattr(field, name).min() for field in fields), max(getattr(field, name).max() for field in fields))
                   for name in ("x", "y"))
    figure, axes_list = panels.grid(parts, np.ptp(window[1]) / np.ptp(window[0]), bar=0.8)
    norm, extend = scale(fields)
    for axes, field in zip(axes_list, fields):
        canvas.window(axes, *window)
        arrows(axes, field, field.clear, norm, 1.0)
        image = arrows(axes, field, ~field.clear, norm, 0.45)
        rod_outline.draw(axes, run)
        axes.tick_params(direction="out", top=False, right=False)
    panels.label(axes_list, parts, r"$x/a$", r"$y/a$", spec.title)
    bar(figure, image, axes_list, norm, extend)
    return figure


def bar(figure, image, axes_list, norm, extend):
    label, place = r"mean speed ($\mathrm{mm/s}$)", dict(pad=0.015, aspect=32)
    if isinstance(norm, LogNorm):
        ranges.log_bar(figure, image, axes_list, extend, label, **place)
        return
    made = figure.colorbar(image, ax=axes_list, extend=extend, extendfrac=0.03, **place)
    made.set_label(label)
    made.ax.tick_params(direction="in")


def read(part, run, spec, across):
    x, y, vx, vy, sigma_x, sigma_y, count = part.grid("flow", *NAMES)
    columns, rows = (measured.inside(values, asked, run.granular.a) for values, asked in ((x, spec.x), (y, spec.y)))
    step = max(1, int(np.ceil(max(columns.sum(), rows.sum()) / across)))
    crop = np.ix_(rows, columns)
    factor = measured.mm_per_s(run)
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
        return ranges.log_norm(speeds)
    return Normalize(0, top), "max" if (speeds > top).any() else "neither"


def arrows(axes, field, which, norm, part):
    """`part` of the full width."""
    rows, columns = np.nonzero(which & np.isfinite(field.v) & (field.speed > 0))
    v = field.v[rows, columns]
    spacing = field.x[1] - field.x[0] if field.x.size > 1 else 1.0
    return axes.quiver(field.x[columns], field.y[rows], (v / np.abs(v)).real, (v / np.abs(v)).imag, np.abs(v), norm=norm,
                       cmap=style.FIELD_MAP, pivot="middle", angles="xy", units="xy", scale_units="xy", scale=1 / (0.85 * spacing),
                       width=0.13 * spacing * part, headwidth=4, headlength=4.5, headaxislength=4, minlength=0, zorder=3)


def caption(run, spec):
    parts = measured.holders(run, FIELDS, "flow")
    text = ("Direction of the beads' mean velocity in the frame that moves and turns with the rod, thin end towards +<i>x</i>, and by "
            f"colour its size; thin arrows: less than {SIGNIFICANT:g} standard errors. Beads at rest in the box have velocity 0. The rod "
            f"is drawn to scale. {panels.told(parts, near)}").rstrip()
    return text + measured.not_measured(run, FIELDS, "flow")


def near(part):
    speed = part.number("flow", "near_speed")
    return "" if speed is None else f"Mean speed within 6 <i>a</i> of the rod: {words.number(1e3 * part.granular.a * float(speed), 3)} mm/s."


def defaults(run):
    return [Spec("flow", "flow")] if measured.some_hold(run, "flow") else []
