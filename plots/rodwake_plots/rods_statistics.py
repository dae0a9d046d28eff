"""Rods that diffuse: how far they get, how long they keep their headings, and how many have met, of the scene and of each variant."""

from typing import NamedTuple

import numpy as np

from . import canvas, files, style, words
from .errors import MissingError
from .schema import Kind
from .words import Units

MEANS, RUNS = "noise.json", "ensemble.csv"
CONTACT = 0  # in ensemble.csv
POINTS = 24  # with error bars, of the times that are stored


class Case(NamedTuple):
    label: str
    means: dict
    ends: dict

    def by_rod(self, key):
        """A quantity and its standard error, each [time][rod], unknown as nan."""
        return tuple(np.array(self.means[name], dtype=float) for name in (key, f"{key}_error"))

    def by_time(self, key):
        """Means over the rods; their errors as if all rods were one."""
        value, error = self.by_rod(key)
        return value.mean(axis=1), error.max(axis=1)


def cases(run):
    found = []
    for one in run.result.runs():
        folder = run.path if one.name == "scene" else run.path / "variants" / one.name
        if (folder / MEANS).is_file():
            means = files.Record(folder / MEANS)
            label = one.label if one.attrs.get("label") else rf"$D_r = {words.math_number(means['rotational_diffusion'])}$"
            found.append(Case(label, means, files.read_csv(folder / RUNS)))
    if not found:
        raise MissingError(run.path / MEANS, "no such file: [noise] in the scene and a finished run of its rods write it")
    return found


def draw_noise(run, spec):
    drawn, units = cases(run), run.result.units
    paired = any(case.means["capture_probability"] is not None for case in drawn)
    figure = canvas.figure(style.WIDE if paired else 0.75 * style.WIDE, 2.7)
    panels = figure.subplots(1, 3 if paired else 2)
    end = max(case.means["times"][-1] for case in drawn)
    time = units.time("t", end)
    for k, case in enumerate(drawn):
        colour = style.ROD_COLOURS[k % len(style.ROD_COLOURS)]
        draw_spread(panels[0], case, time, units, colour)
        draw_headings(panels[1], case, time, colour)
        if paired:
            draw_met(panels[2], case, time, colour)
    length = units.length(r"\langle|\mathbf{r}(t)-\mathbf{r}(0)|^2\rangle^{1/2}", np.sqrt(largest_square(drawn)))
    panels[0].set(xlabel=time.label, ylabel=length.label, xscale="log", yscale="log")
    panels[1].set(xlabel=time.label, ylabel=r"$\langle\cos(\theta(t)-\theta(0))\rangle$", xlim=(0, end * time.factor))
    if paired:
        panels[2].set(xlabel=time.label, ylabel="share of the runs in contact", xlim=(0, 1.04 * end * time.factor), ylim=(0, 1))
    if len(drawn) > 1:
        panels[0].legend(loc="lower right", frameon=False, fontsize=8, handlelength=1.2)
    for k, axes in enumerate(panels):
        canvas.letter(axes, k)
    figure.suptitle(style.safe(spec.title), fontsize=10.5)
    return figure


def largest_square(drawn):
    return max(np.nanmax(case.by_time("mean_square_displacement")[0]) for case in drawn)


def with_bars(times):
    """Indices of the times that get an error bar, the start not among them."""
    return np.unique(np.linspace(1, len(times) - 1, min(POINTS, len(times) - 1)).astype(int)) if len(times) > 1 else np.array([], dtype=int)


def draw_spread(axes, case, time, units, colour):
    t = np.array(case.means["times"])
    square, error = case.by_time("mean_square_displacement")
    factor = units.length("r", np.sqrt(np.nanmax(square))).factor
    at = with_bars(t)
    root = np.sqrt(square[at])
    axes.errorbar(t[at] * time.factor, root * factor, 0.5 * error[at] / root * factor, fmt="o", markersize=2.5, linewidth=0.8, color=colour,
                  label=style.label(case.label))
    axes.plot(t[1:] * time.factor, np.sqrt(free_square(case.means, t[1:])) * factor, color=colour, linewidth=0.9)


def draw_headings(axes, case, time, colour):
    t = np.array(case.means["times"])
    value, error = case.by_time("heading_correlation")
    at = with_bars(t)
    axes.errorbar(t[at] * time.factor, value[at], error[at], fmt="o", markersize=2.5, linewidth=0.8, color=colour)
    axes.plot(t * time.factor, np.exp(-case.means["rotational_diffusion"] * t), color=colour, linewidth=0.9)


def draw_met(axes, case, time, colour):
    """Runs in contact by a time, and at the end the probability of capture with its interval of 95 %."""
    means = case.means
    if means["capture_probability"] is None:
        return
    ends = np.array(case.ends["outcome"], dtype=float)
    done = int(np.isfinite(ends).sum())
    at = np.sort(np.array(case.ends["time"])[ends == CONTACT]) * time.factor
    end = means["times"][-1] * time.factor
    share = np.arange(at.size + 1) / max(done, 1)
    axes.step(np.concatenate([[0.0], at, [end]]), np.append(share, share[-1]), where="post", color=colour)
    p, low, high = (means[key] for key in ("capture_probability", "capture_low", "capture_high"))
    axes.errorbar([end], [p], [[p - low], [high - p]], fmt="s", markersize=3.5, capsize=2, color=colour, clip_on=False)


def free_square(means, t):
    """Mean-square displacement of a rod that no other turns."""
    D, v = means["rotational_diffusion"], means["speed"]
    walked = v * v * 2 / D**2 * (D * t + np.expm1(-D * t)) if D > 0 else v * v * t * t
    return walked + 4 * means["translational_diffusion"] * t


def caption_noise(run, _):
    drawn = cases(run)
    captures = "; ".join(f"{words.label_html(case.label)}: {capture(case.means)}" for case in drawn if case.means["capture_probability"] is not None)
    return ("Root of the mean-square displacement and correlation of the headings, means over runs and rods; lines: a rod that no other turns. "
            + (f"Right: runs in contact by a time; squares: probability of capture (contact or pursuit) with its interval of 95 %. {captures}." if captures else ""))


def capture(means):
    p, low, high = (words.number(means[key], 3) for key in ("capture_probability", "capture_low", "capture_high"))
    return f"{p} ({low} to {high}) of {words.number(means['runs'])} runs"


# Order parameters and clusters of the rods against time, and how many rods are in clusters of which size.

SERIES, CLUSTERS, RODS_ORDER_MEANS = "rods_order.csv", "clusters.csv", "rods_order.json"


def draw_rods_order(run, spec):
    series, clusters, means = order_tables(run)
    time = units_of(means).time("t", series["t"][-1])
    figure = canvas.figure(style.WIDE, 5.2)
    axes = figure.subplot_mosaic([["order", "share"], ["size", "share"]], width_ratios=[1.25, 1])
    t = series["t"] * time.factor
    order_curves(axes["order"], t, [(series["polar"], style.LINE, "polar"), (series["nematic"], style.ROD_COLOURS[0], "nematic")])
    axes["order"].set(ylabel="order", ylim=(0, 1))
    order_curves(axes["size"], t, [(series["largest"], style.ROD_COLOURS[2], "largest"), (series["weighted_size"], style.ROD_COLOURS[3], "of a rod, mean"),
                             (series["mean_size"], style.GREY, "mean")])
    axes["size"].set(ylabel="cluster size (rods)", yscale="log", xlabel=time.label)
    canvas.plain_ticks(axes["size"].yaxis, series["mean_size"].min(), series["largest"].max())
    axes["order"].tick_params(labelbottom=False)
    for part in (axes["order"], axes["size"]):
        part.axvspan(means["from"] * time.factor, t[-1], color=style.INK, alpha=0.05, linewidth=0)
        part.margins(x=0)
    cluster_histogram(axes["share"], clusters)
    figure.suptitle(style.safe(spec.title), fontsize=10.5)
    return figure


def order_tables(run):
    means = run.rods_order
    if means is None:
        raise MissingError(run.path / RODS_ORDER_MEANS, "no such file: [rods_order] in the scene and a finished run write it; of a bed rodwake measure does")
    return files.read_csv(run.path / SERIES), files.read_csv(run.path / CLUSTERS), means


def order_curves(axes, t, parts):
    for values, colour, name in parts:
        axes.plot(t, values, color=colour, label=name)
    axes.legend(loc="best", frameon=False, fontsize=8.5, handlelength=1.4)


def cluster_histogram(axes, clusters):
    """Share of the rods in clusters of 1, 2, 3 to 4, 5 to 8, ... rods."""
    top = int(np.ceil(np.log2(clusters["size"].max()))) if clusters["size"].size else 0
    bins = np.ceil(np.log2(clusters["size"])).astype(int)
    share = np.bincount(bins, clusters["share"], top + 1)
    axes.bar(np.arange(top + 1), share, width=0.85, color=style.LINE)
    axes.set_xticks(np.arange(top + 1), ["1", "2"][:top + 1] + [f"{2 ** (k - 1) + 1}-{2 ** k}" for k in range(2, top + 1)], rotation=40, fontsize=8)
    axes.set(xlabel="cluster size (rods)", ylabel="share of the rods", ylim=(0, None))


def caption_rods_order(run, _):
    means = order_tables(run)[2]
    unit = units_of(means).length_html()
    linked = f"rods nearer than {words.number(means['link'])} {unit} are linked" if "link" in means else "rods that touch are linked"
    estimates = "; ".join(f"{name} {order_estimate(means[key])}" for key, name in (
        ("polar", "polar order"), ("nematic", "nematic order"), ("weighted_size", "mean size of the cluster that a rod is in"),
        ("largest", "largest cluster")))
    return (f"Left: order of the rods and sizes of their clusters; {linked}. Right: share of "
            f"the rods in clusters of each size. Means over the shaded time, standard errors from {words.number(means['blocks'])} blocks: {estimates}.")


def units_of(means):
    """Of a bed SI, whatever the theory's results are in."""
    return Units("si" if means["units"]["time"] == "s" else "reduced")


def order_estimate(value):
    error = f" ± {words.number(value['error'], 2)}" if value["error"] is not None else ""
    return words.number(value["value"]) + error


KINDS = {
    "noise": Kind(draw=draw_noise, caption=caption_noise, there=lambda run: (run.path / MEANS).is_file() and run.result.has("/rods")),
    "rods_order": Kind(draw=draw_rods_order, caption=caption_rods_order, there=lambda run: run.rods_order),
}
