"""What is said to the user. Printing never stops the work nor changes how it ends, whoever reads it, or nobody."""

import contextlib
import os
import sys

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


def forget():
    """Before another run: nothing has been said of it."""
    _said.clear()
