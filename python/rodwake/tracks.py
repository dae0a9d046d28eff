"""Tracks of particles in a film, and measurements of them."""

from __future__ import annotations

import logging
import math
import os
import tempfile
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Optional, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _core, arguments, shipped
from .errors import InputError
from .runs import Run
from .scenes import Folder, Progress, Scene
from .toml import toml

_log = logging.getLogger("rodwake")
_OF_ROWS = ("frame", "particle", "x", "y", "heading", "kind", "t")


@dataclass(frozen=True, repr=False)
class Measured:
    """Result of a measure. Lengths in bead radii a, times in s, as in the files of `rodwake measure` (docs/measure.md)."""

    values: dict[str, Any]  #: by name: {"value": ..., "error": ...}, or a number; as in measure.json
    tables: dict[str, Any]  #: by name, "gr": pandas DataFrames whose attrs have the units, or NumPy structured arrays
    film: dict[str, Any]  #: what the film is and what could not be used: tracks.json

    def __repr__(self) -> str:
        return f"<Measured: values {', '.join(self.values)}; tables {', '.join(self.tables)}; {self.film['frames']} frames>"


class Tracks:
    """Tracks of a film or of a simulation.

    Columns are copied. A particle with a NaN or masked position was not seen in that frame; a NaN in `particle` belongs to no track.

    Parameters
    ----------
    rows : path, DataFrame or mapping
        A file (CSV of trackpy, pandas or TrackMate, TrackMate's XML, LAMMPS dump, extended XYZ, GSD, H5MD), or columns frame (or t, in
        s), x, y, and optionally particle, heading (rad), kind ("bead", "rod").
    pixel : str or float
        Length of one unit of x and y: "25 um", or a number in m.
    **keys
        Other keys of [tracks] (docs/scene.md): frames_per_second if there are no times, bead_radius, window, box, columns, rod_kinds.
    """

    def __init__(self, rows: Union[Folder, Any], *, pixel: Union[str, float], **keys: Any) -> None:
        self._file: Optional[str] = None
        self._columns: dict[str, NDArray[Any]] = {}
        self._keys = {"pixel": pixel, **keys}
        if "file" in keys:
            raise InputError("file: give the name of the file instead of rows")
        if isinstance(rows, (str, os.PathLike)):
            self._file = str(Path(arguments.path("rows", rows, "the name of a file")).absolute())
        else:
            self._columns = _columns(rows)
            if "t" in self._columns:
                self._keys.setdefault("time_column", "t")
        self.scene()  # tells what is wrong with the keys

    @classmethod
    def from_arrays(cls, positions: ArrayLike, *, pixel: Union[str, float] = 1.0, **keys: Any) -> Tracks:
        """Tracks from `positions` (T, N, 2): x and y of each particle in each frame, NaN or masked where it was not seen."""
        given = arguments.gaps("positions", positions, "an array of shape (T, N, 2)")
        if given.ndim != 3 or given.shape[2] not in (2, 3):
            raise InputError(f"positions: expected an array of shape (T, N, 2); got one of shape {given.shape}")
        frame, particle = np.indices(given.shape[:2])
        return cls({"frame": frame.ravel(), "particle": particle.ravel(), "x": given[..., 0].ravel(), "y": given[..., 1].ravel()},
                   pixel=pixel, **keys)

    def scene(self, **measure: Any) -> Scene:
        """The scene that measures the tracks, with these keys of [measure]. Columns in memory stand for the file tracks.csv."""
        tracks: dict[str, Any] = {"file": self._file or "tracks.csv", **self._keys}
        text = "\n".join(["schema = 1", "[tracks]", *(f"{key} = {toml(value, key)}" for key, value in tracks.items()),
                          "[measure]", *(f"{key} = {toml(value, key)}" for key, value in (measure or {"order": True}).items()), ""])
        return Scene.parse(text, "tracks")

    def run(self, folder: Folder, *, threads: int = 0, force: bool = False, progress: Optional[Progress] = None, **measure: Any) -> Run:
        """Measures into a folder, as `rodwake run` does: run(folder, order=True, microrheology=True, block="2 s"). Columns in memory
        are written next to it, to `<folder>.csv`."""
        folder = Path(arguments.path("folder", folder))
        scene = self.scene(**measure)
        if not self._file:
            folder.parent.mkdir(parents=True, exist_ok=True)
            file = folder.absolute().with_name(f"{folder.name}.csv")
            _write(file, self._columns)
            scene.set("tracks.file", str(file))
        return scene.run(folder, threads=threads, force=force, progress=progress)

    def order(self, **measure: Any) -> Measured:
        """Pair correlation g(r), table "gr"; bond order psi6 and its correlation g_B(r), table "gB". Keys of [measure]: order_interval,
        order_cutoff, neighbours, block, ..."""
        return self._measure("order", ("gr", "gB"), {"order": True, **measure})

    def displacement(self, **measure: Any) -> Measured:
        """Mean-square displacement, table "msd", and the stiffness of the medium around a particle, table "stiffness". Keys of
        [measure]: interval, block, ..."""
        return self._measure("microrheology", ("msd", "stiffness"), {"microrheology": True, **measure})

    def _measure(self, part: str, tables: tuple[str, ...], measure: dict[str, Any]) -> Measured:
        with tempfile.TemporaryDirectory(prefix="rodwake-") as folder:
            run = self.run(Path(folder) / "run", **measure)
            found = {name: run.table(f"{name}.csv") for name in tables if f"{name}.csv" in run.files}
            return Measured(run.json("measure.json")[part], found, run.json("tracks.json"))

    def __repr__(self) -> str:
        held = self._file or f"{len(self._columns['x'])} rows"
        return f"<Tracks: {held}>"


def convert(source: Folder, target: Folder, *, frames: str = "", rods: str = "", unit: str = "", group: str = "",
            columns: Optional[Mapping[str, str]] = None, rod_kinds: Iterable[str] = (), time_column: str = "", force: bool = False,
            progress: Optional[Progress] = None) -> Path:
    """Writes tracks or a trajectory in another format, as `rodwake convert` does: convert("results/bed", "bed.gsd").

    The logger 'rodwake' reports what the format loses.

    Parameters
    ----------
    source : path
        File of tracks (CSV, TrackMate's XML, LAMMPS dump, extended XYZ, GSD, H5MD), or the folder of a run or an ensemble.
    target : path
        File to write. Its extension is the format: .h5md, .gsd, .xyz, .dump, .csv. Each run of an ensemble gets its own.
    frames : str
        "from:to:stride", numbers from 0; empty: all.
    rods : str
        "poses" or "spheres"; empty: spheres if the file has them, poses in CSV.
    unit : str
        Of lengths in the target: "a", "m"; empty: a for beds, otherwise as in the source.
    group : str
        Group of an H5MD file that holds the particles; empty: the only one.
    columns : mapping, optional
        Names of columns: {"id": "label", "heading": "angle"}.
    rod_kinds : iterable of str
        Types, species or kinds that are rods.
    time_column : str
        Column of times in s.
    force : bool
        Replace an existing target.
    progress : callable, optional
        Called as progress(what, value, end, unit).

    Returns
    -------
    Path
        The target.
    """
    target = Path(arguments.path("target", target, "the name of a file"))
    _core.convert(arguments.path("source", source, "the name of a file or folder"), target, frames, unit, rods, group,
                  dict(columns or {}), list(rod_kinds), time_column, bool(force), shipped.converter(), _log.log, progress)
    return target


def _columns(rows: Any) -> dict[str, NDArray[Any]]:
    """Of a DataFrame, a mapping or a structured array."""
    if isinstance(rows, np.ndarray) and rows.dtype.names:
        rows = {name: rows[name] for name in rows.dtype.names}
    if not hasattr(rows, "keys"):
        raise TypeError(f"rows: expected the name of a file, a DataFrame or a mapping of columns, not {type(rows).__name__}")
    names = [name for name in _OF_ROWS if name in rows.keys()]
    missing = [name for name in ("x", "y") if name not in names] + ([] if {"frame", "t"} & set(names) else ["frame (or t)"])
    if missing:
        raise InputError(f"rows: no column {', '.join(missing)}; there are {', '.join(map(str, rows.keys()))}; rename them, as in "
                         "frame.rename(columns={\"X\": \"x\"})")
    found: dict[str, NDArray[Any]] = {}
    for name in names:
        if name == "kind":
            found[name] = np.array([str(one) for one in rows[name]])
        elif name in ("x", "y", "particle", "heading"):
            found[name] = arguments.gaps(f"rows.{name}", rows[name], "numbers").copy()
        else:
            found[name] = arguments.array(f"rows.{name}", rows[name], "numbers", finite=True).copy()
    shapes = {name: column.shape for name, column in found.items()}
    if len(set(shapes.values())) != 1 or found["x"].ndim != 1:
        raise InputError(f"rows: the columns have the shapes {shapes}: expected one axis of one length")
    return found


def _write(path: Path, columns: dict[str, NDArray[Any]]) -> None:
    """Numbers with all their digits; empty where there is none."""
    texts = []
    for name, column in columns.items():
        if column.dtype.kind == "f" and name in ("frame", "particle"):
            texts.append(["" if math.isnan(one) else f"{one:.17g}" for one in column.tolist()])
        else:
            texts.append(["" if one != one else repr(one) if isinstance(one, float) else one for one in column.tolist()])
    with open(path, "w", encoding="utf-8") as file:
        file.write(",".join(columns) + "\n")
        file.writelines(f"{','.join(row)}\n" for row in zip(*texts))
