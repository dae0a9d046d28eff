"""pair_equilibria, pair_branches, pair_flow: against rods that move in the lab, and numbers of other programs."""

import csv
import inspect
import math
import unittest

import numpy as np
import rodwake
from program import new_folder

MEDIUM = rodwake.Medium(alpha=0.3)


def orbits(medium, **couplings):
    return [e for e in rodwake.pair_equilibria(medium, **couplings) if e.kind == "orbit"]


def turning(pose, medium, kappa, gamma1, gamma2):
    """Rates of turn of rod 0, at the origin along x, and of rod 1 at this pose: the law by hand, from the fields."""
    rods = np.array([[0.0, 0.0, 0.0], pose])
    fields = rodwake.wakes(rods, medium)
    n = np.stack([np.cos(rods[:, 2]), np.sin(rods[:, 2])], axis=1)
    v = kappa * np.einsum("aij,aj->ai", fields.strain, n) + gamma1 * fields.laplacian + gamma2 * fields.grad_div
    return n[:, 0] * v[:, 1] - n[:, 1] * v[:, 0]


class EquilibriaTest(unittest.TestCase):
    def test_orbits_of_two_other_programs(self):
        tight, wide = orbits(MEDIUM, kappa=23.0)
        np.testing.assert_allclose(tight.pose, (-1.72806389, 1.56732073, -1.47331705), atol=6e-9)
        self.assertAlmostEqual(tight.omega, 0.57593510, delta=6e-9)
        self.assertAlmostEqual(tight.separation, 2.33296, delta=6e-6)
        np.testing.assert_allclose(tight.eigenvalues, (-0.027, -0.271, -0.529), atol=6e-4)
        self.assertEqual((tight.stable, wide.stable), (True, False))
        self.assertEqual(orbits(rodwake.Medium(), kappa=22.94), [])
        wide, = orbits(rodwake.Medium(), kappa=26.05842651829)
        np.testing.assert_allclose(wide.pose, (-1.97850743, 1.36092121, -1.20505329), atol=6e-9)
        np.testing.assert_allclose(wide.eigenvalues, (0.17642976, -0.60881 + 0.175j, -0.60881 - 0.175j), atol=1e-5)

    def test_both_rods_turn_at_omega_on_one_circle(self):
        for medium, couplings in ((MEDIUM, (23.0, 0.0, 0.0)), (rodwake.Medium(eta=10.0), (130.0, 0.0, 0.0)), (rodwake.Medium(eta=0.5), (30.0, 5.0, -3.0)),
                                  (rodwake.Medium(), (-60.0, 0.0, 0.0)), (rodwake.Medium(), (0.0, 50.0, 0.0))):
            found = orbits(medium, **dict(zip(("kappa", "gamma1", "gamma2"), couplings)))
            self.assertTrue(found)
            for orbit in found:
                x, y, h = orbit.pose
                np.testing.assert_allclose(turning(orbit.pose, medium, *couplings), orbit.omega, rtol=1e-10)
                np.testing.assert_allclose((x * orbit.omega, y * orbit.omega), (math.sin(h), 1 - math.cos(h)), atol=1e-11)

    def test_rods_go_round(self):
        stable = [orbit for orbit in orbits(MEDIUM, kappa=23.0) if orbit.stable]
        period = 2 * math.pi / stable[0].omega
        end = rodwake.simulate([[0, 0, 0], stable[0].pose], MEDIUM, kappa=23.0, t_end=period, output_times=[], rtol=1e-11).poses[-1]
        np.testing.assert_allclose(end, [[0, 0, 2 * math.pi], np.add(stable[0].pose, (0, 0, 2 * math.pi))], atol=1e-8)

    def test_in_line(self):
        far = rodwake.pair_equilibria(rodwake.Medium(), kappa=10.0)
        self.assertEqual([(e.kind, e.stable) for e in far], [("in_line", False), ("in_line", True)])
        self.assertEqual(far[0].separation[1], far[1].separation[0])
        for kappa, distance, growth, rounding in ((10, 1, 0.23, 0.005), (10, 2, 0.040, 5e-4), (26, 2, 0.95, 0.005), (100, 3, 2.4, 0.05)):
            rates, jacobian = rodwake.pair_flow([-distance, 0, 0], rodwake.Medium(), kappa=kappa)
            np.testing.assert_array_equal(rates, 0)
            self.assertAlmostEqual(np.linalg.eigvals(jacobian).real.max(), growth, delta=rounding)
        end = far[0].separation[1]
        rates, jacobian = rodwake.pair_flow([-end, 0, 0], rodwake.Medium(), kappa=10.0)
        self.assertLess(abs(np.linalg.eigvals(jacobian).real).min(), 1e-12)
        self.assertLess(np.sort(abs(np.linalg.eigvals(jacobian).real))[1], 1e-11)

    def test_parallel_pairs_need_polar_couplings(self):
        self.assertEqual({e.kind for e in rodwake.pair_equilibria(rodwake.Medium(), kappa=300.0)}, {"orbit", "in_line"})
        parallel = [e for e in rodwake.pair_equilibria(rodwake.Medium(), gamma1=50.0) if e.kind == "parallel"]
        self.assertEqual(len(parallel), 2)  # in echelon and abreast
        for pair in parallel:
            np.testing.assert_allclose(turning(pair.pose, rodwake.Medium(), 0.0, 50.0, 0.0), 0, atol=1e-13)

    def test_the_fold(self):
        branch, = rodwake.pair_branches(rodwake.Medium(), "kappa", 20.0, 30.0)
        self.assertEqual(branch.ends, ("range", "distance"))
        fold, = branch.folds
        self.assertAlmostEqual(branch.parameter[fold], 22.940713, delta=5e-7)
        self.assertAlmostEqual(branch.separation[fold], 0.925, delta=5e-4)
        self.assertLess(abs(branch.growth[fold]), 1e-6)
        self.assertEqual(branch.parameter.argmin(), fold)
        self.assertEqual(branch.parameter.shape, branch.omega.shape)
        self.assertTrue((branch.growth[fold + 1:] < 0).all() and (branch.growth[:fold] > 0).all())  # tight: stable

    def test_branches_as_a_table_and_a_figure(self):
        branches = rodwake.pair_branches(rodwake.Medium(), "kappa", 20.0, 30.0)
        rows = list(csv.DictReader(rodwake.write_branches(new_folder(self) / "branches.csv", branches).read_text().splitlines()))
        self.assertEqual([float(row["kappa"]) for row in rows], branches[0].parameter.tolist())
        self.assertEqual([float(row["separation"]) for row in rows], branches[0].separation.tolist())
        self.assertEqual([k for k, row in enumerate(rows) if row["fold"] == "1"], branches[0].folds)
        self.assertEqual({(row["branch"], row["kind"], row["stable"]) for row in rows}, {("0", "orbit", "0"), ("0", "orbit", "1")})
        figure = rodwake.plots.branches(branches, "Orbits")
        for axes, values in zip(figure.axes, (branches[0].separation, branches[0].omega)):
            stable, unstable, folds = axes.lines[:3]
            self.assertEqual((stable.get_linestyle(), unstable.get_linestyle()), ("-", "--"))
            shown = np.isfinite(stable.get_ydata()) | np.isfinite(unstable.get_ydata())
            self.assertTrue(shown.all())  # no gap
            self.assertLessEqual((np.isfinite(stable.get_ydata()) & np.isfinite(unstable.get_ydata())).sum(), 2)
            np.testing.assert_array_equal(folds.get_xydata(), np.column_stack([branches[0].parameter, values])[branches[0].folds])
        self.assertRegex(figure.axes[0].get_xlabel(), "kappa")
        for wrong in ([], [*branches, *rodwake.pair_branches(rodwake.Medium(), "eta", 1.0, 2.0, kappa=30.0)]):
            with self.assertRaisesRegex(rodwake.InputError, "branches"):
                rodwake.write_branches(new_folder(self) / "branches.csv", wrong)
        with self.assertRaisesRegex(rodwake.InputError, "none to draw"):
            rodwake.plots.branches([])

    def test_what_cannot_be_looked_at(self):
        with self.assertRaisesRegex(rodwake.InputError, "infinite plane"):
            rodwake.pair_equilibria(rodwake.Medium(periodic=20.0), kappa=1.0)
        with self.assertRaisesRegex(rodwake.InputError, "not over 'xi'"):
            rodwake.pair_branches(rodwake.Medium(), "xi", 1.0, 2.0)
        with self.assertRaisesRegex(rodwake.InputError, "must rise"):
            rodwake.pair_branches(rodwake.Medium(), "eta", 2.0, 1.0)
        with self.assertRaisesRegex(rodwake.InputError, "three numbers"):
            rodwake.pair_flow([1.0, 2.0], rodwake.Medium())
        with self.assertRaises(TypeError):
            rodwake.pair_equilibria(None)

    def test_the_examples(self):
        """Of the docstrings."""
        for function in (rodwake.pair_equilibria, rodwake.pair_branches):
            lines = inspect.getdoc(function).split("Examples\n--------\n")[1].splitlines()
            names = {"rodwake": rodwake}
            for line, said in zip(lines, lines[1:]):
                code = line[4:]
                if line.startswith(">>> ") and not said.startswith(">>> "):
                    self.assertEqual(repr(eval(code, names)), said)
                elif line.startswith(">>> "):
                    exec(code, names)


class SimilarityTest(unittest.TestCase):
    def test_alpha_is_a_unit_of_length(self):
        """Without polar couplings lengths and times times alpha remove alpha: the same outcomes, and times that rounding and
        rtol = 1e-12 let differ (3e-13 for 1000 pairs)."""
        chance = np.random.default_rng(1)
        seen = set()
        for _ in range(40):
            kappa, eta = 10 ** chance.uniform(-0.5, 2.5), chance.uniform(0.2, 5)
            start = np.array([[0, 0, 0], [*chance.uniform(1, 6, 2) * chance.choice([-1, 1], 2), chance.uniform(-np.pi, np.pi)]])
            runs = [rodwake.simulate(start / [scale, scale, 1], rodwake.Medium(eta=eta, alpha=0.5 * scale), kappa=kappa, t_end=40 / scale,
                                     contact_distance=0.1 / scale, output_times=[], rtol=1e-12) for scale in (1.0, 2.1)]
            self.assertEqual(runs[0].outcome, runs[1].outcome)
            self.assertAlmostEqual(runs[0].time, 2.1 * runs[1].time, delta=1e-9 * runs[0].time)
            seen.add(runs[0].outcome)
        self.assertLessEqual({"contact", "escape"}, seen)


if __name__ == "__main__":
    unittest.main()
