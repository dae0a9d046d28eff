"""The verdict of every row, and the Markdown table."""

import csv
import hashlib
import re
import shlex
import textwrap
from dataclasses import dataclass
from pathlib import Path
from string import ascii_lowercase

import numpy as np

from . import judge, results
from .entry import Row, Subject

KEPT = Path(__file__).with_name("full.csv")  # verdicts of full results of an earlier time
LENGTH = re.compile(r"(?<=\d) ?a(?=[/²,.;:) ]|$)|\ba(?=²)")  # in bead radii
COLUMNS = ("row", "asked", "version", "verdict", "ours", "difference")


@dataclass(frozen=True)
class Found:
    row: Row
    judged: judge.Judged
    folders: tuple[Path, ...]   # of the runs that are there
    commands: tuple[str, ...]
    quick: bool                 # made with fewer runs
    kept: str = ""              # the version whose full results the verdict rests on, if they are not here


def asked(lab, row):
    """Of what the row's full results are."""
    return hashlib.sha256("".join(lab.asked(run, False) for run in row.runs).encode()).hexdigest()[:16]


def kept_verdicts(path=KEPT):
    return {entry["row"]: entry for entry in results.table(path)} if path.is_file() else {}


def keep(lab, found, path=KEPT):
    """Adds the rows whose results are all full, and would not all be made by --quick."""
    kept = kept_verdicts(path)
    for one in (one for _, rows in found for one in rows):
        if one.row.runs and len(one.folders) == len(one.row.runs) and not one.quick and any(run.quick != () for run in one.row.runs):
            version = results.read_json(one.folders[0], "provenance")["version"]
            kept[one.row.id] = dict(zip(COLUMNS, (one.row.id, asked(lab, one.row), version, one.judged.verdict, one.judged.ours, one.judged.difference)))
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, COLUMNS, lineterminator="\n")
        writer.writeheader()
        writer.writerows(kept.values())


def judge_all(lab, subjects, kept=None):
    kept = kept_verdicts() if kept is None else kept
    return [(subject, [of_full_results(lab, judge_row(lab, row), kept.get(row.id)) for row in subject.rows]) for subject in subjects]


def of_full_results(lab, one, entry):
    """The verdict kept of full results of the same scenes and settings stands for quick ones and for none."""
    if not entry or entry["asked"] != asked(lab, one.row) or (len(one.folders) == len(one.row.runs) and not one.quick):
        return one
    commands = tuple(shlex.join(lab.command(run, False)) for run in one.row.runs)
    return Found(one.row, judge.Judged(entry["verdict"], entry["ours"], entry["difference"]), one.folders, commands, False, entry["version"])


def judge_row(lab, row):
    """Reasons why there is no value make the verdict "inconclusive", too."""
    there = [lab.found(run) for run in row.runs]
    commands = tuple(shlex.join(lab.command(run, got[1] if got else lab.quick and run.quick is not None)) for run, got in zip(row.runs, there))
    folders = tuple(got[0] for got in there if got)
    missing = next((run for run, got in zip(row.runs, there) if not got), None)
    if missing:
        judged = judge.unknown(lab.failed.get(missing.name) or ("needs --full" if missing.quick is None else "not run yet"))
    else:
        try:
            judged = row.judge(*folders)
        except (LookupError, ValueError, OSError, TypeError, ArithmeticError, AttributeError, np.linalg.LinAlgError) as error:
            judged = judge.unknown(f"the results do not hold it: {error!r}")
    return Found(row, judged, folders, commands, any(got and got[1] and run.quick for run, got in zip(row.runs, there)))


def counts(found):
    verdicts = [one.judged.verdict for _, rows in found for one in rows if one.row.counted]
    return {verdict: verdicts.count(verdict) for verdict in judge.VERDICTS}


def markdown(found):
    """One table a claim; a row that holds quick results is marked. A reason of several rows stands once, below their table."""
    lines = [", ".join(f"{number} {verdict}" for verdict, number in counts(found).items()) +
             "; q: few runs (`--quick`); f: full results of the same scenes and settings, kept\nfrom an earlier version (`studies/paper_rows/full.csv`)."]
    for subject, rows in found:
        counted = [one for one in rows if one.row.counted]
        if counted:
            reasons = shared_reasons(counted)
            lines += ["", f"### {subject.title}", "", "| row | paper | statement | ours | difference | verdict |", "|---|---|---|---|---|---|"]
            lines += [markdown_row(one, reasons) for one in counted]
            for reason, letter in reasons.items():
                lines += ["", textwrap.fill(f"({letter}) {reason}", 118, break_on_hyphens=False)]
    return "\n".join(lines) + "\n"


def lengths(text):
    """The bead radius as a symbol."""
    return LENGTH.sub(lambda found: " $a$" if found.start() and text[found.start() - 1].isdigit() else "$a$", text)


def why(one):
    """Of what differs or stays open, not of what has no value."""
    return "" if one.judged.verdict == judge.MATCHES or one.judged.ours == judge.NOTHING else one.row.why


def shared_reasons(rows):
    """{reason: letter} of those that two rows and more have."""
    reasons = [why(one) for one in rows if why(one)]
    return dict(zip(dict.fromkeys(reason for reason in reasons if reasons.count(reason) > 1), ascii_lowercase))


def markdown_row(one, reasons):
    reason = f" ({reasons[why(one)]})" if why(one) in reasons else f". {why(one)}" if why(one) else ""
    cells = (one.row.id + (" (q)" if one.quick else " (f)" if one.kept else ""), one.row.place, one.row.says, one.judged.ours, one.judged.difference,
             f"**{one.judged.verdict}**{reason}")
    return "| " + " | ".join(lengths(cell.replace("|", "\\|")) for cell in cells) + " |"
