"""paper.html: one page that needs no other file."""

import re
from html import escape
from pathlib import Path

from . import images, judge, table

STYLE = Path(__file__).with_name("page.css")
CLASS = {judge.MATCHES: "matches", judge.DIFFERS: "differs", judge.UNKNOWN: "unknown"}
HEAD = """<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta name="color-scheme" content="light dark">
<title>The paper beside rodwake</title>
<style>
{style}</style>
</head>
<body>
<main>
"""


def document(lab, found):
    cache = lab.runs.parent / "shrunk"
    parts = [HEAD.format(style=STYLE.read_text(encoding="utf-8")), header(found), overview(found)]
    parts += [section(subject, rows, number, cache) for number, (subject, rows) in enumerate(found, 1)]
    return "\n".join(parts) + f"\n<footer>{rules()}</footer>\n</main>\n</body>\n</html>\n"


def header(found):
    chips = "".join(f'<span class="chip {CLASS[verdict]}"><b>{number}</b> {verdict if number != 1 or verdict != "matches" else "match"}</span>'
                    for verdict, number in table.counts(found).items())
    quick = sum(one.quick for _, rows in found for one in rows)
    note = f" {quick} rows rest on few runs (<code>--quick</code>) and are marked; <code>studies/paper --full</code> makes them anew." if quick else ""
    return ("<h1>The paper beside rodwake</h1>\n"
            '<p class="sub">Every figure and number of Gupta, Kant, Soni, Sood and Ramaswamy, “Active nonreciprocal attraction between motile '
            'particles in an elastic medium” (arXiv 2007.04860, Phys. Rev. E 105, 064602), made again by rodwake.</p>\n'
            f'<p class="chips">{chips}</p>\n<p>Errors are standard errors, a is the bead radius (0.4 mm), φ<sub>b</sub> the area fraction of the beads.{note}</p>')


def overview(found):
    rows = []
    for number, (subject, entries) in enumerate(found, 1):
        marks = "".join(f'<a class="dot {CLASS[one.judged.verdict]}" href="#{one.row.id}" title="{escape(one.row.place)}: {one.judged.verdict}">'
                        f'<span>{escape(one.row.id)}: {one.judged.verdict}</span></a>' for one in entries)
        rows.append(f'<tr><th><a href="#part{number}">{escape(subject.title)}</a></th><td>{marks}</td></tr>')
    return '<table class="overview">' + "".join(rows) + "</table>"


def section(subject, rows, number, cache):
    shown = set()
    return (f'<section id="part{number}">\n<h2>{escape(subject.title)}</h2>\n' + "\n".join(article(one, cache, shown) for one in rows) + "\n</section>")


def article(one, cache, shown):
    verdict = one.judged.verdict
    facts = [("Paper", one.row.says), ("rodwake", one.judged.ours), ("Difference" if verdict != judge.UNKNOWN else "Note", one.judged.difference),
             ("Why", table.why(one))]
    listed = "".join(f"<dt>{name}</dt><dd>{typeset(text)}</dd>" for name, text in facts if text)
    quick = '<span class="few">few runs</span>' if one.quick else f'<span class="few">kept, version {escape(one.kept)}</span>' if one.kept else ""
    return (f'<article id="{one.row.id}" class="{CLASS[verdict]}">\n<h3>{escape(one.row.place)} <span class="badge">{verdict}</span>{quick}</h3>\n'
            f"<dl>{listed}</dl>\n{figures(one, cache, shown)}{made(one)}</article>")


def figures(one, cache, shown):
    """Each figure once a section: the first row that names it shows it."""
    paths = [next(filter(None, (images.source(folder, name) for folder in one.folders)), None) for name in one.row.figures]
    new = [path for path in paths if path and path not in shown]
    shown.update(new)
    return "".join(f'<figure class="sheet">{images.markup(path, cache)}</figure>\n' for path in new)


def made(one):
    text = "\n".join(one.commands) or one.row.made
    return f"<details><summary>Made by</summary><pre>{escape(text)}</pre></details>\n" if text else ""


def typeset(text):
    """Subscripts and powers: U_x, phi_b, |x|^(1/2)."""
    text = re.sub(r"\^\(([^)]+)\)", r"<sup>\1</sup>", escape(text))
    return re.sub(r"(?<![\w.])(\w)_(\w{1,2})\b", r"\1<sub>\2</sub>", text)


def rules():
    return (f"A statement matches if it holds by {judge.CONFIRMED:g} standard errors and differs if it fails by {judge.REFUTED:g}; a value matches within "
            f"{judge.CONFIRMED:g} standard errors, the paper's rounding included, and differs beyond {judge.REFUTED:g}. In between, with an error above a third "
            "of the paper's value, or without data: inconclusive.")
