"""Displacement along lines, measured in the bed at the left and by the theory at the right, a row a component (paper, Fig. ufield)."""

from dataclasses import replace

from . import canvas, cut, measured, profile, style
from .errors import PlotError
from .spec import Spec

ROWS = (("Ux", False), ("Uy", False), ("Ux", True))  # component, times |x|^(1/2); as in the paper
BELOW = {("Ux", False): "<i>U<sub>x</sub></i> through the rod", ("Uy", False): "<i>U<sub>y</sub></i> beside the rod",
         ("Ux", True): "|<i>x</i>|<sup>1/2</sup><i>U<sub>x</sub></i>, in which a level stretch is a fall-off as |<i>x</i>|<sup>−1/2</sup>"}


def draw(run, spec):
    rows = rows_of(run, spec)
    figure = canvas.figure(style.WIDE, 2.35 * len(rows) + 0.4)
    grid = figure.subplots(len(rows), 2, squeeze=False)
    for index, ((bed, theory), (left, right)) in enumerate(zip(rows, grid)):
        profile.paint(left, run, bed, measured.holders(run, profile.file_of(bed)))
        cut.paint(right, run, theory)
        for side, axes in enumerate((left, right)):
            canvas.letter(axes, 2 * index + side)
    for axes, name in zip(grid[0], ("bed", "theory")):
        canvas.heading(axes, name)
    figure.align_ylabels(grid)
    if spec.title:
        figure.suptitle(style.safe(spec.title), fontsize=11)
    return figure


def rows_of(run, spec):
    """(spec of the profile, spec of the cut) of what both have along x: U_x through the rod, U_y beside it."""
    found = []
    for component, scaled in ROWS:
        index = cut_of(run.result, component, scaled)
        bed = replace(spec, kind="profile", title="", component=component, along="x", sqrt_scaled=scaled, x=(), y=())
        if index is not None and measured.some(run, profile.file_of(bed)):
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


def caption(run, spec):
    rows = rows_of(run, spec)
    bed, theory = rows[0]
    below = ", and ".join(BELOW[one.component, one.sqrt_scaled] for one, _ in rows[1:])
    return (f"Left, measured in the bed: {profile.caption(run, bed)} Right, of the theory: {cut.caption(run, theory)}"
            + (f" Below: {below}." if below else ""))


def defaults(run):
    there = run.has_result and cut_of(run.result, "Ux") is not None and measured.some(run, "profile_Ux_x.csv")
    return [Spec("theory_beside_bed", "theory_beside_bed")] if there else []
