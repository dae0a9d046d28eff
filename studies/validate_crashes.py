#!/usr/bin/python3
"""Machines that stop: every folder that a file system may leave, and what the same command makes of it; studies/reports/house.md.

    studies/validate_crashes.py [--program build/release/rodwake] [--states 10000] [--only rods,dem,...] [--seed 1] [--keep DIR] [--csv FILE]

tests/support/crashes.py says what a crash leaves. Distinct states are made, some of them of commands that take up an earlier crash,
and `rodwake info` and the same command run there. It must end with the results of an undisturbed run, or with a message that names a
file, after which --force gives these results. Prints Markdown; exit code 1 if anything else happened. --csv: a row a state, added to
those of other seeds, which the table has too; --keep: folder for the states that went wrong. Needs strace.
"""

import collections
import os
import random
import re
import shutil
import sys
import tempfile
from pathlib import Path

from lab import SOURCE, keep_row, kept_rows, markdown, parser

reader = parser(__doc__, "seed", "csv", "keep")
reader.add_argument("--states", default=10000, type=int)
options = reader.parse_args()
os.environ["RODWAKE_PROGRAM"] = str(options.program.resolve())
sys.path.insert(0, str(SOURCE / "tests/support"))
import crashes  # noqa: E402 (it reads the program's name)

AGAIN = 4  # crashes of each verb that are taken up, and that command crashes too; each gets as many states as the first


def round_of(verb, most, chance):
    """Rows of a verb's states."""
    with tempfile.TemporaryDirectory(prefix="rodwake-crashes-") as folder:
        bench, seen, tree = crashes.Bench(verb, Path(folder) / "bench"), set(), None
        for level in range(AGAIN + 1):
            tree = chance.choice(trees) if level else bench.first
            recorder = bench.record(tree)
            trees = crashes.crash_states(tree, recorder, most // (AGAIN + 1), chance, seen)
            for number, state in enumerate(trees):
                ending, wrong, message = bench.judge(state)
                row = {"verb": verb, "crash": level + 1, "state": number, "seed": options.seed, "operations": len(recorder.ops), "ending": ending, "wrong": wrong,
                       "message": message.strip()[-400:]}
                keep_row(options.csv, row)
                if wrong:
                    print(f"{verb} {level} {number}: {ending}: {wrong}: {message}", file=sys.stderr, flush=True)
                    keep_state(bench, state, f"{verb}_{level}_{number}")
                yield row


def keep_state(bench, state, name):
    if options.keep:
        bench.put(state)
        shutil.copytree(bench.place, options.keep / name, dirs_exist_ok=True)


ENDINGS = ("resumed", "finished", "refused", "hang", "unseemly")


def table(rows):
    counts = collections.defaultdict(collections.Counter)
    for row in rows:
        for verb in (row["verb"], "all"):
            counts[verb].update([row["ending"], *(["wrong"] if row["wrong"] else [])])
            counts[verb]["states"] += 1
    print(markdown(["verb", "states", *ENDINGS, "wrong"],
                   [[verb, found["states"], *(found[end] for end in ENDINGS), found["wrong"]] for verb, found in counts.items()]))
    for message, count in collections.Counter(re.sub(r"\d+", "N", row["message"]) for row in rows if row["ending"] == "refused").most_common(20):
        print(f"{count}: {message}")


def main():
    verbs = options.only or crashes.VERBS
    rows = kept_rows(options.csv) + [row for verb in verbs
                                     for row in round_of(verb, options.states // len(verbs), random.Random(f"{options.seed} {verb}"))]
    table(rows)
    return 1 if any(row["wrong"] for row in rows) else 0


if __name__ == "__main__":
    sys.exit(main())
