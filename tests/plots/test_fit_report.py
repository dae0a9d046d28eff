"""Tests of the report's part about a fit, on made-up results: /usr/bin/python3 tests/plots/test_fit_report.py"""

import json
import math
import re
import unittest

from fit_case import FitCase, figure
from made_up_fit import parameter
from made_up_result import LINE, write_result
from made_up_result import SCENE as THEORY
from rodwake_plots import fit_sections, fit_words, run_dir, words


class ReportTest(FitCase):
    def page(self):
        """With the quickest figure."""
        self.ask(figure("fit_correlation"))
        return super().page()

    def test_everything_is_reported(self):
        known = self.record["parameters"] | {"x0": parameter(0.5, None, free=False, unit="a"),
                                           "f2d_over_mu": parameter(1.1, None, free=False, tied_to="f_over_mu", unit="a^2"),
                                           "xi": self.record["parameters"]["xi"] | {"at_bound": "upper", "value": 100.0, "stderr": None}}
        self.rewrite(parameters=known, remarks=["xi sits at its upper bound"], box=78.0)
        (self.folder / "medium.json").write_text(json.dumps({"eta": 1.31, "xi": 9.8, "xi_stderr": 0.9, "alpha": 0.102}))
        page = self.words_of_page()
        for part in ("(2.200 ± 0.060) a", "1.016 to 1.604", "χ² = 61.3 for 59 degrees of freedom, χ²/dof = 1.04", "the probability of at least this χ² is 0.39",
                     "tied to f/μ", "fixed", "at its upper bound", "xi sits at its upper bound", "α alpha0.1020 ± 0.0090", "follows from",
                     "Rods and field of this run are in the fitted medium: η = 1.31, ξ = (9.80 ± 0.90) f/μ, α = 0.102.", "prediction", "62 of 78",
                     "2.20 ± 0.21", "12, 8 of which reached the same optimum", "converged: the polish met its tolerance", "slsqp",
                     "side 78 a", "f/μ = 2.2, η = 1.3, ξ = 22", "1.016 to 1.661", "lengths in a", "η0.9971"):
            self.assertIn(part, page)
        self.assertNotRegex(page, r"\b(?:nan|inf|None|null)\b")

    def test_both_sides_of_a_rectangle_are_reported(self):
        self.rewrite(box=[78.5, 77.25])
        self.assertIn("sides 78.5 × 77.25 a", self.words_of_page())

    def test_self_contained(self):
        page = self.page()
        self.assertNotRegex(page, "https?:")
        self.assertEqual(set(re.findall(r'src="([^"]{0,22})', page)), {"data:image/png;base64,"})

    def test_no_degrees_of_freedom_and_no_remarks(self):
        self.rewrite(dof=0, probability=1.0)
        page = self.page()
        self.assertIn("no degree of freedom is left", page)
        self.assertNotIn("<li>", page)

    def test_names_are_escaped(self):
        self.rewrite(remarks=["<script>alert(1)</script>"], compare=[self.record["compare"][0] | {"name": "<b>&"}])
        page = self.page()
        self.assertNotIn("<script", page)
        self.assertIn("&lt;b&gt;&amp;", page)

    def test_beside_other_figures(self):
        """A scene that asks for figures, none of the fit, shows the fit all the same; one that does is left alone."""
        write_result(self.folder)
        (self.folder / "outcome.json").write_text(json.dumps({"outcome": "contact", "time": 4.0, "min_separation": 0.1, "pair": [0, 1]}))
        self.ask(LINE, scene=THEORY)
        self.assert_drawn("line", "fit")
        self.ask(LINE.replace("line", "fit"), scene=THEORY)
        self.assert_drawn("fit", "fit_to_data")
        self.ask(LINE, figure("fit_correlation"), scene=THEORY)
        self.assert_drawn("line", "fig")

    def test_the_keys_of_a_fit_are_explained(self):
        page = self.page()
        for part in ("where the search starts", "[[fit.profiles]]", "Measured displacement along a line."):
            self.assertIn(part, page)

    def test_terminations(self):
        for name in ("converged", "roundoff", "budget", "interrupted", "failed"):
            self.rewrite(termination=name)
            with run_dir.RunDir(self.folder) as run:
                self.assertEqual(dict(fit_sections.search_rows(run.fit))["End"].split(":")[0], fit_sections.ENDINGS[name].split(":")[0])


class WordsTest(unittest.TestCase):
    def test_units(self):
        for unit, html, math_text in (("", "", "$$"), ("1", "", None), ("a", "<i>a</i>", "$a$"), ("a^2", "<i>a</i><sup>2</sup>", "$a^{2}$"),
                                      ("m^2/s^2", "m<sup>2</sup>/s<sup>2</sup>", None), ("a^(1/2)", "<i>a</i><sup>1/2</sup>", None), ("a^-2", "<i>a</i><sup>−2</sup>", None),
                                      ("f/mu", "<i>f</i>/<i>μ</i>", r"$f/\mu{}$"), ("rad", "rad", r"$\mathrm{rad}$"),
                                      ("mm", "mm", r"$\mathrm{mm}$"), ("m", "m", r"$\mathrm{m}$"), ("v0", "<i>v</i><sub>0</sub>", "$v_0$"),
                                      ("v0 mu/f", "<i>v</i><sub>0</sub> <i>μ</i>/<i>f</i>", r"$v_0\,\mu{}/f$"), ("<x>", "&lt;<i>x</i>&gt;", "$x$")):
            self.assertEqual(fit_words.unit_html(unit), html)
            if math_text is not None:
                self.assertEqual(fit_words.unit_math(unit), math_text)

    def test_axes(self):
        self.assertEqual([fit_words.axis("x", unit) for unit in ("a", "mm", "m", "$\\evil{")], ["$x/a$", "$x$ / mm", "$x$ / m", "$x$ / evil"])

    def test_intervals(self):
        infinite = math.inf
        self.assertEqual([fit_words.interval_html(*ends) for ends in ((1.0, 2.5), (-infinite, 2.5), (1.0, infinite), (-infinite, infinite))],
                         ["1 to 2.5", "below 2.5", "above 1", "unbounded"])

    def test_an_error_as_small_as_rounding(self):
        self.assertEqual(words.with_error(2.2, 1e-12), "2.2 ± 10<sup>−12</sup>")
        self.assertEqual(words.with_error(2.2, 1e-7), "2.20000000 ± 0.00000010")


if __name__ == "__main__":
    unittest.main()
