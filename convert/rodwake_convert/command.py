"""The command: its options, and what it prints. Reads TrackMate XML, LAMMPS dumps, XYZ, GSD, H5MD and CSV; writes all but the first."""

import argparse
import os
import signal
import sys

os.environ.update(dict.fromkeys(("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"), "1"))

from . import formats, supervise  # noqa: E402 (threads are counted when NumPy is imported, which only the worker does)


def arguments(argv):
    parser = argparse.ArgumentParser(prog="rodwake_convert", description="Convert a film of particles to another format.")
    parser.error = lambda text: sys.exit(print(text, file=sys.stderr) or 2)  # one line, as of all errors
    parser.add_argument("input", metavar="IN")
    parser.add_argument("-o", "--output", default="", metavar="OUT", help=".h5md, .gsd, .xyz, .dump or .csv")
    parser.add_argument("--format", choices=list(formats.MODULES), help="of IN; else by its content, then by its name")
    parser.add_argument("--to", choices=list(formats.WRITERS), help="of OUT; else by its name")
    parser.add_argument("--group", default="", help="of H5MD: particles/GROUP")
    parser.add_argument("--rod-kind", action="append", default=[], metavar="K", help="types that are rods; may be given several times")
    parser.add_argument("--column", action="append", default=[], metavar="KEY=NAME", help="id, x, y, heading or kind of another name")
    parser.add_argument("--time-column", default="", metavar="KEY", help="of the second line of XYZ, in s")
    parser.add_argument("--needs-times", action="store_true", help="refuse frames without a time")
    parser.add_argument("--frames", default="::", metavar="FROM:TO:STRIDE", help="numbers from 0 on, TO not included")
    parser.add_argument("--unit", default="", help="of length: a (bead radii, the default for a bed), m, mm, um, ...")
    parser.add_argument("--rods", choices=["poses", "spheres"], help="of a bed")
    parser.add_argument("--look", action="store_true", help="read two frames, write nothing")
    parser.add_argument("--force", action="store_true", help="replace OUT")
    options = parser.parse_args(argv)
    try:
        parts = (options.frames.split(":") + [""] * 3)[:3]
        if options.frames.count(":") > 2 or not all(part.isascii() and (part.isdigit() or not part) for part in parts):
            raise ValueError
        options.frames = int(parts[0] or 0), int(parts[1]) if parts[1] else None, int(parts[2] or 1)
        if not options.frames[2]:
            raise ValueError
    except ValueError:
        parser.error(f"--frames {options.frames}: expected FROM:TO:STRIDE, whole numbers, each optional")
    pairs = [pair.partition("=") for pair in options.column]
    if bad := [key for key, equal, name in pairs if key not in ("id", "x", "y", "heading", "kind") or not name]:
        parser.error(f"--column {bad[0]}: expected id=NAME, x=NAME, y=NAME, heading=NAME or kind=NAME")
    options.columns = {key: name for key, _, name in pairs}
    options.to = options.to or (formats.by_name(options.output) if options.output else None)
    if not options.look and options.to not in formats.WRITERS:
        parser.error("-o OUT: expected a name that ends in .h5md, .gsd, .xyz, .dump or .csv, or --to FORMAT")
    options.rods = options.rods or ("poses" if options.to in ("csv", "h5md", None) else "spheres")
    return options


def run(options, show=None):
    """The Outcome of a conversion; also for a process that does many."""
    path = options.input
    folder = os.path.dirname(options.output) or "."
    options.temporary = os.path.join(folder, f".rodwake-{os.getpid()}.part")
    why = None
    try:
        if not os.path.isfile(path):
            why = f"{path}: no such file of tracks"
        else:
            options.format = options.format or formats.of_file(path)
            if options.time_column and options.format not in ("csv", "xyz"):
                why = f"{path}: has no columns of times: leave tracks.time_column out, or give tracks.frames_per_second"
    except OSError as error:
        why = f"{path}: cannot be read ({error.strerror})"
    if why:
        return supervise.Outcome(2, why)
    if not options.look:
        if os.path.lexists(options.output) and not options.force:
            return supervise.Outcome(1, f"{options.output}: exists already; --force replaces it")
        if os.path.isdir(options.output) or not os.path.isdir(folder):
            why = "it is a folder" if os.path.isdir(options.output) else "no such folder"
            return supervise.Outcome(1, f"{options.output}: cannot be written ({why})")

    def work(report):
        from .convert import convert  # its libraries take time, and belong to the worker
        convert(options, report)
    return supervise.run(work, path, formats.LIBRARIES[options.format], [options.temporary], show)


def main(argv=None):
    for stream in sys.stdout, sys.stderr:
        stream.reconfigure(errors="surrogateescape", line_buffering=True)
    options = arguments(argv)
    stopped = []

    def stop(number, _):
        for each in (signal.SIGINT, signal.SIGTERM):
            signal.signal(each, signal.SIG_IGN)
        stopped.append(number)
        raise supervise.Stopped

    for number in (signal.SIGINT, signal.SIGTERM):
        if signal.getsignal(number) != signal.SIG_IGN:
            signal.signal(number, stop)
    try:
        outcome = run(options, print)
    except supervise.Stopped:
        return 128 + stopped[0]
    except BrokenPipeError:  # nobody reads on
        return 1
    if outcome.code:
        print(" ".join(outcome.message.split()), file=sys.stderr)
    return outcome.code


