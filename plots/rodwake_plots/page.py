"""What the pages have in common. Their text comes from files that anybody may have written, so nothing of it is ever run."""

import base64
import hashlib
import io
import json
import zlib
from html.parser import HTMLParser

import numpy as np

from . import words

# In JSON inside a script: what could end or begin a script or a comment, and the line ends of old JavaScript.
SPELT = {ord(sign): f"\\u{ord(sign):04x}" for sign in "<>&\u2028\u2029"}


WASM = "'wasm-unsafe-eval'"


def head(title, style, script="", computes=False):
    return (f'<meta charset="utf-8">\n<meta http-equiv="Content-Security-Policy" content="{policy(script, computes)}">\n'
            '<meta name="viewport" content="width=device-width, initial-scale=1">\n<meta name="color-scheme" content="light dark">\n'
            f"<title>{words.escape(title)}</title>\n<style>\n{style}</style>")


def policy(script, computes=False):
    """Nothing runs but the page's own script, by its hash, and its own WebAssembly if it computes; nothing is loaded but the pictures
    and films inside the page."""
    digest = base64.b64encode(hashlib.sha256(script.encode("utf-8")).digest()).decode("ascii")
    scripts = f"script-src 'sha256-{digest}'{' ' + WASM if computes else ''}; " if script else ""
    return f"default-src 'none'; {scripts}style-src 'unsafe-inline'; img-src data:; media-src data:; base-uri 'none'; form-action 'none'"


def json_text(value):
    return json.dumps(value, ensure_ascii=False, separators=(",", ":")).translate(SPELT)


# Arrays inside a page: their bytes by significance, deflated, as base64; data.js takes them out again.

PACKED = 6  # more makes the page 1 % smaller and takes twice as long


class Box:
    """Collects arrays; each becomes a script of its own that no browser runs."""

    def __init__(self):
        self.scripts = []

    def add(self, values):
        """The description of the array for the page: its number, the type of its items, how many there are."""
        values = np.ascontiguousarray(values).ravel()
        values = values.astype(values.dtype.newbyteorder("<"))
        bytes_ = values.view(np.uint8).reshape(values.size, values.itemsize).T  # alike bytes together: they pack better
        text = base64.b64encode(zlib.compress(bytes_.tobytes(), PACKED)).decode("ascii")
        self.scripts.append(f'<script type="application/octet-stream" id="array{len(self.scripts)}">{text}</script>')
        return {"array": len(self.scripts) - 1, "type": values.dtype.str[1:], "count": int(values.size)}


# HTML of words as parts of which a page makes nodes without reading markup: a text, or [tag, parts...].

TAGS = ("b", "i", "sub", "sup")


def marked(html):
    reader = MarkReader()
    reader.feed(html)
    reader.close()
    return reader.found


class MarkReader(HTMLParser):
    """A tag that words does not make stays text."""

    def __init__(self):
        super().__init__()
        self.found = []
        self._open = [self.found]

    def handle_starttag(self, tag, _):
        if tag not in TAGS:
            return self.handle_data(self.get_starttag_text())
        self._open[-1].append([tag])
        self._open.append(self._open[-1][-1])

    def handle_endtag(self, tag):
        if tag in TAGS and len(self._open) > 1:
            self._open.pop()

    def handle_data(self, text):
        self._open[-1].append(text)


# Values that the report shows where the mouse is on a figure: kept in the picture itself, as places and texts.

HOVER = "Hover"    # of the PNG's text
MOST_PLACES = 1500      # places of a figure; of more, one in each cell of a net
NEAR = 0.008     # of the picture's width: radius of a place


def hover_places(figure, marks, box):
    """[x, y, text], x and y as parts of the picture (a box in inches) from its top left, of marks (axes, x, y, text) with numbers of the axes."""
    if not marks:
        return []
    points = np.array([axes.transData.transform((x, y)) for axes, x, y, _ in marks]) / figure.dpi
    inside = np.array([axes.bbox.contains(*(point * figure.dpi)) for (axes, *_), point in zip(marks, points)])
    x, y = (points[:, 0] - box.x0) / box.width, 1 - (points[:, 1] - box.y0) / box.height
    kept = thinned(x, y, np.flatnonzero(inside & np.isfinite(x) & np.isfinite(y)))
    return [[round(float(x[one]), 4), round(float(y[one]), 4), marks[one][3]] for one in kept]


def thinned(x, y, rows):
    """All, or of very many the first in each cell of a net."""
    side = max(1, round(MOST_PLACES ** 0.5))
    if len(rows) <= MOST_PLACES:
        return rows
    cells = np.floor(x[rows] * side) * side + np.floor(y[rows] * side)
    return rows[np.unique(cells, return_index=True)[1]]


def hover_metadata(found):
    return {HOVER: json.dumps(found, ensure_ascii=False, separators=(",", ":"))} if found else {}


def hover_of_png(image):
    """The places that a picture holds; none in one that was drawn by something else."""
    from PIL import Image  # quick to import, but not needed by who only draws
    text = getattr(Image.open(io.BytesIO(image)), "text", {}).get(HOVER, "[]")
    try:
        return json.loads(text)
    except ValueError:
        return []


def hover_overlay(found, width, height):
    """SVG to lie on the picture: a text beside each place that the pointer is on."""
    if not found:
        return ""
    radius = max(3.0, NEAR * width)
    marks = "\n".join(hover_mark(x * width, y * height, text, width, radius) for x, y, text in found)
    return f'<svg class="hover" viewBox="0 0 {width} {height}" aria-hidden="true">\n{marks}\n</svg>'


def hover_mark(x, y, text, width, radius):
    at_left = x < width / 2
    side = f'x="{x + radius + 3:.1f}"' if at_left else f'x="{x - radius - 3:.1f}" text-anchor="end"'
    return (f'<g><circle cx="{x:.1f}" cy="{y:.1f}" r="{radius:.1f}"/>'
            f'<text {side} y="{max(y - radius, 14):.1f}">{words.escape(text)}</text></g>')
