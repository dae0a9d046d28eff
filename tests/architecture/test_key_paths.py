"""Every key of scenes is used where a reader meets it, with a value that is not its default, or a reason says why not.

A key counts as used if a shipped scene or fitting problem has it, also within `set = {...}` or as the key of a scan's axis, or if
an example that the tests run sets it: a command of the docs (-s key=value), docs/python.md or a notebook.

    test_key_paths.py --list       prints every key and its path
"""

import json
import math
import re
import sys
import tomllib
import unittest

import rodwake
from doc_commands import blocks_of
from rodwake import SOURCE

SCHEMA = json.loads((SOURCE / "plots/rodwake_plots/schema.json").read_text())
KEYS = {f"{key['table'].replace('[]', '')}.{key['key']}".lstrip("."): key for key in SCHEMA["keys"]}
REASONS = SOURCE / "tests/data/keys_without_scene.toml"
UNITS = {"": 1.0, "s": 1.0, "ms": 1e-3, "Hz": 1.0, "m": 1.0, "cm": 1e-2, "mm": 1e-3, "um": 1e-6, "mm/s": 1e-3, "deg": math.pi / 180}
OPTION = re.compile(r"""(?:-s|--set)[ =]["']?([\w.]+)=("[^"]*"|'[^']*'|[^\s"']+)""")
PYTHON_SET = re.compile(r"""\.set\(\s*["']([\w.]+)["'],\s*(.+?)\)""")
PYTHON_ENTRY = re.compile(r"""["']((?:[a-z_]+\.)+[\w.]+)["']: (.+?)[,}\]]""")


def key_of(path):
    """The key of a dotted path with indices or entries of a table, as rods.1.position.0; None if it has none."""
    parts = [part for part in path.split(".") if not part.isdigit()]
    names = (".".join(parts[:count]) for count in range(len(parts), 0, -1))
    return next((name for name in names if name in KEYS), None)


def literal(text):
    """The value that TOML reads, else the text."""
    try:
        return tomllib.loads(f"x = {text}")["x"]
    except tomllib.TOMLDecodeError:
        return text.strip("\"'")


def is_default(key, value):
    """Whether writing this value changes nothing; quantities are compared in the unit of the key."""
    if key["required"]:
        return False
    default = literal(key["default"])
    if value == default:
        return True
    quantity = re.fullmatch(r"([-+\d.eE]+) ?(\S*)", value) if isinstance(value, str) else None
    if quantity and quantity[2] in UNITS and isinstance(default, float):
        return math.isclose(float(quantity[1]) * UNITS[quantity[2]], default)
    return False


def uses(tree, path=""):
    """(key, value) of each key of a scene, those that a variant, a model or an axis changes too."""
    for name, value in tree.items():
        here = f"{path}.{name}".lstrip(".")
        if here in KEYS:
            yield here, value
            if here in ("variants.set", "fit.models.set"):
                yield from ((key_of(changed), new) for changed, new in value.items())
            elif here in ("scan.axes.key", "scan.axes.keys"):
                yield from ((key_of(changed), None) for changed in ([value] if name == "key" else value))
        else:
            for entry in value if isinstance(value, list) else [value]:
                yield from uses(entry, here)


def sources():
    """(file, its uses) of all files where a key has its path, scenes first."""
    for folder in ("scenes", "fitting/problems", "examples"):
        for file in sorted((SOURCE / folder).rglob("*.toml")):
            yield file, uses(tomllib.loads(file.read_text()))
    for file in [SOURCE / "README.md", *sorted((SOURCE / "docs").glob("*.md"))]:
        run = "".join(block.script() for block in blocks_of(file, file.read_text()) if not block.reason)
        yield file, ((key_of(name), literal(value)) for name, value in OPTION.findall(run))
    for file in [SOURCE / "docs/python.md", *sorted((SOURCE / "examples/notebooks").glob("*.ipynb"))]:
        text = file.read_text().replace('\\"', '"')
        yield file, ((key_of(name), literal(value)) for form in (PYTHON_SET, PYTHON_ENTRY) for name, value in form.findall(text))


def key_paths():
    """{key: the first file that uses it}."""
    found = {}
    for file, used in sources():
        for key, value in used:
            if key and not is_default(KEYS[key], value):
                found.setdefault(key, str(file.relative_to(SOURCE)))
    return found


def reason_of(key, reasons):
    """The entry of the list, a key or a table, that covers the key."""
    return next((entry for entry in reasons if f"{key}.".startswith(f"{entry}.")), None)


class KeyPathsTest(unittest.TestCase):
    def test_every_key_has_a_path_or_a_reason(self):
        paths, reasons = key_paths(), tomllib.loads(REASONS.read_text())
        without = [key for key in KEYS if key not in paths]
        self.assertEqual([key for key in without if not reason_of(key, reasons)], [], "keys without a scene, an example or a reason")
        self.assertEqual(set(reasons) - {reason_of(key, reasons) for key in without}, set(), "reasons for keys that have a path or are gone")

    def test_a_default_is_no_use(self):
        for key, value in (("fit.starts", 1), ("granular.bead_radius", "0.4 mm"), ("granular.plates.frequency", "200 Hz"), ("rods_run.method", "auto")):
            self.assertTrue(is_default(KEYS[key], value), key)
        for key, value in (("fit.starts", 2), ("granular.bead_radius", "0.5 mm"), ("rods.position", [0.0, 1.0])):
            self.assertFalse(is_default(KEYS[key], value), key)

    def test_keys_are_found_wherever_a_scene_can_name_them(self):
        scene = tomllib.loads('[[variants]]\nset = {"granular.rods.0.kind" = "apolar"}\n[[scan.axes]]\nkey = "rods.1.position.0"\n[fit.start]\neta = 2')
        found = list(uses(scene))
        for use in (("granular.rods.kind", "apolar"), ("rods.position", None), ("fit.start", {"eta": 2})):
            self.assertIn(use, found)
        self.assertIsNone(key_of("granular.rods.0.kid"))


if __name__ == "__main__":
    if "--list" in sys.argv:
        named, why = key_paths(), tomllib.loads(REASONS.read_text())
        for key in KEYS:
            print(f"{key:40} {named.get(key) or 'no scene: ' + why.get(reason_of(key, why), '?')}")
    else:
        rodwake.main()
