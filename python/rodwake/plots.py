"""Figures of a run as matplotlib figures, as `rodwake plot` draws them: save them with savefig or show them in a notebook."""

from __future__ import annotations

import contextlib
import dataclasses
import importlib
import math
import sys
from pathlib import Path
from typing import Any, Callable, Iterator, Sequence, Union

from . import arguments, shipped
from .equilibria import PairBranch
from .errors import Error, InputError, RunError
from .fitting import FitResult
from .reading import reading
from .runs import Run, open_run
from .scenes import Folder

def kinds() -> list[str]:
    """Kinds of figures that `draw` takes: 'trajectories', 'cut', 'snapshot', 'phase_diagram', ... (docs/figures.md)."""
    return [kind for kind, module in _plots("draw").KINDS.items() if module.draw]


def draw(run: Union[Run, Folder], kind: str, *, width: str = "", style: str = "", font_size: Union[float, str] = "", overlay: bool = False,
         **options: Any) -> Any:
    """One figure of a run. Options are keys of [[figures]]: draw(run, "cut", cut=0, component="Uy", title="The wake"); width, style,
    font_size and overlay are those of `rodwake plot`."""
    arguments.kind("kind", kind, str, "a kind of figure")
    known = list(_plots("schema").Spec.__dataclass_fields__)
    for option in options:
        if option not in known:
            raise InputError(f"figure {kind!r}: unknown option {option!r} (known: {', '.join(known)})")
    with _telling(InputError):
        look = _plots("style").look(width, style, str(font_size))
        figure = _plots("schema").from_scene({"figures": [{"name": kind, "kind": kind, **options}]})[0]
    if not _plots("draw").KINDS[kind].draw:
        raise InputError(f"kind {kind!r} is written to a file, not drawn: rodwake plot does it")
    with _opened(run) as folder:
        return _drawn(folder, dataclasses.replace(figure, overlay=overlay), look)


def figures(run: Union[Run, Folder], *, width: str = "", style: str = "", font_size: Union[float, str] = "",
            overlay: bool = False) -> dict[str, Any]:
    """Figures of a run by name: those that the scene lists, or else one for each result of the run. Films are left out."""
    with _telling(InputError):
        look, drawable = _plots("style").look(width, style, str(font_size)), kinds()
    with _opened(run) as folder:
        found: dict[str, Any] = {}
        missing = []
        for one in _plots("draw").figures_of(folder, overlay=overlay):
            try:
                found |= {one.name: _drawn(folder, one, look)} if one.kind in drawable else {}
            except _plots("errors").MissingError as error:
                if folder.has_lost(error.file):
                    raise
                missing.append(error)
        if missing and not found:
            raise missing[0]
        return found


def correlation(found: FitResult, title: str = "") -> Any:
    """Correlations of the fitted parameters. For a fit in a run folder use draw(run, "fit_correlation")."""
    matrix = found.correlation.copy()
    lacking = [not math.isfinite(found.parameters[name].standard_error) for name in found.free]
    matrix[lacking, :] = matrix[:, lacking] = math.nan
    return _plots("draw").in_style(_plots("fit_errors").of_matrix, found.free, matrix, title)


def branches(found: Sequence[PairBranch], title: str = "") -> Any:
    """Distance and turning rate along branches of `pair_branches`. Dashed lines are unstable, dots are folds."""
    if not found:
        raise InputError("branches: there are none to draw")
    return _plots("draw").in_style(_plots("pair_branches").of_branches, found, title)


def _plots(module: str) -> Any:
    """A module of the plotting package."""
    place = str(shipped.folder("plots"))
    if place not in sys.path:
        sys.path.append(place)
    return importlib.import_module(f"rodwake_plots.{module}")


@contextlib.contextmanager
def _opened(run: Union[Run, Folder]) -> Iterator[Any]:
    opened = run if isinstance(run, Run) else open_run(run)
    if opened.is_part:
        raise InputError(f"{opened.folder}: a part of a run; figures are drawn of the whole, rodwake.open_run({str(opened.whole)!r})")
    with reading(opened.folder, "run"):
        with _telling(RunError):
            entered = _plots("run_dir").RunDir(opened.folder)
        with entered as folder:
            try:
                yield folder
            except _plots("errors").PlotError as error:
                _read_all(opened)
                lost = isinstance(error, _plots("errors").MissingError) and folder.has_lost(error.file)
                raise (RunError if lost else InputError)(str(error)) from error


@contextlib.contextmanager
def _telling(kind: type[Error]) -> Iterator[None]:
    try:
        yield
    except _plots("errors").PlotError as error:
        raise kind(str(error)) from error


def _read_all(run: Run) -> None:
    """Raises RunError if a file of the run is damaged: the plots report that as they report a figure that the run has no data for."""
    readers: dict[str, Callable[[str], Any]] = {".json": run.json, ".csv": run.table, ".h5": run.datasets, ".h5md": run.datasets}
    for name in run.files:
        path = run.folder / name
        if path.suffix in readers and path.is_file():
            readers[path.suffix](name)


def _drawn(folder: Any, figure: Any, look: Any) -> Any:
    kind = _plots("draw").KINDS[figure.kind]
    return _plots("draw").in_style(lambda: _plots("draw").dressed(kind.draw(folder, figure), look), look=look)
