"""Fits from arrays: known values come back, and the bits are those of the program."""

import unittest

import numpy as np
import rodwake
from program import new_folder
from rodwake import Profile, Track

PLACES = np.linspace(-30, 10, 81) + 0.25
SIGMA = 1e-3


def noisy_profile(component="Ux", at=1.0, seed=3):
    medium = rodwake.Medium(eta=2.0, xi=12.0)
    exact = 2.2 * rodwake.displacement(PLACES, at, medium)[:, "Ux Uy".split().index(component)]
    noise = np.random.default_rng(seed).normal(size=PLACES.size)
    return Profile(PLACES, exact + SIGMA * noise, np.full(PLACES.size, SIGMA), component=component, at=at, name=f"{component} at {at}")


class WakeTest(unittest.TestCase):
    def test_what_made_the_data_is_found(self):
        found = rodwake.fit_wake([noisy_profile(), noisy_profile("Uy", 3.0, 4)], ["f_over_mu", "eta", "xi"], starts=3, threads=2)
        self.assertEqual((found.termination, found.free, found.dof), ("converged", ["f_over_mu", "eta", "xi"], 2 * 81 - 3))
        for name, truth in (("f_over_mu", 2.2), ("eta", 2.0), ("xi", 12.0)):
            one = found.parameters[name]
            self.assertLess(abs(one.value - truth), 4 * one.standard_error, one)  # the seeds are fixed: 4 sigma is a wrong error
            self.assertTrue(one.low < one.value < one.high and one.free and one.bound is None)
        self.assertGreater(found.probability, 1e-3)
        errors = [found.parameters[name].standard_error for name in found.free]
        np.testing.assert_allclose(np.sqrt(np.diag(found.covariance)), errors, rtol=1e-12)
        np.testing.assert_allclose(found.correlation * np.outer(errors, errors), found.covariance, rtol=1e-10)
        self.assertIn("f_over_mu", found.report())
        self.assertIn("eta=", repr(found))

    def test_the_bits_of_the_program(self):
        folder, profile = new_folder(self), noisy_profile()
        rows = zip(profile.place.tolist(), profile.value.tolist(), profile.sigma.tolist())
        (folder / "p.csv").write_text("x,value,sigma\n" + "".join(f"{x!r},{value!r},{sigma!r}\n" for x, value, sigma in rows))
        (folder / "fit.toml").write_text('schema = 1\n[fit]\nparameters = ["f_over_mu", "eta", "xi"]\nstarts = 3\ncore = 2.0\nindependent_spacing = 1.2\n'
                                         '[[fit.profiles]]\nfile = "p.csv"\nat = 1.0\n')
        theirs = rodwake.Scene.load(folder / "fit.toml").run(folder / "run").json("fit.json")
        ours = rodwake.fit_wake([profile], ["f_over_mu", "eta", "xi"], starts=3, core=2.0, independent_spacing=1.2)
        for name, one in ours.parameters.items():
            self.assertEqual((one.value, one.standard_error), (theirs["parameters"][name]["value"], theirs["parameters"][name]["stderr"]))
        self.assertEqual((ours.chi2, ours.dof), (theirs["chi2"], theirs["dof"]))

    def test_fixed_and_tied_parameters(self):
        found = rodwake.fit_wake([noisy_profile()], ["f_over_mu", "xi"], fixed={"eta": 2.0}, tied={"f2d_over_mu": ["f_over_mu", 1e-9]},
                                 start={"xi": 5.0}, bounds={"xi": [1.0, 11.0]})
        self.assertEqual((found.parameters["eta"].value, found.parameters["eta"].free), (2.0, False))
        self.assertTrue(np.isnan(found.parameters["eta"].standard_error))
        self.assertEqual((found.parameters["xi"].value, found.parameters["xi"].bound), (11.0, "upper"))
        self.assertTrue(any("bound" in line for line in found.diagnostics), found.diagnostics)

    def test_wrong_data_and_keys_are_refused(self):
        good = noisy_profile()
        for profile, names, options, word in ((Profile([1.0], [2.0]), ["f_over_mu", "offset"], {"fixed": {"eta": 1.0, "xi": 1.0}}, "1 data points"),
                                              (Profile(PLACES, PLACES[1:]), ["eta"], {"fixed": {"f_over_mu": 1.0, "xi": 1.0}}, "value|length|numbers"),
                                              (good, ["f_over_my", "eta"], {}, "f_over_mu"), (good, ["eta"], {"methd": "slsqp"}, "method"),
                                              (Profile(PLACES, good.value, -good.sigma), ["f_over_mu", "eta", "xi"], {}, "sigma")):
            with self.subTest(word), self.assertRaisesRegex(rodwake.InputError, word):
                rodwake.fit_wake([profile], names, **options)


class RodsTest(unittest.TestCase):
    def test_couplings_from_a_track(self):
        run = rodwake.simulate([[0, 2.5, 0], [0, -2.5, 0]], rodwake.Medium(), kappa=0.5, t_end=20.0, output_times=np.linspace(0, 20, 21), rtol=1e-10)
        found = rodwake.fit_rods([Track(run.t, run.poses, 1e-3, 1e-3)], ["kappa", "alpha"], start={"kappa": 1.0, "alpha": 0.5}, fixed={"eta": 1.0})
        for name, truth in (("kappa", 0.5), ("alpha", 1.0)):  # data without noise; solved at rtol 1e-10
            self.assertAlmostEqual(found.parameters[name].value, truth, delta=1e-6)
        with self.assertRaisesRegex(rodwake.InputError, r"\(T, N, 3\)"):
            rodwake.fit_rods([Track(run.t, run.poses[1:], 1e-3, 1e-3)], ["kappa"], fixed={"eta": 1.0, "alpha": 1.0})


if __name__ == "__main__":
    unittest.main()
