"""What turns two rods in the bed (studies/validate_mechanism.py): judged from the weights of rivals that it has kept.

A law that leaves strain out and has an AIC lower by 10 or more than all with strain refutes strain, if it fits; one that is not lower at all
leaves it. Where the best law does not fit (as in the crystal, where residuals are correlated too), differences of AIC refute nothing.
"""

from math import nan
from pathlib import Path

from . import judge, results

KEPT = Path(__file__).parents[1] / "mechanism.csv"
MADE = "studies/validate_mechanism.py --only weigh"
DECIDES = 10.0  # of AIC: a likelihood ratio of 150, if a model fitted and residuals were independent
FITS = 0.01     # probability of a larger misfit
STRAIN = ("strain", "rows_strain")


def kept(phi, rows):
    """{law: row} of the most runs, in the medium of sound and pushes."""
    found = [row for row in results.table(KEPT) if (float(row["phi"]), int(row["rows"]), row["medium"]) == (phi, rows, "medium")] if KEPT.is_file() else []
    most = max((int(row["runs"]) for row in found), default=0)
    return {row["model"]: row for row in found if int(row["runs"]) == most}


def strain_turns(phi):
    def judged():
        parts = []
        for rows in (0, 90):
            laws = {name: float(row["aic"]) for name, row in kept(phi, rows).items()}
            if not laws:
                return judge.unknown("no runs at these settings")
            best = min((name for name in laws if name not in STRAIN), key=laws.get)
            more = min(laws[name] for name in STRAIN) - laws[best]
            misfit = float(kept(phi, rows)[best]["misfit"])
            verdict = judge.MATCHES if more <= 0 else judge.DIFFERS if more >= DECIDES and misfit >= FITS else judge.UNKNOWN
            parts.append(judge.Judged(verdict, f"rows at {rows}°: AIC {more:+.1f} relative to {best.replace('_', ' and ')} (p = {misfit:.2g})"))
        both = judge.together(*parts)
        return judge.Judged(both.verdict, both.ours, f"criterion: no law that fits (p > {FITS}) without strain and with an AIC lower by {DECIDES:.0f}")
    return judged


def kappa(phi):
    """Of the law with strain and rows, in both directions."""
    def judged():
        laws = [kept(phi, rows).get("rows_strain") for rows in (0, 90)]
        if None in laws:
            return judge.unknown("no runs at these settings")
        pairs = [[float(law[key].split()[1]) if law[key] else nan for key in ("values", "errors")] for law in laws]
        return judge.together(*(judge.sign(*pair, +1, "v₀ μ/f") for pair in pairs))
    return judged
