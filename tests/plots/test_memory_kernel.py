"""Tests of the figure of the memory kernel, on made-up results: /usr/bin/python3 tests/plots/test_memory_kernel.py"""

import unittest

import numpy as np

from made_up_granular import SCENE
from made_up_measured import variants, write_measured
from plot_case import PlotCase
from rodwake_plots import bead_motion, bed_run, draw, run_dir

FIGURE = '[[figures]]\nname = "fig"\nkind = "memory_kernel"\n'


class MemoryKernelTest(PlotCase):
    def setUp(self):
        super().setUp()
        write_measured(self.folder, (0.8, 0.7), rods=0)
        (self.folder / "scene.toml").write_text(SCENE + variants(["v1"]) + FIGURE)

    def draw(self):
        with run_dir.RunDir(self.folder) as run:
            spec = draw.figures_of(run)[0]
            return draw.KINDS["memory_kernel"].draw(run, spec), draw.caption(run, spec)

    def line(self, drawn, label):
        return next(line for line in drawn.axes[0].lines if line.get_label().startswith(label))

    def test_kernels_within_their_range_and_the_stiffness(self):
        drawn, caption = self.draw()
        for part, label, column in ((bed_run.Part("", "", self.folder), "$\\phi_b", "kernel"),
                                    (bed_run.Part("", "", self.folder / "variants/v1"), "v1", "with_drag")):
            s, value = part.table("memory_kernel.csv", "s", column)
            kept = (s >= 0.1) & (s <= 100)
            self.assertTrue(0 < kept.sum() < s.size)
            np.testing.assert_array_equal(self.line(drawn, label).get_xydata(), np.column_stack([s, value])[kept])
            dashed = [line for line in drawn.axes[0].lines if line.get_linestyle() == "--" and len(line.get_xdata()) == 2]
            self.assertIn(part.estimate("microrheology", "spring").value, [line.get_ydata()[0] for line in dashed])
        s, inertia = self.line(drawn, "$m s^2$").get_data()
        np.testing.assert_allclose(inertia, 2.1e-6 * s**2, rtol=1e-9)  # differences of numbers 1e6 times as large
        self.assertIn("with <i>Γs</i> where no drag", caption)
        self.assertIn("3.20 ± 0.10 µN/m", caption)

    def spoil(self, parts):
        for part in parts:
            path = self.folder / part / "measure.json"
            path.write_text(path.read_text().replace('"kernel_low": 0.1', '"kernel_low": null'))

    def test_a_part_without_range_is_left_out_and_named(self):
        self.spoil(["variants/v1"])
        drawn, caption = self.draw()
        self.assertFalse([line for line in drawn.axes[0].lines if line.get_label().startswith("v1")])
        self.line(drawn, "$\\phi_b")
        self.assertIn("v1: too short", caption)

    def test_a_range_is_needed(self):
        self.spoil([".", "variants/v1"])
        self.assert_fails('figure "fig"', "memory_kernel.csv", "good to 2 % at no s")

    def test_a_figure_that_cannot_be_drawn_stops_no_other(self):
        self.spoil([".", "variants/v1"])
        (self.folder / "scene.toml").write_text(SCENE + variants(["v1"]) + FIGURE + FIGURE.replace("fig\"", "second\"").replace("memory_kernel", "msd"))
        self.assert_fails('figure "fig"', "good to 2 % at no s")
        self.assertEqual([path.name for path in (self.folder / "figures").iterdir()], ["second.png"])
        self.assertIn("second", (self.folder / "report.html").read_text())

    def test_kernels_below_zero_cannot_be_drawn(self):
        for part in (".", "variants/v1"):
            (self.folder / part / "memory_kernel.csv").write_text("s,total,total_error,bias,with_drag,kernel,kernel_error\n1,1,1,1,-1,-2,1\n")
        self.assert_fails('figure "fig"', "memory_kernel.csv", "no kernel > 0")


if __name__ == "__main__":
    unittest.main()
