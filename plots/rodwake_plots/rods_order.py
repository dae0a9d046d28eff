"""Order parameters and clusters of the rods against time, and how many rods are in clusters of which size."""

import numpy as np

from . import canvas, csv_columns, ranges, style, words
from .errors import MissingError
from .spec import Spec
from .units import Units

SERIES, CLUSTERS, MEANS = "rods_order.csv", "clusters.csv", "rods_order.json"


def draw(run, spec):
    series, clusters, means = tables(run)
    time = units_of(means).time("t", series["t"][-1])
    figure = canvas.figure(style.WIDE, 5.2)
    axes = figure.subplot_mosaic([["order", "share"], ["size", "share"]], width_ratios=[1.25, 1])
    t = series["t"] * time.factor
    curves(axes["order"], t, [(series["polar"], style.LINE, "polar"), (series["nematic"], style.ROD_COLOURS[0], "nematic")])
    axes["order"].set(ylabel="order", ylim=(0, 1))
    curves(axes["size"], t, [(series["largest"], style.ROD_COLOURS[2], "largest"), (series["weighted_size"], style.ROD_COLOURS[3], "of a rod, mean"),
                             (series["mean_size"], style.GREY, "mean")])
    axes["size"].set(ylabel="cluster size (rods)", yscale="log", xlabel=time.label)
    ranges.plain_ticks(axes["size"].yaxis, series["mean_size"].min(), series["largest"].max())
    axes["order"].tick_params(labelbottom=False)
    for part in (axes["order"], axes["size"]):
        part.axvspan(means["from"] * time.factor, t[-1], color=style.INK, alpha=0.05, linewidth=0)
        part.margins(x=0)
    histogram(axes["share"], clusters)
    figure.suptitle(style.safe(spec.title), fontsize=10.5)
    return figure


def tables(run):
    means = run.rods_order
    if means is None:
        raise MissingError(run.path / MEANS, "no such file: [rods_order] in the scene and a finished run write it; of a bed rodwake measure does")
    return csv_columns.read(run.path / SERIES), csv_columns.read(run.path / CLUSTERS), means


def curves(axes, t, parts):
    for values, colour, name in parts:
        axes.plot(t, values, color=colour, label=name)
    axes.legend(loc="best", frameon=False, fontsize=8.5, handlelength=1.4)


def histogram(axes, clusters):
    """Share of the rods in clusters of 1, 2, 3 to 4, 5 to 8, ... rods."""
    top = int(np.ceil(np.log2(clusters["size"].max()))) if clusters["size"].size else 0
    bins = np.ceil(np.log2(clusters["size"])).astype(int)
    share = np.bincount(bins, clusters["share"], top + 1)
    axes.bar(np.arange(top + 1), share, width=0.85, color=style.LINE)
    axes.set_xticks(np.arange(top + 1), ["1", "2"][:top + 1] + [f"{2 ** (k - 1) + 1}-{2 ** k}" for k in range(2, top + 1)], rotation=40, fontsize=8)
    axes.set(xlabel="cluster size (rods)", ylabel="share of the rods", ylim=(0, None))


def caption(run, _):
    means = tables(run)[2]
    unit = units_of(means).length_html()
    told = "; ".join(f"{name} {estimate(means[key])}" for key, name in (
        ("polar", "polar order"), ("nematic", "nematic order"), ("weighted_size", "mean size of the cluster that a rod is in"),
        ("largest", "largest cluster")))
    return (f"Left: order of the rods and sizes of their clusters; rods nearer than {words.number(means['link'])} {unit} are linked. Right: share of "
            f"the rods in clusters of each size. Means over the shaded time, standard errors from {words.number(means['blocks'])} blocks: {told}.")


def units_of(means):
    """Of a bed SI, whatever the theory's results are in."""
    return Units("si" if means["units"]["time"] == "s" else "reduced")


def estimate(value):
    error = f" ± {words.number(value['error'], 2)}" if value["error"] is not None else ""
    return words.number(value["value"]) + error


def defaults(run):
    return [Spec("rods_order", "rods_order")] if run.rods_order else []
