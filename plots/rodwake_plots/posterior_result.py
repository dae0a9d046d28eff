"""The posterior of a fit: posterior.json and the tables beside it."""

import math
from typing import NamedTuple

import numpy as np

from . import files
from .errors import PlotError

FILE = "posterior.json"


class Prior(NamedTuple):
    kind: str
    low: float
    high: float
    mean: float
    sd: float

    def density(self, x):
        """Normalised between low and high but for the part of a normal prior that is cut there."""
        inside = (x >= self.low) & (x <= self.high)
        with np.errstate(divide="ignore", invalid="ignore"):
            found = {"uniform": lambda: 1 / (self.high - self.low) + 0 * x,
                     "log_uniform": lambda: 1 / (x * math.log(self.high / self.low)),
                     "normal": lambda: np.exp(-((x - self.mean) / self.sd) ** 2 / 2) / (self.sd * self.held)}[self.kind]()
        return np.where(inside, found, 0.0)

    @property
    def held(self):
        """Of a normal prior between low and high, times sqrt(2 pi)."""
        low, high = (0.5 * math.erfc(-(end - self.mean) / (self.sd * math.sqrt(2))) for end in (self.low, self.high))
        return math.sqrt(2 * math.pi) * (high - low)


class Marginal(NamedTuple):
    name: str
    unit: str
    mean: float
    sd: float
    median: float
    low: float  # 2.5 %
    high: float  # 97.5 %
    rhat: float
    ess: float
    prior: Prior


class PosteriorResult:
    def __init__(self, folder):
        self.path = folder / FILE
        self.record = files.Record(self.path)
        with files.reading(self.path, "parameters"):
            self.parameters = [marginal(name, one) for name, one in self.record["parameters"].items()]
        self.remarks = self.record.get("remarks") or []
        evidence = self.record.get("log_evidence") or {}
        self.log_evidence = (number(evidence.get("value")), number(evidence.get("stderr"))) if evidence else None

    def chains(self):
        """{parameter: values as [chain][draw]}."""
        with files.reading(self.path, "samples"):
            path = self.path.parent / self.record["samples"]
        found = files.read_csv(path, needed=("chain", *(one.name for one in self.parameters)))
        _, counts = np.unique(found["chain"], return_counts=True)
        if counts.size == 0 or np.ptp(counts) > 0:
            raise PlotError(f"{path}: the chains are not equally long")
        return {one.name: found[one.name].reshape(counts.size, -1) for one in self.parameters}

    def table(self, kind, index):
        """Columns of what the samples predict, of the `index`th profile ("curve") or track ("trajectory")."""
        return files.read_csv(self.path.parent / f"posterior_{kind}_{index}.csv")


def marginal(name, one):
    prior = one["prior"]
    return Marginal(name, str(one.get("unit") or ""), *(number(one.get(key)) for key in ("mean", "sd", "median", "q025", "q975", "rhat", "ess")),
                    Prior(str(prior["kind"]), number(prior.get("low"), -math.inf), number(prior.get("high"), math.inf), number(prior.get("mean")),
                          number(prior.get("sd"))))


def number(value, absent=math.nan):
    return absent if value is None else float(value)
