"""The verdict of every row, and the Markdown table."""

import shlex
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from . import judge
from .entry import Row, Subject


@dataclass(frozen=True)
class Found:
    row: Row
    judged: judge.Judged
    folders: tuple[Path, ...]   # of the runs that are there
    commands: tuple[str, ...]
    quick: bool                 # made with fewer runs


def judge_all(lab, subjects):
    return [(subject, [judge_row(lab, row) for row in subject.rows]) for subject in subjects]


def judge_row(lab, row):
    """Reasons why there is no value make the verdict "cannot tell", too."""
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
    verdicts = [one.judged.verdict for _, rows in found for one in rows]
    return {verdict: verdicts.count(verdict) for verdict in judge.VERDICTS}


def markdown(found):
    """One table a subject; a row that holds quick results is marked."""
    lines = [", ".join(f"{number} {verdict}" for verdict, number in counts(found).items()) + "; q: few runs (`--quick`)."]
    for subject, rows in found:
        lines += ["", f"### {subject.title}", "", "| row | paper | says | ours | difference | verdict |", "|---|---|---|---|---|---|"]
        lines += [markdown_row(one) for one in rows]
    return "\n".join(lines) + "\n"


def why(one):
    """Of what differs or stays open, not of what has no value."""
    return "" if one.judged.verdict == judge.MATCHES or one.judged.ours == judge.NOTHING else one.row.why


def markdown_row(one):
    cells = (one.row.id + (" (q)" if one.quick else ""), one.row.place, one.row.says, one.judged.ours, one.judged.difference,
             f"**{one.judged.verdict}**{'. ' + why(one) if why(one) else ''}")
    return "| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |"
