"""One number of each run of a series of runs, against what the runs differ in (paper, Figs. hop a, micro a, trajectory d, rel_fv)."""

import re
from typing import NamedTuple

import numpy as np

from . import bed_run, canvas, fit_words, schema, style, words
from .errors import PlotError
from .schema import Kind, Spec

# What the schema says in words alone, or in another unit than figures have.
NAMED_ELSE = {"delta_y": "half_box_change"}  # in measure.json
SYMBOLS = {"stiffness": r"$1/(s\,\tilde{\Delta}(s))|_{s\to 0}$", "force": "$F$", "c_T": "$c_T$"}
UNITS = {"µN": "N", "1/s": r"\mathrm{s}^{-1}"}  # N gets a prefix
SIGNED = ("stiffness", "delta_y", "non_reciprocity", "force", "speed", "D_r", "diffusion_per_length")  # zero is a mark to see
ASIDE = 0.014  # of the range
CLASSES = (("o", "liquid"), ("s", "hexatic"), ("^", "crystal"))  # g_B falls exponentially, as a power, not to zero


class Group(NamedTuple):
    """Runs alike but for what stands on the x axis, in its order."""
    label: str
    x: np.ndarray
    y: np.ndarray
    sigma: np.ndarray
    kind: np.ndarray  # of decay; -1: not known


class Quantity(NamedTuple):
    label: str
    unit: str
    words: str     # for the caption
    factor: float


def quantity_of(name):
    """As the schema describes it among the values of its measure."""
    measure = re.match(r"measure\.(\w+)", schema.FIGURES["series"]["quantities"][name])[1]
    entry = next(one for one in schema.MEASURED if (one["measure"], one["key"]) == (measure, NAMED_ELSE.get(name, name)))
    symbol = re.search(r"\$.*\$", entry["title"])
    unit = r"\mathrm{mm/s}" if name == "speed" else UNITS.get(entry["unit"]) or fit_words.unit_math(entry["unit"]).strip("$")
    what = entry["meaning"].split(";")[0]  # what follows is for the table in which it stands
    return Quantity(SYMBOLS.get(name) or (symbol[0] if symbol else entry["title"].lower()), unit,
                    f"{words.text_html(entry['title'])}: {words.text_html(what)}", 1.0 if unit == "N" else entry["factor"])


def draw(run, spec):
    groups, quantity = read(run, spec), quantity_of(spec.quantity)
    figure, axes = canvas.curve_panel(len(groups))
    if spec.quantity in SIGNED:
        axes.axhline(0, color=style.GREY, linewidth=0.6)
    if spec.quantity == "exponent":
        axes.axhline(0.25, **canvas.FAINT)
    factor, unit = scale(groups, quantity)
    for index, (group, colour) in enumerate(zip(apart(groups, spec), canvas.colours(len(groups)))):
        draw_group(axes, spec, group._replace(y=group.y * factor, sigma=group.sigma * factor), colour, index)
    axes.set(xlabel=xlabel(spec.against), ylabel=f"{quantity.label} (${unit}$)" if unit else quantity.label)
    if spec.quantity == "psi6":
        axes.set_ylim(0, 1.02)
    if spec.quantity in ("force", "speed") and spec.against == "imposed_speed":
        axes.set_xlim(left=0)
    canvas.legend(axes)
    canvas.heading(axes, style.safe(spec.title))
    return figure


def xlabel(against):
    symbol, unit, _ = bed_run.AGAINST[against]
    return f"${symbol}$" + (f" (${unit[2:]}$)" if unit else "")


def apart(groups, spec):
    """Groups moved a little along the axis, so that their bars do not hide each other; not where a line is fitted."""
    if fitted(spec):
        return groups
    x = np.concatenate([group.x for group in groups])
    step = ASIDE * np.ptp(x)
    return [group._replace(x=group.x + step * (index - (len(groups) - 1) / 2)) for index, group in enumerate(groups)]


def scale(groups, quantity):
    if quantity.unit != "N":
        return quantity.factor, quantity.unit
    factor, prefix = words.prefix_for(max(np.nanmax(np.abs(group.y)) for group in groups))
    return factor, rf"\mathrm{{{prefix}N}}"


def read(run, spec):
    path = run.path / bed_run.SERIES
    columns = bed_run.series(run)
    x, y = (columns[name] for name in (spec.against, spec.quantity))
    kept = np.flatnonzero(np.isfinite(x) & np.isfinite(y))
    if kept.size == 0:
        raise PlotError(f"{path}: holds no row with both {spec.against} and {spec.quantity}: nothing to draw; switch the measure on in "
                        "[measure], and name the runs in [[variants]]")
    nothing = np.full(x.size, np.nan)
    sigma = bed_run.known_errors(columns.get(f"{spec.quantity}_error", nothing))
    kind = np.nan_to_num(columns.get("class", nothing), nan=-1).astype(int)
    members = {}
    for index in kept[np.argsort(x[kept], kind="stable")]:
        members.setdefault(distinct_label(columns, spec.against, index, kept), []).append(index)
    return [Group(label, x[rows], y[rows], sigma[rows], kind[rows]) for label, rows in sorted(members.items(), key=lambda one: min(one[1]))]


def measured_in(run):
    """(quantity, against) of what series.csv holds two points or more of."""
    if not (run.path / bed_run.SERIES).is_file():
        return []
    columns = bed_run.series(run)
    found = []
    for quantity in schema.FIGURES["series"]["quantities"]:
        kept = np.isfinite(columns.get(quantity, np.empty(0)))
        against = [key for key in bed_run.AGAINST if key in columns and differ(columns[key][kept])]
        found += [(quantity, against[0])] if against else []
    return found


def differ(values):
    return len({f"{value:.3g}" for value in values if np.isfinite(value)}) > 1


def distinct_label(columns, against, row, rows):
    """A row's label: what, besides the x axis, the rows differ in."""
    parts = []
    for key, (symbol, unit, _) in bed_run.AGAINST.items():
        values = columns.get(key)
        if key == against or values is None or len({f"{value:.3g}" for value in values[rows]}) < 2:
            continue
        parts.append(rf"${symbol} = {values[row]:.3g}{unit}$" if np.isfinite(values[row]) else rf"no ${symbol}$")
    return ", ".join(parts)


def fitted(spec):
    """Force against the speed it was dragged at: a line, and one through the origin."""
    return spec.quantity == "force" and spec.against == "imposed_speed"


def draw_group(axes, spec, group, colour, index):
    if fitted(spec) and can_fit(group.x, group.sigma):
        draw_fits(axes, group, colour)
    elif len(group.x) > 1:
        axes.plot(group.x, group.y, color=style.GREY if by_class(spec, group) else colour, linewidth=0.7, alpha=0.55, zorder=2)
    if not by_class(spec, group):
        canvas.points(axes, group.x, group.y, group.sigma, colour, group.label or None, canvas.curve_mark(index))
        return
    for kind, (mark, name) in enumerate(CLASSES):
        of = group.kind == kind
        if of.any():
            canvas.points(axes, group.x[of], group.y[of], group.sigma[of], style.CURVES[kind], name, mark)
    rest = group.kind < 0
    if rest.any():
        canvas.points(axes, group.x[rest], group.y[rest], group.sigma[rest], style.GREY, "not classified", "x")


def by_class(spec, group):
    """Whether the marks tell how g_B decays; several groups need them to be distinguished."""
    return spec.quantity in ("psi6", "exponent") and (group.kind >= 0).any() and not group.label


def draw_fits(axes, group, colour):
    """The weighted line with its band, and the best line through the origin."""
    line, through = fits(group)
    x = np.linspace(0, group.x.max() * 1.04, 60)
    axes.fill_between(x, line(x) - line.sigma(x), line(x) + line.sigma(x), color=colour, alpha=0.18, linewidth=0)
    axes.plot(x, line(x), color=colour, linewidth=1.1, label=None if group.label else r"$F_0 + c\,v$")
    axes.plot(x, through(x), color=colour, linewidth=1.0, linestyle=(0, (5, 3)), label=None if group.label else r"$\propto v$")


def fits(group):
    usable = np.isfinite(group.sigma)
    x, y, sigma = group.x[usable], group.y[usable], group.sigma[usable]
    return fit_line(x, y, sigma), fit_line(x, y, sigma, proportional=True)


def caption(run, spec):
    groups = read(run, spec)
    text = f"{quantity_of(spec.quantity).words}, against {bed_run.AGAINST[spec.against][2]}, one point a run or ensemble of runs; bars: standard error."
    if spec.quantity == "exponent":
        text += " Broken line: 1/4, where a hexatic phase ends."
    unknown = sum(int(np.isnan(group.sigma).sum()) for group in groups)
    if unknown:
        text += f" {unknown} point{'s have' if unknown > 1 else ' has'} no known error."
    if len(groups) > 1 and not fitted(spec):
        text += " The groups are moved a little apart along the axis."
    return text + "".join(describe_fit(group) for group in groups if fitted(spec))


def describe_fit(group):
    who = f"{words.label_html(group.label)}: " if group.label else ""
    if not can_fit(group.x, group.sigma):
        return f" {who}No line is fitted: that needs three points of known error at different speeds."
    line, through = fits(group)
    (at_rest, slope), (error, slope_error) = line.values, line.errors
    return (f" {who}Line with band, weighted fit <i>F</i> = <i>F</i><sub>0</sub> + <i>cv</i>: <i>F</i><sub>0</sub> = "
            f"{words.with_error(at_rest, error, 1e6)} µN, <i>c</i> = {words.with_error(slope, slope_error, 1e6)} µN s/mm, "
            f"{chi2(line)}. Broken line, <i>F</i> ∝ <i>v</i>: {words.with_error(through.values[0], through.errors[0], 1e6)} µN s/mm, "
            f"{chi2(through)}.")


def chi2(fit):
    return f"<i>χ</i>² = {words.number(fit.chi2, 3)} for {fit.dof} degree{'' if fit.dof == 1 else 's'} of freedom"


def defaults(run):
    return [Spec(f"series_{what}", "series", quantity=what, against=against) for what, against in measured_in(run)]


# A straight line through points with errors, by weighted least squares: y = intercept + slope x, or proportional.

class LineFit(NamedTuple):
    values: np.ndarray      # intercept and slope, or the slope alone
    covariance: np.ndarray  # from the given errors
    chi2: float
    dof: int

    def __call__(self, x):
        return line_basis(x, len(self.values)) @ self.values

    def sigma(self, x):
        rows = line_basis(x, len(self.values))
        return np.sqrt(np.einsum("ij,jk,ik->i", rows, self.covariance, rows))

    @property
    def errors(self):
        return np.sqrt(np.diag(self.covariance))


def line_basis(x, count):
    x = np.atleast_1d(np.asarray(x, dtype=float))
    return np.column_stack([np.ones_like(x), x][2 - count:])


def fit_line(x, y, sigma, proportional=False):
    rows = line_basis(x, 1 if proportional else 2)
    weighted = rows / sigma[:, None]
    covariance = np.linalg.inv(weighted.T @ weighted)
    values = covariance @ (weighted.T @ (y / sigma))
    chi2 = float((((y - rows @ values) / sigma) ** 2).sum())
    return LineFit(values, covariance, chi2, len(y) - len(values))


def can_fit(x, sigma):
    """Three points of known error at two places or more."""
    usable = np.isfinite(sigma)
    return usable.sum() >= 3 and np.ptp(x[usable]) > 0


KINDS = {"series": Kind(draw=draw, caption=caption, defaults=defaults)}
