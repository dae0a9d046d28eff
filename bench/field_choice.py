#!/usr/bin/python3
"""Rods in boxes, exactly and by a table, and what medium.field = "auto" makes of it: CPU seconds of whole commands.

    bench/field_choice.py [--program build/release/rodwake] [--quick]

Prints the rows of docs/validation_elastic.md ("Tables of the field") for 2 and 8 rods in boxes of 2 to 50 xi at three tolerances, tables made
anew each time.
"""

import argparse
import json
import os
import tempfile
from pathlib import Path
from subprocess import run

SCENE = """schema = 1
[medium]
eta = 1.0
xi = 1.0
periodic = {side}
field = {field}
[coupling]
kappa = 1.0
[rods_random]
count = {rods}
extent = {side}
min_separation = {apart}
seed = 3
[rods_run]
t_end = {t_end}
rtol = {rtol}
output_interval = {t_end}
"""


def measured(program, **keys):
    """CPU seconds and what the solver tells."""
    with tempfile.TemporaryDirectory() as folder:
        scene = Path(folder) / "scene.toml"
        scene.write_text(SCENE.format(apart=0.2 * keys["side"] / keys["rods"]**0.5, **keys))
        before = os.times()
        run([program, "rods", scene, "-o", f"{folder}/run", "--quiet", "-j", "1"], check=True, env=os.environ | {"XDG_CACHE_HOME": folder})
        after = os.times()
        seconds = after.children_user + after.children_system - before.children_user - before.children_system
        return seconds, json.loads((Path(folder) / "run/outcome.json").read_text())["solver"]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", default="build/release/rodwake", type=Path)
    parser.add_argument("--quick", action="store_true", help="a trial: one box")
    options = parser.parse_args()
    print("| rods | L/xi | rtol | right-hand sides | exact, s | table, s | auto |\n|---|---|---|---|---|---|---|")
    for rods, t_end in (2, 20.0), (8, 5.0):
        for side in (2.0,) if options.quick else (2.0, 5.0, 20.0, 50.0):
            for rtol in 1e-4, 1e-6, 1e-8:
                keys = {"rods": rods, "t_end": t_end, "side": side, "rtol": rtol}
                exact, solver = measured(options.program.resolve(), field='"exact"', **keys)
                table, _ = measured(options.program.resolve(), field=f'"table"\ntable.tolerance = {rtol}', **keys)
                chosen = measured(options.program.resolve(), field='"auto"', **keys)[1]["field"]
                print(f"| {rods} | {side:g} | {rtol:g} | {solver['rhs_evaluations']} | {exact:.2f} | {table:.2f} | {chosen} |", flush=True)


if __name__ == "__main__":
    main()
