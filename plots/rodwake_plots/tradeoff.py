"""Work-precision diagrams of `rodwake tradeoff`: error against time and against right-hand sides, the Pareto front marked."""

import json
from pathlib import Path

import matplotlib
import numpy as np
from matplotlib.lines import Line2D

from . import canvas, files, style
from .errors import PlotError

FILE, SUMMARY = "tradeoff.csv", "tradeoff.json"
WORDS = ("method", "form", "field", "precision", "status")
METHODS = {"erk": 1, "adams": 2, "bdf": 0, "auto": 3}  # of style.ROD_COLOURS
FORMS = {"angle": "o", "director": "^", "dae": "s"}
LINES = ("-", "--", "-.", ":", (0, (5, 1, 1, 1, 1, 1)))
ERRORS = {"final_state": "error of the last state", "contact_time": "error of the contact time", "outcome": "share of outcomes that differ",
          "path": "error of the whole path"}


def has_rods(folder):
    return (Path(folder) / SUMMARY).is_file()


def write(folder, output=None):
    """Paths of the figures made."""
    path = Path(output or folder) / "figures" / "tradeoff.png"
    canvas.save(draw(Path(folder)), path)
    return [path]


def draw(folder):
    rows = files.read_csv(folder / FILE, text=WORDS)
    record = files.Record(folder / SUMMARY)
    figure = canvas.figure(style.WIDE, 3.9)
    axes = figure.subplots(1, 2, sharey=True)
    error = np.where(np.isfinite(rows["error"]) & (np.array(rows["status"]) == "ok"), rows["error"], np.nan)
    if not np.isfinite(error).any():
        raise PlotError(f"{folder / FILE}: no setting has a {record['error']}")
    floor = lowest(record, error)
    shown = np.maximum(error, floor)
    ways = sorted(set(zip(rows["field"], rows["table_tolerance"].astype(str), rows["precision"])), key=way_order)
    for part, column in zip(axes, ("seconds", "rhs_evaluations")):
        curves(part, rows, rows[column], shown, ways)
        front(part, rows[column], shown)
        part.axhline(floor, color=style.GREY, linewidth=0.7, linestyle=":")
        part.set(xscale="log", yscale="log")
    work = record["unit"].removeprefix("a ")
    axes[0].set(xlabel=f"CPU time of {record['unit']} (s)", ylabel=ERRORS[record["error"]])
    axes[1].set(xlabel=f"right-hand sides ({work})")
    axes[1].legend(handles=legend(rows, ways), loc="upper left", bbox_to_anchor=(1.0, 1.02), frameon=False, fontsize=8, handlelength=2.2)
    return figure


def lowest(record, error):
    """Errors below this are quoted as this; an error of 0 has no place on a logarithmic axis."""
    least = record["reference"]["least_error_quoted"][record["error"]]
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
        axes.plot(work[mine][order], error[mine][order], color=style.ROD_COLOURS[METHODS[key[0]]], marker=FORMS[key[1]], markersize=3, linewidth=0.8,
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
    handles = [line(name, color=style.ROD_COLOURS[METHODS[name]], linewidth=2) for name in dict.fromkeys(rows["method"])]
    handles += [line(name, marker=FORMS[name], linewidth=0, markersize=4) for name in dict.fromkeys(rows["form"])]
    handles += [line(way_words(way), linestyle=LINES[k % len(LINES)]) for k, way in enumerate(ways)] if len(ways) > 1 else []
    return handles + [line("not beaten", color=style.INK, linewidth=4.5, alpha=0.16), line("least quoted", linestyle=":", linewidth=0.7)]


def way_words(way):
    field, tolerance, precision = way
    if field == "table":
        return f"table {float(tolerance):g}"
    return field if precision == "full" else f"{field}, {precision}"


# What `rodwake tradeoff --of` measured of a bed, a fit or a field map: error against cost, way by way.

WAYS = "ways.json"
SHOWN = {"rod_speed": "rod speed", "T_xy": "$T_{xy}$", "T_z": "$T_z$", "psi6": r"$\psi_6$", "wake": "wake, $U_x(-8a, 0)$"}  # of a bed; others are in the table
LEAST = 1e-13
tab10 = matplotlib.colormaps["tab10"]
FIT_METHODS = ("slsqp", "lbfgs", "mma", "bobyqa", "nelder-mead", "mlsl", "crs", "isres", "direct-l")
QUANTITIES = {"optimum": "distance from the optimum ($\sigma$)", "interval": "shift of the 95 % interval (half widths)",
         "displacement": "displacement", "strain": "strain", "gradients": "gradients of strain"}


def has_ways(folder):
    return (Path(folder) / WAYS).is_file()


def write_ways(folder, output=None):
    """Paths of the figures made."""
    folder, output = Path(folder), Path(output or folder)
    record = json.loads((folder / WAYS).read_text(encoding="utf-8"))
    ways = [way for way in record["ways"] if way["found"]]
    if not ways:
        raise PlotError(f"{folder / WAYS}: no configuration has a result")
    path = output / "figures" / "ways.png"
    canvas.save({"bed": draw_bed, "fit": draw_fit, "field": draw_field}[record["of"]](ways), path)
    return [path]


def found_value(way, name):
    """None where there is none, or an error without bound."""
    return next((one for one in way["found"] if one["quantity"] == name and one["bias"] is not None), None)


def key_text(way, name):
    """The value of a key, as text."""
    return next((text.split("=", 1)[1].strip('"') for text in way["keys"] if text.startswith(name + "=")), "")


def key_number(way, name):
    return float(key_text(way, name).split()[0])


def draw_bed(ways):
    figure = canvas.figure(style.WIDE, 3.6)
    steps, costs = figure.subplots(1, 2)
    longest = key_number(ways[0], "granular.duration")
    often = key_text(ways[0], "measure.interval")
    full = [way for way in ways if key_number(way, "granular.duration") == longest and key_text(way, "measure.interval") == often]
    names = [name for name in SHOWN if any(found_value(way, name) for way in full)]
    if not names:
        raise PlotError(f"no configuration of the longest duration has a result for any of {', '.join(SHOWN)}")
    for k, name in enumerate(names):
        bias_against_step(steps, full, name, k, len(names))
    steps.axhline(0, color=style.GREY, linewidth=0.7)
    steps.set(xscale="log", xlabel="time step (s)", ylabel="difference from the shortest step (%)")
    steps.legend(frameon=False, fontsize=8)
    error_against_cost(costs, ways, full, names[0])
    return figure


def bias_against_step(axes, ways, name, k, count):
    """Shifted a little, so that error bars do not hide each other; they are standard errors."""
    shift = 1.06 ** (k - 0.5 * (count - 1))
    there = [(key_number(way, "granular.time_step") * shift, found_value(way, name)) for way in ways if found_value(way, name)]
    size = there[0][1]["scale"] or 1.0
    axes.errorbar([x for x, _ in there], [100 * one["bias"] / size for _, one in there], [100 * one["bias_error"] / size for _, one in there],
                  fmt="o", markersize=3, capsize=2, linewidth=0.9, color=style.ROD_COLOURS[k % len(style.ROD_COLOURS)], label=SHOWN[name])


def error_against_cost(axes, ways, full, name):
    """sqrt(b^2 + s^2/n) against the CPU time of n runs: down with the number of runs, to the bias."""
    lines = 0
    for way in ways:
        one = found_value(way, name)
        if one is None:
            continue
        bias = max(0.0, one["bias"] ** 2 - one["bias_error"] ** 2) ** 0.5
        runs = np.logspace(0, 4, 101)
        axes.plot(way["seconds"] * runs / 3600, 100 * np.hypot(bias, one["scatter"] / np.sqrt(runs)) / (one["scale"] or 1.0), linewidth=1.0,
                  color=style.ROD_COLOURS[lines % len(style.ROD_COLOURS)], linestyle="-" if way in full else "--", label=bed_way_words(way, way in full))
        lines += 1
    axes.set(xscale="log", yscale="log", xlabel="CPU time of all runs (h)", ylabel=f"error of the {SHOWN.get(name, name)} (%)")
    axes.legend(frameon=False, fontsize=7, title="time step", title_fontsize=8)


def bed_way_words(way, full):
    words = f"{key_number(way, 'granular.time_step'):.3g} s"
    if full:
        return words
    return words + f", {key_text(way, 'granular.duration')} long" + (f", measured every {key_text(way, 'measure.interval')}" if key_text(way, "measure.interval") else "")


def draw_fit(ways):
    figure = canvas.figure(style.WIDE, 3.6)
    panels = figure.subplots(1, 2)
    for axes, name in zip(panels, ("optimum", "interval")):
        for way in ways:
            one = found_value(way, name)
            if one is None:
                continue
            axes.plot(1e3 * way["seconds"], max(one["bias"], LEAST), linewidth=0, markersize=4, marker=fit_marker(way), color=fit_colour(way),
                      markerfacecolor=fit_colour(way) if key_text(way, "fit.polish") == "true" else "none")
        axes.set(xscale="log", yscale="log", xlabel="CPU time of a fit (ms)", ylabel=QUANTITIES[name])
    panels[1].legend(handles=fit_legend(ways), loc="upper left", bbox_to_anchor=(1.0, 1.02), frameon=False, fontsize=8)
    return figure


def fit_colour(way):
    return tab10(FIT_METHODS.index(key_text(way, "fit.method")))


def fit_marker(way):
    if key_text(way, "fit.likelihood") != "[]":
        return "*"
    return "o" if key_text(way, "fit.starts") == "1" else "s"


def fit_legend(ways):
    used = [method for method in FIT_METHODS if any(key_text(way, "fit.method") == method for way in ways)]
    look = {"linewidth": 0, "markersize": 4}
    return [Line2D([], [], color=tab10(FIT_METHODS.index(method)), label=method, linewidth=2) for method in used] + [
        Line2D([], [], color=style.GREY, marker="o", label="1 start", **look), Line2D([], [], color=style.GREY, marker="s", label="10 starts", **look),
        Line2D([], [], color=style.GREY, marker="*", label="and likelihood", **look),
        Line2D([], [], color=style.GREY, marker="o", markerfacecolor="none", label="not polished", **look)]


def draw_field(ways):
    figure = canvas.figure(style.SINGLE, 3.2)
    axes = figure.subplots()
    for k, name in enumerate(("displacement", "strain", "gradients")):
        axes.plot([1e3 * way["seconds"] for way in ways], [found_value(way, name)["bias"] for way in ways], marker="o^s"[k], markersize=4, linewidth=0,
                  color=style.ROD_COLOURS[k], label=QUANTITIES[name])
    for k, way in enumerate(ways):
        exact = key_text(way, "medium.field") == "exact"
        label = "exact" if exact else f"table to {key_text(way, 'medium.table.tolerance')}"
        axes.annotate(label, (1e3 * way["seconds"], found_value(way, "strain")["bias"]), textcoords="offset points", xytext=(0, 6), fontsize=7, ha="center")
    axes.margins(x=0.15, y=0.12)
    axes.set(xscale="log", yscale="log", xlabel="CPU time of the map (ms)", ylabel="largest relative error")
    axes.legend(frameon=False, fontsize=8, loc="center right")
    return figure
