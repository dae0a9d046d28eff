"""Making and saving a figure."""

import contextlib
import os
import string

from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator


def figure(width, height):
    made = Figure(figsize=(width, height), layout="compressed")
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


@contextlib.contextmanager
def replacing(path):
    """A temporary path beside `path`, moved over it only when all went well."""
    temporary = path.with_name(f".{path.name}.{os.getpid()}.tmp")
    try:
        yield temporary
        os.replace(temporary, path)
    finally:
        temporary.unlink(missing_ok=True)


PAD = 0.04  # inches around what is drawn


def save(made, path, metadata=None):
    with replacing(path) as temporary:
        made.savefig(temporary, format=path.suffix[1:], bbox_inches="tight", pad_inches=PAD, metadata=metadata)
