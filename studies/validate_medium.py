#!/usr/bin/python3
"""The bed as an elastic medium: every table of studies/reports/bed.md, "The bed as a medium".

    studies/validate_medium.py [--program build/release/rodwake] [--only sound,static,strain,moving,drag,monopole,pairs,polycrystal,scaling,spread,moments,tail,hard,scaling_310] [--quick]
                             [-j 2] [--keep DIR]

Prints Markdown, a part at a time, and before each the CPU time that it takes at most. --keep DIR keeps runs and takes up what is
there, so an interrupted command goes on; without it they are removed. --quick: runs of 6 s, to see that everything works; its
numbers mean nothing (some minutes: the box of 155 a). spread reads the maps of scaling,
moments those of monopole and scaling. tail and hard read the reduced runs of studies/medium/tail and hard.csv and make those that are missing.
scaling_310 runs only when named.
"""

from lab import parser, run_parts
from medium import drag, hard, moments, monopole, moving, pairs, scaling, sound, spread, static, strain, tail
from medium.bed import COST, Beds

PARTS = {"sound": (sound.part, sound.cost), "static": (static.part, static.cost), "strain": (strain.part, strain.cost),
         "moving": (moving.part, moving.cost),
         "drag": (drag.part, drag.cost),
         "monopole": (monopole.part, monopole.cost), "pairs": (pairs.part, pairs.cost), "polycrystal": (pairs.polycrystal, pairs.cost_polycrystal), "scaling": (scaling.part, scaling.cost),
         "spread": (spread.part, spread.cost), "moments": (moments.part, moments.cost),
         "tail": (tail.part, tail.cost), "hard": (hard.part, hard.cost),
         "scaling_310": (lambda lab: scaling.part(lab, 310), lambda: scaling.cost(310))}
NAMED_ONLY = {"scaling_310"}


def tell_cost(name):
    hours = PARTS[name][1]() * COST / 3600
    print(f"\n{name}: at most {hours:.1f} CPU hours" if hours > 0.95 else f"\n{name}: at most {60 * hours:.0f} CPU minutes", flush=True)


def main():
    options = parser(__doc__, "report", "quick", "threads", "keep", parts=PARTS, chosen=[name for name in PARTS if name not in NAMED_ONLY]).parse_args()
    run_parts(options, {name: make for name, (make, _) in PARTS.items()}, before=(lambda name: None) if options.quick else tell_cost, kind=Beds)


if __name__ == "__main__":
    main()
