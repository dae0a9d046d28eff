"""The program, for tests that compare the package with it."""

import os
import subprocess
import tempfile
from pathlib import Path

import rodwake

SOURCE = Path(os.environ["RODWAKE_SOURCE_DIR"])
SCENES = SOURCE / "scenes"
PROGRAM = os.environ["RODWAKE_PROGRAM"]


def new_folder(test):
    """A folder that goes when the test ends."""
    keeper = tempfile.TemporaryDirectory(prefix="rodwake-python-")
    test.addCleanup(keeper.cleanup)
    return Path(keeper.name)


def run_scene(test, scene, *changes, verb="run"):
    """What the program makes of a scene with these settings of -s, opened."""
    folder = new_folder(test) / "run"
    settings = [word for change in changes for word in ("-s", change)]
    # No figures: they are not compared.
    verb = {"run": "rods"}.get(verb, verb)
    subprocess.run([PROGRAM, verb, scene, "-o", folder, "--quiet", "-j", "1", *settings], check=True)
    return rodwake.open_run(folder)
