"""report.html: one page that needs no other file."""

import base64
import struct
from pathlib import Path

from . import draw, movie, sections, words
from .canvas import replacing

STYLE = Path(__file__).with_name("report.css")
LARGEST_FILM = 16e6  # bytes
SCALE = 0.62  # image pixels (200 per inch) to page pixels: somewhat larger than in print


def write(run, figures):
    path = run.path / "report.html"
    page = document(run, figures)
    with replacing(path) as temporary:
        temporary.write_text(page, encoding="utf-8")
    print(path)


def document(run, figures):
    title = words.escape(run.title)
    body = "\n".join(part for part in (
        sections.header(run),
        section("Figures", "\n".join(figure(run, one, number) for number, one in enumerate(figures, 1))),
        section("Fit", sections.fit(run)),
        section("Scan", sections.scan(run)),
        section("Granular bed", sections.granular(run)),
        section("Measures", sections.measures(run)),
        section("Runs", sections.runs(run)),
        section("Parameters", sections.parameters(run)),
        section("Solver", sections.solver(run)),
        section("Scene and log", sections.texts(run)),
        section("Provenance", sections.provenance(run)),
    ) if part)
    return (f'<!doctype html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
            f'<meta name="viewport" content="width=device-width, initial-scale=1">\n'
            f'<meta name="color-scheme" content="light dark">\n<title>{title}</title>\n'
            f"<style>\n{STYLE.read_text(encoding='utf-8')}</style>\n</head>\n<body>\n<main>\n{body}\n"
            f"<footer>rodwake {words.escape(run.version)}</footer>\n</main>\n</body>\n</html>\n")


def section(name, inside):
    return f"<section>\n<h2>{name}</h2>\n{inside}\n</section>" if inside else ""


def figure(run, spec, number):
    image = draw.png(run, spec)
    width, height = (round(SCALE * pixels) for pixels in struct.unpack(">II", image[16:24]))  # the PNG header
    data = base64.b64encode(image).decode("ascii")
    name = f"<b>Figure {number}.</b> " + (f"<b>{words.label_html(spec.title)}.</b> " if spec.title else "")
    picture = (film(run, spec, width) or f'<img alt="{words.escape(spec.name)}" width="{width}" height="{height}" '
               f'src="data:image/png;base64,{data}">')
    return (f'<figure>\n<div class="sheet">{picture}</div>\n<figcaption>{name}{draw.caption(run, spec)}</figcaption>\n</figure>')


def film(run, spec, width):
    """The film inside the page; too large a one is left beside it, and the page shows its last picture."""
    found = movie.film_of(run, spec) if spec.kind in ("movie", "rods_movie") else None
    if not found or found[0].stat().st_size > LARGEST_FILM:
        return ""
    path, kind = found
    source = f'src="data:{kind};base64,{base64.b64encode(path.read_bytes()).decode("ascii")}"'
    if kind.startswith("video/"):
        return f'<video controls loop muted width="{width}" {source}></video>'
    return f'<img alt="{words.escape(spec.name)}" width="{width}" {source}>'
