#!/usr/bin/python3
"""Which mechanism made the tracks: how often the true one wins, and how often the misfit speaks. Table of studies/reports/fitting.md.

    studies/validate_rivals.py [--program build/release/rodwake] [--only choice,none,evidence,tracks] [--runs 100] [--quick] [--keep DIR]

choice: tracks of two rods that pass each other, made by strain, polar coupling, the medium's velocity, the rows of a crystal or nothing, with
noise of another seed in each set. All five are fitted to each set; counted is how often the true one has the lowest AIC, BIC and the best
cross-validation, whether its weight says so, and in how many sets its misfit is below 0.05 though it is right.
none: the same tracks with a wobble of the headings that no mechanism has; counted is in how many sets no model is said to describe the data.
evidence, tracks: rivals of a wake, or of tracks, and their parameters drawn from the priors, weights by evidence; counted is how often the true
one has the largest, beside what its own probability says. By the Python package beside the program (build/release/python); sets that --keep has
are not made again.
Some 2 s a set. --quick: 2 sets, whose numbers mean nothing.
"""

import csv
import math
import sys
from pathlib import Path

import numpy as np

from lab import parser, rows_of, run_parts, table, read_json

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
    return read_json(out, "models")


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


# By evidence. A family of rivals: priors of each, data of one with noise, and the log evidence of one for such data.

WAKES = {"force": {"f_over_mu": (0.5, 4.0), "xi": (6.0, 60.0)}, "with offset": {"f_over_mu": (0.5, 4.0), "xi": (6.0, 60.0), "offset": (-0.3, 0.3)},
         "with dipole": {"f_over_mu": (0.5, 4.0), "xi": (6.0, 60.0), "f2d_over_mu": (-30.0, 30.0)}, "offset alone": {"offset": (-0.3, 0.3)}}
PLACES, ETA, BLUR = np.linspace(-38.0, 38.0, 20), 1.3, 0.1
TRACKS = {"strain": {"kappa": (0.0, 1.0)}, "polar": {"gamma1": (-0.5, 0.5), "gamma2": (-0.5, 0.5)}, "flow": {"gamma_flow": (-1.0, 1.0)},
          "rows": {"gamma_rows": (0.0, 0.1)}, "none": {}}
START, TIMES, ALPHA = np.array([[0.0, 2.0, 0.1], [1.0, -2.0, 0.4]]), np.linspace(0.0, 8.0, 17), 0.8
POSE_SIGMA = 0.05  # f/mu and rad: strong couplings are distinguished, weak ones not


def wake_of(rodwake, random, values):
    points = np.stack([PLACES, np.ones(PLACES.size)], axis=1)
    medium = rodwake.Medium(eta=ETA, xi=values.get("xi", 20.0))
    return (values.get("f_over_mu", 0.0) * rodwake.displacement(points[:, 0], points[:, 1], medium)[:, 0]
            + values.get("f2d_over_mu", 0.0) * rodwake.dipole(points[:, 0], points[:, 1], medium)[:, 0] + values.get("offset", 0.0)
            + BLUR * random.standard_normal(PLACES.size))


def wake_evidence(rodwake, ranges, values):
    fixed = {"eta": ETA} | ({} if "xi" in ranges else {"xi": 20.0, "f_over_mu": 0.0})
    data = rodwake.Profile(PLACES, values, np.full(PLACES.size, BLUR), component="Ux", along="x", at=1.0)
    return evidence_of(rodwake, ranges, fixed, profiles=[data])


def tracks_of(rodwake, random, values):
    if "gamma_rows" in values:
        poses = in_rows(values["gamma_rows"])
    else:
        flow = values.get("gamma_flow", 0.0) / ALPHA  # turning to the medium's velocity is polar turning
        poses = rodwake.simulate(START, rodwake.Medium(eta=ETA, alpha=ALPHA), t_end=TIMES[-1], output_times=TIMES, kappa=values.get("kappa", 0.0),
                                 gamma1=values.get("gamma1", 0.0) + flow, gamma2=values.get("gamma2", 0.0) + flow * ETA).poses.copy()
    poses[1:] += POSE_SIGMA * random.standard_normal(poses[1:].shape)
    return poses


def in_rows(gamma):
    """Rods that only the rows turn: tan 3 theta falls off exponentially."""
    each = 200
    fine = np.linspace(0.0, TIMES[-1], each * (TIMES.size - 1) + 1)
    heading = np.arctan(np.tan(3.0 * START[:, 2]) * np.exp(-6.0 * gamma * fine)[:, None]) / 3.0
    way = np.stack([np.cos(heading), np.sin(heading)], axis=2)
    gone = np.concatenate([np.zeros((1, 2, 2)), np.cumsum(0.5 * (way[1:] + way[:-1]), axis=0) * (fine[1] - fine[0])])
    return np.concatenate([START[None, :, :2] + gone, heading[:, :, None]], axis=2)[::each]


def track_evidence(rodwake, ranges, poses):
    fixed = {"eta": ETA, "alpha": ALPHA} | ({"rows_direction": 0.0} if "gamma_rows" in ranges else {})
    data = rodwake.Track(TIMES, poses, sigma_position=POSE_SIGMA, sigma_heading=POSE_SIGMA, start_poses="exact")
    if not ranges:  # nothing is unknown: the likelihood itself
        return rodwake.FitProblem(tracks=[data], parameters=["kappa"], bounds={"kappa": [-1.0, 1.0]}, fixed=fixed).log_likelihood([[0.0]])[0]
    return evidence_of(rodwake, ranges, fixed, tracks=[data])


def evidence_of(rodwake, ranges, fixed, **data):
    return rodwake.posterior(**data, parameters=list(ranges), bounds={one: list(ends) for one, ends in ranges.items()}, fixed=fixed,
                             start={one: np.mean(ends) for one, ends in ranges.items()}, chains=2, samples=800).log_evidence[0]


def by_evidence(kept, priors, make, evidence, sigma):
    def part(lab):
        sys.path.insert(0, str(Path(lab.program).parent / "python"))
        import rodwake  # pylint: disable=import-outside-toplevel
        file, sets = lab.folder / kept, len(priors) * sets_of(lab)
        done = rows_of(file.read_text(encoding="utf-8")) if file.is_file() else []
        with file.open("a", encoding="utf-8") as out:
            if not done:
                out.write("set,made_by," + ",".join(priors) + "\n")
            for index in range(len(done), sets):
                random, name = np.random.default_rng([index, 5]), list(priors)[index % len(priors)]
                data = make(rodwake, random, {one: random.uniform(*ends) for one, ends in priors[name].items()})
                found = {one: evidence(rodwake, ranges, data) for one, ranges in priors.items()}
                done.append({"made_by": name, **found})
                out.write(f"{index},{name}," + ",".join(repr(float(one)) for one in found.values()) + "\n")
                out.flush()
        wins(done[:sets], list(priors), sigma)
    return part


def wins(sets, names, sigma):
    """How often a rival is right where it wins, beside what its own weights say."""
    scores = np.array([[float(one[rival]) for rival in names] for one in sets])
    weights = np.exp(scores - scores.max(axis=1, keepdims=True))
    weights /= weights.sum(axis=1, keepdims=True)
    likeliest, said = weights.argmax(axis=1), weights.max(axis=1)
    true = np.array([names.index(one["made_by"]) for one in sets])
    line = lambda name, chosen, mine: [name, mine.sum(), chosen.sum(), (chosen & (likeliest == true)).sum(),
                                       f"{said[chosen].sum():.1f} +- {math.sqrt((said * (1 - said))[chosen].sum()):.1f}"]
    every = np.ones(len(sets), dtype=bool)
    table(f"Rivals and parameters from the priors, sigma {sigma}: sets in which a rival has the largest evidence, and in which it made the data",
          ["rival", "sets made by it", "largest evidence", "of these made by it", "sum of its weights there"],
          [*(line(name, likeliest == k, true == k) for k, name in enumerate(names)), line("all", every, every)])


PARTS = {"choice": choice, "none": none, "evidence": by_evidence("evidence.csv", WAKES, wake_of, wake_evidence, BLUR),
         "tracks": by_evidence("evidence_tracks.csv", TRACKS, tracks_of, track_evidence, POSE_SIGMA)}

if __name__ == "__main__":
    run_parts(parser(__doc__, "report", "quick", "keep", "runs", "threads", parts=PARTS).parse_args(), PARTS)
