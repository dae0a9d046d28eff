"""The examples of docs/python.md, one after the other."""

import contextlib
import io
import re
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


if __name__ == "__main__":
    unittest.main()
