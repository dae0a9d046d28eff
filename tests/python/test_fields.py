"""Fields on arrays: shapes, symmetry, and the digits of the program."""

import os
import pickle
import subprocess
import unittest
import warnings

import numpy as np
import rodwake


def some_points(count):
    draw = np.random.default_rng(5)
    return draw.uniform(-20, 20, (2, count))


class MediumTest(unittest.TestCase):
    def test_names_of_one_number_agree(self):
        medium = rodwake.Medium(eta=3.0, alpha=0.5)
        self.assertEqual((medium.eta, medium.xi, medium.alpha, medium.periodic), (3.0, 2.0, 0.5, None))
        self.assertEqual(medium, rodwake.Medium(poisson_ratio=0.5, xi=2.0))  # (1 + p)/(1 - p) = 3
        self.assertNotEqual(medium, rodwake.Medium(eta=3.0, alpha=0.5, periodic=40.0))
        self.assertEqual(rodwake.Medium(), rodwake.Medium(eta=1.0, xi=1.0))

    def test_can_be_copied_and_read_back(self):
        for medium in (rodwake.Medium(eta=0.1, xi=1 / 3), rodwake.Medium(periodic=12.5), rodwake.Medium(periodic=(12.5, 9.0))):
            self.assertEqual(pickle.loads(pickle.dumps(medium)), medium)
            self.assertEqual(eval(repr(medium), {"Medium": rodwake.Medium}), medium)
            self.assertEqual(hash(pickle.loads(pickle.dumps(medium))), hash(medium))

    def test_what_is_no_medium_is_refused(self):
        for given, word in (({"eta": -1.0}, "eta"), ({"xi": 0.0}, "xi"), ({"xi": 1.0, "alpha": 1.0}, "alpha"), ({"eta": float("nan")}, "eta"),
                            ({"eta": 1.0, "poisson_ratio": 0.3}, "poisson_ratio"), ({"periodic": -1.0}, "periodic"), ({"periodic": (3.0, -1.0)}, "periodic")):
            with self.assertRaisesRegex(rodwake.InputError, word):
                rodwake.Medium(**given)
        with self.assertRaises(ValueError):  # it is one
            rodwake.Medium(eta=-2.0)
        for given, word in (({"eta": "soft"}, "eta = 'soft': must be a finite number above -1"), ({"xi": True}, "xi = True"), ({"alpha": 1j}, "alpha"),
                            ({"periodic": "big"}, "periodic = 'big'"), ({"periodic": (1, 2, 3)}, "periodic"), ({"eta": [1, 2]}, "eta"),
                            ({"xi": 10**400}, "xi"), ({"periodic": (1, None)}, "periodic")):
            with self.assertRaisesRegex(rodwake.InputError, word):
                rodwake.Medium(**given)


class FieldTest(unittest.TestCase):
    quantities = (rodwake.displacement, rodwake.strain, rodwake.laplacian, rodwake.grad_div, rodwake.dipole)

    def test_shapes_follow_the_points(self):
        medium = rodwake.Medium()
        for quantity in self.quantities:
            tail = (2, 2) if quantity is rodwake.strain else (2,)
            self.assertEqual(quantity(1.0, 2.0, medium).shape, tail)
            self.assertEqual(quantity([], [], medium).shape, (0, *tail))
            grid = quantity(np.arange(1, 4)[None, :], np.arange(1, 6)[:, None], medium)
            self.assertEqual(grid.shape, (5, 3, *tail))
            np.testing.assert_array_equal(grid[4, 2], quantity(3.0, 5.0, medium))

    def test_the_digits_of_the_program(self):
        x, y = some_points(200)
        table = "x,y,xi,eta\n" + "".join(f"{a!r},{b!r},2.0,1.5\n" for a, b in zip(x.tolist(), y.tolist()))
        done = subprocess.run([os.environ["RODWAKE_PROGRAM"], "field", "--points", "-"], input=table, capture_output=True, text=True, check=True)
        printed = np.genfromtxt(done.stdout.splitlines(), delimiter=",", names=True)
        medium = rodwake.Medium(eta=1.5, xi=2.0)
        np.testing.assert_array_equal(rodwake.displacement(x, y, medium)[:, 0], printed["Ux"])
        # Batched kernels, whose strain and polar vectors keep 1.5e-13 of the norm (wake_kernel.hpp).
        strain = rodwake.strain(x, y, medium)
        size = np.sqrt((strain**2).sum(axis=(1, 2)))
        self.assertLess(np.max(np.abs(strain[:, 0, 1] - printed["exy"]) / size), 1.5e-13)

    def test_neither_threads_nor_neighbours_change_a_bit(self):
        x, y = some_points(5000)
        rods = np.random.default_rng(6).uniform(-3, 3, (4, 3))
        for quantity in self.quantities:
            values = quantity(x, y, rodwake.Medium(), rods=rods)
            np.testing.assert_array_equal(values, quantity(x, y, rodwake.Medium(), rods=rods, threads=3))
            np.testing.assert_array_equal(values[77], quantity(x[77], y[77], rodwake.Medium(), rods=rods))

    def test_fields_of_rods_add_up_and_turn(self):
        x, y = some_points(50)
        for medium in (rodwake.Medium(eta=2.0), rodwake.Medium(periodic=60.0)):
            both = rodwake.strain(x, y, medium, rods=[[1, 2, 0.5], [-2, 0, 3.0]])
            parts = sum(rodwake.strain(x, y, medium, rods=[rod]) for rod in ([1, 2, 0.5], [-2, 0, 3.0]))
            np.testing.assert_allclose(both, parts, rtol=0, atol=1e-15 * np.abs(parts).max())  # a rounding of the largest
        up = rodwake.displacement(x, y, rodwake.Medium(), rods=[[0, 0, np.pi / 2]])
        flat = rodwake.displacement(y, -x, rodwake.Medium())
        # The turn itself rounds: cos(pi/2) is 6e-17, and the fields are of order 0.1.
        np.testing.assert_allclose(up, np.stack([-flat[:, 1], flat[:, 0]], axis=-1), rtol=1e-12, atol=1e-15)

    def test_a_large_box_is_nearly_the_plane(self):
        """What images add decays with the box (docs/numerics.md); at 400 xi it is below a thousandth near the rod."""
        plane = rodwake.strain([-2.0, 0.3], [1.0, -0.4], rodwake.Medium())
        box = rodwake.strain([-2.0, 0.3], [1.0, -0.4], rodwake.Medium(periodic=400.0))
        self.assertLess(np.abs(box - plane).max(), 1e-3 * np.abs(plane).max())
        self.assertGreater(np.abs(box - plane).max(), 0)

    def test_a_rod_on_the_grid_leaves_the_other_points(self):
        """NaN at the rod, with a warning; elsewhere the bits of the points without it. The first block has the rod, the second not."""
        x, y = np.linspace(-4, 4, 81), np.linspace(-3, 3, 61)[:, None]
        away = np.hypot(x, y) > 0
        for medium in (rodwake.Medium(eta=2.0), rodwake.Medium(periodic=(40.0, 30.0))):
            few = slice(None) if medium.periodic is None else slice(28, 33)  # a box is dear
            for quantity in self.quantities:
                with self.assertWarnsRegex(RuntimeWarning, f"{quantity.__name__}: NaN at 1 of") as caught:
                    grid = quantity(x, y[few], medium, threads=2)
                self.assertEqual(caught.filename, __file__)
                np.testing.assert_array_equal(np.isnan(grid).any(axis=tuple(range(2, grid.ndim))), ~away[few])
                X, Y = np.broadcast_arrays(x, y[few])
                np.testing.assert_array_equal(grid[away[few]], quantity(X[away[few]], Y[away[few]], medium))

    def test_where_a_rod_is(self):
        turned = [[1.5, -2.25, 0.7], [3.0, 1.0, -2.0]]
        for medium, places in ((rodwake.Medium(), [[1.5, -2.25], [3.0, 1.0]]), (rodwake.Medium(periodic=12.0), [[1.5, -2.25], [15.0, 1.0], [-10.5, 9.75]])):
            for quantity in self.quantities:
                with self.assertWarns(RuntimeWarning):
                    values = quantity(*np.transpose([*places, [1.5, -2.25 + 1e-9]]), medium, rods=turned)
                self.assertTrue(np.isnan(values[:-1]).all() and np.isfinite(values[-1]).all(), (quantity, medium, values))
        with self.assertWarns(RuntimeWarning):
            self.assertTrue(np.isnan(rodwake.strain(0, 0, rodwake.Medium())).all())

    def test_places_that_are_none(self):
        """NaN, infinite and masked ones, without a warning."""
        x = np.ma.masked_array([1.0, np.nan, 3.0, np.inf, 5.0], mask=[0, 0, 0, 0, 1])
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            for quantity in self.quantities:
                for medium in (rodwake.Medium(), rodwake.Medium(periodic=30.0)):
                    values = quantity(x, 0.5, medium)
                    np.testing.assert_array_equal(values[[0, 2]], quantity([1, 3], 0.5, medium))
                    self.assertTrue(np.isnan(values[[1, 3, 4]]).all())

    def test_arrays_of_every_kind(self):
        medium, base = rodwake.Medium(), np.arange(1.0, 13.0)
        exact = rodwake.strain(base, 0.5, medium)
        for x, shape in ((base.astype(int), 12), (base.astype(np.float32), 12), (base.tolist(), 12), (base.reshape(3, 4), (3, 4)), (tuple(base), 12),
                         (np.repeat(base, 2)[::2], 12), (np.asfortranarray(base.reshape(3, 4)), (3, 4)), (base.astype(object), 12), (base.astype(">f8"), 12)):
            np.testing.assert_array_equal(rodwake.strain(x, 0.5, medium), exact.reshape(*np.atleast_1d(shape), 2, 2))
        self.assertEqual(rodwake.strain(np.float32(1), np.array(2), medium).shape, (2, 2))
        self.assertEqual(rodwake.strain(np.zeros((0, 3)), 1.0, medium).shape, (0, 3, 2, 2))
        np.testing.assert_array_equal(rodwake.displacement(1.0, 1.0, medium, rods=np.zeros((0, 3))), [0, 0])

    def test_bad_points_are_refused(self):
        medium = rodwake.Medium()
        for x, y, more, word in (([1], [1], {"rods": [[0, 0]]}, r"rods: .*\(N, 3\)"), ([1], [1], {"rods": [[np.nan, 1, 0]]}, "rods: nan.*finite"),
                                 ("one", [1], {}, "x: expected numbers"), ([1], None, {}, "y: expected numbers"), ([1j], [1], {}, "x: .*complex"),
                                 (1j, 1, {}, "x: "), ([True], 1, {}, "x: .*bool"), ([[1], [2, 3]], 1, {}, "x: "), ([1, None], 1, {}, "x: "),
                                 ([1, 2, 3], [1, 2], {}, r"x has the shape \(3,\) and y \(2,\)"), (1, 1, {"threads": -1}, "threads = -1: .* from 0 to 1024"),
                                 (1, 1, {"threads": 2.5}, "threads = 2.5"), (1, 1, {"rods": "none"}, "rods")):
            for quantity in self.quantities:
                with self.assertRaisesRegex(rodwake.InputError, word):
                    quantity(x, y, medium, **more)
        with self.assertRaisesRegex(TypeError, "medium: expected a rodwake.Medium, not str"):
            rodwake.strain(1, 1, "water")


class WakesTest(unittest.TestCase):
    POSES = np.array([[0, 2.5, 0.3], [0.5, -2.5, -1.0], [3.0, 0.2, 2.0]])

    def test_the_fields_of_the_others(self):
        for medium, rounding in ((rodwake.Medium(eta=3.0, xi=2.0), 3e-13), (rodwake.Medium(periodic=(60.0, 50.0)), 3e-10)):
            found = rodwake.wakes(self.POSES, medium)
            for a, (x, y, _) in enumerate(self.POSES):
                others = np.delete(self.POSES, a, axis=0)
                for name in ("displacement", "strain", "laplacian", "grad_div"):
                    exact = getattr(rodwake, name)(x, y, medium, rods=others)
                    if medium.periodic is not None:  # its own images, by a place so near that only they change little
                        near = 1e-4 * np.array([np.cos(0.4), np.sin(0.4)])
                        plane = rodwake.Medium(eta=medium.eta, xi=medium.xi)
                        own = [self.POSES[a]]
                        at = (x + near[0] * np.array([1, -1]), y + near[1] * np.array([1, -1]))
                        images = getattr(rodwake, name)(*at, medium, rods=own) - getattr(rodwake, name)(*at, plane, rods=own)
                        # Beside a rod the field itself is large, and the difference loses it.
                        exact, rounding = exact + images.mean(axis=0), 1e-5
                    np.testing.assert_allclose(getattr(found, name)[a], exact, rtol=0, atol=rounding * max(1.0, np.abs(exact).max()), err_msg=name)

    def test_the_gradient_of_the_strain(self):
        """Against central differences: h^2/6 of the third derivatives, here below 1e-7, and rounding 1e-16/h."""
        medium, h = rodwake.Medium(eta=3.0, xi=2.0), 1e-4
        found = rodwake.wakes(self.POSES.ravel(), medium).strain_gradient
        for a, (x, y, _) in enumerate(self.POSES):
            others = np.delete(self.POSES, a, axis=0)
            for k, step in enumerate(np.eye(2) * h):
                ahead, behind = (rodwake.strain(x + sign * step[0], y + sign * step[1], medium, rods=others) for sign in (1, -1))
                np.testing.assert_allclose(found[a, k], (ahead - behind) / (2 * h), rtol=0, atol=1e-7)

    def test_the_law_of_the_theory_follows_from_them(self):
        medium = rodwake.Medium(eta=2.0)
        found = rodwake.wakes(self.POSES, medium)
        n = np.stack([np.cos(self.POSES[:, 2]), np.sin(self.POSES[:, 2])], axis=-1)
        drive = 0.5 * np.einsum("aij,aj->ai", found.strain, n) + 0.3 * found.laplacian - 0.2 * found.grad_div
        law = rodwake.RodEquations(self.POSES, medium, kappa=0.5, gamma1=0.3, gamma2=-0.2)(0.0, self.POSES.ravel()).reshape(-1, 3)
        np.testing.assert_allclose(n[:, 0] * drive[:, 1] - n[:, 1] * drive[:, 0], law[:, 2], rtol=1e-11)

    def test_what_is_refused(self):
        medium = rodwake.Medium()
        for poses, word in (([[0, 0, 0], [0, 0, 1]], "same place"), ([1, 2], r"\(N, 3\)"), ([[0, np.nan, 0]], "finite"), ([], r"\(N, 3\)")):
            with self.assertRaisesRegex(rodwake.InputError, word):
                rodwake.wakes(poses, medium)
        with self.assertRaisesRegex(TypeError, "medium"):
            rodwake.wakes([[0, 0, 0]], None)
        for sums in rodwake.wakes([[0, 0, 0]], medium):
            np.testing.assert_array_equal(sums, 0)  # alone on the plane


if __name__ == "__main__":
    unittest.main()
