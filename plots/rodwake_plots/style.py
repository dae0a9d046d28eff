"""One look for every figure: fonts, sizes, colours. Widths are those of a Physical Review page."""

import matplotlib
from matplotlib.colors import ListedColormap
from matplotlib.mathtext import MathTextParser

SINGLE, WIDE = 4.2, 7.0  # inches: one and a half columns, two columns

SETTINGS = {
    "font.family": ["STIXGeneral", "DejaVu Sans"],
    "mathtext.fontset": "stix",
    "font.size": 10, "axes.labelsize": 10.5, "axes.titlesize": 10.5, "xtick.labelsize": 9, "ytick.labelsize": 9,
    "axes.linewidth": 0.7, "lines.linewidth": 1.3,
    "xtick.direction": "in", "ytick.direction": "in", "xtick.top": True, "ytick.right": True,
    "xtick.major.width": 0.7, "ytick.major.width": 0.7, "xtick.major.size": 3.5, "ytick.major.size": 3.5,
    "figure.facecolor": "white", "savefig.facecolor": "white", "savefig.dpi": 200,
    "pdf.fonttype": 42, "axes.formatter.use_mathtext": True,
}


def part_of(name, low, high):
    """A perceptual map without the end that would vanish against white paper or white marks."""
    import numpy as np
    return ListedColormap(matplotlib.colormaps[name](np.linspace(low, high, 256)), name=f"{name}_part")


FIELD_MAP = part_of("viridis", 0.0, 0.93)
TIME_MAP = part_of("viridis", 0.0, 0.9)

INK, GREY = "#1a1a1a", "#666666"
LINE = "#0072b2"
# Okabe and Ito, told apart with any colour vision; the yellow is left out for white paper.
ROD_COLOURS = ["#d55e00", "#0072b2", "#009e73", "#cc79a7", "#e69f00", "#56b4e9"]


def safe(text):
    """A user's one-line text as matplotlib can show it: mathtext if it parses, else literally."""
    if "$" not in text:
        return text
    try:
        MathTextParser("path").parse(text)
        return text
    except ValueError:
        return text.replace("$", r"\$")


def require_mathtext(symbol):
    """ValueError unless matplotlib can show this TeX, without dollars."""
    MathTextParser("path").parse(f"${symbol}$")
