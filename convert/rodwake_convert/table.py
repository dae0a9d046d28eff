"""CSV with the columns frame, t, particle, x, y, theta, kind: `rodwake` has made any other table into this before it calls the converter."""

import numpy as np

from .errors import shown
from .frames import UNTRACKED, Frame, Part, headings, number, numbers, turned, whole
from .lines import Lines, rows_of_text

KNOWN = ("frame", "t", "particle", "x", "y", "theta", "kind")


def read(source):
    """All rows are held, since they may come in any order."""
    lines = Lines(source.path, source.report)
    header = [word.decode("utf-8", "replace").strip().strip('"') for word in (lines.next() or b"").split(b",")]
    if len(set(header)) < len(header) or set(header) - set(KNOWN) or not {"x", "y"} <= set(header) or not {"frame", "t"} & set(header):
        source.fail(f"the header is {shown(','.join(header))}: expected x, y, frame or t, and of particle, theta, kind", ":1")
    columns = {name: [] for name in header}
    while block := lines.take(1 << 16):
        first = lines.number - len(block) + 1
        rows = [line.strip().split(b",") for line in block]
        rows = [row for row in rows if row != [b""]] if len(rows) < 1 << 16 else rows  # empty lines at the end
        for k, row in enumerate(rows):
            if len(row) != len(header):
                source.fail(f"has {len(row)} cells, and the header names {len(header)}", f":{first + k}")
        for at, name in enumerate(header):
            words = [row[at] for row in rows]
            empty = np.array([not word for word in words], bool)

            def fail(k, what):
                source.fail(f"{name} = {what}", f":{first + k}")
            if name == "kind":
                kinds = {word: source.names_rod(word.decode("utf-8", "surrogateescape")) or word == b"1" for word in set(words)}
                columns[name].append(np.array([kinds[word] for word in words], bool))
            elif name in ("frame", "particle"):
                if name == "frame" and empty.any():
                    fail(int(np.argmax(empty)), '"": expected a whole number')
                values = numbers([word or b"0" for word in words], fail, whole)
                columns[name].append(np.where(empty, UNTRACKED, values))
            else:
                columns[name].append(numbers([word or b"nan" for word in words], fail, number))
        source.report(lines.read / max(1, lines.size))
    table = {name: np.concatenate(values) if values else np.zeros(0) for name, values in columns.items()}
    count = len(table["x"])
    source.expect_rows(1, count)
    source.certain = False
    key = table["frame"] if "frame" in table else table["t"]
    if np.isnan(key).any():
        source.fail("has no time: give every row one", f":{int(np.argmax(np.isnan(key))) + 2}")
    order = np.argsort(key, kind="stable")
    starts = np.flatnonzero(np.diff(key[order], prepend=-np.inf)) if count else []
    position = np.column_stack([table["x"], table["y"], np.zeros(count)])
    for k, (begin, end) in enumerate(zip(starts, [*starts[1:], count])):
        if source.past(k):
            return
        if not source.wanted(k):
            continue
        rows = order[begin:end]
        part = Part(position[rows], table["particle"][rows] if "particle" in table else np.full(len(rows), UNTRACKED))
        part.orientation = turned(table["theta"][rows]) if "theta" in table else None
        time = float(table["t"][rows[0]]) if "t" in table else None
        yield Frame(k, int(key[rows[0]]) if "frame" in table else k, time, None, part, is_rod=table["kind"][rows] if "kind" in table else None,
                    place=lambda i, rows=rows: f":{rows[i] + 2}")
        source.report(k / len(starts))


class Writer:
    loses = "box, images, z, types and sizes"

    def __init__(self, source, target):
        self.file, self.header = open(target, "wb"), None

    def add(self, frame, part, is_rod):
        n = len(part)
        columns = {"frame": np.full(n, frame.step)} | ({"t": np.full(n, frame.time)} if frame.time is not None else {})
        ids = part.ids if part.ids is not None else np.arange(n)
        columns |= {"particle": ["" if k == UNTRACKED else str(k) for k in ids.tolist()], "x": part.position[:, 0], "y": part.position[:, 1]}
        if self.header and "theta" in self.header or part.orientation is not None:
            theta = np.full(n, np.nan) if part.orientation is None else headings(part.orientation)
            columns["theta"] = ["" if t != t else repr(t) for t in theta.tolist()]
        if self.header and "kind" in self.header or is_rod is not None:
            columns["kind"] = ["rod" if flag else "bead" for flag in (np.zeros(n, bool) if is_rod is None else is_rod).tolist()]
        if self.header is None:
            self.header = list(columns)
            self.file.write(",".join(self.header).encode() + b"\n")
        if list(columns) != self.header:
            raise ValueError(f"frame {frame.index} has {', '.join(columns)}, unlike the frames before")
        self.file.write(rows_of_text(columns.values(), ","))

    def close(self):
        self.file.close()
