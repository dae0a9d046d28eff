"""The displacement along a line (paper, Fig. ufield b, d, e)."""

import numpy as np
from matplotlib.lines import Line2D

from . import canvas, field_map, ranges, style, words
from .errors import PlotError
from .spec import Spec

ASYMPTOTE = dict(color="#d55e00", linewidth=1.0, linestyle=(0, (5, 3)))
CORE = 0.012  # of the window: the limits ignore what is nearer to the singular point


def draw(run, spec):
    figure = canvas.figure(style.SINGLE, 2.9)
    paint(figure.subplots(), run, spec)
    return figure


def paint(axes, run, spec):
    cut = run.result.cut(spec.cut)
    kept = inside(cut, spec)
    s, values = cut.s[kept], scaled(cut, spec)[kept]
    axis, value_axis = axes_of(run.result.units, cut, spec, s, values)
    s, values = s * axis.factor, values * value_axis.factor
    axes.axhline(0, color=style.GREY, linewidth=0.6)
    axes.plot(*broken_at_rod(cut, s, values), color=style.LINE)
    axes.set(xlim=(s.min(), s.max()), ylim=limits(cut, spec, s, values), xlabel=axis.label, ylabel=value_axis.label)
    if tail := asymptote(run, cut, spec):
        draw_tail(axes, s[s < 0], tail(s[s < 0] / axis.factor) * value_axis.factor)
    mark_rod(axes, cut, s)
    canvas.heading(axes, style.safe(spec.title))
    note_line(run.result.units, axes, cut, free_corner(s, values, axes.get_ylim()[1]), medium_lines(run))


def inside(cut, spec):
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
    """What |x|^(1/2) U_x tends to far behind the rod, a function of x < 0: (xi/pi)^(1/2)/2 exp(-y^2/4 xi |x|) (docs/physics.md, Eq. 16)."""
    xi = run.result.attributes("/medium").get("xi")
    if not (spec.sqrt_scaled and spec.component == "Ux" and cut.along == "x" and cut.s.min() < 0 and xi):
        return None
    return lambda x: 0.5 * np.sqrt(xi / np.pi) * np.exp(-cut.at ** 2 / (4 * xi * np.abs(x)))


def draw_tail(axes, far, values):
    axes.plot(far, values, **ASYMPTOTE)
    axes.annotate(r"$\frac{1}{2}\,(\xi/\pi)^{1/2}$", (far[0], values[0]), (4, 3), textcoords="offset points", va="bottom", fontsize=9,
                  color=ASYMPTOTE["color"])
    axes.set_ylim(top=max(axes.get_ylim()[1], 1.2 * values.max()))


def through_rod(cut):
    return cut.at == 0 and cut.s.min() < 0 < cut.s.max()


def broken_at_rod(cut, s, values):
    """No line across the singular point: the two branches are not joined."""
    if not through_rod(cut):
        return s, values
    split = np.searchsorted(s, 0.0)
    return np.insert(s, split, 0.0), np.insert(values, split, np.nan)


def limits(cut, spec, s, values):
    singular = through_rod(cut) and not spec.sqrt_scaled
    trusted = np.abs(s) > CORE * np.ptp(s) if singular else np.ones(s.size, dtype=bool)
    return ranges.linear_limits(values, trusted, below=0.15 if cut.along == "x" else 0.06)  # room for words


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
    """The fixed coordinate and the medium: a legend without a handle."""
    other = "y" if cut.along == "x" else "x"
    axis = units.length(other, abs(cut.at))
    text = units.equals(axis, other, cut.at)
    note = axes.legend([Line2D([], [], linewidth=0)], ["\n".join([text, *more])], loc=corner, frameon=False, handlelength=0, handletextpad=0)
    note.get_texts()[0].set_linespacing(1.4)


def medium_lines(run):
    return list(filter(None, [field_map.heading_of(run, "")]))


def caption(run, spec):
    cut, units = run.result.cut(spec.cut), run.result.units
    other = "y" if cut.along == "x" else "x"
    what = f"<i>U<sub>{spec.component[1]}</sub></i>"
    point = words.equation(f"<i>{other}</i>", cut.at, units.length_html())
    text = (f"Displacement {what} of the medium along <i>{cut.along}</i> at {point}, "
            f"one rod at the origin heading along +<i>x</i>. ")
    if spec.sqrt_scaled:
        text = text.replace("Displacement ", f"|<i>{cut.along}</i>|<sup>1/2</sup>", 1)
        text += f"A level stretch is a fall-off as |<i>{cut.along}</i>|<sup>−1/2</sup>. "
        if asymptote(run, cut, spec):
            text += "Broken: the limit far behind the rod, ½ (<i>ξ</i>/π)<sup>1/2</sup>, whatever <i>η</i>. "
    elif through_rod(cut):
        text += "The point force at the origin is logarithmically singular; the range leaves it out. "
    return text + field_map.medium_note(run)


def defaults(run):
    return [Spec(f"cut{index}_{part}", "cut", cut=index, component=part) for index in range(run.result.cut_count())
            for part in components(run.result.cut(index))]


def components(cut):
    """U_y vanishes on the rod's own axis: no figure for a zero line."""
    return ("Ux",) if cut.along == "x" and cut.at == 0 else ("Ux", "Uy")
