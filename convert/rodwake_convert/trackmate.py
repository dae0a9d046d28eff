"""TrackMate's XML: spots, the links between them, and which tracks its filters left."""

import codecs
import re
from xml.parsers import expat

import numpy as np

from .errors import shown
from .frames import UNTRACKED, Frame, Part, number, numbers, whole

BATCH = 1 << 16
AGAIN = "save the file again in TrackMate"


class Table:
    """Columns of numbers, collected as words with their lines and converted many at once."""

    def __init__(self, source, element, columns):
        self.source, self.element, self.columns = source, element, columns
        self.rows, self.lines, self.done = [], [], []

    def add(self, attributes, line):
        get = attributes.get
        self.rows.append([get(name, absent) for name, _, absent in self.columns])
        self.lines.append(line)
        if len(self.lines) >= BATCH:
            self.convert()

    def convert(self):
        def fail(name):
            return lambda k, what: self.source.fail(f"{name} = {what} in <{self.element}>; {AGAIN}", f":{self.lines[k]}")
        for k, row in enumerate(self.rows):
            if None in row:
                self.source.fail(f"<{self.element}> without {self.columns[row.index(None)][0]}; {AGAIN}", f":{self.lines[k]}")
        words = zip(*self.rows) if self.rows else [()] * len(self.columns)
        words = [[word.encode("utf-8", "replace") for word in column] for column in words]
        self.done.append([numbers(column, fail(name), kind) for column, (name, kind, _) in zip(words, self.columns)] + [np.array(self.lines, int)])
        self.rows, self.lines = [], []

    def arrays(self):
        self.convert()
        return [np.concatenate(column) for column in zip(*self.done)]


def parse(source):
    """(spots, number of hidden spots' table, edges, ids of the tracks that the filters left or None)."""
    spots = Table(source, "Spot", [("ID", whole, None), ("FRAME", whole, None), ("POSITION_X", number, None), ("POSITION_Y", number, None),
                                   ("POSITION_Z", number, "0")])
    hidden, filtered = Table(source, "Spot", [("ID", whole, None)]), Table(source, "TrackID", [("TRACK_ID", whole, None)])
    edges = Table(source, "Edge", [("SPOT_SOURCE_ID", whole, None), ("SPOT_TARGET_ID", whole, None), ("TRACK", whole, None)])
    parser, path, seen, track, section = expat.ParserCreate(), [], set(), "-1", ""

    def start(name, attributes):
        nonlocal track, section
        path.append(name)
        if name == "Spot" and section == "AllSpots":
            visible = attributes.get("VISIBILITY", "1")
            if visible == "1":
                spots.add(attributes, parser.CurrentLineNumber)
            elif visible == "0":
                hidden.add(attributes, parser.CurrentLineNumber)
            else:
                source.fail(f'VISIBILITY = "{shown(visible)}" in <Spot>: expected 0 or 1; {AGAIN}', f":{parser.CurrentLineNumber}")
        elif name == "Edge" and section == "AllTracks":
            attributes["TRACK"] = track
            edges.add(attributes, parser.CurrentLineNumber)
        elif name == "Track" and section == "AllTracks":
            track = attributes.get("TRACK_ID", "-1")
        elif name == "TrackID" and section == "FilteredTracks":
            filtered.add(attributes, parser.CurrentLineNumber)
        elif path == ["TrackMate", "Model"]:
            source.length_unit = attributes.get("spatialunits", "")
        elif len(path) == 3 and path[:2] == ["TrackMate", "Model"]:
            section = name
            seen.add(name)

    def doctype(*_):
        source.fail(f"has a <!DOCTYPE>, which TrackMate does not write; {AGAIN}", f":{parser.CurrentLineNumber}")

    parser.StartElementHandler, parser.EndElementHandler = start, lambda _: path.pop()
    parser.StartDoctypeDeclHandler = doctype
    try:
        with open(source.path, "rb") as file:
            head = file.read(200)
            file.seek(0)
            encoding = re.match(rb"""\s*<\?xml[^>]*encoding\s*=\s*["']([\w.-]+)""", head)
            # Names of channels in Latin-1 within UTF-8 are labels: a mark stands for each wrong byte.
            utf8 = codecs.getincrementaldecoder("utf-8-sig")("replace") if head[:2] not in (b"\xff\xfe", b"\xfe\xff") and (
                encoding is None or encoding[1].lower() in (b"utf-8", b"utf8")) else None
            while block := file.read(1 << 20):
                source.report()
                parser.Parse(utf8.decode(block) if utf8 else block, False)
            parser.Parse(b"", True)
    except expat.ExpatError as error:
        source.fail(f"no XML ({expat.ErrorString(error.code)}); is the file whole? Save it again in TrackMate", f":{error.lineno}")
    if "AllSpots" not in seen:
        source.fail('no <TrackMate><Model><AllSpots>: is this TrackMate\'s file? Its "Export tracks to XML" leaves the spots out; save with "Save", '
                    "or export the spots as CSV")
    return spots.arrays(), hidden.arrays()[0], edges.arrays(), filtered.arrays()[0] if "FilteredTracks" in seen else None


def read(source):
    source.certain = False
    (ids, frame, x, y, z, lines), hidden, (begin, end, track, _), filtered = parse(source)
    source.hidden = len(hidden)
    source.expect_rows(1, len(ids))
    if not len(ids):
        source.fail("has no visible spot: lower TrackMate's filters and save again")
    if len(ids) > 1 and (frame == frame[0]).all() and z.any():
        source.fail("all spots are in one frame, at different heights: the film was read as a stack in z; swap z and t (Image > Properties) "
                    "and track again")
    order = np.argsort(ids, kind="stable")
    again = np.flatnonzero(np.diff(ids[order]) == 0)
    if len(again):
        k = order[again + 1].min()
        source.fail(f'ID = {ids[k]} stands for a spot before; {AGAIN}', f":{lines[k]}")
    if filtered is not None:
        left = np.isin(track, filtered)
        begin, end = begin[left], end[left]
    missing = ~(np.isin(begin, ids) | np.isin(begin, hidden)) | ~(np.isin(end, ids) | np.isin(end, hidden))
    source.dangling = int(missing.sum())
    if source.dangling:
        source.warn(f"{source.dangling} links to spots that are not in the file: tracks end there")
    number_of = chains(source, ids, order, frame, np.isfinite(x) & np.isfinite(y), begin, end)
    source.report()
    by_frame = np.argsort(frame, kind="stable")
    starts = np.flatnonzero(np.diff(frame[by_frame], prepend=frame[by_frame[0]] - 1))
    for k, (first, last) in enumerate(zip(starts, [*starts[1:], len(frame)])):
        if source.past(k):
            return
        if source.wanted(k):
            rows = by_frame[first:last]
            part = Part(np.column_stack([x[rows], y[rows], z[rows]]), number_of[rows])
            yield Frame(k, int(frame[rows[0]]), None, None, part, place=lambda i, rows=rows: f":{lines[rows[i]]}")
            source.report(k / len(starts))


def chains(source, ids, order, frame, placed, begin, end):
    """Spots that follow one another are one particle; it ends where a track splits or merges. One without any link is untracked."""
    def spot(links):  # -1: hidden, without a place, or not in the file
        at = order[np.minimum(np.searchsorted(ids[order], links), len(ids) - 1)]
        return np.where((ids[at] == links) & placed[at], at, -1)

    begin, end = spot(begin), spot(end)
    both = (begin >= 0) & (end >= 0)
    begin, end = begin[both], end[both]
    swap = frame[begin] >= frame[end]
    begin, end = np.where(swap, end, begin), np.where(swap, begin, end)
    after, before = np.bincount(begin, minlength=len(ids)), np.bincount(end, minlength=len(ids))
    single = (after[begin] == 1) & (before[end] == 1)
    source.branches = int((~single).sum())
    follower, follows = np.full(len(ids), -1), np.zeros(len(ids), bool)
    follower[begin[single]] = end[single]
    follows[end[single]] = True
    number_of, follower, count = np.full(len(ids), UNTRACKED), follower.tolist(), 0
    for k in np.flatnonzero(~follows & (before + after > 0)).tolist():
        while k >= 0:
            number_of[k] = count
            k = follower[k]
        count += 1
    return number_of
