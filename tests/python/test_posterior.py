"""Densities and samples of the parameters of a fit: closed forms, and the bits of the program."""

import math
import unittest

import numpy as np
import rodwake
from program import new_folder
from rodwake import Profile
from test_fitting import PLACES, SIGMA, noisy_profile

PRIORS = {"f_over_mu": {"kind": "normal", "mean": 2.0, "sd": 0.5, "low": 0.0, "high": 5.0}, "eta": {"kind": "log_uniform", "low": 0.1, "high": 20.0}}
KEYS = {"parameters": ["f_over_mu", "eta", "xi"], "priors": PRIORS, "bounds": {"xi": [5.0, 40.0]}, "core": 2.0}


class DensityTest(unittest.TestCase):
    def test_it_is_likelihood_times_prior_at_each_row(self):
        problem = rodwake.FitProblem(profiles=[noisy_profile()], threads=2, **KEYS)
        self.assertEqual(problem.names, KEYS["parameters"])
        theta = np.array([[2.2, 2.0, 12.0], [2.1, 1.0, 20.0], [2.2, 2.0, 50.0], [-1.0, 2.0, 12.0]])
        found = problem.log_density(theta)
        self.assertEqual(found.shape, (4,))
        self.assertTrue(np.isneginf(found[2:]).all())  # outside the priors of xi and f_over_mu
        used = np.abs(PLACES) >= 2.0
        for row, density in zip(theta[:2], found):
            model = row[0] * rodwake.displacement(PLACES[used], 1.0, rodwake.Medium(eta=row[1], xi=row[2]))[:, 0]
            r = (np.asarray(noisy_profile().value)[used] - model) / SIGMA
            likelihood = -0.5 * np.sum(r**2) - r.size * math.log(SIGMA * math.sqrt(2 * math.pi))
            cut = 0.5 * (math.erf(3.0 / 0.5 / math.sqrt(2)) + math.erf(2.0 / 0.5 / math.sqrt(2)))
            prior = (-0.5 * ((row[0] - 2.0) / 0.5) ** 2 - math.log(0.5 * math.sqrt(2 * math.pi) * cut)
                     - math.log(row[1] * math.log(20.0 / 0.1)) - math.log(35.0))
            self.assertAlmostEqual(density, likelihood + prior, delta=1e-8 * abs(likelihood))  # two ways to the field
            self.assertAlmostEqual(problem.log_prior(row), prior, delta=1e-12)
        self.assertEqual(problem.log_density(theta[0]), found[0])

    def test_what_cannot_be_is_refused(self):
        problem = rodwake.FitProblem(profiles=[noisy_profile()], **KEYS)
        for theta in ([1.0, 2.0], np.zeros((2, 2)), np.zeros((1, 2, 3))):
            with self.assertRaisesRegex(rodwake.InputError, "in the order f_over_mu, eta, xi"):
                problem.log_density(theta)
        for changes, words in (({"priors": {"eta": {"kind": "log_uniform", "low": 0.0, "high": 2.0}}}, "log_uniform|beyond"),
                               ({"priors": {"eta": {"kind": "gauss"}}}, "normal"), ({"samples": 4001}, "multiple"), ({"chains": 0}, "chains")):
            with self.assertRaisesRegex(rodwake.Error, words):
                rodwake.FitProblem(profiles=[noisy_profile()], **KEYS | changes)
        with self.assertRaisesRegex(rodwake.InputError, "standard errors"):
            rodwake.FitProblem(profiles=[Profile(PLACES, noisy_profile().value, at=1.0)], **KEYS)


class PosteriorTest(unittest.TestCase):
    def test_the_bits_of_the_program(self):
        folder, profile = new_folder(self), noisy_profile()
        rows = zip(profile.place.tolist(), profile.value.tolist(), profile.sigma.tolist())
        (folder / "p.csv").write_text("x,value,sigma\n" + "".join(f"{x!r},{value!r},{sigma!r}\n" for x, value, sigma in rows))
        (folder / "fit.toml").write_text("""schema = 1
[fit]
parameters = ["f_over_mu", "eta", "xi"]
core = 2.0
bounds = { xi = [5.0, 40.0] }
[[fit.profiles]]
file = "p.csv"
at = 1.0
[fit.posterior]
evidence = true
samples = 400
[fit.posterior.priors]
f_over_mu = { kind = "normal", mean = 2.0, sd = 0.5, low = 0.0, high = 5.0 }
eta = { kind = "log_uniform", low = 0.1, high = 20.0 }
""")
        theirs = rodwake.Scene.load(folder / "fit.toml").run(folder / "run").json("posterior.json")
        ours = rodwake.posterior(profiles=[profile], samples=400, threads=2, **KEYS)
        for name, one in ours.parameters.items():
            self.assertEqual((one.mean, one.sd, one.ess), tuple(theirs["parameters"][name][key] for key in ("mean", "sd", "ess")))
            self.assertEqual(ours.samples[name].shape, (4, 100))
            self.assertAlmostEqual(ours.samples[name].mean(), one.mean, delta=1e-12 * abs(one.mean))  # sums in another order
        self.assertEqual(ours.log_evidence, (theirs["log_evidence"]["value"], theirs["log_evidence"]["stderr"]))
        self.assertIn("eta=", repr(ours))
        theta = [ours.samples[name][1, 2] for name in ours.samples]
        problem = rodwake.FitProblem(profiles=[profile], **KEYS)
        self.assertAlmostEqual(problem.log_likelihood(theta), ours.log_likelihood[1, 2], delta=1e-9 * abs(ours.log_likelihood[1, 2]))  # by z and back


if __name__ == "__main__":
    unittest.main()
