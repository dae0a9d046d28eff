#!/usr/bin/python3
"""Files that are damaged in every way: what studies/reports/house.md says of programs that read them.

    studies/validate_damage.py [--program build/release/rodwake] [--files 10000] [--only toml,csv,...] [--seed 1] [--csv FILE] [-j N]

A file of each kind is damaged (bits, bytes, blocks, cuts, insertions, words that are no numbers) and read by the verbs that read
such files. Prints Markdown: how many of each kind were refused, read all the same, ended by a signal, did not end within a minute,
or ended otherwise unseemly; the last three are to be 0. Of tables of the field (rwt), which are large, a tenth as many are tried.
--csv: a row a kind, written over; what failed is kept in its folder.
"""

import collections
import concurrent.futures
import os
import random
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from lab import SOURCE, markdown, parser, write_csv

reader = parser(__doc__, "seed", "csv")
reader.add_argument("--files", default=10000, type=int)
reader.add_argument("-j", "--jobs", default=os.cpu_count(), type=int)
options = reader.parse_args()
os.environ["RODWAKE_PROGRAM"] = str(options.program.resolve())
sys.path.insert(0, str(SOURCE / "tests/support"))
import faults  # noqa: E402 (it reads the program's name)

AGAIN = faults.SHORT_BED.replace("[granular]\n", '[granular]\nstart = "restart"\nrestart_from = "out/final.rwc"\n', 1)
MEASURE = faults.SHORT_BED + faults.MEASURE
SCAN = faults.VERBS["scan"][0]
TABLE = faults.FIELD.replace("[medium]\n", '[medium]\nfield = "table"\nperiodic = 40.0\n').replace("alpha = 1.0", "alpha = 0.2")

# Kind: files that are there, verbs that make more, the file that is damaged, and the verbs that read it.
KINDS = {
    "toml": ({"scene.toml": faults.SHORT_PAIR}, [], "scene.toml", [["info", "scene.toml"], ["check", "scene.toml"]]),
    "csv": ({"scene.toml": faults.FIT, "ux.csv": faults.profile()}, [], "ux.csv",
            [["info", "ux.csv"], ["fit", "scene.toml", "-o", "read"]]),
    "h5": ({"scene.toml": faults.FIELD}, [["field", "scene.toml", "-o", "out"]], "out/result.h5",
           [["info", "out/result.h5"], ["info", "out"]]),
    "h5md": ({"scene.toml": MEASURE}, [["dem", "scene.toml", "-o", "out"]], "out/trajectory.h5md",
             [["info", "out/trajectory.h5md"], ["measure", "scene.toml", "-o", "out"]]),
    "rwc": ({"scene.toml": faults.SHORT_BED, "again.toml": AGAIN}, [["dem", "scene.toml", "-o", "out"]], "out/final.rwc",
            [["info", "out/final.rwc"], ["dem", "again.toml", "-o", "read"]]),
    "rwt": ({"scene.toml": TABLE}, [["field", "scene.toml", "-o", "out"]], "cache/rodwake/*.rwt", [["field", "scene.toml", "-o", "read"]]),
    "json": ({"scene.toml": faults.FIELD}, [["field", "scene.toml", "-o", "out"]], "out/provenance.json",
             [["info", "out"], ["field", "scene.toml", "-o", "out", "--force"]]),
    "log": ({"scene.toml": SCAN}, [["scan", "scene.toml", "-o", "out"]], "out/points.log",
               [["info", "out/points.log"], ["scan", "scene.toml", "-o", "out"]]),
}
WORDS = [b"nan", b"-inf", b"1e400", b"-1", b"", b'"', b"[", b"\x00", b"9" * 400, b"\xff\xfe", b"0x", b"1e-400"]


def damaged(good, chance):
    """The bytes of `good` with one to three injuries."""
    data = bytearray(good)
    for _ in range(chance.randint(1, 3)):
        at, length = chance.randrange(len(data) + 1), chance.randint(1, 64)
        how = chance.randrange(7)
        if how == 0 and data:
            data[at % len(data)] ^= 1 << chance.randrange(8)
        elif how == 1 and data:
            data[at % len(data)] = chance.randrange(256)
        elif how == 2:
            data[at:at + length] = bytes(len(data[at:at + length]))
        elif how == 3:
            del data[at:at + length]
        elif how == 4:
            data[at:at] = chance.randbytes(length)
        elif how == 5:
            data[at:at + chance.randint(1, 6)] = chance.choice(WORDS)
        elif chance.random() < 0.2:
            del data[at:]
    return bytes(data)


def called(arguments, place):
    return subprocess.run([options.program.resolve(), *arguments], cwd=place, capture_output=True, text=True, errors="replace",
                          timeout=60, env={**os.environ, "XDG_CACHE_HOME": str(place / "cache")}, check=False)


def must(kind, arguments, place):
    done = called(arguments, place)
    if done.returncode != 0:
        raise RuntimeError(f"{kind}, undamaged: {' '.join(arguments)}: {done.stderr}")


def ready(kind, folder):
    files, makers, _, readers = KINDS[kind]
    folder.mkdir()
    for name, text in files.items():
        (folder / name).write_text(text)
    for arguments in makers:
        must(kind, arguments, folder)
    record = folder / "out/provenance.json"
    if kind == "log":  # a scan that is to go on
        record.write_text(record.read_text().replace("finished", "interrupted"))
    for arguments in readers:
        sound = shutil.copytree(folder, folder.parent / "sound")
        must(kind, arguments, sound)
        shutil.rmtree(sound)


def ending(arguments, place):
    try:
        done = called(arguments, place)
    except subprocess.TimeoutExpired:
        return "hang"
    if done.returncode < 0 or done.returncode > 128:
        return "signal"
    if faults.UNSEEMLY.search(done.stderr) or (done.returncode != 0 and not done.stderr.strip()):
        return "unseemly"
    return "read" if done.returncode == 0 else "refused"


def trial(kind, number, folder):
    """One damaged file, read by one of the verbs in turn."""
    _, _, name, readers = KINDS[kind]
    place = folder / f"place{number}"
    shutil.copytree(folder / "ready", place)
    file = next(place.glob(name))
    file.write_bytes(damaged(file.read_bytes(), random.Random(f"{options.seed} {kind} {number}")))
    end = ending(readers[number % len(readers)], place)
    if end in ("refused", "read"):
        shutil.rmtree(place)
    else:
        print(f"{kind} {number}: {end}: {place}", file=sys.stderr)
    return end


def round_of(kind):
    count = options.files if kind != "rwt" else options.files // 10  # megabytes each, and made anew when refused
    folder = Path(tempfile.mkdtemp(prefix=f"rodwake-damage-{kind}-"))
    ready(kind, folder / "ready")
    with concurrent.futures.ThreadPoolExecutor(options.jobs) as team:
        ends = collections.Counter(team.map(lambda number: trial(kind, number, folder), range(count)))
    if not set(ends) - {"refused", "read"}:
        shutil.rmtree(folder)
    return {"kind": kind, "files": count, **{end: ends[end] for end in ("refused", "read", "signal", "hang", "unseemly")}}


rows = [round_of(kind) for kind in options.only or KINDS]
print(markdown(rows[0], [row.values() for row in rows]))
if options.csv:
    write_csv(options.csv, rows)
