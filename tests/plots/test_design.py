"""Tests of the figure of designs, on made-up results: /usr/bin/python3 tests/plots/test_design.py"""

import unittest

import plot_case  # noqa: F401, first: puts the plots on the path
from rodwake_plots import design
from rodwake_plots.errors import PlotError


def made_up(information, runs=1):
    return {"settings": {"rods.1.position.1": "-1.5"}, "runs": runs, "information": information, "information_stderr": 0.1, "right": 0.8, "log_bayes": {}}


class DesignTest(unittest.TestCase):
    def test_the_best_come_first_and_those_without_result_are_left_out(self):
        figure = design.draw({"models": ["a", "b"], "designs": [made_up(0.2), made_up(0.9, 5), made_up(None)]})
        axes = figure.axes[0]
        self.assertEqual([label.get_text() for label in axes.get_yticklabels()], ["1.position.1 = -1.5, 5 runs", "1.position.1 = -1.5, 1 run"])
        self.assertEqual(list(axes.lines[0].get_xdata()), [0.9, 0.2])
        self.assertIn("bits of 1", axes.get_xlabel())

    def test_without_any_result(self):
        with self.assertRaisesRegex(PlotError, "no design has a result"):
            design.draw({"models": ["a", "b"], "designs": [made_up(None)]})


if __name__ == "__main__":
    unittest.main()
