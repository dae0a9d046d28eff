"""How two rods go, in all runs (paper, Figs. trajectory c and nonreciptheory b)."""

from dataclasses import replace

import numpy as np

from . import bed, canvas, curves, measured, panels, path_panel, style, track_curves, words
from .errors import PlotError
from .granular_run import TRACKS, track
from .spec import Spec

THIN = dict(linewidth=0.6, alpha=0.4)
NARROWEST = 0.45  # height over width of a panel


def draw(run, spec):
    parts = parts_of(run)
    paths = [read(part) for part in parts]
    beside = [side_by_side(path) for path in paths]
    aspects = [0.8 if flat else aspect_of(path) for path, flat in zip(paths, beside)]
    if spec.overlay and all(beside) and len(parts) > 1:
        return overlaid(parts, paths, spec)
    figure, axes_list = panels.grid(parts, max(aspects), share=False)
    for axes, part, tracks, flat in zip(axes_list, parts, paths, beside):
        (draw_beside if flat else draw_plane)(axes, tracks, part.granular)
    panels.label(axes_list, parts, "", "", spec.title)
    for axes, flat in zip(axes_list, beside):  # each has a range of its own
        axes.tick_params(labelbottom=True, labelleft=True)
        axes.set(xlabel=r"way along the start heading ($a$)" if flat else r"$x/a$", ylabel=r"$y/a$")
    return figure


def overlaid(parts, paths, spec):
    """The rods of all variants in one panel, a colour for each variant."""
    figure, axes = curves.panel(len(parts))
    for part, tracks, colour in zip(parts, paths, curves.colours(len(parts))):
        draw_beside(axes, tracks, part.granular, colour)
        axes.plot([], [], color=colour, label=part.label)
    axes.set(xlabel=r"way along the start heading ($a$)", ylabel=r"$y/a$")
    curves.legend(axes)
    canvas.heading(axes, style.safe(spec.title))
    return figure


def parts_of(run):
    """The scene and those variants that have tracks."""
    found = [part for part in measured.parts(run) if part.has("summary.json") and part.granular.has(TRACKS)]
    if not found:
        raise PlotError(f"{run.path / TRACKS}: no such file, nor in runs/*: nothing to draw")
    return found


def read(part):
    tracks = part.granular.tracks()
    for one in tracks:
        if one.x.shape[1] != 2:
            raise PlotError(f"{one.path}: holds {one.x.shape[1]} rod{'' if one.x.shape[1] == 1 else 's'}; pair_tracks shows two")
    return [together(one, part.granular.box) for one in tracks]


def together(one, box):
    """Rod 1 as the image that is nearest to rod 0 at the start."""
    def moved(values, side):
        return values - np.array([0.0, side * np.round((values[0, 1] - values[0, 0]) / side)])
    return replace(one, x=moved(one.x, box[0]), y=moved(one.y, box[1]))


def side_by_side(tracks):
    return track_curves.is_pair(tracks)


def seen(one):
    """Each rod of a run: way along the mean start heading from its start, and place across it from the pair's middle."""
    ahead = track_curves.direction(one)
    left = np.array([-ahead[1], ahead[0]])
    place = np.stack([one.x, one.y], axis=-1)
    middle = place[0].mean(axis=0)
    return [((place[:, rod] - place[0, rod]) @ ahead, (place[:, rod] - middle) @ left) for rod in (0, 1)]


def draw_beside(axes, tracks, granular, of_all=None):
    both = [seen(one) for one in tracks]
    for rod in (0, 1):
        runs = [(along / granular.a, across / granular.a) for along, across in (one[rod] for one in both)]
        colour = of_all or bed.rod_colour(rod)
        axes.axhline(np.mean([across[0] for _, across in runs]), color=colour, linewidth=0.7, linestyle=(0, (5, 4)), alpha=0.8)
        for along, across in runs:
            axes.plot(along, across, color=colour, **(THIN if len(runs) > 1 else {}))
        if len(runs) > 1:
            draw_mean(axes, runs, colour)
    axes.margins(x=0.02, y=0.08)


def draw_mean(axes, runs, colour):
    x, mean, error = track_curves.mean_curve(runs)
    axes.fill_between(x, mean - error, mean + error, color=colour, alpha=0.3, linewidth=0, zorder=3)
    axes.plot(x, mean, color=colour, linewidth=2.2, zorder=4)


def draw_plane(axes, tracks, granular):
    """Paths in the plane, not folded back into the box; marks at start and end of the mean path."""
    a = granular.a
    mean = track_curves.mean_track(tracks)
    for rod in (0, 1):
        colour = bed.rod_colour(rod)
        for one in tracks if len(tracks) > 1 else ():
            axes.plot(one.x[:, rod] / a, one.y[:, rod] / a, color=colour, **THIN)
        axes.plot(mean.x[:, rod] / a, mean.y[:, rod] / a, color=colour, linewidth=2.0 if len(tracks) > 1 else 1.3)
        for index, mark in ((0, path_panel.hollow), (-1, path_panel.filled)):
            mark(axes, mean.x[index, rod] / a, mean.y[index, rod] / a, mean.theta[index, rod], colour)
    canvas.window(axes, *window_of(tracks, a))


def window_of(tracks, a):
    """All paths with a margin, not too flat and not too tall."""
    spans = []
    for name in ("x", "y"):
        values = np.concatenate([getattr(one, name).ravel() for one in tracks]) / a
        spans.append(np.array([values.min(), values.max()]))
    size = max(np.ptp(span) for span in spans) or 1.0
    wanted = [max(np.ptp(span) + 0.12 * size, NARROWEST * size) / 2 for span in spans]
    return tuple((span.mean() - half, span.mean() + half) for span, half in zip(spans, wanted))


def aspect_of(tracks):
    x, y = window_of(tracks, 1.0)
    return np.ptp(y) / np.ptp(x)


def caption(run, spec):
    parts = parts_of(run)
    members = [part.granular.holders(TRACKS) for part in parts]
    shown = dict.fromkeys(told(len(one), side_by_side([track(one[0] / TRACKS)])) for one in members)
    return " ".join([*shown, panels.told(parts, outcomes)]).rstrip()


def told(runs, beside):
    thin = f"; thin: each of {runs} runs; bold: their mean" if runs > 1 else ""
    if beside:
        return ("Place of each rod across the start heading, from the middle of the pair, against its way along it"
                f"{thin}{' with a band of its standard error' if runs > 1 else ''}; broken lines: at the start.")
    return f"Paths of the two rods, not folded back into the periodic box{thin}; hollow mark at the start, filled at the end."


def outcomes(part):
    """From measure.json, where the pairs were measured."""
    if not part.has(measured.RESULTS):
        return ""
    counts = [(name, part.number("pairs", name)) for name in ("contact", "pursuit", "escape", "undecided")]
    change = part.estimate("pairs", "half_box_change")
    known = [f"{words.number(count)} {name}" for name, count in counts if count is not None]
    text = "Outcomes: " + ", ".join(known) + "." if known else ""
    return text + (f" Δ<i>y</i> over half the box: {words.with_error(*change[:2])} <i>a</i>." if change else "")


def defaults(run):
    return [Spec("pair_tracks", "pair_tracks")] if measured.some(run, "pairs.csv") and run.granular.has(TRACKS) else []
