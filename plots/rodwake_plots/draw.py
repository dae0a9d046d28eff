"""Which module draws which kind of figure of schema.json; drawing all figures of a run."""

from dataclasses import replace

from . import bead_motion, bead_order, bed, canvas, critical, displacement, errors, field, fit, fit_errors, fit_models, fit_tracks, flow, granular_table, medium_film, movie
from . import page, phase_diagram, posterior, rod_tracks, rods_statistics, scan_curve, schema, series, trajectories
from .bed_run import TRAJECTORY
from .canvas import save
from .errors import MissingError, PlotError, attempt, reason
from .medium_film import FILE as MEDIUM_FRAMES
from .style import Look, SETTINGS, applied

FILM = "film"  # name of the figure that --film adds
FILMS = "movie", "medium_film", "rods_movie"

MODULES = (bead_motion, bead_order, bed, critical, displacement, field, fit, fit_errors, fit_models, fit_tracks, flow, granular_table, medium_film, movie, phase_diagram,
           posterior, rod_tracks, rods_statistics, scan_curve, series, trajectories)
MADE = {kind: made for module in MODULES for kind, made in module.KINDS.items()}
KINDS = {kind: MADE[kind] for kind in schema.FIGURES}  # in the order of reports


def figures_of(run, film=False, overlay=False):
    """As the scene asks, or all there is to draw; a film that was made on request stays in the report."""
    asked = schema.from_scene(run.scene)
    found = [replace(one, overlay=overlay) for one in (asked + besides(run, asked) if asked else defaults(run))]
    there = run.figures_dir / f"{FILM}.png"
    return found + filmed(run, found) if film or there.is_file() else found


def filmed(run, found):
    """A film of the beads, of the medium or of the rods, whichever there are frames of first."""
    if FILM in (one.name for one in found) or any(one.kind in FILMS for one in found):
        return []
    if (run.path / MEDIUM_FRAMES).is_file():
        return [schema.Spec(FILM, "medium_film")]
    beads = run.has_granular and run.granular.has(TRAJECTORY)
    if not beads and not (run.has_result and run.result.has("/rods")):
        raise PlotError(f"{run.path}: holds neither frames of beads (granular.output.formats = [\"h5md\"]) nor paths of rods to film")
    return [schema.Spec(FILM, "movie" if beads else "rods_movie")]


def defaults(run):
    """A figure for everything the run directory holds."""
    there = {"bed": run.has_granular, "measure": run.has_granular or run.has_tracks, "theory": run.has_result, "rod_order": run.rods_order is not None,
             "fit": run.has_fit, "scan": run.has_scan}
    specs = [one for kind in KINDS if there[schema.subject(kind)] or kind == "snapshot" and run.has_tracks for one in all_of(kind, run)]
    if not specs:
        raise PlotError(f"{run.path}: holds no rods, no field, no cuts, no fit, no scan and no tables or trajectories of beads: nothing to draw")
    return specs


def all_of(kind, run):
    """If the data cannot be listed, one figure, which says why when it is drawn."""
    made = KINDS[kind]
    one = schema.Spec(kind, kind, **schema.OF_KIND.get(kind, {}))
    found, error = attempt(made.defaults or (lambda run: [one] if made.there(run) else []), run)
    return [one] if error else [replace(each, name=schema.file_name(each.name)) for each in found]


def besides(run, asked):
    """What to add to figures asked for, none of which shows the fit or the scan that was made: data and fit, phase diagram."""
    shown, taken = {schema.subject(one.kind) for one in asked}, {one.name for one in asked}
    kinds = (["fit", "fit_map", "fit_trajectories"] if run.has_fit and "fit" not in shown else []) + (
        ["critical_values", "phase_diagram", "scan_curve"] if run.has_scan and "scan" not in shown else [])
    ends = {"fit": "to_data", "scan": "of_scan"}
    return [replace(one, name=f"{one.name}_{ends[schema.subject(kind)]}") if one.name in taken else one
            for kind in kinds for one in first(all_of(kind, run), kind)]


def first(specs, kind):
    """Of a phase diagram the outcomes are enough."""
    return specs[:1] if schema.subject(kind) == "scan" else specs


def write_all(run, figures, pdf, look=Look(SETTINGS)):
    """[(figure, "" or why it could not be drawn)]; beside figures that are drawn, one without data is left out, with a message."""
    endings = (".png", ".pdf") if pdf else (".png",)
    tried = [(one, attempt(write_one, run, one, endings, look)[1]) for one in figures]
    left_out = [one for one, error in tried if isinstance(error, MissingError) and not run.has_lost(error.file)]
    if all(error for _, error in tried):
        left_out = []
    shown = [(one, reason(error) if error else "") for one, error in tried]
    for one, why in shown:
        if one in left_out:
            errors.say(f'left out: figure "{one.name}": {why}')
    return [(one, why) for one, why in shown if one not in left_out]


def write_one(run, figure, endings, look):
    kind = KINDS[figure.kind]
    if kind.write:
        print(*kind.write(run, figure), sep="\n")
        return
    made = dressed(kind.draw(run, figure), look)
    marks = list(kind.hover_marks(run, figure, made)) if kind.hover_marks else []
    metadata = page.hover_metadata(page.hover_places(made, marks, made.bbox_inches))
    for ending in endings:
        path = run.figures_dir / (figure.name + ending)
        save(made, path, metadata if ending == ".png" else None, settled=True)
        print(path)


def dressed(made, look):
    """The figure with text and width as asked for."""
    if look.enlarged != 1.0:
        canvas.enlarge(made, look.enlarged)
    canvas.settle(made, canvas.fit_width(made, look.width) if look.width else None)
    return made


def in_style(write, *arguments, look=Look(SETTINGS)):
    """What does not stand in [[figures]], with the look of what does."""
    with applied(look.settings):
        return write(*arguments)


def caption(run, figure):
    return KINDS[figure.kind].caption(run, figure)


def png(run, figure):
    path = run.figures_dir / f"{figure.name}.png"
    if not path.is_file():
        raise PlotError(f"{path}: not drawn yet; run without --report-only first")
    return path.read_bytes()
