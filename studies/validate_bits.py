#!/usr/bin/python3
"""The bits of granular states with other compilers, flags, instruction sets and on arm64; studies/reports/granular.md has the table.

    studies/validate_bits.py [--only x86,arm] [-j 2] [--keep folder]

Compiles studies/bits/beds.cpp with the granular part alone (Eigen, fmt, Highway, xxHash, Random123) and runs it: a program a row. x86:
g++ and clang++ for any x86-64 and for this machine's own instructions, each with the vector loops of every instruction set that it
has. arm: aarch64-linux-gnu-g++ (and clang++ where its headers are found), run by qemu-aarch64 (section compilers of tools/packages.txt).
A row says `same`, or what differs first from the first row. Exit code 1 if any differs.
"""

import shutil
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor

from lab import SOURCE, open_lab, parser, table

CORE = ["bond_order", "box_sides", "cell_list", "error", "parallel", "repeatable_math", "rng"]
SOURCES = [SOURCE / "studies/bits/beds.cpp", *sorted((SOURCE / "models/granular").glob("*.cpp")),
           *(SOURCE / f"src/core/{name}.cpp" for name in CORE)]
SOURCES = [path for path in SOURCES if path.name != "record.cpp"]  # tables, no state
FLAGS = ["-std=c++20", "-ffp-contract=off", "-Wall", "-Wextra", "-Wpedantic", "-Wshadow", "-Wconversion", "-Wno-sign-conversion",
         "-DFMT_HEADER_ONLY", *(f"-I{SOURCE / folder}" for folder in ("include", "models", "models/granular", "tests")),
         "-isystem", "/usr/include/eigen3"]
ARM = ["-static", "-DHWY_COMPILE_ONLY_STATIC", "-idirafter", "/usr/include"]  # headers alone, of the same packages
COMPILERS = {"x86": [("g++", []), ("clang++", [])],
             "arm": [("aarch64-linux-gnu-g++", ARM), ("clang++", ["--target=aarch64-linux-gnu", *ARM])]}
LEVELS = {"x86": [["-O1"], ["-O2"], ["-O3"], ["-O3", "-march=native"]], "arm": [["-O1"], ["-O3"]]}
WANTED = []  # (what, hash) of the first row


def command(compiler, flags):
    return [*([shutil.which("ccache")] if shutil.which("ccache") else []), compiler, *FLAGS, *flags]


def built(lab, compiler, flags):
    """A program and what the compiler had to say."""
    folder = lab.folder / "_".join([compiler, *(flag.strip("-").replace("=", "-") for flag in flags if "/" not in flag)])
    folder.mkdir(parents=True, exist_ok=True)

    def compiled(source):
        return subprocess.run([*command(compiler, flags), "-c", source, "-o", folder / f"{source.stem}.o"], capture_output=True, text=True, check=False)

    with ThreadPoolExecutor(lab.threads) as pool:
        done = list(pool.map(compiled, SOURCES))
    libraries = [] if "-static" in flags else ["-lhwy"]
    done.append(subprocess.run([*command(compiler, flags), *folder.glob("*.o"), "-o", folder / "beds", "-pthread", *libraries],
                               capture_output=True, text=True, check=False))
    return folder / "beds", "".join(one.stderr for one in done)


def hashes(lines):
    """Of the program's lines: {instruction set: [(what, hash)]}."""
    found = {}
    for line in lines.splitlines():
        target, rest = line.split(",", 1)
        found.setdefault(target, []).append(tuple(rest.rsplit(",", 1)))
    return found


def verdict(found):
    if not WANTED:
        WANTED.extend(found)
    differing = [what for (what, value), (_, wanted) in zip(found, WANTED, strict=True) if value != wanted]
    return f"differs from: {differing[0]}" if differing else "same"


def compare(lab, kind):
    """Rows of the table, and whether all have the bits of the first."""
    found = []
    for compiler, extra in COMPILERS[kind]:
        for level in LEVELS[kind]:
            program, messages = built(lab, compiler, [*level, *extra])
            if not program.is_file():
                print(f"{compiler} {' '.join(level)} did not link:\n{messages[-1500:]}", file=sys.stderr)
                found.append([compiler, " ".join(level), "", "", "not built", messages.count("warning:")])
                continue
            run = subprocess.run([*(["qemu-aarch64"] if kind == "arm" else []), program], capture_output=True, text=True, check=True)
            alike = {}  # instruction sets by what came out with them
            for target, of_target in hashes(run.stdout).items():
                alike.setdefault((of_target[-1][1], verdict(of_target)), []).append(target)
            found += [[compiler, " ".join(level), " ".join(targets), *outcome, messages.count("warning:")] for outcome, targets in alike.items()]
    return found


def main():
    options = parser(__doc__, "keep", "threads", parts=COMPILERS).parse_args()
    with open_lab(options) as lab:
        found = [row for kind in options.only for row in compare(lab, kind)]
    table("Bits", ["compiler", "flags", "vector loops", "last hash", "bits", "warnings"], found)
    return any(row[4] != "same" for row in found)


if __name__ == "__main__":
    sys.exit(main())
