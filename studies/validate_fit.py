#!/usr/bin/python3
"""Validation of the calibration: every number of studies/reports/fitting.md about fits.

    studies/validate_fit.py [--program build/release/rodwake] [--tests build/test/tests/test_fitting] [-j 2] [--keep DIR]
                            [--only periodic,nist,synthetic,problems,variations,speed,quickstart,moments]
    studies/validate_fit.py --mean-track RUN_DIRECTORY [--step 0.5] > pair.csv

nist and synthetic need a tree with tests (--tests names test_fitting of it), speed the benchmarks beside --program. Prints Markdown.
--mean-track makes data for trajectory fits ([[fit.trajectories]]) of the runs of a granular ensemble (RUN_DIRECTORY/runs/*/tracks.csv;
of a variant: RUN_DIRECTORY/variants/NAME): t,x0,y0,theta0,x1,... from t = 0 to the end of the shortest run, means over the runs,
lengths in bead radii a, times in s. The comment line gives the mean standard errors and the mean speed.
"""

import json
import math
import re
import subprocess
import sys
import time
import tomllib
from pathlib import Path

import numpy as np

from lab import SOURCE, markdown, mean, parser, run_parts, text, read_json, tracks
from medium import monopole, spread
from validate_field import periodic

BEAD_RADIUS = 4e-4  # m


def with_error(parameter):
    error = parameter["stderr"]
    if not parameter["free"]:
        return f"{parameter['value']:.4g} (not fitted)"
    if parameter["at_bound"]:
        return f"{parameter['value']:.4g} (at its {parameter['at_bound']} bound)"
    return f"{parameter['value']:.4g} " + ("(no error)" if error is None else f"+- {error:.2g}")


def print_fit(name, folder):
    fit = read_json(folder, "fit")
    values = ", ".join(f"{key} = {with_error(one)}" for key, one in fit["parameters"].items())
    print(f"\n**{name}**: {values}; chi2 = {fit['chi2']:.1f} for {fit['dof']}, {fit['termination']}, "
          f"{fit['same_optimum']} of {len(fit['starts'])} starts at this optimum\n")
    print(markdown(["profile", "role", "points", "chi2", "data over model"],
                   [[f"{one['component']} along {one['along']} at {one['at']}", one["role"], one["used"], f"{one['chi2']:.1f}", excess(one)]
                    for one in fit["profiles"]]))
    for other in fit["compare"]:
        print(f"\nwith {other['name']}'s values: chi2 = {other['chi2']:.0f}; data over model " + ", ".join(map(excess, other["profiles"])))
    for remark in fit["remarks"]:
        print(f"\n- {remark}")


def excess(profile):
    return f"{profile['excess']['scale']:.2f} +- {profile['excess']['stderr']:.2f}"


def fitted(lab, name, file):
    """The folder of a fit; its problem stays where it is, since it names data beside it."""
    out = lab.folder / name
    lab.call("fit", file, "-o", out, "--force", "-j", lab.threads, "--quiet")
    return out


def problems(lab):
    for problem in sorted((SOURCE / "fitting/problems").glob("*.toml")):
        print_fit(problem.stem, fitted(lab, problem.stem, problem))


def of_tests(words):
    """Prints what test_fitting prints of the tests of this tag."""
    return lambda lab: print(subprocess.run([lab.options.tests, words], capture_output=True, text=True, check=False).stdout)


def held(problem, **values):
    """The problem with only the first of its parameters that are not among the values fitted, and no bounds or starts of the held ones."""
    scene = tomllib.loads((SOURCE / "fitting/problems" / problem).read_text())["fit"]
    free = [name for name in scene["parameters"] if name not in values]
    table = lambda entries: "{ " + ", ".join(f"{name} = {value}" for name, value in entries.items()) + " }"
    kept = lambda key: table({name: value for name, value in scene.get(key, {}).items() if name in free})
    return {"parameters": json.dumps(free), "start": kept("start"), "bounds": kept("bounds"), "fixed": table(values)}


def varied(problem, **keys):
    """The text of a problem with other values of keys of [fit] (None: without that key), no figures and no profile likelihood."""
    text = (SOURCE / "fitting/problems" / problem).read_text().split("[[figures]]")[0].replace("../data", str(SOURCE / "fitting/data"))
    head, *profiles = text.split("[[fit.profiles]]")
    for name, value in {"likelihood": None, **keys}.items():
        head = re.sub(rf"^{name} = .*\n", "", head, flags=re.MULTILINE)
        head += "" if value is None else f"{name} = {value}\n"
    data, *_ = "[[fit.profiles]]".join(["", *profiles]).split("[[fit.compare]]")
    return head + data


def variations(lab):
    """What docs/fit.md says of other models and cores."""
    with_x0, with_offset = (json.dumps(["f_over_mu", "eta", "xi", name]) for name in ("x0", "offset"))
    cases = {"eta = 1.3 held": varied("monopole.toml", **held("monopole.toml", eta=1.3)),
             "infinite plane": varied("monopole.toml", box=None),
             "infinite plane with an offset": varied("monopole.toml", box=None, parameters=with_offset),
             "place of the force free": varied("monopole.toml", parameters=with_x0),
             "dipole alone in the medium of the monopole": varied("dipole.toml", **held("dipole.toml", f_over_mu=4.081, eta=4.439, xi=52.16)),
             **{f"core {core} a": varied("monopole.toml", core=core) for core in (8, 12, 14)}}
    for number, (name, text) in enumerate(cases.items()):
        print_fit(name, fitted(lab, f"variation_{number}", lab.write(f"variation_{number}.toml", text)))


def speed(lab):
    command = [SOURCE / "bench/wake_fit.py", "--programs", Path(lab.program).parent / "bench"]
    print(subprocess.run(command, capture_output=True, text=True, check=True).stdout)


SEEDS = (1, 2, 3, 4)
# f/mu (a), eta and xi (a) of a free rod by sound and pushes: validate_medium.py --only monopole, table "The medium's own parameters"
MEASURED = {"bed at rest": ((1.48, 0.03), (2.00, 0.08), (581, 8)), "bed with this rod": ((1.78, 0.10), (2.86, 0.44), (481, 26))}
MEASURED_AT = 2.48, 13.94  # a/s and 1/s: speed of that rod through the bed and drag of a push, which its xi goes with
MEDIUM = {"f_over_mu": 2, "eta": 2, "xi": 0}  # digits


def quick_start(lab, seed):
    start, out = time.perf_counter(), lab.folder / f"quickstart_{seed}"
    if not (out / "report.html").exists():
        lab.call("run", SOURCE / "scenes/quickstart.toml", "-o", out, "--force", "-j", lab.threads, "--quiet", "--seed", seed)
        print(f"\nrodwake run scenes/quickstart.toml -j {lab.threads} --seed {seed}: {time.perf_counter() - start:.0f} s, report.html "
              f"{(out / 'report.html').stat().st_size / 1e6:.1f} MB")
    return out


def quickstart(lab):
    found = []
    for seed in SEEDS:
        out = quick_start(lab, seed)
        print_fit(f"quickstart, seed {seed}", out)
        errors, drift = read_json(out, "fit")["systematics"]["errors"], read_json(out, "measure")["mechanics"]
        found.append([*((errors[name]["value"], errors[name]["total"]) for name in MEDIUM),
                      *((drift[name]["value"], drift[name]["error"]) for name in ("speed", "drag_rate"))])
    overall = [mean([one[k][0] for one in found]) for k in range(len(found[0]))]
    rows = [[name, *cells(one), *(apart(one, other) for other in MEASURED.values())]
            for name, one in zip((*(f"seed {seed}" for seed in SEEDS), "mean, error of the scatter"), (*found, overall))]
    rows += [[name, *cells([*one, *((value, math.nan) for value in MEASURED_AT)]), "", ""] for name, one in MEASURED.items()]
    print("\n" + markdown(["", "f/mu, a", "eta", "xi, a", "speed, a/s", "drag, 1/s", *(f"apart from the {name}, in errors" for name in MEASURED)],
                          rows))


def cells(values):
    return [text(one, digits=digits) for one, digits in zip(values, (*MEDIUM.values(), 2, 2))]


def apart(values, others):
    """f/mu, eta, and xi as it would be at this speed and drag."""
    *values, (speed, _), (drag, _) = values
    scale = math.prod(MEASURED_AT) / (speed * drag)
    *others, (xi, error) = others
    others = [*others, (scale * xi, scale * error)]
    return ", ".join(f"{(a - b) / math.hypot(da, db):+.1f}" for (a, da), (b, db) in zip(values, others))


TRUTH, TRUE_ORDER = (1.48, 2.0), 7   # f/mu (a) and eta of the made-up map, and of its moments the highest
ORDERS, TRIED = (2, 3, 4), ((8, 10), (12, 14), (10, 16), (8, 20))  # of the fits; strip and radius of their masks, a
ETAS = np.geomspace(0.5, 8.0, 15)
SPACING = (1 / 4.2) ** 2             # values that a bin of 1 a is worth


def sources(x, y, eta, order):
    """Fields of a rod's force and its moments up to an order, mu = 1. The drag hardly matters: it is that of the bed at rest."""
    medium = spread.Medium(x, y, (1 + eta, 1 + eta, eta - 1, 1.0), 1 / 581, 0.0, 0.0, 1.0, width=1.0)
    half = monopole.ROD_LENGTH / 2
    return [medium.line(-half, half), *medium.dipoles(), *(one for n in range(2, order + 1) for one in medium.moments(n))]


def fitted_medium(data, fields, count):
    """f/mu and eta: where a parabola through chi2 of the three best of ETAS is least."""
    found = [data.fit(one[:count]) for one in fields]
    best = min(max(int(np.argmin([chi2 for _, chi2, _ in found])), 1), len(ETAS) - 2)
    near, at = slice(best - 1, best + 2), np.log(ETAS[best - 1:best + 2] / ETAS[best])
    a, b, _ = np.polyfit(at, [chi2 for _, chi2, _ in found[near]], 2)
    return np.polyval(np.polyfit(at, [one[0] for one, *_ in found[near]], 2), -b / (2 * a)), ETAS[best] * math.exp(-b / (2 * a))


def moments(lab):
    """Which moments and masks give a known medium back: its map has the moments that describe the quick start's, and no noise."""
    one, = spread.maps([quick_start(lab, SEEDS[0])])
    x, y, strength = one["x"], one["y"], TRUTH[0]
    force, *rest = sources(x, y, TRUTH[1], TRUE_ORDER)
    less = one | {name: one[name] - strength * field for name, field in zip(("Ux", "Uy"), force)}
    found, chi2, dof = spread.Data([less], TRIED[0], SPACING).fit(rest)
    Ux, Uy = strength * force + sum(size * field for size, field in zip(found[:-1], rest))
    fields = [sources(x, y, eta, max(ORDERS)) for eta in ETAS]
    rows = [[order, *("{:.2f}; {:.2f}".format(*fitted_medium(spread.Data([one | {"Ux": Ux, "Uy": Uy}], mask, SPACING), fields, 1 + 2 * order))
                      for mask in TRIED)] for order in ORDERS]
    print(f"\nMade up: f/mu = {TRUTH[0]} a, eta = {TRUTH[1]}, moments up to {TRUE_ORDER} (chi2 {chi2:.0f} for {dof:.0f} in the quick start's map). "
          "Found: f/mu; eta\n\n" + markdown(["moments up to", *(f"strip {strip} a, radius {radius} a" for strip, radius in TRIED)], rows))


def mean_track(folder, step):
    runs = tracks(folder)
    if len(runs) < 2:
        sys.exit(f"{folder}: {len(runs)} runs with tracks.csv; a mean with an error needs two")
    rods = sum(name.startswith("theta") for name in runs[0])
    names = ["t"] + [f"{name}{rod}" for rod in range(rods) for name in ("x", "y", "theta")]
    walked = [np.array([run[name][run["t"] >= -1e-9] for name in names]).T for run in runs]
    every = max(round(step / (walked[0][1, 0] - walked[0][0, 0])), 1)
    scale = np.array([1.0] + [BEAD_RADIUS, BEAD_RADIUS, 1.0] * rods)
    all_runs = np.stack([one[:min(map(len, walked)):every] for one in walked]) / scale
    mean, error = all_runs.mean(0), all_runs.std(0, ddof=1)[1:] / np.sqrt(len(runs))
    by_kind = error[:, 1:].reshape(len(error), rods, 3)
    speeds = [np.hypot(*(mean[-1, c:c + 2] - mean[0, c:c + 2])) / mean[-1, 0] for c in range(1, 3 * rods, 3)]
    print(f"# mean of {len(runs)} runs; lengths in bead radii, s; standard errors {by_kind[..., :2].mean():.3g} a and {by_kind[..., 2].mean():.3g} rad; "
          f"mean speed {np.mean(speeds):.4g} a/s")
    print("\n".join([",".join(names), *(",".join(f"{value:.17g}" for value in row) for row in mean)]))


PARTS = {"periodic": periodic, "nist": of_tests("[.table]"), "synthetic": of_tests("[long]"), "problems": problems, "variations": variations, "speed": speed,
         "quickstart": quickstart, "moments": moments}


def main():
    found = parser(__doc__, "report", "threads", "keep", parts=PARTS)
    found.add_argument("--tests", type=Path, default=SOURCE / "build/dev/tests/test_fitting")
    found.add_argument("--mean-track", type=Path, metavar="RUN_DIRECTORY", help="prints the mean paths of its rods, and nothing else")
    found.add_argument("--step", type=float, default=0.5, help="s between the rows of --mean-track")
    options = found.parse_args()
    if options.mean_track:
        mean_track(options.mean_track, options.step)
    else:
        run_parts(options, PARTS, lambda name: print(f"\n## {name}", flush=True))


if __name__ == "__main__":
    main()
