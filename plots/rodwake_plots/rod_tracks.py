"""Paths of the rods in the box; beside them how two rods come together, or how one turns and how fast it goes."""

from dataclasses import replace

import numpy as np

from . import bed, bed_run, canvas, style, trajectories, words
from .bed_run import TRACKS
from .errors import PlotError
from .frames import wrapped_path
from .schema import Kind
from .trajectories import mark_interval

STRAIGHT = 1e-6  # degrees: a heading that changes by less is not drawn
FLAT = 0.62      # height over width of the paths, below which they have a row of their own
MOST, MARGIN = 0.7, 8.0  # of a side of the box, beyond which all of it is shown; around paths, bead radii
NUMBER = 4.0     # of a rod: its distance from the start, bead radii
THIN = dict(linewidth=0.6, alpha=0.45)


def draw_rod_tracks(run, spec):
    tracks, granular = run.granular.tracks(), run.granular
    pair = is_pair(tracks)
    window = window_of(tracks, granular)
    figure, axes = layout(np.ptp(window[1]) / np.ptp(window[0]), pair or is_straight(tracks))
    for index, one in enumerate(axes.values()):
        canvas.letter(one, index)
    draw_box(axes["box"], tracks, granular, window)
    if pair:
        draw_pair(axes["first"], tracks, granular)
    else:
        draw_each(axes["first"], axes.get("second"), tracks)
    figure.suptitle(style.safe(spec.title) or f"{bed.density(granular)},  {duration(tracks)}", fontsize=10.5)
    return figure


def layout(aspect, alone):
    """Figure and panels: paths in a strip above the others, or beside them where they take the box's height."""
    if aspect < FLAT:
        figure = canvas.figure(style.WIDE, 6.2 * aspect + 3.2)
        return figure, figure.subplot_mosaic([["box", "box"], ["first", "first" if alone else "second"]], height_ratios=[6.2 * aspect + 0.5, 2.4])
    figure = canvas.figure(style.WIDE + 0.6, 3.9)
    return figure, figure.subplot_mosaic([["box", "first"], ["box", "first" if alone else "second"]], width_ratios=[1, 0.85])


def window_of(tracks, granular):
    """((left, right), (bottom, top)) in a: along each side the part of the box where rods go, or all of it if they need most of it."""
    found = []
    for side, name in zip(granular.sides, ("x", "y")):
        places = np.concatenate([getattr(one, name).ravel() for one in tracks]) % side / granular.a
        low, high, whole = places.min() - MARGIN, places.max() + MARGIN, side / granular.a
        found.append((low, high) if high - low < MOST * whole else (0.0, whole))
    return tuple(found)


def is_straight(tracks):
    """Whether no rod ever turns: a lone one between plates has nothing that could turn it but rounding."""
    return all(np.ptp(np.degrees(track.theta), axis=0).max() < STRAIGHT for track in tracks)


def duration(tracks):
    runs = f", {len(tracks)} runs" if len(tracks) > 1 else ""
    return rf"$t = {tracks[0].t[0]:.3g}$ to ${tracks[0].t[-1]:.4g}$ s{runs}"


def draw_box(axes, tracks, granular, window):
    a, box = granular.a, granular.box
    canvas.window(axes, *window)
    axes.set(xlabel=r"$x/a$", ylabel=r"$y/a$")
    mean = mean_track(tracks)
    for rod in range(mean.x.shape[1]):
        colour = bed.rod_colour(rod)
        for track in tracks if len(tracks) > 1 else ():
            axes.plot(*wrapped_path(track.x[:, rod], track.y[:, rod], box).T / a, color=colour, **THIN)
        axes.plot(*wrapped_path(mean.x[:, rod], mean.y[:, rod], box).T / a, color=colour, linewidth=1.1)
        draw_marks(axes, mean, rod, granular)
    note_rods(axes, mean, granular)
    if granular.container:
        bed.bed_edge(axes, granular, window)


def draw_marks(axes, track, rod, granular):
    """Start hollow, end filled, small marks at equal times."""
    interval = mark_interval(track.t[-1])
    times = np.arange(1, np.ceil(track.t[-1] / interval)) * interval
    places = [(trajectories.small, t) for t in times[times < track.t[-1] - 0.3 * interval]]
    for mark, t in [*places, (trajectories.hollow, track.t[0]), (trajectories.filled, track.t[-1])]:
        x, y, theta = (np.interp(t, track.t, part[:, rod]) for part in (track.x, track.y, track.theta))
        mark(axes, x % granular.box[0] / granular.a, y % granular.box[1] / granular.a, theta, bed.rod_colour(rod))


def note_rods(axes, track, granular):
    """Each rod's number above or under its start, where there is more room."""
    for rod in range(track.x.shape[1]) if 1 < track.x.shape[1] <= trajectories.MOST_LABELS else ():
        start = np.array([track.x[0, rod], track.y[0, rod]])
        up = 1 if room(track, granular, start + [0, NUMBER * granular.a]) >= room(track, granular, start - [0, NUMBER * granular.a]) else -1
        axes.text(*(start % granular.box / granular.a + [0, up * NUMBER]), str(rod), ha="center", va="center", clip_on=True,
                  color=bed.rod_colour(rod))


def room(track, granular, place):
    """Distance to the nearest path."""
    away = np.stack([track.x, track.y], axis=-1) - place
    return np.linalg.norm(away - granular.box * np.round(away / granular.box), axis=-1).min()


def draw_pair(axes, tracks, granular):
    """Separation across the starting heading against the way along it; of an ensemble all runs and their mean."""
    curves = [approach(track, granular.box) for track in tracks]
    names = approach_names(tracks[0])
    axes.axhline(curves[0][1][0] / granular.a, color=style.GREY, linewidth=0.7, linestyle=(0, (5, 4)))
    for along, apart in curves:
        axes.plot(along / granular.a, apart / granular.a, color=style.LINE, **(THIN if len(curves) > 1 else {}))
    if len(curves) > 1:
        draw_mean(axes, *(part / granular.a for part in mean_curve(curves)), len(curves))
    axes.set(xlabel=names[0], ylabel=names[1])
    axes.margins(x=0, y=0.12)


def draw_mean(axes, x, mean, error, runs):
    axes.fill_between(x, mean - error, mean + error, color=style.INK, alpha=0.18, linewidth=0)
    axes.plot(x, mean, color=style.INK, linewidth=2, label=f"mean of {runs} runs ± its standard error")
    axes.legend(loc="best", frameon=True, framealpha=0.85, edgecolor="none", fontsize=8.5)


def draw_each(upper, lower, tracks):
    """Speed along the axis (moving mean; of a single run the values too, pale) and heading against time."""
    rods = range(tracks[0].x.shape[1])
    for track in tracks:
        look = THIN if len(tracks) > 1 else {}
        for rod in rods:
            colour = bed.rod_colour(rod)
            if not look:
                upper.plot(track.t, track.speed[:, rod] * 1e3, color=colour, linewidth=0.5, alpha=0.3)
            upper.plot(track.t, smooth(track.speed[:, rod]) * 1e3, color=colour, **look)
            if lower:
                lower.plot(track.t, np.degrees(track.theta[:, rod]), color=colour, **look)
    draw_each_mean(upper, lower, tracks, rods)
    upper.axhline(0, color=style.GREY, linewidth=0.6)
    upper.set(ylabel="speed (mm/s)", ylim=speed_limits(tracks))
    (lower or upper).set_xlabel(r"$t$ (s)")
    upper.margins(x=0)
    if lower:
        upper.tick_params(labelbottom=False)
        lower.set_ylabel("heading (°)")
        lower.margins(x=0)


def draw_each_mean(upper, lower, tracks, rods):
    if len(tracks) < 2:
        return
    mean = mean_track(tracks)
    for rod in rods:
        look = dict(color=bed.rod_colour(rod), linewidth=2.2)
        upper.plot(mean.t, smooth(mean.speed[:, rod]) * 1e3, **look)
        if lower:
            lower.plot(mean.t, np.degrees(mean.theta[:, rod]), **look)


def speed_limits(tracks):
    """From the moving means, so that single knocks do not set the scale."""
    means = np.concatenate([smooth(part) for track in tracks for part in track.speed.T]) * 1e3
    low, high = min(means.min(), 0.0), max(means.max(), 0.0)
    room = 0.35 * ((high - low) or 1.0)
    return low - room, high + room


def caption_rod_tracks(run, spec):
    tracks = run.granular.tracks()
    several = len(tracks) > 1
    rods = tracks[0].x.shape[1]
    text = f"(a) Path{'s' if rods > 1 else ''} of {'the rods' if rods > 1 else 'the rod'} in the periodic box, of which the part is shown where they go"
    text += f", thin for each of {len(tracks)} runs and bold for their mean" if several else ""
    text += (f"; hollow mark at the start, filled at the end, small marks every {words.number(mark_interval(tracks[0].t[-1]))} s; "
             f"the thin end points forward. ")
    if is_pair(tracks):
        return text + "(b) The rods' separation across the starting heading against their mean distance along it; broken line: at the start."
    window = words.number(window_time(tracks[0].t), 2)
    text += (f"(b) Speed along the rod, positive thin end first, as a moving mean over {window} s"
             f"{'' if several else ' (values at the output times pale)'}. ")
    if is_straight(tracks):
        return text + f"The heading{'s stay' if rods > 1 else ' stays'} what {'they were' if rods > 1 else 'it was'} at the start."
    return text + "(c) Heading from <i>x</i>."


# Curves made from the tracks of rods: means over runs, moving means, the approach of two rods.

POINTS = 300
PARALLEL = 0.5  # cosine of the angle between headings above which two rods go side by side
PART = 0.05     # of the run: the window of the moving mean


def is_pair(tracks):
    """Two rods that start in about the same direction."""
    theta = tracks[0].theta[0]
    return theta.size == 2 and np.cos(theta[0] - theta[1]) > PARALLEL


def direction(track):
    """The mean starting heading of the rods."""
    mean = np.exp(1j * track.theta[0]).mean()
    return np.array([mean.real, mean.imag]) / abs(mean)


def approach(track, box):
    """(mean way along the starting heading, separation across it); the nearest images at the start make the pair."""
    ahead = direction(track)
    left = np.array([-ahead[1], ahead[0]])
    place = np.stack([track.x, track.y], axis=-1)
    along = (place - place[0]).mean(axis=1) @ ahead
    away = place[:, 1] - place[:, 0]
    across = (away - box * np.round(away[0] / box)) @ left
    return along, across * (np.sign(across[0]) or 1.0)


def approach_names(track):
    if abs(direction(track)[1]) < 1e-3:
        return r"distance travelled along $x$ ($a$)", r"separation in $y$ ($a$)"
    return r"distance travelled along the starting heading ($a$)", r"separation across it ($a$)"


def mean_curve(curves):
    """(x, mean of y, its standard error) up to where every run has come; y is read where a run first reaches x."""
    furthest = [np.maximum.accumulate(x) for x, _ in curves]
    x = np.linspace(0, min(reach[-1] for reach in furthest), POINTS)
    values = np.array([np.interp(x, reach, y) for reach, (_, y) in zip(furthest, curves)])
    return x, values.mean(axis=0), values.std(axis=0, ddof=1) / np.sqrt(len(curves))


def mean_track(tracks):
    """Mean over the runs at the first run's times, as long as all of them last."""
    if len(tracks) == 1:
        return tracks[0]
    t = tracks[0].t[tracks[0].t <= min(track.t[-1] for track in tracks)]

    def mean(name):
        parts = [[np.interp(t, track.t, part) for part in getattr(track, name).T] for track in tracks]
        return np.mean(parts, axis=0).T
    return replace(tracks[0], t=t, **{name: mean(name) for name in ("x", "y", "theta", "speed")})


def window_length(count):
    return max(1, round(PART * count))


def window_time(t):
    return float(window_length(t.size) * (t[-1] - t[0]) / max(t.size - 1, 1))


def smooth(values):
    """Moving mean; towards the ends over what there is."""
    window = np.ones(window_length(values.size))
    return np.convolve(values, window, "same") / np.convolve(np.ones(values.size), window, "same")


# How two rods go, in all runs (paper, Figs. trajectory c and nonreciptheory b).

PAIR_TRACKS_THIN = dict(linewidth=0.6, alpha=0.4)
NARROWEST = 0.45  # height over width of a panel


def draw_pair_tracks(run, spec):
    parts = pair_parts(run)
    paths = [read_pairs(part) for part in parts]
    beside = [side_by_side(path) for path in paths]
    aspects = [0.8 if flat else aspect_of(path) for path, flat in zip(paths, beside)]
    if spec.overlay and all(beside) and len(parts) > 1:
        return pairs_overlaid(parts, paths, spec)
    figure, axes_list = canvas.panel_grid(parts, max(aspects), share=False)
    for axes, part, tracks, flat in zip(axes_list, parts, paths, beside):
        (draw_beside if flat else draw_plane)(axes, tracks, part.granular)
    canvas.label_panels(axes_list, parts, "", "", spec.title)
    for axes, flat in zip(axes_list, beside):  # each has a range of its own
        axes.tick_params(labelbottom=True, labelleft=True)
        axes.set(xlabel=r"distance along the start heading ($a$)" if flat else r"$x/a$", ylabel=r"$y/a$")
    return figure


def pairs_overlaid(parts, paths, spec):
    """The rods of all variants in one panel, a colour for each variant."""
    figure, axes = canvas.curve_panel(len(parts))
    for part, tracks, colour in zip(parts, paths, canvas.colours(len(parts))):
        draw_beside(axes, tracks, part.granular, colour)
        axes.plot([], [], color=colour, label=style.label(part.label))
    axes.set(xlabel=r"distance along the start heading ($a$)", ylabel=r"$y/a$")
    canvas.legend(axes)
    canvas.heading(axes, style.safe(spec.title))
    return figure


def with_tracks(run):
    return [part for part in bed_run.parts_of(run) if (part.has(bed_run.SUMMARY) or part.has(bed_run.FILM)) and part.granular.has(TRACKS)]


def pair_parts(run):
    """The scene and those variants that have tracks."""
    found = with_tracks(run)
    if not found:
        raise PlotError(f"{run.path / TRACKS}: no such file, nor in runs/*: nothing to draw")
    return found


def read_pairs(part):
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
    return is_pair(tracks)


def pair_seen(one):
    """Each rod of a run: way along the mean start heading from its start, and place across it from the pair's middle."""
    ahead = direction(one)
    left = np.array([-ahead[1], ahead[0]])
    place = np.stack([one.x, one.y], axis=-1)
    middle = place[0].mean(axis=0)
    return [((place[:, rod] - place[0, rod]) @ ahead, (place[:, rod] - middle) @ left) for rod in (0, 1)]


def draw_beside(axes, tracks, granular, of_all=None):
    both = [pair_seen(one) for one in tracks]
    for rod in (0, 1):
        runs = [(along / granular.a, across / granular.a) for along, across in (one[rod] for one in both)]
        colour = of_all or bed.rod_colour(rod)
        axes.axhline(np.mean([across[0] for _, across in runs]), color=colour, linewidth=0.7, linestyle=(0, (5, 4)), alpha=0.8)
        for along, across in runs:
            axes.plot(along, across, color=colour, **(PAIR_TRACKS_THIN if len(runs) > 1 else {}))
        if len(runs) > 1:
            draw_pair_mean(axes, runs, colour)
    axes.margins(x=0.02, y=0.08)


def draw_pair_mean(axes, runs, colour):
    x, mean, error = mean_curve(runs)
    axes.fill_between(x, mean - error, mean + error, color=colour, alpha=0.3, linewidth=0, zorder=3)
    axes.plot(x, mean, color=colour, linewidth=2.2, zorder=4)


def draw_plane(axes, tracks, granular):
    """Paths in the plane, not folded back into the box; marks at start and end of the mean path."""
    a = granular.a
    mean = mean_track(tracks)
    for rod in (0, 1):
        colour = bed.rod_colour(rod)
        for one in tracks if len(tracks) > 1 else ():
            axes.plot(one.x[:, rod] / a, one.y[:, rod] / a, color=colour, **PAIR_TRACKS_THIN)
        axes.plot(mean.x[:, rod] / a, mean.y[:, rod] / a, color=colour, linewidth=2.0 if len(tracks) > 1 else 1.3)
        for index, mark in ((0, trajectories.hollow), (-1, trajectories.filled)):
            mark(axes, mean.x[index, rod] / a, mean.y[index, rod] / a, mean.theta[index, rod], colour)
    canvas.window(axes, *pair_window(tracks, a))


def pair_window(tracks, a):
    """All paths with a margin, not too flat and not too tall."""
    spans = []
    for name in ("x", "y"):
        values = np.concatenate([getattr(one, name).ravel() for one in tracks]) / a
        spans.append(np.array([values.min(), values.max()]))
    size = max(np.ptp(span) for span in spans) or 1.0
    wanted = [max(np.ptp(span) + 0.12 * size, NARROWEST * size) / 2 for span in spans]
    return tuple((span.mean() - half, span.mean() + half) for span, half in zip(spans, wanted))


def aspect_of(tracks):
    x, y = pair_window(tracks, 1.0)
    return np.ptp(y) / np.ptp(x)


def caption_pair_tracks(run, spec):
    parts = pair_parts(run)
    members = [part.granular.holders(TRACKS) for part in parts]
    shown = dict.fromkeys(describe_pair(len(one), side_by_side(part.granular.tracks()[:1])) for part, one in zip(parts, members))
    return " ".join([*shown, canvas.describe_panels(parts, pair_outcomes)]).rstrip()


def describe_pair(runs, beside):
    thin = f"; thin: each of {runs} runs; bold: their mean" if runs > 1 else ""
    if beside:
        return ("Position of each rod across the start heading, from the middle of the pair, against its distance along it"
                f"{thin}{' with a band of its standard error' if runs > 1 else ''}; broken lines: at the start.")
    return f"Paths of the two rods, not folded back into the periodic box{thin}; hollow mark at the start, filled at the end."


def pair_outcomes(part):
    """From measure.json, where the pairs were measured."""
    if not part.has(bed_run.RESULTS):
        return ""
    counts = [(name, part.number("pairs", name)) for name in ("contact", "pursuit", "escape", "undecided")]
    change = part.estimate("pairs", "half_box_change")
    known = [f"{words.number(count)} {name}" for name, count in counts if count is not None]
    text = "Outcomes: " + ", ".join(known) + "." if known else ""
    return text + (f" Δ<i>y</i> over half the box: {words.with_error(*change[:2])} <i>a</i>." if change else "")


KINDS = {
    "rod_tracks": Kind(draw=draw_rod_tracks, caption=caption_rod_tracks, there=lambda run: run.granular.rods and run.granular.has(TRACKS)),
    "pair_tracks": Kind(draw=draw_pair_tracks, caption=caption_pair_tracks, there=lambda run: bed_run.some(run, "pairs.csv") and bool(with_tracks(run))),
}
