"""Text dumps of LAMMPS and of programs that write such."""

import numpy as np

from .errors import shown
from .frames import UNTRACKED, Frame, Part, box_of, box_of_bounds, number, turned, whole
from .lines import Lines, rows_of_text

SECONDS = {"real": 1e-15, "electron": 1e-15, "metal": 1e-12, "micro": 1e-6, "nano": 1e-9}  # of the UNITS that have others
LENGTHS = {"real": "Angstrom", "metal": "Angstrom", "si": "m", "cgs": "cm", "micro": "um", "nano": "nm"}
SCALED, UNWRAPPED = ("xs", "xsu"), ("xu", "xsu")


def read(source):
    """Frames: ITEM sections until ITEM: ATOMS, which ends one."""
    lines = Lines(source.path, source.report)
    step = time = count = box = None
    index, unit, header, columns = 0, 1.0, None, None

    def fail(what):
        source.fail(what, f":{lines.number}")

    def value(kind=None):
        line = lines.next()
        if line is None:
            fail("the dump ends here; remove the last frame if it is cut short")
        found = line if kind is None else kind(line)
        if found is None or (kind is whole and found < 0):
            fail(f'"{shown(line)}": expected a {"whole number, not below 0" if kind is whole else "number"}')
        return found

    def cut_short(k):
        fail(f"step {step} has {k} of its {count} atoms: is the dump cut short? Remove this frame")

    while (line := lines.next()) is not None:
        if not line:
            continue
        if not line.startswith(b"ITEM:"):
            fail(f'"{shown(line)}": expected a line that begins with ITEM:; has something been added to the dump?')
        name, *words = line[5:].split() or [b""]
        if name == b"TIMESTEP":
            step = value(whole)
        elif name == b"TIME":
            time = value(number) * unit
        elif name == b"UNITS":
            units = shown(value())
            unit, source.length_unit = SECONDS.get(units, 1.0), LENGTHS.get(units, units)
        elif name == b"NUMBER":
            count = value(whole)
        elif name == b"BOX":
            box = read_box(source, fail, value, words, lines)
        elif name == b"ATOMS":
            if step is None or count is None:
                fail(f"ITEM: ATOMS without ITEM: {'TIMESTEP' if step is None else 'NUMBER OF ATOMS'} before it")
            if count * 2 <= lines.size and index == 0:
                source.expect_rows(1, count)
            if source.past(index):
                return
            if not source.wanted(index):
                lines.skip(count, cut_short)
            else:
                if words != header:
                    header, columns = words, find_columns(source, fail, words)
                yield read_atoms(source, lines, fail, cut_short, columns, Frame(index, step, time, box, None), count)
            if index == 0 and count:  # the rest of a large file is probably like the first frame
                source.expect_rows(int(0.8 * lines.size / max(1, lines.used())), count, "about ")
            step = time = count = box = None
            index += 1
        else:
            fail(f"ITEM: {shown(name)}: expected a dump of atoms (ITEM: TIMESTEP, NUMBER OF ATOMS, BOX BOUNDS, ATOMS)")
    if step is not None or count is not None:
        fail("the last frame is cut short; remove its lines from the end of the dump")


def read_box(source, fail, value, words, lines):
    """BOUNDS [xy xz yz | abc origin] pp pp ff, and a line for each axis: low, high and a tilt, or a whole vector and the origin."""
    flags = [word for word in words if len(word) == 2 and not word.strip(b"pfsm")]
    periodic = [flag == b"pp" for flag in flags[:3]] + [True] * (3 - len(flags[:3]))  # without flags, as in old dumps, it is
    whole_vectors, tilted = b"abc" in words, b"xy" in words
    rows = []
    for _ in range(3):
        line = value()
        if line.startswith(b"ITEM:"):
            fail("expected the bounds of the box, low and high, for x, y and z")
        row = [number(word) for word in line.split()]
        if None in row or len(row) < 2:
            fail(f'"{shown(line if len(row) != 1 else b"")}": expected a number')
        if whole_vectors and len(row) != 4 or not whole_vectors and len(row) > 3 or tilted and len(row) != 3:
            fail(f'"{shown(line)}": expected {4 if whole_vectors else 3 if tilted else 2} numbers')
        rows.append(row + [0.0] * (3 - len(row)))
    where = f":{lines.number}"
    if whole_vectors:
        return box_of(source, where, [row[3] for row in rows], [row[:3] for row in rows], periodic)
    low, high, tilt = zip(*rows)
    return box_of_bounds(source, where, low, high, tilt, periodic)


def find_columns(source, fail, words):
    """Which word of an atom's line is what: a dictionary of names of quantities."""
    names, given = [word.decode("utf-8", "surrogateescape") for word in words], source.options.columns

    def bad(what, key):
        fail(f'{what}; the dump has {", ".join(map(shown, names))}; name it in tracks.columns = {{ {key} = "..." }}')

    def named(key, *usual):
        if key in given:
            if given[key] not in names:
                bad(f'no column "{given[key]}"', key)
            return given[key]
        return next((name for name in usual if name in names), None)

    unwrapped = [x for x in UNWRAPPED if x in names and x.replace("x", "y") in names]
    wrapped = [x for x in ("x", "xs") if x in names and x.replace("x", "y") in names]
    # Positions that are unwrapped, or can be, tell more than those in the box.
    order = wrapped + unwrapped if "ix" in names and "iy" in names else unwrapped + wrapped
    x = named("x", *order)
    y = named("y", *([x.replace("x", "y")] if x in order else []))
    if x is None or y is None:
        bad("no columns x and y, xu and yu, or xs and ys", "x")
    found = {"id": named("id", "id"), "x": x, "y": y, "z": x.replace("x", "z") if x.startswith("x") else None,
             "heading": named("heading", "theta", "heading"), "kind": named("kind", "kind", *["type", "element"] * bool(source.options.rod_kind)),
             "type": "type", "element": "element", "radius": "radius", "diameter": "diameter"}
    for name in ("ix", "iy", "iz", "quatw", "quati", "quatj", "quatk"):
        found[name] = name
    found = {key: names.index(name) for key, name in found.items() if name in names}
    found["width"], found["names"] = len(names), names
    found["last"] = max(found[key] for key in ("id", "x", "y", "heading", "kind") if key in found)
    return found


def read_atoms(source, lines, fail, cut_short, columns, frame, count):
    names, start = columns["names"], lines.number + 1

    def wrong_length(length):
        last = columns["last"] if length <= columns["last"] else min(length, columns["width"] - 1)
        if length < columns["width"]:
            return f'has {length} words, and column "{shown(names[last])}" would be number {last + 1}: is the line cut short?'
        return f"has {length} words, and the dump has {columns['width']} columns" if length > columns["width"] else None

    kinds = {"id": whole, "ix": whole, "iy": whole, "iz": whole, "kind": None, "element": None, "type": None}
    asked = [key for key in columns if key not in ("width", "names", "last")]
    found = dict(zip(asked, lines.table(count, [(columns[key], shown(names[columns[key]]), kinds.get(key, number)) for key in asked],
                                        wrong_length, cut_short)))
    zero = np.zeros(count)
    position = np.column_stack([found["x"], found["y"], found.get("z", zero)])
    x = names[columns["x"]]
    if x in SCALED:
        if frame.box is None:
            fail("scaled positions (xs, ys) need a box; dump x and y")
        position = frame.box.origin + position @ frame.box.edges
    part = Part(position, found.get("id", np.full(count, UNTRACKED)))
    if x in UNWRAPPED:
        part.image = np.zeros((count, 3), np.int32)
    elif "ix" in found and "iy" in found:
        part.image = np.column_stack([found["ix"], found["iy"], found.get("iz", zero.astype(int))])
    if "quatw" in found and "quatk" in found and "heading" not in found:
        part.orientation = np.column_stack([found.get(name, zero) for name in ("quatw", "quati", "quatj", "quatk")])
    elif "heading" in found:
        part.orientation = turned(found["heading"])
    part.radius = found["radius"] if "radius" in found else 0.5 * found["diameter"] if "diameter" in found else None
    words = found.get("element") or found.get("type") or found.get("kind")
    if words:
        part.species = source.species_of(words)
    if "kind" in found:
        rods = {word: source.names_rod(word.decode("utf-8", "surrogateescape")) for word in set(found["kind"])}
        frame.is_rod = np.array([rods[word] for word in found["kind"]], bool)
    frame.beads, frame.place = part, lambda k: f":{start + k}"
    return frame


class Writer:
    """A dump that LAMMPS and OVITO read: atoms by their types, unwrapped by image indices where these are known."""
    loses = "names of types"

    def __init__(self, source, target):
        self.file = open(target, "wb")

    def add(self, frame, part, is_rod):
        box, n = frame.box, len(part)
        text = [f"ITEM: TIME\n{frame.time!r}\n"] if frame.time is not None else []
        text.append(f"ITEM: TIMESTEP\n{frame.step}\nITEM: NUMBER OF ATOMS\n{n}\n")
        if box is not None:
            flags = " ".join("pp" if flag else "ff" for flag in box.periodic)
            if box.upright:
                rows = [f"{low!r} {low + side!r}\n" for low, side in zip(box.origin.tolist(), np.diag(box.edges).tolist())]
                text.append(f"ITEM: BOX BOUNDS {flags}\n" + "".join(rows))
            else:
                rows = [" ".join(map(repr, (*edge, low))) + "\n" for edge, low in zip(box.edges.tolist(), box.origin.tolist())]
                text.append(f"ITEM: BOX BOUNDS abc origin {flags}\n" + "".join(rows))
        columns = {"id": part.ids if part.ids is not None and not (part.ids == UNTRACKED).all() else None,
                   "type": part.species if part.species is not None else np.zeros(n, int), "x y z": part.position,
                   "ix iy iz": part.image, "radius": part.radius, "quatw quati quatj quatk": part.orientation}
        columns = {name: values for name, values in columns.items() if values is not None}
        text.append(f"ITEM: ATOMS {' '.join(columns)}\n")
        self.file.write("".join(text).encode() + rows_of_text(columns.values()))

    def close(self):
        self.file.close()
