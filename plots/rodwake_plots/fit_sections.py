"""The part of the report that tells of a fit: what came out, how good it is, and how it was found."""

import math

from . import fit_tables, fit_words, words


def parts(run):
    """Paragraphs as HTML, tables as (name, heads, rows); nothing for what there is nothing of."""
    fit = run.fit
    yield models(fit)
    yield quality(fit)
    yield remarks(fit)
    yield medium(run)
    yield named("Fitted parameters", ("Parameter", "Value", "95 % interval", "Start", "Bounds", "Remark"),
                [*map(fit_tables.parameter, fit.parameters.values()), *fit_tables.derived(fit)])
    yield named("Correlations", *fit_tables.correlations(fit))
    yield named("Errors by their cause", *fit_tables.systematics(fit))
    yield named("Maps", *fit_tables.maps(fit))
    yield named("Profiles", *fit_tables.profiles(fit))
    yield named("Trajectories", *fit_tables.trajectories(fit))
    yield named("Other values", *fit_tables.compared(fit))
    yield named("Likelihood intervals", ("Parameter", "95 % interval"), fit_tables.likelihood(fit))
    yield named("Search", ("Item", "Value"), list(fit_tables.search(fit)))


def of_medium(medium, key, unit):
    error = medium.get(f"{key}_stderr")
    return fit_words.with_unit(words.with_error(medium[key], error if words.is_number(error) and error > 0 else None), unit)


def named(name, heads, rows):
    return (name, heads, rows) if rows else ""


def headline(run):
    """One line under the title."""
    fit = run.fit
    told = ", ".join(f'<span class="eq">{fit_words.symbol_html(one.name)} = {fit_words.value(one)}</span>' for one in fit.free)
    return f'<p class="outcome"><span class="tag">fit</span>{told or "no free parameter"}; {chi2_words(fit)}.</p>'


def chi2_words(fit):
    chi2, dof = fit.number(fit.told, "chi2"), fit.number(fit.told, "dof")
    if not dof > 0:
        return f"{words.equation('<i>χ</i>²', chi2)}, no degrees of freedom left"
    return words.equation("<i>χ</i>²/dof", chi2 / dof, digits=3)


def models(fit):
    """Which medium the numbers belong to."""
    told = []
    if fit.profiles:
        told.append("profiles by the steady field of an <b>isotropic</b> medium along a line")
    if fit.maps:
        told.append("maps by the steady field of an <b>orthotropic</b> medium outside the mask")
    return f"<p>Fitted: {' and '.join(told)}.</p>" if told else ""


def quality(fit):
    told = fit.told
    chi2, dof, chance = (fit.number(told, key) for key in ("chi2", "dof", "probability"))
    text = f"{words.equation('<i>χ</i>²', chi2)} for {words.number(int(dof)) if math.isfinite(dof) else '?'} degrees of freedom"
    text += f", {chi2_words(fit)}" if dof > 0 else ""
    known = fit.number(told, "error_factor", 1.0) == 1.0
    if known and dof > 0 and math.isfinite(chance):
        text += (f"; if theory and errors are right, so large a <i>χ</i>² or a larger one has the probability "
                 f"{words.number(chance, 2) if chance > 1e-300 else 'zero'}")
    if not known:
        text += (f"; the errors of the data are not known or not trusted, and those of the parameters were multiplied by "
                 f"{words.number(fit.number(told, 'error_factor'), 4)}")
    if told.get("rms") is not None:
        text += f". Root mean square of what is left: {words.number(fit.number(told, 'rms'), 4)}" + (" standard errors" if known else "")
    if told.get("loss") not in (None, "squares"):
        text += f". Minimised: {words.escape(told['loss'])} loss, {words.number(fit.number(told, 'objective'), 6)} at the end"
    return f"<p>{text}.</p>"


def remarks(fit):
    """In the program's words; flat directions too, unless a remark has told them already."""
    told = [*fit.remarks, *(text for one in fit.flat if (text := str(one.get("text", ""))) and text not in fit.remarks)]
    return "<ul>\n" + "\n".join(f"<li>{words.escape(one)}</li>" for one in told) + "\n</ul>" if told else ""


def medium(run):
    if not isinstance(run.medium, dict):
        return ""
    known = [f'<span class="eq">{fit_words.symbol_html(key)} = {of_medium(run.medium, key, unit)}</span>'
             for key, unit in (("eta", ""), ("xi", "f/mu"), ("alpha", "")) if words.is_number(run.medium.get(key))]
    return f"<p>Rods and field of this run are in the fitted medium: {', '.join(known)}.</p>" if known else ""
