"""Scans: the points of a phase diagram, evaluated by threads, by processes or by a cluster."""

from __future__ import annotations

import math
import os
import tempfile
from concurrent.futures import Executor, Future, wait
from functools import lru_cache
from pathlib import Path
from typing import Any, Callable, Iterable, Mapping, Optional, Union

from . import _core, arguments
from .errors import InputError
from .scenes import Folder, Progress, Scene
from .toml import toml

_FLIGHT = 64  # chunks that are handed out at once


def scan(scene: Scene, axes: Optional[Mapping[str, Any]] = None, *, executor: Any = None, folder: Optional[Folder] = None,
         threads: int = 0, chunk: int = 0, progress: Optional[Progress] = None, force: bool = False) -> Any:
    """Evaluates a scene at many values of its keys.

    Dask and process pools import rodwake in their workers, so it must be installed there.

    Parameters
    ----------
    scene : Scene
        Of rods or of a bed.
    axes : mapping, optional
        Values of each key, in all combinations: {"coupling.kappa": [1, 10], "rods.1.position.0": np.linspace(-6, 6, 64)}. Default: the
        [scan] of the scene, of any design.
    executor : optional
        An executor of concurrent.futures or a Dask client. Default: threads of this process. Results do not depend on it.
    folder : path, optional
        Run folder, from which a stopped scan resumes. Default: none is kept.
    threads : int
        Without an executor; 0: one per core.
    chunk : int
        Points per task of an executor; 0: automatic.
    progress : callable, optional
        Called as progress(what, value, end, unit).
    force : bool
        Replace a run in the folder.

    Returns
    -------
    pandas.DataFrame
        One row per point, units in attrs["units"]. Without pandas a NumPy structured array.
    """
    arguments.kind("scene", scene, Scene, "a rodwake.Scene")
    if axes is not None:
        scene = scene.copy().set("scan", {"design": "grid", "axes": _axes(axes)})
    return _table("scan.csv", scene, executor, folder, threads, chunk, progress, force)


def critical(scene: Scene, solve_for: Optional[str] = None, between: Iterable[str] = ("capture", "escape"), *,
             limits: Optional[tuple[float, float]] = None, axes: Optional[Mapping[str, Any]] = None, spacing: str = "linear", count: int = 20,
             tolerance: float = 1e-8, executor: Any = None, folder: Optional[Folder] = None, threads: int = 0,
             progress: Optional[Progress] = None, force: bool = False) -> Any:
    """Critical values of a key: where the end of an encounter changes. A row a value, as of `critical.csv`.

    solve_for  the key, "coupling.kappa". None: the [scan] of the scene, whose design is "critical"
    between    two outcomes or groups of them ("capture", "other"), or ("any",) for every change of outcome
    limits     the range in which values are sought, (from, to)
    axes       values of other keys, as of `scan`: critical values are sought for every combination
    spacing    of the coarse pass, "linear" or "log", and
    count      how many values it has
    tolerance  relative, of the value

    executor, folder, threads, progress and force are as of `scan`. Example: critical kappa against alpha,

        rodwake.critical(scene, "coupling.kappa", ("capture", "escape"), limits=(1, 120), axes={"medium.alpha": np.geomspace(0.1, 20, 30)})
    """
    arguments.kind("scene", scene, Scene, "a rodwake.Scene")
    between = (between,) if isinstance(between, str) else tuple(between)
    if solve_for is None and (limits is not None or axes is not None or (between, spacing, count, tolerance) != (("capture", "escape"), "linear", 20, 1e-8)):
        raise InputError("solve_for: give the name of the key; without it the [scan] of the scene is taken as it stands")
    if solve_for is not None:
        if limits is None:
            raise InputError("limits: give the range of the key, such as limits=(1.0, 120.0)")
        table = {"design": "critical", "solve_for": arguments.kind("solve_for", solve_for, str, "the name of a key"),
                 "from": limits[0], "to": limits[1], "between": list(between), "spacing": spacing, "count": count, "tolerance": tolerance}
        scene = scene.copy().set("scan", table if axes is None else {**table, "axes": _axes(axes)})
    return _table("critical.csv", scene, executor, folder, threads, 0, progress, force)


def _table(name: str, scene: Scene, executor: Any, folder: Optional[Folder], threads: int, chunk: int, progress: Optional[Progress],
           force: bool) -> Any:
    if executor is not None and not (hasattr(executor, "submit") or hasattr(executor, "get_executor")):
        raise TypeError(f"executor: expected one of concurrent.futures or a Dask client, not {type(executor).__name__}")
    arguments.whole("chunk", chunk, 0)
    with tempfile.TemporaryDirectory(prefix="rodwake-") as unkept:
        place = Path(unkept if folder is None else arguments.path("folder", folder)).resolve()
        execute = None if executor is None else _distributor(scene, place, executor, chunk)
        return scene._run(place, ["scan"], threads, None, force, progress, execute).table(name)


def _axes(axes: Any) -> list[dict[str, Any]]:
    """As [[scan.axes]] has them."""
    return [_axis(key, values) for key, values in arguments.kind("axes", axes, Mapping, "a mapping of keys and their values").items()]


def _axis(key: Any, values: Any) -> dict[str, Any]:
    arguments.kind("axes", key, str, "names of keys")
    wanted = f"axes[{key!r}] = {arguments.shown(values)}: expected a list of values"
    if isinstance(values, (str, bytes, Mapping)) or not isinstance(values, Iterable):
        raise InputError(wanted)
    try:
        listed = list(values)
        toml(listed, key)
    except (TypeError, InputError) as error:
        raise InputError(f"{wanted}: {error}") from error
    return {"key": key, "values": listed}


def _distributor(scene: Scene, folder: Path, executor: Any, chunk: int) -> Callable[..., None]:
    """What hands points out: execute(points, take, stopped), records as bytes."""
    pool: Executor = executor.get_executor() if hasattr(executor, "get_executor") else executor  # Dask's client has one
    if not callable(getattr(pool, "submit", None)):
        raise InputError(f"executor is {executor!r}: expected one of concurrent.futures, or a Dask client")
    source = (scene.to_toml(), scene.path, str(folder))

    def execute(points: bytes, take: Callable[[bytes], None], stopped: Callable[[], bool]) -> None:
        count = len(points) // _core.point_size
        size = (chunk or min(1000, max(1, math.ceil(count / _FLIGHT)))) * _core.point_size
        waiting = [points[at:at + size] for at in range(0, len(points), size)][::-1]
        flying: set[Future[bytes]] = set()
        try:
            while (waiting or flying) and not stopped():
                while waiting and len(flying) < _FLIGHT:
                    flying.add(pool.submit(_evaluate, source, waiting.pop()))
                done, flying = wait(flying, timeout=0.1, return_when="FIRST_COMPLETED")
                for one in done:
                    take(one.result())
        finally:  # Ctrl-C may have ended the workers, too, so nothing that is not done is waited for
            for one in flying:
                one.cancel()

    return execute


@lru_cache(maxsize=8)
def _evaluator(text: str, path: str, folder: str, process: int) -> Any:
    return _core.PointEvaluator(_core.parse_scene(text, path, []), folder)


def _evaluate(source: tuple[str, str, str], points: bytes) -> bytes:
    """In the process that works."""
    return bytes(_evaluator(*source, os.getpid())(points))
