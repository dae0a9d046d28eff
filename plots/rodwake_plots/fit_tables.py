"""The tables of the report about a fit; cells are HTML."""

import math

from . import fit_correlation, fit_words, words

ENDINGS = {"converged": "converged", "roundoff": "no further progress is possible in double precision",
           "budget": "the evaluations allowed were spent first", "interrupted": "interrupted: the best point so far",
           "failed": "failed"}


def name_of(one):
    told = fit_words.symbol_html(one)
    return told if told == words.escape(one) else f"{told} <code>{words.escape(one)}</code>"


def parameter(one):
    fitted = one.free or math.isfinite(one.error)  # a tied one has the error of what it follows
    value = fit_words.value(one) if fitted else fit_words.with_unit(words.number(one.value, 6), one.unit)
    interval = fit_words.interval_html(one.low, one.high, one.unit) if one.free and one.low < one.high else ""
    start = words.number(one.start) if one.free and math.isfinite(one.start) else ""
    return name_of(one.name), whole(value), whole(interval), start, whole(bounds(one)) if one.free else "", remark(one)


def whole(text):
    """Does not break across lines."""
    return f'<span class="eq">{text}</span>' if text else ""


def bounds(one):
    return "none" if not any(map(math.isfinite, one.bounds)) else fit_words.interval_html(*one.bounds)


def remark(one):
    parts = [fit_words.meaning(one.name)]
    if one.tied_to:
        parts.append(f"tied to {fit_words.symbol_html(one.tied_to)}")
    elif one.fixed:
        parts.append("fixed")
    if one.at_bound:
        parts.append(f"<b>held by its {words.escape(one.at_bound)} bound</b>")
    if one.free and one.log:
        parts.append("searched in the logarithm")
    return "; ".join(part for part in parts if part)


def derived(fit):
    for name, (value, error, unit) in fit.derived.items():
        if math.isfinite(value):
            text = fit_words.with_unit(words.with_error(value, error), unit)
            yield name_of(name), whole(text), "", "", "", "; ".join(filter(None, (fit_words.meaning(name), "follows from the others")))


def correlations(fit):
    if len(fit.free) < 2:
        return (), []
    matrix = fit.correlation
    heads = ("", *(fit_words.symbol_html(one.name) for one in fit.free))
    rows = []
    for row, one in enumerate(fit.free):
        lacking = [not math.isfinite(other.error) or not math.isfinite(one.error) for other in fit.free]
        rows.append((fit_words.symbol_html(one.name), *("–" if lacking[column] else fit_correlation.number(matrix[row][column])
                                                       for column in range(row + 1)), *[""] * (len(fit.free) - row - 1)))
    return heads, rows


def maps(fit):
    rows = []
    for one in fit.maps:
        sides = " × ".join(words.number(side) for side in one.get("box") or [])
        rows.append((words.escape(str(one.get("name", ""))), words.escape(str(one.get("file", ""))), words.number(one.get("used")), sides,
                     words.number(one.get("speed")), words.number(one.get("chi2"))))
    return ("Map", "File", "Bins fitted", "Box", "Speed", "<i>χ</i>²"), rows


def systematics(fit):
    """Errors of the free parameters by where they come from."""
    kinds = ("curvature", "held", "masks", "jackknife", "total")
    rows = []
    for name, one in fit.systematics.items():
        errors = (words.number(one[kind], 2) if words.is_number(one.get(kind)) else "–" for kind in kinds)
        rows.append((fit_words.symbol_html(name), words.number(one.get("value"), 4), *errors))
    return ("Parameter", "Value", "Curvature", "Held constants", "Masks", "Jackknife over runs", "Total"), rows


def profiles(fit):
    rows = []
    for one in fit.profiles:
        found = fit_words.excess(one)
        told = words.with_error(*found) if found else ""
        used, all_points = fit.number(one, "used"), fit.number(one, "points")
        chi2, worth = fit.number(one, "chi2"), fit.number(one, "independent", 1.0)  # values a point is worth
        rows.append((words.escape(one.get("name", "")), fit_words.line_html(one, fit.unit),
                     "prediction" if fit_words.predicted(one) else "fitted", f"{used:.0f} of {all_points:.0f}" if math.isfinite(used + all_points) else "",
                     words.number(chi2) if math.isfinite(chi2) else "",
                     words.number(chi2 / (used * worth), 3) if used * worth > 0 and math.isfinite(chi2) else "",
                     whole(told)))
    return ("Profile", "Shows", "Role", "Points used", "<i>χ</i>²", "<i>χ</i>²/values", "Data over theory"), rows


def trajectories(fit):
    rows = [(words.escape(one.get("name", "")), words.number(int(fit.number(one, "rods", 0))),
             words.number(fit.number(one, "rms_position")), words.number(fit.number(one, "rms_heading"))) for one in fit.trajectories]
    return ("Trajectory", "Rods", "Positions, rms left (unit of the file)", "Headings, rms left (rad)"), rows


def compared(fit):
    """This fit and other values of the parameters side by side."""
    if not fit.compared:
        return (), []
    fitted = [index for index, one in enumerate(fit.profiles) if not fit_words.predicted(one)]
    heads = ("Values", "", "<i>χ</i>² of the fitted", *(f"<i>χ</i>² of {fit_words.line_html(one, fit.unit)}" for one in fit.profiles))
    own = sum(fit.number(fit.profiles[index], "chi2") for index in fitted)
    rows = [("this fit", values({one.name: one.value for one in fit.parameters.values()}), words.number(own), *map(chi2(fit), fit.profiles))]
    for one in fit.compared:
        each = one.get("profiles") if isinstance(one.get("profiles"), list) else []
        cells = [*map(chi2(fit), each), *[""] * len(fit.profiles)][:len(fit.profiles)]
        rows.append((words.label_html(str(one.get("name", ""))), values(one.get("values") or {}), words.number(fit.number(one, "chi2")),
                     *cells))
    return heads, rows


def chi2(fit):
    def of(profile):
        value = fit.number(profile, "chi2") if isinstance(profile, dict) else math.nan
        return words.number(value) if math.isfinite(value) else ""
    return of


def values(given):
    return ", ".join(words.equation(fit_words.symbol_html(name), value) for name, value in given.items() if words.is_number(value))


def likelihood(fit):
    return [(name_of(name), fit_words.interval_html(fit.number(one, "low", -math.inf), fit.number(one, "high", math.inf),
                                                    fit.parameters[name].unit if name in fit.parameters else ""))
            for name, one in fit.likelihood.items() if isinstance(one, dict)]


def search(fit):
    told = fit.told
    ending = str(told.get("termination", ""))
    yield "End", f"{ENDINGS.get(ending, words.escape(ending))}" + (f": {words.escape(told['reason'])}" if told.get("reason") else "")
    for key, name in (("algorithm", "Algorithm"), ("evaluations", "Evaluations of the residuals"), ("rank", "Rank of the Jacobian"),
                      ("seed", "Seed")):
        if told.get(key) is not None:
            yield name, words.number(told[key]) if words.is_number(told[key]) else words.escape(told[key])
    if len(fit.starts) > 1:
        same = told.get("same_optimum")
        reached = f", of which {words.number(same)} reached the same optimum" if words.is_number(same) else ""
        yield "Starts", words.number(len(fit.starts)) + reached
    if told.get("box") is not None:
        sides = told["box"] if isinstance(told["box"], list) else [fit.number(told, "box")]
        yield "Periodic box", f"{'sides' if len(sides) > 1 else 'side'} {' × '.join(map(words.number, sides))} {fit_words.unit_html(fit.unit)}"
    core, spacing = fit.number(told, "core", 0.0), fit.number(told, "independent_spacing", 0.0)
    if core > 0:
        yield "Core left out", f"places within {words.number(core)} {fit_words.unit_html(fit.unit)}"
    if spacing > 0:
        yield "Independent spacing", (f"{words.number(spacing)} {fit_words.unit_html(fit.unit)}: closer points share data, and their "
                                      "errors were enlarged for it")
