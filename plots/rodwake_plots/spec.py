"""What [[figures]] of the scene asks for, or what a result is drawn as when the scene asks for nothing."""

import re
from dataclasses import dataclass, field

from .errors import PlotError

KINDS = ("extensional_axis", "polar_streamlines", "cut", "trajectories")
DEFAULT_GAMMAS = ((1.0, 0.0), (0.0, 1.0), (1.0, -1.0))


@dataclass(frozen=True)
class Spec:
    name: str
    kind: str
    title: str = ""
    cut: int = 0
    component: str = "Ux"
    sqrt_scaled: bool = False
    gammas: tuple = field(default=DEFAULT_GAMMAS)
    x: tuple = ()  # window; empty: fit to the data
    y: tuple = ()


def from_scene(scene):
    specs = [_spec(table) for table in scene.get("figures", [])]
    names = [spec.name for spec in specs]
    for name in names:
        if names.count(name) > 1:
            raise PlotError(f'figure "{name}": two figures have this name')
    return specs


def _spec(table):
    name = table.get("name", "")
    if not isinstance(name, str) or not re.fullmatch(r"[\w+-][\w.+-]*", name):
        raise PlotError(f'figure "{name}": the name must do as a file name')
    kind = table.get("kind", "")
    if kind not in KINDS:
        raise PlotError(f'figure "{name}": unknown kind "{kind}" (known: {", ".join(KINDS)})')
    known = {key: table[key] for key in Spec.__dataclass_fields__ if key in table}
    for key in ("x", "y"):
        known[key] = _window(name, key, table.get(key, []))
    known["gammas"] = _gammas(name, table.get("gammas", []))
    spec = Spec(**known)
    if spec.component not in ("Ux", "Uy"):
        raise PlotError(f'figure "{name}": component "{spec.component}" is neither "Ux" nor "Uy"')
    return spec


def _window(name, key, value):
    if value and not (len(value) == 2 and value[0] < value[1]):
        raise PlotError(f'figure "{name}": {key} = {value} is not [min, max]')
    return tuple(value)


def _gammas(name, value):
    if any(len(pair) != 2 for pair in value):
        raise PlotError(f'figure "{name}": each entry of gammas is [gamma1, gamma2]')
    return tuple(tuple(pair) for pair in value) or DEFAULT_GAMMAS


def defaults(result):
    """A figure for everything the result holds."""
    specs = []
    if result.has("/rods"):
        specs.append(Spec("trajectories", "trajectories"))
    if result.has("/field/grid"):
        specs += [Spec("extensional_axis", "extensional_axis"), Spec("polar_streamlines", "polar_streamlines")]
    for index in range(result.cut_count()):
        specs += [Spec(f"cut{index}_{part}", "cut", cut=index, component=part) for part in _components(result.cut(index))]
    if not specs:
        raise PlotError(f"{result.path}: holds no rods, no field grid and no cuts: nothing to draw")
    return specs


def _components(cut):
    """U_y vanishes on the rod's own axis: no figure for a zero line."""
    return ("Ux",) if cut.along == "x" and cut.at == 0 else ("Ux", "Uy")
