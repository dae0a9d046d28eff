"""Captions of figures of a fit."""

import numpy as np

from . import fit_words, words


def of(fit, views, spec):
    text = "Displacement of the medium around a rod that heads along +<i>x</i>: data (points"
    known = any(np.isfinite(view.points.sigma).any() for view in views)
    text += ", bars: standard error" if known else ", of unknown error"
    text += f") and the theory of an isotropic medium (lines). {fitted_to(fit)}: {values(fit)}. "
    if any(np.nanmax(view.curve.band, initial=0.0) > 0 for view in views):
        text += "Shaded: one standard error of the fitted curve. "
    if spec.residuals:
        text += "Below each panel the residuals" + (" in standard errors; triangles at the edge: beyond it. " if known else "; triangles at the edge: beyond it. ")
    core = fit.number(fit.told, "core", 0.0)
    text += f"Places within {words.equation('', core, fit_words.unit_html(fit.unit)).replace(' = ', '')} were left out. " if core > 0 else ""
    text += "".join(told(index, view, len(views), fit.unit) for index, view in enumerate(views))
    text += "".join(not_shown(fit, one) for one in fit.profiles if all(one is not view.profile for view in views))
    return text + "".join(compared(fit, one) for one in fit.compared)


def fitted_to(fit):
    """Which profiles the parameters come from."""
    names = [fit_words.line_html(one, fit.unit) for one in fit.profiles if not fit_words.predicted(one)]
    if not names:
        return "Fitted to trajectories"
    return "Fitted to " + (names[0] if len(names) == 1 else ", ".join(names[:-1]) + " and " + names[-1])


def values(fit):
    """All values, the free ones with their errors."""
    return ", ".join(f'<span class="eq">{fit_words.symbol_html(one.name)} = {fit_words.value(one)}</span>' for one in fit.parameters.values())


def told(index, view, count, unit):
    """What is special of one panel."""
    if not fit_words.predicted(view.profile):
        return ""
    found = fit_words.excess(view.profile)
    name = f"{fit_words.letter(index)} " if count > 1 else ""
    more = f'; the data are <span class="eq">{fit_words.excess_html(found)}</span> times as large' if found else ""
    return f"{name}{fit_words.line_html(view.profile, unit)} was not fitted: a prediction{more}. "


def not_shown(fit, profile):
    """What the fit says of a predicted profile that has no panel, by its name."""
    found = fit_words.excess(profile) if fit_words.predicted(profile) else None
    if not found:
        return ""
    return f'{words.label_html(str(profile.get("name", "")))}: the data are <span class="eq">{fit_words.excess_html(found)}</span> times the prediction. '


def compared(fit, one):
    given = one.get("values") if isinstance(one.get("values"), dict) else {}
    known = ", ".join(words.equation(fit_words.symbol_html(name), value, unit_of(fit, name)) for name, value in given.items())
    return f"For comparison, {words.label_html(str(one.get('name', '')))}: {known}. "


def unit_of(fit, name):
    return fit_words.unit_html(fit.parameters[name].unit) if name in fit.parameters else ""
