"""Tests of the figure of heading diffusion, on made-up results: /usr/bin/python3 tests/plots/test_heading_diffusion.py"""

import unittest

import numpy as np

from made_up_granular import SCENE
from made_up_measured import D_R, JITTER, write_measured
from plot_case import PlotCase
from rodwake_plots import bead_motion, bed_run, draw, run_dir

FIGURE = '[[figures]]\nname = "fig"\nkind = "heading_diffusion"\n'


class HeadingDiffusionTest(PlotCase):
    def setUp(self):
        super().setUp()
        write_measured(self.folder, rods=1)
        (self.folder / "scene.toml").write_text(SCENE + FIGURE)

    def draw(self):
        with run_dir.RunDir(self.folder) as run:
            spec = draw.figures_of(run)[0]
            return draw.KINDS["heading_diffusion"].draw(run, spec), draw.caption(run, spec)

    def test_points_and_the_fits_over_their_window(self):
        drawn, caption = self.draw()
        part = bed_run.Part("", "", self.folder)
        for axes, column, fit in ((drawn.axes[0], "square", lambda t: 2 * JITTER**2 + 2 * D_R * t),
                                  (drawn.axes[1], "cosine", lambda t: np.exp(-JITTER**2 - D_R * t))):
            marks = next(line for line in axes.lines if line.get_marker() == "o")
            np.testing.assert_array_equal(marks.get_xydata(), np.column_stack(part.table("heading.csv", "lag", column)))
            solid = next(line for line in axes.lines if line.get_linestyle() == "-" and line.get_marker() == "None" and len(line.get_xdata()) == 50)
            self.assertEqual((solid.get_xdata()[0], solid.get_xdata()[-1]), (0.125, 1.25))
            np.testing.assert_allclose(solid.get_ydata(), fit(solid.get_xdata()), rtol=2e-3)  # the points' own intercept: they scatter
        self.assertIn("0.0400 ± 0.0010 rad²/s", caption)
        self.assertIn("in the theory's units 0.0176 ± 0.0020", caption)

    def test_a_steady_turn_has_its_line_where_it_is_fitted(self):
        """(turn tau)^2 bends the points, and the line through them starts below 0."""
        part = bed_run.Part("", "", self.folder)
        table = bead_motion.read_heading(part)
        table["square"] = 0.3 * table["lag"] ** 2
        self.assertLess(bead_motion.at_zero(part, table, 0.2), -0.01)

    def test_headings_that_never_change_cannot_be_drawn(self):
        lines = (self.folder / "heading.csv").read_text().splitlines()
        head = next(i for i, line in enumerate(lines) if line.startswith("lag"))
        (self.folder / "heading.csv").write_text("\n".join([*lines[:head + 1], "0.1,0,0,1,0,10"]) + "\n")
        self.assert_fails('figure "fig"', "heading.csv", "the rod never turns")


if __name__ == "__main__":
    unittest.main()
