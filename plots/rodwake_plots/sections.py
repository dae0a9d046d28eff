"""The parts of the report that are words and tables."""

from . import fit_sections, fit_words, granular_sections, measure_sections, scan_sections, scene_table, words
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
    told = granular_sections.headline(run) if run.has_granular else ""
    told += fit_sections.headline(run) if run.has_fit else ""
    told += scan_sections.headline(run) if run.has_scan else ""
    told += outcome(run) if has_theory(run) else ""
    return told + (f'<p class="verdict">{" ".join(sentences)}</p>' if sentences else "")


def has_theory(run):
    """Every run leaves a result file; that of a bed or a fit alone holds neither rods nor a field."""
    return run.has_result and any(map(run.result.has, ("/rods", "/field")))


def outcome(run):
    if not run.outcome:
        return '<p class="outcome">The field of one rod; no rods were integrated.</p>'
    name = str(run.outcome.get("outcome", "undecided"))
    return f'<p class="outcome"><span class="tag">{words.escape(name)}</span>{sentence(run, name)}</p>'


def sentence(run, name):
    units = run.result.units
    time = words.equation("<i>t</i>", run.outcome.get("time", "?"), units.time_html(), digits=6)
    nearest = f"{words.number(run.outcome.get('min_separation', '?'), 6)} {units.length_html()}"
    pair = run.outcome.get("pair") or []
    who = f"rods {words.number(pair[0])} and {words.number(pair[1])}" if len(pair) == 2 else "the rods"
    return {
        "contact": f"Contact: {who} met at {time}, {nearest} apart.",
        "pursuit": f"Pursuit: the headings of {who} locked and their separation stayed bounded until {time}; closest approach {nearest}.",
        "escape": f"Escape: {who} went apart; closest approach {nearest}, followed until {time}.",
    }.get(name, f"No outcome was decided until {time}; closest approach {nearest}.")


def runs(run):
    """Scene and variants side by side; a single run is told in the header."""
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
    told = table(("What", "Value"), list(scan_sections.points(run.scan)))
    return f"{told}\n<h3>Axes</h3>\n{table(('Key', 'Axis', 'Range', 'Spacing'), list(scan_sections.axes(run.scan)))}"


def granular(run):
    """What was modelled, what came out, what it cost."""
    if not run.has_granular:
        return ""
    parts = (("Modelled", ("What", "Value"), granular_sections.modelled(run)),
             ("Contacts", ("Pair", "Friction", "Restitution"), granular_sections.contacts(run)),
             ("Results", ("Quantity", "Value", "Meaning"), granular_sections.measured(run)),
             ("Run", ("Item", "Value"), ((words.escape(name), value) for name, value in flat(granular_sections.other(run)))))
    tables = ((name, table(heads, list(rows))) for name, heads, rows in parts)
    return "\n".join(f"<h3>{name}</h3>\n{made}" for name, made in tables if made)


def measures(run):
    """measure.json in words, of the scene and of its variants side by side."""
    return table(*measure_sections.heads_and_rows(run)) if run.has_granular else ""


def parameters(run):
    told = scene_table.Told(run.scene.get("units", "reduced"), run.fit.unit if run.has_fit else "")
    return "\n".join(f"<h3>{name}</h3>\n<p>{meaning}</p>\n{table(heads, rows)}"
                     for name, meaning, heads, rows in scene_table.tables(run.scene, told))


def solver(run):
    statistics = (run.outcome or {}).get("solver") or {}
    return table(("Quantity", "Value"), [(words.escape(name), value) for name, value in flat(statistics)])


def texts(run):
    scene = f"<details>\n<summary>Resolved scene</summary>\n<pre>{words.escape(run.scene_text)}</pre>\n</details>"
    log = f"<details>\n<summary>Log</summary>\n<pre>{words.escape(run.log)}</pre>\n</details>" if run.log.strip() else ""
    return scene + log


def provenance(run):
    if run.provenance is None:
        return "<p>provenance.json is missing from this run directory.</p>"
    return table(("Item", "Value"), [(words.escape(name), f"<code>{value}</code>") for name, value in flat(run.provenance)])
