"""What is installed beside the package: the programs that draw figures and read the films of other programs."""

from __future__ import annotations

import sys
from pathlib import Path

_HERE = Path(__file__).resolve().parent


def folder(name: str) -> Path:
    """The folder that holds the package rodwake_<name>: beside this one (pip), in the source tree, or below the prefix of an
    installation."""
    places = (_HERE.parent, _HERE.parents[1] / name, _HERE.parents[3] / "share/rodwake" / name)
    return next((place for place in places if (place / f"rodwake_{name}").is_dir()), _HERE.parent)


def converter() -> list[str]:
    """The command that reads and writes films of other programs: what `rodwake convert` runs, by this interpreter."""
    return [sys.executable, str(folder("convert") / "rodwake_convert")]
