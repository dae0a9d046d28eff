"""Tests of what a reader needs to read a figure: /usr/bin/python3 tests/plots/test_looks.py"""

import unittest
from types import SimpleNamespace

import numpy as np

import plot_case  # noqa: F401, first: puts the plots on the path
from rodwake_plots import bed, canvas, field, fit, rod_tracks, style, trajectories, words
from rodwake_plots.run_dir import Run, distinct_label
from rodwake_plots.words import Units

WINDOW = trajectories.Window((0.0, 10.0), (-2.0, 2.0))


def run_of(*ways, **attrs):
    """A run whose rods go along these lines y(x), with x from 0 to 10."""
    x = np.linspace(0, 10, 201)
    y = np.stack([way(x) for way in ways], axis=-1)
    return Run("scene", "", "pursuit", attrs, x, np.repeat(x[:, None], len(ways), axis=1), y, 0 * y)


class PathsTest(unittest.TestCase):
    def hidden(self, *ways):
        return trajectories.lie_on_each_other([run_of(*ways)], WINDOW)

    def test_paths_that_hide_each_other(self):
        self.assertTrue(self.hidden(lambda x: 0 * x, lambda x: 2 * np.exp(-x)))
        self.assertTrue(self.hidden(lambda x: 0 * x, lambda x: 0 * x))

    def test_crossings_and_meetings_do_not(self):
        self.assertFalse(self.hidden(lambda x: 0 * x, lambda x: x / 2 - 2))
        self.assertFalse(self.hidden(lambda x: 2 - x / 5, lambda x: x / 5 - 2))
        self.assertFalse(self.hidden(lambda x: 0 * x))

    def test_a_rod_that_stays_has_no_path(self):
        self.assertEqual(len(trajectories.evenly(np.ones(5), np.ones(5))), 0)
        places = trajectories.evenly(np.array([0.0, 1.0, np.nan]), np.zeros(3), 5)
        np.testing.assert_allclose(places[:, 0], [0, 0.25, 0.5, 0.75, 1], rtol=1e-15)

    def test_hidden_paths_are_moved_to_two_sides(self):
        figure = canvas.figure(4, 3)
        axes = figure.subplots()
        canvas.window(axes, (0, 10), (-2, 2))
        run = run_of(lambda x: 0 * x, lambda x: 0 * x)
        (x0, y0), (x1, y1) = (trajectories.beside(axes, run, rod).transform((5, 0)) for rod in (0, 1))
        self.assertAlmostEqual(x0, x1)
        self.assertAlmostEqual((y0 - y1) * 72 / figure.dpi, trajectories.APART)


class LabelsTest(unittest.TestCase):
    def test_couplings_have_units(self):
        shown = [(name, Units("reduced").parameter(name, 2.0)) for name in ("eta", "kappa", "gamma1")]
        self.assertEqual(shown, [("eta", r"\eta = 2"), ("kappa", r"\kappa\,f/(\mu v_0) = 2"), ("gamma1", r"\gamma_1/v_0 = 2")])
        self.assertEqual(Units("si").parameter("kappa", 2.0), r"\kappa = 2\ \mathrm{s^{-1}}")
        self.assertEqual(Units("si").parameter("gamma2", 0.5), r"\gamma_2 = 0.5\ \mathrm{m/s}")

    def test_labels_of_runs_have_them_too(self):
        runs = [run_of(lambda x: x, kappa=value, eta=1.0) for value in (1.0, 2.0)]
        label = distinct_label(runs[1], runs, Units("reduced"))
        self.assertEqual(label, r"$\kappa\,f/(\mu v_0) = 2$")
        self.assertEqual(words.label_html(label), "κ\u2009f/(μv<sub>0</sub>) = 2")

    def test_a_name_that_begins_with_an_underscore_is_in_the_legend(self):
        made = canvas.figure(4, 3)
        axes = made.subplots()
        x = np.arange(4.0)
        canvas.band(axes, x, x, x, "red", "_one")
        canvas.points(axes, x, x, x, "blue", "_two")
        axes.plot(x, x, label=style.label("_three $"))
        canvas.legend(axes)
        made.draw_without_rendering()
        self.assertEqual([text.get_text() for text in axes.get_legend().get_texts()], ["_one", r"_three \$", "_two"])

    def test_in_a_narrow_figure_the_legend_is_below(self):
        for inches, below in ((3.4, True), (7.0, False)):
            with style.applied(style.SETTINGS):
                made, axes = canvas.curve_panel(8)
                for k in range(8):
                    axes.plot([0, 1], [0, k], label=f"a curve {k}")
                canvas.legend(axes)
                canvas.settle(made, canvas.fit_width(made, inches))
            self.assertEqual([len(made.legends), axes.get_legend() is None], [below, below])
            made.draw_without_rendering()
            panel = axes.get_window_extent().width / made.bbox.width
            self.assertGreater(panel, 0.75 if below else 0.6)
            if below:
                self.assertLess(made.legends[0].get_window_extent().y1, axes.get_window_extent().y0)

    def test_headings_of_a_row_start_on_one_line(self):
        figure = canvas.figure(6, 3)
        one, two = figure.subplots(1, 2)
        canvas.heading(one, "one")
        canvas.heading(two, "two\nlines")
        canvas.align_headings([[one, two]])
        self.assertEqual([axes.get_title().count("\n") for axes in (one, two)], [1, 1])
        figure.canvas.draw()
        tops = [axes.title.get_window_extent().y1 for axes in (one, two)]
        self.assertAlmostEqual(*tops, delta=1.0)  # pixels

    def test_a_rod_alone_is_in_no_bed(self):
        granular = SimpleNamespace(phi_b=0.75, need=lambda key: granular.beads, beads=10)
        self.assertEqual(bed.density(granular), r"$\phi_b = 0.750$")
        granular.beads = 0
        self.assertEqual(bed.density(granular), "no beads")

    def test_rounding_is_no_turn(self):
        tracks = [SimpleNamespace(theta=np.array([[0.1], [0.1 + turn]])) for turn in (1e-16, 1e-15)]
        self.assertTrue(rod_tracks.is_straight(tracks))
        self.assertFalse(rod_tracks.is_straight([*tracks, SimpleNamespace(theta=np.array([[0.0], [1e-3]]))]))


class CutTest(unittest.TestCase):
    def test_words_stand_where_the_curve_is_low(self):
        s = np.linspace(-10, 10, 201)
        for values, corner in ((s, "upper left"), (-s, "upper right"), (np.where(abs(s) < 2, 99.0, -s), "upper right"),
                               (np.full(201, 9.0), "center right")):
            self.assertEqual(field.free_corner(s, values, top=11.0), corner)


class ResidualsTest(unittest.TestCase):
    def test_the_strip_holds_every_fitted_point(self):
        used = np.array([True, True, False])
        self.assertEqual(fit.strip_reach(np.array([1.0, -8.0, 2.0]), used, 3.0), 8.0)
        self.assertEqual(fit.strip_reach(np.array([1.0, -1.0, 5.0]), used, 3.0), 5.0)
        self.assertEqual(fit.strip_reach(np.array([1.0, -1.0, 50.0]), used, 3.0), 6.0)  # an outlier does not flatten the others


if __name__ == "__main__":
    unittest.main()
