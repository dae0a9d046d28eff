"""Tests of the figures of a fit, on made-up results: /usr/bin/python3 tests/plots/test_fit.py"""

import math
import re
import unittest

import numpy as np
from matplotlib.figure import Figure

from fit_case import FitCase, figure
from made_up_fit import FOUR, TWO, correlation, likelihood, parameter
from made_up_granular import write_csv
from made_up_result import write_result
from rodwake_plots import canvas, draw, fit_errors, fit_words, run_dir

ALL = ("fit", "fit_likelihood_eta", "fit_correlation", "fit_starts")
EPS = np.finfo(float).eps


def titles(made):
    return [axes.get_title() for axes in made.axes if axes.get_title()]


def curves_of(axes, colour="#0072b2"):
    return [line for line in axes.lines if line.get_color() == colour]


class ProfilesTest(FitCase):
    def test_every_kind_by_default(self):
        self.assert_drawn(*ALL)

    def test_four_panels_as_in_the_paper(self):
        made, caption = self.draw("fit", residuals=False)
        self.assertEqual(len(made.axes), 4)
        self.assertEqual([title.splitlines()[0] for title in titles(made)],
                         ["(a)  $U_x(x, 0)$", "(b)  $U_x(0, y)$", r"(c)  $U_y(x, 4\,a)$", "(d)  $U_y(0, y)$"])
        self.assertEqual([axes.get_xlabel() for axes in made.axes], ["$x/a$", "$y/a$", "$x/a$", "$y/a$"])
        self.assertEqual([axes.get_ylabel() for axes in made.axes], ["$U_x/a$", "$U_x/a$", "$U_y/a$", "$U_y/a$"])
        columns = {round(axes.get_position().x0, 3) for axes in made.axes}
        self.assertEqual(len(columns), 2)
        plain = re.sub("<[^>]*>", "", caption)
        self.assertIn("Fitted to Ux(x, 0) and Ux(0, y): f/μ = (2.200 ± 0.060) a, η = 1.31 ± 0.15, ξ = (21.6 ± 1.9) a.", plain)

    def test_predictions_are_marked_with_their_deviation(self):
        made, caption = self.draw("fit")
        labels = [title.splitlines()[1:] for title in titles(made)]
        self.assertEqual(labels[:2], [[], []])
        data = self.table("fit_profile_2.csv")
        kept = data["used"] > 0
        off = ((data["value"] - data["model"]) / data["sigma"])
        rms = np.sqrt(np.mean(off[kept] ** 2))
        self.assertEqual(labels[2], [rf"predicted, not fitted: rms ${rms:.2g}\,\sigma$"])
        self.assertEqual(caption.count("was predicted, not fitted"), 2)
        for side, where in (("behind the rod", data["x"] < 0), ("ahead", data["x"] > 0)):
            rms = np.sqrt(np.mean(off[kept & where] ** 2))
            self.assertRegex(re.sub("<[^>]*>", "", caption), rf"{side} (?:within the errors|off by \d+ %) \(rms {rms:.2g} σ\)")

    def test_data_curve_band_and_comparison_are_the_files(self):
        made, caption = self.draw("fit", profiles=[0])
        axes, strip = made.axes
        data, curve = self.table("fit_profile_0.csv"), self.table("fit_curve_0.csv")
        marks = [container.lines[0].get_xydata() for container in axes.containers]
        for found, kept in zip(marks, (data["used"] > 0, data["used"] == 0)):
            np.testing.assert_array_equal(found, np.stack([data["x"][kept], data["value"][kept]], axis=-1))
        faint, bold = (one.get_xydata() for one in curves_of(axes)[:2])  # all but the middle of the core; outside the core
        for drawn, nearest in ((faint, 0.2 * 8.0), (bold, 8.0)):
            kept = np.abs(curve["x"]) >= nearest
            np.testing.assert_array_equal(drawn[np.isfinite(drawn[:, 1])], np.stack([curve["x"], curve["model"]], axis=-1)[kept])
        band = max(axes.collections, key=lambda one: sum(len(path.vertices) for path in one.get_paths()))
        edges = np.concatenate([path.vertices for path in band.get_paths()])
        at = edges[edges[:, 0] == curve["x"][0]][:, 1]
        np.testing.assert_allclose([at.min(), at.max()], curve["model"][0] + np.array([-1, 1]) * curve["band"][0], rtol=4 * EPS)
        np.testing.assert_array_equal(curves_of(axes, "#d55e00")[0].get_ydata()[0], curve["compare_0"][0])
        left = [container.lines[0].get_xydata() for container in strip.containers][0][:, 1]
        kept = data["used"] > 0
        np.testing.assert_allclose(left, ((data["value"] - data["model"]) / data["sigma"])[kept], rtol=4 * EPS)
        self.assertEqual([text.get_text() for text in made.legends[0].get_texts()], ["data", "left out", "fit", "paper"])
        self.assertIn("For comparison, paper", caption)

    def test_no_line_across_the_singular_place(self):
        made, _ = self.draw("fit", profiles=[0, 2])
        through, beside = (curves_of(axes)[0] for axes in made.axes[::2])
        gap = through.get_xdata()[np.isnan(through.get_ydata())]
        self.assertIn(0.0, gap)
        self.assertLess(np.abs(gap).max(), 0.2 * 8.0)  # a fifth of the core
        self.assertTrue(np.isfinite(beside.get_ydata()).all())

    def test_without_a_core_only_the_singular_place_is_left_out(self):
        self.build(core=0.0)
        made, _ = self.draw("fit", profiles=[0])
        through = curves_of(made.axes[0])[0]
        self.assertEqual(through.get_xdata()[np.isnan(through.get_ydata())].tolist(), [0.0])

    def test_predictions_without_a_panel_are_reported_in_the_caption(self):
        _, caption = self.draw("fit", profiles=[0])
        self.assertRegex(re.sub("<[^>]*>", "", caption), r"was predicted, not fitted: behind the rod .*\(rms \S+ σ\), ahead .*\(rms \S+ σ\)")

    def test_the_range_is_that_of_the_data(self):
        """Neither the singularity of the curve nor a comparison that is far off."""
        path = self.folder / "fit_curve_0.csv"
        head, *rows = path.read_text().splitlines()
        for far in ("1e9", "-1e9"):
            path.write_text("\n".join([head, *(row.rsplit(",", 1)[0] + "," + far for row in rows)]) + "\n")
            made, _ = self.draw("fit", profiles=[0])
            data = self.table("fit_profile_0.csv")
            low, high = made.axes[0].get_ylim()
            self.assertLess(high - low, 3 * np.ptp(data["value"]))  # REACH = 2.5 and room above
            self.assertGreater(high, data["value"].max())

    def test_two_panels_windows_and_a_title(self):
        self.build(profiles=TWO, compare=2)
        made, _ = self.draw("fit", residuals=False, x=[-30.0, 10.0], title="A title")
        self.assertEqual(len({round(axes.get_position().y0, 3) for axes in made.axes}), 1)
        self.assertEqual([axes.get_xlim() for axes in made.axes], [(-30.0, 10.0)] * 2)
        self.assertEqual(made.get_suptitle() if hasattr(made, "get_suptitle") else made._suptitle.get_text(), "A title")
        self.assert_drawn("fig")

    def test_one_profile_one_parameter_one_start(self):
        self.build(profiles=FOUR[:1], core=0.0, names=("f_over_mu",), number_of_starts=1, likelihoods=(), compare=0)
        self.assert_drawn("fit")
        made, caption = self.draw("fit")
        self.assertEqual([text.get_text() for text in made.legends[0].get_texts()], ["data", "fit"])
        self.assertNotIn("left out", caption)

    def test_unknown_errors_of_the_data(self):
        self.build(known=0, error_factor=1.7)
        made, caption = self.draw("fit")
        self.assertIn("of unknown error", caption)
        self.assertEqual(made.axes[1].get_ylabel(), r"$(\mathrm{data}-\mathrm{fit})/a$")
        self.assertIn("multiplied by 1.7", self.words_of_page())

    def test_a_parameter_that_the_data_do_not_fix(self):
        known = self.record["parameters"] | {"xi": parameter(21.6, None, unit="a", log=True)}
        for name in ("fit_curve_0.csv", "fit_curve_1.csv", "fit_curve_2.csv", "fit_curve_3.csv"):
            path = self.folder / name
            head, *rows = path.read_text().splitlines()
            path.write_text("\n".join([head, *(re.sub(r"^([^,]*,[^,]*),[^,]*", r"\1,", row) for row in rows)]) + "\n")
        self.rewrite(parameters=known, flat=[{"text": "the data do not fix xi", "singular_value": 0.0, "change": {"xi": 1.0}}])
        _, caption = self.draw("fit")
        self.assertIn("not fixed by the data", caption)
        self.assertNotIn("Shaded", caption)
        page = self.words_of_page()
        self.assertIn("21.6 a, not fixed by the data", page)
        self.assertIn("the data do not fix xi", page)
        self.assertNotRegex(page, r"\b(?:nan|inf|None|null)\b")

    def test_huge_and_small_values(self):
        for factor in (1e-12, 1e12):
            self.build()
            for path in self.folder.glob("fit_*_?.csv"):
                values = self.table(path.name)
                scaled = {name: column * (factor if name in ("value", "sigma", "model", "band", "compare_0") else 1)
                          for name, column in values.items()}
                write_csv(path, scaled)
            known = {name: one | {"value": one["value"] * factor, "stderr": one["stderr"] * factor}
                     for name, one in self.record["parameters"].items()}
            self.rewrite(parameters=known)
            self.assert_drawn(*ALL)
            self.assertIn(f"(2.200 ± 0.060) × 10{'−12' if factor < 1 else '12'}", self.words_of_page())

    def test_wrong_input(self):
        self.fails("4 profiles", "no profile 4", kind="fit", profiles=[4])
        self.fails("profiles", "integers", kind="fit", profiles=[0.5])
        self.fails("residuals", "true, false", kind="fit", residuals=3)
        (self.folder / "fit_curve_1.csv").write_text("x,model,band\n1,2,3\n")
        self.fails("fit_curve_1.csv", "compare_0", kind="fit")
        self.fails("fit_curve_1.csv", "compare_0", kind="fit", profiles=[1])
        (self.folder / "fit_profile_0.csv").write_text("x,value,sigma,model,band,residual,used\n")
        self.fails("fit_profile_0.csv", "no rows", kind="fit", profiles=[0])
        (self.folder / "fit_profile_0.csv").unlink()
        self.fails("fit_profile_0.csv", "no such file", kind="fit")
        self.build(profiles=(), trajectories=1)
        self.fails("no profiles", "fit_trajectories", kind="fit")
        (self.folder / "fit.json").write_text("{")
        self.fails("fit.json", "JSON", kind="fit")
        (self.folder / "fit.json").write_text('{"parameters": {"eta": {"value": "much"}}}')
        self.fails("fit.json", "much", kind="fit")

    def test_a_run_without_a_fit(self):
        (self.folder / "fit.json").unlink()
        write_result(self.folder)
        (self.folder / "outcome.json").write_text('{"outcome": "contact", "time": 4.0, "min_separation": 0.1}')
        self.fails("fit.json", "no such file", kind="fit")


class StartsTest(FitCase):
    def test_in_the_order_of_the_objective_with_failures_left_out(self):
        made, caption = self.draw("fit_starts")
        worse, best = (line.get_xydata() for line in made.axes[0].lines[:2])
        found = sorted(one["objective"] for one in self.record["starts"] if one["objective"] is not None)
        self.assertEqual((len(best), len(worse)), (8, 3))
        self.assertEqual(best[:, 0].tolist(), list(range(1, 9)))
        np.testing.assert_allclose(worse[:, 1], np.array(found[8:]) - found[0], rtol=4 * EPS)
        self.assertEqual(made.axes[0].get_yscale(), "log")
        self.assertIn("1 start failed", caption)
        self.assertEqual([axes.get_yscale() for axes in made.axes[1:4]], ["linear", "log", "log"])
        self.assertEqual([axes.get_ylabel() for axes in made.axes[1:4]], [r"$f/\mu$ ($a$)", r"$\eta$", r"$\xi$ ($a$)"])
        ends = made.axes[3].lines[2].get_ydata()
        np.testing.assert_allclose(ends, 21.6, rtol=1e-6)  # the made-up ends differ by 1e-7 a start

    def test_plain_digits_on_logarithmic_axes_of_few_decades(self):
        axes = Figure().subplots()
        axes.set(yscale="log", ylim=(0.4, 30))
        canvas.plain_ticks(axes.yaxis, 0.4, 30)
        seen = {text.get_text() for at, text in zip(axes.get_yticks(), axes.get_yticklabels()) if 0.4 <= at <= 30}
        self.assertEqual(seen, {"0.5", "1", "2", "5", "10", "20"})

    def test_what_counts_as_the_same(self):
        """Within 1e-4 of the best objective, relative, plus 1e-8."""
        for base in (61.3, 0.0):
            same = 1e-4 * base + 1e-8
            starts = [self.record["starts"][0] | {"objective": base + part * same} for part in (0.0, 0.99, 1.01)]
            self.rewrite(starts=starts)
            with run_dir.RunDir(self.folder) as run:
                self.assertEqual(fit_errors.Ends(run.fit).best.tolist(), [True, True, False])

    def test_nothing_to_compare(self):
        self.rewrite(starts=self.record["starts"][:1])
        self.fails("one start", "fit.starts", kind="fit_starts")
        self.rewrite(starts=[one | {"objective": None} for one in self.record["starts"]])
        self.fails("no start has a finite objective", kind="fit_starts")


class LikelihoodTest(FitCase):
    KEYS = dict(likelihoods=("eta", "xi"))

    def test_rise_threshold_interval_and_curvature(self):
        made, caption = self.draw("fit_likelihood", parameter="xi")
        axes = made.axes[0]
        self.assertEqual(axes.get_xlabel(), r"$\xi$ ($a$)")
        lines = {line.get_label(): line for line in axes.lines}
        np.testing.assert_allclose(lines["others refitted"].get_xydata()[:, 1], np.array(self.record["likelihood"]["xi"]["chi2"]) - 61.3,
                                   atol=100 * EPS)
        x, rise = lines["curvature at the best value"].get_xydata().T
        np.testing.assert_allclose(rise, (np.log(x / 21.6) * 21.6 / 1.9) ** 2, rtol=1e-12)  # searched in the logarithm
        self.assertTrue(any(line.get_ydata()[0] == fit_errors.RISE_95 == line.get_ydata()[-1] for line in axes.lines))
        self.assertIn("17.88 to 26.05 <i>a</i>", caption)

    def test_the_first_one_by_default(self):
        made, _ = self.draw("fit_likelihood")
        self.assertEqual(made.axes[0].get_xlabel(), r"$\eta$")

    def test_errors_from_the_scatter_scale_the_rise(self):
        self.rewrite(error_factor=2.0)
        with run_dir.RunDir(self.folder) as run:
            like = fit_errors.Likelihood(run.fit, "eta")
        np.testing.assert_allclose(like.rise, (np.array(self.record["likelihood"]["eta"]["chi2"]) - 61.3) / 4, atol=100 * EPS)

    def test_unbounded_below(self):
        self.rewrite(likelihood={"eta": likelihood(1.31, 0.15, low=False)})
        made, caption = self.draw("fit_likelihood")
        shaded = made.axes[0].patches[0].get_xy()[:, 0]
        self.assertEqual(shaded.min(), made.axes[0].get_xlim()[0])
        self.assertIn("below 1.661", caption)

    def test_wrong_input(self):
        self.fails("f_over_mu", "eta, xi", "fit.likelihood", kind="fit_likelihood", parameter="f_over_mu")
        self.rewrite(likelihood={})
        self.fails("there is: none", kind="fit_likelihood")
        self.rewrite(likelihood={"eta": {"value": [1.0], "chi2": [2.0]}})
        self.fails("less than two points", kind="fit_likelihood")
        self.rewrite(likelihood={"eta": {"value": "x", "chi2": [2.0]}})
        self.fails("fit.json", "likelihood.eta is not as rodwake writes it", kind="fit_likelihood")


class CorrelationTest(FitCase):
    def test_numbers_and_names(self):
        made, _ = self.draw("fit_correlation")
        self.assertEqual([text.get_text() for text in made.axes[0].texts],
                         ["1", "0.997", "−0.31", "0.997", "1", "0.997", "−0.31", "0.997", "1"])
        self.assertEqual([text.get_text() for text in made.axes[0].get_xticklabels()], [r"$f/\mu$", r"$\eta$", r"$\xi$"])

    def test_what_nearly_is_one_is_not_called_one(self):
        self.assertEqual([fit_errors.correlation_number(value) for value in (1, -1, 0.5, -0.004, 0.996, -0.9996)],
                         ["1", "−1", "0.50", "−0.00", "0.996", "−0.9996"])

    def test_starts_of_tracks_are_named_and_left_out_of_large_matrices(self):
        poses = [f"{name}.0.{rod}" for rod in range(4) for name in ("x", "y", "heading")]
        self.assertEqual([fit_words.symbol(name) for name in poses[1:3]], ["y_{0}^{(0)}", r"\theta_{0}^{(0)}"])
        self.assertEqual(fit_words.meaning("x.2.1"), "x of rod 1 at the start of trajectory 2")
        for names, shown in ((["kappa", *poses], 1), (["kappa", *poses[:11]], 12)):
            made = fit_errors.of_matrix(names, np.eye(len(names)))
            self.assertEqual(len(made.axes[0].get_xticklabels()), shown)

    def test_blank_without_an_error(self):
        self.rewrite(parameters=self.record["parameters"] | {"xi": parameter(21.6, None, unit="a")})
        made, caption = self.draw("fit_correlation")
        self.assertEqual([text.get_text() for text in made.axes[0].texts].count("–"), 5)
        self.assertIn("<i>ξ</i> has no finite error", caption)

    def test_wrong_input(self):
        self.rewrite(correlation=correlation(2))
        self.fails("fit.json", "correlation is not", kind="fit_correlation")
        self.rewrite(correlation=[["a"]])
        self.fails("fit.json", "correlation is not", kind="fit_correlation")
        self.rewrite(free=["eta"], correlation=[[1.0]])
        self.fails("one free parameter", kind="fit_correlation")
        self.rewrite(free=["none"])
        self.fails("none", "parameters", kind="fit_correlation")


class TrajectoriesTest(FitCase):
    KEYS = dict(profiles=(), trajectories=1, names=("kappa", "heading.0.1"), number_of_starts=1, likelihoods=(), derived={}, core=0.0)

    def test_paths_and_residuals(self):
        self.assert_drawn("fit_trajectories", "fit_correlation")
        made, caption = self.draw("fit_trajectories")
        paths, places, headings = made.axes
        values = self.table("fit_trajectory_0.csv")
        np.testing.assert_array_equal(paths.lines[1].get_xydata(), np.stack([values["model_x0"], values["model_y0"]], axis=-1))
        np.testing.assert_allclose(places.lines[1].get_ydata(), values["x0"] - values["model_x0"], atol=10 * EPS)
        np.testing.assert_allclose(headings.lines[2].get_ydata(), values["theta1"] - values["model_theta1"], atol=10 * EPS)
        self.assertIn("0.051", caption)

    def test_a_full_turn_is_no_residual(self):
        path = self.folder / "fit_trajectory_0.csv"
        values = self.table(path.name)
        values["theta0"] += 2 * math.pi
        write_csv(path, values)
        made, _ = self.draw("fit_trajectories")
        np.testing.assert_allclose(made.axes[2].lines[1].get_ydata(), values["theta0"] - 2 * math.pi - values["model_theta0"],
                                   rtol=0, atol=1e-11)  # written with 12 digits

    def test_units_of_the_file(self):
        labels = {}
        for factor in (1.0, 9e-4):
            self.ask(figure("fit_trajectories"), scene=f"[fit]\n[[fit.trajectories]]\nfile = 'rods.csv'\nf_over_mu = {factor}\n")
            with run_dir.RunDir(self.folder) as run:
                labels[factor] = draw.KINDS["fit_trajectories"].draw(run, draw.figures_of(run)[0]).axes[0].get_xlabel()
        self.assertEqual(labels, {1.0: r"$x\,\mu/f$", 9e-4: "$x$"})

    def test_wrong_input(self):
        (self.folder / "fit_trajectory_0.csv").write_text("t,x0\n0,0\n")
        self.fails("fit_trajectory_0.csv", "column y0", kind="fit_trajectories")
        self.build(profiles=FOUR[:1], trajectories=0)
        self.fails("no trajectories", "kind fit", kind="fit_trajectories")

    def test_report(self):
        page = self.words_of_page()
        for part in ("κ = (0.500 ± 0.010) v0 μ/f", "θ1(0)", "heading of rod 1 at the start of trajectory 0"):
            self.assertIn(part, page)


if __name__ == "__main__":
    unittest.main()
