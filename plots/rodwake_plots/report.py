"""report.html: one page that needs no other file."""

import base64
import io
import struct
from pathlib import Path

from . import abstract, contents, draw, hover, movie, sections, words
from .canvas import replacing

STYLE = Path(__file__).with_name("report.css")
LARGEST_FILM = 1.5e6  # bytes
LARGEST = 3.2e6       # bytes of all pictures: with what base64 adds the page stays below 5 MB
SCALE = 0.62  # image pixels (200 per inch) to page pixels: somewhat larger than in print


def write(run, figures):
    path = run.output / "report.html"
    page = document(run, figures)
    with replacing(path) as temporary:
        temporary.write_text(page, encoding="utf-8")
    print(path)


def document(run, figures):
    title = words.escape(run.title)
    parts = [(name, inside) for name, inside in sections_of(run, figures) if inside]
    links = contents.navigation([name for name, _ in parts], [(number, one.title or one.name.replace("_", " ")) for number, one in enumerate(figures, 1)])
    body = "\n".join((sections.header(run), links, *(section(name, inside) for name, inside in parts)))
    return (f'<!doctype html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
            f'<meta name="viewport" content="width=device-width, initial-scale=1">\n'
            f'<meta name="color-scheme" content="light dark">\n<title>{title}</title>\n'
            f"<style>\n{STYLE.read_text(encoding='utf-8')}</style>\n</head>\n<body>\n<main>\n{body}\n"
            f"<footer>rodwake {words.escape(run.version)}</footer>\n</main>\n</body>\n</html>\n")


def sections_of(run, figures):
    """(name, HTML) of all there may be."""
    yield "Abstract", sections.abstract(run, abstract.sentences(run))
    yield "Figures", "\n".join(figure(run, one, number, image) for number, (one, image) in enumerate(zip(figures, pictures(run, figures)), 1))
    for name, of in (("Fit", sections.fit), ("Scan", sections.scan), ("Granular bed", sections.granular), ("Measures", sections.measures),
                     ("Runs", sections.runs), ("Reproduce", contents.reproduce), ("Parameters", sections.parameters),
                     ("Solver", sections.solver), ("Scene and log", sections.texts), ("Provenance", sections.provenance)):
        yield name, of(run)


def section(name, inside):
    return f'<section id="{contents.identifier(name)}">\n<h2>{name}</h2>\n{inside}\n</section>'


def pictures(run, figures):
    """The PNG of each figure; of many the largest ones with fewer colours, the files themselves stay as they are."""
    found = [draw.png(run, one) for one in figures]
    for index in sorted(range(len(found)), key=lambda one: -len(found[one])):
        if sum(map(len, found)) <= LARGEST:
            break
        found[index] = slim(found[index])
    return found


def slim(image):
    """The picture with 128 colours and its hover texts."""
    from PIL import Image, PngImagePlugin
    places = PngImagePlugin.PngInfo()
    for key, value in hover.metadata(hover.of_png(image)).items():
        places.add_text(key, value)
    out = io.BytesIO()
    Image.open(io.BytesIO(image)).convert("RGB").quantize(128).save(out, format="PNG", optimize=True, pnginfo=places)
    return min(image, out.getvalue(), key=len)


def figure(run, spec, number, image):
    width, height = (round(SCALE * pixels) for pixels in struct.unpack(">II", image[16:24]))  # the PNG header
    data = base64.b64encode(image).decode("ascii")
    name = f"<b>Figure {number}.</b> " + (f"<b>{words.label_html(spec.title)}.</b> " if spec.title else "")
    picture = film(run, spec, width) or (
        f'<div class="picture"><img alt="{words.escape(spec.title or spec.name)}" width="{width}" height="{height}" '
        f'src="data:image/png;base64,{data}">{hover.overlay(hover.of_png(image), width, height)}</div>')
    return (f'<figure id="figure-{number}">\n<div class="sheet">{picture}</div>\n'
            f"<figcaption>{name}{draw.caption(run, spec)}\n{contents.links(run, spec)}</figcaption>\n</figure>")


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
