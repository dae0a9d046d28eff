"""The examples of docs/python.md, one after the other, and docs/python_reference.md."""

import contextlib
import io
import re
import subprocess
import sys
import unittest

from program import SCENES, SOURCE, new_folder

PAGE = SOURCE / "docs/python.md"


class DocsTest(unittest.TestCase):
    def test_every_example_of_the_page_runs(self):
        text = PAGE.read_text()
        examples = list(re.finditer(r"```python\n(.*?)```", text, re.DOTALL))
        self.assertGreaterEqual(len(examples), 5)
        names = {"scenes": SCENES, "folder": new_folder(self), "__name__": "__main__"}
        for example in examples:
            line = text.count("\n", 0, example.start(1))
            with contextlib.redirect_stdout(io.StringIO()):
                exec(compile("\n" * line + example[1], str(PAGE), "exec"), names)  # errors name the line of the page

    def test_the_reference_is_the_page_in_docs(self):
        made = subprocess.run([sys.executable, SOURCE / "tools/python_reference"], capture_output=True, text=True)
        self.assertEqual(made.stderr, "")
        page = (SOURCE / "docs/python_reference.md").read_text()
        self.assertTrue(made.stdout == page, "regenerate it: ninja reference")
        for line in ("- `kappa` (float): Rate at which a rod turns", "- `poses` (array): (T, N, 3): x, y, heading, unwrapped",
                     "- `eta` (float): lambda/mu, compression over shear modulus K/mu", "#### `Bed.advance`", "### `plots.draw`"):
            self.assertIn(line, page)


if __name__ == "__main__":
    unittest.main()
