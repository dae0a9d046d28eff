"""What [[figures]] of the scene asks for."""

import re
from dataclasses import dataclass, field, replace

from . import schema, words
from .errors import PlotError

BEADS = ("order", "orientation")  # what can colour them
DEFAULT_GAMMAS = ((1.0, 0.0), (0.0, 1.0), (1.0, -1.0))


@dataclass(frozen=True)
class Spec:
    name: str
    kind: str
    title: str = ""
    cut: int = 0
    component: str = "Ux"    # displacement_map: also "U", the size, which it shows unless asked
    sqrt_scaled: bool = False
    along: str = "x"         # profile
    quantity: str = "psi6"   # series: what
    against: str = "phi_b"   # series: against what
    gammas: tuple = field(default=DEFAULT_GAMMAS)
    frame: int = -1          # snapshot: from 0, or from the end
    colour: str = "order"    # snapshot, movie: what colours the beads; phase_diagram: "outcome" or a column
    fps: int = 20            # movie
    profiles: tuple = ()     # fit: which, from 0; empty: all
    residuals: bool = True   # fit: below each panel
    parameter: str = ""      # fit_likelihood: whose; empty: the first
    cells: bool = False      # phase_diagram: outline the cells of the refinement
    boundary: bool = True    # phase_diagram: where it was traced
    slices: tuple = ()       # phase_diagram: values of the third axis; empty: spread over it
    column: str = ""         # scan_curve: what; empty: made from the data
    x: tuple = ()  # window; empty: fit to the data
    y: tuple = ()
    overlay: bool = False  # variants in one panel: asked of all figures, no key of a scene


def from_scene(scene):
    specs = [_spec(table) for table in scene.get("figures", [])]
    names = [spec.name for spec in specs]
    for name in names:
        if names.count(name) > 1:
            raise PlotError(f'figure "{name}": two figures have this name')
    return specs


def file_name(text):
    """As a name that may hold a column or a parameter of a file: it does not lead out of the folder of the figures."""
    return re.sub(r"[^\w.+-]", "_", text)[:100].lstrip(".")


def _spec(table):
    name = table.get("name", "")
    if not isinstance(name, str) or not re.fullmatch(r"[\w+-][\w.+-]*", name):
        raise PlotError(f'figure "{name}": the name must do as a file name')
    kind = table.get("kind", "")
    if kind not in schema.FIGURES:
        raise PlotError(f'figure "{name}": unknown kind "{kind}" (known: {", ".join(schema.FIGURES)})')
    known = {key: table[key] for key in Spec.__dataclass_fields__ if key in table and key != "overlay"}
    for key in ("x", "y"):
        known[key] = _window(name, key, table.get(key, []))
    known["gammas"] = _gammas(name, table.get("gammas", []))
    known.setdefault("component", "U" if kind == "displacement_map" else "Ux")
    known.setdefault("colour", "outcome" if kind == "phase_diagram" else "order")
    for key, value in known.items():
        _check(name, key, value)
    spec = Spec(**known)
    if spec.component == "U" and kind != "displacement_map":
        raise PlotError(f'figure "{name}": component "U" is neither "Ux" nor "Uy"')
    if spec.colour not in BEADS and kind in ("snapshot", "movie"):
        raise PlotError(f'figure "{name}": colour "{spec.colour}" is none of {", ".join(BEADS)}')
    return replace(spec, profiles=tuple(spec.profiles), slices=tuple(spec.slices))


def _check(name, key, value):
    """Against the field list: a scene that was written by hand may hold anything."""
    told = schema.KEYS["figures[]", key]
    least = told.get("range", {}).get("from", 0)
    least = None if least < 0 else least  # frames count from the end too
    if key in ("along", "quantity", "against", "component"):
        wrong = value not in told["choices"] and f'"{value}" is none of {", ".join(told["choices"])}'
    elif told["type"] == "integer":
        wrong = not _is_whole(value) or (least is not None and value < least)
        wrong = wrong and f"= {value} is not a whole number" + ("" if least is None else f" from {least:g}")
    elif told["type"] == "boolean":
        wrong = not isinstance(value, bool) and f"= {value} is neither true nor false"
    elif told["type"].endswith("integers"):
        whole = isinstance(value, (list, tuple)) and all(map(_is_whole, value))
        wrong = not whole and f"= {value} is not a list of whole numbers, which count [[fit.profiles]] from 0"
    elif key == "slices":
        wrong = not (isinstance(value, (list, tuple)) and all(map(words.is_number, value))) and f"= {value} is not a list of numbers"
    elif key in ("colour", "column", "title"):
        wrong = not isinstance(value, str) and f"= {value} is not a {'text' if key == 'title' else 'name'}"
    else:
        return
    if wrong:
        raise PlotError(f'figure "{name}": {key} {wrong}')


def _is_whole(value):
    return isinstance(value, int) and not isinstance(value, bool)


def _window(name, key, value):
    if value and not (len(value) == 2 and value[0] < value[1]):
        raise PlotError(f'figure "{name}": {key} = {value} is not [min, max]')
    return tuple(value)


def _gammas(name, value):
    if any(len(pair) != 2 for pair in value):
        raise PlotError(f'figure "{name}": each entry of gammas is [gamma1, gamma2]')
    return tuple(tuple(pair) for pair in value) or DEFAULT_GAMMAS
