"""Mean-square displacement of the beads, drift removed, on logarithmic axes."""

import numpy as np

from . import bed_run, canvas, style, words
from .errors import PlotError
from .schema import Kind

MSD = "msd.csv"
STIFFNESS_TEXT = bed_run.of_measure("stiffness", "<i>a</i><sup>−2</sup>")


def draw_msd(run, spec):
    parts = bed_run.holders(run, MSD)
    figure, axes = canvas.curve_panel(len(parts), 3.3)
    tables = [read(part) for part in parts]
    for part, (lag, value, sigma), colour in zip(parts, tables, canvas.colours(len(parts))):
        canvas.band(axes, lag, value, sigma, colour, part.label, lowest=value.min() / 10)
    diffusion_guide(axes, tables)
    low, high = (edge(value[:2].min() if edge is min else value.max() for _, value, _ in tables) for edge in (min, max))
    axes.set(xscale="log", yscale="log", ylim=(low / 2, 2 * high), xlabel=r"$t$ (s)", ylabel=r"$\Delta(t)$ ($a^2$)")
    canvas.legend(axes, **(dict(loc="upper left") if len(parts) <= canvas.MOST_INSIDE else {}))
    canvas.heading(axes, style.safe(spec.title))
    return figure


def read(part):
    lag, value, sigma = part.table(MSD, "lag", "msd", "sigma")
    kept = (lag > 0) & (value > 0)
    if not kept.any():
        raise PlotError(f"{part.folder / MSD}: holds no displacement > 0 at any lag > 0: nothing to draw on a log scale")
    return lag[kept], value[kept], bed_run.known_errors(sigma[kept])


def diffusion_guide(axes, tables):
    """Slope 1, free diffusion, up to over the end of the highest curve."""
    lag, value, _ = max(tables, key=lambda table: table[1][-1])
    t = np.array([max(lag[0], lag[-1] / 8), lag[-1]])
    axes.plot(t, 1.5 * value[-1] / lag[-1] * t, label=r"$\propto t$", **canvas.FAINT)


def caption_msd(run, spec):
    text = ("Mean-square displacement <i>Δ</i>(<i>t</i>) of the beads in the plane, the mean of all beads taken off; band: standard error; "
            "broken line: slope 1, free diffusion.")
    found = bed_run.describe_each(bed_run.holders(run, MSD), STIFFNESS_TEXT)
    stiffness = f" Stiffness 1/(<i>s</i> Δ̃(<i>s</i>)) for <i>s</i> → 0: {found}." if found else ""
    return text + stiffness + bed_run.not_measured(run, MSD)


# The curve from which the stiffness of what holds a bead is read off: 1/(s MSD~(s)), extrapolated to s = 0.

STIFFNESS = "stiffness.csv"


def draw_stiffness(run, spec):
    parts = bed_run.holders(run, STIFFNESS)
    figure, axes = canvas.curve_panel(len(parts))
    axes.axhline(0, color=style.GREY, linewidth=0.6, zorder=1)
    for index, (part, colour) in enumerate(zip(parts, canvas.colours(len(parts)))):
        canvas.points(axes, *read_stiffness(part), colour, part.label or None, canvas.curve_mark(index))
        extrapolation(axes, part, colour)
    axes.set(xlabel=r"$s$ (1/s)", ylabel=r"$1/(s\,\tilde{\Delta}(s))$ ($a^{-2}$)")
    axes.set_xlim(left=-0.03 * axes.get_xlim()[1])  # room for the marks at s = 0
    canvas.legend(axes)
    canvas.heading(axes, style.safe(spec.title))
    return figure


def read_stiffness(part):
    s, value, sigma = part.table(STIFFNESS, "s", "value", "sigma")
    kept = (s > 0) & np.isfinite(value)
    if not kept.any():
        raise PlotError(f"{part.folder / STIFFNESS}: holds no value at any s > 0: nothing to draw")
    return s[kept], value[kept], bed_run.known_errors(sigma[kept])


def extrapolation(axes, part, colour):
    """The value at s = 0 with its error, and a line from it to the end of the window that it was taken from."""
    found, last = part.estimate("microrheology", "stiffness"), part.number("microrheology", "s_high")
    if found is None:
        return
    canvas.points(axes, [0.0], [found.value], np.array([found.error]), colour, marker="*", markersize=8, clip_on=False)
    s, value, _ = read_stiffness(part)
    if last is not None and s[0] <= last <= s[-1]:
        axes.plot([0.0, last], [found.value, np.interp(last, s, value)], color=colour, linewidth=0.8, linestyle=(0, (5, 3)), zorder=2)


def caption_stiffness(run, _):
    parts = bed_run.holders(run, STIFFNESS)
    values = bed_run.describe_each(parts, STIFFNESS_TEXT)
    return ("Stiffness of what holds a bead, 1/(<i>s</i> Δ̃(<i>s</i>)) with the Laplace transform of the mean-square displacement; bars: "
            "standard error; star: extrapolated to <i>s</i> = 0 from the window up to the end of the broken line"
            f"{', ' + values if values else ''}.{bed_run.not_measured(run, STIFFNESS)}")


# Memory kernel of what holds a bead against the Laplace frequency, with the stiffness it starts from, on logarithmic axes.

KERNEL = "memory_kernel.csv"


def draw_memory_kernel(run, spec):
    parts, tables, _ = drawable(run)
    figure, axes = canvas.curve_panel(len(parts), 3.4)
    for part, table, colour in zip(parts, tables, canvas.colours(len(parts))):
        canvas.band(axes, table["s"], table["value"], table["sigma"], colour, kernel_label(part, table), lowest=table["value"].min() / 10)
        spring(axes, part, table, colour)
    inertia(axes, tables)
    low, high = (edge(edge(table["value"]) for table in tables) for edge in (min, max))
    axes.set(xscale="log", yscale="log", ylim=(low / 3, 3 * high), xlabel=r"$s$ (1/s)", ylabel=r"$\tilde{k}(s)$ (N/m)")
    canvas.legend(axes)
    canvas.heading(axes, style.safe(spec.title))
    return figure


def drawable(run):
    """Runs or variants with their curves, and what is wrong with those that have none."""
    parts, tables, faults = [], [], []
    for part in bed_run.holders(run, KERNEL):
        try:
            tables.append(read_kernel(part))
            parts.append(part)
        except PlotError as error:
            faults.append((part, error))
    if not parts:
        raise faults[0][1]
    return parts, tables, faults


def read_kernel(part):
    """The kernel without drag, or with it where no drag was given, within the range of s where data are close and long enough."""
    s, total, bias, with_drag, kernel, total_error, kernel_error = part.table(
        KERNEL, "s", "total", "bias", "with_drag", "kernel", "total_error", "kernel_error")
    dragged = not np.isfinite(kernel).any()
    value, sigma = (with_drag, total_error) if dragged else (kernel, kernel_error)
    low, high = (part.number("microrheology", f"kernel_{end}") for end in ("low", "high"))
    if low is None or high is None:
        raise PlotError(f"{part.folder / KERNEL}: the transform is good to 2 % at no s: run longer, or measure frames closer together")
    kept = (s >= low * (1 - 1e-9)) & (s <= high * (1 + 1e-9)) & (value > 0)
    if not kept.any():
        raise PlotError(f"{part.folder / KERNEL}: holds no kernel > 0 at any s from {low:.3g} to {high:.3g} 1/s: nothing to draw on a log scale")
    sigma = np.hypot(np.nan_to_num(sigma), bias)  # what is unknown is not drawn; the caption tells
    return {"s": s[kept], "value": value[kept], "sigma": sigma[kept], "inertia": (total - with_drag)[kept], "dragged": dragged}


def kernel_label(part, table):
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
    axes.plot(s, mass * s ** 2, label=r"$m s^2$", **canvas.FAINT)


def caption_memory_kernel(run, _):
    parts, tables, faults = drawable(run)
    dragged = [table["dragged"] for table in tables]
    what = ("<i>k̃</i>(<i>s</i>) + <i>Γs</i>, no drag of the plates being given (<code>measure.bead_drag</code>)" if all(dragged)
            else "<i>k̃</i>(<i>s</i>)" + (", with <i>Γs</i> where no drag of the plates is given" if any(dragged) else ", the drag of the plates taken off"))
    values = bed_run.describe_each(parts, bed_run.of_measure("spring", "µN/m", 1e6))
    short = "".join(f" {words.label_html(part.label)}: too short, or frames too far apart, for any <i>s</i>." for part, _ in faults)
    return (f"Memory kernel of what holds a bead, {what}; the inertia <i>ms</i>² of the bare bead is taken off, the broken grey line. "
            "Band: standard error and what frames and length of the run leave open; drawn where the latter is below 2 % of all that resists; "
            f"short broken lines: stiffness at <i>s</i> → 0{', ' + values if values else ''}.{short}{bed_run.not_measured(run, KERNEL)}")


# How a rod of the bed forgets its heading: mean-square change and mean cosine against the lag, with the fits that give D_r.

HEADING, DIFFUSION = "heading.csv", "heading_diffusion"
HEADING_COLUMNS = ("lag", "square", "square_error", "cosine", "cosine_error")
FITTED, BEYOND = "-", (0, (5, 3))


def draw_heading_diffusion(run, spec):
    parts = bed_run.holders(run, HEADING)
    figure = canvas.figure(style.WIDE, 3.0)
    square, cosine = figure.subplots(1, 2)
    for part, colour in zip(parts, canvas.colours(len(parts))):
        draw_heading(part, square, cosine, colour, style.safe(part.label) if len(parts) > 1 else None)
    square.set(xlabel=r"lag $\tau$ (s)", ylabel=r"$\langle\Delta\theta^2\rangle$ (rad$^2$)", xscale="log", yscale="log")
    cosine.set(xlabel=r"lag $\tau$ (s)", ylabel=r"$\langle\cos\Delta\theta\rangle$", xlim=(0, None))
    if len(parts) > 1:
        canvas.legend(square, fontsize=7.5, loc="upper left", bbox_to_anchor=None)
    for k, axes in enumerate((square, cosine)):
        canvas.letter(axes, k)
    figure.suptitle(style.safe(spec.title), fontsize=10.5)
    return figure


def draw_heading(part, square, cosine, colour, label):
    table = read_heading(part)
    canvas.points(square, table["lag"], table["square"], table["square_error"], colour, label)
    canvas.points(cosine, table["lag"], table["cosine"], table["cosine_error"], colour)
    low, high = (part.number(DIFFUSION, key) for key in ("lag_low", "lag_high"))
    for lag, look in ((np.linspace(low, high, 50), FITTED), (np.linspace(table["lag"][0], low, 30), BEYOND)):
        draw_heading_fits(part, table, (square, cosine), lag, dict(color=colour, linewidth=0.9, linestyle=look))


def at_zero(part, table, D):
    """Where the fitted line, of weights 1/lag^2, has lag 0: below 0 for a rod that turns steadily."""
    lag = table["lag"]
    fitted = (lag >= 0.999 * part.number(DIFFUSION, "lag_low")) & np.isfinite(table["square"])
    return np.average((table["square"] - 2 * D * lag)[fitted], weights=1 / lag[fitted] ** 2)


def draw_heading_fits(part, table, panels, lag, look):
    """Both fits over these lags."""
    square, cosine = panels
    D, D_cosine = (part.estimate(DIFFUSION, key) for key in ("D_r", "D_r_cosine"))
    if D is not None:
        line = at_zero(part, table, D.value) + 2 * D.value * lag
        square.plot(lag, np.where(line > 0, line, np.nan), **look)
    if D_cosine is not None:
        cosine.plot(lag, part.number(DIFFUSION, "cosine_amplitude") * np.exp(-D_cosine.value * lag), **look)


def read_heading(part):
    table = dict(zip(HEADING_COLUMNS, part.table(HEADING, *HEADING_COLUMNS)))
    if not (table["square"] > 0).any():
        raise PlotError(f"{part.folder / HEADING}: the rod never turns: nothing to draw")
    return table | {name: bed_run.known_errors(table[name]) for name in ("square_error", "cosine_error")}


def caption_heading_diffusion(run, _):
    def describe(part):
        D = part.estimate(DIFFUSION, "D_r")
        reduced = part.estimate(DIFFUSION, "rotational_diffusion")
        return "" if D is None else (f"<i>D</i><sub>r</sub> = {words.with_error(D.value, D.error)} rad²/s"
                                     + (f", in the theory's units {words.with_error(reduced.value, reduced.error)}" if reduced else ""))

    parts = bed_run.holders(run, HEADING)
    numbers = bed_run.describe_each(parts, describe)
    return ("Mean-square change of a rod's heading and mean cosine of it against the lag <i>τ</i>; solid lines: straight line and exponential "
            "over the lags that are fitted; dashed: towards shorter lags, where the rod rattles; bars: standard error"
            f"{'. ' + numbers if numbers else ''}.{bed_run.not_measured(run, HEADING)}")


KINDS = {
    "msd": Kind(draw=draw_msd, caption=caption_msd, there=lambda run: bed_run.some(run, MSD)),
    "stiffness": Kind(draw=draw_stiffness, caption=caption_stiffness),
    "memory_kernel": Kind(draw=draw_memory_kernel, caption=caption_memory_kernel),
    "heading_diffusion": Kind(draw=draw_heading_diffusion, caption=caption_heading_diffusion, there=lambda run: bed_run.some(run, HEADING)),
}
