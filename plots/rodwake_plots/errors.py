"""The exceptions that mean: tell the user in a line and stop; and going on after any other."""

import os
import traceback

DEBUG = "RODWAKE_PLOT_DEBUG"


class PlotError(Exception):
    pass


class MissingError(PlotError):
    """What a figure shows is not in a file of this folder. If it never was, the other figures can be drawn."""

    def __init__(self, file, why):
        super().__init__(f"{file}: {why}")
        self.file = file


class UsageError(PlotError):
    """An option that cannot be."""


def attempt(act, *arguments):
    """(what it gives, None), or (None, the exception): one figure or section that fails does not take the others with it.

    A user sees no traceback; it is for whoever asks for it. Nor is it kept: it holds the figure, and files that are open.
    """
    try:
        return act(*arguments), None
    except Exception as error:
        if os.environ.get(DEBUG):
            traceback.print_exc()
        error.__cause__ = error.__context__ = None
        return None, error.with_traceback(None)


def reason(error):
    """In one line."""
    if isinstance(error, PlotError):
        text = str(error)
    elif isinstance(error, ImportError):
        text = f"a Python package is missing: {error}"
    elif isinstance(error, OSError):
        text = f"{error.filename}: {error.strerror}" if error.filename else str(error)
    elif isinstance(error, MemoryError):
        text = "not enough memory"
    else:
        text = f"internal error: {type(error).__name__}: {error} ({DEBUG}=1 shows where)"
    return " ".join(text.split())
