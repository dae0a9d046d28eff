#!/usr/bin/python3
"""What turns two rods in the bed: rivals weighed on the tracks of pairs. The table of docs/findings.md, section 7.

    studies/validate_mechanism.py [--program build/release/rodwake] [--only beds,weigh,weights,apart] [--runs 50] [-j 2] [--quick] [--keep DIR]

beds   two rods side by side, 15 a apart, at 0.70 and 0.78, close-packed rows along and across them, walking and apolar, in batches of 25 runs;
       some 3 CPU minutes a batch. What is kept of a run are its rods at whole seconds, in studies/bed_pairs.csv; batches that are there are
       not made again, so another --runs adds to them.
weigh  each pair of walking rods as a track with noise of its own: strain, polar couplings, the medium's velocity, the rows of the crystal,
       none; AIC of all runs of a setting together, in the medium of sound and of pushes, and in that of the line. Kept in studies/mechanism.csv.
weights the table of what is kept.
apart  of all, how far rods have come together or apart, and turned, without a model.
"""

import math

import numpy as np

from lab import SOURCE, keep_row, kept_rows, mean, parser, run_parts, table, text, read_json, tracks

KEPT, WEIGHED, A, BATCH, RUNS = SOURCE / "studies/bed_pairs.csv", SOURCE / "studies/mechanism.csv", 4e-4, 25, 50
SETTINGS = [(kind, phi, rows) for kind in ("motile", "apolar") for phi in (0.78, 0.70) for rows in (0, 90)]
NUMBERS = ("x0", "y0", "theta0", "x1", "y1", "theta1")
# f/mu in a, eta, alpha: docs/findings.md, section 10.
# "line" has parameters of U_x(x, 0), which are not those of the medium.
MEDIA = {"medium": (1.48, 2.00, 0.0025), "line": (4.08, 4.4, 0.078)}
TOUCH = 6.0  # a, between their centres
SIGMA_POSITION, SIGMA_HEADING = 0.05, 0.01  # a, rad: the rods' rattling in a period, far below what they wander
FIT = """schema = 1
[fit]
name = "strain"
parameters = ["kappa", "D_r", "D_t"]
fixed = {{ eta = {eta}, alpha = {alpha} }}
bounds = {{ D_r = [1e-7, 1.0], D_t = [1e-7, 10.0] }}
start = {{ D_r = 0.003, D_t = 0.1 }}
{tracks}
[[fit.models]]
name = "polar"
set = {{ "fit.parameters" = ["gamma1", "gamma2", "D_r", "D_t"] }}
[[fit.models]]
name = "flow"
set = {{ "fit.parameters" = ["gamma_flow", "D_r", "D_t"] }}
[[fit.models]]
name = "rows"
set = {{ "fit.parameters" = ["gamma_rows", "D_r", "D_t"], "fit.fixed.rows_direction" = {direction} }}
[[fit.models]]
name = "rows_flow"
set = {{ "fit.parameters" = ["gamma_rows", "gamma_flow", "D_r", "D_t"], "fit.fixed.rows_direction" = {direction} }}
[[fit.models]]
name = "rows_strain"
set = {{ "fit.parameters" = ["gamma_rows", "kappa", "D_r", "D_t"], "fit.fixed.rows_direction" = {direction} }}
[[fit.models]]
name = "none"
set = {{ "fit.parameters" = ["D_r", "D_t"] }}
"""
TRACK = """[[fit.trajectories]]
file = "{file}"
f_over_mu = {scale}
speed = {speed}
sigma_position = {position}
sigma_heading = {heading}
"""


def name_of(kind, phi, rows):
    return f"{kind}_{phi:.2f}_{rows}"


def scene(kind, rows):
    """That of the shipped scenes; apolar rods are followed for as long as rods that walk take for half a box."""
    lines = (SOURCE / f"scenes/pair_unstrained_{rows}.toml").read_text(encoding="utf-8").splitlines()
    if kind == "apolar":
        lines = [line.replace('"motile"', '"apolar"').replace('"60 s"', '"14 s"') for line in lines if not line.startswith("stop_at_travel")]
    return "\n".join(lines) + "\n"


def seconds_of(track):
    """Rows of whole seconds from t = 0 on: t, and the rods in a and rad."""
    keep = [int(np.argmin(np.abs(track["t"] - t))) for t in np.arange(0.0, track["t"][-1] + 1e-9, 1.0)]
    return [{"t": round(track["t"][k])} | {one: round(float(track[one][k]) / (1.0 if one.startswith("theta") else A), 3) + 0.0 for one in NUMBERS}
            for k in keep]


def beds(lab):
    there = {(row["kind"], float(row["phi"]), int(row["rows"]), int(row["batch"])) for row in kept_rows(KEPT)}
    for batch in range(1, math.ceil((lab.options.runs or RUNS) / BATCH) + 1):
        for kind, phi, rows in SETTINGS[:1] if lab.quick else SETTINGS:
            if (kind, phi, rows, batch) in there:
                continue
            out = lab.make(f"{name_of(kind, phi, rows)}_{batch}", scene(kind, rows), f"granular.phi_b={phi:.2f}", f"granular.seed={batch}",
                           f"granular.runs={lab.count(BATCH)}", verbs=("dem",))
            for run, track in enumerate(tracks(out), 1):
                for row in seconds_of(track):
                    keep_row(None if lab.quick else KEPT, {"kind": kind, "phi": phi, "rows": rows, "batch": batch, "run": run} | row)


def pairs_of(lab, kind, phi, rows):
    """[run]: its rows as an array, t and the rods."""
    found, batches = {}, math.ceil((lab.options.runs or RUNS) / BATCH)
    for row in kept_rows(KEPT):
        if (row["kind"], float(row["phi"]), int(row["rows"])) == (kind, phi, rows) and int(row["batch"]) <= batches:
            found.setdefault((row["batch"], row["run"]), []).append([float(row[one]) for one in ("t", *NUMBERS)])
    return [np.array(one) for one in found.values()]


def apart_yet(pair):
    """Rows before the rods touch: what turns them then is no wake."""
    near = np.flatnonzero(np.hypot(pair[:, 4] - pair[:, 1], pair[:, 5] - pair[:, 2]) < TOUCH)
    return pair[:near[0]] if near.size else pair


def speed_of(pair):
    return float(np.mean([np.hypot(*np.diff(pair[:, k:k + 2], axis=0).T).sum() for k in (1, 4)]) / (pair[-1, 0] - pair[0, 0]))


def apart(lab):
    lines = []
    for setting in SETTINGS:
        pairs = pairs_of(lab, *setting)
        if not pairs:
            continue
        ahead = [0.5 * (np.ptp(one[:, 1]) + np.ptp(one[:, 4])) for one in pairs]
        change = [abs(one[-1, 5] - one[-1, 2]) - abs(one[0, 5] - one[0, 2]) for one in pairs]  # along it rods of unlike speed part
        free = [one for one in map(apart_yet, pairs) if len(one) > 1]
        until = [one[0, 5] - one[-1, 5] - one[0, 2] + one[-1, 2] for one in free]
        inward = [np.max(one[:, 6] - one[:, 3]) for one in free]  # rod 0 is the upper one
        lines.append([setting[0], setting[1], setting[2], len(pairs), *(text(mean(one)) for one in (ahead, change, until, walked(free), inward))])
    table("Pairs 15 a apart", ["rods", "phi_b", "rows, deg", "runs", "way, a", "change of the distance across, a", "of it until they touch",
                                "of that by walking along their headings", "turned towards each other by then at most, rad"], lines)


def walked(pairs):
    """How far rods have parted by what they walked along their headings."""
    return [sum(sign * float(np.sum((np.diff(one[:, k]) * np.cos(way) + np.diff(one[:, k + 1]) * np.sin(way)) * np.sin(way)))
                for sign, k in ((1, 1), (-1, 4)) for way in [0.5 * (one[1:, k + 2] + one[:-1, k + 2])]) for one in pairs]


def weigh(lab):
    """What is kept is weighed no more."""
    for medium in MEDIA:
        for kind, phi, rows in SETTINGS:
            pairs = [one for one in map(apart_yet, pairs_of(lab, kind, phi, rows)) if len(one) > 3][:4 if lab.quick else None]
            if kind == "motile" and pairs and not kept_of(phi, rows, medium, len(pairs)):
                keep_weights(lab, phi, rows, medium, pairs)
    weights(lab)


def weights(_):
    """Of the most runs that there are of a setting."""
    lines = [line_of(*setting) for setting in sorted({(float(row["phi"]), int(row["rows"]), row["medium"]) for row in kept_rows(WEIGHED)})]
    table("Rivals on the tracks of pairs", ["phi_b", "rows, deg", "medium", "runs", *(f"{one}: AIC less that of none" for one in RIVALS),
                                             "coupling of the best", "its misfit"], lines)


def keep_weights(lab, phi, rows, medium, pairs):
    (scale, eta, alpha), parts = MEDIA[medium], []
    for number, pair in enumerate(pairs):
        file = lab.write(f"pair_{phi:.2f}_{rows}_{number}.csv", "t,x0,y0,theta0,x1,y1,theta1\n" +
                         "".join(",".join(f"{value:.4f}" for value in row) + "\n" for row in pair))
        parts.append(TRACK.format(file=file, scale=scale, speed=round(speed_of(pair), 4), position=SIGMA_POSITION, heading=SIGMA_HEADING))
    out = lab.make(f"weigh_{phi:.2f}_{rows}_{medium}_{len(pairs)}",
                   FIT.format(eta=eta, alpha=alpha, direction=math.radians(rows), tracks="".join(parts)), verbs=("fit",))
    for one in read_json(out, "models")["models"]:
        names, found = RIVALS.get(one["name"], ()), one["parameters"]
        keep_row(None if lab.quick else WEIGHED, {
            "phi": phi, "rows": rows, "medium": medium, "runs": len(pairs), "model": one["name"], "aic": round(one["aic"], 2), "bic": round(one["bic"], 2),
            "misfit": f"{one['misfit']['probability']:.2g}", "couplings": " ".join(names),
            "values": " ".join(f"{found[name]['value']:.4g}" for name in names), "errors": " ".join(f"{found[name]['stderr']:.3g}" for name in names),
            "D_r": f"{found['D_r']['value']:.4g}", "D_t": f"{found['D_t']['value']:.4g}", "worst": one["misfit"]["worst"].rsplit("/", 1)[-1]})


def kept_of(phi, rows, medium, runs=None):
    """{model: row} of the most runs, or of so many."""
    found = [row for row in kept_rows(WEIGHED) if (float(row["phi"]), int(row["rows"]), row["medium"]) == (phi, rows, medium)]
    runs = runs or max((int(row["runs"]) for row in found), default=0)
    return {row["model"]: row for row in found if int(row["runs"]) == runs}


RIVALS = {"strain": ("kappa",), "polar": ("gamma1", "gamma2"), "flow": ("gamma_flow",), "rows": ("gamma_rows",),
          "rows_flow": ("gamma_rows", "gamma_flow"), "rows_strain": ("gamma_rows", "kappa")}


def line_of(phi, rows, medium):
    found = kept_of(phi, rows, medium)
    best, none = min(found.values(), key=lambda one: float(one["aic"])), float(found["none"]["aic"])
    coupling = ", ".join(f"{name} = {value} +- {error}" for name, value, error in zip(*(best[key].split() for key in ("couplings", "values", "errors"))))
    return [phi, rows, medium, best["runs"], *(f"{float(found[one]['aic']) - none:+.1f}" for one in RIVALS), f"{best['model']}: {coupling}",
            f"{float(best['misfit']):.2g}"]


PARTS = {"beds": beds, "weigh": weigh, "weights": weights, "apart": apart}

if __name__ == "__main__":
    run_parts(parser(__doc__, "report", "runs", "threads", "quick", "keep", parts=PARTS, chosen=("beds", "weigh", "apart")).parse_args(), PARTS)
