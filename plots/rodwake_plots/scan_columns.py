"""The numbers of a scan's points: what each is called, for which points it means something, and its colours."""

import re
from typing import NamedTuple

import numpy as np
from matplotlib import colormaps
from matplotlib.colors import Normalize, to_rgba
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from . import canvas, style, words
from .errors import PlotError
from .scan_run import CAPTURED, OUTCOMES

WIDE, WIDE_TIMES = 30, 4  # positive numbers, and times, that span more than this factor are shown by their logarithm
BALANCED = colormaps["RdBu_r"]


class Quantity(NamedTuple):
    symbol: str      # mathtext without dollars; empty: described by words alone
    name: str        # in words
    unit: str        # length, time, rad, other words, or none
    signed: bool     # whether zero is a mark to see: colours diverge from it
    of: tuple = ()   # outcomes for which it means something; empty: all
    largest: float = 0.0  # of signed ones, where it is known


KNOWN = {
    "time": Quantity("t", "time to contact", "time", False, ("contact",)),
    "min_separation": Quantity("", "smallest separation", "length", False),
    "min_separation_time": Quantity("", "time of the smallest separation", "time", False),
    "final_separation": Quantity("", "final separation", "length", False),
    "final_angle": Quantity("", "final angle between the headings", "rad", True),
    "non_reciprocity": Quantity("", "turning asymmetry", "", True, largest=1.0),
    "pair_i": Quantity("", "first rod of the pair that met", "", False),
    "pair_j": Quantity("", "second rod of the pair that met", "", False),
    "capture_runs": Quantity("", "runs with noise", "", False),
    "rhs_evaluations": Quantity("", "evaluations of the right-hand side", "", False),
    "delta_y": Quantity(r"\Delta y", "change of separation", "a", True),
    "psi6": Quantity(r"\psi_6", "bond order", "", False),
    "T_xy": Quantity("T_{xy}", "horizontal temperature", "m²/s²", False),
    "T_z": Quantity("T_z", "vertical temperature", "m²/s²", False),
    "pressure": Quantity("p", "pressure", "N/m", False),
    "max_overlap": Quantity("", "largest overlap", "radii", False),
    "last_change": Quantity(r"\Delta y_\mathrm{end}", "change of separation at the end", "a", True),
    "separation": Quantity("", "separation of the orbit", "length", False, ("orbit",)),
    "omega": Quantity(r"\omega", "turning rate of the orbit", "", True, ("orbit",)),
    "leader": Quantity("", "rod that was ahead", "", False),
    "failed_runs": Quantity("", "runs that failed", "", False),
} | {name: Quantity("", f"share of runs that end in {name}" if name != "undecided" else "share of runs left undecided", "", False)
     for name in OUTCOMES if name != "finished"}
OF_BEDS = {"separation": Quantity("", "separation at the start", "a", False),
           "time": Quantity("t", "time to capture", "time", False, ("contact", "pursuit"))}  # a pursuit has the time of its lock
OF_RODS = {"mean_speed": ("v", "mean speed", "m/s"), "force": ("F", "mean force", "N")}
BESIDES = ("_error", "_low", "_high", "_runs")  # columns that say something of another one
MEANING = {
    "time": "pursuit is decided at the end of the run and has no time of its own",
    "non_reciprocity": "1: the rear rod alone turns, −1: the front rod alone, 0: both alike",
    "delta_y": "below zero the rods come together",
}


def meaning(name, scan):
    """What the number says, for captions; empty: its name says it."""
    return "" if scan.of_beds and name in OF_BEDS else MEANING.get(name, "")


def quantity(name, scan=None):
    if scan and scan.of_beds and name in OF_BEDS:
        return OF_BEDS[name]
    turn = re.fullmatch(r"turn(\d+)", name)
    if turn:
        return Quantity(rf"\Delta\theta_{{{turn[1]}}}", f"turn of rod {turn[1]}", "rad", True)
    of_rod = re.fullmatch(r"(mean_speed|force)(\d+)", name)
    if of_rod:
        symbol, description, unit = OF_RODS[of_rod[1]]
        return Quantity(f"{symbol}_{{{of_rod[2]}}}", f"{description} of rod {of_rod[2]}", unit, True)
    return KNOWN.get(name, Quantity("", name.replace("_", " "), "", False))


def names(scan):
    """Columns of numbers that are no axis and no error or interval of another column."""
    axes = {axis.key for axis in scan.axes}
    return [name for name, values in scan.columns.items()
            if not isinstance(values, list) and name not in axes
            and not any(name.endswith(end) and name.removesuffix(end) in scan.columns for end in BESIDES)]


def errors(scan, name):
    """[below, above][point]: standard errors, of shares the distances to the ends of their interval; nan where unknown."""
    values = np.asarray(scan.numbers(name), dtype=float)
    if f"{name}_low" in scan.columns:
        found = np.stack([values - scan.columns[f"{name}_low"], scan.columns[f"{name}_high"] - values])
    else:
        found = np.tile(scan.columns.get(f"{name}_error", np.full(values.shape, np.nan)), (2, 1))
    return np.where(np.isfinite(found) & (found > 0).any(axis=0), found, np.nan)


def values(scan, name):
    """The column, nan where it means nothing."""
    found = np.array(scan.numbers(name), dtype=float)
    found[scan.failed | ~np.isfinite(found)] = np.nan
    found[~means(scan, name)] = np.nan
    return found


def means(scan, name):
    """For which points the column means something."""
    of = quantity(name, scan).of or OUTCOMES
    return np.isin(scan.outcome, [OUTCOMES.index(one) for one in of])


def unit(run, name, extent):
    """(factor, unit as mathtext with dollars): of lengths and times those of the run."""
    column = quantity(name)
    if run.scan.of_beds and column.unit in ("length", "time"):
        return 1.0, {"length": "$a$", "time": r"$\mathrm{s}$"}[column.unit]
    if column.unit in ("length", "time"):
        made = run.units.length("L", extent) if column.unit == "length" else run.units.time("L", extent)
        return made.factor, made.label.split("$ ", 1)[1].strip("()") if run.units.si else rf"${REDUCED[column.unit]}$"
    if column.unit == "m/s":
        return 1e3, r"$\mathrm{mm/s}$"
    return 1.0, {"": "", "a": "$a$", "m²/s²": r"$\mathrm{m^2/s^2}$", "N": r"$\mathrm{N}$"}.get(column.unit, column.unit)


REDUCED = {"length": r"f/\mu", "time": r"f/\mu v_0"}


def unit_html(run, name, shown=True):
    """Of the number as figures and captions show it, or of the file."""
    plain = quantity(name).unit
    if run.scan.of_beds and plain in ("length", "time"):
        return {"length": "<i>a</i>", "time": "s"}[plain]
    return {"length": run.units.length_html(), "time": run.units.time_html(), "a": "<i>a</i>", "m/s": "mm/s" if shown else "m/s"}.get(plain, words.escape(plain))


def label(run, name, extent):
    """(factor, text) for an axis or a colour bar."""
    column = quantity(name, run.scan)
    factor, units = unit(run, name, extent)
    text = f"{column.name} ${column.symbol}$" if column.symbol else column.name
    return factor, f"{text} ({units})" if units else text


def scaling(name, shown):
    """(norm, extend, colour map) for these numbers, nan left out."""
    shown = shown[np.isfinite(shown)]
    if shown.size == 0:
        raise PlotError(f"column {name} holds no numbers{of_outcomes(name)}: nothing to draw")
    column, low, high = quantity(name), float(shown.min()), float(shown.max())
    if column.signed:
        reach = column.largest or canvas.nice(np.percentile(np.abs(shown), 99.5) or 1.0, up=True)
        return Normalize(-reach, reach), extend(shown, -reach, reach), BALANCED
    if low > 0 and high > (WIDE_TIMES if column.unit == "time" else WIDE) * low:
        return *canvas.log_norm(shown), style.FIELD_MAP
    if low == high:
        return Normalize(low - 0.5, high + 0.5), "neither", style.FIELD_MAP
    ends = np.percentile(shown, (0.5, 99.5)) if shown.size > 100 else (low, high)
    if ends[0] == ends[1]:
        ends = low, high
    return Normalize(*ends), extend(shown, *ends), style.FIELD_MAP


def of_outcomes(name):
    of = quantity(name).of
    return f" of points that end in {' or '.join(of)}" if of else ""


def extend(shown, low, high):
    room = 1e-9 * (high - low)
    return {(0, 0): "neither", (1, 0): "min", (0, 1): "max", (1, 1): "both"}[
        bool((shown < low - room).any()), bool((shown > high + room).any())]


# Outcomes have the same colours in every figure, and marks in every legend.

# Two blues, contact and pursuit, are one family; orbit, rare, is brown, bound purple. Any two of these and white differ by more than 30 (CIE Lab) with full and with any reduced colour
# vision; tests/plots/test_scan_pieces.py has the numbers.
COLOURS = {"contact": "#14589c", "pursuit": "#69b8ec", "escape": "#f5cb76", "undecided": "#a3a19c",
           "orbit": "#873c00", "bound": "#9300f2", "finished": "#6f8f7a"}  # the last stands alone
NOTHING = "#e4e4e1"  # where there is no number
CAPTURE = "capture = contact, bound, orbit or pursuit"
BOUNDARY = dict(color=style.INK, linewidth=0.6)
FAILED = dict(marker="x", color="#b3261e", linestyle="none")


def rgba(colour):
    """Four bytes."""
    return np.round(255 * np.array(to_rgba(colour))).astype(np.uint8)


def painted(codes):
    """Bytes of the colours of outcomes; transparent where there is none."""
    table = np.array([*(rgba(COLOURS[name]) for name in OUTCOMES), (0, 0, 0, 0)], dtype=np.uint8)
    return table[codes]  # -1 is the last


def without_number(codes):
    """Where a number is shown: pursuit, orbit and bound as themselves, captures without a time of their own, the others as nothing."""
    table = np.array([rgba(COLOURS[name] if name in ("pursuit", "orbit", "bound") else NOTHING) for name in (*OUTCOMES, "")], dtype=np.uint8)
    return table[codes]


def alike(x, y, codes):
    """Points in order along x with gaps where the outcome changes, as plot() takes them: no line joins what differs."""
    order = np.argsort(x, kind="stable")
    x, y, codes = (np.asarray(part)[order] for part in (x, y, codes))
    changes = np.flatnonzero(np.diff(codes)) + 1
    return np.insert(x, changes, np.nan), np.insert(y, changes, np.nan)


def outcome_handles(codes, failed, boundary):
    """Legend entries: the outcomes that occur, failed points with their number, the boundary by its name."""
    there = [name for index, name in enumerate(OUTCOMES) if (codes == index).any()]
    found = [Patch(facecolor=COLOURS[name], edgecolor="white", linewidth=0.4, label=name) for name in there]
    if boundary:
        found.append(Line2D([], [], **BOUNDARY, label=boundary))
    if failed:
        found.append(Line2D([], [], **FAILED, markersize=4.5, markeredgewidth=1.1, label=f"failed ({failed})"))
    return found


def outcomes_title(codes):
    """Of the legend: what capture means, where there is some."""
    return CAPTURE if any((codes == OUTCOMES.index(name)).any() for name in CAPTURED) else ""
