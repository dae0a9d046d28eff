"""Studies write their tables into studies/reports."""

import contextlib
import importlib
import io
import re
import sys
import tempfile
import unittest
import unittest.mock
from pathlib import Path

import rodwake
from rodwake import SOURCE

sys.path.insert(0, str(SOURCE / "studies"))
import lab  # noqa: E402
import validate_field  # noqa: E402

MARK = re.compile(r"^<!-- studies/(\w+)\.py (\w+) -->$", re.MULTILINE)


class ReportsTest(unittest.TestCase):
    def run_study(self, folder, *words):
        arguments = ["validate_field.py", "--program", str(rodwake.PROGRAM), "--only", "plane", *words]
        with unittest.mock.patch.object(sys, "argv", arguments), unittest.mock.patch.object(lab, "REPORTS", folder):
            options = lab.parser("", "report", "quick", parts=validate_field.PARTS).parse_args(arguments[1:])
            with contextlib.redirect_stdout(io.StringIO()) as printed:
                lab.run_parts(options, validate_field.PARTS)
        return printed.getvalue()

    def test_a_part_replaces_its_table_and_nothing_else(self):
        with tempfile.TemporaryDirectory() as name:
            page = Path(name, "field.md")
            page.write_text("Before.\n\n<!-- studies/validate_field.py plane -->\nold\n<!-- end -->\n\n<!-- studies/validate_field.py periodic -->\n<!-- end -->\n")
            self.assertNotIn("| strain | 320 |", page.read_text())
            for _ in range(2):  # the second time it stands there
                printed = self.run_study(Path(name), "--report")
                text = page.read_text()
                self.assertIn("| strain | 320 |", printed)
                self.assertRegex(text, r"^Before\.\n\n<!-- studies/validate_field\.py plane -->\n\nBy `studies/validate_field\.py --only plane` on "
                                       r"\d{4}-\d\d-\d\d: .+, \d+ cores; rodwake \d\S+ \(\S+\), GNU .+\.\n\n### One rod on the plane\n\n\| quantity ")
                self.assertEqual((text.count("| strain | 320 |"), text.count("<!-- end -->"), text.count("old")), (1, 2, 0))
            page.write_text("No place.\n")
            self.assertIn("| strain | 320 |", self.run_study(Path(name)))
            with self.assertRaisesRegex(SystemExit, "no page of .* has the lines <!-- studies/validate_field.py plane -->"):
                self.run_study(Path(name), "--report")

    def test_marks_name_parts_of_studies(self):
        marks = []
        for page in sorted((SOURCE / "studies/reports").glob("*.md")):
            text = page.read_text(encoding="utf-8")
            found = MARK.findall(text)
            self.assertEqual(text.count("<!-- end -->"), len(found), page)
            for study, part in found:
                self.assertIn(part, getattr(importlib.import_module(study), "PARTS", ["all"]), page)
            marks += found
        self.assertGreater(len(marks), 1)
        self.assertEqual(sorted(set(marks)), sorted(marks))


if __name__ == "__main__":
    rodwake.main()
