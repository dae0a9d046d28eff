#!/usr/bin/python3
"""Calls of the system that fail, one at a time, while each verb works: what docs/validation.md says of them.

    tools/validate_faults.py SHIM [--program build/release/rodwake] [--faults 5000] [--only rods,dem,...] [--csv FILE]

SHIM: libfaulty_system.so of the tests' build. Prints Markdown: by verb and call how many failed, how many of these ended with 1
and a message, how many made no difference (exit code 0 and the results of a sound system), and what was wrong, which is to be
nothing. --csv: a row a fault, added to the file; faults that stand there are not tried again.
"""

import argparse
import collections
import csv
import os
import sys
import tempfile
from pathlib import Path

SOURCE = Path(__file__).resolve().parent.parent


def arguments_of_command():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("shim", type=Path)
    parser.add_argument("--program", default=SOURCE / "build/release/rodwake", type=Path)
    parser.add_argument("--faults", default=5000, type=int)
    parser.add_argument("--only", default="")
    parser.add_argument("--csv", type=Path)
    return parser.parse_args()


options = arguments_of_command()
os.environ["RODWAKE_PROGRAM"] = str(options.program.resolve())
sys.path.insert(0, str(SOURCE / "tests/support"))
import faults  # noqa: E402 (it reads the program's name)

COLUMNS = ["verb", "call", "number", "error", "exit", "wrong"]


def done_before():
    if not options.csv or not options.csv.exists():
        return []
    with options.csv.open() as file:
        return list(csv.DictReader(file))


def keep(row):
    if not options.csv:
        return
    new = not options.csv.exists()
    with options.csv.open("a", newline="") as file:
        writer = csv.DictWriter(file, COLUMNS)
        if new:
            writer.writeheader()
        writer.writerow(row)


def of_verb(verb, share, known):
    """Rows of `share` faults of a verb, each kind of call with as many as it has, the rest of the share to writes and allocations."""
    with tempfile.TemporaryDirectory(prefix="rodwake-faults-") as folder:
        bench = faults.Bench(verb, Path(folder), options.shim.resolve())
        kinds = [(call, error) for call in faults.CALLS for error in faults.ERRORS[call]]
        wanted = [(call, error, number) for call, error in kinds
                  for number in faults.spread(bench.counts[call], max(2, share // len(kinds)))]
        for call, error, number in wanted:
            key = (verb, call, str(number), str(error))
            if key in known:
                continue
            wrong, done = bench.fault(call, number, error)
            row = dict(zip(COLUMNS, (*key, done.returncode, "; ".join(wrong))))
            keep(row)
            yield row
            if wrong:
                print(f"{verb}: {call} {number} with {error}: {row['wrong']}", file=sys.stderr)


def table(rows):
    print("| verb | call | faults | told, exit code 1 | no difference | silent or unseemly |\n|---|---|---|---|---|---|")
    groups = collections.defaultdict(list)
    for row in rows:
        groups[row["verb"], row["call"]].append(row)
    for (verb, call), some in [*sorted(groups.items()), (("all", ""), rows)]:
        told = sum(str(row["exit"]) == "1" and not row["wrong"] for row in some)
        none = sum(str(row["exit"]) == "0" and not row["wrong"] for row in some)
        print(f"| {verb} | {call} | {len(some)} | {told} | {none} | {sum(bool(row['wrong']) for row in some)} |")


rows = done_before()
verbs = options.only.split(",") if options.only else list(faults.VERBS)
before = {tuple(row[key] for key in COLUMNS[:4]) for row in rows}
for one in verbs:
    rows.extend(of_verb(one, options.faults // len(verbs), before))
table(rows)
