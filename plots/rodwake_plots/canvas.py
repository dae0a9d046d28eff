"""Making and saving a figure."""

import io
import string

import matplotlib
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.text import Text
from matplotlib.ticker import MaxNLocator

from . import files, style


class ShownFigure(Figure):
    """A text that is no TeX, whoever wrote it into a file of the run, is shown as it stands: it would end the drawing."""

    def draw(self, renderer):
        for text in self.findobj(Text):
            if not style.can_show(text.get_text()):
                text.set_parse_math(False)
        super().draw(renderer)


def figure(width, height):
    made = ShownFigure(figsize=(width, height), layout="compressed")
    made.get_layout_engine().set(w_pad=0.04, h_pad=0.04, wspace=0.04, hspace=0.04)
    return made


def heading(axes, text):
    if text:
        axes.set_title(text, pad=6)


def letter(axes, index):
    """`(a)` over the left end of a panel."""
    axes.set_title(f"({string.ascii_lowercase[index % 26]})", loc="left", pad=6)


def align_headings(rows):
    """Headings of the panels of a row start on one line, whatever number of lines each has."""
    for row in rows:
        most = max(axes.get_title().count("\n") for axes in row)
        for axes in row:
            axes.set_title(axes.get_title() + "\n " * (most - axes.get_title().count("\n")), pad=6)


def window(axes, x, y):
    axes.set_xlim(*x)
    axes.set_ylim(*y)
    axes.set_aspect("equal")
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_major_locator(MaxNLocator(6, steps=[1, 2, 5, 10]))


def enlarge(made, factor):
    """All text of a figure; ticks that are made later have it from their axis."""
    ticks = [(axis, axis.get_major_ticks(1)[0].label1.get_fontsize()) for axes in made.findobj(Axes) for axis in (axes.xaxis, axes.yaxis)]
    for text in made.findobj(Text):
        text.set_fontsize(factor * text.get_fontsize())
    for axis, size in ticks:
        axis.set_tick_params(which="both", labelsize=factor * size)


PAD = 0.04  # inches around what is drawn
TRIES = 12  # text does not shrink with its figure: the width is approached
WIDEST = 1.6  # a figure that is by nature this much wider than a column goes over two
GUTTER = 6 / 25.4  # inches between columns


def fit_width(made, column):
    """Scales the figure until it is saved as wide as a column, or as two, legends beside its panels included."""
    inches = column if made.get_figwidth() < WIDEST * column else 2 * column + GUTTER
    made.set_dpi(matplotlib.rcParams["savefig.dpi"])  # text is as wide as the pixels let it be
    aspect, renderer = made.get_figheight() / made.get_figwidth(), FigureCanvasAgg(made).get_renderer()
    found = []  # (width of the figure, width as saved): the secant's
    width = made.get_figwidth()
    for _ in range(TRIES):
        made.set_size_inches(width, aspect * width)
        made.draw_without_rendering()
        found.append((width, made.get_tightbbox(renderer).width + 2 * PAD))
        if abs(found[-1][1] - inches) < 0.002 * inches:
            break
        (w0, s0), (w1, s1) = found[-2] if len(found) > 1 else (0.0, 0.0), found[-1]
        step = (inches - s1) * (w1 - w0) / (s1 - s0) if s1 != s0 else 0.1 * w1
        width = w1 + max(-0.5 * w1, min(step, w1))
    made.set_layout_engine("none")  # it would move things again


def save(made, path, metadata=None):
    out = io.BytesIO()  # a write that fails is then told with its cause, which Pillow loses
    made.savefig(out, format=path.suffix[1:], bbox_inches="tight", pad_inches=PAD, metadata=metadata)
    files.write(path, out.getvalue())
