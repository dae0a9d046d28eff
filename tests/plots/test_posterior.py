"""Tests of the figures of a posterior, on made-up results: /usr/bin/python3 tests/plots/test_posterior.py"""

import math
import re
import unittest

import numpy as np

from fit_case import FitCase, figure
from made_up_posterior import PRIORS, samples, write_posterior
from rodwake_plots import draw, posterior, posterior_result, run_dir


class PosteriorCase(FitCase):
    def build(self, **keys):
        super().build(**keys)
        write_posterior(self.folder, profiles=range(len(self.record["profiles"])), tracks=len(self.record["trajectories"]))


class CornerTest(PosteriorCase):
    def test_the_figures_of_a_posterior_come_by_themselves(self):
        with run_dir.RunDir(self.folder) as run:
            there = {spec.kind for spec in draw.figures_of(run)}
        self.assertEqual({kind for kind in there if "posterior" in kind}, {"posterior", "posterior_trace", "posterior_predictive"})

    def test_they_are_pictures(self):
        self.ask(figure("posterior", "corner"), figure("posterior_trace", "trace"))
        self.assert_drawn("corner", "trace")

    def test_contours_hold_the_masses_that_they_are_drawn_for(self):
        random = np.random.default_rng(1)
        counts, edges, _ = np.histogram2d(*random.standard_normal((2, 200000)), np.linspace(-5, 5, 101))
        middle = (edges[1:] + edges[:-1]) / 2
        r2 = middle[:, None] ** 2 + middle**2
        for mass, sigmas in zip(posterior.MASSES, (2.0, 1.0)):
            inside = counts >= posterior.level_of(posterior.smooth(counts), mass)
            self.assertAlmostEqual(math.sqrt(r2[inside].max()), sigmas, delta=0.4)  # the noise of the outermost cells

    def test_pairs_priors_and_least_squares(self):
        made, caption = self.draw("posterior")
        panels = [axes for axes in made.axes if axes.axison]
        self.assertEqual(len(panels), 6)
        self.assertEqual([axes.get_xlabel() for axes in panels if axes.get_xlabel()], ["$f/\\mu$ ($a$)", "$\\eta$", "$\\xi$ ($a$)"])
        self.assertEqual([text.get_text() for text in made.legends[0].get_texts()], ["samples", "prior", "least squares"])
        found = samples()["f_over_mu"]
        self.assertIn(f"{found.mean():.3f} ± {found.std():.3f}", re.sub("<[^>]*>", "", caption))
        cross = next(line for line in panels[1].lines if line.get_marker() == "+")
        self.assertEqual((cross.get_xdata()[0], cross.get_ydata()[0]), (2.2, 1.31))  # of made_up_fit

    def test_priors_are_normalised(self):
        for name, one in PRIORS.items():
            prior = posterior_result.Prior(one["kind"], one["low"], one["high"], one.get("mean", math.nan), one.get("sd", math.nan))
            x = np.geomspace(0.02, 120, 200001)
            self.assertAlmostEqual(np.trapz(prior.density(x), x), 1 - (0.011 if name == "f_over_mu" else 0), delta=0.012)

    def test_bands_stand_around_the_data(self):
        made, caption = self.draw("posterior_predictive", profiles=[0])
        self.assertIn("95 % of data", caption)
        self.assertEqual([text.get_text() for text in made.legends[0].get_texts()],
                         ["data", "posterior, 95 %", "with the noise of the data, 95 %"])

    def test_the_report_tells_of_it(self):
        write_posterior(self.folder, remarks=["the chains of <eta> do not agree"])
        self.ask(figure("posterior_trace"))
        text = self.words_of_page()
        for words in ("Posterior", "even in the logarithm, 0.05 to 50", "1.0012", "−123.400 ± 0.020", "the chains of &lt;eta&gt; do not agree"):
            self.assertIn(words, text)

    def test_damage_is_reported_by_the_name_of_the_file(self):
        (self.folder / "posterior.csv").write_text("chain,draw,f_over_mu,eta\n0,0,1,1\n")
        self.fails("posterior.csv", "xi", kind="posterior")


class TracksTest(PosteriorCase):
    KEYS = {"trajectories": 2}

    def test_what_is_left_of_tracks(self):
        made, _ = self.draw("posterior_trajectories")
        self.assertEqual(len(made.axes), 6)


del FitCase, PosteriorCase
if __name__ == "__main__":
    unittest.main()
