"""The beads' pair correlation g(r); its first minimum is where neighbours end."""

import numpy as np

from . import bed_run, canvas, style, words
from .errors import PlotError
from .schema import Kind

GR = "gr.csv"
SHOWN = 20.0  # a


def draw_pair_correlation(run, spec):
    parts = bed_run.holders(run, GR)
    figure, axes = canvas.curve_panel(len(parts))
    axes.axhline(1, color=style.GREY, linewidth=0.6)
    window = window_of(run, spec)
    tops = [draw_one(axes, part, colour, window) for part, colour in zip(parts, canvas.colours(len(parts)))]
    for part, colour in zip(parts, canvas.colours(len(parts))) if len(parts) <= canvas.MOST_INSIDE else ():
        mark_minimum(axes, part, colour)
    axes.set(xlim=window or (0, min(SHOWN, axes.dataLim.x1)), ylim=(0, 1.08 * max(tops)), xlabel=r"$r/a$", ylabel=r"$g(r)$")
    canvas.legend(axes, loc="upper right" if len(parts) <= canvas.MOST_INSIDE else "center left")
    canvas.heading(axes, style.safe(spec.title))
    return figure


def window_of(run, spec):
    return tuple(edge / bed_run.bead_radius(run) for edge in spec.x)


def draw_one(axes, part, colour, window):
    """Returns the highest value shown."""
    r, g, sigma = part.table(GR, "r", "g", "sigma")
    shown = (r >= window[0]) & (r <= window[1]) if window else r <= SHOWN
    if not np.isfinite(g[shown]).any():
        raise PlotError(f"{part.folder / GR}: holds no r inside the window: nothing to draw")
    canvas.band(axes, r, g, bed_run.known_errors(sigma), colour, part.label)
    return np.nanmax(g[shown])


def mark_minimum(axes, part, colour):
    r, g = part.table(GR, "r", "g")
    minimum = part.number("order", "g_minimum")
    if minimum is not None:
        axes.annotate("", (minimum, np.interp(minimum, r, g)), (0, 20), textcoords="offset points", annotation_clip=True, zorder=4,
                      arrowprops=dict(arrowstyle="-|>", color=colour, linewidth=1.1, shrinkA=0, shrinkB=1))


def caption_pair_correlation(run, spec):
    parts = bed_run.holders(run, GR)
    text = ("Pair correlation <i>g</i>(<i>r</i>) of the beads: pairs at distance <i>r</i> relative to an ideal gas of the same density "
            "in the box; band: standard error. First minimum")
    minima = [(part, part.number("order", "g_minimum")) for part in parts]
    where = ", ".join(f"{words.number(value, 3)} <i>a</i>{of(part)}" for part, value in minima if value is not None)
    arrow = " (arrow)" if len(parts) <= canvas.MOST_INSIDE else ""
    return f"{text}{arrow}: {where or 'not found'}.{bed_run.not_measured(run, GR)}"


def of(part):
    return f" ({words.label_html(part.label)})" if part.label else ""


# Decay of the bond-orientational order g_B(r) on logarithmic axes (paper, Fig. hop b).

GB = "gB.csv"
LOWEST = 1e-3  # what is smaller is noise in any run that fits a disk


def draw_bond_order(run, spec):
    parts = bed_run.holders(run, GB)
    figure, axes = canvas.curve_panel(len(parts), 3.3)
    tables = [read(part) for part in parts]
    lowest = lowest_order(tables)
    for part, (r, g, sigma), colour in zip(parts, tables, canvas.colours(len(parts))):
        canvas.band(axes, r, g, sigma, colour, decay_label(part), lowest=lowest / 10)
    hexatic_guide(axes, tables)
    axes.set(xscale="log", yscale="log", ylim=(lowest, 1.3), xlabel=r"$r/a$", ylabel=r"$g_B(r)$")
    window = tuple(edge / bed_run.bead_radius(run) for edge in spec.x)
    axes.set_xlim(window or (min(r[0] for r, _, _ in tables), max(r[-1] for r, _, _ in tables)))
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_major_locator(canvas.LogLocator(subs=(1, 2, 5)))
        axis.set_major_formatter("{x:g}")
        axis.set_minor_formatter("")
    canvas.legend(axes, **(dict(loc="lower left") if len(parts) <= canvas.MOST_INSIDE else {}))
    canvas.heading(axes, style.safe(spec.title))
    return figure


def read(part):
    r, g, sigma = part.table(GB, "r", "gB", "sigma")
    kept = (r > 0) & np.isfinite(g)
    if not (g[kept] > 0).any():
        raise PlotError(f"{part.folder / GB}: holds no g_B > 0 at any r > 0: nothing to draw on a log scale")
    return r[kept], g[kept], bed_run.known_errors(sigma[kept])


def lowest_order(tables):
    """Under the smallest value that stands out from its error."""
    clear = np.concatenate([g[(g > 0) & ~(g < 2 * sigma)] for _, g, sigma in tables])
    least = clear.min() if clear.size else LOWEST
    return max(LOWEST, min(canvas.nice(0.7 * least, up=False), 0.5))


def hexatic_guide(axes, tables):
    """At the edge of the hexatic phase g_B falls as r^(-1/4); drawn over the curves."""
    left, right = min(r[0] for r, _, _ in tables), max(r[-1] for r, _, _ in tables)
    top = max(np.interp(left, r, g) for r, g, _ in tables)
    r = np.array([left, right])
    axes.plot(r, top * (r / left) ** -0.25, label=r"$r^{-1/4}$", **canvas.FAINT)


def decay_label(part):
    """The part's label and how its order decays."""
    kind = part.value("order", "class") or "not classified"
    exponent = part.estimate("order", "exponent")
    if kind == "algebraic" and exponent is not None:
        kind += rf", $\eta_6 = {exponent.value:.2g}$"
    return f"{part.label}: {kind}" if part.label else kind


def caption_bond_order(run, spec):
    parts = bed_run.holders(run, GB)
    reasons = " ".join(reason(part) for part in parts)
    return ("Correlation <i>g<sub>B</sub></i>(<i>r</i>) of the beads' bond orders <i>ψ</i><sub>6</sub> at distance <i>r</i>, over all "
            "pairs; band: standard error. Broken line: <i>r</i><sup>−1/4</sup>, the steepest power law of a hexatic phase. "
            f"{reasons}{bed_run.not_measured(run, GB)}".rstrip())


def reason(part):
    phase, why = part.value("order", "phase"), part.value("order", "reason")
    if not phase:
        return ""
    who = f"{words.label_html(part.label)}: {words.escape(phase)}" if part.label else words.escape(str(phase).capitalize())
    return f"{who} ({words.escape(str(why).rstrip('.'))})." if why else f"{who}."


# Modes of the bed: frequency, damping and temperature against q, with the lines that sound speeds and drag give.

PHONONS = "phonons.csv"
PHONON_COLUMNS = ("m", "n", "branch", "q", "omega", "omega_error", "gamma", "gamma_error", "temperature", "temperature_error")
DIRECTIONS = (("x", "along $x$"), ("y", "along $y$"), ("d", "diagonal"), ("", "other"))
BRANCHES = (("L", "o", "longitudinal", "viscosity_L"), ("T", "s", "transverse", "viscosity_T"))


def draw_phonons(run, spec):
    parts = bed_run.holders(run, PHONONS)
    figure = canvas.figure(style.WIDE + 1.0, min(2.9 * len(parts), 10.8))
    rows = figure.subplots(len(parts), 3, squeeze=False)
    for part, row in zip(parts, rows):
        draw_part(part, row)
        if len(parts) > 1:
            canvas.heading(row[0], style.safe(part.label))
    canvas.legend(rows[0][0], fontsize=7.5, loc="upper left", bbox_to_anchor=None)
    if len(parts) == 1:
        canvas.heading(rows[0][0], style.safe(spec.title))
    return figure


def draw_part(part, row):
    modes = read_modes(part)
    scale = part.estimate("phonons", "temperature")
    for index, (direction, label) in enumerate(DIRECTIONS):
        colour = (*style.CURVES[:3], style.GREY)[index]
        for number, (branch, mark, word, _) in enumerate(BRANCHES):
            kept = (modes["branch"] == number) & (modes["direction"] == direction)
            look = dict(marker=mark, markerfacecolor=colour if number == 0 else "white")
            curve = f"{label}, {word}" if direction else None
            q = modes["q"][kept]
            canvas.points(row[0], q, modes["omega"][kept], modes["omega_error"][kept], colour, curve, **look)
            canvas.points(row[1], q, modes["gamma"][kept], modes["gamma_error"][kept], colour, **look)
            if scale is not None:
                canvas.points(row[2], q, modes["temperature"][kept] / scale.value, modes["temperature_error"][kept] / scale.value, colour,
                              **look)
            slope = part.estimate("phonons", f"c_{branch}{direction}") if direction else None
            if slope is not None:
                row[0].plot([0, modes["q"].max()], [0, slope.value * modes["q"].max()], color=colour, linewidth=0.8,
                            linestyle="-" if number == 0 else (0, (5, 3)), zorder=1)
    damping_lines(part, row[1], modes["q"].max())
    row[2].axhline(1, color=style.GREY, linewidth=0.6)
    for axes, label in zip(row, (r"$\omega$ (1/s)", r"$\gamma$ (1/s)", r"$T(q)/T_{xy}$")):
        axes.set(xlabel=r"$q\,a$", ylabel=label, xlim=(0, 1.05 * modes["q"].max()))
        axes.set_ylim(bottom=0)


def damping_lines(part, axes, end):
    """drag + nu q^2 of both branches."""
    drag = part.estimate("phonons", "drag_rate")
    q = np.linspace(0, end, 60)
    for number, (_, _, _, viscosity) in enumerate(BRANCHES):
        nu = part.estimate("phonons", viscosity)
        if drag is not None and nu is not None:
            axes.plot(q, drag.value + nu.value * q ** 2, color="black", linewidth=0.8, linestyle="-" if number == 0 else (0, (5, 3)), zorder=1)


def read_modes(part):
    """The columns by name, with the direction of each mode: "x", "y", "d" along the diagonal of the box, or ""."""
    modes = dict(zip(PHONON_COLUMNS, part.table(PHONONS, *PHONON_COLUMNS)))
    if not np.isfinite(modes["omega"]).any():
        raise PlotError(f"{part.folder / PHONONS}: holds no mode of known frequency: nothing to draw")
    modes["direction"] = np.select([modes["n"] == 0, modes["m"] == 0, modes["m"] == modes["n"]], ["x", "y", "d"], "")
    for name in ("omega", "gamma", "temperature"):
        modes[name + "_error"] = bed_run.known_errors(modes[name + "_error"])
    return modes


def caption_phonons(run, _):
    def describe(part):
        found = [(title, part.estimate("phonons", key), unit) for title, key, unit in
                 (("<i>c</i><sub>T</sub>", "c_T", "<i>a</i>/s"), ("drag rate", "drag_rate", "1/s"), ("<i>η</i>", "eta", ""))]
        return ", ".join(f"{title} = {words.with_error(*one[:2])} {unit}".rstrip() for title, one, unit in found if one)

    parts = bed_run.holders(run, PHONONS)
    numbers = bed_run.describe_each(parts, describe)
    return ("Modes of the beads against wave number <i>q</i>: frequency <i>ω</i> without damping (lines: <i>ω = cq</i> with the sound speeds), "
            "damping rate <i>γ</i> (lines: drag + <i>ν q</i><sup>2</sup>) and temperature relative to single beads; filled: longitudinal, "
            f"open: transverse; grey: other directions; bars: standard error{'. ' + numbers if numbers else ''}."
            f"{bed_run.not_measured(run, PHONONS)}")


KINDS = {
    "pair_correlation": Kind(draw=draw_pair_correlation, caption=caption_pair_correlation, there=lambda run: bed_run.some(run, GR)),
    "bond_order": Kind(draw=draw_bond_order, caption=caption_bond_order, there=lambda run: bed_run.some(run, GB)),
    "phonons": Kind(draw=draw_phonons, caption=caption_phonons, there=lambda run: bed_run.some(run, PHONONS)),
}
