"""Arrays inside a page: their bytes by significance, deflated, as base64; table.js takes them out again."""

import base64
import zlib

import numpy as np

LEVEL = 6  # more makes the page 1 % smaller and takes twice as long


class Box:
    """Collects arrays; each becomes a script of its own that no browser runs."""

    def __init__(self):
        self.scripts = []

    def add(self, values):
        """What the page is told of the array: its number, the type of its items, how many there are."""
        values = np.ascontiguousarray(values).ravel()
        values = values.astype(values.dtype.newbyteorder("<"))
        bytes_ = values.view(np.uint8).reshape(values.size, values.itemsize).T  # alike bytes together: they pack better
        text = base64.b64encode(zlib.compress(bytes_.tobytes(), LEVEL)).decode("ascii")
        self.scripts.append(f'<script type="application/octet-stream" id="array{len(self.scripts)}">{text}</script>')
        return {"array": len(self.scripts) - 1, "type": values.dtype.str[1:], "count": int(values.size)}
