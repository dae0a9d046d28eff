"""The parts of the report that are words and tables."""

import math

from . import bed_sections, fit_prediction, fit_sections, fit_words, scan_words, schema, words
from .trajectories import outcome_words, parameters as run_parameters


def table(heads, rows):
    """Cells are HTML already."""
    if not rows:
        return ""
    head = "".join(f"<th>{name}</th>" for name in heads)
    body = "\n".join("<tr>" + "".join(f"<td>{cell}</td>" for cell in row) + "</tr>" for row in rows)
    kind = ' class="keys"' if heads[1:2] == ("Symbol",) else ' class="wide"' if len(heads) > 5 else ""
    return f'<div class="scroll"><table{kind}>\n<thead><tr>{head}</tr></thead>\n<tbody>\n{body}\n</tbody></table></div>'


def flat(record, prefix=""):
    """(name, value as HTML) of a nested record, names joined by spaces."""
    for key, value in record.items():
        name = f"{prefix} {key}".strip().replace("_", " ")
        if isinstance(value, dict):
            yield from flat(value, name)
        elif isinstance(value, list):
            yield name, words.escape(" ".join(map(str, value)))
        else:
            yield name, words.number(value, 6)


def header(run):
    units = "SI units" if run.units.si else ("reduced units: lengths in <i>f</i>/<i>μ</i>, times in "
                                                    "<i>f</i>/(<i>μv</i><sub>0</sub>)")
    if run.has_fit and not (has_theory(run) or run.has_granular):
        units = f"lengths in {fit_words.unit_html(run.fit.unit)}"
    head = f'<header>\n<h1>{words.escape(run.title)}</h1>\n<div class="sub">rodwake {words.escape(run.version)}, {units}</div>'
    return f"{head}\n</header>"


def abstract(run, sentences):
    """What was done and came out, and whether the theory fits."""
    text = bed_sections.bed_headline(run) if run.has_granular else bed_sections.tracks_headline(run) if run.has_tracks else ""
    text += fit_sections.headline(run) if run.has_fit else ""
    text += scan_words.scan_headline(run) if run.has_scan else ""
    text += outcome(run) if has_theory(run) else ""
    return text + (f'<p class="verdict">{" ".join(sentences)}</p>' if sentences else "")


def has_theory(run):
    """Every run leaves a result file; that of a bed or a fit alone holds neither rods nor a field."""
    return run.has_result and any(map(run.result.has, ("/rods", "/field")))


def outcome(run):
    if not run.outcome:
        return '<p class="outcome">The field of one rod; no rods were integrated.</p>'
    name = str(run.outcome.get("outcome", "undecided"))
    return f'<p class="outcome"><span class="tag">{words.escape(name)}</span>{sentence(run, name)}{known(run)}</p>'


def known(run):
    """How well the outcome is known."""
    verified = " The outcome is verified."  # version 0.3 wrote proved
    return {"verified": verified, "proved": verified, "checked": " The outcome is checked by a second, tighter run.",
            "open": " The outcome is neither verified nor checked."}.get(run.outcome.get("certificate"), "")


def sentence(run, name):
    units = run.result.units
    time = words.equation("<i>t</i>", run.outcome.get("time", "?"), units.time_html(), digits=6)
    nearest = f"{words.number(run.outcome.get('min_separation', '?'), 6)} {units.length_html()}"
    pair = run.outcome.get("pair") or []
    who = f"rods {words.number(pair[0])} and {words.number(pair[1])}" if len(pair) == 2 else "the rods"
    return {
        "contact": f"Contact: {who} met at {time}, {nearest} apart.",
        "pursuit": f"Pursuit: the headings of {who} locked and their separation stayed bounded until {time}; closest approach {nearest}.",
        "orbit": f"Orbit: {who} circle each other, {words.number(run.outcome.get('separation', '?'), 6)} {units.length_html()} apart.",
        "bound": f"Bound: {who} push each other until the end, {words.number(run.outcome.get('separation', '?'), 6)} {units.length_html()} apart.",
        "escape": f"Escape: {who} went apart; closest approach {nearest}, followed until {time}.",
    }.get(name, f"No outcome was decided until {time}; closest approach {nearest}.")


def runs(run):
    """Scene and variants side by side; a single run is described in the header."""
    found = run.result.runs() if run.has_result else []
    if len(found) < 2:
        return ""
    rows = [(words.label_html(one.label), outcome_words(run.result.units, one), run_parameters(run.result.units, one).rstrip(".")) for one in found]
    return table(("Run", "Outcome", "Parameters"), rows)


def fit(run):
    """Parameters, how good they are, and how they were found."""
    if not run.has_fit:
        return ""
    return "\n".join(one if isinstance(one, str) else f"<h3>{one[0]}</h3>\n{table(*one[1:])}" for one in fit_sections.parts(run) if one)


def scan(run):
    """How the points were chosen, what became of them, and the axes."""
    if not run.has_scan:
        return ""
    points = table(("What", "Value"), list(scan_words.point_rows(run.scan)))
    return f"{points}\n<h3>Axes</h3>\n{table(('Key', 'Axis', 'Range', 'Spacing'), list(scan_words.axis_rows(run.scan)))}"


def granular(run):
    """What was modelled, what came out, what it cost."""
    if not run.has_granular:
        return ""
    parts = (("Modelled", ("What", "Value"), bed_sections.modelled_rows(run)),
             ("Contacts", ("Pair", "Friction", "Restitution"), bed_sections.contact_rows(run)),
             ("Results", ("Quantity", "Value", "Meaning"), bed_sections.summary_rows(run)),
             ("Run", ("Item", "Value"), ((words.escape(name), value) for name, value in flat(bed_sections.other_summary(run)))))
    tables = ((name, table(heads, list(rows))) for name, heads, rows in parts)
    return "\n".join(f"<h3>{name}</h3>\n{made}" for name, made in tables if made)


def measures(run):
    """measure.json in words, of the scene and of its variants side by side."""
    return table(*bed_sections.measures_table(run)) if run.has_granular or run.has_tracks else ""


def parameters(run):
    labels = KeyLabels(run.scene.get("units", "reduced"), run.fit.unit if run.has_fit else "")
    return "\n".join(f"<h3>{name}</h3>\n<p>{meaning}</p>\n{table(heads, rows)}"
                     for name, meaning, heads, rows in scene_tables(run.scene, labels))


def solver(run):
    statistics = (run.outcome or {}).get("solver") or {}
    return table(("Quantity", "Value"), [(words.escape(name), value) for name, value in flat(statistics)])


def texts(run):
    scene = f"<details>\n<summary>Resolved scene</summary>\n<pre>{words.escape(run.scene_text)}</pre>\n</details>"
    lines = "\n".join(line for line in run.log.splitlines() if " debug: " not in line)  # log.txt has all
    log = f"<details>\n<summary>Log</summary>\n<pre>{words.escape(lines)}</pre>\n</details>" if lines.strip() else ""
    return scene + log


def provenance(run):
    if run.provenance is None:
        return "<p>provenance.json is missing from this run directory.</p>"
    return table(("Item", "Value"), [(words.escape(name), f"<code>{value}</code>") for name, value in flat(run.provenance)])


# Sentences at the head of the report that say whether the theory fits what was measured.

FITS, POOR = 0.05, 0.001  # probability of so large a chi2 above which a fit is called good, below which it is not one


def sentences(run):
    """As HTML; none where nothing was compared."""
    found = []
    if run.has_fit:
        found += [verdict(run.fit), origin_of_xi(run.fit), *comparison(run.fit), *(prediction(run.fit, one) for one in run.fit.profiles),
                 long_wake(run.fit), *(other_values(run.fit, one) for one in run.fit.compared)]
    if run.has_scan:
        found.append(trust(run.scan))
    return [one for one in found if one]


def verdict(fit):
    """One, of all tests of the residuals together; without known errors there is none."""
    chi2, dof, chance = (fit.number(fit.record, key) for key in ("chi2", "dof", "probability"))
    names = [fit_words.line_html(one, fit.unit) for one in fit.profiles if not fit_words.predicted(one)] or ["the maps" if fit.maps else "the trajectories"]
    data = words.listed(names)
    text = f"{words.equation('<i>χ</i>²', chi2)} for {words.number(int(dof))} degrees of freedom" if dof > 0 else words.equation("<i>χ</i>²", chi2)
    if not (dof > 0 and math.isfinite(chance)) or fit.number(fit.record, "error_factor", 1.0) != 1.0:
        return f"Whether the theory fits {data} is unknown: the errors of the data are unknown, or no degree of freedom is left ({text})."
    if fit.misfit.get("describes") is False:
        worst, p = fit_words.without_folders(str(fit.misfit.get("worst", ""))), fit_words.chance_html(fit.number(fit.misfit, "probability"))
        worst = text if worst.startswith("chi2 is ") else words.escape(worst).replace("chi2", "<i>χ</i>²")
        overall = f", although {text} alone would pass" if chance >= FITS else ""
        return f"The theory does not fit {data} within the errors: {worst} ({p}){overall}."
    how = "fits" if chance >= FITS else "fits only poorly" if chance >= POOR else "does not fit"
    return f"The theory {how} {data}: {text}, probability {words.number(chance, 2) if chance > 1e-300 else 'zero'}."


def origin_of_xi(fit):
    """The screening length follows from the drag that the run measured, not from the map."""
    if "drag_area" not in fit.parameters or "xi" not in fit.derived:
        return ""
    area = fit.parameters["drag_area"]
    held = [fit.number(one, "error") for one in (fit.record.get("systematics") or {}).get("held") or [] if one.get("name") == "drag_area"]
    known = fit_words.with_unit(words.with_error(area.value, held[0] if held else area.error), area.unit)
    name = fit_words.symbol_html("xi")
    source = "measured in this run by the drift of the bed" if area.fixed else "fitted"
    return (f'{name} is not read from the map: it is the drag of the plates, <span class="eq">{fit_words.symbol_html("drag_area")} = {known}</span>, '
            f'{source}, divided by {fit_words.symbol_html("f_over_mu")}.')


def long_wake(fit):
    """Whether |x|^(-1/2) can show in the box of the maps."""
    xi, box = fit.derived.get("xi"), max((float(side) for one in fit.maps for side in one.get("box") or []), default=0.0)
    if not (xi and box > 0 and xi[0] > box):
        return ""
    return (f"The long wake of the paper, <i>U<sub>x</sub></i> ∝ |<i>x</i>|<sup>−1/2</sup>, cannot be seen here, because "
            f"{fit_words.symbol_html('xi')} exceeds the box of {words.number(box, 3)} {fit_words.unit_html(fit.unit)}; "
            "<code>scenes/tail.toml</code> has a box of many screening lengths.")


def comparison(fit):
    """Of the models, as the program has it."""
    return [words.escape(str(one)) for one in fit.weighed.get("text") or []] if fit.weighed is not None else []


def prediction(fit, profile):
    """How far off the theory is where it was not fitted, on each side of the rod."""
    if not fit_words.predicted(profile):
        return ""
    found = fit_prediction.html(fit, profile)
    return f"{predicted_place(fit, profile)} was predicted, not fitted: {found}{fit_prediction.size_html(fit, profile)}." if found else ""


def predicted_place(fit, profile):
    """The line, and the profile's name where several are along it."""
    line = fit_words.line_html(profile, fit.unit)
    alike = [one for one in fit.profiles if fit_words.line_html(one, fit.unit) == line]
    return line if len(alike) < 2 else f"{line} (<q>{words.label_html(str(profile.get('name', '')))}</q>)"


def by_itself(fit, one):
    """A point force fitted to one line, and how far it is from the fit of the maps."""
    found, units = one["line"].get("parameters") or {}, {"f_over_mu": fit.unit, "xi": fit.unit}
    values = words.listed([f'<span class="eq">{fit_words.symbol_html(name)} = '
                         f'{fit_words.with_unit(words.with_error(value["value"], value["stderr"]), units.get(name, ""))}</span>'
                         if words.is_number(value.get("stderr")) else f"{fit_words.symbol_html(name)} at its bound"
                         for name, value in found.items()])
    line = fit_words.line_html(fit.profiles[int(one["line"]["profile"])], fit.unit)
    off = [name for name, value in found.items() if name in fit.systematics and words.is_number(value.get("stderr"))
           and abs(value["value"] - fit.systematics[name]["value"])
           > 2 * math.hypot(value["stderr"], fit.systematics[name].get("total") or 0.0)]
    bound = len([name for name, value in found.items() if not words.is_number(value.get("stderr"))])
    verdict = "which differs from the medium of the maps" if off or bound else "which agrees with the maps"
    chi2 = words.equation("<i>χ</i>²", fit.number(one["line"], "chi2"))
    return f"A point force fitted to {line} alone gives {values} ({chi2} for {one['line'].get('dof')}), {verdict}."


def other_values(fit, one):
    if isinstance(one.get("line"), dict):
        return by_itself(fit, one)
    chi2 = fit.number(one, "chi2")
    if not math.isfinite(chi2):
        return ""
    return f"The values <q>{words.label_html(str(one.get('name', '')))}</q> give {words.equation('<i>χ</i>²', chi2)}, this fit {words.number(fit.number(fit.record, 'chi2'))}."


def trust(scan):
    """How far a phase diagram can be trusted between its points."""
    missed = scan_words.missed_html(scan).strip()
    if missed:
        return missed
    return "Points between the points of this scan were not checked." if scan.design == "adaptive" else ""


# The resolved scene as tables: keys with symbol, unit and meaning from schema.json, any others as they stand.

KEY_HEADS = ("Key", "Symbol", "Value", "Meaning")
SKIPPED = {"figures"}  # the figures speak for themselves


class KeyLabels:
    """What schema.json says of the keys of one scene; `lengths` is the name of the unit of the fitted profiles."""

    def __init__(self, system, lengths=""):
        self.system, self.lengths = system, lengths

    def unit(self, table, key):
        unit = schema.KEYS.get((table, key), {}).get("unit", {}).get(self.system, "")
        return fit_words.unit_html(self.lengths if unit == schema.PROFILES_UNIT else unit)

    def symbol(self, table, key):
        return words.tex_html(schema.KEYS.get((table, key), {}).get("symbol", ""))

    def meaning(self, table, key):
        inner = schema.TABLES.get(joined(table, key), "")
        return words.prose(schema.KEYS.get((table, key), {}).get("meaning", inner))


def scene_tables(scene, labels):
    """(name as HTML, meaning as HTML, heads, rows) for each table of the scene."""
    for key, value in scene.items():
        if key not in SKIPPED:
            yield from of_table(key, value, labels)


def of_table(path, value, labels):
    """This table and the tables in it; a list of tables has a row for each."""
    if is_listing(value):
        yield table_heading(f"[[{path}]]"), table_meaning(f"{path}[]"), *table_listing(f"{path}[]", value, labels)
    elif isinstance(value, dict) and value:
        inner = {key: one for key, one in value.items() if is_listing(one) or is_table(joined(path, key), one)}
        rows = [key_row(path, key, one, labels) for key, one in value.items() if key not in inner]
        if rows:
            yield table_heading(f"[{path}]"), table_meaning(path), KEY_HEADS, rows
        for key, one in inner.items():
            yield from of_table(joined(path, key), one, labels)


def is_table(path, value):
    """Whether it has a table of its own; one that says two things of a pair of surfaces is a row of its table."""
    return isinstance(value, dict) and path in schema.TABLES and not path.startswith("granular.contacts.")


def is_listing(value):
    return isinstance(value, list) and bool(value) and all(isinstance(item, dict) for item in value)


def table_heading(name):
    return f"<code>{words.escape(name)}</code>"


def table_meaning(path):
    return words.prose(schema.TABLES.get(path, ""))


def joined(table, key):
    return f"{table}.{key}" if table else key


def key_row(table, key, value, labels):
    return (f"<code>{words.escape(key)}</code>", labels.symbol(table, key), with_unit(value, labels.unit(table, key)),
            labels.meaning(table, key))


def with_unit(value, unit):
    """A string has its unit already: what SI does not hold exactly is written as "2.5 f/mu". Speeds are in mm/s."""
    if unit == "m/s" and words.is_number(value):
        value, unit = 1e3 * value, "mm/s"
    return shown_value(value) if isinstance(value, str) else f"{shown_value(value)} {unit}".strip()


def table_listing(table, items, labels):
    """One row an item, one column a key."""
    keys = list(dict.fromkeys(key for item in items for key in item))
    unit = {key: labels.unit(table, key) for key in keys}
    speeds = {key for key in keys if unit[key] == "m/s"}
    unit |= dict.fromkeys(speeds, "mm/s")
    items = [item | {key: 1e3 * item[key] for key in speeds if words.is_number(item.get(key))} for item in items]
    return (["No."] + [words.escape(key.replace("_", " ")) + (f" ({unit[key]})" if unit[key] else "") for key in keys],
            [[str(index)] + [shown_value(item.get(key, "")) for key in keys] for index, item in enumerate(items)])


def shown_value(value):
    """Long lists are shown by their ends: output times run to thousands."""
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, dict):
        return ", ".join(f"{words.escape(key)} = {shown_value(one)}" for key, one in value.items())
    if isinstance(value, list):
        few = value if len(value) <= 8 else value[:3] + ["…"] + value[-2:]
        text = ", ".join(shown_value(one) for one in few)
        return text if len(value) <= 8 else f"{text} ({len(value)} values)"
    return words.number(value, 6)
