"""Measured displacement along a line of the rod's frame (paper, Figs. ufield a, c, e)."""

import numpy as np

from . import canvas, curves, fit_panel, fit_words, measured, rod_outline, style, words
from .errors import PlotError
from .spec import Spec

THEORY = fit_panel.COMPARED[0]


def file_of(spec):
    return f"profile_{spec.component}_{spec.along}.csv"


def line_of(run, spec):
    """The fixed coordinate, a: beside the rod for U_y along x, which vanishes on the axis."""
    if (spec.component, spec.along) != ("Uy", "x"):
        return 0.0
    asked = run.scene.get("measure", {}).get("profile_offset")
    return asked / run.granular.a if words.is_number(asked) else 4.0


def draw(run, spec):
    parts = measured.holders(run, file_of(spec))
    figure, axes = curves.panel(len(parts))
    paint(axes, run, spec, parts)
    return figure


def paint(axes, run, spec, parts):
    rod_outline.shade(axes, run, spec.along)
    axes.axhline(0, color=style.GREY, linewidth=0.6, zorder=1)
    several = len(parts) > 1
    for index, (part, colour) in enumerate(zip(parts, curves.colours(len(parts)))):
        place, value, sigma = read(run, spec, part)
        curves.points(axes, place, value, sigma, colour, part.label or None, curves.mark(index) if several else "o",
                      markersize=3.0 if several else 3.4)
    theory(axes, run, spec)
    window = window_of(run, spec)
    axes.set(xlabel=rf"${spec.along}/a$", ylabel=ylabel(spec))
    if window:
        axes.set_xlim(*window)
    else:
        axes.margins(x=0.01)
    low, high = axes.get_ylim()
    axes.set_ylim(low - 0.06 * (high - low), high)  # room for words
    curves.legend(axes)
    canvas.heading(axes, style.safe(spec.title))
    note_line(axes, run, spec)


def fitted(run, spec):
    """What a fit of this run knows of the line; None without one."""
    for one in run.fit.profiles if run.has_fit and run.fit.unit == "a" else ():
        if (one.get("component"), one.get("along"), one.get("at")) == (spec.component, spec.along, line_of(run, spec)):
            return fit_panel.View(one, run.fit.points(one), run.fit.curve(one))
    return None


def theory(axes, run, spec):
    """The curve of the theory with the fitted parameters, which does not set the range."""
    view = fitted(run, spec)
    if not view:
        return
    axes.set_ylim(*axes.get_ylim())
    x, model = fit_panel.broken(run.fit, view, view.curve.model)
    factor = np.sqrt(np.abs(x)) if spec.sqrt_scaled else 1.0
    fit_panel.line(axes, run.fit, x, factor * model, color=THEORY, linewidth=1.4, zorder=2)
    axes.plot([], [], color=THEORY, label=f"theory, {told_of(view)}")


def told_of(view):
    return "predicted" if fit_words.predicted(view.profile) else "fitted"


def read(run, spec, part):
    """(place, U, its error) in a inside the window, each U times |place|^(1/2) if asked for."""
    place, value, sigma, count = part.table(file_of(spec), "x", "value", "sigma", "count")
    window = window_of(run, spec) or (-np.inf, np.inf)
    kept = (count > 0) & ~((place == 0) & spec.sqrt_scaled) & np.isfinite(value) & (place >= window[0]) & (place <= window[1])
    if not kept.any():
        raise PlotError(f"{part.folder / file_of(spec)}: holds no bin with beads inside the window: nothing to draw")
    factor = np.sqrt(np.abs(place[kept])) if spec.sqrt_scaled else np.ones(kept.sum())
    return place[kept], factor * value[kept], factor * measured.known(sigma[kept])


def window_of(run, spec):
    return tuple(edge / run.granular.a for edge in (spec.x if spec.along == "x" else spec.y))


def ylabel(spec):
    symbol = f"U_{spec.component[1]}"
    return rf"$|{spec.along}|^{{1/2}}\,{symbol}$ ($a^{{3/2}}$)" if spec.sqrt_scaled else f"${symbol}/a$"


def note_line(axes, run, spec):
    """The fixed coordinate in a corner above the frame; along the rod's path, which side is which."""
    other, at = ("y" if spec.along == "x" else "x"), line_of(run, spec)
    axes.annotate(f"${other} = {words.math_number(at)}" + (r"\,a$" if at else "$"), (1, 1), (0, 3), xycoords="axes fraction",
                  textcoords="offset points", ha="right", va="bottom", fontsize=9)
    if spec.along == "x":
        x, _ = rod_outline.outline(run)
        look = dict(textcoords="offset points", xycoords=axes.get_xaxis_transform(), color=style.GREY, fontsize=8.5, va="bottom")
        left, right = axes.get_xlim()
        narrow = x[-1] - x[0] < 0.1 * (right - left)  # no room beside the word for what is in the middle
        axes.annotate("behind", (left if narrow else x[0], 0.02), (3 if narrow else -3, 0), ha="left" if narrow else "right", **look)
        axes.annotate("ahead", (right if narrow else x[-1], 0.02), (-3 if narrow else 3, 0), ha="right" if narrow else "left", **look)


def caption(run, spec):
    parts = measured.holders(run, file_of(spec))
    what = f"<i>U<sub>{spec.component[1]}</sub></i>"
    known = any(np.isfinite(read(run, spec, part)[2]).any() for part in parts)
    other, at = ("y" if spec.along == "x" else "x"), line_of(run, spec)
    text = (f"Measured displacement {what} of the beads along <i>{spec.along}</i> at "
            f"{words.equation(f'<i>{other}</i>', at, '<i>a</i>' if at else '')} in the frame of the {rod_outline.who(run)}, which heads along +<i>x</i>; "
            f"{'bars: standard error' if known else 'the error is unknown'}; shaded: {rod_outline.shaded(run)}. ")
    if view := fitted(run, spec):
        how_made = "predicted with what was fitted to other lines" if fit_words.predicted(view.profile) else "fitted to it"
        text += f"Line: theory {how_made}, thin within {words.number(run.fit.number(run.fit.told, 'core', 0.0))} <i>a</i> of the rod, where data are left out. "
    if spec.sqrt_scaled:
        text = text.replace("displacement ", f"|<i>{spec.along}</i>|<sup>1/2</sup>", 1)
        text += f"A level stretch is a fall-off as |<i>{spec.along}</i>|<sup>−1/2</sup>. "
    return text + how(parts[0]) + measured.not_measured(run, file_of(spec))


def how(part):
    """Estimator and reference, for this caption and the map's."""
    method, reference = part.told("displacement", "method"), part.told("displacement", "reference")
    blocks = part.number("displacement", "blocks")
    if not method:
        return ""
    text = f"Estimator: {words.escape(method)}"
    text += {"box": ", relative to the mean over the box", "far": ", relative to the far field"}.get(reference, "")
    return text + (f"; {words.number(blocks)} block{'' if blocks == 1 else 's'} of time." if blocks else ".")


def defaults(run):
    specs = [Spec(f"profile_{component}_{along}", "profile", component=component, along=along) for component in ("Ux", "Uy")
             for along in ("x", "y")]
    specs.append(Spec("profile_Ux_x_scaled", "profile", sqrt_scaled=True))
    return [spec for spec in specs if measured.some(run, file_of(spec))]
