"""Paths of the rods in the box; beside them how two rods come together, or how one turns and how fast it goes."""

import numpy as np

from . import bed, canvas, path_panel, style, track_curves, words
from .granular_run import TRACKS
from .paths import mark_interval
from .periodic import wrapped_path
from .spec import Spec

STRAIGHT = 1e-6  # degrees: a heading that changes by less is not drawn
FLAT = 0.62      # height over width of the paths, below which they have a row of their own
MOST, MARGIN = 0.7, 8.0  # of a side of the box, beyond which all of it is shown; around paths, bead radii
NUMBER = 4.0     # of a rod: its distance from the start, bead radii
THIN = dict(linewidth=0.6, alpha=0.45)


def draw(run, spec):
    tracks, granular = run.granular.tracks(), run.granular
    pair = track_curves.is_pair(tracks)
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
    for side, name in zip(granular.box, ("x", "y")):
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
    mean = track_curves.mean_track(tracks)
    for rod in range(mean.x.shape[1]):
        colour = bed.rod_colour(rod)
        for track in tracks if len(tracks) > 1 else ():
            axes.plot(*wrapped_path(track.x[:, rod], track.y[:, rod], box).T / a, color=colour, **THIN)
        axes.plot(*wrapped_path(mean.x[:, rod], mean.y[:, rod], box).T / a, color=colour, linewidth=1.1)
        draw_marks(axes, mean, rod, granular)
    note_rods(axes, mean, granular)


def draw_marks(axes, track, rod, granular):
    """Start hollow, end filled, small marks at equal times."""
    interval = mark_interval(track.t[-1])
    times = np.arange(1, np.ceil(track.t[-1] / interval)) * interval
    places = [(path_panel.small, t) for t in times[times < track.t[-1] - 0.3 * interval]]
    for mark, t in [*places, (path_panel.hollow, track.t[0]), (path_panel.filled, track.t[-1])]:
        x, y, theta = (np.interp(t, track.t, part[:, rod]) for part in (track.x, track.y, track.theta))
        mark(axes, x % granular.box[0] / granular.a, y % granular.box[1] / granular.a, theta, bed.rod_colour(rod))


def note_rods(axes, track, granular):
    """Each rod's number above or under its start, where there is more room."""
    for rod in range(track.x.shape[1]) if 1 < track.x.shape[1] <= path_panel.MOST_LABELS else ():
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
    curves = [track_curves.approach(track, granular.box) for track in tracks]
    names = track_curves.approach_names(tracks[0])
    axes.axhline(curves[0][1][0] / granular.a, color=style.GREY, linewidth=0.7, linestyle=(0, (5, 4)))
    for along, apart in curves:
        axes.plot(along / granular.a, apart / granular.a, color=style.LINE, **(THIN if len(curves) > 1 else {}))
    if len(curves) > 1:
        draw_mean(axes, *(part / granular.a for part in track_curves.mean_curve(curves)), len(curves))
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
            upper.plot(track.t, track_curves.smooth(track.speed[:, rod]) * 1e3, color=colour, **look)
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
    mean = track_curves.mean_track(tracks)
    for rod in rods:
        look = dict(color=bed.rod_colour(rod), linewidth=2.2)
        upper.plot(mean.t, track_curves.smooth(mean.speed[:, rod]) * 1e3, **look)
        if lower:
            lower.plot(mean.t, np.degrees(mean.theta[:, rod]), **look)


def speed_limits(tracks):
    """From the moving means, so that single knocks do not set the scale."""
    means = np.concatenate([track_curves.smooth(part) for track in tracks for part in track.speed.T]) * 1e3
    low, high = min(means.min(), 0.0), max(means.max(), 0.0)
    room = 0.35 * ((high - low) or 1.0)
    return low - room, high + room


def caption(run, spec):
    tracks = run.granular.tracks()
    several = len(tracks) > 1
    rods = tracks[0].x.shape[1]
    text = f"(a) Path{'s' if rods > 1 else ''} of {'the rods' if rods > 1 else 'the rod'} in the periodic box, of which the part is shown where they go"
    text += f", thin for each of {len(tracks)} runs and bold for their mean" if several else ""
    text += (f"; hollow mark at the start, filled at the end, small marks every {words.number(mark_interval(tracks[0].t[-1]))} s; "
             f"the thin end points forward. ")
    if track_curves.is_pair(tracks):
        return text + "(b) The rods' separation across the starting heading against their mean way along it; broken line: at the start."
    window = words.number(track_curves.window_time(tracks[0].t), 2)
    text += (f"(b) Speed along the rod, positive thin end first, as a moving mean over {window} s"
             f"{'' if several else ' (values at the output times pale)'}. ")
    if is_straight(tracks):
        return text + f"The heading{'s stay' if rods > 1 else ' stays'} what {'they were' if rods > 1 else 'it was'} at the start."
    return text + "(c) Heading from <i>x</i>."


def defaults(run):
    return [Spec("rod_tracks", "rod_tracks")] if run.granular.rods and run.granular.has(TRACKS) else []
