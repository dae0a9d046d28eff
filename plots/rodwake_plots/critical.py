"""Critical values of a scan: curves with their ranges along its first axis, one set for each value of the others."""

from typing import NamedTuple

import numpy as np

from . import canvas, files, scan_run, scan_words, style, words
from .errors import PlotError
from .schema import Kind, Spec

FILE = "critical.csv"
KINDS_OF_VALUES = {"grazing": "-", "separatrix": "--", "unbinding": ":", "fold": "-."}  # and how their curves are drawn
MOST = 9  # more families than this are thinned out


class Branch(NamedTuple):
    """Values of one family that continue each other, of one kind."""
    family: int
    kind: str
    x: np.ndarray
    value: np.ndarray
    low: np.ndarray
    high: np.ndarray


def there(run):
    return run.has_scan and (run.scan.folder / FILE).is_file() and len(run.scan.axes) > 1


def read(run):
    """(Branches, names of the families in figures, in captions); the last axis of the scan is the key that was solved for."""
    scan = run.scan
    path, others = scan.folder / FILE, scan.axes[:-1]
    if not others:
        raise PlotError(f"{path}: critical values at one point make no curve; give [[scan.axes]]")
    if any(axis.is_choice for axis in others[:1]):
        raise PlotError(f"{path}: the first axis holds words, so values make no curve")
    choices = [axis.key for axis in others if axis.is_choice]
    table = files.read_csv(path, text=("kind", "below", "above", *choices), needed=["value", "low", "high", "kind", "branch"])
    if not len(table["value"]):
        raise PlotError(f"{path}: holds no critical values; critical.json has the reason")
    rest = np.stack([table[axis.key] if not axis.is_choice else np.array([axis.values.index(word) for word in table[axis.key]], dtype=float)
                     for axis in others[1:]], axis=-1) if others[1:] else np.zeros((len(table["value"]), 0))
    kinds, family = np.unique(rest, axis=0, return_inverse=True)
    shown = np.unique(np.linspace(0, len(kinds) - 1, min(MOST, len(kinds))).round().astype(int))
    fixed = [[(axis, float(value)) for axis, value in zip(others[1:], kind)] for kind in kinds[shown]]
    branches = []
    for number, index in enumerate(shown):
        for branch in np.unique(table["branch"][family.ravel() == index]):
            for kind in KINDS_OF_VALUES:
                rows = np.flatnonzero((family.ravel() == index) & (table["branch"] == branch) & np.array([one == kind for one in table["kind"]]))
                rows = rows[np.argsort(table[others[0].key][rows], kind="stable")]
                if rows.size:
                    branches.append(Branch(number, kind, *(table[name][rows] for name in (others[0].key, "value", "low", "high"))))
    names = [tuple(", ".join(say(axis, value) for axis, value in each) for say in (scan_run.Axis.equals, scan_run.Axis.equals_html)) for each in fixed]
    return branches, names


def draw(run, spec):
    scan = run.scan
    branches, names = read(run)
    first, solved = scan.axes[0], scan.axes[-1]
    figure, axes = canvas.curve_panel(len(names) + len({branch.kind for branch in branches}))
    colours = canvas.colours(len(names))
    for branch in branches:
        x = branch.x * first.factor
        axes.fill_between(x, branch.low * solved.factor, branch.high * solved.factor, color=colours[branch.family], alpha=0.3, linewidth=0)
        axes.plot(x, branch.value * solved.factor, KINDS_OF_VALUES[branch.kind], marker=".", markersize=3, linewidth=1, color=colours[branch.family])
    for (name, _), colour in zip(names, colours):
        if name:
            axes.plot([], [], "-", color=colour, label=name)
    for kind, line in KINDS_OF_VALUES.items():
        if any(branch.kind == kind for branch in branches):
            axes.plot([], [], line, color=style.GREY, label=kind)
    x = scan_run.shown_window(first, spec.x, "x") if spec.x else scan_run.margin(first, 0.02)
    first.dress(axes.xaxis, *x)
    low, high = (min(branch.value.min() for branch in branches), max(branch.value.max() for branch in branches))
    even = solved.even(np.array([low, high]))
    room = 0.06 * (float(even[1] - even[0]) or 0.2 * (abs(float(even[0])) or 1.0))
    solved.dress(axes.yaxis, *(spec.y or (float(place) for place in solved.back(even + [-room, room]))))
    canvas.legend(axes)
    canvas.heading(axes, style.safe(spec.title) or scan_words.fixed_title(run))
    return figure


def caption(run, spec):
    branches, names = read(run)
    solved, record = run.scan.axes[-1], files.Record(run.scan.folder / "critical.json")
    widest = max(float(np.max((branch.high - branch.low) / np.maximum(np.abs(branch.value), 1e-300))) for branch in branches)
    count = sum(branch.value.size for branch in branches)
    between = " and ".join(str(one) for one in record.need("between"))
    text = f"Critical values of {solved.name_html} between {words.escape(between)} against {run.scan.axes[0].name_html}: {count} values"
    text += ", by kind " + words.listed([f"{kind} {sum(branch.value.size for branch in branches if branch.kind == kind)}"
                                         for kind in KINDS_OF_VALUES if any(branch.kind == kind for branch in branches)])
    text += f". Bands are their ranges, at most {widest:.1e} of the value."
    none = sum(point["status"] == "none" for point in record.need("points"))
    if none:
        text += f" {none} of {len(record.need('points'))} points have none."
    return text + scan_words.fixed_html(run)


def defaults(run):
    if not there(run) or run.scan.axes[0].is_choice or not files.Record(run.scan.folder / "critical.json").need("values"):
        return []
    return [Spec("critical_values", "critical_values")]


KINDS = {"critical_values": Kind(draw=draw, caption=caption, defaults=defaults)}
