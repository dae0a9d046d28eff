"""Tests of the picture of a film, kind snapshot of [tracks]: /usr/bin/python3 tests/plots/test_film_frame.py"""

import json
import unittest

import numpy as np
from matplotlib.collections import EllipseCollection
from matplotlib.patches import Polygon

from made_up_granular import A, write_csv
from plot_case import PlotCase
from rodwake_plots import draw, run_dir, style

SIDES = np.array([24.0, 20.0]) * A


def write_film(folder, window="hull", lengths=(8.0, None), order=True, sizes=(1.0,)):
    """Beads on a lattice with two rods that cross it, the second seen in parts only; lengths in a."""
    place = np.array([(i * 2.1 + 1.05 * (j % 2), j * 1.82) for j in range(11) for i in range(11)]) * A
    border = (place > 3 * A).all(axis=1) & (place < SIDES - 3 * A).all(axis=1)
    psi6 = np.where(border | (window == "periodic"), np.abs(np.sin(place[:, 0] / A)), np.nan) if order else np.full(len(place), np.nan)
    write_csv(folder / "film_frame.csv", {"t": np.ones(len(place)), "x": place[:, 0], "y": place[:, 1], "psi6": psi6, "orientation": psi6 - 0.5,
                                           "radius": A * np.resize(sizes, len(place))})
    t = np.linspace(0, 2, 41)
    x, y = (3 + 8 * t) * A, (6 + 3 * np.sin(2 * t)) * A
    gap = np.where((t > 0.5) & (t < 0.8), np.nan, 1.0)
    write_csv(folder / "rod_tracks.csv", {"t": t, "x0": x, "y0": y, "theta0": np.arctan(0.75 * np.cos(2 * t)), "speed0": 8 * A + 0 * t,
                                          "x1": (20 - 9 * t) * A * gap, "y1": 15 * A * gap + 0 * t, "theta1": np.pi * gap, "speed1": 9 * A * gap})
    rods = [{"number": k, "frames": 41, "known": 41, "from": 0.0, "to": 2.0, "length": each and each * A} for k, each in enumerate(lengths)]
    (folder / "tracks.json").write_text(json.dumps({
        "file": "film.csv", "window": window, "length_unit": "", "rows": 5000, "frames": 41, "particles": 121, "rods": len(rods), "beads_per_frame": 120.0,
        "mean_length": 40.0, "lost_share": 0.01, "interval": 0.05, "duration": 2.0, "area": 480.0, "phi_b": 0.79, "bead_radius": A,
        "box": SIDES.tolist(), "rod_tracks": rods, "left_out": []}))
    (folder / "measure.json").write_text(json.dumps({"units": {"a": A}, "phi_b": 0.79}))
    (folder / "scene.toml").write_text(f'schema = 1\n[tracks]\nfile = "film.csv"\npixel = 1e-4\nbead_radius = {A}\n[measure]\norder = true\n')
    (folder / "provenance.json").write_text('{"version": "0", "status": "finished"}')


class FilmFrameTest(PlotCase):
    def drawn(self, **film):
        write_film(self.folder, **film)
        with run_dir.RunDir(self.folder) as run:
            spec = draw.figures_of(run)[0]
            self.assertEqual((spec.name, spec.kind), ("snapshot", "snapshot"))
            with style.applied(style.SETTINGS):
                made = draw.dressed(draw.KINDS["snapshot"].draw(run, spec), style.look())
            return made, draw.caption(run, spec)

    def test_a_run_of_a_film_has_a_picture(self):
        write_film(self.folder)
        self.assert_drawn("snapshot")
        self.assertIn("The frame of the film with most beads, 121,", (self.folder / "report.html").read_text())

    def test_beads_rods_and_paths(self):
        made, caption = self.drawn()
        axes = made.axes[0]
        grey, coloured = (one for one in axes.collections if isinstance(one, EllipseCollection))
        self.assertEqual(len(grey.get_offsets()) + len(coloured.get_offsets()), 121)
        np.testing.assert_allclose(coloured._widths, 1.0)  # half of the diameter 2 a
        rod, = (one for one in axes.patches if isinstance(one, Polygon))
        self.assertAlmostEqual(max(np.linalg.norm(p - q) for p in rod.get_xy() for q in rod.get_xy()), 8.0, delta=0.3)
        self.assertEqual(sum(len(line.get_xdata()) > 2 for line in axes.lines), 2)
        self.assertIn("as long as their ends are apart", caption)
        self.assertIn("grey beads", caption)

    def test_beads_have_their_own_radii(self):
        made, caption = self.drawn(sizes=(1.0, 1.4))
        drawn = np.concatenate([one._widths for one in made.axes[0].collections if isinstance(one, EllipseCollection)])
        self.assertEqual([np.isclose(drawn, radius).sum() for radius in (1.0, 1.4)], [61, 60])
        self.assertIn("circles are at true size", caption)

    def test_plain_beads_without_order(self):
        made, caption = self.drawn(order=False, lengths=())
        self.assertEqual(len(made.axes), 1)  # no colour bar
        self.assertNotIn("Colour", caption)

    def test_a_periodic_box_is_full(self):
        made, caption = self.drawn(window="periodic")
        self.assertGreater(sum(len(one.get_offsets()) for one in made.axes[0].collections if isinstance(one, EllipseCollection)), 121)
        self.assertNotIn("grey", caption)


if __name__ == "__main__":
    unittest.main()
