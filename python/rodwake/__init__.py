"""Motile rods in an elastic medium.

Reduced units throughout, as in scenes: lengths in f/mu, times in f/(mu v0), angles in radians. Exceptions are `Error` and its
subclasses; long work ends cleanly at Ctrl-C.

    import rodwake
    medium = rodwake.Medium(eta=1.0, alpha=1.0)
    rodwake.strain([-3.0, 2.0], [0.0, 1.0], medium)                 # (2, 2, 2)
    rodwake.simulate([[0, 2.5, 0], [0, -2.5, 0]], medium, kappa=0.5, t_end=60, contact_distance=0.1).outcome
    rodwake.Scene.load("pair.toml").set("coupling.kappa", 3.0).run("results/pair")
"""

import importlib

from ._core import Medium, RodEquations, RodResult
from ._core import version as __version__
from .equilibria import PairBranch, PairEquilibrium, pair_branches, pair_equilibria, pair_flow, write_branches
from .errors import Error, InputError, Problem, RunError, SceneError
from .fields import Wakes, dipole, displacement, grad_div, laplacian, strain, wakes
from .fitting import Estimate, FitResult, FittedMap, FittedProfile, FittedTrack, Likelihood, Map, Profile, Track, fit, fit_map, fit_rods, fit_wake
from .granular import Bed, run_bed
from .noise import NoiseResult, simulate_noise
from .ode import Event, Hit, OdeResult, integrate
from .posteriors import FitProblem, Marginal, Posterior, posterior
from .rods import classify, simulate
from .runs import Quantity, RodPath, Run, Trajectory, open_run
from .scans import critical, scan
from .scenes import Scene
from .tracks import Measured, Tracks, convert

__all__ = [
    "Bed", "Error", "Estimate", "Event", "FitProblem", "FitResult", "FittedMap", "FittedProfile", "FittedTrack", "Hit", "InputError", "Likelihood", "Map",
    "Marginal", "Measured", "Medium",
    "NoiseResult", "OdeResult", "PairBranch", "PairEquilibrium", "Posterior", "Problem", "Profile", "Quantity",
    "RodEquations", "RodPath", "RodResult", "Run", "RunError", "Scene", "SceneError", "Track", "Tracks", "Trajectory", "Wakes", "__version__",
    "classify", "convert", "critical", "dipole", "displacement", "fit", "fit_map", "fit_rods", "fit_wake", "grad_div", "integrate", "laplacian", "open_run",
    "pair_branches", "pair_equilibria", "pair_flow", "posterior",
    "run_bed", "scan", "simulate", "simulate_noise", "strain", "wakes", "write_branches",
]


def __getattr__(name: str) -> object:
    """rodwake.plots without `import rodwake.plots`: matplotlib is loaded when it is used."""
    if name == "plots":
        return importlib.import_module(".plots", __name__)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def __dir__() -> list[str]:
    """What is for users: completion shows it, and not the modules it is in."""
    return [*__all__, "plots"]
