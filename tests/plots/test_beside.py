"""Tests of figures with the bed beside the theory, on made-up results: /usr/bin/python3 tests/plots/test_beside.py"""

import shutil
import unittest

import h5py
import numpy as np

from made_up_fit import write_fit
from made_up_granular import SCENE
from made_up_measured import write_measured
from made_up_result import write_result
from plot_case import PlotCase
from rodwake_plots import displacement, draw, run_dir, style

FIGURE = '[[figures]]\nname = "fig"\nkind = "theory_beside_bed"\n'


class BesideTest(PlotCase):
    def build(self):
        shutil.rmtree(self.folder)
        self.folder.mkdir()
        write_measured(self.folder)
        write_result(self.folder)
        self.edit(lambda file: file.pop("rods"))
        (self.folder / "scene.toml").write_text(SCENE + FIGURE)

    def edit(self, change):
        with h5py.File(self.folder / "result.h5", "r+") as file:
            change(file)

    def add_cut(self, number, at, factor=1.0):
        def add(file):
            file.copy("field/cuts/0", f"field/cuts/{number}")
            file[f"field/cuts/{number}"].attrs["at"] = at
            file[f"field/cuts/{number}/s"][...] *= factor
        self.edit(add)

    def draw(self):
        with run_dir.RunDir(self.folder) as run:
            spec = draw.figures_of(run)[0]
            return displacement.draw_theory_beside_bed(run, spec), displacement.caption_theory_beside_bed(run, spec)

    def test_a_row_a_component(self):
        self.add_cut(1, 1.8)
        made, caption = self.draw()
        self.assertEqual([axes.get_title(loc="left") for axes in made.axes], [f"({letter})" for letter in "abcdef"])
        self.assertEqual([axes.get_title() for axes in made.axes[:2]], ["bed, periodic box", "theory, infinite plane"])
        self.assertEqual([axes.get_ylabel()[:4] for axes in made.axes], ["$U_x", "$U_x", "$U_y", "$U_y", "$|x|", "$|x|"])
        self.assertIn("Right, theory: Displacement", caption)
        self.assertIn("Below: <i>U<sub>y</sub></i> beside the rod, and |<i>x</i>|", caption)

    def test_the_tail_is_seen_from_farthest(self):
        self.add_cut(1, 0.0, factor=3.0)
        ends = [axes.get_xlim()[0] for axes in self.draw()[0].axes]
        self.assertEqual((ends[1], ends[3]), (-20.0, -60.0))

    def test_only_what_both_have(self):
        made, caption = self.draw()
        self.assertEqual(len(made.axes), 4)  # no cut beside the rod: no U_y
        self.assertIn("Below: |<i>x</i>|", caption)
        self.edit(lambda file: file.pop("field/cuts"))
        self.assert_fails("no line along x both measured", "[[field.cuts]]")


class FittedProfileTest(PlotCase):
    def build(self):
        shutil.rmtree(self.folder)
        self.folder.mkdir()
        write_measured(self.folder)

    def draw(self):
        (self.folder / "scene.toml").write_text(SCENE + FIGURE.replace("theory_beside_bed", "profile"))
        with run_dir.RunDir(self.folder) as run:
            spec = draw.figures_of(run)[0]
            return displacement.draw_profile(run, spec), draw.caption(run, spec)

    def test_theory_beside_the_profile_it_was_fitted_to(self):
        _, caption = self.draw()
        self.assertNotIn("theory", caption)
        write_fit(self.folder)
        made, caption = self.draw()
        curve = max(made.axes[0].lines, key=lambda line: len(line.get_xdata()) if line.get_color() == style.OTHERS[0] else 0)
        given = np.genfromtxt(self.folder / "fit_curve_0.csv", delimiter=",", names=True)
        x, y = curve.get_data()
        np.testing.assert_allclose(np.interp(20.0, x, y), np.interp(20.0, given["x"], given["model"]), rtol=1e-9)  # digits of the file
        self.assertEqual(made.axes[0].get_legend().get_texts()[-1].get_text(), "theory, fitted")
        self.assertIn("theory fitted to it", caption)


if __name__ == "__main__":
    unittest.main()
