"""Extended XYZ (libAtoms; as ASE and OVITO write it), and XYZ whose second line is a comment."""

import re

import numpy as np

from .errors import shown
from .frames import NO_TIME, UNTRACKED, Frame, Part, box_of, number, turned, whole
from .lines import Lines, rows_of_text

# A value: quoted with \" inside, in braces or brackets, which may be nested, or a word.
VALUE = r'"(?:[^"\\]|\\.)*"|\'[^\']*\'|\{[^{}]*\}|\[(?:[^\[\]]|\[[^\[\]]*\])*\]|[^\s"\'{}\[\]=]+'
PAIR = re.compile(rf'(?P<key>"(?:[^"\\]|\\.)*"|[^\s"\'=]+)(?:\s*=\s*(?P<value>{VALUE})?)?|\S')
PLAIN = re.compile(r"\s*[A-Za-z_]\w*\s*=\s*[^\s=,;\"']+(\s+[A-Za-z_]\w*\s*=\s*[^\s=,;\"']+)*\s*")
EXTENDED = re.compile(r"(?:^|\s)(?:Properties|Lattice)\s*=", re.IGNORECASE)


def keys_of(line):
    """(keys in lower case, whether the line is one of extended XYZ). Prose has no keys."""
    text = line.decode("utf-8", "surrogateescape")
    extended = bool(EXTENDED.search(text))
    if not extended and not PLAIN.fullmatch(text):
        return {}, False
    keys = {}
    for pair in PAIR.finditer(text):
        if pair["key"]:
            value = pair["value"]
            if value and value[0] in "\"'{[":
                value = value[1:-1].replace('\\"', '"') if value[0] in "\"'" else value
            keys.setdefault(pair["key"].strip('"').lower(), "T" if value is None else value)
    return keys, extended


def words_in(value):
    """Of "1 0 0 ...", {1 0 0 ...}, [1, 0, 0, ...] or [[1, 0, 0], ...]."""
    return [word.encode("utf-8", "surrogateescape") for word in re.sub(r"[\[\]{}(),]", " ", value).split()]


def read(source):
    lines = Lines(source.path, source.report)
    index, has_steps, properties, columns = 0, None, None, None

    def fail(what):
        source.fail(what, f":{lines.number}")

    def cut_short(k):
        fail(f"frame {index + 1} has {k} of its {count} particles: is the file cut short? Remove the frame")

    while (line := lines.next()) is not None:
        if not line:
            continue
        count = whole(line)
        if count is None or count < 0:
            fail(f'"{shown(line)}": expected the number of particles of the next frame')
        if count * 2 <= lines.size and index == 0:
            source.expect_rows(1, count)
        if source.past(index):
            return
        second = lines.next()
        if second is not None and len(second) > 1 << 20:
            fail("the second line of the frame is longer than 1 MB: is this a file of text?")
        if second is None:
            fail("a frame without its second line: is the file cut short?")
        if not source.wanted(index):
            lines.skip(count, cut_short)
            index += 1
            continue
        keys, extended = keys_of(second)
        step = first_of(keys, "step", "timestep", "frame")
        value = None if step is None else whole(step.encode("utf-8", "surrogateescape"))
        if step is not None and value is None and extended:
            fail(f"Step={shown(step)}: expected a whole number")
        if has_steps not in (None, value is not None):
            fail(f"frame {index + 1} has {'no ' if value is None else 'a '}Step, unlike those before")
        has_steps = value is not None
        time = time_of(source, fail, keys, extended, second)
        if time is None and source.options.needs_times:
            fail(NO_TIME)
        text = keys.get("properties", "species:S:1:pos:R:3")
        if text != properties:
            properties, columns = text, find_columns(source, fail, text, "properties" not in keys)
        frame = Frame(index, index if value is None else value, time, read_lattice(source, fail, keys, f":{lines.number}"), None)
        yield read_particles(source, lines, cut_short, columns, frame, count)
        if index == 0 and count:
            source.expect_rows(int(0.8 * lines.size / max(1, lines.used())), count, "about ")
        index += 1


def first_of(keys, *names):
    return next((keys[name] for name in names if name in keys), None)


def time_of(source, fail, keys, extended, second):
    """The user's key is looked for in prose, too."""
    given = source.options.time_column
    text = keys.get(given.lower()) if given else first_of(keys, "time")
    if given and text is None:
        found = re.search(rf"(?:^|[\s,;]){re.escape(given)}\s*=\s*([^\s,;]+)", second.decode("utf-8", "surrogateescape"))
        text = found and found[1]
        if text is None:
            fail(f"no {shown(given)}= (tracks.time_column) in the second line of the frame; it has {', '.join(map(shown, keys)) or 'no keys'}")
    value = None if text is None else number(text.encode("utf-8", "surrogateescape"))
    if text is not None and value is None and (given or extended):
        fail(f"Time={shown(text)}: expected a number")
    return value


def read_lattice(source, fail, keys, where):
    """Periodic, as the format has it, unless pbc says otherwise."""
    if "lattice" not in keys:
        return None
    text = keys["lattice"], keys.get("pbc"), keys.get("origin")
    if source.last_text[0] == text:  # most are as in the frame before
        return source.last_text[1]
    edges = [number(word) for word in words_in(keys["lattice"])]
    if len(edges) != 9 or None in edges:
        fail(f'Lattice="{shown(keys["lattice"])}": expected nine numbers')
    flags = words_in(keys.get("pbc", "T T T"))
    if not 2 <= len(flags) <= 3 or any(flag.upper() not in (b"T", b"F", b"TRUE", b"FALSE", b"1", b"0") for flag in flags):
        fail(f'pbc="{shown(keys["pbc"])}": expected T or F for x, y and z')
    periodic = [flag[:1] in b"Tt1" for flag in flags] + [False] * (3 - len(flags))
    origin = [number(word) for word in words_in(keys.get("origin", "0 0 0"))]
    if len(origin) != 3 or None in origin:
        fail(f'Origin="{shown(keys["origin"])}": expected three numbers')
    source.last_text = text, box_of(source, where, origin, edges, periodic)
    return source.last_text[1]


def find_columns(source, fail, text, plain):
    """Properties are name:type:number of words; a dictionary of quantities and the words they begin with."""
    parts, at, width, given = text.split(":") if text else [], {}, 0, source.options.columns
    place = given.get("x", "pos")
    for name, kind, count in zip(parts[::3], parts[1::3], parts[2::3]):
        size = whole(count.encode("utf-8", "surrogateescape"))
        if not name or len(kind) != 1 or size is None or not 1 <= size <= 1000:
            fail(f"Properties={shown(text)}: expected name:type:number, as species:S:1:pos:R:3")
        if name.lower() == place.lower() and size < 2:
            fail(f"Properties: {shown(name)} has one component; two or three are needed")
        at.setdefault(name.lower(), (width, size))
        width += size
    if len(parts) % 3:
        fail(f"Properties={shown(text)}: expected name:type:number, as species:S:1:pos:R:3")

    def named(key, *usual):
        if key in given and given[key].lower() not in at or key == "x" and place.lower() not in at:
            fail(f'no column "{shown(given.get(key, place))}"; the frame has {", ".join(map(shown, at))}; '
                 f'name it in tracks.columns = {{ {key} = "..." }}')
        return next((at[name] for name in ([given[key].lower()] if key in given else usual) if name in at), None)

    found = {"pos": named("x", "pos"), "id": named("id", "id"), "heading": named("heading", "theta", "heading"),
             "kind": named("kind", "kind", *["type", "species"] * bool(source.options.rod_kind))}
    found.update({name: at.get(name) for name in ("species", "radius", "image", "orientation")})
    sizes = {"image": 3, "orientation": 4}
    found = {name: value for name, value in found.items() if value and value[1] >= sizes.get(name, 1)}
    return found, width, plain, text


def read_particles(source, lines, cut_short, columns, frame, count):
    at, width, plain, properties = columns
    start, kinds = lines.number + 1, {"id": whole, "image": whole, "kind": None, "species": None}
    sizes = {"pos": min(3, at["pos"][1]), "image": 3, "orientation": 4}
    labels = {"pos": ("x", "y", "z")}
    asked = [(name, k) for name in at for k in range(sizes.get(name, 1))]

    def wrong_length(length):
        if length < width or (length > width and not plain):
            return f"has {length} words, expected the {width} of Properties={shown(properties)}"

    table = lines.table(count, [(at[name][0] + k, labels[name][k] if name in labels else name, kinds.get(name, number)) for name, k in asked],
                        wrong_length, cut_short)
    found = {}
    for (name, _), values in zip(asked, table):
        found.setdefault(name, []).append(values)
    position = np.column_stack(found["pos"] + [np.zeros(count)] * (3 - len(found["pos"])))
    part = Part(position, found["id"][0] if "id" in found else np.arange(count))
    source.by_order |= "id" not in found
    if "image" in found:
        part.image = np.column_stack(found["image"])
    if "orientation" in found:  # OVITO puts the real part last
        part.orientation = np.column_stack(found["orientation"][3:] + found["orientation"][:3])
    if "heading" in found:
        part.orientation = turned(found["heading"][0])
    part.radius = found["radius"][0] if "radius" in found else None
    if "species" in found or "kind" in found:
        part.species = source.species_of(found["kind" if "kind" in found else "species"][0])
    if "kind" in found:
        rods = {word: source.names_rod(word.decode("utf-8", "surrogateescape")) for word in set(found["kind"][0])}
        frame.is_rod = np.array([rods[word] for word in found["kind"][0]], bool)
    frame.beads, frame.place = part, lambda k: f":{start + k}"
    return frame


class Writer:
    loses = "nothing"

    def __init__(self, source, target):
        self.file, self.source = open(target, "wb"), source

    def add(self, frame, part, is_rod):
        names = self.source.type_names or []
        species = (part.species if part.species is not None else np.zeros(len(part), int)).tolist()
        words = {k: re.sub(r"\s", "_", names[k]) or "X" if 0 <= k < len(names) else str(k) for k in set(species)}
        columns = {"species:S:1": [words[k] for k in species], "pos:R:3": part.position}
        if part.ids is not None and not (part.ids == UNTRACKED).all():
            columns["id:I:1"] = part.ids
        for name, values in (("radius:R:1", part.radius), ("image:I:3", part.image),
                             ("orientation:R:4", None if part.orientation is None else part.orientation[:, [1, 2, 3, 0]])):
            if values is not None:
                columns[name] = values
        if is_rod is not None:
            columns["kind:S:1"] = ["rod" if flag else "bead" for flag in is_rod.tolist()]
        keys = [f"Properties={':'.join(columns)}"]
        if frame.box is not None:
            keys.insert(0, f"Lattice=\"{' '.join(map(repr, frame.box.edges.ravel().tolist()))}\"")
            keys.append(f"Origin=\"{' '.join(map(repr, frame.box.origin.tolist()))}\"" if frame.box.origin.any() else "")
            keys.append(f"pbc=\"{' '.join('FT'[flag] for flag in frame.box.periodic)}\"")
        keys += [f"Time={frame.time!r}"] * (frame.time is not None) + [f"Step={frame.step}"]
        self.file.write(f"{len(part)}\n{' '.join(filter(None, keys))}\n".encode() + rows_of_text(columns.values()))

    def close(self):
        self.file.close()
