"""Curves made from the tracks of rods: means over runs, moving means, the approach of two rods."""

from dataclasses import replace

import numpy as np

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
