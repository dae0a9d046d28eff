"""The rod on paper to scale, as in the frame that moves with it: centre of mass at the origin, thin end towards +x."""

from dataclasses import replace

import numpy as np
from matplotlib.colors import Normalize
from matplotlib.patches import Rectangle

from . import bed_run, canvas, field, fit, fit_words, style, words
from .bed_run import FIELDS
from .errors import PlotError
from .schema import Kind, Spec

USUAL = {"motile": (1.1e-3, 12), "apolar": (0.95e-3, 13)}  # thick diameter in m, spheres
FINE = 1200
MARK = 1.5  # of a rod whose shape is not known: half its length, a


def rod_outline(run):
    """(x, half width) of the row of spheres in bead radii, thick end first; of the rod in whose frame was measured.

    In a bed without rods of the force from which was measured: a circle of its width. A film does not tell: a triangle as a mark."""
    if run.has_tracks:
        return np.array([-MARK, MARK]), np.array([0.7 * MARK, 0.0])
    a = run.granular.a
    if who(run) == "force":
        width = rod_number(run.scene["granular"]["body_force"], "width", a) / a
        x = np.linspace(-width, width, FINE)
        return x, np.sqrt(width**2 - x**2)
    centres, radii = sphere_row(rod_of(run.scene))
    x = np.linspace(centres[0] - radii[0], centres[-1] + radii[-1], FINE)
    square = (radii[:, None] ** 2 - (x - centres[:, None]) ** 2).max(axis=0).clip(0)
    middle = (x * square).sum() / square.sum()  # of the solid of revolution
    return (x - middle) / a, np.sqrt(square) / a


def who(run):
    """In whose frame was measured."""
    bed = run.scene.get("granular", {})
    return "force" if not bed.get("rods") and "body_force" in bed else "rod"


def drawn(run):
    """What stands in the middle."""
    if run.has_tracks:
        return "The triangle marks the rod, whose size is unknown in a film."
    return "The rod is drawn to scale." if who(run) == "rod" else "Circle: one width of the force around its centre."


def shaded(run):
    if run.has_tracks:
        return f"{words.number(MARK)} <i>a</i> on either side of the rod's position"
    return "the rod's body" if who(run) == "rod" else "one width of the force to each side"


def rod_of(scene):
    rods = scene.get("granular", {}).get("rods", [])
    number = scene.get("measure", {}).get("rod", 0)
    return rods[number] if isinstance(number, int) and 0 <= number < len(rods) else {}


def sphere_row(rod):
    """Centres along the axis and radii, m."""
    apolar = rod.get("kind") == "apolar"
    thick, count = USUAL["apolar" if apolar else "motile"]
    thick, thin = rod_number(rod, "thick_diameter", thick), rod_number(rod, "thin_diameter", 0.8e-3)
    length, count = rod_number(rod, "length", 4.5e-3), int(rod_number(rod, "spheres", count))
    place = np.linspace(0, 1, count) if count > 1 else np.array([0.5])
    first, last = (thin if apolar else thick) / 2, length - thin / 2
    return first + (last - first) * place, (thick + (thin - thick) * taper(rod, place, apolar)) / 2


def taper(rod, place, apolar):
    """0 where thick, 1 where thin."""
    part = abs(2 * place - 1) if apolar else place
    if rod.get("taper") != "stepwise":
        return part
    segments, count = int(rod_number(rod, "segments", 4)), len(place)
    places = (count + 1) // 2 if apolar else count
    step = np.rint(part * (places - 1)) * segments // places
    return step / max(segments - 1, 1)


def rod_number(rod, key, usual):
    value = rod.get(key)
    return value if words.is_number(value) else usual


def draw_rod(axes, run, **look):
    x, half = rod_outline(run)
    look = dict(facecolor="white", edgecolor="black", linewidth=0.9, zorder=5) | look
    axes.fill(np.concatenate([x, x[::-1]]), np.concatenate([half, -half[::-1]]), **look)


def shade_rod(axes, run, along):
    """The stretch of a line that the rod's body covers."""
    x, half = rod_outline(run)
    low, high = (x[0], x[-1]) if along == "x" else (-np.interp(0.0, x, half), np.interp(0.0, x, half))
    axes.axvspan(low, high, color="#e6e6e2", linewidth=0, zorder=0)
    axes.annotate(who(run), ((low + high) / 2, 0.02), xycoords=axes.get_xaxis_transform(), ha="center", va="bottom", fontsize=8.5,
                  color=style.GREY)


# The measured displacement of the beads around the rod: its size or a component by colour, and arrows.

ARROWS = 22, 15  # across the window of one panel, of several
MAP_LABELS = {"U": r"$|U|/a$", "Ux": r"$U_x/a$", "Uy": r"$U_y/a$"}
MAP_WORDS = {"U": "size |<b>U</b>|", "Ux": "<i>U<sub>x</sub></i>", "Uy": "<i>U<sub>y</sub></i>"}


def draw_displacement_map(run, spec):
    parts = bed_run.holders(run, FIELDS, "displacement")
    fields = [read(part, run, spec) for part in parts]
    window = tuple((min(field[axis][0] for field in fields), max(field[axis][-1] for field in fields)) for axis in (0, 1))
    figure, axes_list = canvas.panel_grid(parts, np.ptp(window[1]) / np.ptp(window[0]), bar=0.8)
    norm, extend = map_scale([colour_values(spec, U) for _, _, U in fields], spec.component)
    longest = max(np.nanpercentile(np.abs(U), 97) for _, _, U in fields) or 1.0
    for axes, (x, y, U) in zip(axes_list, fields):
        blank(axes, window)
        image = axes.pcolormesh(x, y, colour_values(spec, U), norm=norm, cmap=colour_map(spec), shading="nearest", rasterized=True,
                                zorder=1)
        drawn = arrows(axes, x, y, U, longest, ARROWS[len(parts) > 1])
        arrow_key(axes, drawn, longest)
        canvas.window(axes, *window)
        draw_rod(axes, run)
        axes.tick_params(direction="out", top=False, right=False)
    canvas.label_panels(axes_list, parts, r"$x/a$", r"$y/a$", spec.title)
    canvas.colour_bar(figure, image, axes_list, MAP_LABELS[spec.component], extend=extend, pad=0.015, aspect=32)
    return figure


def read(part, run, spec):
    """x, y and complex U in the window; nan where no bead was seen."""
    x, y, Ux, Uy, count = part.grid("displacement", "Ux", "Uy", "count")
    U = np.where(count > 0, Ux + 1j * Uy, complex(np.nan, np.nan))  # nan alone would leave U_y 0
    columns, rows = (bed_run.inside_window(values, asked, bed_run.bead_radius(run)) for values, asked in ((x, spec.x), (y, spec.y)))
    U = U[np.ix_(rows, columns)]
    if columns.sum() < 2 or rows.sum() < 2 or not np.isfinite(U).any():
        raise PlotError(f"{part.folder / FIELDS}: /displacement has no bin with beads inside the window: nothing to draw")
    return x[columns], y[rows], U


def colour_values(spec, U):
    return {"U": np.abs, "Ux": np.real, "Uy": np.imag}[spec.component](U)


def colour_map(spec):
    return style.FIELD_MAP if spec.component == "U" else "RdBu_r"


def map_scale(values, component):
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
    size = canvas.nice(longest, up=False)
    axes.set_title(" ", loc="right", pad=6)  # keeps room: the layout does not see a key
    axes.quiverkey(drawn, 0.99, 1.035, size / longest, rf"$|U| = {size:g}\,a$", labelpos="W", labelsep=0.05, coordinates="axes",
                   fontproperties={"size": 9})


def caption_displacement_map(run, spec):
    parts = bed_run.holders(run, FIELDS, "displacement")
    rod = who(run) == "rod"
    return (f"Measured displacement <b>U</b> of the beads in the frame of the {who(run)}, which {'heads' if rod else 'points'} along +<i>x</i>: colour, "
            f"{MAP_WORDS[spec.component]}; arrows, <b>U</b>, the largest ones cut to the distance between arrows. Hatched: no bead was seen "
            f"there. {drawn(run)} {how(parts[0])}{bed_run.not_measured(run, FIELDS, 'displacement')}")


# Measured displacement along a line of the rod's frame (paper, Fig. 6).



def file_of(spec):
    return f"profile_{spec.component}_{spec.along}.csv"


def line_of(run, spec):
    """The fixed coordinate, a: beside the rod for U_y along x, which vanishes on the axis."""
    if (spec.component, spec.along) != ("Uy", "x"):
        return 0.0
    asked = run.scene.get("measure", {}).get("profile_offset")
    return asked / bed_run.bead_radius(run) if words.is_number(asked) else 4.0


def draw_profile(run, spec):
    parts = bed_run.holders(run, file_of(spec))
    figure, axes = canvas.curve_panel(len(parts))
    paint_profile(axes, run, spec, parts)
    return figure


def paint_profile(axes, run, spec, parts):
    shade_rod(axes, run, spec.along)
    axes.axhline(0, color=style.GREY, linewidth=0.6, zorder=1)
    several = len(parts) > 1
    for index, (part, colour) in enumerate(zip(parts, canvas.colours(len(parts)))):
        place, value, sigma = read_profile(run, spec, part)
        canvas.points(axes, place, value, sigma, colour, part.label or None, canvas.curve_mark(index) if several else "o",
                      markersize=3.0 if several else 3.4)
    theory(axes, run, spec)
    window = profile_window(run, spec)
    axes.set(xlabel=rf"${spec.along}/a$", ylabel=ylabel(spec))
    if window:
        axes.set_xlim(*window)
    else:
        axes.margins(x=0.01)
    low, high = axes.get_ylim()
    axes.set_ylim(low - 0.06 * (high - low), high)  # room for words
    canvas.legend(axes)
    canvas.heading(axes, style.safe(spec.title))
    note_profile_line(axes, run, spec)


def fitted(run, spec):
    """What a fit of this run knows of the line; None without one."""
    for one in run.fit.profiles if run.has_fit and run.fit.unit == "a" else ():
        if (one.get("component"), one.get("along"), one.get("at")) == (spec.component, spec.along, line_of(run, spec)):
            return fit.View(one, run.fit.points(one), run.fit.curve(one))
    return None


def theory(axes, run, spec):
    """The curve of the theory with the fitted parameters, which does not set the range."""
    view = fitted(run, spec)
    if not view:
        return
    axes.set_ylim(*axes.get_ylim())
    x, model = fit.modelled(run.fit, view)
    factor = np.sqrt(np.abs(x)) if spec.sqrt_scaled else 1.0
    fit.draw_line(axes, run.fit, x, factor * model, color=style.OTHERS[0], linewidth=1.4, zorder=2)
    axes.plot([], [], color=style.OTHERS[0], label=f"theory, {describe_theory(view)}")


def describe_theory(view):
    return "predicted" if fit_words.predicted(view.profile) else "fitted"


def read_profile(run, spec, part):
    """(place, U, its error) in a inside the window, each U times |place|^(1/2) if asked for."""
    place, value, sigma, count = part.table(file_of(spec), "x", "value", "sigma", "count")
    window = profile_window(run, spec) or (-np.inf, np.inf)
    kept = (count > 0) & ~((place == 0) & spec.sqrt_scaled) & np.isfinite(value) & (place >= window[0]) & (place <= window[1])
    if not kept.any():
        raise PlotError(f"{part.folder / file_of(spec)}: holds no bin with beads inside the window: nothing to draw")
    factor = np.sqrt(np.abs(place[kept])) if spec.sqrt_scaled else np.ones(kept.sum())
    return place[kept], factor * value[kept], factor * bed_run.known_errors(sigma[kept])


def profile_window(run, spec):
    return tuple(edge / bed_run.bead_radius(run) for edge in (spec.x if spec.along == "x" else spec.y))


def ylabel(spec):
    symbol = f"U_{spec.component[1]}"
    return rf"$|{spec.along}|^{{1/2}}\,{symbol}$ ($a^{{3/2}}$)" if spec.sqrt_scaled else f"${symbol}/a$"


def note_profile_line(axes, run, spec):
    """The fixed coordinate in a corner above the frame; along the rod's path, which side is which."""
    other, at = ("y" if spec.along == "x" else "x"), line_of(run, spec)
    axes.annotate(f"${other} = {words.math_number(at)}" + (r"\,a$" if at else "$"), (1, 1), (0, 3), xycoords="axes fraction",
                  textcoords="offset points", ha="right", va="bottom", fontsize=9)
    if spec.along == "x":
        x, _ = rod_outline(run)
        look = dict(textcoords="offset points", xycoords=axes.get_xaxis_transform(), color=style.GREY, fontsize=8.5, va="bottom")
        left, right = axes.get_xlim()
        narrow = x[-1] - x[0] < 0.1 * (right - left)  # no room beside the word for what is in the middle
        axes.annotate("behind", (left if narrow else x[0], 0.02), (3 if narrow else -3, 0), ha="left" if narrow else "right", **look)
        axes.annotate("ahead", (right if narrow else x[-1], 0.02), (-3 if narrow else 3, 0), ha="right" if narrow else "left", **look)


def caption_profile(run, spec):
    parts = bed_run.holders(run, file_of(spec))
    what = f"<i>U<sub>{spec.component[1]}</sub></i>"
    known = any(np.isfinite(read_profile(run, spec, part)[2]).any() for part in parts)
    other, at = ("y" if spec.along == "x" else "x"), line_of(run, spec)
    text = (f"Measured displacement {what} of the beads along <i>{spec.along}</i> at "
            f"{words.equation(f'<i>{other}</i>', at, '<i>a</i>' if at else '')} in the frame of the {who(run)}, which heads along +<i>x</i>; "
            f"{'bars: standard error' if known else 'the error is unknown'}; shaded: {shaded(run)}. ")
    if view := fitted(run, spec):
        how_made = "predicted with what was fitted to other lines" if fit_words.predicted(view.profile) else "fitted to it"
        text += f"Line: theory {how_made}, {'not drawn' if run.fit.maps else 'thin'} within {words.number(run.fit.number(run.fit.record, 'core', 0.0))} <i>a</i> of the rod, where data are left out. "
    if spec.sqrt_scaled:
        text = text.replace("displacement ", f"|<i>{spec.along}</i>|<sup>1/2</sup>", 1)
        text += f"A level stretch is a fall-off as |<i>{spec.along}</i>|<sup>−1/2</sup>. "
    return text + how(parts[0]) + bed_run.not_measured(run, file_of(spec))


def how(part):
    """Estimator and reference, for this caption and the map's."""
    method, reference = part.value("displacement", "method"), part.value("displacement", "reference")
    blocks = part.number("displacement", "blocks")
    if not method:
        return ""
    text = f"Estimator: {words.escape(method)}"
    text += {"box": ", relative to the mean over the box", "far": ", relative to the far field"}.get(reference, "")
    return text + (f"; {words.number(blocks)} block{'' if blocks == 1 else 's'} of time." if blocks else ".")


def defaults_profile(run):
    specs = [Spec(f"profile_{component}_{along}", "profile", component=component, along=along) for component in ("Ux", "Uy")
             for along in ("x", "y")]
    specs.append(Spec("profile_Ux_x_scaled", "profile", sqrt_scaled=True))
    return [spec for spec in specs if bed_run.some(run, file_of(spec))]


# Displacement along lines, measured in the bed at the left and by the theory at the right, one row per component (paper, Fig. 6).

ROWS = (("Ux", False), ("Uy", False), ("Ux", True))  # component, times |x|^(1/2); as in the paper
BELOW = {("Ux", False): "<i>U<sub>x</sub></i> through the rod", ("Uy", False): "<i>U<sub>y</sub></i> beside the rod",
         ("Ux", True): "|<i>x</i>|<sup>1/2</sup><i>U<sub>x</sub></i>, in which a level stretch is a fall-off as |<i>x</i>|<sup>−1/2</sup>"}


def draw_theory_beside_bed(run, spec):
    rows = rows_of(run, spec)
    figure = canvas.figure(style.WIDE, 2.35 * len(rows) + 0.4)
    grid = figure.subplots(len(rows), 2, squeeze=False)
    for index, ((bed, theory), (left, right)) in enumerate(zip(rows, grid)):
        paint_profile(left, run, bed, bed_run.holders(run, file_of(bed)))
        paint_theory(right, run, theory, left.get_xlim())
        for side, axes in enumerate((left, right)):
            canvas.letter(axes, 2 * index + side)
    for axes, name in zip(grid[0], ("bed, periodic box", "theory, infinite plane") if on_plane(run) else ("bed", "theory")):
        canvas.heading(axes, name)
    figure.align_ylabels(grid)
    if spec.title:
        figure.suptitle(style.safe(spec.title), fontsize=11)
    return figure


def on_plane(run):
    """Whether the bed is periodic and the theory is not."""
    bed, medium = run.scene.get("granular") or {}, run.scene.get("medium") or {}
    return bool(bed) and "container" not in bed and "periodic" not in medium


def f_over_mu(run):
    """Of the fitted medium in bead radii; None where the theory has units of its own."""
    found = run.medium.get("f_over_mu_a") if isinstance(run.medium, dict) and not run.result.units.si else None
    return found if words.is_number(found) and found > 0 else None


def paint_theory(axes, run, line, window):
    """In bead radii and over the range of the bed, where f/mu is known in them."""
    scale = f_over_mu(run)
    if scale is None:
        field.paint_cut(axes, run, line)
        return
    cut = field.in_units(run.result.cut(line.cut), scale)
    kept = (cut.s >= window[0]) & (cut.s <= window[1])
    s, values = cut.s[kept], field.scaled(cut, line)[kept]
    axes.axhline(0, color=style.GREY, linewidth=0.6)
    axes.plot(*field.broken_at_rod(cut, s, values), color=style.LINE)
    axes.set(xlim=window, ylim=field.cut_limits(cut, line, s, values), xlabel=r"$x/a$", ylabel=ylabel(line))
    if tail := field.asymptote(run, run.result.cut(line.cut), line):
        field.draw_tail(axes, s[s < 0], tail(s[s < 0] / scale) * scale ** 1.5)
    field.mark_rod(axes, cut, s)
    field.note(axes, [f"$y = {words.math_number(float(cut.at), 2)}" + (r"\,a$" if cut.at else "$"), *field.medium_lines(run)],
               "best")


def rows_of(run, spec):
    """(spec of the profile, spec of the cut) of what both have along x: U_x through the rod, U_y beside it."""
    found = []
    for component, scaled in ROWS:
        index = cut_of(run.result, component, scaled)
        bed = replace(spec, kind="profile", title="", component=component, along="x", sqrt_scaled=scaled, x=(), y=())
        if index is not None and bed_run.some(run, file_of(bed)):
            found.append((bed, replace(bed, kind="cut", cut=index)))
    if not found:
        raise PlotError(f"{run.path}: holds no line along x both measured (measure.displacement) and of the theory ([[field.cuts]])")
    return found


def cut_of(result, component, farthest=False):
    """The first cut along x on the rod's axis, or beside it for U_y, which vanishes there, or that which reaches back farthest; None
    without one."""
    cuts = [result.cut(index) for index in range(result.cut_count())]
    found = [index for index, one in enumerate(cuts) if one.along == "x" and (one.at == 0) == (component == "Ux")]
    return min(found[:None if farthest else 1], key=lambda index: cuts[index].s.min(), default=None)


def caption_theory_beside_bed(run, spec):
    rows = rows_of(run, spec)
    bed, theory = rows[0]
    below = ", and ".join(BELOW[one.component, one.sqrt_scaled] for one, _ in rows[1:])
    scale = f_over_mu(run)
    at = run.result.cut(theory.cut).at * scale if scale else 0.0
    at = words.equation("<i>y</i>", at, "<i>a</i>" if at else "", 2) if scale else ""
    units = (f" Both sides are in bead radii, with {words.equation('<i>f</i>/<i>μ</i>', scale, '<i>a</i>', 3)}."
             + (" The bed is periodic and the theory is on the infinite plane, so they differ far from the rod." if on_plane(run) else "") if scale else "")
    return (f"Left, measured in the bed: {caption_profile(run, bed)} Right, theory: {field.caption_cut(run, theory, at)}{units}"
            + (f" Below: {below}." if below else ""))


def is_beside(run):
    return run.has_result and cut_of(run.result, "Ux") is not None and bed_run.some(run, "profile_Ux_x.csv")


KINDS = {
    "displacement_map": Kind(draw=draw_displacement_map, caption=caption_displacement_map, there=lambda run: bed_run.some_hold(run, "displacement")),
    "profile": Kind(draw=draw_profile, caption=caption_profile, defaults=defaults_profile),
    "theory_beside_bed": Kind(draw=draw_theory_beside_bed, caption=caption_theory_beside_bed, there=is_beside),
}
