"""What [[figures]] of the scene asks for."""

import re
from dataclasses import dataclass, field, replace

from . import measured, series
from .errors import PlotError

KINDS = ("extensional_axis", "polar_streamlines", "cut", "trajectories",
         "snapshot", "rod_tracks", "side_view", "movie", "granular_table", "pair_correlation", "bond_order", "msd", "series",
         "flow", "dragged", "profile", "displacement_map", "pair_tracks",
         "fit", "fit_starts", "fit_likelihood", "fit_correlation", "fit_trajectories")
COLOURS = ("order", "orientation")
AGAINST, QUANTITIES = measured.AGAINST, series.QUANTITIES
DEFAULT_GAMMAS = ((1.0, 0.0), (0.0, 1.0), (1.0, -1.0))


@dataclass(frozen=True)
class Spec:
    name: str
    kind: str
    title: str = ""
    cut: int = 0
    component: str = "Ux"    # displacement_map: also "U", the size
    sqrt_scaled: bool = False
    along: str = "x"         # profile
    quantity: str = "psi6"   # series: what
    against: str = "phi_b"   # series: against what
    gammas: tuple = field(default=DEFAULT_GAMMAS)
    frame: int = -1          # snapshot: from 0, or from the end
    colour: str = "order"    # snapshot, movie: what colours the beads
    fps: int = 20            # movie
    profiles: tuple = ()     # fit: which, from 0; empty: all
    residuals: bool = True   # fit: below each panel
    parameter: str = ""      # fit_likelihood: whose; empty: the first
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
    known.setdefault("component", "U" if kind == "displacement_map" else "Ux")
    spec = Spec(**known)
    if spec.component not in ("Ux", "Uy") and (spec.component, kind) != ("U", "displacement_map"):
        raise PlotError(f'figure "{name}": component "{spec.component}" is neither "Ux" nor "Uy"')
    _check_granular(spec)
    _check_measured(spec)
    return _checked_fit(spec)


def _check_granular(spec):
    if spec.colour not in COLOURS:
        raise PlotError(f'figure "{spec.name}": colour "{spec.colour}" is neither "order" nor "orientation"')
    for key, least in (("frame", None), ("fps", 1)):
        value = getattr(spec, key)
        if not isinstance(value, int) or isinstance(value, bool) or (least is not None and value < least):
            raise PlotError(f'figure "{spec.name}": {key} = {value} is not a whole number{"" if least is None else f" from {least}"}')


def _check_measured(spec):
    for key, legal in (("along", ("x", "y")), ("quantity", tuple(QUANTITIES)), ("against", tuple(AGAINST))):
        if getattr(spec, key) not in legal:
            raise PlotError(f'figure "{spec.name}": {key} "{getattr(spec, key)}" is none of {", ".join(legal)}')


def _checked_fit(spec):
    wanted = spec.profiles
    if not isinstance(wanted, (list, tuple)) or not all(isinstance(one, int) and not isinstance(one, bool) for one in wanted):
        raise PlotError(f'figure "{spec.name}": profiles = {wanted} is not a list of whole numbers, which count [[fit.profiles]] from 0')
    if not isinstance(spec.residuals, bool):
        raise PlotError(f'figure "{spec.name}": residuals = {spec.residuals} is neither true nor false')
    return replace(spec, profiles=tuple(wanted))


def _window(name, key, value):
    if value and not (len(value) == 2 and value[0] < value[1]):
        raise PlotError(f'figure "{name}": {key} = {value} is not [min, max]')
    return tuple(value)


def _gammas(name, value):
    if any(len(pair) != 2 for pair in value):
        raise PlotError(f'figure "{name}": each entry of gammas is [gamma1, gamma2]')
    return tuple(tuple(pair) for pair in value) or DEFAULT_GAMMAS
