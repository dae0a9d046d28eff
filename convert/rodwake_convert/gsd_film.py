"""GSD of the schema hoomd, by the gsd library's file layer: what a frame does not have is as in the first frame."""

import os
import re

import numpy as np

from .errors import InputError, OutputError, reason, shown
from .frames import Frame, Part, box_of

try:
    import gsd.fl
    import gsd.version
except ImportError as error:
    raise OutputError(f"the Python package gsd is missing ({error}): apt-get install python3-gsd, or pip install gsd") from None

OLD = int(re.match(r"\d+", getattr(gsd.version, "version", None) or gsd.version.__version__)[0]) < 3  # names of modes


def opened(path, reading):
    """By a descriptor where the path is not UTF-8, which the library takes alone."""
    try:
        os.fsencode(path).decode()
        name = path
    except UnicodeDecodeError:
        name = f"/dev/fd/{os.open(path, os.O_RDONLY if reading else os.O_RDWR | os.O_CREAT)}"
    mode = ("rb" if OLD else "r") if reading else ("wb" if OLD else "w")
    return gsd.fl.open(name, mode, *([] if reading else ["rodwake convert", "hoomd", [1, 4]]))


def read(source):
    try:
        file = opened(source.path, True)
    except (OSError, RuntimeError, ValueError, MemoryError) as error:
        source.fail(f"not a readable GSD file ({reason(error)}): it is cut short or damaged, or of a newer GSD; write it again")
    if file.schema != "hoomd":
        source.fail(f'is of the schema "{shown(file.schema)}", not hoomd, which has positions of particles')
    if file.nframes == 0:
        source.fail("has no frames")
    frame = 0

    def chunk(name, rows=None, columns=None, kinds="iuf"):
        """Of this frame, else of the first one, where it fits; else None."""
        for k in dict.fromkeys((frame, 0)):
            if not file.chunk_exists(k, name):
                continue
            try:
                values = file.read_chunk(k, name)
            except (OSError, RuntimeError, ValueError, KeyError, MemoryError) as error:  # a damaged index claims any number of rows
                source.fail(f"{name} cannot be read ({reason(error)}): the file is cut short or damaged", f": frame {frame}")
            if values.dtype.kind not in kinds:
                source.fail(f"{name} is of the type {values.dtype}: the index is damaged", f": frame {frame}")
            if rows is None or len(values) == rows and (columns is None and values.size == rows or values.shape[1:] == (columns,)):
                return values
            if k == frame:
                wanted = f"{rows} rows{f' of {columns}' if columns else ''}"
                source.fail(f"{name} has {values.shape} numbers, expected {wanted}: the index is damaged", f": frame {frame}")
        return None

    def count(name, absent=0):
        value = chunk(name, 1, kinds="iu")
        return absent if value is None else int(value.ravel()[0])

    size = os.path.getsize(source.path)
    source.expect_rows(file.nframes, count("particles/N") if not any(file.chunk_exists(k, "particles/N") for k in (1, file.nframes - 1) if k) else 0)
    read_bytes, types = 0, None
    for frame in range(file.nframes):
        if source.past(frame):
            return
        if not source.wanted(frame):
            continue
        n, time, edges = count("particles/N"), chunk("log/time", 1), chunk("configuration/box", 6, kinds="f")
        position = chunk("particles/position", n, 3, "f") if n else np.zeros((0, 3))
        if position is None:
            source.fail(f"no particles/position of its {n} particles: the file is cut short or damaged", f": frame {frame}")
        if file.chunk_exists(frame, "particles/position"):
            read_bytes += position.nbytes
            if read_bytes > 2 * size:
                source.fail("chunks of particles/position lie one over the other: the index is damaged", f": frame {frame}")
        box = None
        if edges is not None:
            lx, ly, lz, xy, xz, yz = edges.astype(float).ravel()
            vectors = np.array([[lx, 0, 0], [xy * ly, ly, 0], [xz * lz, yz * lz, lz]])
            box = box_of(source, f": frame {frame}", -0.5 * vectors.sum(axis=0), vectors, (True, True, True)) if vectors.any() else None
        if frame == 0 or file.chunk_exists(frame, "particles/types"):
            letters = chunk("particles/types", kinds="iu")
            names = [] if letters is None or letters.ndim != 2 else [bytes(row.astype(np.uint8)).split(b"\0")[0] for row in letters]
            types = [name.decode("utf-8", "replace") for name in names] or ["A"]
            source.type_names = types
        ids = chunk("log/particles/id", n, kinds="iu") if n else None
        source.by_order |= ids is None
        part = Part(position.astype(float), np.arange(n) if ids is None else ids.ravel().astype(np.int64))
        if n:
            typeid, diameter = chunk("particles/typeid", n, kinds="iu"), chunk("particles/diameter", n, kinds="f")
            part.species = np.zeros(n, np.int32) if typeid is None else typeid.ravel().astype(np.int64)
            part.image, part.orientation = chunk("particles/image", n, 3, "i"), chunk("particles/orientation", n, 4, "f")
            part.orientation = None if part.orientation is None else part.orientation.astype(float)
            part.radius = None if diameter is None else 0.5 * diameter.ravel().astype(float)
            if part.species.max() >= len(types):
                source.fail(f"a typeid of {part.species.max()}, and there are {len(types)} types: the index is damaged", f": frame {frame}")
        rods = np.array([source.names_rod(name) for name in types], bool)
        yield Frame(frame, count("configuration/step"), None if time is None else float(time.ravel()[0]), box, part,
                    is_rod=rods[part.species] if n and rods.any() else None)
        source.report(frame / file.nframes)


class Writer:
    """Chunks of the schema hoomd. Positions are relative to the middle of the box; ids stand beside them where they are no 0, 1, 2, ..."""
    loses = "digits beyond single precision, and that a box is not periodic"

    def __init__(self, source, target):
        self.source, self.file, self.first = source, opened(target, False), None

    def add(self, frame, part, is_rod):
        n, box = len(part), frame.box
        species = np.zeros(n, np.uint32) if part.species is None else part.species.astype(np.uint32)
        names = list(self.source.type_names or ["A"] * (not species.any()))
        names += [str(k) for k in range(len(names), int(species.max(initial=0)) + 1)]
        letters = [name.encode("utf-8", "replace") for name in names]
        sizes, position, image = np.zeros(6), part.position, part.image
        if box is not None:
            (lx, ax, bx), (xy, ly, by), (xz, yz, lz) = box.edges
            if ax or bx or by:
                raise InputError(f"{self.source.path}: frame {frame.index}: GSD has no box whose first side is not along x: write .xyz or .dump")
            sizes = np.array([lx, ly, lz, xy / ly if ly else 0, xz / lz if lz else 0, yz / lz if lz else 0])
            position = position - (box.origin + 0.5 * box.edges.sum(axis=0))
            position, image = wrapped(position, image, box)
        chunks = {"configuration/step": np.array([frame.step], np.uint64), "configuration/box": sizes.astype(np.float32),
                  "particles/N": np.array([n], np.uint32),
                  "particles/types": np.array([list(word.ljust(max(map(len, letters)) + 1, b"\0")) for word in letters], np.uint8).view(np.int8),
                  "particles/position": position.astype(np.float32), "particles/typeid": species}
        if frame.time is not None:
            chunks["log/time"] = np.array([frame.time])
        if image is not None:
            chunks["particles/image"] = image.astype(np.int32)
        if part.orientation is not None:
            chunks["particles/orientation"] = part.orientation.astype(np.float32)
        if part.radius is not None:
            chunks["particles/diameter"] = (2 * part.radius).astype(np.float32)
        if part.ids is not None and not np.array_equal(part.ids, np.arange(n)):
            chunks["log/particles/id"] = part.ids.astype(np.int64)
        for name, values in chunks.items():
            # What is as in the first frame is taken from there.
            known = self.first and name in self.first and name not in ("configuration/step", "particles/position")
            if values.size and not (known and np.array_equal(self.first[name], values)):
                self.file.write_chunk(name, values)
        self.first = self.first or chunks
        self.file.end_frame()

    def close(self):
        self.file.close()


def wrapped(position, image, box):
    """Into the box, as GSD wants it, in the periodic directions of an upright one. Image indices go along where they are known."""
    if not box.upright:
        return position, image
    side = np.where(box.periodic, np.diag(box.edges), 0.0)
    turns = np.floor(np.divide(position, side, out=np.zeros_like(position), where=side > 0) + 0.5)
    return position - turns * side, None if image is None else image + turns.astype(int)
