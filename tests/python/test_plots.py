"""Figures of runs as matplotlib figures."""

import io
import unittest

import rodwake
from matplotlib.figure import Figure
from program import SCENES, new_folder


class PlotsTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        keeper = cls()
        cls.addClassCleanup(keeper.doCleanups)
        cls.run_of_pair = rodwake.Scene.load(SCENES / "pair.toml").run(new_folder(keeper) / "run")

    def runTest(self):
        """Of the keeper."""

    def test_the_figures_of_the_scene(self):
        made = rodwake.plots.figures(self.run_of_pair)
        self.assertEqual(list(made), ["trajectories", "strain", "wake"])
        png = io.BytesIO()
        made["wake"].savefig(png, dpi=50)
        self.assertTrue(png.getvalue().startswith(b"\x89PNG"))
        self.assertIsInstance(made["wake"], Figure)

    def test_one_figure_with_options(self):
        made = rodwake.plots.draw(self.run_of_pair.folder, "cut", component="Uy", title="Beside the rod", x=[-5.0, 5.0])
        self.assertEqual(made.axes[0].get_xlim(), (-5.0, 5.0))
        self.assertIn("Beside the rod", made.axes[0].get_title() + str(made._suptitle))

    def test_what_cannot_be_drawn_is_reported(self):
        for ask, word in ((lambda: rodwake.plots.draw(self.run_of_pair, "snapshot"), "no beads"), (lambda: rodwake.plots.draw(self.run_of_pair, "cat"), "cat"),
                          (lambda: rodwake.plots.draw(self.run_of_pair, "movie"), "film|file"),
                          (lambda: rodwake.plots.draw(self.run_of_pair, "cut", compnent="Uy"), "unknown option 'compnent'"),
                          (lambda: rodwake.plots.draw(new_folder(self), "cut"), "no run")):
            with self.assertRaisesRegex(rodwake.InputError, word):
                ask()
        self.assertNotIn("movie", rodwake.plots.kinds())
        self.assertIn("phase_diagram", rodwake.plots.kinds())
        with self.assertRaises(AttributeError):
            rodwake.no_such_thing


if __name__ == "__main__":
    unittest.main()
