"""How well a fit predicts a profile that it was not fitted to, on each side of the rod."""

import math

import numpy as np

from . import fit_words, words


def parts(profile, points):
    """(name, which points) of the two sides along the rod's path, of the whole line across it; points left out of the fit do not count."""
    x, along = points.x, profile.get("along", "x") == "x"
    named = (("behind the rod", x < 0), ("ahead", x > 0)) if along else (("", np.isfinite(x)),)
    return [(name, side & points.used) for name, side in named if (side & points.used).any()]


def rms(points, kept):
    """Deviation in standard errors, and relative to the data; the first nan without errors."""
    off = (points.value - points.model)[kept]
    with np.errstate(invalid="ignore"):
        size = math.sqrt(((off / points.sigma[kept]) ** 2).mean())
    return size, math.sqrt((off ** 2).mean() / max((points.value[kept] ** 2).mean(), 1e-300))


def agrees(points, kept, share):
    """chi2 within two standard deviations, sqrt(2 n), of its mean n; `share`: independent values per point."""
    count = share * kept.sum()
    chi2 = count * rms(points, kept)[0] ** 2
    return bool(chi2 <= count + 2 * math.sqrt(2 * count))  # not without errors


def side_html(points, kept, share):
    size, part = rms(points, kept)
    if not math.isfinite(size):
        return f"off by {100 * part:.0f} % (rms), of unknown error"
    sigmas = f'<span class="eq">{words.number(size, 2)} <i>σ</i></span>'
    return f"within the errors (rms {sigmas})" if agrees(points, kept, share) else f"off by {100 * part:.0f} % (rms {sigmas})"


def html(fit, profile):
    """`behind the rod within the errors (rms 0.8 σ), ahead off by 40 % (rms 2.1 σ)`."""
    points, share = fit.points(profile), fit.number(profile, "independent", 1.0)
    return ", ".join(f"{name} {side_html(points, kept, share)}".strip() for name, kept in parts(profile, points))


def size_html(fit, profile):
    """By which factor the data exceed the prediction, where it agrees, so that the factor means something."""
    points, share = fit.points(profile), fit.number(profile, "independent", 1.0)
    size = fit_words.excess(profile)
    good = size and math.isfinite(size[1]) and all(agrees(points, kept, share) for _, kept in parts(profile, points))
    return f'; the data are <span class="eq">{fit_words.excess_html(size)}</span> times the theory' if good else ""
