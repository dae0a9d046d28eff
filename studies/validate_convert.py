#!/usr/bin/python3
"""Damaged films through the converter, and films of 10^6 rows: what studies/reports/house.md says of files of other programs.

    studies/validate_convert.py [--files 2400] [--only dump,xyz,...] [--seed 1] [--csv FILE] [-j N] [--quick]

A small film in each format is damaged (bits, bytes, blocks, cuts, insertions, words that are no numbers) and converted, all in one
process that forks a worker for each. Prints Markdown: how many were read as they are, read otherwise (a changed digit of a text is a
digit), or refused; how many of these were refused because the library crashed, hung or wanted more than 1 GB, which ends the worker
alone; and what is to be 0: conversions that took longer than the limit or more memory, ended in any other way or left a file behind,
and films read wrongly where a checksum tells: "sums.h5md" has one on every chunk and on its metadata. 4/3 as many files are H5MD, half
of them with checksums. Then the time and memory of 10^6 rows in each format. Exit code 1 if what is to be 0 is not. --csv: a row a
format, written over; --quick: a twentieth of the files and of the rows.
"""

import argparse
import concurrent.futures
import os
import random
import resource
import sys
import tempfile
import time
from pathlib import Path

from lab import SOURCE, markdown, write_csv

sys.path.insert(0, str(SOURCE / "tests/convert"))
import films  # noqa: E402
from rodwake_convert import command, convert, gsd_film, h5md, lammps, supervise  # noqa: E402, F401 (a warm process)

np = films.np
COLUMNS = ["read", "otherwise", "refused", "crashed", "hung", "wanted 1 GB", "beyond 20 s", "beyond 1 GB", "unseemly", "wrong"]
DEATHS = {"signal": "crashed", "time": "hung", "memory": "wanted 1 GB"}
NAMES = ["dump", "xyz", "xml", "csv", "gsd", "h5md", "sums"]


def converted(source, target, *more):
    return command.run(command.arguments([str(source), "-o", str(target), "--force", *more]))


def seen_in(target):
    return films.Film(target).seen()


def batch(job):
    """What became of some damaged files of a name: a dictionary of counts."""
    name, count, seed = job
    chance, counts = random.Random(f"{name} {seed}"), dict.fromkeys(COLUMNS, 0)
    with tempfile.TemporaryDirectory(prefix="rodwake-convert-") as folder:
        folder = Path(folder)
        good = films.small_films(folder)[name]
        source, target = folder / name, folder / "film.h5md"
        source.write_bytes(good)
        converted(source, target)
        true = seen_in(target)
        for _ in range(count):
            source.write_bytes(films.damaged(good, chance))
            start = time.monotonic()
            outcome = converted(source, target)
            counts["beyond 20 s"] += time.monotonic() - start > supervise.SECONDS + 2
            counts["beyond 1 GB"] += outcome.peak > supervise.MEMORY * 1.05
            if outcome.code == 2 and outcome.message.startswith(str(source)) and "internal" not in outcome.message:
                counts["refused"] += 1
                if outcome.death:
                    counts[DEATHS[outcome.death]] += 1
            elif outcome.code:
                counts["unseemly"] += 1
                print(name, outcome, file=sys.stderr)
            elif (found := seen_in(target)) == true:
                counts["read"] += 1
            else:
                counts["wrong" if name.startswith("sums") else "otherwise"] += 1
        if [path for path in folder.iterdir() if path.name.endswith(".part")]:
            counts["unseemly"] += 1
    return name, counts


def damage(options):
    names = ["sums.h5md" if name == "sums" else f"a.{name}" for name in options.only]
    each = {name: options.files * 2 // 3 if "h5md" in name else options.files for name in names}
    jobs = [(name, min(200, each[name] - k), f"{options.seed} {k}") for name in names for k in range(0, each[name], 200)]
    found = {name: {"files": each[name]} for name in names}
    with concurrent.futures.ProcessPoolExecutor(options.jobs) as pool:
        for name, counts in pool.map(batch, jobs):
            for key, value in counts.items():
                found[name][key] = found[name].get(key, 0) + value
    return [{"film": name} | row for name, row in found.items()]


def large(rows):
    """Seconds of the clock, of the processor, and MB for films of this many rows, each way."""
    frames, found = 1000, []
    random_numbers = np.random.default_rng(1)
    place = random_numbers.random((frames, rows // frames, 3)) * films.SIDES
    with tempfile.TemporaryDirectory(prefix="rodwake-convert-") as folder:
        folder = Path(folder)
        (folder / "a.dump").write_text(films.dump(place, image=np.zeros(place.shape, int)))
        (folder / "a.xml").write_text(films.trackmate(place))
        for source, target in [("a.dump", "b.h5md"), ("a.xml", "c.h5md"), *[("b.h5md", f"b.{ending}") for ending in ("xyz", "gsd", "csv", "dump")],
                               *[(f"b.{ending}", "c.h5md") for ending in ("xyz", "gsd", "csv", "h5md")]]:
            before, start = resource.getrusage(resource.RUSAGE_CHILDREN), time.monotonic()
            outcome = converted(folder / source, folder / target)
            after = resource.getrusage(resource.RUSAGE_CHILDREN)
            found.append([f"{source[2:]} to {target[2:]}", outcome.code, f"{time.monotonic() - start:.1f}",
                          f"{after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime:.1f}", f"{outcome.peak / 2**20:.0f}"])
    return found


if __name__ == "__main__":
    reader = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    reader.add_argument("--files", type=int, default=2400)
    reader.add_argument("--only", type=lambda text: text.split(","), default=NAMES)
    reader.add_argument("--seed", type=int, default=1)
    reader.add_argument("--csv", type=Path)
    reader.add_argument("-j", "--jobs", type=int, default=os.cpu_count())
    reader.add_argument("--quick", action="store_true")
    options = reader.parse_args()
    options.files = options.files // 20 if options.quick else options.files
    found = damage(options)
    print(markdown(list(found[0]), [row.values() for row in found]), flush=True)
    if options.csv:
        write_csv(options.csv, found)
    times = large(50_000 if options.quick else 10**6)
    print("\n" + markdown(["10^6 rows", "exit", "s", "s of processor", "MB"], times))
    sys.exit(any(row[key] for row in found for key in COLUMNS[-4:]) or any(row[1] for row in times))
