"""The exceptions that mean: tell the user in a line and stop; and going on after any other."""

import contextlib
import os
import signal
import sys
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


# What is said to the user. Printing never stops the work nor changes how it ends, whoever reads it, or nobody.

NAME = "rodwake plot: "
_said = set()


class Stream:
    """Standard output or error as long as it can be written to: `rodwake plot RUN | head -1` makes every figure."""

    def __init__(self, out):
        self.out = out  # None: it was closed when the program began
        if hasattr(out, "reconfigure"):
            out.reconfigure(errors="backslashreplace")

    def write(self, text):
        try:
            if self.out is not None:
                self.out.write(text)
                self.out.flush()
        except (OSError, ValueError):  # nobody reads on, the disk is full, it was closed
            silence(self.out)

    def flush(self):
        """Written at once."""


def silence(out):
    """What is buffered goes nowhere, now and when the interpreter ends."""
    with contextlib.suppress(OSError, ValueError):
        os.dup2(os.open(os.devnull, os.O_WRONLY), out.fileno())


def fill_closed_descriptors():
    """So that no file of a run gets the number of a closed stdout or stderr, and what is printed there."""
    for number in range(3):
        try:
            os.fstat(number)
        except OSError:
            os.open(os.devnull, os.O_RDWR)  # takes the lowest free number


def say(text):
    Stream(sys.stderr).write(NAME + " ".join(text.split()) + "\n")


def say_once(text):
    """What several figures would say again."""
    if text not in _said:
        _said.add(text)
        say(text)


def forget_said():
    """Before another run: nothing has been said of it."""
    _said.clear()


# Ctrl-C and SIGTERM while figures are drawn: what is half done is taken back, one line is said, and the program ends.

SIGNALS = signal.SIGINT, signal.SIGTERM
STOPPED = b"rodwake plot: stopped by a signal; the files that were complete are kept\n"
_acts = []


def take_signals():
    """Those that are not ignored, as Ctrl-C is in the background of a shell."""
    for number in SIGNALS:
        if signal.getsignal(number) != signal.SIG_IGN:
            signal.signal(number, end_by_signal)


@contextlib.contextmanager
def undoing(act):
    """`act` is called if a signal ends the program inside the block."""
    _acts.append(act)
    try:
        yield
    finally:
        _acts.remove(act)


def end_by_signal(number, _):
    for one in SIGNALS:  # rodwake passes the signal on until we have ended
        signal.signal(one, signal.SIG_IGN)
    for act in reversed(_acts):
        with contextlib.suppress(OSError):
            act()
    with contextlib.suppress(OSError):
        os.write(2, STOPPED)
    os._exit(128 + number)
