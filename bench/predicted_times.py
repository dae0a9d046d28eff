#!/usr/bin/python3
"""What `rodwake check` says that a stage will take, beside the CPU seconds that it took, start of the program and files included.

Shipped scenes, some shortened or enlarged by a key; each stage by its own verb, on one thread. Prints Markdown; takes some five minutes,
--quick half a minute.
"""

import argparse
import re
import resource
import tempfile
from pathlib import Path
from typing import NamedTuple

import measure

UNITS = {"ns": 1e-9, "us": 1e-6, "ms": 1e-3, "s": 1.0, "CPU seconds": 1.0}


class Case(NamedTuple):
    verb: str
    scene: str
    settings: tuple = ()
    quick: bool = True


CASES = (
    Case("rods", "scenes/crowd.toml"),
    Case("rods", "scenes/pair.toml", ("medium.periodic=20", "rods_run.method=bdf")),
    Case("field", "scenes/pair.toml", ("field.nx=2000", "field.ny=1000")),
    Case("scan", "scenes/phase_gamma_zero.toml"),
    Case("scan", "scenes/phase_perpendicular.toml"),
    Case("scan", "scenes/capture_basin.toml"),
    Case("scan", "scenes/pair_density_quick.toml", (), False),
    Case("fit", "fitting/problems/monopole.toml"),
    Case("dem", "scenes/granular_quick.toml"),
    Case("dem", "scenes/rod_in_bed.toml", (), False),
    Case("dem", "scenes/wake.toml", ("granular.runs=1", "granular.duration=10 s"), False),
    Case("dem", "scenes/order.toml", ("granular.runs=1", "granular.duration=10 s", "variants="), False),
)
STAGES = {"rods": "rods", "field": "field maps", "scan": "scan", "fit": "fit", "dem": "granular run"}


def predicted(program, case, arguments):
    """The last time on the stage's line that is not one of a part: of all runs, if there are several."""
    text = measure.run([program, "check", *arguments]).split("# expected cost\n")[1]
    line = next(line for line in text.splitlines() if line.startswith(f"  {STAGES[case.verb]}: "))
    line = re.split(r": \d+ steps|; less,", line)[0]
    for words in (r"([\d.e+]+) (for) all \d+ beds", r"([\d.e+]+) (in all)", r"([\d.e+]+)( s|) for \S+ runs", r"about ([\d.e+]+) (CPU seconds|[num]?s)\b"):
        if found := re.search(words, line):
            return float(found[1]) * UNITS.get(found[2].strip(), 1.0)
    raise measure.Problem(f"no time in \"{line}\"")


def took(program, case, arguments, folder):
    def spent():
        used = resource.getrusage(resource.RUSAGE_CHILDREN)
        return used.ru_utime + used.ru_stime
    before = spent()
    measure.run([program, case.verb, *arguments, "--quiet", "-j", "1", "-o", folder])
    return spent() - before


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", help="rodwake [build/release/rodwake]")
    parser.add_argument("--quick", action="store_true", help="the short ones")
    options = parser.parse_args()
    program = str(measure.find_program(options.program))
    print(*measure.conditions(), "", sep="\n", flush=True)
    measure.print_table(("verb, scene", "predicted, s", "took, s", "took/predicted"), [])
    with tempfile.TemporaryDirectory() as folder:
        for number, case in enumerate(CASES):
            if options.quick and not case.quick:
                continue
            arguments = [str(measure.SOURCE / case.scene), *(word for one in case.settings for word in ("-s", one))]
            before, after = predicted(program, case, arguments), took(program, case, arguments, str(Path(folder) / str(number)))
            print(f"| {case.verb} {case.scene}{''.join(f', {one}' for one in case.settings)} | {before:.2g} | {after:.2g} | {after / before:.2g} |",
                  flush=True)


if __name__ == "__main__":
    measure.main(main)
