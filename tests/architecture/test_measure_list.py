"""The list of measures that CMake makes of the folder with their files (cmake/measures.cmake)."""

import os
import subprocess
import tempfile
import unittest
from pathlib import Path

import rodwake

TEMPLATE = rodwake.SOURCE / "app/bed/measure_kinds.cpp.in"
GOOD = "namespace rodwake::app::measures {{\nMeasureKind {}() {{\n    return {{}};\n}}\n}}\n"


class MeasureListTest(unittest.TestCase):
    def setUp(self):
        scratch = tempfile.TemporaryDirectory(prefix="rodwake-list-")
        self.addCleanup(scratch.cleanup)
        self.folder = Path(scratch.name)

    def listed(self, **files):
        """Whether CMake is content, what it says, and the source that it made."""
        paths = []
        for name, text in files.items():
            paths.append(self.folder / f"{name}.cpp")
            paths[-1].write_text(text)
        made = self.folder / "list.cpp"
        script = self.folder / "script.cmake"
        script.write_text(f'include("{rodwake.SOURCE}/cmake/measures.cmake")\n'
                          f'rodwake_list_measures("{TEMPLATE}" "{made}" {" ".join(map(str, paths))})\n')
        done = subprocess.run([os.environ.get("RODWAKE_CMAKE", "cmake"), "-P", script], capture_output=True, text=True)
        return done.returncode == 0, " ".join(done.stderr.split()), made.read_text() if made.exists() else ""

    def test_every_file_is_declared_and_called(self):
        content, said, text = self.listed(order=GOOD.format("order"), agitation=GOOD.format("agitation"))
        self.assertEqual((content, said), (True, ""))
        for name in ("order", "agitation"):
            self.assertEqual(text.count(f"MeasureKind {name}();"), 1)
            self.assertEqual(text.count(f"measures::{name}(),"), 1)

    def test_a_file_without_its_measure_is_named(self):
        for text in ("", GOOD.format("order"), "// MeasureKind agitation() { is to come }\n"):
            content, said, made = self.listed(agitation=text)
            self.assertEqual((content, made), (False, ""))
            self.assertIn('agitation.cpp defines no "MeasureKind agitation()"', said)


if __name__ == "__main__":
    rodwake.main()
