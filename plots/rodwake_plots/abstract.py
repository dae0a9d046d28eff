"""Sentences at the head of the report that say whether the theory fits what was measured."""

import math

from . import fit_words, scan_words, words

FITS, POOR = 0.05, 0.001  # probability of so large a chi2 above which a fit is called good, below which it is not one


def sentences(run):
    """As HTML; none where nothing was compared."""
    told = []
    if run.has_fit:
        told += [verdict(run.fit), *(prediction(run.fit, one) for one in run.fit.profiles), *(other(run.fit, one) for one in run.fit.compared)]
    if run.has_scan:
        told.append(trust(run.scan))
    return [one for one in told if one]


def verdict(fit):
    """Of the data that were fitted; without known errors there is no yes or no."""
    chi2, dof, chance = (fit.number(fit.told, key) for key in ("chi2", "dof", "probability"))
    names = [fit_words.line_html(one, fit.unit) for one in fit.profiles if not fit_words.predicted(one)] or ["the trajectories"]
    data = names[0] if len(names) == 1 else ", ".join(names[:-1]) + " and " + names[-1]
    told = f"{words.equation('<i>χ</i>²', chi2)} for {words.number(int(dof))} degrees of freedom" if dof > 0 else words.equation("<i>χ</i>²", chi2)
    if not (dof > 0 and math.isfinite(chance)) or fit.number(fit.told, "error_factor", 1.0) != 1.0:
        return f"Whether the theory fits {data} cannot be told: the errors of the data are not known, or no degree of freedom is left ({told})."
    how = "fits" if chance >= FITS else "fits only poorly" if chance >= POOR else "does not fit"
    return f"The theory {how} {data}: {told}, probability {words.number(chance, 2) if chance > 1e-300 else 'zero'}."


def prediction(fit, profile):
    """How far off the theory is where it was not fitted, as a part of itself."""
    found = fit_words.excess(profile) if fit_words.predicted(profile) else None
    if not found:
        return ""
    off, error = found[0] - 1.0, found[1]
    where = place(fit, profile)
    if not (math.isfinite(error) and error > 0):
        return f"The prediction of {where} is off by {words.with_error(off, None)}, of unknown error."
    shape = misfit(fit, profile)
    size = "does not agree in size" if abs(off) > 2 * error else "has the right size but not the right shape" if shape else "agrees"
    return (f'The prediction of {where} {size}: the data are <span class="eq">{fit_words.excess_html(found)}</span> times the theory, '
            f'off by <span class="eq">{words.with_error(off, error)}</span>{f", {shape}" if shape else ""}.')


def place(fit, profile):
    """The line, and the profile's name where several are along it."""
    line = fit_words.line_html(profile, fit.unit)
    alike = [one for one in fit.profiles if fit_words.line_html(one, fit.unit) == line]
    return line if len(alike) < 2 else f"{line} (<q>{words.label_html(str(profile.get('name', '')))}</q>)"


def misfit(fit, profile):
    """chi2 where it is more than two standard deviations, sqrt(2 n), above its mean n, the number of independent points."""
    chi2, points, share = (fit.number(profile, key, absent) for key, absent in (("chi2", math.nan), ("used", 0.0), ("independent", 1.0)))
    count = points * share
    if not (count > 0 and chi2 > count + 2 * math.sqrt(2 * count)):
        return ""
    return f"{words.equation('<i>χ</i>²', chi2)} for {words.number(round(count))} independent points"


def other(fit, one):
    chi2 = fit.number(one, "chi2")
    if not math.isfinite(chi2):
        return ""
    return f"The values <q>{words.label_html(str(one.get('name', '')))}</q> give {words.equation('<i>χ</i>²', chi2)} against {words.number(fit.number(fit.told, 'chi2'))}."


def trust(scan):
    """How far a phase diagram can be trusted where nobody looked."""
    missed = scan_words.missed_html(scan).strip()
    if missed:
        return missed
    return "Places between the points of this scan were not checked." if scan.design == "adaptive" else ""
