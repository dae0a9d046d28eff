"""What all studies share: options, runs that are kept, results of runs, values with errors, tables in Markdown.

A study has parts, functions of a Lab that print what they find, and ends with

    run_parts(parser(__doc__, "keep", "threads", parts=PARTS).parse_args(), PARTS)
"""

import argparse
import contextlib
import csv
import io
import json
import math
import os
import shlex
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import h5py
import numpy as np

SOURCE = Path(__file__).resolve().parents[1]
PROGRAM = SOURCE / "build" / "release" / "rodwake"
REPORTS = SOURCE / "studies" / "reports"
RESULTS = {"dem": "summary.json", "measure": "measure.json", "fit": "fit.json", "scan": "scan.json", "rods": "outcome.json"}
NAN = math.nan

# Options. One that a study takes beside --program and --only is named to parser().

OPTIONS = {
    "quick": (("--quick",), {"action": "store_true", "help": "few and short runs, to see that everything works"}),
    "threads": (("-j",), {"type": int, "default": 2, "help": "threads [2]"}),
    "keep": (("--keep",), {"type": Path, "help": "folder for the results: the same command goes on there; otherwise they are removed"}),
    "runs": (("--runs",), {"type": int, "help": "number of runs in place of the scenes'"}),
    "seed": (("--seed",), {"type": int, "default": 1, "help": "of what is drawn by chance [1]"}),
    "report": (("--report",), {"action": "store_true", "help": "write the tables into studies/reports, with date, machine and commit"}),
    "csv": (("--csv",), {"type": Path, "help": "file for the rows of the table"}),
}


def parser(doc, *names, parts=(), chosen=None, program=PROGRAM):
    """Of a study with these parts, those chosen if --only names none."""
    found = argparse.ArgumentParser(description=doc, formatter_class=argparse.RawDescriptionHelpFormatter)
    found.add_argument("--program", type=Path, default=program)
    found.add_argument("--only", default=list(parts if chosen is None else chosen), type=names_among(parts),
                       help="parts, separated by commas: " + ", ".join(parts))
    for name in names:
        flags, keys = OPTIONS[name]
        found.add_argument(*flags, **keys)
    return found


def names_among(parts):
    def read(text):
        names = [name for name in text.split(",") if name]
        if unknown := [name for name in names if parts and name not in parts]:
            raise argparse.ArgumentTypeError(f"no such part: {', '.join(unknown)}; there are {', '.join(parts)}")
        return names
    return read


@contextlib.contextmanager
def open_lab(options, kind=None):
    """In the folder of --keep, or in one that is removed; `kind` is the class."""
    with tempfile.TemporaryDirectory() as scratch:
        lab = (kind or Lab)(options.program, getattr(options, "keep", None) or scratch, getattr(options, "j", None), getattr(options, "quick", False))
        lab.options = options
        yield lab


def run_parts(options, parts, before=lambda name: None, kind=None):
    """Each part that was asked for, and what it took; `before` says what one begins with."""
    with open_lab(options, kind) as lab:
        version = lab.call("--version").stdout.strip()
        print(f"{version}, {time.strftime('%Y-%m-%d')}" + (" (quick: numbers mean nothing)" if lab.quick else ""))
        pages = {name: report_page(name) for name in options.only} if getattr(options, "report", False) else {}
        if pages and lab.quick:
            sys.exit("--report: not with --quick, whose numbers mean nothing")
        for name in options.only:
            before(name)
            began = time.monotonic()
            if pages:
                printed = io.StringIO()
                with contextlib.redirect_stdout(printed):
                    parts[name](lab)
                print(printed.getvalue())
                write_report(pages[name], name, f"{stamp(lab, name)}\n\n{printed.getvalue().strip()}")
            else:
                parts[name](lab)
            print(f"({name}: {time.monotonic() - began:.0f} s)", flush=True)


# Reports. What a part prints stands in a page of studies/reports between two comments, which decide where:
#
#     <!-- studies/validate_field.py plane -->
#     <!-- end -->


def report_mark(part):
    return f"<!-- studies/{Path(sys.argv[0]).name} {part} -->\n"


def report_page(part):
    """The page that has a place for the part of this study."""
    for page in sorted(REPORTS.glob("*.md")):
        if report_mark(part) in page.read_text(encoding="utf-8"):
            return page
    sys.exit(f"--report: no page of {REPORTS} has the lines {report_mark(part).strip()} and <!-- end -->")


def write_report(page, part, text):
    before, mark, after = page.read_text(encoding="utf-8").partition(report_mark(part))
    page.write_text(f"{before}{mark}\n{text}\n\n<!-- end -->{after.partition('<!-- end -->')[2]}", encoding="utf-8")


def stamp(lab, part=None):
    """Command, date, class of the machine, and program."""
    words, options = iter(sys.argv[1:]), []
    for word in words:
        if word in ("--only", "--program", "--keep", "-j"):
            next(words)
        elif word != "--report":
            options.append(word)
    info = dict(line.split(maxsplit=1) for line in lab.call("info").stdout.splitlines())
    command = shlex.join([f"studies/{Path(sys.argv[0]).name}", *(["--only", part] if part else []), *options])
    return (f"By `{command}` on {time.strftime('%Y-%m-%d')}: {info['cpu']}, {os.cpu_count()} cores; rodwake {info['rodwake']}, {info['compiler']}, "
            f"{info['build']}.")


# Runs.


class Lab:
    """Runs the program in a folder and keeps what is done: the same command goes on where it was stopped."""

    def __init__(self, program, folder, threads=None, quick=False):
        self.program, self.folder = str(Path(program).absolute()), Path(folder).resolve()
        self.threads, self.quick = threads, quick
        self.folder.mkdir(parents=True, exist_ok=True)

    def seconds(self, value):
        return max(6.0, value / 20) if self.quick else value

    def count(self, runs):
        return min(runs, 2) if self.quick else runs

    def write(self, name, text):
        path = self.folder / name
        path.write_text(text, encoding="utf-8")
        return path

    @staticmethod
    def text_of(scene):
        return scene if "\n" in scene else (SOURCE / "scenes" / scene).read_text(encoding="utf-8")

    def call(self, *words, good=(0,), **keys):
        """The process, which must end with an exit code that is good (none named: any)."""
        command = [self.program, *map(str, words)]
        done = subprocess.run(command, capture_output=True, text=True, errors="replace", cwd=self.folder, check=False, **keys)
        if good and done.returncode not in good:
            sys.exit(f"{shlex.join(command)}: exit code {done.returncode}\n{done.stdout}{done.stderr}")
        return done

    def make(self, name, scene, *settings, verbs=("run",), seed=None, good=(0,)):
        """The run directory of a scene, which is its text or the name of a shipped one; taken as it is if it was made of the same."""
        asked = self.text_of(scene) + "".join(f"# -s {one}\n" for one in settings) + ("" if seed is None else f"# --seed {seed}\n")
        file, out = self.folder / f"{name}.toml", self.folder / name
        same = file.is_file() and file.read_text(encoding="utf-8") == asked
        if same and is_finished(out, *(RESULTS[verb] for verb in verbs if verb in RESULTS)):
            return out
        self.write(file.name, asked)
        words = ["--quiet", *(f"-s{one}" for one in settings), *([] if self.threads is None else ["-j", self.threads]),
                 *([] if seed is None else ["--seed", seed])]
        began = time.monotonic()
        for verb in verbs:
            fresh = [] if same or verb != verbs[0] else ["--force"]  # of the same scene the program goes on
            self.call(verb, file, "-o", out, *words, *fresh, good=good)
        print(f"  ({name}: {time.monotonic() - began:.0f} s)", file=sys.stderr, flush=True)
        return out


def is_finished(folder, *results):
    """Whether the last command in it ended well, and these files are there."""
    record = folder / "provenance.json"
    return (record.is_file() and json.loads(record.read_text())["status"] == "finished"
            and all((folder / name).is_file() for name in results))


# Results.


def read_json(folder, name):
    return json.loads((folder / f"{name}.json").read_text(encoding="utf-8"))


def rows_of(text):
    """Of a table with comment lines, as dictionaries."""
    return list(csv.DictReader(line for line in text.splitlines() if not line.startswith("#")))


def rows(path):
    return rows_of(path.read_text(encoding="utf-8"))


def columns(path, *names):
    """Columns as arrays, NaN where a cell is empty; without names all of them, by name."""
    found = rows(path)
    arrays = {name: np.array([float(row[name] or "nan") for row in found]) for name in names or found[0]}
    return tuple(arrays.values()) if names else arrays


def datasets(path, group, *names):
    with h5py.File(path) as file:
        return [file[f"{group}/{name}"][()] for name in names]


def cases(folder):
    """(row of series.csv, folder) of the scene and its variants."""
    return [(row, folder if row["name"] == "scene" else folder / "variants" / row["name"]) for row in rows(folder / "series.csv")]


def tracks(folder):
    """Of each run, its columns by name."""
    return [columns(path) for path in sorted(folder.glob("runs/*/tracks.csv"))]


def norm_error(got, want, names):
    """|got - want| over |want| of the vector or tensor in these columns of two rows."""
    difference = math.hypot(*(float(got[name]) - float(want[name]) for name in names))
    return difference / math.hypot(*(float(want[name]) for name in names))


# Lines that are kept as they come: a study that goes on takes them up.


def kept_lines(path):
    """Entries of a file with a JSON text a line; the last one may have been cut off."""
    found = []
    for line in path.read_text(encoding="utf-8").splitlines() if path.is_file() else ():
        with contextlib.suppress(json.JSONDecodeError):
            found.append(json.loads(line))
    return found


def keep_line(path, entry):
    with open(path, "a", encoding="utf-8") as file:
        file.write(json.dumps(entry) + "\n")


def kept_rows(path):
    return rows(path) if path and path.exists() else []


def keep_row(path, row):
    """Adds a row to a CSV file, whose first one makes the header; no path: nowhere."""
    if path:
        new = not path.exists()
        with open(path, "a", newline="", encoding="utf-8") as file:
            writer = csv.DictWriter(file, list(row))
            if new:
                writer.writeheader()
            writer.writerow(row)


def write_csv(path, found, shown=lambda value: value):
    """Rows, which are dictionaries, those of the first one's columns; `shown` makes the cells."""
    with open(path, "w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, list(found[0]), restval="")
        writer.writeheader()
        writer.writerows({key: shown(value) for key, value in row.items()} for row in found)


# Values with errors: pairs of both; the error of a single run is NaN.


def estimate(entry, *keys):
    """Of an entry of a result file with "value" and "error", or of a file's keys `name` and `name_error`."""
    pair = (entry[keys[0]], entry.get(f"{keys[0]}_error")) if keys else (entry["value"], entry["error"])
    return tuple(NAN if one is None else one for one in pair)


def mean(values):
    """Mean and standard error of independent values."""
    values = np.asarray(values, dtype=float)
    return values.mean(), values.std(ddof=1) / math.sqrt(len(values)) if len(values) > 1 else NAN


def weighted(pairs):
    """Mean of (value, error) with weights 1/error^2."""
    values, errors = (np.array(column, dtype=float) for column in zip(*pairs))
    if len(values) == 1 or not np.isfinite(errors).all():
        return values.mean(), errors[0] if len(values) == 1 else NAN
    weights = 1 / errors**2
    return (weights * values).sum() / weights.sum(), weights.sum() ** -0.5


def ratio(top, bottom):
    """Of two independent (value, error)."""
    value = top[0] / bottom[0]
    return value, abs(value) * math.hypot(top[1] / top[0], bottom[1] / bottom[0])


def leave_one_out(function, n):
    """The jackknife's error of a function of the runs that are kept, an array of truths."""
    if n < 2:
        return NAN
    left = np.array([function(np.arange(n) != k) for k in range(n)])
    return np.sqrt((n - 1) / n * ((left - left.mean(axis=0)) ** 2).sum(axis=0))


def line_fit(x, y, error):
    """Of a straight line: (slope, error), (intercept, error), their covariance."""
    found, covariance = np.polyfit(x, y, 1, w=1.0 / np.asarray(error), cov="unscaled")
    return *zip(found, np.sqrt(np.diag(covariance))), covariance


def text(pair, scale=1.0, digits=2):
    value, error = pair
    if not math.isfinite(value):
        return "-"
    return f"{scale * value:.{digits}f}" + (f" +- {scale * error:.{digits}f}" if math.isfinite(error) else "")


# Tables and figures.


def markdown(head, lines):
    """A table: the claim or case, what is asked or the reference, what was found with its error, the command."""
    first, *others = ("| " + " | ".join(map(str, cells)) + " |" for cells in (head, *lines))
    return "\n".join([first, "|" + "---|" * len(head), *others])


def table(title, head, lines):
    print(f"\n### {title}\n\n{markdown(head, lines)}\n", flush=True)


def drawing():
    """(canvas, style) of the program's own figures."""
    sys.path.insert(0, str(SOURCE / "plots"))
    import matplotlib  # pylint: disable=import-outside-toplevel
    from rodwake_plots import canvas, style  # pylint: disable=import-outside-toplevel
    matplotlib.rcParams.update(style.SETTINGS)
    return canvas, style
