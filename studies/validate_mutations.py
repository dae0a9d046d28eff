#!/usr/bin/python3
"""Random small changes of the sources, one at a time: whether a test fails for each.

    studies/validate_mutations.py TREE [--mutations 200] [--seed 1] [--csv FILE] [--under app/ models/]

TREE: a clone of its own, configured with the preset dev; its sources are changed and put back. A change swaps an operator, a
constant or a truth value in one place of a .cpp file. It is compiled, and the tests of its part, then those of the program that
concern it, then all but drawing and documents run until one fails, which then has to pass without the change. Prints Markdown: by folder how many were caught by what, and
each survivor. --csv: a row a change, added to the file; changes that stand there are not tried again.
"""

import argparse
import collections
import random
import re
import subprocess
import sys
from pathlib import Path

from lab import OPTIONS, keep_row, kept_rows, markdown

COLUMNS = ["file", "line", "before", "after", "caught_by"]
SWAPS = [(" < ", " <= "), (" <= ", " < "), (" > ", " >= "), (" >= ", " > "), (" == ", " != "), (" != ", " == "), (" + ", " - "), (" - ", " + "),
         (" * ", " / "), (" / ", " * "), (" && ", " || "), (" || ", " && "), ("true", "false"), ("false", "true"), (" += ", " -= "),
         ("std::min", "std::max"), ("std::max", "std::min"), ("0.5 ", "0.25 "), ("2.0 ", "3.0 "), ("return !", "return "), ("if (!", "if ("), ("++", "--")]
# tests of the program that a folder of app concerns, by their names
CONCERNED = {"bed": "dem|measure|granular", "cli": "cli", "fit": "fit", "run": "run|resume|variants|info|stops", "scan": "scan", "scene": "scene|mistake|units|options",
             "theory": "rods|noise|order|theory|medium|variants"}


def candidates(tree, under):
    """Every change there is: (file, line from 1, column, before, after)."""
    for path in sorted(p for folder in under for p in (tree / folder).rglob("*.cpp")):
        for number, line in enumerate(path.read_text().splitlines(), 1):
            code = re.sub(r'"(\\.|[^"\\])*"', lambda found: "_" * len(found.group()), line.split("//")[0])
            if code.lstrip().startswith("#") or "template" in code or "static_assert" in code:
                continue
            for before, after in SWAPS:
                for found in re.finditer(re.escape(before), code):
                    yield str(path.relative_to(tree)), number, found.start(), before, after


def mutate(tree, file, number, column, before, after):
    path = tree / file
    original = path.read_text()
    lines = original.splitlines(keepends=True)
    line = lines[number - 1]
    lines[number - 1] = line[:column] + after + line[column + len(before):]
    path.write_text("".join(lines))
    return original


def stages(file):
    """What ctest runs, one after the other, until something fails."""
    top, second = file.split("/")[:2]
    part = second if top == "models" else top
    if top == "app":
        yield ["-L", "^(app|scene|scan|store)$"]
        yield ["-L", "^(cli|python)$", "-LE", "long", "-R", CONCERNED.get(second, ".")]
    else:
        yield ["-L", f"^{part}$"]
        yield ["-L", "^(rods|medium|measure|granular|fitting|app)$"]
    yield ["-L", "^(cli|python|store|report|support)$", "-LE", "long", "-E", "cli: (scenes|hostile|tradeoff_ways)|^report"]  # not what draws


def fate(tree, file):
    """The name of the test that fails first; "compiler"; "" where the change survives."""
    build = tree / "build/dev"
    if subprocess.run(["cmake", "--build", build, "-j1"], capture_output=True, check=False).returncode != 0:
        return "compiler"
    for stage in stages(file):
        ran = subprocess.run(["ctest", "--test-dir", build, "-j1", "--stop-on-failure", "--timeout", "300", *stage], capture_output=True, text=True, check=False)
        if ran.returncode != 0:
            failed = re.search(r"^\s*\d+ - (.*?) \((?:Failed|Timeout|SEGFAULT|Subprocess|ILLEGAL|BAD|Not Run)", ran.stdout, re.M)
            return failed.group(1) if failed else "a test"
    return ""


def passes(tree, test):
    """Whether a test that failed passes on the unchanged sources."""
    build = tree / "build/dev"
    subprocess.run(["cmake", "--build", build, "-j1"], capture_output=True, check=True)
    return subprocess.run(["ctest", "--test-dir", build, "-R", f"^{re.escape(test)}$"], capture_output=True, check=False).returncode == 0


def report(rows):
    counts = collections.defaultdict(collections.Counter)
    for row in rows:
        of_program = re.match("(cli|python|store|report|support): ", row["caught_by"])
        counts["/".join(row["file"].split("/")[:2])]["survived" if not row["caught_by"] else "program" if of_program else "part"] += 1
    print(markdown(["folder", "changes", "a test of its part", "a test of the program", "survived"],
                   [[f"`{folder}`", sum(of.values()), of["part"], of["program"], of["survived"]] for folder, of in sorted(counts.items())]))
    for row in rows:
        if not row["caught_by"]:
            print(f"\n* `{row['file']}:{row['line']}`: `{row['before'].strip()}` as `{row['after'].strip()}`")


def read_options():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("tree", type=Path)
    parser.add_argument("--mutations", type=int, default=200)
    parser.add_argument("--under", nargs="+", default=["app", "models"])
    for flags, keys in (OPTIONS["seed"], OPTIONS["csv"]):
        parser.add_argument(*flags, **keys)
    return parser.parse_args()


def fate_of(tree, change, sound):
    """What catches a change; `sound` holds the tests that are known to pass on the unchanged sources."""
    original = mutate(tree, *change)
    try:
        by = fate(tree, change[0])
    finally:
        (tree / change[0]).write_text(original)
    if by not in ("", "compiler", *sound) and not passes(tree, by):
        sys.exit(f"{by} fails without a change too: mend it first")
    sound.add(by)
    return by


def main():
    options, sound = read_options(), set()
    rows = kept_rows(options.csv)
    tried = {(r["file"], r["line"], r["before"], r["after"]) for r in rows}
    every = list(candidates(options.tree, options.under))
    random.Random(options.seed).shuffle(every)
    for file, line, column, before, after in every:
        if len(rows) >= options.mutations:
            break
        if (file, str(line), before, after) in tried:
            continue
        by = fate_of(options.tree, (file, line, column, before, after), sound)
        if by == "compiler":  # no change of what the program does
            continue
        rows.append(dict(zip(COLUMNS, [file, str(line), before, after, by])))
        print(f"{len(rows)}: {file}:{line} {before}->{after}: {by or 'SURVIVED'}", file=sys.stderr, flush=True)
        keep_row(options.csv, rows[-1])
    report(rows)


if __name__ == "__main__":
    main()
