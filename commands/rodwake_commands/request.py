"""The options of a command, as the program has checked them."""

import sys
from collections import defaultdict
from pathlib import Path

import rodwake
from rodwake import _core


class Request:
    """Words NAME=VALUE, in the order of the command line. Options that were not given are empty."""

    def __init__(self, words, program=None):
        self.program = program
        self._given = defaultdict(list)
        for word in words:
            name, _, value = word.partition("=")
            self._given[name].append(value)

    def all(self, name):
        return self._given[name]

    def text(self, name, otherwise=""):
        return self._given[name][-1] if self._given[name] else otherwise

    def number(self, name, otherwise):
        return float(self.text(name, otherwise))

    def whole(self, name, otherwise):
        return int(self.text(name, otherwise))

    def flag(self, name):
        return bool(self._given[name])

    def scene(self, *settings):
        """The scene of the command line with its settings -s, then `settings` ("key=value"), every default written out."""
        scene = _core.read_scene(self.text("target"), [*self.all("set"), *settings])
        return rodwake.Scene.parse(scene.to_toml(), self.text("target"))

    def folder(self):
        """The folder for the results."""
        return Path(self.text("output"))

    def say(self, text):
        if not self.flag("quiet"):
            print(text, file=sys.stderr)
