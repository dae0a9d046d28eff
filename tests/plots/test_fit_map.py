"""Tests of the figure of fitted displacement maps: /usr/bin/python3 tests/plots/test_fit_map.py"""

import unittest

import numpy as np

from fit_case import FitCase
from made_up_fit import FOUR

ERRORS = {"amplitude": {"value": 0.85, "curvature": 0.02, "held": 0.03, "masks": 0.04, "jackknife": None, "total": 0.0539}}


class MapsTest(FitCase):
    KEYS = dict(profiles=(), maps=2, names=("amplitude", "p_yy"), number_of_starts=1, likelihoods=(), derived={}, core=0.0, compare=0,
                systematics={"errors": ERRORS})

    def test_data_model_and_residual_of_both_components(self):
        self.assert_drawn("fit_map", "fit_correlation")
        made, caption = self.draw("fit_map")
        panels = [axes for axes in made.axes if axes.collections and axes.get_aspect() == 1]
        self.assertEqual(len(panels), 6)
        meshes = [np.ma.filled(axes.collections[0].get_array().astype(float), np.nan).ravel() for axes in panels]
        tables = [self.table(f"fit_map_{index}.csv") for index in range(2)]
        for row, letter in enumerate("xy"):
            data = np.mean([one[f"U{letter}"] for one in tables], axis=0)  # the bin without data is nan in both
            np.testing.assert_allclose(meshes[3 * row], data, rtol=1e-9, atol=1e-12)
            np.testing.assert_allclose(meshes[3 * row + 2], data - tables[0][f"model_U{letter}"], rtol=1e-9, atol=1e-11)
        self.assertIn("Means of 2 maps", caption)
        self.assertIn("Hatched", caption)

    def test_the_scale_is_that_of_what_was_fitted(self):
        made, _ = self.draw("fit_map")
        mesh = made.axes[0].collections[0]
        table = self.table("fit_map_0.csv")
        self.assertLess(mesh.norm.vmax, np.nanmax(table["Ux"]))  # the ridge is above it
        self.assertEqual(mesh.norm.vmin, -mesh.norm.vmax)

    def test_the_mask_is_hatched(self):
        made, _ = self.draw("fit_map")
        hatches = [one for axes in made.axes[:1] for one in axes.collections[1:]]
        self.assertTrue(hatches)

    def test_report(self):
        page = self.words_of_page()
        for part in ("orthotropic medium outside the mask", "Errors by their cause", "Jackknife over runs", "0.054", "run 1"):
            self.assertIn(part, page)

    def test_wrong_input(self):
        (self.folder / "fit_map_0.csv").write_text("x,y\n0,0\n")
        self.fails("fit_map_0.csv", "column Ux", kind="fit_map")
        self.build(profiles=FOUR[:1], maps=0)
        self.fails("no maps", "kind fit", kind="fit_map")


if __name__ == "__main__":
    unittest.main()
