"""Lines of a text file, read in blocks: end with LF, CR LF, or, in a file without LF, with CR."""

import gzip
import os
import zlib

import numpy as np

from .errors import InputError
from .frames import numbers, whole

LONGEST, BLOCK = 1 << 24, 1 << 22


class Lines:
    def __init__(self, path, report):
        self.path, self.report, self.number = path, report, 0
        try:
            self.bytes = open(path, "rb")
            zipped = self.bytes.read(2) == b"\x1f\x8b"
            self.bytes.seek(0)
        except OSError as error:
            raise InputError(f"{path}: cannot be read ({error.strerror})") from None
        self.file = gzip.GzipFile(fileobj=self.bytes) if zipped else self.bytes
        self.size, self.read = os.fstat(self.bytes.fileno()).st_size, 0
        self.rest, self.lines, self.at, self.end, self.taken = b"", [], 0, b"\n", 0
        self.fill()

    def fill(self):
        """Another block of lines behind those that are used up; False at the end of the file."""
        self.report(min(1.0, self.bytes.tell() / max(1, self.size)))
        try:
            block = self.file.read(BLOCK)
        except (EOFError, OSError, zlib.error) as error:
            raise InputError(f"{self.path}: its gzip data are damaged or end too soon ({error}); take another copy") from None
        first = self.read == 0
        self.read += len(block)
        if first:
            block = block.removeprefix(b"\xef\xbb\xbf")
            if b"\r" in block and b"\n" not in block:
                self.end = b"\r"
        if not block and not self.rest:
            return False
        *lines, rest = (self.rest + block).split(self.end)
        self.rest = rest if block else b""
        lines += [] if block else [rest]
        if len(self.rest) > LONGEST:
            raise InputError(f"{self.path}:{self.number + len(lines) + 1}: a line of more than {LONGEST >> 20} MB: is this a file of text?")
        self.lines, self.at = self.lines[self.at:] + lines, 0
        return True

    def next(self):
        """The next line, or None at the end."""
        while self.at >= len(self.lines):
            if not self.fill():
                return None
        line = self.lines[self.at]
        self.at += 1
        self.number += 1
        return line.strip(b" \t\r")

    def take(self, count):
        """Up to `count` lines: fewer where a block ends, none at the end of the file. Blanks and CR are left on."""
        while self.at >= len(self.lines):
            if not self.fill():
                return []
        found = self.lines[self.at:self.at + count]
        self.at += len(found)
        self.number += len(found)
        return found

    def table(self, count, columns, wrong_length, cut_short):
        """Columns of the next `count` lines: arrays of (word in the line, name, kind) each; a kind of None leaves words as they are.

        wrong_length(number of words) tells what is wrong with a line, or None; cut_short(k) ends the reading at row k.
        """
        found, done = [[] for _ in columns], 0

        def fail(line, what):
            raise InputError(f"{self.path}:{line}: {what}")

        while done < count:
            block = self.take(min(count - done, 1 << 16))
            if not block:
                cut_short(done)
            first = self.number - len(block) + 1
            rows = [line.split() for line in block]
            for length in set(map(len, rows)):
                if what := wrong_length(length):
                    k = next(k for k, row in enumerate(rows) if len(row) == length)
                    if not rows[k] or rows[k][0].startswith(b"ITEM:"):
                        self.number = first + k
                        cut_short(done + k)
                    fail(first + k, what)
            for values, (at, name, kind) in zip(found, columns):
                words = [row[at] for row in rows]
                values.append(words if kind is None else numbers(words, lambda k, what: fail(first + k, f"{name} = {what}"), kind))
            done += len(block)
            self.report(self.read / max(1, self.size))
        return [sum(values, []) if kind is None else np.concatenate(values) if values else np.zeros(0, np.int64 if kind is whole else float)
                for values, (_, _, kind) in zip(found, columns)]

    def skip(self, count, cut_short):
        done = 0
        while done < count:
            block = self.take(count - done)
            if not block:
                cut_short(done)
            done += len(block)

    def used(self):
        """Bytes of the file before the next line, or nearly so."""
        return self.read - len(self.rest) - sum(map(len, self.lines[self.at:]))


def rows_of_text(columns, separator=" "):
    """Lines with all digits of the numbers, as bytes. A column is an array of one or two dimensions, or a list of words."""
    words = []
    for values in columns:
        if isinstance(values, list):
            words.append(values)
        else:
            words += [map(repr, column.tolist()) for column in (values.T if values.ndim == 2 else [values])]
    return "".join(f"{row}\n" for row in map(separator.join, zip(*words))).encode("utf-8", "surrogateescape")
