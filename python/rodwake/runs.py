"""Results: what is in the folder of a run, with units."""

from __future__ import annotations

import json
import os
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Mapping, Optional, Union, overload

import numpy as np
from numpy.typing import NDArray

from . import _core, arguments
from .errors import InputError, RunError
from .reading import open_hdf5, read_json, read_record, read_table, reading

Floats = NDArray[np.float64]
_OF_THE_WHOLE = ("scene.toml", "provenance.json")  # every run has them, and its parts share them
_ENDINGS = {"table": (".csv",), "JSON file": (".json",), "HDF5 file": (".h5", ".h5md")}


@dataclass(frozen=True, repr=False)
class Quantity:
    """Numbers and the unit they are in: "f/mu", "m", "rad"; "1" without dimension."""

    values: NDArray[Any]
    unit: str

    def __repr__(self) -> str:
        return f"<Quantity: values {self.values.shape}, unit {self.unit}>"


@dataclass(frozen=True, repr=False)
class RodPath:
    """Rods against time. Units: `length_unit` and `time_unit`; headings in rad."""

    t: Floats  #: (T,)
    poses: Floats  #: (T, N, 3): x, y, heading, unwrapped
    length_unit: str
    time_unit: str
    attributes: dict[str, Any]  #: outcome, couplings, medium

    def __repr__(self) -> str:
        ended = f", {self.attributes['outcome']}" if "outcome" in self.attributes else ""
        return f"<RodPath: poses {self.poses.shape}, {self.length_unit} and {self.time_unit}{ended}>"


@dataclass(frozen=True, repr=False)
class Trajectory:
    """Frames of a bed in SI units. N spheres (beads, then spheres of the rods), R rods."""

    time: Floats  #: (T,), s
    box: Floats  #: (3,), sides in m; periodic in x and y
    position: Floats  #: (T, N, 3), m, unwrapped
    velocity: Floats  #: (T, N, 3), m/s
    species: NDArray[np.int32]  #: (N,): 0 a bead, else a sphere of a rod
    radius: Floats  #: (N,), m
    rod_position: Floats  #: (T, R, 3), m, centres of mass, unwrapped
    rod_orientation: Floats  #: (T, R, 4), quaternion from body to world, real part first; the axis is the body's x

    def __repr__(self) -> str:
        span = f", t = {self.time[0]:g} to {self.time[-1]:g} s" if len(self.time) else ""
        return f"<Trajectory: {len(self.time)} frames{span}, {int((self.species == 0).sum())} beads, {self.rod_position.shape[1]} rods>"


class Run:
    """The folder of a run: its manifest lists what is there. Files are read on demand. A run that is still going on, or was
    killed, has what was written so far; a part of a run (runs/0001 of an ensemble, points/0003 of a scan) has the files of that part.
    A file that is damaged or lost raises RunError, what the run never held InputError."""

    def __init__(self, folder: Union[str, "os.PathLike[str]"]) -> None:
        self.folder = Path(arguments.path("folder", folder))
        with reading(self.folder, "folder"):
            self.whole = _run_around(self.folder)
        self.manifest = _below(_manifest(self.whole), self.folder.resolve().relative_to(self.whole).as_posix())
        if self.is_part and not self.files:
            raise InputError(f"{self.folder}: holds no run of rodwake, nor a part of that in {self.whole}; Run.files lists what is there")

    @property
    def is_part(self) -> bool:
        """Whether this is a part of the run in the folder `whole`."""
        return self.folder.resolve() != self.whole

    @property
    def files(self) -> dict[str, str]:
        """Name of each file, and what it is."""
        return {name: str(entry.get("what", "")) for name, entry in self.manifest["files"].items()}

    def json(self, name: str) -> Any:
        """A JSON file: 'outcome.json', 'summary.json', 'fit.json', 'provenance.json'."""
        return read_json(self._file(name, "JSON file"))

    @property
    def outcome(self) -> dict[str, Any]:
        """How an encounter of rods ended."""
        outcome = read_record(self._file("outcome.json"))
        return {key: _certificate(value) if key == "certificate" else value for key, value in outcome.items()}

    @property
    def status(self) -> str:
        """'finished', 'unfinished', 'interrupted' or 'failed'; for a part, of the whole run."""
        path = self._file("provenance.json")
        status = read_record(path).get("status")
        if not isinstance(status, str):
            raise RunError(f"{path}: damaged JSON: holds no status")
        return status

    def scene(self) -> Any:
        """The scene that was run, every key with its value; for a part, of the whole run."""
        from .scenes import Scene
        path = self._file("scene.toml")
        with reading(path, "scene"):
            return Scene.load(path)

    def units(self, name: str) -> dict[str, str]:
        """Unit of each column of a table."""
        return {column["name"]: column["unit"] for column in self._entry(name).get("columns", ())}

    def table(self, name: str) -> Any:
        """A CSV file, 'rods.csv': a pandas DataFrame whose attrs have the units, or without pandas a NumPy structured array."""
        path, units = self._file(name, "table"), self.units(name)
        table = read_table(path, units)
        if hasattr(table, "attrs"):
            table.attrs["units"] = units
        return table

    def dataset(self, name: str, file: str = "result.h5") -> Quantity:
        """One of `datasets`: dataset("field/grid/Ux")."""
        arguments.kind("name", name, str, "the name of a dataset")
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
            raise InputError(f"{self.folder}: holds no field on a grid; add [field] to the scene")
        return {name.removeprefix("field/grid/"): self.dataset(name) for name in names}

    def rods(self, name: str = "scene") -> RodPath:
        """Rods of the theory: of the scene as written, or of one of its variants."""
        arguments.kind("name", name, str, "'scene' or the name of a variant")
        with self._open("result.h5") as h5:
            if f"rods/{name}" not in h5:
                raise InputError(f"{self.folder}: holds no rods of {name!r}, but of {list(h5.get('rods', ()))}")
            group = h5[f"rods/{name}"]
            t, poses = np.asarray(group["t"]), np.stack([group[column] for column in ("x", "y", "theta")], axis=-1)
            _check_shapes({"t": t}, {"t": poses.shape[:1]})
            attributes = {key: _certificate(_plain(value)) if key == "certificate" else _plain(value) for key, value in group.attrs.items()}
            return RodPath(t, poses, _text(group["x"].attrs["unit"]), _text(group["t"].attrs["unit"]), attributes)

    @property
    def members(self) -> list[Run]:
        """The runs of an ensemble of beds, in order: runs/0001 is the first. A single run has none."""
        names = {name.split("/")[1] for name in self.files if name.startswith("runs/")}
        return [self._part(f"runs/{name}") for name in sorted(names, key=lambda name: (len(name), name))]

    @overload
    def trajectory(self, name: str = ..., *, run: int) -> Trajectory: ...
    @overload
    def trajectory(self, name: str = ..., *, run: None = ...) -> Any: ...

    def trajectory(self, name: str = "trajectory.h5md", *, run: Optional[int] = None) -> Any:
        """The stored frames of a bed, a Trajectory; last_period.h5md has the frames of one period of the plates. Of an ensemble a list, a
        Trajectory for each of `members`, or with `run` one of them, from 0."""
        members = self.members
        if run is not None:
            return (members or [self])[arguments.whole("run", run, 0, max(len(members), 1) - 1)]._frames(name)
        return [one._frames(name) for one in members] or self._frames(name)

    def _frames(self, name: str) -> Trajectory:
        with self._open(name) as h5:
            if "particles/trajectory" not in h5:
                raise InputError(f"{self.folder / name}: holds no frames of a bed; trajectory.h5md and last_period.h5md do")
            spheres = h5["particles/trajectory"]
            edges = np.asarray(spheres["box/edges/value"][0], dtype=float)
            box = np.diag(edges) if edges.ndim == 2 else edges
            time = np.asarray(spheres["position/time"], dtype=float)
            rods = h5.get("particles/trajectory_rods")
            none = np.zeros((len(time), 0, 4))
            return _agreeing(Trajectory(
                time, box, _unwrapped(spheres, box), np.asarray(spheres["velocity/value"]), np.asarray(spheres["species"]),
                np.asarray(spheres["radius"], dtype=float), none[..., :3] if rods is None else _unwrapped(rods, box),
                none if rods is None else np.asarray(rods["orientation/value"])))

    def __repr__(self) -> str:
        own = [name for name in self.files if "/" not in name]
        parts = len({name.split("/")[1] for name in self.files if name.startswith("runs/")})
        held = [*([f"{parts} runs (members)"] if parts else []), *own]
        try:
            state = self.status
        except RunError:
            state = "of unknown status"
        return f"<Run {str(self.folder)!r}, {state}: {', '.join(held)}>"

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Run) and (self.folder, self.manifest) == (other.folder, other.manifest)

    def __hash__(self) -> int:
        return hash(self.folder)

    def _part(self, name: str) -> Run:
        part = Run.__new__(Run)
        part.folder, part.whole, part.manifest = self.folder / name, self.whole, _below(self.manifest, name)
        return part

    def _file(self, name: str, kind: str = "") -> Path:
        """A file that is there; of a kind that its ending shows."""
        arguments.kind("name", name, str, "the name of a file of the run")
        path = self.folder / name
        if name in _OF_THE_WHOLE and not path.exists():
            path = self.whole / name
        if kind and not name.endswith(_ENDINGS[kind]):
            others = ", ".join(one for one in self.files if one.endswith(_ENDINGS[kind]))
            raise InputError(f"{path}: no {kind}; those of this run: {others or 'none'}")
        if path.is_file():
            return path
        if path.exists():
            raise RunError(f"{path}: not a file, but {'a folder' if path.is_dir() else 'something else'}")
        if name in self.files or name in _OF_THE_WHOLE:
            raise RunError(f"{path}: lost; the same rodwake command makes it again")
        members = ", and members those of an ensemble" if any(one.startswith("runs/") for one in self.files) else ""
        raise InputError(f"{path}: no such file; Run.files lists those of a run{members}")

    def _entry(self, name: str) -> dict[str, Any]:
        self._file(name)
        return dict(self.manifest["files"].get(name, {}))

    def _open(self, name: str) -> Any:
        return open_hdf5(self._file(name, "HDF5 file"))


def open_run(folder: Union[str, "os.PathLike[str]"]) -> Run:
    """The results in a folder that `rodwake run`, one of its stages or Scene.run made, or in a part of it: a run of an ensemble
    (runs/0001), a bed of a variant or of a scan."""
    return Run(folder)


def _run_around(folder: Path) -> Path:
    """The folder of the run that this is, or a part of."""
    if not folder.is_dir():
        raise InputError(f"{folder}: {'is a file: give the folder of the run' if folder.exists() else 'no such folder'}")
    here = folder.resolve()
    for one in (here, *here.parents):
        if (one / "manifest.json").is_file() or (one / "provenance.json").is_file():
            return one
    below = sorted(one.parent.name for one in folder.glob("*/manifest.json"))
    hint = f"; there are runs in its folders {', '.join(below[:5])}{', ...' if len(below) > 5 else ''}" if below else ""
    raise InputError(f"{folder}: holds no run of rodwake: there is no manifest.json{hint}")


def _manifest(folder: Path) -> dict[str, Any]:
    """As it stands there; of a run that has not ended yet as it would."""
    path = folder / "manifest.json"
    if not path.exists():
        with reading(folder, "folder"):
            listing: dict[str, Any] = json.loads(_core.manifest(folder))
            return listing
    listing = read_record(path)
    with reading(path, "JSON"):
        if not isinstance(listing.get("files"), dict):
            raise ValueError("not the manifest of a run: it lists no files")
        for name, entry in listing["files"].items():
            columns = entry.get("columns", ()) if isinstance(entry, dict) else [None]
            if not all(isinstance(one, dict) and {str} == {type(one.get(key)) for key in ("name", "unit")} for one in columns):
                raise ValueError(f"not the manifest of a run: its entry {name!r} has no columns with names and units")
    return listing


def _below(manifest: dict[str, Any], part: str) -> dict[str, Any]:
    """Of the files in a part of the run, by their names there: runs/0001, variants/soft, points/0003/runs/0012."""
    if part == ".":
        return manifest
    is_part = part.count("/") % 2 == 1
    kept = {name.removeprefix(f"{part}/"): entry for name, entry in manifest["files"].items() if name.startswith(f"{part}/")}
    return {**manifest, "files": kept if is_part else {}}


def _agreeing(found: Trajectory) -> Trajectory:
    """If its arrays are of one trajectory."""
    frames, spheres, rods = len(found.time), found.species.size, found.rod_position.shape[1]
    _check_shapes(vars(found), {"box": (3,), "position": (frames, spheres, 3), "velocity": (frames, spheres, 3), "species": (spheres,),
                                "radius": (spheres,), "rod_position": (frames, rods, 3), "rod_orientation": (frames, rods, 4)})
    return found


def _check_shapes(arrays: Mapping[str, Any], shapes: Mapping[str, tuple[int, ...]]) -> None:
    for name, shape in shapes.items():
        if arrays[name].shape != shape:
            raise ValueError(f"{name} has the shape {arrays[name].shape}, expected {shape}")


def _certificate(word: str) -> str:
    """Version 0.3 wrote proved."""
    return "verified" if word == "proved" else word


def _text(value: Any) -> str:
    return value.decode() if isinstance(value, bytes) else str(value)


def _plain(value: Any) -> Any:
    return value.decode() if isinstance(value, bytes) else value.item() if hasattr(value, "item") else value


def _unwrapped(group: Any, box: Floats) -> Floats:
    """Positions with the images of the box that they have walked to; the image of z is 0."""
    place: Floats = np.asarray(group["position/value"], dtype=float)
    if "image" in group:
        place += box * np.asarray(group["image/value"])
    return place
