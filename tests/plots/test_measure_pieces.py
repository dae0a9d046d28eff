"""Tests of the pieces that figures of measured runs are made of: /usr/bin/python3 tests/plots/test_measure_pieces.py"""

import unittest

import numpy as np

from made_up_granular import A, rod_spheres, write_granular
from plot_case import PlotCase
from rodwake_plots import displacement, files, flow, series, words
from rodwake_plots.errors import PlotError

GRANULAR = ("snapshot", "rod_tracks", "side_view", "granular_table")
EPS = np.finfo(float).eps


class PiecesTest(unittest.TestCase):
    def test_line_with_unequal_errors(self):
        """Against the textbook sums."""
        x, y, sigma = np.array([1.0, 2.0, 4.0, 7.0]), np.array([2.1, 2.9, 5.2, 7.8]), np.array([0.1, 0.3, 0.2, 0.5])
        w = sigma ** -2
        S, Sx, Sy, Sxx, Sxy = w.sum(), (w * x).sum(), (w * y).sum(), (w * x * x).sum(), (w * x * y).sum()
        D = S * Sxx - Sx ** 2
        line = series.fit_line(x, y, sigma)
        np.testing.assert_allclose(line.values, [(Sxx * Sy - Sx * Sxy) / D, (S * Sxy - Sx * Sy) / D], rtol=1e-12)
        np.testing.assert_allclose(line.errors, np.sqrt([Sxx / D, S / D]), rtol=1e-12)
        np.testing.assert_allclose(line.sigma(0.0), line.errors[:1], rtol=1e-12)
        through = series.fit_line(x, y, sigma, proportional=True)
        np.testing.assert_allclose([through.values[0], through.errors[0]], [Sxy / Sxx, Sxx ** -0.5], rtol=1e-12)
        self.assertEqual((line.dof, through.dof), (2, 3))
        self.assertGreater(through.chi2, line.chi2)

    def test_rod_is_that_of_the_simulation(self):
        """Radii to rounding; the ends are those that the simulator stores: nm, which its 1200 points of the solid reach."""
        _, radius = rod_spheres()
        np.testing.assert_allclose(displacement.sphere_row({})[1], radius, rtol=4 * EPS)
        run = type("Run", (), {"scene": {}, "has_tracks": False, "granular": type("Bed", (), {"a": A})})
        x, half = displacement.rod_outline(run)
        self.assertAlmostEqual(x[-1] - x[0], 11.25, delta=20 * EPS)
        self.assertAlmostEqual(2 * half.max(), 2.75, delta=1e-3)  # a fine grid may miss the top
        self.assertAlmostEqual(x[0] * A, -2.015811e-3, delta=5e-9)
        self.assertAlmostEqual(x[-1] * A, 2.484189e-3, delta=5e-9)
        apolar = {"has_tracks": False, "scene": {"granular": {"rods": [{"kind": "apolar"}]}}, "granular": run.granular}
        x, half = displacement.rod_outline(type("Run", (), apolar))
        np.testing.assert_allclose(half, half[::-1], atol=1e-6)
        self.assertAlmostEqual(x[0], -x[-1], delta=1e-9)  # the centre of mass is a sum over 1200 points
        np.testing.assert_allclose(displacement.taper({"taper": "stepwise", "segments": 4}, np.linspace(0, 1, 12), False),
                                   np.repeat([0, 1 / 3, 2 / 3, 1], 3), rtol=4 * EPS)

    def test_numbers_with_errors(self):
        for text, wanted in ((words.with_error(0.87354, 0.00412), "0.8735 ± 0.0041"), (words.with_error(-3.1, 0.62), "−3.10 ± 0.62"),
                             (words.with_error(2.1e-6, 4e-8), "(2.100 ± 0.040) × 10<sup>−6</sup>"),
                             (words.with_error(2.1e-6, 4e-8, 1e6), "2.100 ± 0.040"),
                             (words.with_error(12.5, None), "12.5"), (words.with_error(0, 0), "0.000 ± 0.000"),
                             (words.with_error(310.0, 12.0), "310 ± 12")):
            self.assertEqual(text, wanted)

    def test_coarse_flow_is_the_mean_of_what_was_seen(self):
        v, weight = np.arange(16.0).reshape(4, 4) + 0j, np.ones((4, 4))
        weight[0, 0], v[0, 0] = 0, np.nan
        weight[2:, 2:] = 0
        x, y, mean, spread = flow.coarse(np.arange(4.0), np.arange(4.0), v, np.ones((4, 4)), weight, 2)
        self.assertEqual((list(x), list(y), mean[1, 0]), ([0.5, 2.5], [0.5, 2.5], 10.5))
        self.assertAlmostEqual(mean[0, 0], (1 + 4 + 5) / 3, delta=10 * EPS)
        self.assertTrue(np.isnan(mean[1, 1]))
        np.testing.assert_allclose(spread[:, 0], [1 / 3, 1 / 4])

    def test_labels_as_html(self):
        self.assertEqual(words.label_html(r"$\phi_b = 0.8,\,v = 1\,a/\mathrm{s}$"), "φ<sub>b</sub> = 0.8,\u2009v = 1\u2009a/s")


class CsvTest(PlotCase):
    def test_comments_and_gaps(self):
        path = self.folder / "a.csv"
        path.write_text("# lengths in a\nname,x,y\n# more\n\"a, b\",1,\nc,,2.5\n")
        found = files.read_csv(path, text=("name",))
        self.assertEqual(found["name"], ["a, b", "c"])
        np.testing.assert_array_equal([found["x"], found["y"]], [[1, np.nan], [np.nan, 2.5]])
        with self.assertRaisesRegex(PlotError, "a.csv: not a table of numbers"):
            files.read_csv(path)
        path.write_text("# comment\nx,y\n1,2\n# comment\n3,4\n")
        np.testing.assert_array_equal(files.read_csv(path)["y"], [2, 4])

    def test_runs_without_measures_are_drawn_as_before(self):
        write_granular(self.folder, frames=3, columns=14, rows=16)
        self.assert_drawn(*GRANULAR)
        self.assertNotIn("<h2>Measures</h2>", (self.folder / "report.html").read_text())


if __name__ == "__main__":
    unittest.main()
