"""Runs a conversion in a process of its own, and ends it when it hangs, takes too much memory or crashes.

Libraries that read damaged files may loop for ever, allocate without bound or die by a signal. The parent process imports none of them:
it watches a pipe on which the worker reports, and tells in one line what became of the file.
"""

import contextlib
import gc
import json
import os
import resource
import select
import signal
import sys
import time
import traceback
from dataclasses import dataclass, field

from .errors import InputError, OutputError, reason

DEBUG = "RODWAKE_CONVERT_DEBUG"
SECONDS, MEMORY = 20.0, 1 << 30
ORPHAN_SECONDS = 120  # A worker whose parent was killed ends by SIGALRM if it also hangs.


class Stopped(BaseException):
    """Ctrl-C or SIGTERM reached the parent."""


@dataclass
class Outcome:
    code: int = 1
    message: str = ""
    death: str = ""  # "", "signal", "time" or "memory": why the worker did not end by itself
    peak: int = 0  # bytes of memory, as far as the parent saw
    lines: list = field(default_factory=list)


class Report:
    """The worker's end of the pipe. A call is a sign of life; it writes at most ten times a second."""

    def __init__(self, pipe):
        self.pipe, self.last = pipe, 0.0

    def __call__(self, fraction=None):
        now = time.monotonic()
        if now - self.last > 0.1:
            self.last = now
            signal.alarm(ORPHAN_SECONDS)
            self.send(progress=fraction)

    def send(self, **record):
        data = json.dumps(record).encode() + b"\n"
        while data:
            data = data[os.write(self.pipe, data):]

    def say(self, text):
        self.send(say=text)

    def patient(self):
        """From here on the worker waits for the disk, which may take any time."""
        signal.alarm(0)
        self.send(patient=True)


def work_in_child(work, pipe):
    """Never returns: whatever happens, the process ends with one record of its outcome."""
    report = Report(pipe)
    try:
        signal.signal(signal.SIGINT, signal.SIG_IGN)  # the parent stops the worker
        for number in (signal.SIGTERM, signal.SIGALRM):
            signal.signal(number, signal.SIG_DFL)
        signal.pthread_sigmask(signal.SIG_SETMASK, [])
        gc.disable()  # rows of words are no cycles, and there are millions
        if not os.environ.get(DEBUG):  # C libraries print their last words there
            os.dup2(os.open(os.devnull, os.O_WRONLY), 2)
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        hard = resource.getrlimit(resource.RLIMIT_DATA)[1]
        resource.setrlimit(resource.RLIMIT_DATA, (MEMORY if hard < 0 else min(MEMORY, hard), hard))
        work(report)
        report.send(code=0)
    except BaseException as error:
        if os.environ.get(DEBUG):
            traceback.print_exc()
        code = 2 if isinstance(error, InputError) else 1
        text = f"internal error: {type(error).__name__}: {reason(error)} ({DEBUG}=1 shows where)"
        text = str(error) if isinstance(error, (InputError, OutputError)) else text
        with contextlib.suppress(OSError):
            report.send(**({"memory": True} if isinstance(error, MemoryError) else {"code": code, "message": text}))
    finally:
        os._exit(0)


def run(work, path, library, temporaries=(), show=None):
    """Calls work(report) in a forked process and watches it; `show` gets each line for the user. Returns the Outcome."""
    outcome, rest, idle, patient, ended = Outcome(), b"", 0.0, False, False
    reader, writer = os.pipe()
    sys.stdout.flush()
    page = resource.getpagesize()
    before = signal.pthread_sigmask(signal.SIG_BLOCK, [signal.SIGINT, signal.SIGTERM])
    child = os.fork()
    if child == 0:
        os.close(reader)
        work_in_child(work, writer)
    status = None
    try:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)
        os.close(writer)
        while not outcome.death:
            # A process that was stopped (Ctrl-Z) had no time to report, so that a long wait counts little.
            start = time.monotonic()
            ready = select.select([reader], [], [], 0.1)[0]
            idle += min(time.monotonic() - start, 0.5)
            data = os.read(reader, 1 << 16) if ready else b""
            if ready and not data:
                break
            *records, rest = (rest + data).split(b"\n")
            for record in map(json.loads, records):
                idle, patient, ended = 0.0, patient or "patient" in record, ended or "code" in record
                outcome.code, outcome.message = record.get("code", outcome.code), record.get("message", outcome.message)
                if "memory" in record:
                    outcome.death = "memory"
                line = record.get("say") or (f"{record['progress']:.4f}" if record.get("progress") is not None else None)
                if line and line not in outcome.lines[-1:]:
                    outcome.lines.append(line)
                    if show:
                        show(line)
            with contextlib.suppress(OSError, IndexError, ValueError), open(f"/proc/{child}/statm") as statm:
                outcome.peak = max(outcome.peak, int(statm.read().split()[1]) * page)
            if outcome.peak > MEMORY:
                outcome.death = "memory"
            elif idle > SECONDS and not patient:
                outcome.death = "time"
    finally:
        if outcome.death or sys.exc_info()[0]:
            os.kill(child, signal.SIGKILL)
        status = os.wait4(child, 0)
        os.close(reader)
        if outcome.death or sys.exc_info()[0] or not ended or outcome.code:
            for temporary in temporaries:
                with contextlib.suppress(OSError):
                    os.unlink(temporary)
    outcome.peak = max(outcome.peak, status[2].ru_maxrss * 1024 if sys.platform == "linux" else 0)
    advice = "write it again, or take another copy"
    if outcome.death == "time":
        outcome.message = f"{path}: the {library} library finds no end of this file ({SECONDS:.0f} s without progress): it is damaged; {advice}"
    elif outcome.death == "memory":
        outcome.message = (f"{path}: reading it takes more than {MEMORY >> 30} GB of memory: it is damaged, or its frames are too large; {advice}, "
                           "or convert fewer frames with --frames FROM:TO:STRIDE")
    elif not ended:
        outcome.death = "signal"
        name = signal.Signals(os.WTERMSIG(status[1])).name if os.WIFSIGNALED(status[1]) else "no reason given"
        outcome.message = f"{path}: the {library} library crashed on this file ({name}): it is damaged; {advice}"
    if outcome.death:
        outcome.code = 2
    return outcome
