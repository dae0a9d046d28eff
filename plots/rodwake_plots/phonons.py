"""Modes of the bed: frequency, damping and temperature against q, with the lines that sound speeds and drag give."""

import numpy as np

from . import canvas, curves, measured, style, words
from .errors import PlotError
from .spec import Spec

FILE = "phonons.csv"
COLUMNS = ("m", "n", "branch", "q", "omega", "omega_error", "gamma", "gamma_error", "temperature", "temperature_error")
DIRECTIONS = (("x", "along $x$"), ("y", "along $y$"), ("d", "diagonal"), ("", "other"))
BRANCHES = (("L", "o", "longitudinal", "viscosity_L"), ("T", "s", "transverse", "viscosity_T"))


def draw(run, spec):
    parts = measured.holders(run, FILE)
    figure = canvas.figure(style.WIDE + 1.0, min(2.9 * len(parts), 10.8))
    rows = figure.subplots(len(parts), 3, squeeze=False)
    for part, row in zip(parts, rows):
        draw_part(part, row)
        if len(parts) > 1:
            canvas.heading(row[0], style.safe(part.label))
    curves.legend(rows[0][0], fontsize=7.5, loc="upper left", bbox_to_anchor=None)
    if len(parts) == 1:
        canvas.heading(rows[0][0], style.safe(spec.title))
    return figure


def draw_part(part, row):
    modes = read(part)
    scale = part.estimate("phonons", "temperature")
    for index, (direction, label) in enumerate(DIRECTIONS):
        colour = (*curves.FEW[:3], style.GREY)[index]
        for number, (branch, mark, word, _) in enumerate(BRANCHES):
            kept = (modes["branch"] == number) & (modes["direction"] == direction)
            look = dict(marker=mark, markerfacecolor=colour if number == 0 else "white")
            told = f"{label}, {word}" if direction else None
            q = modes["q"][kept]
            curves.points(row[0], q, modes["omega"][kept], modes["omega_error"][kept], colour, told, **look)
            curves.points(row[1], q, modes["gamma"][kept], modes["gamma_error"][kept], colour, **look)
            if scale is not None:
                curves.points(row[2], q, modes["temperature"][kept] / scale.value, modes["temperature_error"][kept] / scale.value, colour,
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


def read(part):
    """The columns by name, with the direction of each mode: "x", "y", "d" along the diagonal of the box, or ""."""
    modes = dict(zip(COLUMNS, part.table(FILE, *COLUMNS)))
    if not np.isfinite(modes["omega"]).any():
        raise PlotError(f"{part.folder / FILE}: holds no mode of known frequency: nothing to draw")
    modes["direction"] = np.select([modes["n"] == 0, modes["m"] == 0, modes["m"] == modes["n"]], ["x", "y", "d"], "")
    for name in ("omega", "gamma", "temperature"):
        modes[name + "_error"] = measured.known(modes[name + "_error"])
    return modes


def caption(run, _):
    def told(part):
        found = [(title, part.estimate("phonons", key), unit) for title, key, unit in
                 (("<i>c</i><sub>T</sub>", "c_T", "<i>a</i>/s"), ("drag rate", "drag_rate", "1/s"), ("<i>η</i>", "eta", ""))]
        return ", ".join(f"{title} = {words.with_error(*one[:2])} {unit}".rstrip() for title, one, unit in found if one)

    parts = measured.holders(run, FILE)
    numbers = "; ".join(f"{words.label_html(part.label) + ': ' if part.label else ''}{told(part)}" for part in parts if told(part))
    return ("Modes of the beads against wave number <i>q</i>: frequency <i>ω</i> without damping (lines: <i>ω = cq</i> with the sound speeds), "
            "damping rate <i>γ</i> (lines: drag + <i>ν q</i><sup>2</sup>) and temperature over that of single beads; filled: longitudinal, "
            f"open: transverse; grey: other directions; bars: standard error{'. ' + numbers if numbers else ''}."
            f"{measured.not_measured(run, FILE)}")


def defaults(run):
    return [Spec("phonons", "phonons")] if measured.some(run, FILE) else []
