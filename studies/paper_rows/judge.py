"""Verdicts: what a value with its error says about the paper's value or statement. The rules are in docs/paper.md.

A statement is confirmed at two standard errors and refuted at three; between the two, and where the error is too large for the
question, the verdict is "inconclusive". Exact results (the theory, solved to ten digits) have the error 0.
"""

from dataclasses import dataclass
from math import hypot, isfinite, nan

MATCHES, DIFFERS, UNKNOWN = VERDICTS = "matches", "differs", "inconclusive"
NOTHING = "-"                  # instead of a value
CONFIRMED, REFUTED = 2.0, 3.0  # standard errors
LARGEST = 1.0 / 3.0            # of the paper's value: with a larger error of ours three errors reach from it to 0


@dataclass(frozen=True)
class Judged:
    verdict: str
    ours: str
    difference: str = ""


def plain(value, digits=3):
    return f"{value:.{digits}g}" if isfinite(value) else "unknown"


def with_error(value, error, unit=""):
    """-1.90 +- 0.47 a: as many places as two digits of the error ask for, and no more than seven digits of the value."""
    if not isfinite(value):
        return NOTHING
    if not error or not isfinite(error):
        return f"{plain(value, 4)} {unit}".rstrip() + ("" if error == 0 else " (error unknown)")
    if error < 5e-7 * abs(value):
        return f"{value:.7g} ± {error:.0e} {unit}".rstrip()
    places = max(0, -int(f"{error:.1e}".split("e")[1]) + 1)
    return f"{value:.{places}f} ± {error:.{places}f} {unit}".rstrip()


def in_sigma(distance, error):
    ratio = abs(distance) / error
    return "more than 100 sigma" if ratio > 100 else f"{ratio:.1f} sigma"


def unknown(why, ours=""):
    return Judged(UNKNOWN, ours or NOTHING, why)


def by_distance(distance, error):
    """The verdict on something that should not be above 0."""
    if error is None or not isfinite(error) or not isfinite(distance):
        return UNKNOWN
    if distance + CONFIRMED * error <= 0.0:
        return MATCHES
    return DIFFERS if distance - REFUTED * error > 0.0 else UNKNOWN


def number(value, error, paper, paper_error, unit=""):
    """A value of the paper; paper_error is half of its last printed digit, or what it states."""
    ours = with_error(value, error, unit)
    if not isfinite(value):
        return unknown("the value is unknown")
    if error is None or not isfinite(error):
        return unknown("the error is unknown", ours)
    off, both = abs(value - paper), hypot(error, paper_error)
    difference = with_error(value - paper, both, unit) + (f" ({in_sigma(off, both)})" if both > 0 else "")
    if off > REFUTED * both:
        return Judged(DIFFERS, ours, difference)
    if off > CONFIRMED * both or error > LARGEST * abs(paper):
        return Judged(UNKNOWN, ours, difference)
    return Judged(MATCHES, ours, difference)


def sign(value, error, expected, unit=""):
    """A direction: expected is +1 or -1."""
    ours = with_error(value, error, unit)
    if ours == NOTHING:
        return unknown("no runs at these settings")
    side = expected * value
    if side == 0:
        return unknown("no direction", ours)
    distance = f"{in_sigma(side, error)} {'with' if side > 0 else 'against'} the paper" if error and isfinite(error) else ""
    return Judged(by_distance(-side, error), ours, distance)


def at_most(value, error, bound, unit=""):
    return Judged(by_distance(value - bound, error), with_error(value, error, unit), f"criterion: at most {plain(bound)} {unit}".rstrip())


def at_least(value, error, bound, unit=""):
    return Judged(by_distance(bound - value, error), with_error(value, error, unit), f"criterion: at least {plain(bound)} {unit}".rstrip())


def none(value, error, smallest, unit=""):
    """"No effect": an effect of the size `smallest`, which would count, is ruled out."""
    judged = at_most(abs(value), error, smallest, unit)
    return Judged(judged.verdict, with_error(value, error, unit), f"criterion: below {plain(smallest)} {unit} either way".replace("  ", " "))


def between(value, error, low, high, unit=""):
    """A range that the paper states."""
    outside = max(low - value, value - high)
    return Judged(by_distance(outside, error), with_error(value, error, unit), f"criterion: {plain(low)} to {plain(high)} {unit}".rstrip())


def bracket(low, high, paper_low, paper_high):
    """A place known to lie between two of ours, hard bounds and not errors, against the range that the paper leaves."""
    if not (isfinite(low) and isfinite(high)):
        return unknown("no place found")
    slack = 1e-9 * abs(paper_high)  # of the decimals
    inside, apart = paper_low - slack <= low and high <= paper_high + slack, high < paper_low - slack or low > paper_high + slack
    return Judged(MATCHES if inside else DIFFERS if apart else UNKNOWN, f"between {plain(low)} and {plain(high)}",
                  f"criterion: inside {plain(paper_low)} to {plain(paper_high)}")


def holds(true, ours, difference=""):
    """An exact result, or a class without an error."""
    return Judged(MATCHES if true else DIFFERS, ours, difference)


def together(*parts):
    """Several that must all hold: one that differs decides, one that is inconclusive leaves it open."""
    verdicts = [part.verdict for part in parts]
    verdict = DIFFERS if DIFFERS in verdicts else UNKNOWN if UNKNOWN in verdicts else MATCHES
    joined = ("; ".join(text for text in texts if text) for texts in zip(*((part.ours, part.difference) for part in parts)))
    return Judged(verdict, *joined)


def weighted(values, errors):
    """Mean with weights 1/error^2 and its standard error; unknown where an error is."""
    if not all(isfinite(error) and error > 0 for error in errors):
        return nan, nan
    weights = [1.0 / error**2 for error in errors]
    total = sum(weights)
    return sum(w * v for w, v in zip(weights, values)) / total, total**-0.5
