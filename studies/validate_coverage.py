#!/usr/bin/python3
"""Which branches of the store and of the scans' ledger no test takes; studies/reports/house.md has the table.

    studies/validate_coverage.py [build/coverage] [--lines]

Of a build of the preset coverage whose tests have run: lines and branches that were taken, file by file, as gcov counts them. Branches that only
an exception of something called takes are left out: every call has one. --lines: places of branches that were not taken, with their text.
"""

import argparse
import collections
import json
import subprocess
from pathlib import Path

from lab import SOURCE, markdown

SUBJECTS = ("src/store/", "src/scan/ledger")


def counts_of(build):
    """{file: ({line: count}, {(line, number of the branch): count})} over all objects that have been run."""
    found = collections.defaultdict(lambda: (collections.Counter(), collections.Counter()))
    objects = [path for part in ("store", "scan") for path in sorted((build / "src" / part).rglob("*.gcda"))]
    if not objects:
        raise SystemExit(f"{build}: no test of the store has run; cmake --preset coverage, build it, and ctest -R '^(store|scan):'")
    for path in objects:
        text = subprocess.run(["gcov", "--json-format", "--branch-probabilities", "--stdout", path], capture_output=True, text=True, check=True, cwd=build).stdout
        for one in (file for line in text.splitlines() for file in json.loads(line)["files"]):
            lines, branches = found[one["file"]]
            for line in one["lines"]:
                number = line["line_number"]
                lines[number] += line["count"]
                for index, branch in enumerate(line["branches"]):
                    if not branch["throw"]:
                        branches[number, index] += branch["count"]
    return found


def relative(name, build):
    path = (build / name).resolve()
    return str(path.relative_to(SOURCE)) if path.is_relative_to(SOURCE) else ""


def taken(counts):
    return sum(count > 0 for count in counts.values())


def row_of(name, lines, branches):
    return [name, len(lines), f"{taken(lines) / len(lines):.1%}", len(branches), f"{taken(branches) / max(1, len(branches)):.1%}"]


def main():
    reader = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    reader.add_argument("build", nargs="?", default=SOURCE / "build/coverage", type=Path)
    reader.add_argument("--lines", action="store_true")
    options = reader.parse_args()
    build = options.build.resolve()
    files = {name: counts for file, counts in counts_of(build).items() if (name := relative(file, build)).startswith(SUBJECTS) and counts[0]}
    rows = [row_of(name, *counts) for name, counts in sorted(files.items())]
    for part in ("src/scan", "src/store"):
        both = [{(name, key): count for name, counts in files.items() if name.startswith(part) for key, count in counts[kind].items()} for kind in (0, 1)]
        rows.append(row_of(f"all of {part}", *both))
    print(markdown(["file", "lines", "run", "branches", "taken"], rows))
    for name, (_, branches) in sorted(files.items()) if options.lines else ():
        text = (SOURCE / name).read_text().splitlines()
        for line in sorted({line for (line, _), count in branches.items() if not count}):
            print(f"{name}:{line}: {text[line - 1].strip()}")


if __name__ == "__main__":
    main()
