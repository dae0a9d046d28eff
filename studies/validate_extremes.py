#!/usr/bin/python3
"""Extremes: more than 20 000 cells of rods, fields, beds and fits at the ends of their ranges; studies/reports/extremes.md has the table.

    studies/validate_extremes.py [--program build/release/rodwake] [--quick] [--only rods,field] [--seed 1] [--keep DIR] [--report]

Each cell must end with a named status, within its time, without NaN, and within its bound of a reference where there is one. Writes
cells.csv, extremes.json and extremes.md into --keep DIR and prints the table; a run that was interrupted goes on there. Exit code 1
if a cell is bad (no name, NaN, too long). Takes about half an hour on one core; --quick some seconds.
"""

import json
import sys

from extremes import bed_cells, cells, field_cells, rods_cells
from lab import open_lab, parser, report_page, stamp, write_report

GROUPS = {"field": field_cells.run, "rods": rods_cells.run_starts, "pairs": rods_cells.run_pairs, "beds": bed_cells.run_beds, "fits": bed_cells.run_fits}


def write(lab, found):
    summary = {"command": " ".join(["studies/validate_extremes.py", *sys.argv[1:]]), "seed": lab.seed, "quick": lab.quick,
            "cells": len(lab.cells), "bad": sum(cell.verdict == "bad" for cell in lab.cells), "groups": found}
    lab.write("extremes.json", json.dumps(summary, indent=1))
    lab.write("extremes.md", f"{summary['cells']} cells, seed {summary['seed']}: `{summary['command']}`\n\n{cells.markdown(found)}")
    cells.write_cells(lab.folder / "cells.csv", lab.cells)


def main():
    options = parser(__doc__, "report", "quick", "seed", "keep", parts=GROUPS).parse_args()
    if options.report and (options.quick or set(options.only) != set(GROUPS)):
        sys.exit("--report: not with --quick or --only")
    page = report_page("all") if options.report else None
    with open_lab(options) as place:
        lab = cells.Lab(options.program.resolve(), place.folder, options.seed, options.quick)
        for name in options.only:
            GROUPS[name](lab)
        found = cells.summary(lab.cells)
        write(lab, found)
        text = f"{len(lab.cells)} cells, seed {options.seed}\n\n{cells.markdown(found)}"
        print(text)
        if page:
            write_report(page, "all", f"{stamp(place)}\n\n{text}")
    bad = [cell for cell in lab.cells if cell.verdict == "bad"]
    for cell in bad[:20]:
        print(f"bad: {cell.group}: {cell.name}: {cell.status}", file=sys.stderr)
    return 1 if bad or not lab.cells else 0


if __name__ == "__main__":
    sys.exit(main())
