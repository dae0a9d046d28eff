"""Energy, temperatures, order and the plates' push against time."""

import numpy as np

from . import bed, canvas, style, words
from .bed_run import TABLE
from .schema import Kind



def draw(run, spec):
    tables = run.granular.tables()
    figure = canvas.figure(style.WIDE - 0.8, 7.0)
    panels = figure.subplots(4, 1, sharex=True)
    for axes, paint in zip(panels, (energies, temperatures, order, pushes)):
        paint(axes, tables)
        shade_equilibration(axes, tables)
        axes.margins(x=0)
    panels[-1].set_xlabel(r"$t$ (s)")
    for index, axes in enumerate(panels):
        axes.annotate(f"({'abcd'[index]})", (0, 1), (4, -4), xycoords="axes fraction", textcoords="offset points", va="top",
                      bbox=dict(facecolor="white", alpha=0.7, linewidth=0, pad=1))
    canvas.heading(panels[0], style.safe(spec.title) or title(run, tables))
    figure.align_ylabels(panels)
    return figure


def title(run, tables):
    runs = f", {len(tables)} runs" if len(tables) > 1 else ""
    return bed.density(run.granular) + runs


def lines(axes, curves, colour, label):
    """One curve a run [(t, y)], thin with their mean if there are several."""
    several = len(curves) > 1
    for t, y in curves:
        axes.plot(t, y, color=colour, **(dict(linewidth=0.5, alpha=0.4) if several else dict(label=label, linewidth=1.1)))
    if several:
        t = curves[0][0][curves[0][0] <= min(one[-1] for one, _ in curves if one.size)]
        axes.plot(t, np.mean([np.interp(t, *one) for one in curves], axis=0), color=colour, linewidth=1.8, label=label)


def key(axes):
    """Beside the panel, where no curve can run under it."""
    canvas.beside(axes, *axes.get_legend_handles_labels(), frameon=False, fontsize=9, handlelength=1.4)


def energies(axes, tables):
    factor, prefix = words.prefix_for(max(np.abs(table["energy"]).max() for table in tables))
    lines(axes, [(table["t"], table["energy"] * factor) for table in tables], style.LINE, "total")
    lines(axes, [(table["t"], table["kinetic"] * factor) for table in tables], style.ROD_COLOURS[0], "kinetic")
    axes.set_ylabel(rf"energy ($\mathrm{{{prefix}J}}$)")
    if all(min(table["energy"].min(), table["kinetic"].min()) >= 0 for table in tables):
        axes.set_ylim(bottom=0)
    key(axes)


def temperatures(axes, tables):
    for name, symbol, colour in (("T_z", "T_z", style.LINE), ("T_xy", "T_{xy}", style.ROD_COLOURS[0])):
        curves = [(table["t"], np.where(table[name] > 0, table[name], np.nan)) for table in tables]
        lines(axes, curves, colour, rf"${symbol}$")
    axes.set_yscale("log")
    axes.set_ylabel(r"$T$ ($\mathrm{m^2/s^2}$)")
    key(axes)


def order(axes, tables):
    lines(axes, [(table["t"], table["psi6"]) for table in tables], style.LINE, "")
    axes.set(ylabel=r"$\psi_6$", ylim=(0, 1.02), yticks=(0, 0.5, 1))


def pushes(axes, tables):
    """Mean force of each plate between rows: what its impulse grew by over the time."""
    forces = {name: [rate(table["t"], table[f"{name}_impulse"]) for table in tables] for name in ("floor", "lid")}
    size = max((np.abs(force).max() for curves in forces.values() for _, force in curves if force.size), default=0.0)
    factor, prefix = words.prefix_for(size)
    for (name, curves), colour in zip(forces.items(), (style.LINE, style.ROD_COLOURS[0])):
        lines(axes, [(t, force * factor) for t, force in curves], colour, name)
    axes.set_ylabel(rf"upward force ($\mathrm{{{prefix}N}}$)")
    axes.axhline(0, color=style.GREY, linewidth=0.6)
    key(axes)


def rate(t, total):
    """(middle of each interval, growth of a running total over its length)."""
    return (t[1:] + t[:-1]) / 2, np.diff(total) / np.diff(t)


def shade_equilibration(axes, tables):
    start = min(table["t"][0] for table in tables)
    if start < 0:
        axes.axvspan(start, 0, color="#ececea", linewidth=0, zorder=0)


def caption(run, spec):
    shaded = " Shaded: equilibration, rods held." if any(table["t"][0] < 0 for table in run.granular.tables()) else ""
    mean = " Thin: each run; bold: their mean." if not run.granular.single else ""
    return ("(a) Energy; (b) temperatures <i>T</i><sub>z</sub> = var <i>v</i><sub>z</sub> and <i>T</i><sub>xy</sub> = (var "
            "<i>v</i><sub>x</sub> + var <i>v</i><sub>y</sub>)/2 of the beads; (c) global bond order <i>ψ</i><sub>6</sub>; "
            f"(d) mean upward force of floor and lid on the bed between rows of table.csv.{mean}{shaded}")


KINDS = {"granular_table": Kind(draw=draw, caption=caption, there=lambda run: run.granular.has(TABLE))}
