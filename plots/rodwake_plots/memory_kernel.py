"""Memory kernel of what holds a bead against the Laplace frequency, with the stiffness it starts from, on logarithmic axes."""

import numpy as np

from . import canvas, curves, measured, style, words
from .errors import PlotError

FILE = "memory_kernel.csv"


def draw(run, spec):
    parts, tables, _ = drawable(run)
    figure, axes = curves.panel(len(parts), 3.4)
    for part, table, colour in zip(parts, tables, curves.colours(len(parts))):
        curves.band(axes, table["s"], table["value"], table["sigma"], colour, label(part, table), lowest=table["value"].min() / 10)
        spring(axes, part, table, colour)
    inertia(axes, tables)
    low, high = (edge(edge(table["value"]) for table in tables) for edge in (min, max))
    axes.set(xscale="log", yscale="log", ylim=(low / 3, 3 * high), xlabel=r"$s$ (1/s)", ylabel=r"$\tilde{k}(s)$ (N/m)")
    curves.legend(axes)
    canvas.heading(axes, style.safe(spec.title))
    return figure


def drawable(run):
    """Runs or variants with their curves, and what is wrong with those that have none."""
    parts, tables, faults = [], [], []
    for part in measured.holders(run, FILE):
        try:
            tables.append(read(part))
            parts.append(part)
        except PlotError as error:
            faults.append((part, error))
    if not parts:
        raise faults[0][1]
    return parts, tables, faults


def read(part):
    """The kernel without drag, or with it where no drag was given, within the range of s where data are close and long enough."""
    s, total, bias, with_drag, kernel, total_error, kernel_error = part.table(
        FILE, "s", "total", "bias", "with_drag", "kernel", "total_error", "kernel_error")
    dragged = not np.isfinite(kernel).any()
    value, sigma = (with_drag, total_error) if dragged else (kernel, kernel_error)
    low, high = (part.number("microrheology", f"kernel_{end}") for end in ("low", "high"))
    if low is None or high is None:
        raise PlotError(f"{part.folder / FILE}: the transform is good to 2 % at no s: run longer, or measure frames closer together")
    kept = (s >= low * (1 - 1e-9)) & (s <= high * (1 + 1e-9)) & (value > 0)
    if not kept.any():
        raise PlotError(f"{part.folder / FILE}: holds no kernel > 0 at any s from {low:.3g} to {high:.3g} 1/s: nothing to draw on a log scale")
    sigma = np.hypot(np.nan_to_num(sigma), bias)  # what is unknown is not drawn; the caption tells
    return {"s": s[kept], "value": value[kept], "sigma": sigma[kept], "inertia": (total - with_drag)[kept], "dragged": dragged}


def label(part, table):
    return part.label + (r" ($+\Gamma s$)" if part.label and table["dragged"] else "")


def spring(axes, part, table, colour):
    """The value at s -> 0, from the left end of the curve to the end of the window that it was taken from."""
    found, last = part.estimate("microrheology", "spring"), part.number("microrheology", "s_high")
    if found is not None and found.value > 0 and last is not None:
        axes.plot([table["s"][0], max(last, table["s"][0])], [found.value] * 2, color=colour, linewidth=1.0, linestyle=(0, (5, 3)), zorder=2)


def inertia(axes, tables):
    """m s^2, which was taken off; the mass is the same for all."""
    s = np.unique(np.concatenate([table["s"] for table in tables]))
    first = tables[0]
    mass = np.median(first["inertia"] / first["s"] ** 2)
    axes.plot(s, mass * s ** 2, label=r"$m s^2$", **curves.FAINT)


def caption(run, _):
    parts, tables, faults = drawable(run)
    dragged = [table["dragged"] for table in tables]
    what = ("<i>k̃</i>(<i>s</i>) + <i>Γs</i>, no drag of the plates being given (<code>measure.bead_drag</code>)" if all(dragged)
            else "<i>k̃</i>(<i>s</i>)" + (", with <i>Γs</i> where no drag of the plates is given" if any(dragged) else ", the drag of the plates taken off"))
    told = "; ".join(f"{words.label_html(part.label) + ': ' if part.label else ''}{words.with_error(*found[:2], 1e6)} µN/m"
                     for part in parts if (found := part.estimate("microrheology", "spring")))
    short = "".join(f" {words.label_html(part.label)}: too short, or frames too far apart, for any <i>s</i>." for part, _ in faults)
    return (f"Memory kernel of what holds a bead, {what}; the inertia <i>ms</i>² of the bare bead is taken off, the broken grey line. "
            "Band: standard error and what frames and length of the run leave open; drawn where the latter is below 2 % of all that resists; "
            f"short broken lines: stiffness at <i>s</i> → 0{', ' + told if told else ''}.{short}{measured.not_measured(run, FILE)}")


def defaults(_):
    """Only where a scene asks for it, as the stiffness."""
    return []
