"""Tests of the figures of scans, on made-up folders: /usr/bin/python3 tests/plots/test_scan.py"""

import re
import unittest

import numpy as np
from matplotlib.collections import LineCollection

import made_up_scan as made_up
from made_up_scan import GAMMA, KAPPA, METHOD, PLACE
from scan_case import ScanCase, figure, texts  # first: puts the plots on the path
from rodwake_plots import phase_diagram, run_dir, scan_columns, style

# (kappa, x_1) well inside each region of made_up_scan.
INSIDE = {"contact": (10, 0), "pursuit": (20, 3), "escape": (1, -4), "undecided": (22.4, 4.72)}


def lines_of(axes):
    """Places of all line collections, one list of segments each."""
    return [one.get_segments() for one in axes.collections if isinstance(one, LineCollection)]


class AdaptiveTest(ScanCase):
    KEYS = dict(start=16, resolution=256, failing=9)

    def test_defaults(self):
        self.assert_drawn("phase_diagram", "phase_time", "phase_final_separation", "phase_non_reciprocity")

    def test_outcomes_have_their_colours(self):
        made, _ = self.draw()
        for name, place in INSIDE.items():
            self.assert_outcome(made.axes[0], *place, name)

    def test_the_look_at_colours_can_fail(self):
        made, _ = self.draw()
        for wrong in ("pursuit", "escape", "undecided"):
            with self.assertRaises(AssertionError):
                self.assert_outcome(made.axes[0], *INSIDE["contact"], wrong)

    def test_legend(self):
        made, _ = self.draw()
        legend = made.axes[0].get_legend()
        self.assertEqual(legend.get_title().get_text(), "capture = contact, bound, orbit or pursuit")
        self.assertEqual(texts(legend), ["contact", "pursuit", "escape", "undecided", "traced boundary", "failed (9)"])

    def test_failed_points_are_crosses(self):
        made, _ = self.draw()
        cross, = [line for line in made.axes[0].lines if line.get_marker() == "x"]
        with run_dir.RunDir(self.folder) as run:
            scan = run.scan
            np.testing.assert_array_equal(cross.get_xydata(), np.stack([scan.place(axis)[scan.failed] for axis in (0, 1)], axis=-1))

    def test_boundary(self):
        made, caption = self.draw()
        (segments,) = lines_of(made.axes[0])
        with run_dir.RunDir(self.folder) as run:
            wanted = [curve.places for curve in run.scan.boundary]
        self.assertEqual(len(segments), len(wanted))
        for found, curve in zip(segments, wanted):
            np.testing.assert_array_equal(found, curve)
        self.assertIn("traced by bisection, good to 0.0001 of an axis", caption)
        made, caption = self.draw(boundary=False)
        self.assertEqual(lines_of(made.axes[0]), [])
        self.assertNotIn("traced", caption)
        (self.folder / "boundary.csv").unlink()
        made, caption = self.draw()
        self.assertNotIn("traced boundary", texts(made.axes[0].get_legend()))

    def test_boundary_lies_between_the_colours(self):
        """A finest cell to either side of the lowest curve there is contact above and escape below."""
        made, _ = self.draw(boundary=False)
        cell = 12 / 256
        for kappa in (0.3, 3.0, 30.0):
            edge = made_up.edges(np.log10(kappa))[0][1]
            self.assert_outcome(made.axes[0], kappa, edge + 2 * cell, "contact")
            self.assert_outcome(made.axes[0], kappa, edge - 2 * cell, "escape")

    def test_cells_on_demand(self):
        made, caption = self.draw(cells=True, boundary=False)
        (segments,) = lines_of(made.axes[0])
        self.assertEqual(len(segments), 2 * (len((self.folder / "cells.csv").read_text().splitlines()) - 1))
        self.assertIn("cells of the refinement", caption)
        ends = np.array(segments)
        self.assertTrue((ends[..., 0] >= 0.1 * (1 - 1e-9)).all() and (ends[..., 0] <= 100 * (1 + 1e-9)).all())

    def test_open_cells_are_hatched(self):
        def hatched(area, word="verified"):
            self.retell(certificates={word: 10, "checked": 20, "open": 0}, certified_area=area)
            made, caption = self.draw()
            self.assertIn("verified 10, checked 20", caption)
            cells = [len(one.get_paths()) for one in made.axes[0].collections if one.get_hatch()]
            self.assertEqual("Hatched: cells that are not known" in caption, bool(cells))
            return cells
        wanted = (self.folder / "cells.csv").read_text().count(",open\n")
        self.assertEqual(hatched({"verified": 0.25, "checked": 0.7, "open": 0.05}), [wanted])
        self.assertEqual(hatched({"proved": 0.25, "checked": 0.7, "open": 0.05}, "proved"), [wanted])  # as version 0.3 wrote it
        self.assertEqual(hatched({"verified": 0.0, "checked": 0.0, "open": 1.0}), [])  # they were not asked for

    def test_window(self):
        made, _ = self.draw(x=[1.0, 30.0], y=[-2.0, 4.0])
        self.assertEqual((made.axes[0].get_xlim(), made.axes[0].get_ylim()), ((1, 30), (-2, 4)))
        self.assert_outcome(made.axes[0], *INSIDE["contact"], "contact")
        self.assert_outcome(made.axes[0], *INSIDE["pursuit"], "pursuit")
        self.ask(figure(x=[-1.0, 30.0]))
        self.assert_fails("logarithmic", "coupling.kappa")

    def test_axes(self):
        made, _ = self.draw()
        axes = made.axes[0]
        self.assertEqual((axes.get_xscale(), axes.get_yscale()), ("log", "linear"))
        self.assertEqual((axes.get_xlabel(), axes.get_ylabel()), (r"$\kappa\,f/(\mu v_0)$", r"$x_{1}\,\mu/f$"))

    def test_time_to_contact(self):
        made, caption = self.draw(colour="time")
        self.assertEqual(texts(made.axes[0].get_legend()), ["pursuit", "not captured", "traced boundary", "failed (9)"])
        self.assertIn("pursuit is decided at the end of the run", caption)
        made, _ = self.draw(colour="time", boundary=False)
        axes, bar = made.axes[0], made.axes[-1]
        self.assert_colour(axes, *INSIDE["escape"], scan_columns.NOTHING)
        self.assert_colour(axes, *INSIDE["undecided"], scan_columns.NOTHING)
        self.assert_outcome(axes, *INSIDE["pursuit"], "pursuit")  # which has no time of its own
        time = made_up.results_at(10.0, 0.0, 0.0, np.array(0))[0]
        low, high = np.log(bar.get_ylim())  # times from 6 to 30
        self.assertEqual(bar.get_yscale(), "log")
        self.assert_colour(axes, 10, 0, style.FIELD_MAP((np.log(time) - low) / (high - low))[:3])
        self.assertIn("time to contact", bar.get_ylabel())

    def test_asymmetry_diverges_from_zero(self):
        made, caption = self.draw(colour="non_reciprocity")
        self.assertEqual(made.axes[-1].get_ylim(), (-1, 1))
        for kappa in (1.0, 10.0):
            value = np.tanh(0.55 * (2.0 - 1.6 * np.log10(kappa)))
            self.assert_colour(made.axes[0], kappa, 2.0, phase_diagram.scan_columns.BALANCED((value + 1) / 2)[:3])
        self.assertIn("the rear rod alone", caption)

    def test_any_column(self):
        for column in ("min_separation", "final_angle", "turn1", "steps"):
            self.draw(colour=column)
        self.ask(figure(colour="speed"))
        self.assert_fails("scan.csv: column speed is missing")
        self.ask(figure(colour="status"))
        self.assert_fails("column status holds words, not numbers")

    def test_caption(self):
        _, caption = self.draw()
        caption = re.sub("<[^>]*>", "", caption)
        total = f"{len(self.points):,}".replace(",", "\u2009")
        for part in ("capture is contact, bound, orbit or pursuit", f"{total} points by adaptive refinement to 256 cells a side",
                     "contact ", "undecided ", "9 points failed: the state is no longer finite (9).",
                     "Missed rate: 0.2 % of the area outside the boundary (3 of 1\u2009500 random points; with 95 % confidence below 0.58 %)",
                     "Fixed: η = 1, α = 1, γ1 = 0 v0, γ2 = 0 v0.", "rod 1 from (x1, −5), heading 1.571"):
            self.assertIn(part, caption)
        self.assertNotIn("κ = ", caption)  # it is an axis

    def test_title(self):
        made, _ = self.draw()
        self.assertEqual(made.axes[0].get_title(), r"$\eta = 1$,  $\alpha = 1$,  $\gamma_1/v_0 = 0$,  $\gamma_2/v_0 = 0$")
        made, _ = self.draw(title="Mine")
        self.assertEqual(made.axes[0].get_title(), "Mine")

    def test_unfinished(self):
        self.retell(left=1200)
        self.assertIn("1\u2009200 points are not evaluated yet", self.draw()[1])

    def test_without_checks(self):
        self.retell(missed_rate=None, missed_rate_high=None, audited=0)
        self.assertNotIn("Missed", self.draw()[1])


class CriticalTest(ScanCase):
    KEYS = dict(design="grid", count=9)

    def test_curves_lie_over_the_coarse_pass(self):
        """Two curves of critical values; the table need not be in the order of the axis."""
        self.build(axes=[KAPPA, PLACE])
        rows = [(10, 1.5, 0), (1, 1.0, 0), (10, -2.0, 1), (30, -3.0, 1)]
        made_up.write_table(self.folder / "critical.csv", [KAPPA["key"], "value", "low", "high", "kind", "below", "above", "branch"],
                            [*np.array([(kappa, value, value - 0.1, value + 0.1) for kappa, value, _ in rows], dtype=float).T, ["grazing"] * 4,
                             ["escape"] * 4, ["contact"] * 4, np.array([branch for *_, branch in rows], dtype=float)])
        made, caption = self.draw()
        for found, wanted in zip(lines_of(made.axes[0])[0], ([(1, 1.0), (10, 1.5)], [(10, -2.0), (30, -3.0)]), strict=True):
            np.testing.assert_array_equal(found, wanted)
        self.assertIn("critical values", texts(made.axes[0].get_legend()))
        self.assertIn("Lines: critical values.", caption)


class OtherDesignsTest(ScanCase):
    def test_grid(self):
        self.build(design="grid", count=41, failing=3)
        self.assert_drawn("phase_diagram", "phase_time", "phase_final_separation", "phase_non_reciprocity")
        made, caption = self.draw()
        for name in ("contact", "pursuit", "escape"):
            self.assert_outcome(made.axes[0], *INSIDE[name], name)
        self.assertIn("a grid", caption)
        low, high = made.axes[0].get_ylim()
        np.testing.assert_allclose((low, high), (-6.15, 6.15), rtol=1e-12)  # half a cell of 0.3 around the outermost points

    def test_a_cell_has_the_colour_of_its_point(self):
        """Without interpolation: all over it."""
        self.build(design="grid", count=9)
        made, _ = self.draw()
        u, x = np.linspace(-1, 2, 9)[5], np.linspace(-6, 6, 9)[4]
        name = made_up.OUTCOMES[made_up.outcome_at(10 ** u, x)]
        for du in (-0.17, 0.17):
            for dx in (-0.7, 0.7):
                self.assert_outcome(made.axes[0], 10 ** (u + du), x + dx, name)

    def test_scattered_points(self):
        for design, expected in (("lhs", "Latin hypercube"), ("sobol", "Sobol"), ("list", "a list of points")):
            self.build(design=design, count=400, failing=2)
            made, caption = self.draw()
            self.assertIn(expected, caption)
            offsets = made.axes[0].collections[0].get_offsets()
            self.assertEqual(len(offsets), 398)
            colours = made.axes[0].collections[0].get_facecolors()
            index = np.abs(self.points - offsets[7]).sum(axis=1).argmin()
            wanted = scan_columns.rgba(scan_columns.COLOURS[made_up.OUTCOMES[self.codes[index]]])
            self.assertLess(np.abs(colours[7] * 255 - wanted).max(), 1)

    def test_three_axes_are_slices(self):
        self.build(design="grid", axes=(KAPPA, PLACE, GAMMA), count=21)
        self.assert_drawn("phase_diagram")
        made, caption = self.draw()
        self.assertEqual([axes.get_title() for axes in made.axes[:4]],
                         [rf"$\gamma_1 = {value}\ v_0$" for value in ("0", "3.5", "6.5", "10")])
        tongue = 0.3 + 0.55 * 1.5 ** 1.25  # half its width at kappa = 10**0.5 without gamma_1
        place = 10 ** 0.5, float(np.round((made_up.middle(0.5) + tongue - 0.45) / 0.6) * 0.6)
        for axes, gamma in zip(made.axes, (0, 3.5, 6.5, 10)):
            self.assert_outcome(axes, *place, made_up.OUTCOMES[made_up.outcome_at(*place, gamma)])
        self.assertIn("sets <code>coupling.gamma1</code>, <code>coupling.gamma2</code> (times −1)", caption)
        self.assertNotIn("γ</i><sub>2</sub> = 0", caption)  # tied to the axis
        made, caption = self.draw(slices=[2.2])
        self.assertTrue(made.axes[0].get_title().startswith(r"$\gamma_1 = 2\ v_0$,"))  # the nearest that the grid has

    def test_three_axes_refined(self):
        self.build(axes=(KAPPA, PLACE, GAMMA), start=8, resolution=32)
        made, _ = self.draw(slices=[1.3, 8.0], cells=True)
        for axes, gamma in zip(made.axes, (1.3, 8.0)):
            self.assert_outcome(axes, 40.0, 0.9, "contact")
            self.assert_outcome(axes, 1.0, -4.0, "escape")
        self.assertEqual(made.axes[1].get_title(), r"$\gamma_1 = 8\ v_0$")

    def test_three_axes_scattered(self):
        self.build(design="lhs", axes=(KAPPA, PLACE, GAMMA), count=800)
        made, caption = self.draw()
        self.assertEqual(sum(len(axes.collections[0].get_offsets()) for axes in made.axes[:4]), 800)
        self.assertIn("points within 12 % of that axis", caption)

    def test_one_axis(self):
        self.build(design="grid", axes=(PLACE,), count=121, failing=2)
        self.assert_drawn("phase_diagram")
        made, _ = self.draw()
        upper, strip = made.axes
        for place, name in ((0.0, "contact"), (-4.0, "escape")):
            self.assert_outcome(strip, place, 0.5, name)
        self.assertIn("final separation", upper.get_ylabel())
        self.assertEqual(upper.get_yscale(), "log")
        self.assert_joins_like_outcomes(upper.lines[0])
        made, _ = self.draw("scan_curve", column="final_separation")
        self.assert_joins_like_outcomes(made.axes[0].lines[0])
        made, _ = self.draw(colour="non_reciprocity")
        self.assertEqual(made.axes[0].get_ylabel(), "turning asymmetry")

    def assert_joins_like_outcomes(self, line):
        """No piece of the line goes from a point to one that ended otherwise."""
        with run_dir.RunDir(self.folder) as run:
            ended = dict(zip(run.scan.place(0), run.scan.outcome))
        x, y = line.get_data()
        joined = [(ended[x[i]], ended[x[i + 1]]) for i in range(len(x) - 1) if np.isfinite([x[i:i + 2], y[i:i + 2]]).all()]
        self.assertTrue(joined and all(one == other for one, other in joined))
        self.assertGreater(len({one for one, _ in joined}), 1)

    def test_one_refined_axis(self):
        self.build(axes=(KAPPA,), start=16, resolution=256)
        made, _ = self.draw()
        self.assert_outcome(made.axes[1], 30.0, 0.5, "contact")
        np.testing.assert_allclose(made.axes[1].get_xlim(), (0.1, 100), rtol=1e-12)

    def test_choices(self):
        self.build(design="grid", axes=(PLACE, METHOD), count=41)
        made, caption = self.draw()
        self.assertEqual([text.get_text() for text in made.axes[0].get_yticklabels()], METHOD["values"])
        for row in (0.3, 1.3, 1.7):
            self.assert_outcome(made.axes[0], 0.0, row, "contact")
        self.build(design="grid", axes=(KAPPA, PLACE, METHOD), count=9)
        made, caption = self.draw()
        self.assertEqual([axes.get_title() for axes in made.axes[:3]], ["method: bdf", "method: adams", "method: erk"])
        self.assertIn("Panels: method: bdf, method: adams, method: erk.", caption)

    def test_a_scan_of_alpha_does_not_call_xi_fixed(self):
        axis = KAPPA | {"key": "medium.alpha", "keys": ["medium.alpha"], "symbol": "\\alpha", "unit": ""}
        self.build(design="grid", axes=(axis, PLACE), count=5)
        _, caption = self.draw()
        self.assertNotIn("ξ", caption)
        self.assertIn("κ", caption)

    def test_a_negative_logarithmic_axis(self):
        axis = KAPPA | {"from": -100.0, "to": -0.1}
        self.build(design="grid", axes=(PLACE,), count=5)
        rows = [(value, x) for value in (-100.0, -10.0, -1.0, -0.1) for x in (-1.0, 1.0)]
        found = [f"{value!r},{x!r},{'contact' if value < -3 else 'escape'},1.0,ok" for value, x in rows]
        (self.folder / "scan.csv").write_text("coupling.kappa,rods.1.position.0,outcome,time,status\n" + "\n".join(found) + "\n")
        self.retell(axes=[axis, PLACE])
        (self.folder / "scan.h5").unlink()
        self.assert_drawn("phase_diagram", "phase_time")
        made, _ = self.draw()
        for value, _x in rows:
            self.assert_outcome(made.axes[0], value, 0.5, "contact" if value < -3 else "escape")
        self.assertIn("−100", [text.get_text() for text in made.axes[0].get_xticklabels()])

    def test_units_of_si(self):
        self.build(design="grid", axes=(KAPPA, PLACE | {"unit": "m", "from": -0.006, "to": 0.006}), count=7)
        self.rewrite("scene.toml", lambda text: text.replace('"reduced"', '"si"'))
        made, _ = self.draw()
        self.assertEqual(made.axes[0].get_ylabel(), r"$x_{1}$ ($\mathrm{mm}$)")
        np.testing.assert_allclose(made.axes[0].get_ylim(), (-7, 7), rtol=1e-12)
        made, _ = self.draw(colour="final_separation")
        self.assertIn(r"\mathrm{m}", made.axes[-1].get_ylabel())


class CurveTest(ScanCase):
    def build(self, **keys):
        self.points = made_up.write_bed_scan(self.folder, **keys)

    def test_defaults(self):
        self.assert_drawn("phase_diagram", "phase_delta_y", "scan_delta_y")

    def test_points_and_bars(self):
        made, caption = self.draw("scan_curve", column="delta_y")
        axes = made.axes[0]
        columns = np.genfromtxt(self.folder / "scan.csv", delimiter=",", names=True)
        first = columns["granularrods0position1"] == 0.0024
        bars = axes.containers[0]
        np.testing.assert_allclose(bars[0].get_ydata(), columns["delta_y"][first], rtol=1e-15)
        heights = np.array([np.ptp(segment[:, 1]) / 2 for segment in bars[2][0].get_segments()])
        np.testing.assert_allclose(heights, columns["delta_y_error"][first], rtol=1e-12)
        self.assertEqual(texts(axes.get_legend()), [r"$y_{0} = 2.4\ \mathrm{mm}$", r"$y_{0} = 3.6\ \mathrm{mm}$",
                                                     r"$y_{0} = 4.8\ \mathrm{mm}$", "failed (1)"])
        for part in ("bars: standard error", "1 point failed: overlap (1)", "moved a little apart"):
            self.assertIn(part, caption)
        self.assertEqual(axes.get_ylabel(), r"change of separation $\Delta y$ ($a$)")

    def test_one_axis(self):
        self.build(axes=(made_up.PHI,))
        self.assert_drawn("phase_diagram", "scan_delta_y")
        made, caption = self.draw("scan_curve")
        self.assertEqual(len(made.axes[0].containers), 2)  # the curve and the failed point
        self.assertNotIn("apart", caption)

    def test_other_columns(self):
        for column in ("psi6", "contact", "T_xy"):
            made, _ = self.draw("scan_curve", column=column)
            self.assertEqual(len(made.axes[0].containers), 4)
        self.ask(figure("scan_curve", column="speed"))
        self.assert_fails("column speed is missing")

    def test_many_curves_are_thinned(self):
        made_up.write_scan(self.folder, design="grid", count=15)
        _, caption = self.draw("scan_curve")
        self.assertIn("9 of 15 curves are shown", caption)

    def test_scattered_points_are_one_cloud(self):
        made_up.write_scan(self.folder, design="lhs", count=60)
        made, _ = self.draw("scan_curve", column="time")
        self.assertEqual(len(made.axes[0].containers), 1)


if __name__ == "__main__":
    unittest.main()
