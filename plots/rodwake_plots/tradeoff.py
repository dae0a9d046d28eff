"""Work-precision diagrams of `rodwake tradeoff`: error against time and against right-hand sides, the Pareto front marked."""

import numpy as np
from matplotlib.lines import Line2D

from . import canvas, csv_columns, style
from .errors import PlotError

FILE, TOLD = "tradeoff.csv", "tradeoff.json"
WORDS = ("method", "form", "field", "precision", "status")
METHODS = {"erk": style.ROD_COLOURS[1], "adams": style.ROD_COLOURS[2], "bdf": style.ROD_COLOURS[0], "auto": style.ROD_COLOURS[3]}
FORMS = {"angle": "o", "director": "^", "dae": "s"}
LINES = ("-", "--", "-.", ":", (0, (5, 1, 1, 1, 1, 1)))
ERRORS = {"final_state": "error of the last state", "contact_time": "error of the contact time", "outcome": "share of outcomes that differ",
          "path": "error of the whole path"}


def write(run):
    """Paths of the figures made."""
    path = run.figures_dir / "tradeoff.png"
    canvas.save(draw(run), path)
    return [path]


def draw(run):
    rows, told = table(run)
    figure = canvas.figure(style.WIDE, 3.9)
    axes = figure.subplots(1, 2, sharey=True)
    error = np.where(np.isfinite(rows["error"]) & (np.array(rows["status"]) == "ok"), rows["error"], np.nan)
    if not np.isfinite(error).any():
        raise PlotError(f"{run.path / FILE}: no setting has a {told['error']}")
    floor = lowest(told, error)
    shown = np.maximum(error, floor)
    ways = sorted(set(zip(rows["field"], rows["table_tolerance"].astype(str), rows["precision"])), key=way_order)
    for part, column in zip(axes, ("seconds", "rhs_evaluations")):
        curves(part, rows, rows[column], shown, ways)
        front(part, rows[column], shown)
        part.axhline(floor, color=style.GREY, linewidth=0.7, linestyle=":")
        part.set(xscale="log", yscale="log")
    work = told["unit"].removeprefix("a ")
    axes[0].set(xlabel=f"CPU time of {told['unit']} (s)", ylabel=ERRORS[told["error"]])
    axes[1].set(xlabel=f"right-hand sides ({work})")
    axes[1].legend(handles=legend(rows, ways), loc="upper left", bbox_to_anchor=(1.0, 1.02), frameon=False, fontsize=8, handlelength=2.2)
    return figure


def table(run):
    return csv_columns.read_with_gaps(run.path / FILE, text=WORDS), run.tradeoff


def lowest(told, error):
    """Errors below this are quoted as this; an error of 0 has no place on a logarithmic axis."""
    least = told["reference"]["least_error_quoted"][told["error"]]
    if isinstance(least, float) and least > 0:
        return least
    positive = error[error > 0]
    return 0.3 * np.nanmin(positive) if positive.size else 1e-3


def way_order(way):
    field, tolerance, precision = way
    return (field != "exact", precision != "full", precision, -float(tolerance))


def curves(axes, rows, work, error, ways):
    """A line for each way to solve, from loose to tight."""
    keys = list(zip(rows["method"], rows["form"], rows["field"], rows["table_tolerance"].astype(str), rows["precision"]))
    for key in dict.fromkeys(keys):
        mine = np.array([one == key for one in keys])
        order = np.argsort(-rows["tolerance"][mine])
        axes.plot(work[mine][order], error[mine][order], color=METHODS[key[0]], marker=FORMS[key[1]], markersize=3, linewidth=0.8,
                  linestyle=LINES[ways.index(key[2:]) % len(LINES)], alpha=0.85)


def front(axes, work, error):
    """Settings that no other one beats."""
    order = np.lexsort((error, work))
    best, x, y = np.inf, [], []
    for k in order:
        if np.isfinite(error[k]) and error[k] < best:
            best = error[k]
            x.append(work[k])
            y.append(error[k])
    axes.plot(x, y, color=style.INK, linewidth=4.5, alpha=0.16, solid_capstyle="round", zorder=0)


def legend(rows, ways):
    def line(label, **look):
        return Line2D([], [], label=label, **({"color": style.GREY, "linewidth": 1.1} | look))
    told = [line(name, color=METHODS[name], linewidth=2) for name in dict.fromkeys(rows["method"])]
    told += [line(name, marker=FORMS[name], linewidth=0, markersize=4) for name in dict.fromkeys(rows["form"])]
    told += [line(way_words(way), linestyle=LINES[k % len(LINES)]) for k, way in enumerate(ways)] if len(ways) > 1 else []
    return told + [line("not beaten", color=style.INK, linewidth=4.5, alpha=0.16), line("least quoted", linestyle=":", linewidth=0.7)]


def way_words(way):
    field, tolerance, precision = way
    if field == "table":
        return f"table {float(tolerance):g}"
    return field if precision == "full" else f"{field}, {precision}"
