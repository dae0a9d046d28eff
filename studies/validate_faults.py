#!/usr/bin/python3
"""Calls of the system that fail, one at a time, while each verb works: what studies/reports/house.md says of them.

    studies/validate_faults.py SHIM [--program build/release/rodwake] [--faults 5000] [--only rods,dem,...] [--csv FILE]
    studies/validate_faults.py SHIM --allocations 1024 [--faults 5000] [--csv FILE]

SHIM: libfaulty_system.so of the tests' build. Prints Markdown: by verb and call how many failed, how many of these ended with 1
and a message, how many made no difference (exit code 0 and the results of a sound system), and what was wrong, which is to be
nothing. --csv: a row a fault, added to the file; faults that stand there are not tried again. --allocations: in place of these, each
allocation of so many bytes and more by a scan of four points, or, if there are more than --faults, so many evenly among them.
"""

import collections
import os
import sys
import tempfile
from pathlib import Path

from lab import SOURCE, keep_row, kept_rows, markdown, parser

reader = parser(__doc__, "csv")
reader.add_argument("shim", type=Path)
reader.add_argument("--faults", default=5000, type=int)
reader.add_argument("--allocations", type=int, metavar="BYTES")
options = reader.parse_args()
os.environ["RODWAKE_PROGRAM"] = str(options.program.resolve())
sys.path.insert(0, str(SOURCE / "tests/support"))
import faults  # noqa: E402 (it reads the program's name)
from scans import CROSSING, axes  # noqa: E402

if options.allocations:
    os.environ["FAULT_LEAST"] = str(options.allocations)
    options.only = ["scan"]
    faults.VERBS["scan"] = (f"{CROSSING}[scan]\ntrajectories = 0\n{axes(2)}", {}, [], "rodwake")

COLUMNS = ["verb", "call", "number", "error", "exit", "wrong"]


def wanted_of(bench, share):
    """(call, error, number) of `share` faults: of each kind of call as many as it has, up to an equal part; the rest are allocations."""
    kinds = [(call, error) for call in faults.CALLS for error in faults.ERRORS[call] if call != "malloc"]
    wanted = [(call, error, number) for call, error in kinds
              for number in faults.spread(bench.counts[call], max(2, share // (len(kinds) + 1)))]
    rest = max(2, share - len(wanted))
    return wanted + [("malloc", *faults.ERRORS["malloc"], number) for number in faults.spread(bench.counts["malloc"], rest)]


def all_wanted(benches):
    """Of every verb, with the smallest share with which they are as many as asked for, or all that there are."""
    if options.allocations:
        numbers = faults.spread(benches["scan"].counts["malloc"], options.faults)
        return {"scan": [("malloc", *faults.ERRORS["malloc"], number) for number in numbers]}
    share, found, before = options.faults // len(benches), 0, -1
    while before < found < options.faults:
        before = found
        wanted = {verb: wanted_of(bench, share) for verb, bench in benches.items()}
        found = sum(map(len, wanted.values()))
        share += share // 8 + 1
    return wanted


def tried(verb, bench, wanted, known):
    for call, error, number in wanted:
        key = (verb, call, str(number), str(error))
        if key in known:
            continue
        wrong, done = bench.fault(call, number, error)
        row = dict(zip(COLUMNS, (*key, done.returncode, "; ".join(wrong))))
        keep_row(options.csv, row)
        yield row
        if wrong:
            print(f"{verb}: {call} {number} with {error}: {row['wrong']}", file=sys.stderr)


def table(rows):
    groups, lines = collections.defaultdict(list), []
    for row in rows:
        groups[row["verb"], row["call"]].append(row)
    for (verb, call), some in [*sorted(groups.items()), (("all", ""), rows)]:
        reported, none = (sum(str(row["exit"]) == code and not row["wrong"] for row in some) for code in "10")
        lines.append([verb, call, len(some), reported, none, sum(bool(row["wrong"]) for row in some)])
    print(markdown(["verb", "call", "faults", "reported, exit code 1", "no difference", "silent or unseemly"], lines))


rows = kept_rows(options.csv)
before = {tuple(row[key] for key in COLUMNS[:4]) for row in rows}
with tempfile.TemporaryDirectory(prefix="rodwake-faults-") as folder:
    benches = {verb: faults.Bench(verb, Path(folder) / verb, options.shim.resolve()) for verb in options.only or faults.VERBS}
    for one, wanted in all_wanted(benches).items():
        rows.extend(tried(one, benches[one], wanted, before))
table(rows)
