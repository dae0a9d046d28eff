"""Results: what is in the folder of a run, with units."""

from __future__ import annotations

import json
import os
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Union

import numpy as np
from numpy.typing import NDArray

from .errors import InputError

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Quantity:
    """Numbers and the unit they are in: "f/mu", "m", "rad"; "1" without dimension."""

    values: NDArray[Any]
    unit: str


@dataclass(frozen=True)
class RodPath:
    """Rods against time. Units: `length_unit` and `time_unit`; headings in rad."""

    t: Floats  # (T,)
    poses: Floats  # (T, N, 3): x, y, heading, unwrapped
    length_unit: str
    time_unit: str
    attributes: dict[str, Any]  # outcome, couplings, medium


@dataclass(frozen=True)
class Trajectory:
    """Frames of a bed in SI units. N spheres (beads, then those of the rods), R rods."""

    time: Floats  # (T,), s
    box: Floats  # (3,), sides in m; periodic in x and y
    position: Floats  # (T, N, 3), m, unwrapped
    velocity: Floats  # (T, N, 3), m/s
    species: NDArray[np.int32]  # (N,): 0 a bead, else a sphere of a rod
    radius: Floats  # (N,), m
    rod_position: Floats  # (T, R, 3), m, centres of mass, unwrapped
    rod_orientation: Floats  # (T, R, 4), quaternion from body to world, real part first; the axis is the body's x


class Run:
    """The folder of a run: its manifest lists what is there. Files are read when they are asked for."""

    def __init__(self, folder: Union[str, "os.PathLike[str]"]) -> None:
        self.folder = Path(folder)
        self.manifest = self.json("manifest.json")

    @property
    def files(self) -> dict[str, str]:
        """Name of each file, and what it is."""
        return {name: entry["what"] for name, entry in self.manifest["files"].items()}

    def json(self, name: str) -> Any:
        """A JSON file: 'outcome.json', 'summary.json', 'fit.json', 'provenance.json'."""
        try:
            return json.loads(self._file(name).read_text(encoding="utf-8"))
        except ValueError as error:
            raise InputError(f"{self.folder / name}: not valid JSON: {error}") from error

    @property
    def outcome(self) -> dict[str, Any]:
        """How an encounter of rods ended."""
        return dict(self.json("outcome.json"))

    @property
    def status(self) -> str:
        """'finished', 'unfinished', 'interrupted' or 'failed'."""
        return str(self.json("provenance.json")["status"])

    def scene(self) -> Any:
        """The scene that was run, every key with its value."""
        from .scenes import Scene
        return Scene.load(self._file("scene.toml"))

    def units(self, name: str) -> dict[str, str]:
        """Unit of each column of a table."""
        return {column["name"]: column["unit"] for column in self._entry(name).get("columns", ())}

    def table(self, name: str) -> Any:
        """A CSV file, 'rods.csv': a pandas DataFrame whose attrs have the units, or without pandas a NumPy structured array."""
        path = self._file(name)
        try:
            import pandas
        except ImportError:
            return np.atleast_1d(np.genfromtxt(path, delimiter=",", names=True, dtype=None, encoding="utf-8", deletechars=""))
        table = pandas.read_csv(path, comment="#", float_precision="round_trip")
        table.attrs["units"] = self.units(name)
        return table

    def dataset(self, name: str, file: str = "result.h5") -> Quantity:
        """One of `datasets`: dataset("field/grid/Ux")."""
        with self._open(file) as h5:
            if name not in h5:
                raise InputError(f"{self.folder / file}: holds no {name!r}; Run.datasets lists what it holds")
            if not hasattr(h5[name], "shape"):
                raise InputError(f"{self.folder / file}: {name!r} is a group; Run.datasets lists the datasets in it")
            return Quantity(np.asarray(h5[name]), _text(h5[name].attrs.get("unit", "1")))

    def datasets(self, file: str = "result.h5") -> list[str]:
        """Names of the datasets in an HDF5 file."""
        names: list[str] = []
        with self._open(file) as h5:
            h5.visititems(lambda name, item: names.append(name) if hasattr(item, "shape") else None)
        return names

    def field(self) -> dict[str, Quantity]:
        """The field of one rod on the grid of [field]: x (nx,), y (ny,), and Ux, Uy, exx, ... (ny, nx)."""
        names = [name for name in self.datasets() if name.startswith("field/grid/")]
        if not names:
            raise InputError(f"{self.folder}: holds no field on a grid; [field] of the scene asks for it")
        return {name.removeprefix("field/grid/"): self.dataset(name) for name in names}

    def rods(self, name: str = "scene") -> RodPath:
        """Rods of the theory: of the scene as written, or of one of its variants."""
        with self._open("result.h5") as h5:
            if f"rods/{name}" not in h5:
                raise InputError(f"{self.folder}: holds no rods of {name!r}, but of {list(h5.get('rods', ()))}")
            group = h5[f"rods/{name}"]
            poses = np.stack([group[column] for column in ("x", "y", "theta")], axis=-1)
            attributes = {key: _plain(value) for key, value in group.attrs.items()}
            return RodPath(np.asarray(group["t"]), poses, _text(group["x"].attrs["unit"]), _text(group["t"].attrs["unit"]), attributes)

    def trajectory(self, name: str = "trajectory.h5md") -> Trajectory:
        """The stored frames of a bed; last_period.h5md has those of one period of the plates."""
        with self._open(name) as h5:
            spheres = h5["particles/trajectory"]
            edges = np.asarray(spheres["box/edges/value"][0], dtype=float)
            box = np.diag(edges) if edges.ndim == 2 else edges
            time = np.asarray(spheres["position/time"], dtype=float)
            rods = h5.get("particles/trajectory_rods")
            none = np.zeros((len(time), 0, 4))
            return Trajectory(time, box, _unwrapped(spheres, box), np.asarray(spheres["velocity/value"]), np.asarray(spheres["species"]),
                              np.asarray(spheres["radius"], dtype=float), none[..., :3] if rods is None else _unwrapped(rods, box),
                              none if rods is None else np.asarray(rods["orientation/value"]))

    def __repr__(self) -> str:
        return f"<Run {str(self.folder)!r}: {', '.join(self.files)}>"

    def _file(self, name: str) -> Path:
        path = self.folder / name
        if not path.is_file():
            raise InputError(f"{path}: no such file; Run.files lists those of a run" if name != "manifest.json"
                             else f"{self.folder}: holds no run of rodwake: there is no manifest.json")
        return path

    def _entry(self, name: str) -> dict[str, Any]:
        self._file(name)
        return dict(self.manifest["files"].get(name, {}))

    def _open(self, name: str) -> Any:
        import h5py
        return h5py.File(self._file(name), "r")


def open_run(folder: Union[str, "os.PathLike[str]"]) -> Run:
    """The results in a folder that `rodwake run`, one of its stages or Scene.run made."""
    return Run(folder)


def _text(value: Any) -> str:
    return value.decode() if isinstance(value, bytes) else str(value)


def _plain(value: Any) -> Any:
    return value.decode() if isinstance(value, bytes) else value.item() if hasattr(value, "item") else value


def _unwrapped(group: Any, box: Floats) -> Floats:
    """Places with the images of the box that they have walked to; the image of z is 0."""
    place: Floats = np.asarray(group["position/value"], dtype=float)
    if "image" in group:
        place += box * np.asarray(group["image/value"])
    return place
