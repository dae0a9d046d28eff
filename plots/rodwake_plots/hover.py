"""Values that the report shows where the mouse is on a figure: kept in the picture itself, as places and texts."""

import io
import json

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg

from . import words

KEY = "Hover"    # of the PNG's text
MOST = 1500      # places of a figure; of more, one in each cell of a net
NEAR = 0.008     # of the picture's width: radius of a place


def places(figure, marks, pad):
    """[x, y, text], x and y as parts of the picture from its top left, of marks (axes, x, y, text) with numbers of the axes."""
    if not marks:
        return []
    figure.draw_without_rendering()
    box = figure.get_tightbbox(FigureCanvasAgg(figure).get_renderer()).padded(pad)  # inches, as it is saved
    points = np.array([axes.transData.transform((x, y)) for axes, x, y, _ in marks]) / figure.dpi
    inside = np.array([axes.bbox.contains(*(point * figure.dpi)) for (axes, *_), point in zip(marks, points)])
    x, y = (points[:, 0] - box.x0) / box.width, 1 - (points[:, 1] - box.y0) / box.height
    kept = thinned(x, y, np.flatnonzero(inside & np.isfinite(x) & np.isfinite(y)))
    return [[round(float(x[one]), 4), round(float(y[one]), 4), marks[one][3]] for one in kept]


def thinned(x, y, rows):
    """All, or of very many the first in each cell of a net."""
    side = max(1, round(MOST ** 0.5))
    if len(rows) <= MOST:
        return rows
    cells = np.floor(x[rows] * side) * side + np.floor(y[rows] * side)
    return rows[np.unique(cells, return_index=True)[1]]


def metadata(found):
    return {KEY: json.dumps(found, ensure_ascii=False, separators=(",", ":"))} if found else {}


def of_png(image):
    """The places that a picture holds; none in one that was drawn by something else."""
    from PIL import Image  # quick to import, but not needed by who only draws
    text = getattr(Image.open(io.BytesIO(image)), "text", {}).get(KEY, "[]")
    try:
        return json.loads(text)
    except ValueError:
        return []


def overlay(found, width, height):
    """SVG to lie on the picture: a text beside each place that the pointer is on."""
    if not found:
        return ""
    radius = max(3.0, NEAR * width)
    marks = "\n".join(mark(x * width, y * height, text, width, radius) for x, y, text in found)
    return f'<svg class="hover" viewBox="0 0 {width} {height}" aria-hidden="true">\n{marks}\n</svg>'


def mark(x, y, text, width, radius):
    at_left = x < width / 2
    side = f'x="{x + radius + 3:.1f}"' if at_left else f'x="{x - radius - 3:.1f}" text-anchor="end"'
    return (f'<g><circle cx="{x:.1f}" cy="{y:.1f}" r="{radius:.1f}"/>'
            f'<text {side} y="{max(y - radius, 14):.1f}">{words.escape(text)}</text></g>')
