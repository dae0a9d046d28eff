"""The scene of one point of a scan as text: scene.toml of the run without [scan], with places for the values of the axes."""

import json
import re
import tomllib
from typing import NamedTuple

from . import schema

# Keys that say the same thing: of these a scene has one, and the axis's wins.
ALIKE = (("medium", ("eta", "poisson_ratio", "lame_lambda", "bulk_modulus", "mu")), ("medium", ("xi", "alpha")),
         ("granular", ("phi_b", "beads")))
TOGETHER = {"medium.lame_lambda": "medium.mu", "medium.bulk_modulus": "medium.mu", "medium.mu": None}  # say nothing alone
HEADER = re.compile(r"\s*(\[\[?)\s*([\w.\"-]+)\s*\]\]?\s*(#.*)?")
ENTRY = re.compile(r"\s*(#\s*)?([\w-]+)\s*[=:]")


class Slot(NamedTuple):
    """Where the value of an axis goes, times `factor`; kind: float, integer, word or flag."""
    axis: int
    factor: float
    kind: str


class NoTemplate(Exception):
    """Why the scenes of the points cannot be written."""


def template(text, axes):
    """A list of strings and Slots that together are the scene; NoTemplate if it cannot be."""
    lines = [[line] for line in without_scan(text.splitlines())]
    keys = {key for axis in axes for key in axis.keys}
    for key in keys & set(TOGETHER):
        if TOGETHER[key] not in keys and not (key == "medium.mu" and keys & {"medium.lame_lambda", "medium.bulk_modulus"}):
            raise NoTemplate(f"{key} has no meaning by itself")
    for index, axis in enumerate(axes):
        for key, factor in zip(axis.keys, axis.factors):
            put(lines, key, Slot(index, factor, kind_of(key, axis)), keys)
    return merged(part for line in lines for part in (*line, "\n"))


def without_scan(lines):
    """Nor the figures of the scan, which the scene of a point cannot have."""
    kept, block = [], []
    for line in [*lines, "[end]"]:
        if HEADER.fullmatch(line):
            kept += [] if of_scan(block) else block
            block = []
        block.append(line)
    return kept


def of_scan(block):
    header = block and HEADER.fullmatch(block[0])
    if not header:
        return False
    if header[2] == "figures":
        kinds = [found[1] for line in block for found in [re.match(r'\s*kind\s*=\s*"(\w+)"', line)] if found]
        return any(kind in schema.FIGURES and schema.subject(kind) == "scan" for kind in kinds)
    return header[2] == "scan" or header[2].startswith("scan.")


def tables(lines):
    """(full path with the numbers of list entries, first line, end) of each table; the keys before any table have no path."""
    starts, counts, prefix = [("", -1)], {}, {}
    for number, line in enumerate(lines):
        header = HEADER.fullmatch(line[0]) if isinstance(line[0], str) else None
        if not header:
            continue
        name = header[2]
        parent = max((one for one in prefix if name.startswith(one + ".")), key=len, default="")
        path = prefix[parent] + name[len(parent):] if parent else name
        if header[1] == "[[":
            counts[path] = counts.get(path, -1) + 1
            path = prefix[name] = f"{path}.{counts[path]}"
        starts.append((path, number))
    ends = [number for _, number in starts[1:]] + [len(lines)]
    return [(path, number + 1, end) for (path, number), end in zip(starts, ends)]


def put(lines, key, slot, keys):
    """Sets the key: in its line, in the place of the comment that says it is absent, or in a new line."""
    path, first, end, name, places = home(lines, key)
    if path is None:
        lines += [[""], [f"[{key.rpartition('.')[0]}]"], [f"{name} = ", slot]]
        return
    for alike in alike_of(path, name) - {one.rpartition(".")[2] for one in keys}:
        for number in entries(lines, first, end, alike, comments=False):
            lines[number] = ["# " + alike + ": see the axes of the scan"]
    at = next(iter(entries(lines, first, end, name, comments=True)), None)
    if places:
        if at is None or lines[at][0].lstrip().startswith("#"):
            raise NoTemplate(f"{key}: scene.toml does not give {name}")
        lines[at] = replaced_place(lines[at], places, slot, key)
    elif at is None:
        lines.insert(first, [f"{name} = ", slot])
    else:
        lines[at] = [f"{name} = ", slot]


def home(lines, key):
    """(path, first, end) of the table that has the key, its name in there, and the places in a list; path None: no such table."""
    parts = key.split(".")
    places = []
    while parts and parts[-1].isdigit():
        places.insert(0, int(parts.pop()))
    table, name = ".".join(parts[:-1]), parts[-1]
    for path, first, end in tables(lines):
        if path == table:
            return path, first, end, name, places
    if places or re.search(r"(^|\.)\d+(\.|$)", table):
        raise NoTemplate(f"{key}: scene.toml has no such table")
    return None, 0, 0, name, places


def alike_of(path, name):
    return {one for table, alike in ALIKE if table == path and name in alike for one in alike}


def entries(lines, first, end, name, comments):
    """Numbers of the lines of this key: those that set it, then the comments that say it is absent."""
    found = [(bool(entry[1]), number) for number in range(first, end) if isinstance(lines[number][0], str)
             for entry in [ENTRY.match(lines[number][0])] if entry and entry[2] == name and (comments or not entry[1])]
    return [number for _, number in sorted(found)]


def replaced_place(line, places, slot, key):
    """`position = [0.0, 2.5]` with a slot for one of its numbers; lists in lists are not distinguished."""
    if len(places) != 1 or not isinstance(line[-1], str):
        raise NoTemplate(f"{key}: a position in a list of lists")
    text, slots = "", []
    for part in line:
        if isinstance(part, str):
            text += part
        else:
            text += f"\0{len(slots)}\0"
            slots.append(part)
    found = re.fullmatch(r"(.*?=\s*\[)(.*)(\].*)", text)
    items = re.findall(r'(?:"[^"]*"|[^,"])+', found[2]) if found else []
    if places[0] >= len(items):
        raise NoTemplate(f"{key}: the list in scene.toml is shorter")
    items[places[0]] = f" \0{len(slots)}\0" if places[0] else f"\0{len(slots)}\0"
    slots.append(slot)
    pieces = re.split("\0(\\d+)\0", found[1] + ",".join(items) + found[3])
    return [slots[int(piece)] if number % 2 else piece for number, piece in enumerate(pieces)]


def kind_of(key, axis):
    name = re.sub(r"\.\d+(?=\.|$)", "[]", key)
    table, _, last = name.rstrip("[]").rpartition(".")
    kind = schema.KEYS.get((table, last), {}).get("type")
    if axis.is_choice:
        return "flag" if kind == "boolean" else "word"
    return "integer" if kind == "integer" else "float"


def merged(parts):
    """Neighbouring strings as one."""
    found = []
    for part in parts:
        if isinstance(part, str) and found and isinstance(found[-1], str):
            found[-1] += part
        else:
            found.append(part)
    return found


def filled(parts, values):
    """The scene of one point, as the page writes it: values of the axes in numbers of scan.csv, of choices words."""
    return "".join(part if isinstance(part, str) else written(part, values[part.axis]) for part in parts)


def written(slot, value):
    if slot.kind in ("word", "flag"):
        return json.dumps(value) if slot.kind == "word" else value
    value = value * slot.factor
    return str(round(value)) if slot.kind == "integer" else repr(float(value))


def checked(text, axes, values):
    """The template, after a look whether a scene made from it says what it should."""
    parts = template(text, axes)
    try:
        scene = tomllib.loads(filled(parts, values))
    except tomllib.TOMLDecodeError as error:
        raise NoTemplate(f"the scene of a point would not be valid: {error}") from error
    for axis, value in zip(axes, values):
        for key, factor in zip(axis.keys, axis.factors):
            found = looked_up(scene, key)
            kind = kind_of(key, axis)
            wanted = value == "true" if kind == "flag" else value if kind == "word" else value * factor
            if found != wanted and not (kind == "integer" and found == round(wanted)):
                raise NoTemplate(f"{key} = {found!r} where {wanted!r} was set")
    return parts


def looked_up(scene, key):
    for part in key.split("."):
        try:
            scene = scene[int(part)] if isinstance(scene, list) else scene[part]
        except (KeyError, IndexError, TypeError, ValueError):
            return None
    return scene
