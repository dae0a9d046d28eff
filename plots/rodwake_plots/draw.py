"""Which function draws which kind; drawing all figures of a run."""

import matplotlib

from . import (bond_order, cut, defaults, displacement_map, dragged, extensional_axis, fit, fit_correlation, fit_likelihood, fit_starts,
               fit_trajectories, flow, granular_table, movie, msd, pair_correlation, pair_tracks, polar_streamlines, profile,
               rod_tracks, series, side_view, snapshot, spec, trajectories)
from .canvas import save
from .errors import PlotError
from .style import SETTINGS

KINDS = {"extensional_axis": extensional_axis, "polar_streamlines": polar_streamlines, "cut": cut, "trajectories": trajectories,
         "snapshot": snapshot, "rod_tracks": rod_tracks, "side_view": side_view, "movie": movie, "granular_table": granular_table,
         "pair_correlation": pair_correlation, "bond_order": bond_order, "msd": msd, "series": series, "flow": flow,
         "dragged": dragged, "profile": profile, "displacement_map": displacement_map, "pair_tracks": pair_tracks,
         "fit": fit, "fit_starts": fit_starts, "fit_likelihood": fit_likelihood, "fit_correlation": fit_correlation,
         "fit_trajectories": fit_trajectories}


def figures_of(run):
    asked = spec.from_scene(run.scene)
    return asked + defaults.fit_besides(run, asked) if asked else defaults.of(run)


def write_all(run, figures, pdf):
    run.figures_dir.mkdir(exist_ok=True)
    for figure in figures:
        try:
            write_one(run, figure, (".png", ".pdf") if pdf else (".png",))
        except PlotError as error:
            raise PlotError(f'figure "{figure.name}": {error}') from error


def write_one(run, figure, endings):
    with matplotlib.rc_context(SETTINGS):
        if figure.kind == "movie":
            print(*movie.write(run, figure), sep="\n")
            return
        made = KINDS[figure.kind].draw(run, figure)
        for ending in endings:
            path = run.figures_dir / (figure.name + ending)
            save(made, path)
            print(path)


def caption(run, figure):
    return KINDS[figure.kind].caption(run, figure)


def png(run, figure):
    path = run.figures_dir / f"{figure.name}.png"
    if not path.is_file():
        raise PlotError(f"{path}: not drawn yet; run without --report-only first")
    return path.read_bytes()
