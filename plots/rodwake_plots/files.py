"""Files that are complete or not there: written under another name, brought to the disk, renamed."""

import contextlib
import functools
import os

from . import stop
from .errors import PlotError


@contextlib.contextmanager
def replacing(path):
    """A temporary path beside `path`, moved over it only when all went well; the error of a failed write has the name of the file."""
    temporary = path.with_name(f".{path.name}.{os.getpid()}.tmp")
    remove = functools.partial(temporary.unlink, missing_ok=True)
    with stop.undoing(remove):
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            yield temporary
            bring_to_disk(temporary)
            os.replace(temporary, path)
        except OSError as error:
            raise PlotError(f"{path}: cannot be written: {error.strerror or error}") from error
        finally:
            with contextlib.suppress(OSError):
                remove()


def bring_to_disk(path):
    """A disk that is full or broken may say so only now."""
    with open(path, "rb+") as file:
        os.fsync(file.fileno())


def write(path, data):
    """Bytes, or text; what no encoding has, such as half a surrogate pair of a JSON file, becomes a question mark."""
    with replacing(path) as temporary:
        temporary.write_bytes(data.encode("utf-8", "replace") if isinstance(data, str) else data)
