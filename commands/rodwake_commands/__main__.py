"""The commands `rodwake tradeoff`, `design` and `camera`: `rodwake` checks the options and runs this folder with them.

    python3 commands/rodwake_commands PROGRAM COMMAND NAME=VALUE ...

Exit codes are those of `rodwake`: 0 done, 1 failed, 2 wrong input, 130 and 143 after a signal.
"""

import importlib
import signal
import sys
from pathlib import Path


def find_package(program):
    """Puts the Python package of the same build first on the module path: of a build tree, an installation, or a wheel."""
    for folder in (program.parent / "python", *program.parents[1].glob("lib/python3*/*-packages"), *program.parents[3:4]):
        if any((folder / "rodwake").glob("_core.*")):
            sys.path.insert(0, str(folder))
            return
    sys.exit(f"rodwake: this command needs the Python package rodwake, which is neither in {program.parent}/python nor below "
             f"{program.parents[1]}/lib; build with RODWAKE_PYTHON_PACKAGE=ON, or pip install rodwake")


class Stopped(BaseException):
    """Ctrl-C or SIGTERM."""

    def __init__(self, number):
        super().__init__()
        self.exit_code = 128 + number


def stop(number, _):
    """Ends the command once: the program that runs this one passes its own signals on, more than once."""
    for each in (signal.SIGINT, signal.SIGTERM):
        signal.signal(each, signal.SIG_IGN)
    raise Stopped(number)


def main():
    program, command, *words = sys.argv[1:]
    for each in (signal.SIGINT, signal.SIGTERM):
        signal.signal(each, stop)
    find_package(Path(program))
    sys.path.insert(0, str(Path(__file__).resolve().parent.parent))
    from rodwake import InputError, RunError
    from rodwake_commands.request import Request
    try:
        return importlib.import_module(f"rodwake_commands.{command}").main(Request(words, program)) or 0
    except (Stopped, KeyboardInterrupt) as stopped:
        return getattr(stopped, "exit_code", 130)
    except InputError as error:
        print(f"rodwake: {error}", file=sys.stderr)
        return 2
    except (RunError, OSError) as error:
        print(f"rodwake: {error}", file=sys.stderr)
        return 1


if __name__ == "__main__":
    sys.exit(main())
