#!/usr/bin/python3
"""The bed as an elastic medium: every table of docs/validation_bed.md, "The bed as a medium".

    studies/validate_medium.py [--program build/release/rodwake] [--only sound,static,strain,moving,drag,monopole,pairs,scaling,spread,moments,tail,scaling_310] [--quick]
                             [-j 2] [--keep DIR]

Prints Markdown, a part at a time, and before each the CPU time that it takes at most. --keep DIR keeps runs and takes up what is
there, so an interrupted command goes on; without it they are removed. --quick: runs of 3 s, to see that everything works; its
numbers mean nothing (some minutes: the box of 155 a). spread reads the maps of scaling,
moments those of monopole and scaling. tail reads the reduced runs of studies/medium/tail and makes those that are missing.
scaling_310 runs only when named.
"""

import argparse
import subprocess
import tempfile
import time

from medium import drag, moments, monopole, moving, pairs, scaling, sound, spread, static, strain, tail
from medium.lab import COST, SOURCE, Lab

PARTS = {"sound": (sound.part, sound.cost), "static": (static.part, static.cost), "strain": (strain.part, strain.cost),
         "moving": (moving.part, moving.cost),
         "drag": (drag.part, drag.cost),
         "monopole": (monopole.part, monopole.cost), "pairs": (pairs.part, pairs.cost), "scaling": (scaling.part, scaling.cost),
         "spread": (spread.part, spread.cost), "moments": (moments.part, moments.cost),
         "tail": (tail.part, tail.cost),
         "scaling_310": (lambda lab: scaling.part(lab, 310), lambda: scaling.cost(310))}
NAMED_ONLY = {"scaling_310"}


def options_of():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", default=str(SOURCE / "build/release/rodwake"))
    parser.add_argument("--only", default=",".join(name for name in PARTS if name not in NAMED_ONLY), help="parts, comma-separated: " + ", ".join(PARTS))
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("-j", type=int, default=2, help="threads")
    parser.add_argument("--keep", help="folder for the runs; otherwise they are removed")
    options = parser.parse_args()
    unknown = [part for part in options.only.split(",") if part not in PARTS]
    if unknown:
        parser.error(f"no such part: {', '.join(unknown)}; there are {', '.join(PARTS)}")
    return options


def main():
    options = options_of()
    with tempfile.TemporaryDirectory() as scratch:
        lab = Lab(options, options.keep or scratch)
        version = subprocess.run([options.program, "--version"], capture_output=True, text=True, check=True).stdout.strip()
        print(f"{version}, {time.strftime('%Y-%m-%d')}" + (" (quick: numbers mean nothing)" if options.quick else ""))
        for name in options.only.split(","):
            make, cost = PARTS[name]
            hours = cost() * COST / 3600
            if not options.quick:
                print(f"\n{name}: at most {hours:.1f} CPU hours" if hours > 0.95 else f"\n{name}: at most {60 * hours:.0f} CPU minutes", flush=True)
            began = time.monotonic()
            make(lab)
            print(f"({name}: {time.monotonic() - began:.0f} s)", flush=True)


if __name__ == "__main__":
    main()
