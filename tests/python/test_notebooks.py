"""The notebooks in examples/ run from top to bottom, with the results that are kept in them."""

import math
import re
import unittest

import nbformat
from nbclient import NotebookClient
from program import SOURCE, new_folder

BOOKS = sorted((SOURCE / "examples/notebooks").glob("*.ipynb"))
NUMBER = re.compile(r"-?\d+\.?\d*(?:e[+-]?\d+)?")


def printed(cells):
    """Text of the outputs, its numbers apart."""
    text = "".join(output.get("text", "") or output.data.get("text/plain", "") for cell in cells for output in cell.outputs)
    return NUMBER.sub("#", text), [float(number) for number in NUMBER.findall(text)]


class NotebookTest(unittest.TestCase):
    def test_there_are_five(self):
        self.assertEqual([book.stem for book in BOOKS], ["fit", "pair", "phase_diagram", "tracks", "wake"])

    def test_each_runs(self):
        """One after the other in one interpreter, which takes longer to start than a notebook to run; each begins without names."""
        all_cells, code_of, kept = [], {}, {}
        for path in BOOKS:
            cells = nbformat.read(path, as_version=4).cells
            code_of[path.name] = [cell for cell in cells if cell.cell_type == "code"]
            kept[path.name] = printed(code_of[path.name])
            self.assertIn("image/png", path.read_text(), f"{path}: kept without results: tools/notebooks")
            all_cells += [nbformat.v4.new_code_cell("%reset -f"), *cells]
        book = nbformat.v4.new_notebook(cells=all_cells)
        NotebookClient(book, timeout=120, kernel_name="python3", resources={"metadata": {"path": str(new_folder(self))}}).execute()
        for name, code in code_of.items():
            self.assertTrue(any("image/png" in output.get("data", {}) for cell in code for output in cell.outputs), f"{name}: no picture")
            (text, numbers), (kept_text, kept_numbers) = printed(code), kept[name]
            self.assertEqual(text, kept_text, f"{name}: tools/notebooks")
            for number, known in zip(numbers, kept_numbers):
                self.assertTrue(math.isclose(number, known, rel_tol=1e-5, abs_tol=1e-9), f"{name}: {number} is kept as {known}: tools/notebooks")


if __name__ == "__main__":
    unittest.main()
