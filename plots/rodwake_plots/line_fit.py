"""A straight line through points with errors, by weighted least squares: y = intercept + slope x, or proportional."""

from typing import NamedTuple

import numpy as np


class Fit(NamedTuple):
    values: np.ndarray      # intercept and slope, or the slope alone
    covariance: np.ndarray  # from the given errors
    chi2: float
    dof: int

    def __call__(self, x):
        return basis(x, len(self.values)) @ self.values

    def sigma(self, x):
        rows = basis(x, len(self.values))
        return np.sqrt(np.einsum("ij,jk,ik->i", rows, self.covariance, rows))

    @property
    def errors(self):
        return np.sqrt(np.diag(self.covariance))


def basis(x, count):
    x = np.atleast_1d(np.asarray(x, dtype=float))
    return np.column_stack([np.ones_like(x), x][2 - count:])


def fit(x, y, sigma, proportional=False):
    rows = basis(x, 1 if proportional else 2)
    weighted = rows / sigma[:, None]
    covariance = np.linalg.inv(weighted.T @ weighted)
    values = covariance @ (weighted.T @ (y / sigma))
    chi2 = float((((y - rows @ values) / sigma) ** 2).sum())
    return Fit(values, covariance, chi2, len(y) - len(values))


def can_fit(x, sigma):
    """Three points of known error at two places or more."""
    usable = np.isfinite(sigma)
    return usable.sum() >= 3 and np.ptp(x[usable]) > 0
