"""What the two maps of the field share: the window of the grid, the colour map, the rod."""

import math
from dataclasses import dataclass, replace

import numpy as np
from matplotlib import patheffects
from matplotlib.collections import LineCollection
from matplotlib.lines import Line2D

from . import canvas, style, words
from .errors import PlotError
from .schema import Kind, Spec


@dataclass(frozen=True)
class Grid:
    """The part of /field/grid inside a figure's window, in axis units."""
    x: np.ndarray
    y: np.ndarray
    crop: tuple
    xlabel: str
    ylabel: str

    @property
    def aspect(self):
        return np.ptp(self.y) / np.ptp(self.x)


def grid_of(result, spec):
    x, y = result.grid("x"), result.grid("y")
    columns, rows = _inside(x, spec.x), _inside(y, spec.y)
    extent = max(np.abs(x[columns]).max(), np.abs(y[rows]).max())
    xs, ys = result.units.length("x", extent), result.units.length("y", extent)
    return Grid(x[columns] * xs.factor, y[rows] * ys.factor, np.ix_(rows, columns), xs.label, ys.label)


def _inside(values, window):
    found = np.arange(values.size)
    if window:
        found = np.flatnonzero((values >= window[0]) & (values <= window[1]))
    if found.size < 8:
        raise PlotError("fewer than 8 grid points inside the window")
    return found


def paint(axes, grid, values, norm):
    """The colour map; the masked singular point takes the colour of the top."""
    filled = np.where(np.isfinite(values), np.clip(values, norm.vmin, None), norm.vmax)
    image = axes.pcolormesh(grid.x, grid.y, filled, norm=norm, cmap=style.FIELD_MAP, shading="gouraud", rasterized=True)
    canvas.window(axes, (grid.x[0], grid.x[-1]), (grid.y[0], grid.y[-1]))
    axes.set_xlabel(grid.xlabel)
    axes.tick_params(direction="out", top=False, right=False)
    return image


def draw_rod(axes, grid):
    if grid.x[0] < 0 < grid.x[-1] and grid.y[0] < 0 < grid.y[-1]:
        canvas.rod_at_origin(axes)


def heading_of(run, title):
    """The title asked for, else the medium's numbers."""
    medium = run.result.attributes("/medium")
    return style.safe(title) or ",  ".join(f"${run.result.units.parameter(key, medium[key], 3)}$" for key in ("eta", "alpha") if key in medium)


def medium_note(run):
    """The medium's numbers for a caption."""
    medium, units = run.result.attributes("/medium"), run.result.units
    unit = {"xi": units.length_html()}
    parts = [words.equation(words.symbol(key), medium[key], unit.get(key, "")) for key in ("eta", "alpha", "xi") if key in medium]
    return ", ".join(parts) + "." if parts else ""


# Extensional principal axis of the traceless strain over its positive eigenvalue (paper, Fig. attraction a).

SEGMENTS_ACROSS = 25


def draw_extensional_axis(run, spec):
    result = run.result
    grid = grid_of(result, spec)
    angle, value = (result.grid(name)[grid.crop] for name in ("axis_angle", "axis_value"))
    norm, extend = canvas.log_norm(value)
    figure = canvas.figure(style.SINGLE + 0.4, max(style.SINGLE * grid.aspect, 1.6) + 0.6)
    axes = figure.subplots()
    image = paint(axes, grid, value, norm)
    axes.add_collection(segments(grid, angle))
    draw_rod(axes, grid)
    axes.set_ylabel(grid.ylabel)
    canvas.heading(axes, heading_of(run, spec.title))
    canvas.colour_bar(figure, image, axes, r"extensional eigenvalue $\varepsilon_{+}$", extend=extend, pad=0.02, aspect=25)
    return figure


def segments(grid, angle):
    """Headless marks on a square lattice, left out where the rod is drawn."""
    step = grid.x[1] - grid.x[0]
    pitch = max(1, round(np.ptp(grid.x) / SEGMENTS_ACROSS / step)) * step
    x, y, angle = (part.ravel() for part in decimated(grid, angle, pitch))
    kept = np.isfinite(angle) & (np.hypot(x, y) > 0.8 * pitch)
    half = 0.36 * pitch * np.stack([np.cos(angle), np.sin(angle)], axis=-1)[kept]
    middle = np.stack([x, y], axis=-1)[kept]
    edge = patheffects.withStroke(linewidth=1.7, foreground="#00000080")
    ends = np.stack([middle - half, middle + half], axis=1)
    return LineCollection(ends, colors="white", linewidths=0.95, capstyle="round", path_effects=[edge])


def decimated(grid, angle, pitch):
    """The grid points nearest to a lattice of the given pitch, through the origin if it is in view."""
    columns, rows = (nearest(axis, pitch) for axis in (grid.x, grid.y))
    x, y = np.meshgrid(grid.x[columns], grid.y[rows])
    return x, y, angle[np.ix_(rows, columns)]


def nearest(axis, pitch):
    steps = np.arange(np.ceil(axis[0] / pitch + 0.4), np.floor(axis[-1] / pitch - 0.4) + 1) * pitch
    return np.unique([np.abs(axis - step).argmin() for step in steps])


def caption_extensional_axis(run, spec):
    return ("Strain around one rod at the origin that heads along +<i>x</i>. Segments: extensional principal axis of the "
            "traceless strain, along which a second rod turns for <i>κ</i> > 0. Colour, log scale: its positive eigenvalue. "
            + medium_note(run))


# Streamlines of gamma1 lap u + gamma2 grad div u over its magnitude (paper, Fig. 10), a panel per pair.

STREAMLINES = 0.85  # density of streamlines; 1 is matplotlib's 30 across


def draw_polar_streamlines(run, spec):
    grid = grid_of(run.result, spec)
    fields = [polar_field(run.result, grid, *pair) for pair in spec.gammas]
    norm, extend = canvas.log_norm(*(np.hypot(*vector) for vector in fields))
    figure, panels = streamline_panels(grid, len(fields))
    for index, (axes, pair, vector) in enumerate(zip(panels, spec.gammas, fields)):
        image = streamline_panel(axes, grid, vector, norm)
        letter = rf"{words.letter(index)}  " if len(fields) > 1 else ""
        canvas.heading(axes, letter + pair_label(*pair))
    label = rf"$|\gamma_1\nabla^2\mathbf{{u}}+\gamma_2\nabla\nabla\cdot\mathbf{{u}}|$  (${run.result.units.gradient_unit()}$)"
    canvas.colour_bar(figure, image, panels, label, extend=extend, **bar_place(panels, grid))
    figure.suptitle(heading_of(run, spec.title), fontsize=10.5)
    return figure


def bar_place(panels, grid):
    """Beside the panels, or below them where they are too low for the label."""
    rows = panels[0].get_subplotspec().get_gridspec().nrows
    if rows == 1 and len(panels) > 1 and grid.aspect < 0.8:
        return dict(location="bottom", shrink=0.6, aspect=40, pad=0.04)
    return dict(pad=0.015, aspect=25 * rows)


def polar_field(result, grid, gamma1, gamma2):
    lap, grad = (("lapx", "lapy"), ("gradx_tr", "grady_tr"))
    return tuple(gamma1 * result.grid(l)[grid.crop] + gamma2 * result.grid(g)[grid.crop] for l, g in zip(lap, grad))


def streamline_panels(grid, count):
    columns = min(count, 3 if grid.aspect > 0.45 else 2 if grid.aspect > 0.25 else 1)
    if count % columns:  # no lone panel beside a hole if two columns come out even
        columns = next(c for c in (columns, 2, 1) if c <= columns and (count % c == 0 or c == 1))
    rows = math.ceil(count / columns)
    width = style.WIDE if columns > 1 else style.SINGLE
    height = rows * ((width - 1.2) / columns * grid.aspect + 0.45) + (0.9 if grid.aspect < 0.8 else 0.3)
    figure = canvas.figure(width, height)
    axes = figure.subplots(rows, columns, squeeze=False, sharex=True, sharey=True)
    for row in axes:
        row[0].set_ylabel(grid.ylabel)
    return figure, list(axes.ravel())


def streamline_panel(axes, grid, vector, norm):
    magnitude = np.hypot(*vector)
    image = paint(axes, grid, magnitude, norm)
    # Unit vectors: the integrator's step follows the length, which spans decades here.
    with np.errstate(invalid="ignore", divide="ignore"):
        unit = [np.ma.masked_invalid(part / magnitude) for part in vector]
    # Recomputed axes: streamplot wants them evenly spaced to the last bit.
    x, y = (np.linspace(axis[0], axis[-1], axis.size) for axis in (grid.x, grid.y))
    axes.streamplot(x, y, *unit, color="white", linewidth=0.75, arrowsize=0.7, arrowstyle="-|>",
                    density=streamline_density(grid), minlength=0.2)
    canvas.window(axes, (grid.x[0], grid.x[-1]), (grid.y[0], grid.y[-1]))  # streamplot rescales
    draw_rod(axes, grid)
    axes.label_outer()
    return image


def streamline_density(grid):
    """Lines as dense along x as along y on paper."""
    return tuple(STREAMLINES * part for part in ((1.0, grid.aspect) if grid.aspect < 1 else (1.0 / grid.aspect, 1.0)))


def pair_label(gamma1, gamma2):
    return rf"$\gamma_1/v_0={words.math_number(gamma1)},\ \gamma_2/v_0={words.math_number(gamma2)}$"


def caption_polar_streamlines(run, spec):
    return ("Streamlines of <i>γ</i><sub>1</sub>∇²<b>u</b> + <i>γ</i><sub>2</sub>∇∇·<b>u</b> around one rod at the origin that "
            "heads along +<i>x</i>, over its magnitude (colour, log scale). " + medium_note(run))


# The displacement along a line (paper, Fig. ufield b, d, e).

ASYMPTOTE = dict(linewidth=1.0, linestyle=(0, (5, 3)))
CORE = 0.012  # of the window: the limits ignore what is nearer to the singular point


def draw_cut(run, spec):
    figure = canvas.figure(style.SINGLE, 2.9)
    paint_cut(figure.subplots(), run, spec)
    return figure


def paint_cut(axes, run, spec):
    cut = run.result.cut(spec.cut)
    kept = inside_cut(cut, spec)
    s, values = cut.s[kept], scaled(cut, spec)[kept]
    axis, value_axis = axes_of(run.result.units, cut, spec, s, values)
    s, values = s * axis.factor, values * value_axis.factor
    axes.axhline(0, color=style.GREY, linewidth=0.6)
    axes.plot(*broken_at_rod(cut, s, values), color=style.LINE)
    axes.set(xlim=(s.min(), s.max()), ylim=cut_limits(cut, spec, s, values), xlabel=axis.label, ylabel=value_axis.label)
    if tail := asymptote(run, cut, spec):
        draw_tail(axes, s[s < 0], tail(s[s < 0] / axis.factor) * value_axis.factor)
    mark_rod(axes, cut, s)
    canvas.heading(axes, style.safe(spec.title))
    note_line(run.result.units, axes, cut, free_corner(s, values, axes.get_ylim()[1]), medium_lines(run))


def in_units(cut, scale):
    """The cut with lengths and displacements times this."""
    return replace(cut, s=scale * cut.s, at=scale * cut.at, Ux=scale * cut.Ux, Uy=scale * cut.Uy)


def inside_cut(cut, spec):
    window = spec.x if cut.along == "x" else spec.y
    if not window:
        return np.ones(cut.s.size, dtype=bool)
    kept = (cut.s >= window[0]) & (cut.s <= window[1])
    if kept.sum() < 2:
        raise PlotError(f"the window holds no point of cut {spec.cut}")
    return kept


def scaled(cut, spec):
    values = getattr(cut, spec.component)
    values = np.where(np.isfinite(values), values, np.nan)  # a point on the rod itself
    return np.sqrt(np.abs(cut.s)) * values if spec.sqrt_scaled else values


def axes_of(units, cut, spec, s, values):
    extent = np.abs(s).max()
    axis = units.length(cut.along, extent)
    symbol = f"U_{spec.component[1]}"
    size = np.nanpercentile(np.abs(values[np.isfinite(values)]), 98) if np.isfinite(values).any() else 1.0
    if spec.sqrt_scaled:
        return axis, units.root_length(rf"|{cut.along}|^{{1/2}}\,{symbol}", extent, size)
    return axis, units.length(symbol, size)


def asymptote(run, cut, spec):
    """What |x|^(1/2) U_x tends to far behind the rod, a function of x < 0: (xi/pi)^(1/2)/2 exp(-y^2/4 xi |x|) (docs/theory.md, Eq. 16)."""
    xi = run.result.attributes("/medium").get("xi")
    if not (spec.sqrt_scaled and spec.component == "Ux" and cut.along == "x" and cut.s.min() < 0 and xi):
        return None
    return lambda x: 0.5 * np.sqrt(xi / np.pi) * np.exp(-cut.at ** 2 / (4 * xi * np.abs(x)))


def draw_tail(axes, far, values):
    axes.plot(far, values, color=style.OTHERS[0], **ASYMPTOTE)
    axes.annotate(r"$\frac{1}{2}\,(\xi/\pi)^{1/2}$", (far[0], values[0]), (4, 3), textcoords="offset points", va="bottom", fontsize=9,
                  color=style.OTHERS[0])
    axes.set_ylim(top=max(axes.get_ylim()[1], 1.2 * values.max()))


def through_rod(cut):
    return cut.at == 0 and cut.s.min() < 0 < cut.s.max()


def broken_at_rod(cut, s, values):
    """No line across the singular point: the two branches are not joined."""
    if not through_rod(cut):
        return s, values
    split = np.searchsorted(s, 0.0)
    return np.insert(s, split, 0.0), np.insert(values, split, np.nan)


def cut_limits(cut, spec, s, values):
    singular = through_rod(cut) and not spec.sqrt_scaled
    trusted = np.abs(s) > CORE * np.ptp(s) if singular else np.ones(s.size, dtype=bool)
    return canvas.linear_limits(values, trusted, below=0.15 if cut.along == "x" else 0.06)  # room for words


def mark_rod(axes, cut, s):
    """Where the rod is and, along its path, which side is which."""
    if not s.min() < 0 < s.max():
        return
    axes.axvline(0, color=style.GREY, linewidth=0.6, linestyle=(0, (4, 3)))
    if cut.along != "x":
        return
    look = dict(textcoords="offset points", color=style.GREY, fontsize=9, xycoords=axes.get_xaxis_transform(), va="bottom")
    axes.annotate("behind", (0, 0.03), (-6, 0), ha="right", **look)
    axes.annotate("ahead", (0, 0.03), (6, 0), ha="left", **look)


def free_corner(s, values, top):
    """The upper one of the side on which the curve is lower, its middle third apart, where the rod is; half-way up if it is high there."""
    third = np.ptp(s) / 3
    left, right = (np.nanmax(values[side], initial=-np.inf) for side in (s < s.min() + third, s > s.max() - third))
    return ("center" if 0.7 * top < min(left, right) < top else "upper") + (" left" if left < right else " right")


def note_line(units, axes, cut, corner, more=()):
    """The fixed coordinate and the medium."""
    other = "y" if cut.along == "x" else "x"
    axis = units.length(other, abs(cut.at))
    note(axes, [units.equals(axis, other, cut.at), *more], corner)


def note(axes, lines, corner):
    """A legend without a handle."""
    found = axes.legend([Line2D([], [], linewidth=0)], ["\n".join(lines)], loc=corner, frameon=False, handlelength=0, handletextpad=0, fontsize=9)
    found.get_texts()[0].set_linespacing(1.4)


def medium_lines(run):
    return list(filter(None, [heading_of(run, "")]))


def caption_cut(run, spec, at=""):
    """`at`: the fixed coordinate, where it is shown in other units."""
    cut, units = run.result.cut(spec.cut), run.result.units
    other = "y" if cut.along == "x" else "x"
    what = f"<i>U<sub>{spec.component[1]}</sub></i>"
    point = at or words.equation(f"<i>{other}</i>", cut.at, units.length_html() if cut.at else "")
    text = (f"Displacement {what} of the medium along <i>{cut.along}</i> at {point}, "
            f"one rod at the origin heading along +<i>x</i>. ")
    if spec.sqrt_scaled:
        text = text.replace("Displacement ", f"|<i>{cut.along}</i>|<sup>1/2</sup>", 1)
        text += f"A level stretch is a fall-off as |<i>{cut.along}</i>|<sup>−1/2</sup>. "
        if asymptote(run, cut, spec):
            text += "Broken: the limit far behind the rod, ½ (<i>ξ</i>/π)<sup>1/2</sup>, for any <i>η</i>. "
    elif through_rod(cut):
        text += "The point force at the origin is logarithmically singular; the range leaves it out. "
    return text + medium_note(run)


def defaults_cut(run):
    return [Spec(f"cut{index}_{part}", "cut", cut=index, component=part) for index in range(run.result.cut_count())
            for part in components(run.result.cut(index))]


def defaults_polar_streamlines(run):
    """Each coupling by itself, and both as opposites."""
    gammas = ((1.0, 0.0), (0.0, 1.0), (1.0, -1.0))
    return [Spec("polar_streamlines", "polar_streamlines", gammas=gammas)] if run.result.has("/field/grid") else []


def components(cut):
    """U_y vanishes on the rod's own axis: no figure for a zero line."""
    return ("Ux",) if cut.along == "x" and cut.at == 0 else ("Ux", "Uy")


KINDS = {
    "extensional_axis": Kind(draw=draw_extensional_axis, caption=caption_extensional_axis, there=lambda run: run.result.has("/field/grid")),
    "polar_streamlines": Kind(draw=draw_polar_streamlines, caption=caption_polar_streamlines, defaults=defaults_polar_streamlines),
    "cut": Kind(draw=draw_cut, caption=caption_cut, defaults=defaults_cut),
}
