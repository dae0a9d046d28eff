"""The commands of a page: its blocks of kind `sh`, and how the tests run them.

A comment before a block says what is different there, always with the reason:

    <!-- not run: needs SLURM -->
    <!-- run with "40 a" for "312 a": the large box takes minutes -->

Shipped scenes are run with the settings of shorter.py and without figures, the longest with --dry-run.
"""

import os
import re
import subprocess
import sys
from dataclasses import dataclass, field
from pathlib import Path

import rodwake
from rodwake import SCENES
from shorter import LONG, shorter

COMMAND = re.compile(r"\s*\$?\s*(rodwake|mpiexec|(?:tools|studies)/\w+|build/\S+/rodwake|cmake|ctest|sbatch) ")
NOT_RUN = re.compile(r"<!-- not run: (\S.*?) -->")
RUN_WITH = re.compile(r'<!-- run with ("[^"]*" for "[^"]+"(?:, "[^"]*" for "[^"]+")*): \S.*? -->')


@dataclass
class Block:
    place: str  # file:line
    text: str
    reason: str = ""  # why it is not run; empty: it is
    changes: list = field(default_factory=list)  # (what stands there, what is run)

    def script(self):
        text = self.text
        for there, instead in self.changes:
            assert there in text, f"{self.place}: the block has no {there!r}"
            text = text.replace(there, instead)
        return text


def blocks_of(path, text):
    """The `sh` blocks of a page in order. Raises ValueError for commands in a block of another kind, and for a comment that it
    cannot read."""
    lines, found = text.split("\n"), []
    kind, begin = None, 0
    for number, line in enumerate(lines, 1):
        if line.startswith("```"):
            if kind is None:
                kind, begin = line[3:].strip() or "text", number
            else:
                if kind == "sh":
                    found.append(block(f"{path}:{begin}", lines[begin:number - 1], lines[begin - 2] if begin > 1 else ""))
                kind = None
        elif kind != "sh" and COMMAND.match(line) and (kind or line.startswith("    ")):
            raise ValueError(f"{path}:{number}: a command outside of a block of kind sh, so no test runs it: {line.strip()}")
    return found


def block(place, lines, comment):
    text = "\n".join(lines) + "\n"
    if not comment.startswith("<!--"):
        return Block(place, text)
    if match := NOT_RUN.fullmatch(comment):
        return Block(place, text, reason=match[1])
    if match := RUN_WITH.fullmatch(comment):
        return Block(place, text, changes=[(there, instead) for instead, there in re.findall(r'"([^"]*)" for "([^"]+)"', match[1])])
    raise ValueError(f"{place}: the comment before this block says neither why it is not run nor what is run instead: {comment}")


def extra_arguments(arguments):
    """What a test adds to a command line of the program."""
    scenes = [Path(word).stem for word in arguments[1:] if word.endswith(".toml") and "=" not in word]
    if not scenes or arguments[0] not in rodwake.STAGE_VERBS:
        return []
    if scenes[0] in LONG:
        return ["--dry-run"]
    # Figures of shipped scenes are drawn by tests/cli/test_scenes.py; here only those that a command changes.
    shipped = (SCENES / f"{scenes[0]}.toml").is_file() and not any("figures" in word for word in arguments)
    return shorter(scenes[0]) + ["--no-figures"] * (arguments[0] == "run" and shipped)


def run(block, folder):
    """Runs the block as a shell does that stops at the first command that fails; the finished process."""
    path = Path(folder) / ".bin"
    path.mkdir(exist_ok=True)
    program = path / "rodwake"
    program.write_text(f"#!/bin/sh\nexec '{sys.executable}' '{Path(__file__).resolve()}' \"$@\"\n")
    program.chmod(0o755)
    environment = {**os.environ, "PATH": f"{path}:{os.environ['PATH']}", "OMPI_ALLOW_RUN_AS_ROOT": "1",
                   "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1", "OMPI_MCA_rmaps_base_oversubscribe": "1"}
    return subprocess.run(["bash", "-e", "-u", "-x", "-o", "pipefail", "-c", block.script()], cwd=folder, text=True,
                          capture_output=True, timeout=900, env=environment)


if __name__ == "__main__":  # in place of the program
    words = sys.argv[1:]
    os.execv(rodwake.PROGRAM, rodwake.command(*words, *(extra_arguments(words) if words else [])))
