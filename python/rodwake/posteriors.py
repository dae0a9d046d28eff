"""Posterior densities of the parameters of a fit for any sampler, samples, and the evidence of a model."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Mapping, Optional, Sequence, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _core, arguments
from .errors import InputError
from .fitting import Map, Profile, Track, scene_and_data

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Marginal:
    """Of one parameter; q025, q975: where 2.5 % of the samples end on either side. Chains that agree have an rhat below 1.01."""

    name: str
    mean: float
    sd: float
    median: float
    q025: float
    q975: float
    rhat: float
    ess: float  #: effective samples, all chains together


class Posterior:
    """Samples of the parameters, `samples[name]` of shape (chains, draws)."""

    def __init__(self, names: Sequence[str], found: Any) -> None:
        marginals, samples, log_likelihood, log_evidence, accepted, remarks = found
        self.parameters: dict[str, Marginal] = dict(zip(names, marginals))
        self.samples: dict[str, Floats] = dict(zip(names, samples))
        self.log_likelihood: Floats = log_likelihood  #: (chains, draws)
        self.log_evidence: Optional[tuple[float, float]] = log_evidence  #: with its standard error
        self.accepted: list[float] = accepted  #: share of the steps that each chain took
        self.remarks: list[str] = remarks  #: what is not to be trusted, in words

    def __repr__(self) -> str:
        values = ", ".join(f"{one.name}={one.mean:.6g}±{one.sd:.2g}" for one in self.parameters.values())
        return f"<Posterior: {values}; log evidence {self.log_evidence[0] if self.log_evidence else 'unknown'}>"


class FitProblem:
    """Data, parameters and priors.

    Parameters
    ----------
    parameters, profiles, tracks, maps, **options
        As for `fit`.
    priors : mapping, optional
        {name: {kind: "uniform" | "log_uniform" | "normal", low, high, mean, sd}}. Default: uniform between the bounds.
    chains, samples : int
        Chains, and samples of all of them together.
    evidence : bool
        Whether `posterior` also computes the evidence.
    threads : int
        For rows of `log_density` and chains of samples. Results do not depend on it.
    """

    def __init__(self, *, parameters: Sequence[str], profiles: Sequence[Profile] = (), tracks: Sequence[Track] = (), maps: Sequence[Map] = (),
                 priors: Optional[Mapping[str, Mapping[str, Any]]] = None, chains: int = 4, samples: int = 4000, evidence: bool = True,
                 threads: int = 1, **options: Any) -> None:
        self._threads = arguments.threads(threads)
        keys = {"chains": arguments.whole("chains", chains, 1), "samples": arguments.whole("samples", samples, 8), "evidence": bool(evidence)}
        posterior_keys: dict[str, Any] = {**keys, **({"priors": priors} if priors else {})}
        self._core = _core.FitProblem(*scene_and_data(parameters, profiles, tracks, maps, {**options, "posterior": posterior_keys}))
        self.names: list[str] = self._core.names()  #: of the parameters that theta holds, in this order

    def log_density(self, theta: ArrayLike) -> Union[float, Floats]:
        """log of likelihood times prior at theta, (d,), or at each row of theta, (N, d), as samplers such as emcee want it
        (vectorize=True); -inf where the prior is 0 or the model does not exist."""
        prior, likelihood = self._densities(theta)
        return prior + likelihood

    def log_prior(self, theta: ArrayLike) -> Union[float, Floats]:
        """-inf where a parameter is outside its prior."""
        return self._densities(theta)[0]

    def log_likelihood(self, theta: ArrayLike) -> Union[float, Floats]:
        """-inf where the prior is 0: it is not worked out there."""
        return self._densities(theta)[1]

    def posterior(self) -> Posterior:
        """A fit, and samples from where it ended; as `rodwake fit` gives for the same data and keys, to the last bit."""
        return Posterior(self.names, self._core.posterior(self._threads, Marginal))

    def _densities(self, theta: ArrayLike) -> tuple[Union[float, Floats], Union[float, Floats]]:
        given = arguments.array("theta", theta)
        if given.ndim not in (1, 2) or given.shape[-1] != len(self.names):
            raise InputError(f"theta: expected the shape ({len(self.names)},) or (N, {len(self.names)}), in the order {', '.join(self.names)}; "
                             f"got {given.shape}")
        prior, likelihood = self._core.log_densities(np.ascontiguousarray(np.atleast_2d(given)), self._threads)
        if given.ndim == 2:
            return prior, likelihood
        return float(prior[0]), float(likelihood[0])


def posterior(*, parameters: Sequence[str], **options: Any) -> Posterior:
    """Samples of the parameters and the evidence of the model. Options: as in FitProblem."""
    return FitProblem(parameters=parameters, **options).posterior()
