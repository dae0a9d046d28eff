"""report.html: one page that needs no other file."""

import base64
import io
import os
import re
import shlex
import struct
from pathlib import Path

from . import draw, files, movie, page, schema, sections, words
from .errors import attempt, reason

STYLE = Path(__file__).with_name("report.css")
LARGEST_FILM = 1.5e6  # bytes
LARGEST = 3.2e6       # bytes of all pictures: with what base64 adds the page stays below 5 MB
SCALE = 0.62  # image pixels (200 per inch) to page pixels: somewhat larger than in print


def write(run, shown):
    """What of the page could not be made; `shown` is [(figure, "" or why it was not drawn)]."""
    path, failures = run.output / "report.html", []
    files.write(path, document(run, shown, failures))
    print(path)
    return failures


def document(run, shown, failures):
    """A part that fails shows its error on the page and adds it to `failures`. The rest of the page is made all the same."""
    parts = [(name, inside) for name, inside in sections_of(run, shown, failures) if inside]
    names = [(number, one.title or one.name.replace("_", " ")) for number, (one, _) in enumerate(shown, 1)]
    links = navigation([name for name, _ in parts], names)
    body = "\n".join((made("head of the report", failures, sections.header, run), links, *(section(name, inside) for name, inside in parts)))
    return (f'<!doctype html>\n<html lang="en">\n<head>\n{page.head(run.title, STYLE.read_text(encoding="utf-8"))}\n</head>\n'
            f"<body>\n<main>\n{body}\n<footer>rodwake {words.escape(run.version)}</footer>\n</main>\n</body>\n</html>\n")


def sections_of(run, shown, failures):
    """(name, HTML) of all there may be."""
    yield "Abstract", made("Abstract of the report", failures, lambda: sections.abstract(run, sections.sentences(run)))
    yield "Figures", "\n".join(figure(run, *one, image, number, failures)
                               for number, (one, image) in enumerate(zip(shown, pictures(run, shown)), 1))
    for name, of in (("Fit", sections.fit), ("Scan", sections.scan), ("Granular bed", sections.granular), ("Measures", sections.measures),
                     ("Runs", sections.runs), ("Reproduce", reproduce), ("Parameters", sections.parameters),
                     ("Solver", sections.solver), ("Scene and log", sections.texts), ("Provenance", sections.provenance)):
        yield name, made(f"{name} of the report", failures, of, run)


def made(what, failures, act, *arguments):
    found, error = attempt(act, *arguments)
    if error is None:
        return found
    failures.append(f"{what}: {reason(error)}")
    return failed(reason(error))


def failed(why):
    return f'<p class="failed">Not shown: {words.escape(why)}</p>'


def section(name, inside):
    return f'<section id="{identifier(name)}">\n<h2>{name}</h2>\n{inside}\n</section>'


def pictures(run, shown):
    """The PNG of each figure that was drawn; of many the largest ones with fewer colours, the files themselves stay as they are."""
    found = [b"" if why else attempt(draw.png, run, one)[0] or b"" for one, why in shown]
    for index in sorted(range(len(found)), key=lambda one: -len(found[one])):
        if sum(map(len, found)) <= LARGEST:
            break
        found[index] = attempt(slim, found[index])[0] or found[index]
    return found


def slim(image):
    """The picture with 128 colours and its hover texts."""
    from PIL import Image, PngImagePlugin
    places = PngImagePlugin.PngInfo()
    for key, value in page.hover_metadata(page.hover_of_png(image)).items():
        places.add_text(key, value)
    out = io.BytesIO()
    Image.open(io.BytesIO(image)).convert("RGB").quantize(128).save(out, format="PNG", optimize=True, pnginfo=places)
    return min(image, out.getvalue(), key=len)


def figure(run, spec, why, image, number, failures):
    label = f'figure "{spec.name}"'
    inside = failed(why) if why else made(label, failures, picture, run, spec, image)
    caption = "" if why else made(label, failures, lambda: f"{draw.caption(run, spec)}\n{data_links(run, spec)}")
    name = f"<b>Figure {number}.</b> " + (f"<b>{words.label_html(spec.title)}.</b> " if spec.title else "")
    return f'<figure id="figure-{number}">\n<div class="sheet">{inside}</div>\n<figcaption>{name}{caption}</figcaption>\n</figure>'


def picture(run, spec, image):
    image = image or draw.png(run, spec)  # says why there is none
    width, height = (round(SCALE * pixels) for pixels in struct.unpack(">II", image[16:24]))  # the PNG header
    data = base64.b64encode(image).decode("ascii")
    return film(run, spec, width) or (
        f'<div class="picture"><img alt="{words.escape(spec.title or spec.name)}" width="{width}" height="{height}" '
        f'src="data:image/png;base64,{data}">{page.hover_overlay(page.hover_of_png(image), width, height)}</div>')


def film(run, spec, width):
    """The film inside the page; too large a one is left beside it, and the page shows its last picture."""
    found = movie.film_of(run, spec) if spec.kind in draw.FILMS else None
    if not found or found[0].stat().st_size > LARGEST_FILM:
        return ""
    path, kind = found
    source = f'src="data:{kind};base64,{base64.b64encode(path.read_bytes()).decode("ascii")}"'
    if kind.startswith("video/"):
        return f'<video controls loop muted width="{width}" {source}></video>'
    return f'<img alt="{words.escape(spec.name)}" width="{width}" {source}>'


# What leads from the report to something else: its contents, the files behind each figure, the command that makes it again.

MOST_FILES = 6
VERBS = ("dem", "rods", "fit", "field", "scan", "run")  # that make a folder from a scene alone
EXPLORER = "explore.html"  # of a run that the explorer shows, written by the program
LIVE = ("trajectories", "extensional_axis", "polar_streamlines")
FIT_TABLES = ("fit_profile_*.csv", "fit_curve_*.csv", "fit_map_*.csv", "fit_trajectory_*.csv")


def identifier(name):
    return re.sub(r"[^a-z0-9]+", "-", name.lower()).strip("-")


def navigation(sections, figures):
    """Links to the sections [name] that are there, and under them to the figures [(number, name)]."""
    links = " ".join(f'<a href="#{identifier(name)}">{name}</a>' for name in sections)
    if len(figures) > 1:
        links += '<br><span class="figures">' + " ".join(f'<a href="#figure-{number}">{number} {words.label_html(name)}</a>'
                                                         for number, name in figures) + "</span>"
    return f'<nav aria-label="Contents">{links}</nav>'


def files_of(run, spec):
    """Paths of the run directory whose numbers a figure shows, relative to it; those of variants and of an ensemble's runs too."""
    names = list(schema.FIGURES[spec.kind]["files"])
    if spec.kind == "profile":
        names = [f"profile_{spec.component}_{spec.along}.csv"]
    if spec.kind in ("fit", "fit_map", "fit_trajectories"):
        names += FIT_TABLES
    found = [path for name in names for pattern in (name, f"variants/*/{name}", f"runs/*/{name}") for path in sorted(run.path.glob(pattern))]
    return [path.relative_to(run.path).as_posix() for path in found]


def data_links(run, spec):
    """Data, and the figure as it goes into a paper."""
    found = files_of(run, spec)
    parts = [link(beside(run, path), path) for path in found[:MOST_FILES]] + ([f"and {len(found) - MOST_FILES} more"] if len(found) > MOST_FILES else [])
    text = f"Data: {', '.join(parts)}" if parts else ""
    drawn = [link(f"figures/{spec.name}{ending}", ending[1:].upper()) for ending in (".pdf", ".png", ".mp4", ".gif")
             if (run.figures_dir / f"{spec.name}{ending}").is_file()]
    live = spec.kind in LIVE and run.output == run.path and (run.path / EXPLORER).is_file()
    explorer = f"{link(EXPLORER, 'Drag the rods')}: the encounter, computed anew in the browser" if live else ""
    return f'<div class="files">{" · ".join(filter(None, (explorer, text, *drawn)))}</div>'


def beside(run, path):
    """A file of the run as a link of the page, which may stand elsewhere."""
    return path if run.output == run.path else os.path.relpath(run.path / path, run.output)


def link(path, text):
    return f'<a href="{words.escape(path)}">{words.escape(text)}</a>'


def reproduce(run):
    """The command that makes this run again from the resolved scene, and what else it depends on."""
    provenance = run.provenance or {}
    command = str(provenance.get("command") or "")
    first = next((word for word in split(command)[1:] if not word.startswith("-")), "")
    verb = first if first in VERBS else "run"  # a run of Python, too
    program = f"rodwake {words.escape(provenance.get('version', run.version))}" + (f", git {words.escape(provenance['git'])}" if provenance.get("git") else "")
    seed = f", seed {words.number(provenance['seed'])}" if words.is_number(provenance.get("seed")) else ""
    took = f"; it took {words.number(float(provenance['wall_seconds']), 2)} s" if words.is_number(provenance.get("wall_seconds")) else ""
    return (f'<div class="reproduce">\n<pre>rodwake {words.escape(verb)} scene.toml -o again\nrodwake plot again --pdf</pre>\n'
            f'<p>{link(beside(run, "scene.toml"), "scene.toml")} is the scene with every default written out; the result does not depend on the number '
            f"of threads. Made by {program}{seed}{took}.</p>\n"
            + (f"<p>As it was called: <code>{words.escape(command)}</code></p>\n" if command else "") + "</div>")


def split(command):
    try:
        return shlex.split(command)
    except ValueError:
        return command.split()
