"""What a row of the page is made of. A new row is one Row in the file of its subject, and its name in CLAIMS."""

from collections.abc import Callable
from dataclasses import dataclass


@dataclass(frozen=True)
class Run:
    """A command of rodwake and the folder of its results: `rodwake run SCENE -s SETTING...`.

    quick holds further settings for --quick; (): the run is the same in both; None: it is made with --full only.
    """
    name: str
    scene: str                      # of scenes/, or a path from the top of the source tree
    settings: tuple[str, ...] = ()
    quick: tuple[str, ...] | None = ()


@dataclass(frozen=True)
class Row:
    """judge gets the folders of runs, in their order, and returns what was found with the verdict."""
    id: str
    place: str                      # in the paper
    says: str                       # its value or statement
    judge: Callable
    runs: tuple[Run, ...] = ()
    figures: tuple[str, ...] = ()   # names of [[figures]] of the runs; the first run that has one shows it
    why: str = ""                   # why it differs or is unknown, as far as known
    made: str = ""                  # instead of commands, for what no run makes
    counted: bool = True            # False: on the page alone, as it is an input, or a film whose verdict another row has


@dataclass(frozen=True)
class Subject:
    title: str
    rows: tuple[Row, ...]
