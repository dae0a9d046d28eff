"""One look for every figure: fonts, sizes, colours. Widths are those of a Physical Review page."""

import contextlib
import functools
import re
from pathlib import Path
from typing import NamedTuple

import matplotlib
from cycler import cycler
from matplotlib import cbook
from matplotlib.colors import ListedColormap
from matplotlib.mathtext import MathTextParser

from . import errors
from .errors import UsageError

SINGLE, WIDE = 4.2, 7.0  # inches: one and a half columns, two columns

# Okabe and Ito, distinct with any colour vision; the yellow is left out for white paper.
COLOURS = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9"]

SETTINGS = {
    "font.family": ["STIXGeneral", "DejaVu Sans"],
    "mathtext.fontset": "stix",
    "font.size": 10, "axes.labelsize": 10.5, "axes.titlesize": 10.5, "xtick.labelsize": 9, "ytick.labelsize": 9,
    "axes.linewidth": 0.7, "lines.linewidth": 1.3,
    "xtick.direction": "in", "ytick.direction": "in", "xtick.top": True, "ytick.right": True,
    "xtick.major.width": 0.7, "ytick.major.width": 0.7, "xtick.major.size": 3.5, "ytick.major.size": 3.5,
    "figure.facecolor": "white", "savefig.facecolor": "white", "savefig.dpi": 200,
    "pdf.fonttype": 42, "axes.formatter.use_mathtext": True, "axes.prop_cycle": cycler(color=COLOURS),
    "legend.framealpha": 0.8, "legend.edgecolor": "none", "legend.fontsize": 8.5,
}


WIDTHS = {"column": 86 / 25.4, "page": 178 / 25.4}  # inches
STYLES = {"": {}, "paper": {},
          "slides": {"font.family": ["DejaVu Sans"], "mathtext.fontset": "dejavusans", "font.size": 13, "axes.labelsize": 14, "axes.titlesize": 14,
                     "xtick.labelsize": 12, "ytick.labelsize": 12, "axes.linewidth": 1.1, "lines.linewidth": 2.0, "savefig.dpi": 250}}
SIZES = "axes.labelsize", "axes.titlesize", "figure.titlesize", "figure.labelsize", "legend.fontsize", "legend.title_fontsize", "xtick.labelsize", "ytick.labelsize"
SMALL = {"font.size": 8, "axes.labelsize": 8.5, "axes.titlesize": 8.5, "xtick.labelsize": 7.5, "ytick.labelsize": 7.5, "savefig.dpi": 300}


class Look(NamedTuple):
    """What the command line asks of all figures: settings of matplotlib, a width in inches, None: each has its own, and what all
    text is enlarged by."""
    settings: dict
    width: float = None
    enlarged: float = 1.0


def look(width="", style="", font_size=""):
    inches = width_of(width) if width else None
    small = SMALL if inches and inches < SINGLE and style in ("", "paper") else {}
    own, enlarged = settings_of(style), 1.0
    if style not in STYLES and "font.size" in own:  # all text of a figure goes with it, sizes that stand in the code too
        enlarged = own.pop("font.size") / SETTINGS["font.size"]
        own |= {key: own[key] / enlarged for key in own if key in SIZES and not isinstance(own[key], str)}
    settings = {**SETTINGS, **small, **own}
    return Look(settings, inches, points_of(font_size) / settings["xtick.labelsize"] if font_size else enlarged)


@contextlib.contextmanager
def applied(settings):
    """These settings on top of matplotlib's own: a user's matplotlibrc is not asked, so that figures are the same everywhere."""
    with matplotlib.rc_context():
        matplotlib.rcdefaults()
        matplotlib.rcParams.update(settings)
        yield


def points_of(text):
    try:
        points = float(text)
    except ValueError:
        raise UsageError(f"--font-size {text}: not a number of points, such as 9") from None
    if not 4 <= points <= 40:
        raise UsageError(f"--font-size {text}: text is 4 to 40 points high")
    return points


def width_of(text):
    """Inches of `column`, `page`, `86mm`, `8.6 cm` or `3.4in`."""
    found = re.fullmatch(r"\s*([\d.]+)\s*(mm|cm|in)\s*", text)
    try:
        inches = WIDTHS[text] if text in WIDTHS else float(found[1]) / {"mm": 25.4, "cm": 2.54, "in": 1.0}[found[2]]
    except (TypeError, ValueError):
        raise UsageError(f'--width {text}: neither column, page nor a length such as 86mm, 8.6cm or 3.4in') from None
    if not 1.0 <= inches <= 40.0:
        raise UsageError(f"--width {text}: figures are 1 in (25.4 mm) to 40 in wide")
    return inches


def settings_of(style):
    """Of a style by name, or of a file of lines `key: value`; none that a file has is unknown to matplotlib."""
    if style in STYLES:
        return STYLES[style]
    if not Path(style).is_file():
        raise UsageError(f"--style {style}: neither paper, slides nor a file")
    text = Path(style).read_text(encoding="utf-8", errors="replace")
    for number, line in enumerate(text.splitlines(), 1):
        key = line.partition("#")[0].partition(":")[0].strip()
        if key and key not in matplotlib.rcParams:
            raise UsageError(f"{style}:{number}: matplotlib has no setting {key}")
    return dict(matplotlib.rc_params_from_file(style, use_default_template=False))


def part_of(name, low, high):
    """A perceptual map without the end that would vanish against white paper or white marks."""
    import numpy as np
    return ListedColormap(matplotlib.colormaps[name](np.linspace(low, high, 256)), name=f"{name}_part")


INK, GREY = "#1a1a1a", "#666666"
CYCLES = {"CURVES": (0, 1, 2, 3), "ROD_COLOURS": (1, 0, 2, 3, 4, 5), "OTHERS": (1, 2, 3, 4, 5),
          "BED_RODS": (1, 3, 4, 5)}  # the last stand out from beads coloured by order
MAPS = {"FIELD_MAP": 0.93, "TIME_MAP": 0.9}


def __getattr__(name):
    """Colours of the style that is applied: style.LINE, style.CURVES, style.FIELD_MAP. Of a style file its cycle and its map."""
    colours = matplotlib.rcParams["axes.prop_cycle"].by_key().get("color", COLOURS)
    if name == "LINE":
        return colours[0]
    if name in CYCLES:
        return [colours[place % len(colours)] for place in CYCLES[name]]
    if name in MAPS:
        asked = matplotlib.rcParams["image.cmap"]
        return part_of(asked, 0.0, MAPS[name]) if asked == "viridis" else matplotlib.colormaps[asked]
    raise AttributeError(name)


def safe(text):
    """A user's one-line text as matplotlib can show it: mathtext if it parses, else literally."""
    if "$" not in text or is_mathtext(text):
        return text
    if text.count("$") > 1:
        errors.say_once(f'"{text}" is not TeX that figures can show; it is shown as plain text')
    return literal(text)


UNSEEN = "\u200b"  # figures take it away again (canvas.ShownFigure)


def label(text):
    """A user's name as the label of a curve: matplotlib leaves out of legends what begins with an underscore."""
    return text and (UNSEEN if text.startswith("_") else "") + safe(text)


def literal(text):
    """As it stands, also beside mathtext."""
    return text.replace("$", r"\$")


def can_show(text):
    """Whether matplotlib, which takes it line by line, can show this text."""
    return all(safe(line) == line for line in text.split("\n") if cbook.is_math_text(line))


@functools.lru_cache
def is_mathtext(text):
    try:
        MathTextParser("path").parse(text)
    except Exception:  # mostly ValueError, but it is run on whatever a file holds
        return False
    return True
