"""Frames of a film as every reader gives them and every writer takes them, and the rules that hold for all formats."""

import re
from dataclasses import dataclass, field, replace

import numpy as np

from .errors import InputError, shown

EMPTY = -(2**63)  # the id of a row without a particle: the fill value
UNTRACKED = EMPTY + 1  # the id of a spot that is in no track
MOST_ROWS, ROW_BYTES = 10**8, 64  # 32 bytes a row, twice while they are put in order
USUAL_RODS = ("rod", "motile", "apolar")
NO_RATE = "no rate of the film is given, it has no times: set tracks.frames_per_second"
NO_TIME = "the frame has no time: set tracks.frames_per_second, how many frames (of files with time steps: steps) a second has"


@dataclass
class Part:
    """The particles of one kind in a frame; what is None the file does not tell."""
    position: np.ndarray  # (n, 3)
    ids: np.ndarray = None
    image: np.ndarray = None
    species: np.ndarray = None
    radius: np.ndarray = None
    orientation: np.ndarray = None  # (n, 4), real part first

    def rows(self, which):
        return Part(*(None if value is None else value[which] for value in vars(self).values()))

    def __len__(self):
        return len(self.position)


@dataclass
class Box:
    origin: np.ndarray  # the low corner
    edges: np.ndarray  # a row each
    periodic: tuple

    def same(self, other):
        return other is not None and self.periodic == other.periodic and np.array_equal(self.edges, other.edges)

    @property
    def upright(self):
        return not (self.edges - np.diag(np.diag(self.edges))).any()


@dataclass
class Frame:
    index: int  # number in the file
    step: int
    time: float
    box: Box
    beads: Part
    rods: Part = None
    is_rod: np.ndarray = None  # which rows of `beads` are rods, until `tidy` has parted them
    place: object = None  # "line" of a row, or None: rows are named by the frame


@dataclass
class Source:
    """A file that is read: its options, what is known of the whole, and what is found on the way."""
    path: str
    options: object
    report: object
    format: str = ""
    length_unit: str = ""
    type_names: list = None
    bead_radius: float = None  # of a bed of rodwake, m
    bed: bool = False
    certain: bool = True
    last_box: tuple = (None, None)  # (key, box): most are as in the frame before
    last_text: tuple = (None, None)
    rods_apart: bool = None  # whether ids of rods are also those of beads
    by_order: bool = False  # ids are the order in the frame, which holds if all frames have as many rows
    rows: int = 0
    counts: set = field(default_factory=set)  # of rows, in the frames
    hidden: int = 0
    branches: int = 0
    dangling: int = 0
    without_place: int = 0
    first_without_place: str = ""
    warnings: list = field(default_factory=list)

    def fail(self, what, where=None):
        raise InputError(f"{self.path}{'' if where is None else where}: {what}")

    def warn(self, text):
        if text not in self.warnings:
            self.warnings.append(text)
            self.report.say(f"warning: {self.path}: {text}")

    def wanted(self, index):
        first, last, stride = self.options.frames
        return index >= first and (last is None or index < last) and (index - first) % stride == 0

    def past(self, index):
        """Whether no frame from here on is asked for."""
        first, last, stride = self.options.frames
        return (last is not None and index >= last) or (self.options.look and index >= first + 2 * stride)

    def names_rod(self, kind):
        return kind in (self.options.rod_kind or USUAL_RODS)

    def name_of(self, species):
        return self.type_names[species] if self.type_names and 0 <= species < len(self.type_names) else str(species)

    def species_of(self, words):
        """Numbers of types: those of the file, or, if it names its types, their order of appearance in `type_names`."""
        kinds = set(words)
        if self.type_names is None and all(word.isdigit() and len(word) < 10 for word in kinds):
            number = {word: int(word) for word in kinds}
        else:
            self.type_names = self.type_names or []
            for word in dict.fromkeys(words):
                if (name := word.decode("utf-8", "replace")) not in self.type_names:
                    self.type_names.append(name)
            number = {word: self.type_names.index(word.decode("utf-8", "replace")) for word in kinds}
        return np.array([number[word] for word in words], np.int32)

    def expect_rows(self, frames, particles, about=""):
        """Refuses what cannot be held, before it is read."""
        first, last, stride = self.options.frames
        frames = max(0, (min(frames, last) if last is not None else frames) - first + stride - 1) // stride
        if not self.options.look and frames * particles > MOST_ROWS:
            rows = frames * particles
            more = -(-rows // MOST_ROWS) * stride
            self.fail(f"has {about}{rows:.4g} rows ({frames} frames of {particles} particles), which need "
                      f"{rows * ROW_BYTES / 2**30:.3g} GB of memory; "
                      f"the most is {MOST_ROWS:.0e} rows: convert fewer frames, as with --frames 0:{last or ''}:{more}")


def box_of(source, where, origin, edges, periodic):
    """A box whose sides make sense; off-axis parts up to 1e-12 of a side are rounding. None: a box of no size. Most are as in the frame before."""
    key = np.array(edges, float).tobytes(), np.array(origin, float).tobytes(), tuple(periodic)
    if source.last_box[0] != key:
        source.last_box = key, new_box(source, where, origin, edges, periodic)
    return source.last_box[1]


def new_box(source, where, origin, edges, periodic):
    edges, origin = np.array(edges, float).reshape(3, 3), np.array(origin, float)
    sides = np.abs(np.diag(edges))
    edges[np.abs(edges) <= 1e-12 * np.maximum(sides[:, None], sides[None, :])] = 0.0
    if periodic[0] and periodic[1]:
        if not (np.isfinite(edges).all() and np.isfinite(origin).all() and edges[0, 0] > 0.0 and edges[1, 1] > 0.0):
            source.fail(f"the sides of the box, {edges[0, 0]:g} and {edges[1, 1]:g}, are not positive and finite", where)
    elif not (np.isfinite(edges).all() and np.isfinite(origin).all()) or not edges.any():
        return None
    return Box(origin, edges, tuple(bool(flag) for flag in periodic))


def box_of_bounds(source, where, low, high, tilt, periodic):
    """Of LAMMPS, whose bounds are those of the tilted box's hull."""
    low, high, (xy, xz, yz) = np.array(low), np.array(high), tilt
    low = low - [min(0.0, xy, xz, xy + xz), min(0.0, yz), 0.0]
    high = high - [max(0.0, xy, xz, xy + xz), max(0.0, yz), 0.0]
    side = high - low
    return box_of(source, where, low, [[side[0], 0, 0], [xy, side[1], 0], [xz, yz, side[2]]], periodic)


def turned(heading):
    """Quaternions of headings in the plane; NaN where a heading is not known."""
    heading = np.asarray(heading, float)
    zero = np.where(np.isnan(heading), np.nan, 0.0)
    return np.column_stack([np.cos(heading / 2), zero, zero, np.sin(heading / 2)])


def headings(orientation):
    w, x, y, z = np.asarray(orientation, float).T
    return np.arctan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))


def tidy(source, frames):
    """Frames with rods apart, rows in the order of ids, no row without a place; steps and times that make sense.

    The first frame is held back until the second one tells whether the file has steps at all: if all are equal, frames are numbered.
    """
    held, same_steps, last_step, last_time, count, rows = None, None, None, None, 0, 0
    for frame in frames:
        where = f": frame {frame.index}"
        if not -(2**53) < frame.step < 2**53:
            source.fail(f"the step {frame.step} is no step", where)
        if frame.time is None and source.options.needs_times:
            source.fail(NO_RATE if source.format == "trackmate" else NO_TIME, where)
        if frame.time is not None and not np.isfinite(frame.time):
            source.fail(f"the time {frame.time} is no time", where)
        if source.options.needs_times and last_time is not None and not frame.time > last_time:
            source.fail(f"the time {frame.time:.10g} does not increase (it was {last_time:.10g} in the frame before): set tracks.frames_per_second, "
                        "or take the frame out", where)
        if last_step is not None:
            if same_steps is None:
                same_steps = frame.step == last_step
                if same_steps:
                    source.warn(f"all frames have the step {frame.step}: they are taken in their order, as 0, 1, 2, ...")
            if same_steps != (frame.step == last_step) or (not same_steps and frame.step < last_step):
                source.fail(f"the step {frame.step} does not increase (it was {last_step} in the frame before): take the frame out", where)
        last_step, last_time = frame.step, frame.time
        in_frame = len(frame.beads) + (len(frame.rods) if frame.rods is not None else 0)
        rows += in_frame
        source.counts.add(in_frame)
        if rows > MOST_ROWS and not source.options.look:
            source.expect_rows(frame.index + 1, -(-rows // (frame.index + 1)), "more than ")
            source.fail(f"has more than {MOST_ROWS:.0e} rows: convert fewer frames with --frames FROM:TO:STRIDE", where)
        if source.options.nobody_known:
            for part in filter(None, (frame.beads, frame.rods)):
                part.ids = np.full(len(part), UNTRACKED)
        part_and_sort(source, frame)
        if same_steps:
            frame.step = count
        count += 1
        if held is not None:
            yield replace(held, step=0) if same_steps else held
            held = None
        if count == 1:
            held = frame
        else:
            yield frame
    if held is not None:
        yield held
    source.rows = rows - source.without_place
    if source.rows == 0:
        source.fail(f"has no particle with a position in its {count} frames")


def part_and_sort(source, frame):
    """Takes rods out of the beads and rows without a place out of both, and sorts by id."""
    part, rods = frame.beads, frame.rods
    known = np.isfinite(part.position[:, :2]).all(axis=1)
    for group in (part, rods) if rods is not None else (part,):
        bad = ~np.isfinite(group.position[:, :2]).all(axis=1)
        if bad.any():
            if not source.without_place:
                first = int(np.argmax(bad))
                source.first_without_place = source.path + (frame.place(first) if frame.place and group is part else f": frame {frame.index}")
            source.without_place += int(bad.sum())
    if frame.is_rod is not None and frame.is_rod.any():
        rods = part.rows(known & frame.is_rod)
        known &= ~frame.is_rod
    elif rods is not None:
        rods = rods.rows(np.isfinite(rods.position[:, :2]).all(axis=1))
    if not known.all():
        part = part.rows(known)

    def ordered(group):
        if group is None or group.ids is None or len(group) < 2 or (group.ids[1:] >= group.ids[:-1]).all():
            return group
        return group.rows(np.argsort(group.ids, kind="stable"))

    frame.beads, frame.rods, frame.is_rod = ordered(part), ordered(rods), None


# Numbers of text files. float() alone would take "1_000" and the digits of other scripts; so would int().

NUMBER = re.compile(rb"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eEdD][+-]?\d+)?|[+-]?(?i:nan|inf|infinity)")
WHOLE = re.compile(rb"[+-]?\d+(?:\.0*)?")


def number(word):
    """The number that a word is, else None. Fortran writes exponents as 1.5D+00."""
    value = float(word.lower().replace(b"d", b"e")) if NUMBER.fullmatch(word) and len(word) < 400 else None
    return None if value is not None and np.isinf(value) and word[-1:].isdigit() else value  # 1e400 is no number that can be kept


def whole(word):
    if len(word) > 400:
        return None
    if WHOLE.fullmatch(word):
        value = int(word.split(b".")[0])
    else:
        value = number(word)
        if value is None or not abs(value) < 2**53 or value != int(value):
            return None
    return int(value) if abs(value) < 2**53 else None


def numbers(words, fail, kind=number):
    """An array of the words; fail(k, text) if one is none. Words of digits alone go to float(), which is then strict, at once."""
    integer = kind is whole
    if not b",".join(words).translate(None, b",0123456789+-" if integer else b",0123456789+-.eE"):
        try:
            values = np.array(list(map(int if integer else float, words)), np.int64 if integer else float)
            if not len(values) or (np.abs(values).max() < 2**53 if integer else np.isfinite(values).all()):
                return values
        except (ValueError, OverflowError):
            pass  # the slow way below tells which word it is
    values = []
    for k, word in enumerate(words):
        value = kind(word)
        if value is None:
            fail(k, f"\"{shown(word)}\": expected a {'whole ' * integer}number")
        values.append(value)
    return np.array(values, np.int64 if integer else float)
