"""Least squares on arrays: the medium from displacement profiles or maps, couplings from tracks of rods."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal, Mapping, Optional, Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _core, arguments
from .errors import InputError
from .toml import toml

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Profile:
    """Displacement along a line in the frame of the rod, in any unit of length, the same for all. Rows with a masked value are left out."""

    place: ArrayLike  #: (P,): the coordinate that varies
    value: ArrayLike  #: (P,)
    sigma: Optional[ArrayLike] = None  #: (P,): standard errors (None: equal and unknown)
    component: Literal["Ux", "Uy"] = "Ux"
    along: Literal["x", "y"] = "x"
    at: float = 0.0  #: the other coordinate
    name: str = "profile"
    role: Literal["fit", "predict"] = "fit"  #: predict: compared with the fit of the others, not fitted


@dataclass(frozen=True)
class Track:
    """Measured motion of rods in reduced units: t (T,) and poses (T, N, 3) of x, y, heading in rad, which may jump by whole turns.
    The first row is the start; rows with a masked value are left out. Without sigmas the errors come from the scatter."""

    t: ArrayLike
    poses: ArrayLike
    sigma_position: Optional[float] = None
    sigma_heading: Optional[float] = None
    free_headings: bool = False  #: fit the headings at the start too
    start_poses: Literal["auto", "fitted", "exact"] = "auto"  #: the first row: fitted, data like the others, if sigmas are given
    contact_distance: Optional[float] = None
    contact_time: Optional[float] = None  #: a datum; needs contact_distance
    sigma_contact: Optional[float] = None
    independent: float = 1.0  #: independent rows a row is worth, in (0, 1]
    name: str = "track"


@dataclass(frozen=True)
class Map:
    """Displacements on a grid in the frame of a rod, which heads along +x, in any unit of length, the same for all. The grid lies in a
    periodic box whose sides are `box`."""

    x: ArrayLike  #: (nx,): evenly spaced, rising
    y: ArrayLike  #: (ny,)
    Ux: ArrayLike  #: (ny, nx): along the heading; NaN or masked: no data
    Uy: ArrayLike  #: (ny, nx)
    box: tuple[float, float]  #: along and across the heading
    sigma_x: Optional[ArrayLike] = None  #: (ny, nx): standard errors; NaN or masked: the bin is left out; None, or all so: equal and unknown
    sigma_y: Optional[ArrayLike] = None  #: (ny, nx)
    speed: Optional[float] = None  #: of the rod against the medium, length/s; needed for zeta, rho and eta_s
    name: str = "map"


@dataclass(frozen=True)
class Estimate:
    """A fitted value. standard_error: infinite if the data do not fix it, NaN if it has none (fixed, or held by a bound)."""

    name: str
    value: float
    standard_error: float
    low: float  #: 95 % interval
    high: float
    free: bool
    bound: Optional[str]  #: 'lower' or 'upper' if the value is held there


@dataclass(frozen=True)
class FittedProfile:
    """A profile and the model, at every point that is not masked."""

    name: str
    role: str
    place: Floats
    value: Floats
    sigma: Floats  #: as used, enlarged where points share data (NaN: unknown)
    model: Floats
    error: Floats  #: standard error of the model
    residual: Floats  #: (value - model)/sigma; without sigmas over the scatter
    used: NDArray[np.bool_]  #: outside the core
    chi2: float  #: of the used ones
    excess: float  #: factor by which the data exceed the model
    excess_error: float


@dataclass(frozen=True)
class FittedTrack:
    """The model's poses (T, N, 3) at the times of a track that are not masked, and what is left, root mean square."""

    name: str
    model: Floats
    rms_position: float
    rms_heading: float


@dataclass(frozen=True)
class FittedMap:
    """The model on the grid of a map."""

    name: str
    Ux: Floats
    Uy: Floats
    used: NDArray[np.bool_]  #: with data and outside the mask
    chi2: float


@dataclass(frozen=True)
class Likelihood:
    """The smallest chi2 over the other parameters as one is held at `value`; low, high: the 95 % interval, None: no end."""

    value: Floats
    chi2: Floats
    low: Optional[float]
    high: Optional[float]


class FitResult:
    """Result of a fit. Matrices have the parameters in `free`, in this order. profiles, tracks, maps: model and residuals of the data,
    in the given order (empty if the fit failed)."""

    def __init__(self, core: Any) -> None:
        self.parameters: dict[str, Estimate] = {one.name: one for one in core.estimates(Estimate)}
        self.free: list[str] = core.free()
        self.covariance: Floats = core.covariance()
        self.correlation: Floats = core.correlation()
        self.chi2: float = core.chi2
        self.dof: int = core.dof
        self.probability: float = core.probability  #: of so large a chi2 if model and errors are right
        self.termination: str = core.termination  #: 'converged', 'roundoff', 'budget', 'failed'
        self.reason: str = core.reason
        self.diagnostics: list[str] = core.diagnostics  #: bounds, what the data do not fix, other minima, in words
        self.evaluations: int = core.evaluations
        self.residuals: Floats = core.residuals()  #: (data - model)/sigma of all that was fitted; their squares add up to chi2
        self.profiles: list[FittedProfile] = core.profiles(FittedProfile)
        self.tracks: list[FittedTrack] = core.tracks(FittedTrack)
        self.maps: list[FittedMap] = core.maps(FittedMap)
        self.likelihood: dict[str, Likelihood] = core.likelihood(Likelihood)  #: of the parameters in `likelihood = [...]`
        self._report: str = core.text()

    def report(self) -> str:
        """The result as a page of text."""
        return self._report

    def __repr__(self) -> str:
        values = ", ".join(f"{one.name}={one.value:.6g}" for one in self.parameters.values())
        return f"<FitResult: {values}; chi2 = {self.chi2:.4g}, dof = {self.dof}, {self.termination}>"


def fit_wake(profiles: Sequence[Profile], parameters: Sequence[str], **options: Any) -> FitResult:
    """Fits the wake of a rod to profiles of displacement.

    Lengths are in the unit of the profiles. The result is the same as from `rodwake fit` for the same data. NaN among the sigmas is
    refused: leave such rows out.

    Parameters
    ----------
    profiles : sequence of Profile
        The data.
    parameters : sequence of str
        Names of the fitted parameters: f_over_mu, eta, xi or alpha, f2d_over_mu, x0, offset, offset_y.
    **options
        Keys of [fit] (docs/scene.md): start, fixed, bounds and tied, as mappings by name; core (points closer to the rod are left
        out), independent_spacing, box, heading, method, loss, starts, seed, tolerance and others; also `threads`.

    Returns
    -------
    FitResult
    """
    return fit(profiles=profiles, parameters=parameters, **options)


def fit_rods(tracks: Sequence[Track], parameters: Sequence[str], **options: Any) -> FitResult:
    """Fits couplings and medium to tracks of rods: kappa, gamma1, gamma2, eta, alpha or xi. Options as for `fit_wake`."""
    return fit(tracks=tracks, parameters=parameters, **options)


def fit_map(maps: Sequence[Map], parameters: Sequence[str], **options: Any) -> FitResult:
    """Fits a medium and the force multipoles of a rod to displacement maps (docs/fit.md, "Displacement maps").

    Lengths are in the unit of the maps, angles in rad, times in s. Values, errors and chi2 are the same as from `rodwake fit` for the same
    data. Only `rodwake fit` gives the errors of fixed values (fixed_errors), of further masks and of the jackknife.

    Parameters
    ----------
    maps : sequence of Map
        The data.
    parameters : sequence of str
        Of an isotropic medium f_over_mu, eta, and xi, alpha or drag_area. Of an orthotropic one amplitude, force, c11, c22, c12, c66,
        zeta, rho, eta_s. Of both p_xx, p_yy, q_xxx, q_xyy, q_yxy (at most two of these three), t_xxxx, t_xxyy, h_xxxxx, h_xxxyy,
        offset, offset_y. The others must be in `fixed`.
    **options
        As for `fit_wake`, and rod_length, source_width and masks = [{strip, radius, sector}] (at most one).

    Returns
    -------
    FitResult
    """
    return fit(maps=maps, parameters=parameters, **options)


def fit(*, parameters: Sequence[str], profiles: Sequence[Profile] = (), tracks: Sequence[Track] = (), maps: Sequence[Map] = (),
        threads: int = 1, **options: Any) -> FitResult:
    """Fits profiles, tracks and maps together. With profiles and tracks use alpha, which means the same for both (docs/fit.md)."""
    return FitResult(_core.fit(*scene_and_data(parameters, profiles, tracks, maps, options), arguments.threads(threads)))


def scene_and_data(parameters: Sequence[str], profiles: Sequence[Profile], tracks: Sequence[Track], maps: Sequence[Map],
                   options: Mapping[str, Any]) -> tuple[Any, list[Any], list[Any], list[Any]]:
    """The keys of [fit] as a scene, and the data as the compiled module takes them."""
    names = _listed("parameters", parameters, str, "names")
    profiles, tracks, maps = (_listed("profiles", profiles, Profile, "rodwake.Profile"), _listed("tracks", tracks, Track, "rodwake.Track"),
                              _listed("maps", maps, Map, "rodwake.Map"))
    keys: dict[str, Any] = {"parameters": names, **options, "profiles": [_profile_keys(one, i) for i, one in enumerate(profiles)],
            "trajectories": [_track_keys(one, i) for i, one in enumerate(tracks)], "maps": [_map_keys(one, i) for i, one in enumerate(maps)]}
    scene = _core.parse_scene(f"schema = 1\nfit = {_toml(keys)}\n", "fit", [])
    return (scene, [_profile(f"profiles[{i}]", one) for i, one in enumerate(profiles)],
            [_track(f"tracks[{i}]", one) for i, one in enumerate(tracks)], [_map(f"maps[{i}]", one) for i, one in enumerate(maps)])


def _listed(name: str, given: Any, kind: type, wanted: str) -> list[Any]:
    try:
        listed = None if isinstance(given, (str, bytes, Mapping)) else list(given)
    except TypeError:
        listed = None
    if listed is None:
        raise InputError(f"{name}: expected a list of {wanted}, not {type(given).__name__} ({arguments.shown(given)})")
    for index, one in enumerate(listed):
        if not isinstance(one, kind):
            raise InputError(f"{name}[{index}]: expected a list of {wanted}, not of {type(one).__name__} ({arguments.shown(one)})")
    return listed


def _toml(keys: Mapping[str, Any]) -> str:
    try:
        return toml({key: value for key, value in keys.items() if value is not None and not (isinstance(value, list) and not value)})
    except TypeError as error:
        raise InputError(str(error)) from error


def _profile_keys(one: Profile, index: int) -> Mapping[str, Any]:
    return {"file": f"profile {index}", "name": one.name, "component": one.component, "along": one.along, "at": one.at,
            "role": one.role}


def _track_keys(one: Track, index: int) -> Mapping[str, Any]:
    names = ("name", "sigma_position", "sigma_heading", "free_headings", "start_poses", "contact_distance", "contact_time", "sigma_contact")
    return {"file": f"track {index}", **{name: getattr(one, name) for name in names if getattr(one, name) is not None}}


def _map_keys(one: Map, index: int) -> Mapping[str, Any]:
    keys: dict[str, Any] = {"files": [f"map {index}.csv"], "name": one.name, "box": one.box}
    return keys if one.speed is None else keys | {"speed": one.speed}


def _profile(name: str, one: Profile) -> tuple[Floats, Floats, Optional[Floats]]:
    columns = {"place": (one.place, 1), "value": (one.value, 1)}
    if one.sigma is None:
        place, value = arguments.rows(name, columns, "place and value (P,)")
        return place, value, None
    place, value, sigma = arguments.rows(name, columns | {"sigma": (one.sigma, 1)}, "place, value and sigma (P,)")
    return place, value, sigma


def _track(name: str, one: Track) -> tuple[Floats, Floats, float]:
    t, poses = arguments.rows(name, {"t": (one.t, 1), "poses": (one.poses, 3)}, "t (T,) and poses (T, N, 3)")
    return t, poses, arguments.number(f"{name}.independent", one.independent, above=0, most=1)


def _map(name: str, one: Map) -> tuple[Sequence[Floats], tuple[float, float], float]:
    """Positions, displacements and errors, checked; NaN stands for what is not there."""
    box = (arguments.number(f"{name}.box", one.box[0], above=0), arguments.number(f"{name}.box", one.box[1], above=0))
    x, y = (_evenly_spaced(f"{name}.{axis}", places, side) for axis, places, side in (("x", one.x, box[0]), ("y", one.y, box[1])))
    if (one.sigma_x is None) != (one.sigma_y is None):
        raise InputError(f"{name}: sigma_x and sigma_y come together")
    fields = {"Ux": one.Ux, "Uy": one.Uy, "sigma_x": one.sigma_x, "sigma_y": one.sigma_y}
    grids = [np.full((y.size, x.size), np.nan) if field is None else arguments.gaps(f"{name}.{key}", field) for key, field in fields.items()]
    for key, grid in zip(fields, grids):
        if grid.shape != (y.size, x.size):
            raise InputError(f"{name}: {key} has the shape {grid.shape}, expected (ny, nx) = {(y.size, x.size)}")
    return (x, y, *grids), box, 0.0 if one.speed is None else arguments.number(f"{name}.speed", one.speed)


def _evenly_spaced(name: str, given: ArrayLike, side: float) -> Floats:
    """Positions along an axis of a map, within the side of its box."""
    places = arguments.array(name, given)
    steps = np.diff(places) if places.ndim == 1 else np.array([])
    if steps.size < 1 or not (steps[0] > 0 and np.all(np.abs(steps - steps[0]) <= 1e-6 * steps[0])):
        raise InputError(f"{name}: must be two positions or more, rising and evenly spaced")
    if places[-1] - places[0] > side * (1 + 1e-6):
        raise InputError(f"{name}: the grid of {places[-1] - places[0]:g} is larger than the box of {side:g}")
    return places
