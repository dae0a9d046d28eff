"""Ctrl-C and SIGTERM while figures are drawn: what is half done is taken back, one line is said, and the program ends.

The handler itself ends the program: an exception can be lost in a callback, or in a package that is just being imported.
"""

import contextlib
import os
import signal

SIGNALS = signal.SIGINT, signal.SIGTERM
SAID = b"rodwake plot: stopped by a signal; the files that were complete are kept\n"
_acts = []


def take_signals():
    """Those that are not ignored, as Ctrl-C is in the background of a shell."""
    for number in SIGNALS:
        if signal.getsignal(number) != signal.SIG_IGN:
            signal.signal(number, end)


@contextlib.contextmanager
def undoing(act):
    """`act` is called if a signal ends the program inside the block."""
    _acts.append(act)
    try:
        yield
    finally:
        _acts.remove(act)


def end(number, _):
    for one in SIGNALS:  # rodwake passes the signal on until we have ended
        signal.signal(one, signal.SIG_IGN)
    for act in reversed(_acts):
        with contextlib.suppress(OSError):
            act()
    with contextlib.suppress(OSError):
        os.write(2, SAID)
    os._exit(128 + number)
