"""Tests of the figure of fitted displacement maps: /usr/bin/python3 tests/plots/test_fit_map.py"""

import unittest

import numpy as np
from matplotlib.colors import to_hex

from fit_case import FitCase
from made_up_fit import FOUR
from rodwake_plots import fit_tracks

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
        used = np.any([one["used"] > 0 for one in tables], axis=0)
        self.assertTrue(0 < used.sum() < used.size)
        for row, letter in enumerate("xy"):
            data = np.mean([one[f"U{letter}"] for one in tables], axis=0)  # the bin without data is nan in both
            np.testing.assert_allclose(meshes[3 * row], data, rtol=1e-9, atol=1e-12)
            np.testing.assert_allclose(meshes[3 * row + 2], np.where(used, data - tables[0][f"model_U{letter}"], np.nan), rtol=1e-9, atol=1e-11)
            np.testing.assert_allclose(meshes[3 * row + 1], np.where(used, tables[0][f"model_U{letter}"], np.nan), rtol=1e-9, atol=1e-12)
        self.assertIn("Means of 2 maps", caption)
        self.assertIn("grey there", caption)

    def test_the_scale_is_that_of_what_was_fitted(self):
        made, _ = self.draw("fit_map")
        mesh = made.axes[0].collections[0]
        table = self.table("fit_map_0.csv")
        self.assertLess(mesh.norm.vmax, np.nanmax(table["Ux"]))  # the ridge is above it
        self.assertEqual(mesh.norm.vmin, -mesh.norm.vmax)

    def test_the_mask_is_outlined_and_grey_in_the_fit(self):
        made, _ = self.draw("fit_map")
        for axes in made.axes[:3]:
            self.assertTrue(axes.collections[1:])
            self.assertEqual(to_hex(axes.get_facecolor()), fit_tracks.MASKED)
        data, fitted = (np.ma.getmaskarray(axes.collections[0].get_array()).sum() for axes in made.axes[:2])
        self.assertGreater(fitted, data)  # the data inside the mask are shown

    def test_report(self):
        page = self.words_of_page()
        for part in ("orthotropic medium outside the mask", "Errors by source", "Jackknife over runs", "0.054", "run 1"):
            self.assertIn(part, page)

    def test_wrong_input(self):
        (self.folder / "fit_map_0.csv").write_text("x,y\n0,0\n")
        self.fails("fit_map_0.csv", "column Ux", kind="fit_map")
        self.build(profiles=FOUR[:1], maps=0)
        self.fails("no maps", "kind fit", kind="fit_map")


if __name__ == "__main__":
    unittest.main()
