"""Tests of the figure of a rod's large deviations, on made-up results: /usr/bin/python3 tests/plots/test_speed_deviations.py"""

import unittest

import numpy as np

from made_up_granular import SCENE
from made_up_measured import RATE, variants, write_measured
from plot_case import PlotCase
from rodwake_plots import draw, run_dir

FIGURE = '[[figures]]\nname = "fig"\nkind = "speed_deviations"\n'


class SpeedDeviationsTest(PlotCase):
    def draw(self, names=()):
        (self.folder / "scene.toml").write_text(SCENE + variants(names) + FIGURE)
        with run_dir.RunDir(self.folder) as run:
            return draw.KINDS["speed_deviations"].draw(run, draw.figures_of(run)[0]), draw.caption(run, draw.figures_of(run)[0])

    def test_both_sides_of_F_and_the_line_through_0_at_each_lag(self):
        write_measured(self.folder, rods=1)
        drawn, caption = self.draw()
        F, A = drawn.axes
        lines = [line for line in A.lines if len(line.get_xdata()) == 2]
        self.assertEqual(len(lines), 3)
        for line in lines:
            np.testing.assert_allclose(line.get_ydata(), -RATE * line.get_xdata())
            self.assertEqual(line.get_xdata()[0], 0.0)
        marks = [line.get_xydata() for line in F.lines if line.get_marker() == "o"]
        self.assertEqual(len(marks), 6)
        self.assertTrue(all((side[:, 0] > 0).all() or (side[:, 0] < 0).all() for side in marks))
        width = np.sqrt(2 / (RATE * 0.32)) / 3
        np.testing.assert_allclose(marks[4][0], [width / 2, RATE / 4 * (width / 2 - 1)**2 - np.log(RATE * 0.32 / (4 * np.pi)) / 0.64], rtol=1e-12)
        self.assertIn("at 0.16 s slope −20.00 ± 0.40 1/s (a Gaussian of that variance −20), kink at 0 0.30 ± 0.50 1/s", caption)

    def emptied(self, *columns):
        """The table of the run without its values in these columns."""
        path = self.folder / "deviations.csv"
        head, *rows = path.read_text().splitlines()
        names = head.split(",")
        kept = [",".join("" if name in columns else value for name, value in zip(names, row.split(","))) for row in rows]
        path.write_text("\n".join([head, *kept]) + "\n")

    def test_a_panel_without_data_says_why(self):
        write_measured(self.folder, rods=1)
        self.assertEqual(self.notes(), ["", ""])
        self.emptied("A", "A_error")
        self.assertEqual(self.notes(), ["", "too few displacements backwards"])
        self.emptied("F_plus", "F_minus")
        self.assertEqual(self.notes(), ["too few displacements: run for longer", "too few displacements backwards"])

    def notes(self):
        return ["".join(text.get_text() for text in axes.texts if text.get_text().startswith("too few")) for axes in self.draw()[0].axes]

    def test_of_several_cases_the_lag_that_is_told(self):
        write_measured(self.folder, phis=(0.8, 0.7), rods=1)
        drawn, _ = self.draw(("v1",))
        self.assertEqual(len([line for line in drawn.axes[1].lines if len(line.get_xdata()) == 2]), 2)


if __name__ == "__main__":
    unittest.main()
