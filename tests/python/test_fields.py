"""Fields on arrays: shapes, symmetry, and the digits of the program."""

import csv
import os
import pickle
import subprocess
import unittest
from pathlib import Path

import numpy as np
import rodwake

REFERENCE = Path(os.environ["RODWAKE_SOURCE_DIR"]) / "tests/data/elastic_field.csv"


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

    def test_the_reference_table(self):
        """34-digit arithmetic; bound of include/rodwake/elastic/field.hpp, 1e-12 of the norm."""
        with REFERENCE.open() as file:
            rows = [{key: float(value) for key, value in row.items()} for row in csv.DictReader(line for line in file if line[0] != "#")]
        columns = {"displacement": ("Ux", "Uy"), "strain": ("exx", "exy", "exy", "eyy"), "laplacian": ("lapx", "lapy"),
                   "grad_div": ("gradx_tr", "grady_tr"), "dipole": ("dipUx", "dipUy")}
        self.assertGreater(len(rows), 100)
        for row in rows[::7]:
            medium = rodwake.Medium(eta=row["eta"], xi=row["xi"])
            for quantity in self.quantities:
                exact = np.array([row[name] for name in columns[quantity.__name__]])
                value = quantity(row["x"], row["y"], medium).ravel()
                self.assertLess(np.linalg.norm(value - exact), 1e-12 * np.linalg.norm(exact) + 1e-290, (quantity, row))

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
        """What images add decays with the box (docs/physics.md); at 400 xi it is below a thousandth near the rod."""
        plane = rodwake.strain([-2.0, 0.3], [1.0, -0.4], rodwake.Medium())
        box = rodwake.strain([-2.0, 0.3], [1.0, -0.4], rodwake.Medium(periodic=400.0))
        self.assertLess(np.abs(box - plane).max(), 1e-3 * np.abs(plane).max())
        self.assertGreater(np.abs(box - plane).max(), 0)

    def test_bad_points_are_refused(self):
        medium = rodwake.Medium()
        for x, y, more, word in (([1, 0], [1, 0], {}, "singular"), ([np.nan], [0], {}, "finite"),
                                 ([1], [1], {"rods": [[0, 0]]}, r"\(N, 3\)"), ([1], [1], {"rods": [[1, 1, 0]]}, "singular")):
            for quantity in self.quantities:
                with self.assertRaisesRegex(rodwake.InputError, word):
                    quantity(x, y, medium, **more)
        with self.assertRaises(ValueError):
            rodwake.strain([1, 2, 3], [1, 2], medium)


if __name__ == "__main__":
    unittest.main()
