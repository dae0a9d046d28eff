"""What [[figures]] of the scene asks for, or what a result is drawn as when the scene asks for nothing."""

import re
from dataclasses import dataclass, field

from . import measured, series
from .errors import PlotError
from .granular_run import LAST_PERIOD, SUMMARY, TABLE, TRACKS, TRAJECTORY

KINDS = ("extensional_axis", "polar_streamlines", "cut", "trajectories",
         "snapshot", "rod_tracks", "side_view", "movie", "granular_table", "pair_correlation", "bond_order", "msd", "series",
         "flow", "dragged", "profile", "displacement_map", "pair_tracks")
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
    return spec


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


def _window(name, key, value):
    if value and not (len(value) == 2 and value[0] < value[1]):
        raise PlotError(f'figure "{name}": {key} = {value} is not [min, max]')
    return tuple(value)


def _gammas(name, value):
    if any(len(pair) != 2 for pair in value):
        raise PlotError(f'figure "{name}": each entry of gammas is [gamma1, gamma2]')
    return tuple(tuple(pair) for pair in value) or DEFAULT_GAMMAS


def defaults(run):
    """A figure for everything the run directory holds."""
    specs = granular_defaults(run.granular) + measured_defaults(run) if run.has_granular else []
    specs += result_defaults(run.result) if run.has_result else []
    if not specs:
        raise PlotError(f"{run.path}: holds no rods, no field, no cuts and no tables or trajectories of beads: nothing to draw")
    return specs


def granular_defaults(granular):
    """The film is made only where a scene asks for it: it takes longer than all the rest."""
    kinds = {"snapshot": TRAJECTORY, "rod_tracks": TRACKS, "side_view": LAST_PERIOD, "granular_table": TABLE}
    if not granular.rods:
        del kinds["rod_tracks"]
    return [Spec(kind, kind) for kind, file in kinds.items() if granular.has(file)]


def measured_defaults(run):
    """What [measure] has left in the run directory, on any of its variants."""
    specs = [Spec(kind, kind) for kind, file in (("pair_correlation", "gr.csv"), ("bond_order", "gB.csv"), ("msd", "msd.csv"))
             if _some(run, file)]
    specs += [Spec("flow", "flow")] if _holds(run, "flow") else []
    specs += [Spec("dragged", "dragged")] if _can_show_marked(run) else []
    specs += [Spec("displacement_map", "displacement_map", component="U")] if _holds(run, "displacement") else []
    for component, along in (("Ux", "x"), ("Ux", "y"), ("Uy", "x"), ("Uy", "y")):
        if _some(run, f"profile_{component}_{along}.csv"):
            specs.append(Spec(f"profile_{component}_{along}", "profile", component=component, along=along))
    specs += [Spec("profile_Ux_x_scaled", "profile", sqrt_scaled=True)] if _some(run, "profile_Ux_x.csv") else []
    specs += [Spec("pair_tracks", "pair_tracks")] if _some(run, "pairs.csv") and run.granular.has(TRACKS) else []
    return specs + [Spec(f"series_{what}", "series", quantity=what, against=against) for what, against in series.measured_in(run)]


def _some(run, file):
    return any(part.has(file) for part in measured.parts(run))


def _can_show_marked(run):
    """Frames are not kept of every measured run."""
    marked = [part for part in measured.parts(run) if part.has("marked.csv")]
    return bool(marked) and all(part.has(SUMMARY) and part.granular.has(TRAJECTORY) for part in marked)


def _holds(run, group):
    return any(part.has_group(group) for part in measured.parts(run))


def result_defaults(result):
    specs = []
    if result.has("/rods"):
        specs.append(Spec("trajectories", "trajectories"))
    if result.has("/field/grid"):
        specs += [Spec("extensional_axis", "extensional_axis"), Spec("polar_streamlines", "polar_streamlines")]
    for index in range(result.cut_count()):
        specs += [Spec(f"cut{index}_{part}", "cut", cut=index, component=part) for part in _components(result.cut(index))]
    return specs


def _components(cut):
    """U_y vanishes on the rod's own axis: no figure for a zero line."""
    return ("Ux",) if cut.along == "x" and cut.at == 0 else ("Ux", "Uy")
