"""What the tests of the plots share: a folder to draw in, running the program on it, looking at what came out."""

import contextlib
import io
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import matplotlib.image

PROGRAM = Path(__file__).resolve().parents[2] / "plots" / "rodwake_plot.py"
sys.path.insert(0, str(PROGRAM.parent))
import rodwake_plot  # noqa: E402


class PlotCase(unittest.TestCase):
    def setUp(self):
        keeper = tempfile.TemporaryDirectory()
        self.addCleanup(keeper.cleanup)
        self.folder = Path(keeper.name)
        self.build()

    def build(self):
        """Fills the folder with a result."""

    def plot(self, *options):
        """In this process, which spares an interpreter a test; test_as_a_program runs the real thing."""
        out, err = io.StringIO(), io.StringIO()
        with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
            code = rodwake_plot.main([str(self.folder), *options])
        return subprocess.CompletedProcess([], code, out.getvalue(), err.getvalue())

    def assert_drawn(self, *names):
        done = self.plot()
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        self.assertEqual(sorted(path.name for path in (self.folder / "figures").iterdir()), sorted(f"{n}.png" for n in names))
        for name in names:
            self.assert_picture(matplotlib.image.imread(self.folder / "figures" / f"{name}.png"))

    def assert_picture(self, pixels):
        height, width = pixels.shape[:2]
        self.assertTrue(500 < width < 1700 and 250 < height < 2200, (width, height))
        self.assertGreater(pixels[..., :3].var(), 0.005)

    def assert_fails(self, *words):
        done = self.plot()
        self.assertEqual(done.returncode, 1, done.stdout)
        self.assertEqual(done.stderr.count("\n"), 1, done.stderr)
        self.assertNotIn("Traceback", done.stderr)
        self.assertNotIn("internal error", done.stderr)
        for word in words:
            self.assertIn(word, done.stderr)
