"""Tests of the figure and the report's part about rival models, on made-up results: /usr/bin/python3 tests/plots/test_fit_models.py"""

import json
import unittest

import numpy as np

from fit_case import FitCase, figure
from rodwake_plots import run_dir


def model(name, weight, aic, probability, **more):
    return {"name": name, "log_evidence": None, "stderr": None, "aic": aic, "bic": aic + 3.0, "weight": weight, "free": 2, "chi2": aic - 4.0, "dof": 50,
            "parameters": {}, "cross_validation": {"log_likelihood": -30.0, "stderr": 4.0, "difference": -0.5 * (aic - 60.0), "difference_stderr": 1.5,
                                                   "blocks": 8},
            "misfit": {"probability": probability, "describes": probability >= 0.05, "worst": "a < b", "tests": {}, "regions": []}, "failure": None,
            "folder": f"models/{name}"} | more


FAILED = {"name": "broken", "log_evidence": None, "stderr": None, "aic": None, "bic": None, "weight": 0.0, "free": 0, "chi2": None, "dof": None,
          "cross_validation": None, "misfit": {"probability": None}, "failure": "no finite residuals"}
MISFIT = {"probability": 0.0005, "describes": False, "worst": "pair, headings, last third has chi2 80 where 38 is expected",
          "tests": {"chi2": {"value": 120.0, "expected": 90.0, "probability": 0.02, "text": ""}},
          "regions": [{"name": "pair, headings, last third", "chi2": 80.0, "expected": 38.0, "probability": 1e-5}]}


class ModelsTest(FitCase):
    def setUp(self):
        super().setUp()
        self.models = [model("strain", 0.02, 68.0, 0.3), model("flow", 0.98, 60.0, 0.6), FAILED]
        self.rewrite(misfit=MISFIT)
        self.tell("Of 3 models flow has the most weight, 0.98 by AIC; next is strain with 0.02.")

    def tell(self, *text):
        (self.folder / "models.json").write_text(json.dumps({"models": self.models, "weight_from": "aic", "values": 56, "text": text}))

    def test_each_model_that_was_fitted_has_a_row_behind_the_best(self):
        made, caption = self.draw("fit_models")
        axes = made.axes[0]
        self.assertEqual([label.get_text() for label in axes.get_yticklabels()], ["flow  (0.980)", "strain  (0.020)"])
        np.testing.assert_allclose(axes.lines[0].get_xdata(), [0.0, 8.0])
        np.testing.assert_allclose(axes.lines[1].get_xdata(), [0.0, 8.0])
        self.assertIn("weights by AIC", caption)
        self.assertIn("strain <i>p</i> = 0.3", caption)

    def test_the_report_tells_of_models_and_misfit(self):
        self.ask(figure("fit_models"))
        words = self.words_of_page()
        for part in ("Of 3 models flow has the most weight", "within the errors: pair, headings, last third has χ² 80", "Model comparison",
                     "broken", "pair, headings, last third8038"):
            self.assertIn(part, words)

    def test_drawn_by_default_only_where_there_are_rivals(self):
        for there in (True, False):
            with run_dir.RunDir(self.folder) as run:
                from rodwake_plots import draw
                self.assertEqual("fit_models" in [one.kind for one in draw.defaults(run)], there)
            (self.folder / "models.json").unlink(missing_ok=True)

    def test_no_model_that_was_fitted(self):
        self.models = [FAILED]
        self.tell("none")
        self.fails("holds no model that was fitted", kind="fit_models")


if __name__ == "__main__":
    unittest.main()
