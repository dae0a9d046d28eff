"""The part of the report about a fit: results, quality and how they were found."""

import math

from . import fit_errors, fit_words, words


def parts(run):
    """Paragraphs as HTML, tables as (name, heads, rows); nothing for what there is nothing of."""
    fit = run.fit
    yield models(fit)
    yield quality(fit)
    yield remarks(fit)
    yield medium(run)
    yield named("Fitted parameters", ("Parameter", "Value", "95 % interval", "Start", "Bounds", "Remark"),
                [*map(parameter_row, fit.parameters.values()), *derived_rows(fit)])
    yield named("Correlations", *correlations_table(fit))
    yield named("Errors by source", *systematics_table(fit))
    yield named("Maps", *maps_table(fit))
    yield named("Profiles", *profiles_table(fit))
    yield named("Trajectories", *trajectories_table(fit))
    yield named("Other values", *compared_table(fit))
    yield from posterior(run)
    yield named("Model comparison", ("Model", "Weight", "Free parameters", "<i>χ</i>²", "AIC", "BIC", "Log evidence", "Cross-validation, relative to the best",
                                   "Goodness of fit"), [model_row(fit, one) for one in fit.models])
    yield named("Goodness of fit", ("Test", "Value", "Expected", "Probability"), list(misfit_rows(fit)))
    yield named("Likelihood intervals", ("Parameter", "95 % interval"), likelihood_rows(fit))
    yield named("Search", ("Item", "Value"), list(search_rows(fit)))


def of_medium(medium, key, unit):
    error = medium.get(f"{key}_stderr")
    return fit_words.with_unit(words.with_error(medium[key], error if words.is_number(error) and error > 0 else None), unit)


def named(name, heads, rows):
    return (name, heads, rows) if rows else ""


def headline(run):
    """One line under the title."""
    fit = run.fit
    values = fit_words.medium_values(fit) or fit_words.values(fit.free)
    return f'<p class="outcome"><span class="tag">fit</span>{values or "no free parameter"}.</p>'


def chi2_words(fit):
    chi2, dof = fit.number(fit.record, "chi2"), fit.number(fit.record, "dof")
    if not dof > 0:
        return f"{words.equation('<i>χ</i>²', chi2)}, no degrees of freedom left"
    return words.equation("<i>χ</i>²/dof", chi2 / dof, digits=3)


def models(fit):
    """Which medium the numbers belong to."""
    media = []
    if fit.maps and fit.maps[0].get("medium") == "isotropic":
        return "<p>Fitted: maps by the steady field of an <b>isotropic</b> medium outside the mask; lines are predicted by it.</p>"
    if fit.profiles:
        media.append("profiles by the steady field of an <b>isotropic</b> medium along a line")
    if fit.maps:
        media.append("maps by the steady field of an <b>orthotropic</b> medium outside the mask")
    return f"<p>Fitted: {' and '.join(media)}.</p>" if media else ""


def quality(fit):
    record = fit.record
    chi2, dof, chance = (fit.number(record, key) for key in ("chi2", "dof", "probability"))
    text = f"{words.equation('<i>χ</i>²', chi2)} for {words.number(int(dof)) if math.isfinite(dof) else '?'} degrees of freedom"
    text += f", {chi2_words(fit)}" if dof > 0 else ""
    known = fit.number(record, "error_factor", 1.0) == 1.0
    if known and dof > 0 and math.isfinite(chance) and fit.misfit.get("describes") is not False:
        text += (f"; if theory and errors are right, the probability of at least this <i>χ</i>² is "
                 f"{words.number(chance, 2) if chance > 1e-300 else 'zero'}")
    if not known:
        text += (f"; the errors of the data are unknown or not trusted, so the errors of the parameters were multiplied by "
                 f"{words.number(fit.number(record, 'error_factor'), 4)}")
    if record.get("rms") is not None:
        text += f". Root mean square of the residuals: {words.number(fit.number(record, 'rms'), 4)}" + (" standard errors" if known else "")
    if record.get("loss") not in (None, "squares"):
        text += f". Minimised: {words.escape(record['loss'])} loss, {words.number(fit.number(record, 'objective'), 6)} at the end"
    return f"<p>{text}.</p>"


def remarks(fit):
    """In the program's words; flat directions too, unless a remark has them already."""
    texts = [*fit.remarks, *(text for one in fit.flat if (text := str(one.get("text", ""))) and text not in fit.remarks)]
    return "<ul>\n" + "\n".join(f"<li>{words.escape(fit_words.without_folders(one))}</li>" for one in texts) + "\n</ul>" if texts else ""


def medium(run):
    if not isinstance(run.medium, dict):
        return ""
    known = [f'<span class="eq">{fit_words.symbol_html(key)} = {of_medium(run.medium, key, unit)}</span>'
             for key, unit in (("eta", ""), ("xi", "f/mu"), ("alpha", "")) if words.is_number(run.medium.get(key))]
    return f"<p>Rods and field of this run are in the fitted medium: {', '.join(known)}.</p>" if known else ""


# The tables of the report about a fit; cells are HTML.

ENDINGS = {"converged": "converged", "roundoff": "no further progress is possible in double precision",
           "budget": "the evaluations allowed were spent first", "interrupted": "interrupted: the best point so far",
           "failed": "failed"}


def name_of(one):
    symbol = fit_words.symbol_html(one)
    return symbol if symbol == words.escape(one) else f"{symbol} <code>{words.escape(one)}</code>"


def parameter_row(one):
    fitted = one.free or math.isfinite(one.error)  # a tied one has the error of what it follows
    value = fit_words.value(one) if fitted else fit_words.with_unit(words.number(one.value, 6), one.unit)
    interval = fit_words.interval_html(one.low, one.high, one.unit) if one.free and one.low < one.high else ""
    start = words.number(one.start) if one.free and math.isfinite(one.start) else ""
    return name_of(one.name), whole(value), whole(interval), start, whole(bounds_cell(one)) if one.free else "", remark_cell(one)


def whole(text):
    """Does not break across lines."""
    return f'<span class="eq">{text}</span>' if text else ""


def bounds_cell(one):
    return "none" if not any(map(math.isfinite, one.bounds)) else fit_words.interval_html(*one.bounds)


def remark_cell(one):
    parts = [fit_words.meaning(one.name)]
    if one.tied_to:
        parts.append(f"tied to {fit_words.symbol_html(one.tied_to)}")
    elif one.fixed:
        parts.append("fixed")
    if one.at_bound:
        parts.append(f"<b>at its {words.escape(one.at_bound)} bound</b>")
    if one.free and one.log:
        parts.append("searched in the logarithm")
    return "; ".join(part for part in parts if part)


def derived_rows(fit):
    for name, (value, error, unit) in fit.derived.items():
        if math.isfinite(value):
            text = fit_words.with_unit(words.with_error(value, error), unit)
            yield name_of(name), whole(text), "", "", "", "; ".join(filter(None, (fit_words.meaning(name), "follows from the others")))


def correlations_table(fit):
    if len(fit.free) < 2:
        return (), []
    matrix = fit.correlation
    heads = ("", *(fit_words.symbol_html(one.name) for one in fit.free))
    rows = []
    for row, one in enumerate(fit.free):
        lacking = [not math.isfinite(other.error) or not math.isfinite(one.error) for other in fit.free]
        rows.append((fit_words.symbol_html(one.name), *("–" if lacking[column] else fit_errors.correlation_number(matrix[row][column])
                                                       for column in range(row + 1)), *[""] * (len(fit.free) - row - 1)))
    return heads, rows


def maps_table(fit):
    rows = []
    for one in fit.maps:
        sides = " × ".join(words.number(side) for side in one.get("box") or [])
        rows.append((words.escape(str(one.get("name", ""))), words.escape(str(one.get("file", ""))), words.number(one.get("used")), sides,
                     words.number(one.get("speed")), words.number(one.get("chi2"))))
    return ("Map", "File", "Bins fitted", "Box", "Speed", "<i>χ</i>²"), rows


def systematics_table(fit):
    """Errors of the free parameters by source."""
    kinds = ("curvature", "held", "masks", "jackknife", "total")
    rows = []
    for name, one in fit.systematics.items():
        errors = (words.number(one[kind], 2) if words.is_number(one.get(kind)) else "–" for kind in kinds)
        rows.append((fit_words.symbol_html(name), words.number(one.get("value"), 4), *errors))
    return ("Parameter", "Value", "Curvature", "Held constants", "Masks", "Jackknife over runs", "Total"), rows


def profiles_table(fit):
    rows = []
    for one in fit.profiles:
        found = fit_words.excess(one)
        value = words.with_error(*found) if found else ""
        used, all_points = fit.number(one, "used"), fit.number(one, "points")
        chi2, worth = fit.number(one, "chi2"), fit.number(one, "independent", 1.0)  # values a point is worth
        rows.append((words.escape(one.get("name", "")), fit_words.line_html(one, fit.unit),
                     "prediction" if fit_words.predicted(one) else "fitted", f"{used:.0f} of {all_points:.0f}" if math.isfinite(used + all_points) else "",
                     words.number(chi2) if math.isfinite(chi2) else "",
                     words.number(chi2 / (used * worth), 3) if used * worth > 0 and math.isfinite(chi2) else "",
                     whole(value)))
    return ("Profile", "Shows", "Role", "Points used", "<i>χ</i>²", "<i>χ</i>²/values", "Data over theory"), rows


def trajectories_table(fit):
    rows = [(words.escape(one.get("name", "")), words.number(int(fit.number(one, "rods", 0))),
             words.number(fit.number(one, "rms_position")), words.number(fit.number(one, "rms_heading"))) for one in fit.trajectories]
    return ("Trajectory", "Rods", "Positions, rms left (unit of the file)", "Headings, rms left (rad)"), rows


def compared_table(fit):
    """This fit and other values of the parameters side by side."""
    if not fit.compared:
        return (), []
    fitted = [index for index, one in enumerate(fit.profiles) if not fit_words.predicted(one)]
    heads = ("Values", "", "<i>χ</i>² of the fitted", *(f"<i>χ</i>² of {fit_words.line_html(one, fit.unit)}" for one in fit.profiles))
    own = sum(fit.number(fit.profiles[index], "chi2") for index in fitted)
    rows = [("this fit", values_cell({one.name: one.value for one in fit.parameters.values()}), words.number(own), *map(chi2_cell(fit), fit.profiles))]
    for one in fit.compared:
        each = one.get("profiles") if isinstance(one.get("profiles"), list) else []
        cells = [*map(chi2_cell(fit), each), *[""] * len(fit.profiles)][:len(fit.profiles)]
        rows.append((words.label_html(str(one.get("name", ""))), values_cell(one.get("values") or {}), words.number(fit.number(one, "chi2")),
                     *cells))
    return heads, rows


def chi2_cell(fit):
    def of(profile):
        value = fit.number(profile, "chi2") if isinstance(profile, dict) else math.nan
        return words.number(value) if math.isfinite(value) else ""
    return of


def values_cell(given):
    return ", ".join(words.equation(fit_words.symbol_html(name), value) for name, value in given.items() if words.is_number(value))


def likelihood_rows(fit):
    return [(name_of(name), fit_words.interval_html(fit.number(one, "low", -math.inf), fit.number(one, "high", math.inf),
                                                    fit.parameters[name].unit if name in fit.parameters else ""))
            for name, one in fit.likelihood.items() if isinstance(one, dict)]


def posterior(run):
    """Means, intervals, priors and how the chains mix; the evidence; what is not to be trusted."""
    if not run.has_posterior:
        return
    found = run.posterior
    yield named("Posterior", ("Parameter", "Mean", "Median", "95 % of the samples", "Prior", "R-hat", "Effective samples"),
                [(name_of(one.name), whole(fit_words.with_unit(words.with_error(one.mean, one.sd), one.unit)),
                  whole(fit_words.with_unit(words.number(one.median), one.unit)), whole(fit_words.interval_html(one.low, one.high, one.unit)),
                  whole(prior_cell(one.prior)), f"{one.rhat:.4f}", f"{one.ess:.0f}") for one in found.parameters])
    if found.log_evidence:
        yield (f"<p>Logarithm of the evidence, the probability of the data given the model and its priors: "
               f"{words.with_error(*found.log_evidence)}. Differences between models of the same data count, not the number itself.</p>")
    if found.remarks:
        yield "<ul>\n" + "\n".join(f"<li>{words.escape(one)}</li>" for one in found.remarks) + "\n</ul>"


def prior_cell(prior):
    between = fit_words.interval_html(prior.low, prior.high)
    if prior.kind == "normal":
        cut = "" if between == "unbounded" else f", {between}"
        return f"normal, {words.number(prior.mean)} ± {words.number(prior.sd)}{cut}"
    return f"{'even in the logarithm' if prior.kind == 'log_uniform' else 'even'}, {between}"


def model_row(fit, one):
    number = lambda key: fit.number(one, key)
    shown = lambda value, error=math.nan: words.with_error(value, error if error > 0 else None) if math.isfinite(value) else "–"
    apart = one.get("cross_validation") or {}
    return (words.escape(str(one.get("name", ""))), shown(number("weight")), words.number(one.get("free", "?")), shown(number("chi2")), shown(number("aic")),
            shown(number("bic")), shown(number("log_evidence"), number("stderr")),
            shown(fit.number(apart, "difference"), fit.number(apart, "difference_stderr")),
            fit_words.chance_html(fit.number(one.get("misfit") or {}, "probability")))


TESTS = {"chi2": "<i>χ</i>²", "runs": "runs of one sign", "largest": "largest deviation, in standard errors"}


def misfit_rows(fit):
    """The tests of the residuals, then <i>χ</i>² by region."""
    for name, one in (fit.misfit.get("tests") or {}).items():
        if name in TESTS:
            expected = words.number(one["expected"]) if one.get("expected") else "–"
            yield TESTS[name], words.number(one.get("value", "?")), expected, fit_words.chance_html(fit.number(one, "probability"))
    for one in fit.misfit.get("regions") or []:
        yield (f"<i>χ</i>² of {words.escape(str(one.get('name', '')))}", words.number(one.get("chi2", "?")), words.number(one.get("expected", "?")),
               fit_words.chance_html(fit.number(one, "probability")))


def search_rows(fit):
    record = fit.record
    ending = str(record.get("termination", ""))
    yield "End", f"{ENDINGS.get(ending, words.escape(ending))}" + (f": {words.escape(record['reason'])}" if record.get("reason") else "")
    for key, name in (("algorithm", "Algorithm"), ("evaluations", "Evaluations of the residuals"), ("rank", "Rank of the Jacobian"),
                      ("seed", "Seed")):
        if record.get(key) is not None:
            yield name, words.number(record[key]) if words.is_number(record[key]) else words.escape(record[key])
    if len(fit.starts) > 1:
        same = record.get("same_optimum")
        reached = f", {words.number(same)} of which reached the same optimum" if words.is_number(same) else ""
        yield "Starts", words.number(len(fit.starts)) + reached
    if record.get("box") is not None:
        sides = record["box"] if isinstance(record["box"], list) else [fit.number(record, "box")]
        yield "Periodic box", f"{'sides' if len(sides) > 1 else 'side'} {' × '.join(map(words.number, sides))} {fit_words.unit_html(fit.unit)}"
    core, spacing = fit.number(record, "core", 0.0), fit.number(record, "independent_spacing", 0.0)
    if core > 0:
        yield "Core left out", f"points within {words.number(core)} {fit_words.unit_html(fit.unit)}"
    if spacing > 0:
        yield "Independent spacing", (f"{words.number(spacing)} {fit_words.unit_html(fit.unit)}: closer points share data, so their "
                                      "errors were enlarged")
