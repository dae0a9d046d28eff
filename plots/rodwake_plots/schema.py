"""What the program says of scenes, schema.json, which `rodwake info --schema` prints; and what [[figures]] of a scene asks for."""

import json
import re
from dataclasses import fields, make_dataclass
from pathlib import Path
from typing import Callable, NamedTuple

from .errors import PlotError

ALL = json.loads(Path(__file__).with_name("schema.json").read_text(encoding="utf-8"))
KEYS = {(one["table"], one["key"]): one for one in ALL["keys"]}
TABLES = {table["table"]: table["meaning"] for table in ALL["tables"]}
FIGURES = {kind["kind"]: kind for kind in ALL["figures"]}  # in the order of reports
FIT_PARAMETERS = {one["name"]: one for one in ALL["fit_parameters"]}
MEASURED = ALL["measures"]  # values of measure.json, in the order of the report
PROFILES_UNIT = "of the profiles"  # unit of lengths in [fit]: whatever the measured files are in
PHYSICS = {one["key"]: one for one in ALL["keys"] if one["table"] in ("medium", "coupling") and "symbol" in one}  # by name alone
COUPLINGS = tuple(key for key, one in PHYSICS.items() if one["table"] == "coupling")
# Where a kind has a default of its own: "Ux; displacement_map: U".
OF_KIND = {kind: {key: value} for (table, key), entry in KEYS.items() if table == "figures[]"
           for kind, value in re.findall(r"; (\w+): (\w+)", entry.get("default", ""))}
BEADS = ("order", "orientation")  # what can colour them


class Kind(NamedTuple):
    """How figures of one kind are made; a kind that writes films has `write` in place of `draw`."""
    caption: Callable  # (run, spec) -> HTML
    draw: Callable = None  # (run, spec) -> figure
    write: Callable = None  # (run, spec) -> paths
    there: Callable = lambda run: False  # whether a run whose scene asks for nothing gets one such figure
    defaults: Callable = None  # or which: run -> Specs
    hover_marks: Callable = None  # (run, spec, figure) -> [(axes, x, y, text)]: values that the report shows at a place


def default_of(entry):
    """Value of a key of [[figures]] that is left out; empty where the figure chooses by its data, which the schema says in words."""
    text = entry.get("default", "").split(";")[0].strip('"')
    if entry["type"] == "string":
        return "" if " " in text else text
    return json.loads(text) if entry["type"] in ("boolean", "integer") else ()


# A figure that is asked for: its keys are those of [[figures]]. `overlay`, variants in one panel, is asked of all figures by the command.
Spec = make_dataclass("Spec", ["name", "kind", *((key, object, default_of(entry)) for (table, key), entry in KEYS.items()
                                                 if table == "figures[]" and not entry["required"]), ("overlay", bool, False)], frozen=True)


def subject(kind):
    """Whose results a figure of this kind shows: bed, measure, theory or fit."""
    return FIGURES[kind]["subject"]


def file_name(text):
    """As a name that may hold a column or a parameter of a file: it does not lead out of the folder of the figures."""
    return re.sub(r"[^\w.+-]", "_", text)[:100].lstrip(".")


def from_scene(scene):
    specs = [spec_of(table) for table in scene.get("figures", [])]
    names = [spec.name for spec in specs]
    for name in names:
        if names.count(name) > 1:
            raise PlotError(f'figure "{name}": two figures have this name')
    return specs


def spec_of(table):
    """A scene that was changed by hand may hold anything; `rodwake check` tells more of it."""
    name, kind = table.get("name", ""), table.get("kind", "")
    if not isinstance(name, str) or not re.fullmatch(r"[\w+-][\w.+-]*", name):
        raise PlotError(f'figure "{name}": the name must do as a file name')
    if kind not in FIGURES:
        raise PlotError(f'figure "{name}": unknown kind "{kind}" (known: {", ".join(FIGURES)})')
    keys = OF_KIND.get(kind, {}) | {one.name: table[one.name] for one in fields(Spec) if one.name in table and one.name != "overlay"}
    for key, value in keys.items():
        if key != "kind" and not allowed(KEYS["figures[]", key], value, kind):
            entry = KEYS["figures[]", key]
            raise PlotError(f'figure "{name}": {key} = {value} cannot be: {entry["type"]} ({entry["legal"]}); {entry["meaning"]}')
    return Spec(**{key: frozen(value) for key, value in keys.items() if value not in ([], ())})


def frozen(value):
    return tuple(map(frozen, value)) if isinstance(value, (list, tuple)) else value


def allowed(entry, value, kind):
    """Whether a key of [[figures]] can have this value."""
    if entry["key"] == "component":
        return value in entry["choices"] and (value != "U" or kind == "displacement_map")
    if entry["key"] == "colour" and kind in ("snapshot", "movie"):
        return value in BEADS
    if entry["key"] == "gammas":
        return isinstance(value, (list, tuple)) and all(is_list_of(pair, float) and len(pair) == 2 for pair in value)
    if entry["key"] in ("x", "y"):
        return is_list_of(value, float) and (not value or len(value) == 2 and value[0] < value[1])
    if "choices" in entry and entry["key"] != "parameter":  # a part of a start may be fitted too
        return value in entry["choices"]
    if entry["type"].endswith(("integers", "numbers")):
        return is_list_of(value, int if entry["type"].endswith("integers") else float)
    if entry["type"] == "integer":
        return is_a(value, int) and (value >= entry["range"]["from"] or entry["key"] == "frame")
    return isinstance(value, {"boolean": bool, "string": str}[entry["type"]])


def is_list_of(value, kind):
    return isinstance(value, (list, tuple)) and all(is_a(one, kind) for one in value)


def is_a(value, kind):
    """A whole number is a number, true is none."""
    return isinstance(value, (int, kind)) and not isinstance(value, bool)
