#!/usr/bin/python3
"""Validation of the calibration: every number of docs/validation_fitting.md about fits.

    studies/validate_fit.py [--program build/release/rodwake] [--tests build/test/tests/test_fitting] [--only periodic,nist,synthetic,problems,variations,speed,quickstart]
                          [-j 2] [--keep DIR]

nist and synthetic need a tree with tests (--tests names test_fitting of it), speed the benchmarks beside --program. Prints Markdown.
"""

import argparse
import csv
import json
import math
import re
import subprocess
import sys
import tempfile
import time
import tomllib
from pathlib import Path

SOURCE = Path(__file__).resolve().parent.parent


def call(*command, check=True):
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True)
    if check and done.returncode != 0:
        sys.exit(f"{' '.join(map(str, command))}: exit code {done.returncode}\n{done.stdout}{done.stderr}")
    return done


def with_error(parameter):
    error = parameter["stderr"]
    if not parameter["free"]:
        return f"{parameter['value']:.4g} (not fitted)"
    if parameter["at_bound"]:
        return f"{parameter['value']:.4g} (at its {parameter['at_bound']} bound)"
    return f"{parameter['value']:.4g} " + ("(no error)" if error is None else f"+- {error:.2g}")


def print_fit(name, fit):
    values = ", ".join(f"{key} = {with_error(one)}" for key, one in fit["parameters"].items())
    print(f"\n**{name}**: {values}; chi2 = {fit['chi2']:.1f} for {fit['dof']}, {fit['termination']}, "
          f"{fit['same_optimum']} of {len(fit['starts'])} starts at this optimum")
    print("\n| profile | role | points | chi2 | data over model |\n|---|---|---|---|---|")
    for one in fit["profiles"]:
        excess = one["excess"]
        print(f"| {one['component']} along {one['along']} at {one['at']} | {one['role']} | {one['used']} | {one['chi2']:.1f} | "
              f"{excess['scale']:.2f} +- {excess['stderr']:.2f} |")
    for other in fit["compare"]:
        print(f"\nwith {other['name']}'s values: chi2 = {other['chi2']:.0f}; data over model "
              + ", ".join(f"{one['excess']['scale']:.2f} +- {one['excess']['stderr']:.2f}" for one in other["profiles"]))
    for remark in fit["remarks"]:
        print(f"\n- {remark}")


def problems(options, folder):
    for problem in sorted((SOURCE / "fitting/problems").glob("*.toml")):
        out = folder / problem.stem
        call(options.program, "fit", problem, "-o", out, "--force", "-j", options.j, "--quiet")
        print_fit(problem.stem, json.loads((out / "fit.json").read_text()))


def periodic(options, folder):
    """The reference points through the program; errors relative to the value itself, which is stricter than to the largest."""
    file = SOURCE / "tests/data/periodic_field.csv"
    rows = list(csv.DictReader(line for line in file.read_text().splitlines() if not line.startswith("#")))
    answer = list(csv.DictReader(call(options.program, "field", "--points", file).stdout.splitlines()))
    for names in (("Ux", "Uy"), ("exx", "exy", "eyy")):
        worst = 0.0
        for row, got in zip(rows, answer, strict=True):
            error = math.hypot(*(float(row[name]) - float(got[name]) for name in names))
            worst = max(worst, error / math.hypot(*(float(row[name]) for name in names)))
        print(f"{', '.join(names)}: worst error relative to the point's own value {worst:.1e}, {len(rows)} points")


def nist(options, folder):
    print(call(options.tests, "[.table]", check=False).stdout)


def synthetic(options, folder):
    print(call(options.tests, "[long]", check=False).stdout)


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


def variations(options, folder):
    """What docs/fitting.md says of other models and cores."""
    with_x0, with_offset = (json.dumps(["f_over_mu", "eta", "xi", name]) for name in ("x0", "offset"))
    cases = {"eta = 1.3 held": varied("monopole.toml", **held("monopole.toml", eta=1.3)),
             "infinite plane": varied("monopole.toml", box=None),
             "infinite plane with an offset": varied("monopole.toml", box=None, parameters=with_offset),
             "place of the force free": varied("monopole.toml", parameters=with_x0),
             "dipole alone in the medium of the monopole": varied("dipole.toml", **held("dipole.toml", f_over_mu=4.081, eta=4.439, xi=52.16)),
             **{f"core {core} a": varied("monopole.toml", core=core) for core in (8, 12, 14)}}
    for number, (name, text) in enumerate(cases.items()):
        (folder / f"variation_{number}.toml").write_text(text)
        out = folder / f"variation_{number}"
        call(options.program, "fit", folder / f"variation_{number}.toml", "-o", out, "--force", "-j", options.j, "--quiet")
        print_fit(name, json.loads((out / "fit.json").read_text()))


def speed(options, folder):
    print(call(SOURCE / "bench/wake_fit.py", "--programs", Path(options.program).parent / "bench").stdout)


def quickstart(options, folder):
    start = time.perf_counter()
    out = folder / "quickstart"
    call(options.program, "run", SOURCE / "scenes/quickstart.toml", "-o", out, "--force", "-j", options.j, "--quiet")
    print(f"\nrodwake run scenes/quickstart.toml -j {options.j}: {time.perf_counter() - start:.0f} s, report.html "
          f"{(out / 'report.html').stat().st_size / 1e6:.1f} MB")
    print_fit("quickstart", json.loads((out / "fit.json").read_text()))
    print("\nmedium:", (out / "medium.json").read_text().strip(), "\noutcome:", json.loads((out / "outcome.json").read_text())["outcome"])


PARTS = {"periodic": periodic, "nist": nist, "synthetic": synthetic, "problems": problems, "variations": variations, "speed": speed, "quickstart": quickstart}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", default=SOURCE / "build/release/rodwake")
    parser.add_argument("--tests", default=SOURCE / "build/dev/tests/test_fitting")
    parser.add_argument("--only", default=",".join(PARTS))
    parser.add_argument("-j", type=int, default=2)
    parser.add_argument("--keep")
    options = parser.parse_args()
    chosen = options.only.split(",")
    if unknown := [name for name in chosen if name not in PARTS]:
        parser.error(f"no such part: {', '.join(unknown)}; there are {', '.join(PARTS)}")
    with tempfile.TemporaryDirectory() as scratch:
        folder = Path(options.keep or scratch)
        folder.mkdir(parents=True, exist_ok=True)
        for name in chosen:
            print(f"\n## {name}", flush=True)
            PARTS[name](options, folder)


if __name__ == "__main__":
    main()
