#!/usr/bin/python3
"""Which mechanism made the tracks: how often the true one wins, and how often the misfit speaks. Table of docs/validation_fitting.md.

    studies/validate_rivals.py [--program build/release/rodwake] [--only choice] [--runs 100] [--quick] [--keep DIR]

choice: tracks of two rods that pass each other, made by strain, polar coupling, the medium's velocity, the rows of a crystal or nothing, with
noise of another seed in each set. All five are fitted to each set; counted is how often the true one has the lowest AIC, BIC and the best
cross-validation, whether its weight says so, and in how many sets its misfit is below 0.05 though it is right.
none: the same tracks with a wobble of the headings that no mechanism has; counted is in how many sets no model is said to describe the data.
Some 2 s a set. --quick: 2 sets, whose numbers mean nothing.
"""

import csv

import numpy as np

from lab import parser, run_parts, table, told

SETS, SIGMA, WOBBLE = 100, 0.01, 0.02
MEDIUM = "[medium]\neta = 1.3\nalpha = 0.8\n"
PAIR = """schema = 1
{medium}[coupling]
{coupling}
[[rods]]
position = [0.0, 1.5]
heading = 0.1
[[rods]]
position = [1.0, -1.5]
heading = 0.4
[rods_run]
t_end = 8.0
output_interval = 0.5
"""
MADE = {"strain": "kappa = 0.3", "polar": "gamma1 = 0.4\ngamma2 = -0.4", "flow": "gamma_flow = 0.6", "rows": "gamma_rows = 0.03", "none": "kappa = 0.0"}
RIVALS = """schema = 1
[fit]
name = "strain"
parameters = ["kappa"]
fixed = {{ eta = 1.3, alpha = 0.8 }}
[[fit.trajectories]]
file = "{file}"
sigma_position = {sigma}
sigma_heading = {sigma}
[[fit.models]]
name = "polar"
set = {{ "fit.parameters" = ["gamma1", "gamma2"] }}
[[fit.models]]
name = "flow"
set = {{ "fit.parameters" = ["gamma_flow"] }}
[[fit.models]]
name = "rows"
set = {{ "fit.parameters" = ["gamma_rows"], "fit.fixed.rows_direction" = 0.0 }}
[[fit.models]]
name = "none"
set = {{ "fit.parameters" = [] }}
"""


def made(lab, name):
    """Head and rows of the tracks without noise."""
    out = lab.make(f"made_{name}", PAIR.format(medium=MEDIUM, coupling=MADE[name]), verbs=("rods",))
    head, *rows = csv.reader((out / "rods.csv").read_text(encoding="utf-8").splitlines())
    return head, np.array(rows, dtype=float)


def weighed(lab, name, number, wobble=0.0):
    """models.json of one set."""
    head, rows = made(lab, name)
    random = np.random.default_rng([number, sorted(MADE).index(name)])
    rows = rows.copy()
    rows[:, 1:] += SIGMA * random.standard_normal(rows[:, 1:].shape)
    for column in (3, 6):
        rows[:, column] += wobble * np.sin(2.0 * rows[:, 0] + random.uniform(0, 2 * np.pi))
    case = f"{name}_{number}{'_wobble' if wobble else ''}"
    file = lab.write(f"{case}.csv", ",".join(head) + "\n" + "".join(",".join(map(repr, row)) + "\n" for row in rows.tolist()))
    out = lab.make(f"fit_{case}", RIVALS.format(file=file, sigma=SIGMA), verbs=("fit",))
    return told(out, "models")


def sets_of(lab):
    return lab.count(lab.options.runs or SETS)


def best(models, score):
    return min(models, key=score)["name"]


def choice(lab):
    rows = []
    for name in MADE:
        sets = [weighed(lab, name, number)["models"] for number in range(sets_of(lab))]
        true = [next(one for one in models if one["name"] == name) for models in sets]
        count = lambda score: sum(best(models, score) == name for models in sets)
        rows.append([name, count(lambda one: one["aic"]), count(lambda one: one["bic"]),
                     count(lambda one: -one["cross_validation"]["log_likelihood"]), f"{sum(one['weight'] for one in true):.1f}",
                     sum(one["misfit"]["probability"] < 0.05 for one in true)])
    table(f"{sets_of(lab)} sets of each mechanism, sigma {SIGMA}: sets in which the true one wins",
          ["made by", "AIC", "BIC", "cross-validation", "sum of its weights", "misfit below 0.05"], rows)


def none(lab):
    rows = []
    for name in MADE:
        sets = [weighed(lab, name, number, WOBBLE) for number in range(sets_of(lab))]
        rows.append([name, sum(any(text.startswith("No model offered") for text in one["text"]) for one in sets)])
    table(f"{sets_of(lab)} sets with a wobble of {WOBBLE} rad in the headings: sets in which no model is said to describe the data",
          ["made by", "no model describes"], rows)


PARTS = {"choice": choice, "none": none}

if __name__ == "__main__":
    run_parts(parser(__doc__, "quick", "keep", "runs", "threads", parts=PARTS).parse_args(), PARTS)
