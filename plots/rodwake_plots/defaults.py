"""What a result is drawn as when the scene asks for nothing, and the fit when it asks for other things."""

from dataclasses import replace

from . import measured, series
from .errors import PlotError
from .granular_run import LAST_PERIOD, SUMMARY, TABLE, TRACKS, TRAJECTORY
from .spec import Spec


def of(run):
    """A figure for everything the run directory holds."""
    specs = granular_defaults(run.granular) + measured_defaults(run) if run.has_granular else []
    specs += result_defaults(run.result) if run.has_result else []
    specs += fit_defaults(run.fit) if run.has_fit else []
    if not specs:
        raise PlotError(f"{run.path}: holds no rods, no field, no cuts, no fit and no tables or trajectories of beads: nothing to draw")
    return specs


def fit_defaults(fit):
    specs = main_of_fit(fit)
    specs += [Spec(f"fit_likelihood_{name}", "fit_likelihood", parameter=name) for name in fit.likelihood]
    specs += [Spec("fit_correlation", "fit_correlation")] if len(fit.free) > 1 else []
    return specs + ([Spec("fit_starts", "fit_starts")] if len(fit.starts) > 1 else [])


def main_of_fit(fit):
    """Data and fit."""
    specs = [Spec("fit", "fit")] if fit.profiles else []
    return specs + ([Spec("fit_trajectories", "fit_trajectories")] if fit.trajectories else [])


def fit_besides(run, asked):
    """What to add to figures asked for, none of which shows the fit that was made."""
    if not run.has_fit or any(spec.kind.startswith("fit") for spec in asked):
        return []
    taken = {spec.name for spec in asked}
    return [replace(spec, name=f"{spec.name}_to_data") if spec.name in taken else spec for spec in main_of_fit(run.fit)]


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
