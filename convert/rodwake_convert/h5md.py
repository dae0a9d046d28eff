"""H5MD of any program: elements fixed or in time, 2 or 3 dimensions, numbers of any precision. Writes the film that rodwake reads."""

import os

import h5py
import numpy as np

from . import theory
from .errors import InputError, reason, shown
from .frames import EMPTY, UNTRACKED, Frame, Part, box_of

PREFIXES = {"": 1.0, "k": 1e3, "c": 1e-2, "m": 1e-3, "u": 1e-6, "µ": 1e-6, "μ": 1e-6, "n": 1e-9, "p": 1e-12, "f": 1e-15}
VALUES = 1 << 16  # in a chunk, nearly: several frames where these are small
DAMAGE = (OSError, RuntimeError, KeyError, ValueError, TypeError, AttributeError, OverflowError, IndexError, NotImplementedError, UnicodeError)


def factor(unit, base):
    """What one of the unit is in m or s; None if it is not known."""
    if unit in ("Angstrom", "angstrom", "A") and base == "m":
        return 1e-10
    return PREFIXES.get(unit[:-1]) if unit.endswith(base) else None


def shape_of(dataset):
    return "[" + ", ".join(map(str, dataset.shape)) + "]"


class H5mdFile:
    """Datasets by their paths. Data that HDF5 cannot read are reported with the requested path."""

    def __init__(self, source):
        self.source = source
        try:
            self.file = h5py.File(os.fsencode(source.path), "r", rdcc_nbytes=1 << 26)
        except DAMAGE as error:
            source.fail(f"not a readable HDF5 file ({reason(error)}); give an H5MD file with particles/<group>/position/value and step")

    def guarded(self, what, act):
        try:
            return act()
        except DAMAGE as error:
            self.source.fail(f"{what} cannot be read ({reason(error)}): the file is cut short or damaged; write it again")

    def has(self, path):
        """Whether there is such an object inside this file; links to other files are refused, they would name any file of the user."""
        def look():
            group = self.file
            for name in path.strip("/").split("/"):
                if not isinstance(group, h5py.Group) or (link := group.get(name, getlink=True)) is None:
                    return False
                if isinstance(link, h5py.ExternalLink):
                    self.source.fail(f"{path} is a link to another file, {shown(link.filename)}: copy it into this one (h5repack)")
                group = group[name]  # group.get(name) would take an object whose header is damaged for one that is not there
            return True
        return self.guarded(path, look)

    def names(self, path):
        return self.guarded(path, lambda: list(self.file[path])) if self.has(path) else []

    def dataset(self, path, kinds):
        """Numbers of some kinds of types ("iuf"), whose bytes lie in this file and can be there."""
        if not self.has(path):
            self.source.fail(f"dataset {path} is missing")
        data = self.guarded(path, lambda: self.file[path])
        if not isinstance(data, h5py.Dataset) or self.guarded(path, lambda: data.shape) is None:
            self.source.fail(f"{path} is no dataset with numbers")
        if self.guarded(path, lambda: data.dtype.kind) not in kinds:
            self.source.fail(f"{path} holds values of another type ({data.dtype}): expected {'numbers' if 'f' in kinds else 'whole numbers'}")
        if self.guarded(path, lambda: data.external or data.is_virtual):
            self.source.fail(f"{path} has its values in another file: copy them into this one (h5repack)")
        if self.guarded(path, data.id.get_storage_size) > os.path.getsize(self.source.path):
            self.source.fail(f"{path} is of shape {shape_of(data)}, which is more than lies in the file: it is cut short or damaged")
        return data

    def attribute(self, path, name):
        """None if there is none; texts as str, of bytes that are not UTF-8 with marks in their place."""
        if not self.has(path) or name not in self.guarded(path, lambda: self.file[path].attrs):
            return None
        value = self.guarded(f"{name} of {path}", lambda: self.file[path].attrs[name])
        items = [item.decode("utf-8", "replace") if isinstance(item, bytes) else item for item in np.atleast_1d(value).ravel().tolist()]
        return items[0] if np.ndim(value) == 0 and items else items


class Element:
    """A quantity of each particle: the same in all frames, or <path>/value with a row for each, which is read many frames at once."""

    def __init__(self, file, path, kinds, columns):
        self.file, self.in_time = file, file.has(path + "/value")
        self.path = path + "/value" if self.in_time else path
        self.data, self.first, self.block = file.dataset(self.path, kinds), 0, None
        shape, rank = self.data.shape, 1 + self.in_time + bool(columns)
        if columns and (not shape or shape[-1] not in columns) and len(shape) == rank and len(columns) > 1:
            file.source.fail(f"{path} is of shape {shape_of(self.data)}: expected two or three coordinates")
        if len(shape) != rank or (columns and shape[-1] not in columns):
            wanted = f"{'frames, ' * self.in_time}particles{f', {columns[-1]}' if columns else ''}"
            file.source.fail(f"{path} is of shape {shape_of(self.data)}: expected {wanted}")
        self.frames, self.particles = (shape[0] if self.in_time else None), shape[int(self.in_time)]
        cells = max(1, int(np.prod(shape[1:])))
        chunk = self.data.chunks[0] if self.data.chunks else 1
        self.at_once = max(1, VALUES // cells)
        if self.at_once > chunk:
            self.at_once -= self.at_once % chunk

    def at(self, k):
        if self.block is None or (self.in_time and not self.first <= k < self.first + len(self.block)):
            self.first = k - k % self.at_once if self.in_time else 0
            part = slice(self.first, min(self.first + self.at_once, self.frames)) if self.in_time else ()
            self.block = self.file.guarded(f"{self.path}, frame {k}", lambda: self.data[part])
        return self.block[k - self.first] if self.in_time else self.block


def whole_array(source, path, values):
    if values.dtype.kind == "u" and values.size and values.max() >= 2**63:
        source.fail(f"{path} has numbers of 2^63 and above")
    return values.astype(np.int64)


def moments(file, path, frames, kinds):
    """Steps or times: one each, or a number, their distance, with an offset."""
    data = file.dataset(path, kinds)
    if data.shape == (frames,):
        return file.guarded(path, lambda: data[()])
    if data.size != 1:
        file.source.fail(f"{path} is of shape {shape_of(data)}, and there are {frames} frames")
    every, offset = file.guarded(path, lambda: data[()].reshape(-1)[0]), file.attribute(path, "offset")
    offset = offset[0] if isinstance(offset, list) and offset else offset or 0
    if isinstance(offset, str) or not np.isfinite([float(every), float(offset)]).all() or abs(float(offset)) + abs(float(every)) * frames >= 2**53:
        file.source.fail(f"{path} is {every}, with offset {shown(offset)}: the file is damaged")
    return offset + np.arange(frames) * every


class Bodies:
    """One group of particles."""

    def __init__(self, file, group):
        self.file, self.group, self.source = file, group, file.source
        self.position = Element(file, group + "position", "fiu", (2, 3))
        if not self.position.in_time:
            self.source.fail(f"{group}position has no frames in time")
        self.source.expect_rows(self.position.frames, self.position.particles)
        self.others = {}
        for name, kinds, columns in (("id", "iu", None), ("species", "iu", None), ("radius", "fiu", None), ("image", "iu", (2, 3)),
                                     ("orientation", "fiu", (4,))):
            if not file.has(group + name) or (name == "species" and self.file.guarded(group + name, lambda: self.named_types())):
                continue
            found = self.others[name] = Element(file, group + name, kinds, columns)
            if found.particles != self.position.particles or found.frames not in (None, self.position.frames):
                self.source.fail(f"{group}{name} has {found.particles} particles in {found.frames or 1} frames, "
                                 f"position has {self.position.particles} in {self.position.frames}")
        self.nobody = None
        if "id" in self.others:
            created = self.others["id"].data.id.get_create_plist()
            if created.fill_value_defined() == h5py.h5d.FILL_VALUE_USER_DEFINED:
                self.nobody = int(self.others["id"].data.fillvalue)

    def named_types(self):
        """Species that are texts, which are not read."""
        found = self.file.file[self.group + "species"]
        found = found["value"] if isinstance(found, h5py.Group) and "value" in found else found
        return isinstance(found, h5py.Dataset) and found.dtype.kind not in "iu"

    def read(self, k):
        rows = {name: element.at(k) for name, element in self.others.items()}
        place = self.position.at(k).astype(float)
        if "id" in rows:
            rows["id"] = whole_array(self.source, self.group + "id", rows["id"])
        if place.shape[1] == 2:
            place = np.column_stack([place, np.zeros(len(place))])
        if "image" in rows and rows["image"].shape[1] == 2:
            rows["image"] = np.column_stack([rows["image"], np.zeros(len(place), int)])
        self.source.by_order |= "id" not in rows
        rows |= {name: rows[name].astype(float) for name in ("radius", "orientation") if name in rows}
        part = Part(place, rows.get("id", np.arange(len(place))), *map(rows.get, ("image", "species", "radius", "orientation")))
        return part if self.nobody is None else part.rows(part.ids != self.nobody)


def group_of(file, given):
    """particles/<the group that is meant>/"""
    names = [name for name in file.names("particles") if file.has(f"particles/{name}/position")]
    if given and given not in names:
        file.source.fail(f"no positions of particles/{given} (tracks.group); there are: {', '.join(map(shown, names))}")
    if not names:
        file.source.fail("no positions in a group of particles; give an H5MD file with particles/<group>/position/value and step")
    found = given or next((name for name in ("trajectory", "all") if name in names), None)
    if not found and len(names) > 1:
        file.source.fail(f"several groups of particles: {', '.join(map(shown, names))}; name one in tracks.group")
    return f"particles/{found or names[0]}/"


def boxes_of(file, group, d, step):
    """A function that gives the box of a frame: edges a vector or a matrix, fixed, in time, or with steps of their own."""
    source, path = file.source, group + "box/edges"
    boundary = file.attribute(group + "box", "boundary")
    if boundary is None:
        return lambda k: None
    periodic = tuple(flag == "periodic" for flag in np.atleast_1d(boundary).tolist())[:3]
    periodic += (False,) * (3 - len(periodic))
    if not file.has(path):
        if periodic[0] and periodic[1]:
            source.fail(f"{path} is missing, and the box is periodic")
        return lambda k: None

    def element(path, widths, what):
        in_time = file.has(path + "/value")
        data = file.dataset(path + "/value" if in_time else path, "fiu")
        rows = data.shape[0] if in_time and data.shape else 1
        if data.size > 10**9 or not rows or data.size // rows not in widths or data.size % rows:
            source.fail(f"{path} is of shape {shape_of(data)}: expected {what} numbers")
        at = np.arange(len(step)) if rows == len(step) else np.zeros(len(step), int)
        if rows not in (1, len(step)):
            own = moments(file, path + "/step", rows, "iu") if file.has(path + "/step") else []
            if len(own) != rows or (np.diff(own) <= 0).any():
                source.fail(f"{path} has {rows} rows without steps of their own, and there are {len(step)} frames")
            at = np.maximum(0, np.searchsorted(own, step, side="right") - 1)
        block, first = None, 0

        def row(k):  # a part of the rows is in memory
            nonlocal block, first
            if block is None or not first <= at[k] < first + len(block):
                first = int(at[k])
                block = file.guarded(path, lambda: data[first:first + 4096] if in_time and data.shape else data[()].reshape(1, -1))
                block = block.reshape(len(block), -1).astype(float)
            return block[at[k] - first]
        return row

    edges = element(path, (d, d * d), f"{d} or {d} x {d}")
    origin = element(group + "box/origin", (d,), str(d)) if file.has(group + "box/origin") else lambda k: np.zeros(d)

    def box(k):
        found, low = edges(k), np.zeros(3)
        matrix = np.zeros((3, 3))
        matrix[:d, :d] = found.reshape(d, d) if len(found) == d * d else np.diag(found)
        low[:d] = origin(k)
        return None if np.isnan(matrix).all() else box_of(source, f": {group}position, frame {k}", low, matrix, periodic)
    return box


def read(source):
    file = H5mdFile(source)
    if file.names("rods") and not file.has("particles"):
        yield from theory.read(source, file)
        return
    group = group_of(file, source.options.group)
    beads = Bodies(file, group)
    frames = beads.position.frames
    is_film = file.attribute("rodwake", "film") is not None
    rods = Bodies(file, group[:-1] + "_rods/") if file.has(group[:-1] + "_rods/position") and (is_film or "species" in beads.others) else None
    if rods and rods.position.frames != frames:
        source.fail(f"{rods.group}position has {rods.position.frames} frames, {group}position has {frames}")
    step = whole_array(source, group + "position/step", moments(file, group + "position/step", frames, "iu"))
    time = None
    if file.has(group + "position/time"):
        unit = file.attribute(group + "position/time", "unit")
        second = 1.0 if unit is None else factor(str(unit), "s")
        if second is None:
            unknown = f'{group}position/time is in the unit "{shown(unit)}", which is not known; known are s, ms, us, ns, ps and the like'
            (source.fail if source.options.needs_times else source.warn)(unknown)
        else:
            time = moments(file, group + "position/time", frames, "fiu").astype(float) * second
    read_labels(source, file, group, is_film)
    boxes = boxes_of(file, group, beads.position.data.shape[2], step)
    for k in range(frames):
        if source.past(k):
            return
        if not source.wanted(k):
            continue
        source.report(k / frames)
        frame = Frame(k, int(step[k]), None if time is None else float(time[k]), boxes(k), beads.read(k), rods.read(k) if rods else None)
        species = frame.beads.species
        if rods and not is_film and source.options.rods == "spheres":
            frame.rods, frame.is_rod = None, species != 0
        elif rods and not is_film:  # the spheres of rods stand for them no longer
            frame.beads = frame.beads.rows(species == 0)
        elif species is not None and source.options.rod_kind:
            kinds = [k for k in np.unique(species).tolist() if source.names_rod(source.name_of(k)) or source.names_rod(str(k))]
            frame.is_rod = np.isin(species, kinds)
        yield frame


def read_labels(source, file, group, is_film):
    unit = next((found for place in ("position/value", "position") if (found := file.attribute(group + place, "unit"))), "")
    source.length_unit = str(unit)
    radius = file.attribute("parameters", "bead_radius")
    if isinstance(radius, float) and radius > 0:
        kinds = names_by_number(file, "parameters/kinds")
        source.bed, source.bead_radius, source.length_unit = True, radius, str(file.attribute("parameters/units", "length") or unit or "m")
        source.type_names = kinds or None
    if is_film:
        names = next((found for place in ("species/value", "species") if (found := file.attribute(group + place, "names"))), None)
        source.type_names = [str(name) for name in names] if names is not None else None
        source.certain = bool(file.attribute("rodwake", "certain_ids"))
        source.length_unit = str(file.attribute("rodwake", "length_unit") or source.length_unit)


def names_by_number(file, path):
    """Names whose attributes of a group are 0, 1, 2, ..."""
    found = {name: file.attribute(path, name) for name in (file.guarded(path, lambda: list(file.file[path].attrs)) if file.has(path) else [])}
    return sorted((name for name in found if isinstance(found[name], int)), key=found.get)


class Series:
    """A dataset that grows by a row a frame, and in width with the largest frame; empty cells hold the fill value."""

    def __init__(self, file, path, dtype, tail=(), wide=False, fill=None):
        self.file, self.path, self.dtype, self.tail, self.wide, self.fill = file, path, np.dtype(dtype), tail, wide, fill
        self.rows, self.held, self.frames, self.width, self.data = [], 0, 0, 0, None

    def add(self, row):
        self.rows.append(row)
        self.held += np.size(row) + 1
        if self.held >= VALUES or len(self.rows) >= VALUES:
            self.flush()

    def create(self, width):
        columns = (max(1, min(width, VALUES)),) if self.wide else ()
        per_frame = int(np.prod(columns + self.tail))
        chunks = (max(1, min(VALUES, VALUES // max(1, per_frame))), *columns, *self.tail)
        shape = (0, *((width,) if self.wide else ()), *self.tail)
        return self.file.create_dataset(self.path, shape, self.dtype, maxshape=(None, *((None,) if self.wide else ()), *self.tail), chunks=chunks,
                                        compression="gzip", compression_opts=1, shuffle=True, fletcher32=True, fillvalue=self.fill)

    def flush(self):
        if self.data is None:
            self.data = self.create(max(map(len, self.rows), default=0) if self.wide else 0)
            self.width = self.data.shape[1] if self.wide else 0
        if not self.rows:
            return
        width = max(self.width, max(map(len, self.rows))) if self.wide else 0
        if self.wide and width > 8 * self.data.chunks[1]:  # chunks of narrow frames would be too many
            old, self.data = self.data, None
            self.file.move(self.path, self.path + "_narrow")
            self.data = self.create(width)
            self.data.resize(self.frames, axis=0)
            for k in range(0, self.frames, 4096):
                self.data[k:k + 4096, :self.width] = old[k:k + 4096]
            del self.file[self.path + "_narrow"]
        if width > self.width:
            self.data.resize(width, axis=1)
            self.width = width
        if self.wide and any(len(row) != self.width for row in self.rows):
            block = np.full((len(self.rows), self.width, *self.tail), 0 if self.fill is None else self.fill, self.dtype)
            for into, row in zip(block, self.rows):
                into[:len(row)] = row
        else:
            block = np.array(self.rows, self.dtype).reshape(len(self.rows), *((self.width,) if self.wide else ()), *self.tail)
        self.data.resize(self.frames + len(self.rows), axis=0)
        self.data[self.frames:] = block
        self.frames += len(self.rows)
        self.rows, self.held = [], 0


class Writer:
    """The film: particles/trajectory and particles/trajectory_rods, as beds write them."""
    loses = "nothing"
    COLUMNS = {"position": ("position", "f8", (3,), np.nan), "ids": ("id", "i8", (), EMPTY), "image": ("image", "i4", (3,), 0),
               "species": ("species", "i4", (), 0), "radius": ("radius", "f8", (), np.nan), "orientation": ("orientation", "f8", (4,), np.nan)}

    def __init__(self, source, target):
        self.source, self.file = source, h5py.File(os.fsencode(target), "w")
        self.series, self.frames, self.timed, self.unknown = {}, 0, True, set()
        self.first_box, self.has_origin, self.width, self.rows = None, False, {"": 0, "_rods": 0}, 0

    def put(self, path, row, *layout, **keys):
        """A row of a dataset; frames before it get empty rows."""
        if path not in self.series:
            self.series[path] = Series(self.file, "particles/" + path, *layout, **keys)
            if self.frames and path.endswith("image/value"):
                self.unknown.add(path)
            empty = np.zeros((0, *self.series[path].tail)) if self.series[path].wide else np.full(self.series[path].tail, np.nan)
            for _ in range(self.frames):
                self.series[path].add(empty)
        self.series[path].add(row)

    def add(self, frame, part, is_rod):
        self.put("trajectory/position/step", frame.step, "i8")
        self.timed &= frame.time is not None
        self.put("trajectory/position/time", frame.time if frame.time is not None else np.nan, "f8")
        for suffix, part in (("", frame.beads), ("_rods", frame.rods)):
            if part is None:
                if not self.width[suffix]:
                    continue
                part = Part(np.zeros((0, 3)), np.zeros(0, int))
            self.width[suffix] = max(self.width[suffix], len(part))
            for name, (element, dtype, tail, fill) in self.COLUMNS.items():
                values = getattr(part, name)
                path = f"trajectory{suffix}/{element}/value"
                if suffix and name in ("species", "radius") or not suffix and name == "orientation":
                    continue
                if values is None:
                    if path not in self.series and name not in ("species", "orientation"):
                        continue
                    if name == "image":  # image indices that are not known in a frame are of no use in the others
                        self.unknown.add(path)
                    values = np.full((len(part), *tail), np.nan if dtype == "f8" else 0)
                self.put(path, values, dtype, tail, wide=True, fill=fill)
        self.rows += len(frame.beads)
        self.put_box(frame)
        self.frames += 1
        cells = self.frames * sum(self.width.values())
        if cells > 4e8 and cells > 10 * self.rows:
            raise InputError(f"{self.source.path}: its frames differ so much in their number of particles that {cells:.2g} cells would hold "
                             f"{self.rows:.2g} rows: convert parts of it with --frames FROM:TO")

    def put_box(self, frame):
        """A frame whose box is missing, or periodic in other directions than the first, has edges of NaN: it is not the same box."""
        box = frame.box
        if self.frames == 0:
            self.first_box = box
        if box is not None and self.first_box is not None and box.periodic != self.first_box.periodic:
            self.source.warn(f"the boundaries of the box change in frame {frame.index}")
            box = None
        if box is None and "trajectory/box/edges/value" not in self.series:
            return
        if box is not None and self.first_box is None:
            self.first_box = box
        self.has_origin |= box is not None and bool(box.origin.any())
        self.put("trajectory/box/edges/value", np.full((3, 3), np.nan) if box is None else box.edges, "f8", (3, 3))
        self.put("trajectory/box/origin/value", np.zeros(3) if box is None else box.origin, "f8", (3,))

    def close(self):
        source, file = self.source, self.file
        for series in self.series.values():
            series.flush()
        for path in self.unknown:
            del self.series[path], file["particles/" + path.rpartition("/")[0]]
        if not self.timed:
            del file["particles/trajectory/position/time"]
        if "trajectory/box/origin/value" in self.series and not self.has_origin:
            del file["particles/trajectory/box/origin"]
        box = file.require_group("particles/trajectory/box")
        box.attrs["dimension"] = np.int32(3)
        periodic = self.first_box.periodic if self.first_box else (False,) * 3
        box.attrs.create("boundary", ["periodic" if flag else "none" for flag in periodic], dtype=h5py.string_dtype())
        if "particles/trajectory_rods" in file:
            file["particles/trajectory_rods/box"] = box
        for path in self.series:
            element = file.get("particles/" + path.rpartition("/")[0])
            for name in ("step", "time") if element is not None and path.endswith("/value") else ():
                common = f"particles/trajectory/position/{name}"
                if common in file and name not in element:
                    element[name] = file[common]
        file["particles/trajectory/id/value"].attrs["untracked"] = np.int64(UNTRACKED)
        if source.type_names:
            file["particles/trajectory/species/value"].attrs.create("names", [safe(name) for name in source.type_names], dtype=h5py.string_dtype())
        h5md, own = file.require_group("h5md"), file.require_group("rodwake")
        h5md.attrs["version"] = np.array([1, 1], np.int32)
        for name, keys in (("author", {"name": "rodwake"}), ("creator", {"name": "rodwake convert", "version": ""})):
            h5md.require_group(name).attrs.update(keys)
        own.attrs["film"] = np.int64(1)
        for name, value in (("source", os.path.basename(source.path)), ("format", source.format), ("length_unit", source.length_unit),
                            ("first_without_place", source.first_without_place)):
            own.attrs[name] = safe(value)
        for name in ("without_place", "hidden", "branches", "dangling"):
            own.attrs[name] = np.int64(getattr(source, name))
        own.attrs["certain_ids"] = np.int64(source.certain)
        if source.warnings:
            own.attrs.create("warnings", [safe(text) for text in source.warnings], dtype=h5py.string_dtype())
        file.close()


def safe(text):
    """What can be stored as UTF-8: names of files may be any bytes."""
    return os.fsencode(text).decode("utf-8", "replace").replace("\0", "?")
