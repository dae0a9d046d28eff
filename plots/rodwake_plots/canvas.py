"""Making and saving a figure."""

import functools
import io
import math

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends import backend_agg
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure
from matplotlib.markers import MarkerStyle
from matplotlib.mathtext import MathTextParser
from matplotlib.path import Path
from matplotlib.text import Text
from matplotlib.ticker import FuncFormatter, LogFormatterSciNotation, LogLocator, MaxNLocator, NullFormatter
from matplotlib.transforms import Affine2D, Bbox

from . import files, style, words
from .errors import PlotError

# A figure is drawn by several renderers, and to parse its mathematical texts for each of them took a third of the time: they share a parser.
backend_agg.MathTextParser = functools.cache(MathTextParser)


class ShownFigure(Figure):
    """A text that is no TeX, whoever wrote it into a file of the run, is shown as it stands: it would end the drawing."""

    def draw(self, renderer):
        for text in self.findobj(Text):
            text.set_text(text.get_text().removeprefix(style.UNSEEN))
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
    axes.set_title(words.letter(index), loc="left", pad=6)


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
WIDEST = 2.0  # a figure that is by nature this much wider than a column, of panels side by side, goes over two
GUTTER = 6 / 25.4  # inches between columns


MOST_BESIDE = 0.2  # of the width, for a legend beside the panels


def fit_width(made, column):
    """Scales the figure until what is drawn is as wide as a column, or as two; returns that width."""
    inches = column if made.get_figwidth() < WIDEST * column else 2 * column + GUTTER
    made.set_dpi(matplotlib.rcParams["savefig.dpi"])  # text is as wide as the pixels let it be
    renderer = FigureCanvasAgg(made).get_renderer()
    aspect = made.get_figheight() / (made.get_figwidth() - legend_below(made, inches, renderer))
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
    return inches


def legend_below(made, inches, renderer):
    """A legend that would take much of this width goes from beside the panels to below them; returns the width that becomes free."""
    legends = [axes.get_legend() for axes in made.axes if hasattr(axes.get_legend(), "given")]
    if len(legends) != 1:  # of several each belongs to its panel
        return 0.0
    legend, = legends
    width = legend.get_window_extent(renderer).width / made.dpi
    if width < MOST_BESIDE * inches:
        return 0.0
    handles, labels, look = legend.given
    look = look | dict(loc="upper center", bbox_to_anchor=(0.5, 0.0), fontsize=legend.get_texts()[0].get_fontsize())
    if title := legend.get_title().get_text():
        look |= dict(title=title, title_fontsize=legend.get_title().get_fontsize())
    legend.remove()
    for columns in range(min(len(labels), 4), 0, -1):
        below = made.legend(handles, labels, **look, ncols=columns)
        if columns == 1 or below.get_window_extent(renderer).width < (inches - 2 * PAD) * made.dpi:
            return width
        below.remove()


def settle(made, width=None):
    """Lays the figure out for good, and makes it as large as what is drawn: it is saved whole, and as wide as asked for, whoever saves it."""
    before = made.dpi
    if (dpi := matplotlib.rcParams["savefig.dpi"]) != "figure":
        made.set_dpi(dpi)  # texts are measured once
    made.draw_without_rendering()
    made.set_layout_engine("none")
    box = made.get_tightbbox(FigureCanvasAgg(made).get_renderer()).padded(PAD)
    beside = (width - box.width) / 2 if width else 0.0
    box = Bbox.from_extents(box.x0 - beside, box.y0, box.x1 + beside, box.y1)
    moved = Affine2D().scale(*made.get_size_inches()).translate(-box.x0, -box.y0).scale(1 / box.width, 1 / box.height)  # parts of the figure
    for axes in made.axes:
        axes.set_position(axes.get_position(original=True).transformed(moved))
    for text in made.texts:
        text.set_position(moved.transform(text.get_position()))
    anchors = [one.get_bbox_to_anchor().transformed(made.transFigure.inverted() + moved) for one in made.legends]
    for one, anchor in zip(made.legends, anchors):
        one.set_bbox_to_anchor(anchor, made.transFigure)
    made.set_size_inches(box.width, box.height)
    made.set_dpi(before)


def save(made, path, metadata=None, settled=False):
    if not settled:
        settle(made)
    out = io.BytesIO()  # a write that fails then reports its cause, which Pillow loses
    made.savefig(out, format=path.suffix[1:], metadata=metadata)
    files.write(path, out.getvalue())


# Ranges that a singular point cannot spoil.

DECADES = 4.5  # more than this below the top is drawn as "less"


def nice(value, up):
    """The next 1, 2 or 5 times a power of ten, at or beyond `value`."""
    decade = 10.0 ** np.floor(np.log10(value))
    steps = np.array([1, 2, 5, 10]) * decade
    return steps[steps >= value * (1 - 1e-9)][0] if up else steps[steps <= value * (1 + 1e-9)][-1]


def log_norm(*arrays):
    """(norm, extend) for positive values over many decades, from percentiles."""
    values = np.concatenate([np.ravel(array) for array in arrays])
    values = values[np.isfinite(values) & (values > 0)]
    if values.size == 0:
        raise PlotError("nothing to draw on a log scale: no positive values")
    top = nice(np.percentile(values, 99.7), up=True)
    bottom = nice(max(np.percentile(values, 3), top / 10 ** DECADES), up=False)
    bottom = min(bottom, top / 10)
    below, above = bool((values < bottom).any()), bool((values > top).any())
    return LogNorm(bottom, top), {(0, 0): "neither", (1, 0): "min", (0, 1): "max", (1, 1): "both"}[below, above]


def colour_bar(figure, image, axes, label, **place):
    """With labelled decades on a logarithmic scale; 2 and 5 are labelled too when there are few decades."""
    bar = figure.colorbar(image, ax=axes, **(dict(extendfrac=0.03) | place))
    if isinstance(image.norm, LogNorm):
        few = np.log10(image.norm.vmax / image.norm.vmin) < 2
        axis = bar.ax.xaxis if bar.orientation == "horizontal" else bar.ax.yaxis
        axis.set_major_locator(LogLocator(subs=(1, 2, 5) if few else (1,), numticks=20))
        plain = few and image.norm.vmin >= 1e-2 and image.norm.vmax < 1e4  # 5 is read faster than 5 x 10^0
        axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}") if plain
                                 else LogFormatterSciNotation(labelOnlyBase=False, minor_thresholds=(np.inf, np.inf)))
    bar.ax.tick_params(which="both", direction="in")
    bar.set_label(label)
    return bar


def plain_ticks(axis, low, high):
    """1, 2, 5 in plain digits on a logarithmic axis of few decades."""
    if high < 100 * low and 1e-3 < low and high < 1e4:
        axis.set_major_locator(LogLocator(subs=(1, 2, 5)))
        axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
        axis.set_minor_formatter(NullFormatter())


def plain_decades(axis, low, high):
    """0.1, 1, 10 where powers of ten would be longer to read; few decades have their numbers from plain_ticks."""
    if high >= 100 * low and 1e-3 <= low and high < 2e4:
        axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}".replace("-", "−")))


def linear_limits(values, trusted, below=0.06, above=0.06):
    """Limits from the trusted values only, with zero in view and room (a part of the range) on both sides."""
    kept = values[trusted & np.isfinite(values)]
    if kept.size == 0:
        raise PlotError("nothing to draw: no finite values")
    low, high = min(kept.min(), 0.0), max(kept.max(), 0.0)
    size = (high - low) or 1.0
    return low - below * size, high + above * size


# Several measured curves in one panel: a colour each, bands of their standard errors, a legend.

MOST_INSIDE = 4  # with more curves the legend stands beside the panel
MARKS = "osD^vP"
FAINT = dict(color=style.GREY, linewidth=0.8, linestyle=(0, (5, 3)), zorder=1)


def curve_panel(count, height=3.1):
    """Figure and axes; wider where the legend stands beside."""
    made = figure(style.SINGLE + (1.2 if count > MOST_INSIDE else 0.3), height)
    return made, made.subplots()


def colours(count):
    """Few curves are distinguished by hue, many by their place in a sequence."""
    if count <= len(style.CURVES):
        return style.CURVES[:count]
    return [style.TIME_MAP(place) for place in np.linspace(0, 1, count)]


def curve_mark(index):
    return MARKS[index % len(MARKS)]


def band(axes, x, y, sigma, colour, label="", lowest=None):
    """A line and around it one standard error; `lowest` keeps the band on a logarithmic axis."""
    below, above = y - sigma, y + sigma
    if lowest is not None:
        y, below = np.where(y > 0, y, np.nan), np.where(y > 0, np.maximum(below, lowest), np.nan)
    axes.fill_between(x, below, above, color=colour, alpha=0.25, linewidth=0)
    return axes.plot(x, y, color=colour, label=style.label(label), linewidth=0.92 * matplotlib.rcParams["lines.linewidth"])[0]


def points(axes, x, y, sigma, colour, label="", marker="o", **look):
    """Marks with error bars; those of unknown error have none."""
    look = dict(markersize=3.6, linestyle="none", elinewidth=0.8, capsize=1.6, capthick=0.8, zorder=3) | look
    return axes.errorbar(x, y, yerr=np.where(np.isfinite(sigma), sigma, 0.0), color=colour, marker=marker, label=style.label(label), **look)


def legend(axes, **look):
    """Inside where it is small and finds room, else beside the panel; none without labels."""
    handles, labels = axes.get_legend_handles_labels()
    if not labels:
        return
    look = dict(handlelength=1.6, borderaxespad=0.4) | look
    if len(labels) > MOST_INSIDE + 1:
        return beside(axes, handles, [style.safe(label) for label in labels], **look)
    axes.legend(handles, [style.safe(label) for label in labels], **(dict(loc="best") | look))


def beside(axes, handles, labels, **look):
    """A legend right of the panel; fit_width puts it below where it would take much of the width."""
    axes.legend(handles, labels, **(dict(loc="center left", bbox_to_anchor=(1.01, 0.5)) | look)).given = handles, labels, look


# Panels of equal scale, one for each part of a scene with variants.

MOST_COLUMNS = 3


def panel_grid(parts, aspect, bar=0.0, share=True):
    """(figure, list of axes) for windows of this height over width, with room for a colour bar."""
    count = len(parts)
    columns = min(count, 2 if count == 4 else MOST_COLUMNS)
    rows = math.ceil(count / columns)
    width = {1: style.SINGLE + 0.4, 2: style.WIDE}.get(columns, style.WIDE + 1.0)
    inner = (width - 0.6 - bar) / columns - 0.1
    height = rows * (min(inner * aspect, 7.0) + (0.3 if count > 1 else 0.1)) + 0.6
    made = figure(width, height)
    axes = made.subplots(rows, columns, squeeze=False, sharex=share, sharey=share).ravel()
    for spare in axes[count:]:
        spare.set_axis_off()
    return made, list(axes[:count])


def outer_labels(axes_list, columns, xlabel, ylabel):
    """Numbers and labels at the left and under the lowest panel of each column."""
    for index, axes in enumerate(axes_list):
        lowest, leftmost = index + columns >= len(axes_list), index % columns == 0
        axes.set(xlabel=xlabel if lowest else "", ylabel=ylabel if leftmost else "")
        axes.tick_params(labelbottom=lowest, labelleft=leftmost)


def label_panels(axes_list, parts, xlabel, ylabel, title=""):
    """Names over the panels, axis labels at the left and below."""
    outer_labels(axes_list, axes_list[0].get_subplotspec().get_gridspec().ncols, xlabel, ylabel)
    for index, (axes, part) in enumerate(zip(axes_list, parts)):
        if len(parts) > 1:
            heading(axes, f"{words.letter(index)}  {style.safe(part.label)}")
    if len(parts) == 1:
        heading(axes_list[0], style.safe(title))
    elif title:
        axes_list[0].figure.suptitle(style.safe(title), fontsize=11)


def describe_panels(parts, of):
    """`of(part)` of each panel as one line for a caption."""
    if len(parts) == 1:
        return of(parts[0])
    return " ".join(f"{words.letter(index)} {of(part)}" for index, part in enumerate(parts))


# The rod: tapered, thin end forward, as in the experiments. Sizes are in points, so zooming does not change them.

# Along +x, unit length, thick tail, thin rounded nose.
ROD_OUTLINE = np.array([(-0.5, -0.19), (0.40, -0.09), (0.5, 0.0), (0.40, 0.09), (-0.5, 0.19), (-0.5, -0.19)])


def rod_mark(axes, x, y, theta, length=11, **look):
    """One rod at (x, y); `look` goes to scatter (facecolor, edgecolor, linewidth, zorder)."""
    turned = Affine2D().rotate(theta).transform(ROD_OUTLINE)
    # scatter scales a custom path by its largest coordinate, which depends on the turn: undo that.
    reach = 2 * np.abs(turned).max()
    marker = MarkerStyle(Path(turned, closed=True))
    axes.scatter([x], [y], s=(length * reach) ** 2, marker=marker, **look)


def rod_at_origin(axes, length=15):
    rod_mark(axes, 0, 0, 0, length, facecolor="white", edgecolor="black", linewidth=0.9, zorder=6)
