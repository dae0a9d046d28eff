"""What `rodwake tradeoff --of` measured of a bed, a fit or a field map: error against cost, way by way."""

import json
from pathlib import Path

import numpy as np
from matplotlib.lines import Line2D

from . import canvas, style
from .errors import PlotError

FILE = "ways.json"
SHOWN = {"rod_speed": "rod speed", "T_xy": "$T_{xy}$", "T_z": "$T_z$", "psi6": r"$\psi_6$", "wake": "wake, $U_x(-8a, 0)$"}  # of a bed; others are in the table
LEAST = 1e-13
METHODS = ("slsqp", "lbfgs", "mma", "bobyqa", "nelder-mead", "mlsl", "crs", "isres", "direct-l")
WORDS = {"optimum": "distance from the optimum (standard errors)", "interval": "shift of the 95 % interval (half widths)",
         "displacement": "displacement", "strain": "strain", "gradients": "gradients of strain"}


def is_there(folder):
    return (Path(folder) / FILE).is_file()


def write(folder, output=None):
    """Paths of the figures made."""
    folder, output = Path(folder), Path(output or folder)
    told = json.loads((folder / FILE).read_text(encoding="utf-8"))
    ways = [way for way in told["ways"] if way["found"]]
    if not ways:
        raise PlotError(f"{folder / FILE}: no way has a result")
    path = output / "figures" / "ways.png"
    canvas.save({"bed": draw_bed, "fit": draw_fit, "field": draw_field}[told["of"]](ways), path)
    return [path]


def found(way, name):
    """None where there is none, or an error without bound."""
    return next((one for one in way["found"] if one["quantity"] == name and one["bias"] is not None), None)


def key(way, name):
    """The value of a key, as text."""
    return next((text.split("=", 1)[1].strip('"') for text in way["keys"] if text.startswith(name + "=")), "")


def number(way, name):
    return float(key(way, name).split()[0])


def draw_bed(ways):
    figure = canvas.figure(style.WIDE, 3.6)
    steps, costs = figure.subplots(1, 2)
    longest = number(ways[0], "granular.duration")
    often = key(ways[0], "measure.interval")
    full = [way for way in ways if number(way, "granular.duration") == longest and key(way, "measure.interval") == often]
    names = [name for name in SHOWN if any(found(way, name) for way in full)]
    if not names:
        raise PlotError(f"no way of the longest duration has a result for any of {', '.join(SHOWN)}")
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
    there = [(number(way, "granular.time_step") * shift, found(way, name)) for way in ways if found(way, name)]
    size = there[0][1]["scale"] or 1.0
    axes.errorbar([x for x, _ in there], [100 * one["bias"] / size for _, one in there], [100 * one["bias_error"] / size for _, one in there],
                  fmt="o", markersize=3, capsize=2, linewidth=0.9, color=style.ROD_COLOURS[k % len(style.ROD_COLOURS)], label=SHOWN[name])


def error_against_cost(axes, ways, full, name):
    """sqrt(b^2 + s^2/n) against the CPU time of n runs: down with the number of runs, to the bias."""
    lines = 0
    for way in ways:
        one = found(way, name)
        if one is None:
            continue
        bias = max(0.0, one["bias"] ** 2 - one["bias_error"] ** 2) ** 0.5
        runs = np.logspace(0, 4, 101)
        axes.plot(way["seconds"] * runs / 3600, 100 * np.hypot(bias, one["scatter"] / np.sqrt(runs)) / (one["scale"] or 1.0), linewidth=1.0,
                  color=style.ROD_COLOURS[lines % len(style.ROD_COLOURS)], linestyle="-" if way in full else "--", label=way_words(way, way in full))
        lines += 1
    axes.set(xscale="log", yscale="log", xlabel="CPU time of all runs (h)", ylabel=f"error of the {SHOWN.get(name, name)} (%)")
    axes.legend(frameon=False, fontsize=7, title="time step", title_fontsize=8)


def way_words(way, full):
    words = f"{number(way, 'granular.time_step'):.3g} s"
    if full:
        return words
    return words + f", {key(way, 'granular.duration')} long" + (f", measured every {key(way, 'measure.interval')}" if key(way, "measure.interval") else "")


def draw_fit(ways):
    figure = canvas.figure(style.WIDE, 3.6)
    panels = figure.subplots(1, 2)
    for axes, name in zip(panels, ("optimum", "interval")):
        for way in ways:
            one = found(way, name)
            if one is None:
                continue
            axes.plot(1e3 * way["seconds"], max(one["bias"], LEAST), linewidth=0, markersize=4, marker=marker(way), color=colour(way),
                      markerfacecolor=colour(way) if key(way, "fit.polish") == "true" else "none")
        axes.set(xscale="log", yscale="log", xlabel="CPU time of a fit (ms)", ylabel=WORDS[name])
    panels[1].legend(handles=fit_legend(ways), loc="upper left", bbox_to_anchor=(1.0, 1.02), frameon=False, fontsize=8)
    return figure


def colour(way):
    return f"C{METHODS.index(key(way, 'fit.method'))}"


def marker(way):
    if key(way, "fit.likelihood") != "[]":
        return "*"
    return "o" if key(way, "fit.starts") == "1" else "s"


def fit_legend(ways):
    used = [method for method in METHODS if any(key(way, "fit.method") == method for way in ways)]
    look = {"linewidth": 0, "markersize": 4}
    return [Line2D([], [], color=f"C{METHODS.index(method)}", label=method, linewidth=2) for method in used] + [
        Line2D([], [], color=style.GREY, marker="o", label="1 start", **look), Line2D([], [], color=style.GREY, marker="s", label="10 starts", **look),
        Line2D([], [], color=style.GREY, marker="*", label="and likelihood", **look),
        Line2D([], [], color=style.GREY, marker="o", markerfacecolor="none", label="not polished", **look)]


def draw_field(ways):
    figure = canvas.figure(style.SINGLE, 3.2)
    axes = figure.subplots()
    for k, name in enumerate(("displacement", "strain", "gradients")):
        axes.plot([1e3 * way["seconds"] for way in ways], [found(way, name)["bias"] for way in ways], marker="o^s"[k], markersize=4, linewidth=0,
                  color=style.ROD_COLOURS[k], label=WORDS[name])
    for k, way in enumerate(ways):
        exact = key(way, "medium.field") == "exact"
        label = "exact" if exact else f"table to {key(way, 'medium.table.tolerance')}"
        axes.annotate(label, (1e3 * way["seconds"], found(way, "strain")["bias"]), textcoords="offset points", xytext=(0, 6), fontsize=7, ha="center")
    axes.margins(x=0.15, y=0.12)
    axes.set(xscale="log", yscale="log", xlabel="CPU time of the map (ms)", ylabel="largest relative error")
    axes.legend(frameon=False, fontsize=8, loc="center right")
    return figure
