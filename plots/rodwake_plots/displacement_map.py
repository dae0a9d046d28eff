"""The measured displacement of the beads around the rod: its size or a component by colour, and arrows."""

import numpy as np
from matplotlib.colors import Normalize
from matplotlib.patches import Rectangle

from . import canvas, measured, panels, profile, ranges, rod_outline, style
from .errors import PlotError
from .measured import FIELDS
from .spec import Spec

ARROWS = 22, 15  # across the window of one panel, of several
LABELS = {"U": r"$|U|/a$", "Ux": r"$U_x/a$", "Uy": r"$U_y/a$"}
WORDS = {"U": "size |<b>U</b>|", "Ux": "<i>U<sub>x</sub></i>", "Uy": "<i>U<sub>y</sub></i>"}


def draw(run, spec):
    parts = measured.holders(run, FIELDS, "displacement")
    fields = [read(part, run, spec) for part in parts]
    window = tuple((min(field[axis][0] for field in fields), max(field[axis][-1] for field in fields)) for axis in (0, 1))
    figure, axes_list = panels.grid(parts, np.ptp(window[1]) / np.ptp(window[0]), bar=0.8)
    norm, extend = scale([colour_values(spec, U) for _, _, U in fields], spec.component)
    longest = max(np.nanpercentile(np.abs(U), 97) for _, _, U in fields) or 1.0
    for axes, (x, y, U) in zip(axes_list, fields):
        blank(axes, window)
        image = axes.pcolormesh(x, y, colour_values(spec, U), norm=norm, cmap=colour_map(spec), shading="nearest", rasterized=True,
                                zorder=1)
        drawn = arrows(axes, x, y, U, longest, ARROWS[len(parts) > 1])
        arrow_key(axes, drawn, longest)
        canvas.window(axes, *window)
        rod_outline.draw(axes, run)
        axes.tick_params(direction="out", top=False, right=False)
    panels.label(axes_list, parts, r"$x/a$", r"$y/a$", spec.title)
    bar = figure.colorbar(image, ax=axes_list, extend=extend, extendfrac=0.03, pad=0.015, aspect=32)
    bar.set_label(LABELS[spec.component])
    bar.ax.tick_params(direction="in")
    return figure


def read(part, run, spec):
    """x, y and complex U in the window; nan where no bead was seen."""
    x, y, Ux, Uy, count = part.grid("displacement", "Ux", "Uy", "count")
    U = np.where(count > 0, Ux + 1j * Uy, complex(np.nan, np.nan))  # nan alone would leave U_y 0
    columns, rows = (measured.inside(values, asked, run.granular.a) for values, asked in ((x, spec.x), (y, spec.y)))
    U = U[np.ix_(rows, columns)]
    if columns.sum() < 2 or rows.sum() < 2 or not np.isfinite(U).any():
        raise PlotError(f"{part.folder / FIELDS}: /displacement has no bin with beads inside the window: nothing to draw")
    return x[columns], y[rows], U


def colour_values(spec, U):
    return {"U": np.abs, "Ux": np.real, "Uy": np.imag}[spec.component](U)


def colour_map(spec):
    return style.FIELD_MAP if spec.component == "U" else "RdBu_r"


def scale(values, component):
    """Single bins next to the rod do not set it."""
    values = np.concatenate([part[np.isfinite(part)] for part in values])
    top = np.percentile(np.abs(values), 99.5) or 1.0
    above, below = bool((values > top).any()), bool((values < -top).any())
    extend = {(0, 0): "neither", (1, 0): "max", (0, 1): "min", (1, 1): "both"}[above, below]
    return Normalize(0 if component == "U" else -top, top), extend


def blank(axes, window):
    """What shows where no bead was seen."""
    (left, right), (bottom, top) = window
    axes.add_patch(Rectangle((left, bottom), right - left, top - bottom, facecolor="white", edgecolor="#bbbbbb", hatch="////",
                             linewidth=0, zorder=0))


def arrows(axes, x, y, U, longest, across):
    """Every few bins, as long as U but no longer than the way to the next one."""
    step = max(1, round(max(len(x), len(y)) / across))
    columns, rows = (np.arange((len(values) // 2) % step, len(values), step) for values in (x, y))  # one row runs through the rod
    x, y, U = x[columns], y[rows], U[np.ix_(rows, columns)] / longest
    U = U / np.maximum(np.abs(U), 1)
    spacing = abs(x[1] - x[0]) if len(x) > 1 else 1.0
    seen = np.isfinite(U)
    where = np.nonzero(seen)
    return axes.quiver(x[where[1]], y[where[0]], U[seen].real, U[seen].imag, pivot="middle", angles="xy", units="xy", scale_units="xy",
                scale=1 / spacing, width=0.11 * spacing, headwidth=3.6, headlength=4, headaxislength=3.6, minlength=0.4, color="white",
                edgecolor="black", linewidth=0.35, zorder=3)


def arrow_key(axes, drawn, longest):
    """How long an arrow is, over the right end of the panel."""
    size = ranges.nice(longest, up=False)
    axes.set_title(" ", loc="right", pad=6)  # keeps room: the layout does not see a key
    axes.quiverkey(drawn, 0.99, 1.035, size / longest, rf"$|U| = {size:g}\,a$", labelpos="W", labelsep=0.05, coordinates="axes",
                   fontproperties={"size": 9})


def caption(run, spec):
    parts = measured.holders(run, FIELDS, "displacement")
    who = rod_outline.who(run)
    drawn = "The rod is drawn to scale" if who == "rod" else "Circle: one width of the force around its centre"
    return (f"Measured displacement <b>U</b> of the beads in the frame of the {who}, which {'heads' if who == 'rod' else 'points'} along +<i>x</i>: colour, "
            f"{WORDS[spec.component]}; arrows, <b>U</b>, the largest ones cut to the distance between arrows. Hatched: no bead was seen "
            f"there. {drawn}. {profile.how(parts[0])}{measured.not_measured(run, FIELDS, 'displacement')}")


def defaults(run):
    return [Spec("displacement_map", "displacement_map", component="U")] if measured.some_hold(run, "displacement") else []
