"""Fits from arrays: known values come back, and the bits are those of the program."""

import unittest
from dataclasses import replace

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

    def test_residuals_predictions_and_likelihoods(self):
        fitted, other = noisy_profile(), noisy_profile("Uy", 3.0, 4)
        found = rodwake.fit_wake([fitted, replace(other, role="predict")], ["f_over_mu", "eta", "xi"], core=2.0, likelihood=["eta"])
        ours, theirs = found.profiles
        self.assertEqual((ours.role, theirs.role, found.residuals.size), ("fit", "predict", ours.used.sum()))
        self.assertAlmostEqual(np.sum(found.residuals**2), found.chi2, delta=1e-9 * found.chi2)  # round-off of two sums
        np.testing.assert_allclose(ours.residual[ours.used], found.residuals, rtol=1e-9, atol=1e-9)
        np.testing.assert_array_equal(ours.used, np.abs(PLACES) >= 2.0)
        np.testing.assert_allclose(theirs.residual, (other.value - theirs.model) / SIGMA, rtol=1e-9, atol=1e-9)
        self.assertLess(abs(theirs.excess - 1), 4 * theirs.excess_error)  # the model is that of the data
        self.assertTrue(found.likelihood["eta"].low < found.parameters["eta"].value < found.likelihood["eta"].high)
        figure = rodwake.plots.correlation(found, "errors")
        self.assertEqual(len(figure.axes[0].texts), 9)
        alone = rodwake.fit_wake([fitted], ["f_over_mu", "eta", "xi"], core=2.0)
        self.assertEqual(alone.chi2, found.chi2)

    def test_two_runs_in_one_profile(self):
        one, other = noisy_profile(), noisy_profile(seed=5)
        both = Profile(np.concatenate([PLACES, PLACES]), np.concatenate([one.value, other.value]), np.full(2 * PLACES.size, SIGMA), at=1.0)
        dofs = [rodwake.fit_wake([profile], ["f_over_mu", "eta", "xi"], independent_spacing=2.0).dof for profile in (one, both)]
        self.assertEqual(dofs, [round(81 / 4) - 3, 41 - 3])  # half a unit of length a step

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

    def test_headings_that_jump_and_headings_in_degrees(self):
        run = rodwake.simulate([[0, 2.5, 3.0], [0, -2.5, 3.0]], rodwake.Medium(), kappa=0.5, t_end=20.0, output_times=np.linspace(0, 20, 21), rtol=1e-10)
        jumping, degrees = run.poses.copy(), run.poses.copy()
        jumping[..., 2] = (jumping[..., 2] + np.pi) % (2 * np.pi) - np.pi
        jumping[::3, 0, 2] += 2 * np.pi
        degrees[..., 2] = np.degrees(degrees[..., 2])
        keys = {"parameters": ["kappa"], "fixed": {"eta": 1.0, "alpha": 1.0}}
        found = rodwake.fit_rods([Track(run.t, jumping, 1e-3, 1e-3)], **keys)
        self.assertAlmostEqual(found.parameters["kappa"].value, 0.5, delta=1e-6)
        self.assertEqual(len(found.free), 7)
        self.assertEqual(rodwake.fit_rods([Track(run.t, jumping, 1e-3, 1e-3, start_poses="exact")], **keys).free, ["kappa"])
        self.assertLess(np.abs(found.tracks[0].model[:, :, :2] - run.poses[:, :, :2]).max(), 1e-5)
        with self.assertRaisesRegex(rodwake.InputError, "look like degrees"):
            rodwake.fit_rods([Track(run.t, degrees, 1e-3, 1e-3)], **keys)
        with self.assertRaisesRegex(rodwake.InputError, "in Python is in reduced units"):
            rodwake.fit_rods([Track(run.t, run.poses * [1e-3, 1e-3, 1.0], 1e-3, 1e-3)], **keys)


if __name__ == "__main__":
    unittest.main()
