"""The conversion itself: opens a file of some format, and writes its frames in another one. Runs in the worker."""

import contextlib
import importlib
import os
import re

import numpy as np

from . import supervise
from .errors import InputError, OutputError, reason, shown
from .formats import MODULES, WRITERS
from .frames import Box, Frame, Part, Source, tidy


def convert(options, report, nobody_known=False):
    source, options.nobody_known = Source(options.input, options, report, options.format), nobody_known
    reader = importlib.import_module(f".{MODULES[options.format]}", __package__)
    frames = guarded(source, tidy(source, reader.read(source)))
    if options.look:
        look(source, list(frames))
        return
    writer_module = importlib.import_module(f".{MODULES[options.to]}", __package__)
    try:
        with writing(options.output):
            writer = writer_module.Writer(source, options.temporary)
        count = particles = rods = 0
        for frame in frames:
            count, particles = count + 1, max(particles, len(frame.beads))
            rods = max(rods, len(frame.rods) if frame.rods is not None else 0)
            scale(source, frame)
            part, is_rod = (None, None) if options.to == "h5md" else merged(source, frame)
            with writing(options.output):
                writer.add(frame, part, is_rod)
            report()
        if source.by_order and len(source.counts) > 1 and not nobody_known:  # the order in the frame does not tell who is who after all
            writer.close()
            return convert(options, report, True)
        report.patient()
        with writing(options.output):
            writer.close()
            descriptor = os.open(options.temporary, os.O_RDONLY)
            os.fsync(descriptor)
            os.close(descriptor)
            os.rename(options.temporary, options.output)
    except BaseException:
        with contextlib.suppress(OSError):
            os.unlink(options.temporary)
        raise
    loses = "" if writer.loses == "nothing" else f"; {WRITERS[options.to]} loses {writer.loses}"
    left_out = f"; {source.without_place} rows without a position are left out (first: {source.first_without_place})" if source.without_place else ""
    report.say(f"done: {count} frames, {particles} particles, {rods} rod{'s' * (rods != 1)}{left_out}{loses}")


def look(source, frames):
    """What `rodwake check` tells of a file that it will read."""
    first, times = frames[0], [frame.time for frame in frames]
    box = "no box"
    if first.box is not None:
        axes = [axis for axis, flag in zip("x, y, z".split(", "), first.box.periodic) if flag]
        box = f"box {' x '.join(f'{side:.6g}' for side in np.linalg.norm(first.box.edges, axis=1))} (periodic in {', '.join(axes) or 'no direction'})"
    times = "no times" if None in times else f"times {', '.join(f'{time:.6g}' for time in times)} s"
    rods = len(first.rods) if first.rods is not None else 0
    source.report.say(f"done: {len(first.beads)} particles, {rods} rod{'s' * (rods != 1)}, {box}, {times}, steps {', '.join(str(frame.step) for frame in frames)}"
                      f"{', length unit ' + shown(source.length_unit) if source.length_unit else ''}")


def guarded(source, frames):
    """What a reader did not expect of a file is damage; the other errors pass."""
    while True:
        try:
            frame = next(frames)
        except StopIteration:
            return
        except (InputError, OutputError, MemoryError, BrokenPipeError):
            raise
        except Exception as error:
            if os.environ.get(supervise.DEBUG):
                raise
            name = WRITERS.get(source.format, source.format)
            source.fail(f"cannot be read as {name} ({reason(error)}): the file is cut short or damaged; write it again")
        yield frame


@contextlib.contextmanager
def writing(output):
    try:
        yield
    except (InputError, OutputError, MemoryError, BrokenPipeError):
        raise
    except Exception as error:
        if os.environ.get(supervise.DEBUG):
            raise
        why = re.search(r"error message = '([^']*)'", str(error))
        raise OutputError(f"{output}: cannot be written ({why[1] if why else getattr(error, 'strerror', None) or reason(error)})") from None


def scale(source, frame):
    """Lengths in the unit that is asked for: bead radii of a bed, or one that the file's own unit can be turned into."""
    from .h5md import factor
    wanted = source.options.unit or ("a" if source.bed and source.options.to != "h5md" else None)
    if wanted is None:
        return
    known, target = factor(source.length_unit, "m") if source.length_unit else None, source.bead_radius if wanted == "a" else factor(wanted, "m")
    if wanted == "a" and not source.bead_radius:
        source.fail("does not know the radius of its beads: leave --unit a out")
    if target is None or known is None:
        source.fail(f"is in the unit \"{shown(source.length_unit)}\", which cannot be turned into {shown(wanted)}: leave --unit out")
    by = target / known
    for part in filter(None, (frame.beads, frame.rods)):
        part.position = part.position / by
        part.radius = None if part.radius is None else part.radius / by
    if frame.box is not None:
        frame.box = Box(frame.box.origin / by, frame.box.edges / by, frame.box.periodic)


def merged(source, frame: Frame):
    """Beads and rods as rows of one table, and which are rods (None: the film has none). Rods whose ids are those of beads get -1 - id."""
    beads, rods = frame.beads, frame.rods
    if rods is None:
        return beads, frame.is_rod
    if beads.ids is not None and rods.ids is not None:
        if source.rods_apart is None:
            source.rods_apart = bool(np.isin(rods.ids, beads.ids).any())
        if source.rods_apart:
            rods = rods.rows(slice(None))
            rods.ids = -1 - rods.ids
    if rods.species is None or beads.species is None:
        most = 0 if beads.species is None else int(beads.species.max(initial=0))
        names = source.type_names = source.type_names or (["bead"] if most == 0 else [str(k) for k in range(most + 1)])
        if "rod" not in names:
            names.append("rod")
        beads, rods = beads.rows(slice(None)), rods.rows(slice(None))
        beads.species = np.zeros(len(beads), int) if beads.species is None else beads.species
        rods.species = np.full(len(rods), names.index("rod"))
    joined = {}
    for name in vars(beads):
        pair = [getattr(beads, name), getattr(rods, name)]
        if pair[0] is not None or pair[1] is not None:
            known = pair[0] if pair[0] is not None else pair[1]
            empty = np.nan if known.dtype.kind == "f" else 0
            pair = [np.full((len(part), *known.shape[1:]), empty) if values is None else values for values, part in zip(pair, (beads, rods))]
            joined[name] = np.concatenate(pair)
    return Part(**joined), np.repeat([False, True], [len(beads), len(rods)])
