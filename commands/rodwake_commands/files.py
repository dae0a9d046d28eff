"""Files and folders that a command writes, and the numbers in them."""

import contextlib
import os
from pathlib import Path

from rodwake import InputError, RunError


def refuse_link(path):
    """A folder or file of a command may not be a link, through which it would change what lies elsewhere."""
    if path.is_symlink():
        raise InputError(f"{path}: is a link, and rodwake does not write through links: remove it, or choose another folder with -o")


def refuse_present(path):
    """Results stay unless --force says otherwise."""
    if path.exists():
        raise InputError(f"{path}: already exists; --force replaces it, or name another folder with -o")


def number(x):
    """The shortest text that is read as the same number; 12, not 12.0."""
    return repr(float(x)).removesuffix(".0")


def write_atomically(path, content):
    """Writes bytes or text beside `path` and moves it there, so that the file is whole or as it was before."""
    temporary = Path(f"{path}.tmp{os.getpid()}")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        temporary.unlink(missing_ok=True)
        with temporary.open("xb") as file:
            file.write(content.encode("utf-8", "replace") if isinstance(content, str) else content)
            file.flush()
            os.fsync(file.fileno())
        temporary.replace(path)
    except OSError as error:
        raise RunError(f"{path}: cannot be written: {error.strerror}") from error
    finally:
        with contextlib.suppress(OSError):
            temporary.unlink(missing_ok=True)
