#!/usr/bin/python3
"""Extremes: more than 20 000 cells of rods, fields, beds and fits at the ends of their ranges; docs/extremes.md has the table.

    studies/validate_extremes.py [--program build/release/rodwake] [--quick] [--only rods,field] [--seed 1] [--keep DIR]

Each cell must end with a named status, within its time, without NaN, and within its bound of a reference where there is one. Writes
cells.csv, extremes.json and extremes.md into --keep DIR and prints the table; a run that was interrupted goes on there. Exit code 1
if a cell is bad (no name, NaN, too long). Takes about half an hour on one core; --quick some seconds.
"""

import argparse
import csv
import json
import sys
import tempfile
from collections import Counter, defaultdict
from pathlib import Path

from extremes import bed_cells, field_cells, fit_cells, rods_cells, scan_cells
from extremes.lab import SOURCE, VERDICTS, Lab

GROUPS = {"field": field_cells, "rods": rods_cells, "pairs": scan_cells, "beds": bed_cells, "fits": fit_cells}


def summary(cells):
    """Of each group: counts by verdict and status, and the largest and median error over its bound."""
    groups = defaultdict(list)
    for cell in cells:
        groups[cell.group].append(cell)
    table = {}
    for name, members in sorted(groups.items()):
        errors = sorted(cell.error for cell in members if cell.error is not None)
        table[name] = {"cells": len(members), **{verdict: sum(cell.verdict == verdict for cell in members) for verdict in VERDICTS},
                       "statuses": dict(Counter(cell.status for cell in members).most_common()), "compared": len(errors),
                       "median_error": errors[len(errors) // 2] if errors else None, "largest_error": errors[-1] if errors else None,
                       "longest": max(cell.seconds for cell in members)}
    return table


def markdown(table):
    lines = ["| group | cells | good | told | differs | bad | statuses | compared | error: median, largest |", "|" + "---|" * 9]
    for name, row in table.items():
        statuses = ", ".join(f"{status} {count}" for status, count in row["statuses"].items())
        errors = f"{row['median_error']:.1g}, {row['largest_error']:.1g}" if row["compared"] else ""
        counts = " | ".join(str(row[key]) for key in ("cells", *VERDICTS))
        lines.append(f"| {name} | {counts} | {statuses} | {row['compared'] or ''} | {errors} |")
    return "\n".join(lines) + "\n"


def write(lab, options, table):
    told = {"command": " ".join(["studies/validate_extremes.py", *sys.argv[1:]]), "seed": options.seed, "quick": options.quick,
            "cells": len(lab.cells), "bad": sum(cell.verdict == "bad" for cell in lab.cells), "groups": table}
    lab.write("extremes.json", json.dumps(told, indent=1))
    lab.write("extremes.md", f"{told['cells']} cells, seed {told['seed']}: `{told['command']}`\n\n{markdown(table)}")
    with open(lab.folder / "cells.csv", "w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(["group", "name", "status", "verdict", "seconds", "error", "note"])
        writer.writerows([c.group, c.name, c.status, c.verdict, f"{c.seconds:.4f}", c.error, c.note] for c in lab.cells)


def options_of(arguments):
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", default=SOURCE / "build" / "release" / "rodwake", type=Path)
    parser.add_argument("--only", default=",".join(GROUPS), help="parts, separated by commas: " + ", ".join(GROUPS))
    parser.add_argument("--quick", action="store_true", help="some hundred cells")
    parser.add_argument("--seed", type=int, default=1, help="of the random cells")
    parser.add_argument("--keep", help="folder for the results")
    options = parser.parse_args(arguments)
    if unknown := set(options.only.split(",")) - set(GROUPS):
        parser.error(f"--only: {', '.join(sorted(unknown))}: there are {', '.join(GROUPS)}")
    return options


def main():
    options = options_of(sys.argv[1:])
    with tempfile.TemporaryDirectory() as scratch:
        lab = Lab(options.program.resolve(), options.keep or scratch, options.seed, options.quick)
        for name in options.only.split(","):
            GROUPS[name].run(lab)
        table = summary(lab.cells)
        write(lab, options, table)
        print(f"{len(lab.cells)} cells, seed {options.seed}\n\n{markdown(table)}")
        bad = [cell for cell in lab.cells if cell.verdict == "bad"]
        for cell in bad[:20]:
            print(f"bad: {cell.group}: {cell.name}: {cell.status}", file=sys.stderr)
        return 1 if bad or not lab.cells else 0


if __name__ == "__main__":
    sys.exit(main())
