"""The paper's experiments, simulated in their dish (studies/validate_dish.py): judged from the runs that it has kept."""

from math import sqrt
from pathlib import Path

from . import judge, results

KEPT = Path(__file__).parents[1] / "dish.csv"
MADE = "studies/validate_dish.py"
CONTACT = 12.0  # a, between the middles of two rods: side by side or in line they touch
FEWEST = 4      # runs, for an error


def kept(kind, **where):
    rows = results.table(KEPT) if KEPT.is_file() else []
    return [row for row in rows if row["kind"] == kind and all(abs(float(row[key]) - value) < 1e-9 for key, value in where.items())]


def mean_of(rows, name):
    values = [float(row[name]) for row in rows]
    middle = sum(values) / len(values)
    return middle, sqrt(sum((value - middle) ** 2 for value in values) / (len(values) - 1) / len(values))


def too_few(*settings):
    fewest = min(len(rows) for rows in settings)
    return judge.unknown(f"runs so far: {fewest}; an error needs {FEWEST}") if fewest < FEWEST else None


def changes(phi, expected, *distances):
    """Change of the separation over half the dish, distances at the start pooled."""
    def judged():
        runs = [kept("pair", phi=phi, distance=distance) for distance in distances]
        return too_few(*runs) or judge.sign(*judge.weighted(*zip(*(mean_of(rows, "change") for rows in runs))), expected, "a")
    return judged


def rear_turns():
    """The rod that heads across the other's way is the rear one: it turns more."""
    rows = [{"more": abs(float(row["turn1"])) - abs(float(row["turn0"]))} for row in kept("pursuit")]
    return too_few(rows) or judge.sign(*mean_of(rows, "more"), +1, "rad")


def captured():
    rows = kept("pursuit")
    if too_few(rows):
        return too_few(rows)
    many, runs = sum(float(row["closest"]) < CONTACT for row in rows), len(rows)
    share = many / runs
    found = judge.at_least(share, sqrt(max(share * (1 - share), 1 / runs) / runs), 0.5)
    return judge.Judged(found.verdict, f"{many} of {runs} runs come to contact", "criterion: half and more of the runs")


def stiff():
    """At 0.78; the error holds the bend of the mean square displacement of each run."""
    rows = kept("still", phi=0.78)
    if not rows:
        return judge.unknown("no runs at these settings")
    error = sum(float(row["stiffness_error"]) for row in rows) / len(rows)
    return judge.sign(sum(float(row["stiffness"]) for row in rows) / len(rows), error, +1, "1/a²")
