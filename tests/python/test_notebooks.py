"""The notebooks in examples/ run from top to bottom, and are kept without their results."""

import unittest

import nbformat
from nbclient import NotebookClient
from program import SOURCE, new_folder

BOOKS = sorted((SOURCE / "examples/notebooks").glob("*.ipynb"))


class NotebookTest(unittest.TestCase):
    def test_there_are_five(self):
        self.assertEqual([book.stem for book in BOOKS], ["fit", "pair", "phase_diagram", "tracks", "wake"])

    def test_each_runs(self):
        """One after the other in one interpreter, which takes longer to start than a notebook to run; each begins without names."""
        all_cells, code_of = [], {}
        for path in BOOKS:
            cells = nbformat.read(path, as_version=4).cells
            code_of[path.name] = [cell for cell in cells if cell.cell_type == "code"]
            self.assertTrue(all(not cell.outputs and cell.execution_count is None for cell in code_of[path.name]), f"{path}: kept with results")
            all_cells += [nbformat.v4.new_code_cell("%reset -f"), *cells]
        book = nbformat.v4.new_notebook(cells=all_cells)
        NotebookClient(book, timeout=120, kernel_name="python3", resources={"metadata": {"path": str(new_folder(self))}}).execute()
        for name, code in code_of.items():
            self.assertTrue(any("image/png" in output.get("data", {}) for cell in code for output in cell.outputs), f"{name}: no picture")


if __name__ == "__main__":
    unittest.main()
