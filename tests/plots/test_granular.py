"""Tests of the figures of granular runs, on made-up results: /usr/bin/python3 tests/plots/test_granular.py"""

import json
import os
import shutil
import unittest
from types import SimpleNamespace
from unittest import mock

import h5py
import numpy as np
from PIL import Image

from made_up_granular import A, Bed, lattice, rod_spheres, write_granular
from made_up_result import LINE, write_result
from plot_case import PlotCase
from rodwake_plots import bed, draw, frames, granular_table, rod_tracks, run_dir

SMALL = dict(columns=14, rows=16)
KINDS = ("snapshot", "rod_tracks", "side_view", "granular_table")
EPS = np.finfo(float).eps


def figure(kind, **keys):
    return f'[[figures]]\nname = "fig"\nkind = "{kind}"\n' + "".join(f"{key} = {json.dumps(value)}\n" for key, value in keys.items())


class LocalOrderTest(unittest.TestCase):
    """Sixth powers of unit vectors: some 20 roundings a bond, so 100 eps; 1e-12 is what is asked for."""

    def test_perfect_lattice(self):
        for columns, rows in ((30, 34), (12, 14), (4, 4)):  # the last has too few cells: every pair is looked at
            points, box = lattice(columns, rows)
            order = frames.psi6(points, box, 1.4 * 2.12 * A)
            np.testing.assert_allclose(order, 1, rtol=0, atol=1e-12)

    def test_turned_lattice_and_square(self):
        points, box = lattice(12, 14)
        np.testing.assert_allclose(frames.psi6(points[:, ::-1], box[::-1], 1.4 * 2.12 * A), -1, atol=1e-12)
        square = np.stack(np.meshgrid(np.arange(12.0), np.arange(12.0)), axis=-1).reshape(-1, 2)
        np.testing.assert_allclose(frames.psi6(square, np.full(2, 12.0), 1.2), 0, atol=1e-12)

    def test_cells_find_what_pairs_find(self):
        points = np.random.default_rng(3).uniform(-1, 2, (300, 2))
        box = np.array([1.0, 1.3])
        for cutoff in (0.07, 0.3, 0.6):
            away = points[None] - points[:, None]
            away -= box * np.round(away / box)
            distance = np.hypot(*np.moveaxis(away, -1, 0)) + 9 * np.eye(300)
            near = distance < cutoff
            bond = np.where(near, np.exp(6j * np.arctan2(away[..., 1], away[..., 0])), 0)
            wanted = bond.sum(axis=1) / np.maximum(near.sum(axis=1), 1)
            np.testing.assert_allclose(frames.psi6(points, box, cutoff), wanted, rtol=0, atol=1e-12)

    def test_no_neighbours(self):
        self.assertEqual(list(frames.psi6(np.array([[0.1, 0.1], [0.1, 0.1]]), np.ones(2), 0.2)), [0, 0])
        self.assertEqual(frames.psi6(np.empty((0, 2)), np.ones(2), 0.2).size, 0)


class PeriodicTest(unittest.TestCase):
    BOX = np.array([1.0, 2.0])

    def assert_no_line_across(self, path):
        step = np.abs(np.diff(path, axis=0))
        self.assertFalse(np.any(step > 0.5 * self.BOX), path)

    def test_a_line_across_is_seen(self):
        x = np.linspace(0.5, 2.6, 20)
        with self.assertRaises(AssertionError):
            self.assert_no_line_across(np.stack([x % 1, 0 * x], axis=-1))

    def test_no_line_across_the_box(self):
        s = np.linspace(0, 1, 50)
        for x, y in ((0.5 + 2.1 * s, 0.3 + 0 * s), (0.2 - 5 * s, 1.9 + 3 * s), (np.sin(9 * s), np.cos(7 * s)), (1.0 * s, 2.0 * s)):
            path = frames.wrapped_path(x, y, self.BOX)
            self.assert_no_line_across(path)
            inside = path[np.isfinite(path[:, 0])]
            self.assertTrue(np.all(inside >= -8 * EPS) and np.all(inside <= self.BOX * (1 + 8 * EPS)))
            length = np.hypot(np.diff(x), np.diff(y)).sum()
            self.assertAlmostEqual(np.nansum(np.hypot(*np.diff(path, axis=0).T)), length, delta=1e-12 * length)

    def test_paths_reach_the_edge(self):
        path = frames.wrapped_path(np.array([0.9, 1.2]), np.array([0.5, 0.5]), self.BOX)
        np.testing.assert_allclose(path, [[0.9, 0.5], [1, 0.5], [np.nan] * 2, [0, 0.5], [0.2, 0.5]], atol=4 * EPS)
        self.assertEqual(len(frames.wrapped_path(np.array([1.5]), np.array([0.5]), self.BOX)), 1)
        self.assertEqual(len(frames.wrapped_path(np.array([]), np.array([]), self.BOX)), 0)

    def test_images(self):
        window = ((0, 1), (0, 2))
        for point, count in (((0.5, 1.0), 1), ((0.02, 1.0), 2), ((0.99, 1.99), 4)):
            shown, index = frames.with_images(np.array([point]), np.array([0.05]), self.BOX, window)
            self.assertEqual((len(shown), list(index)), (count, [0] * count))
        self.assertEqual(len(frames.with_images(np.array([[0.5, 1.0]]), np.array([0.05]), self.BOX, ((0, 3), (-2, 2)))[0]), 6)


class CurvesTest(unittest.TestCase):
    def test_rate_smooth_and_mean(self):
        t = np.array([0.0, 1.0, 3.0, 4.0])
        np.testing.assert_allclose(granular_table.rate(t, 5 * t + 7)[1], 5, rtol=4 * EPS)
        np.testing.assert_allclose(rod_tracks.smooth(np.full(200, 3.0)), 3, rtol=100 * EPS)
        x, mean, error = rod_tracks.mean_curve([(t, t), (2 * t, 6 * t)])
        self.assertEqual(x[-1], 4)
        np.testing.assert_allclose(mean, 2 * x, atol=1e-12)
        np.testing.assert_allclose(error, x, atol=1e-12)  # of x and 3 x: half their difference

    def test_bodies(self):
        half = np.sqrt(0.5)
        np.testing.assert_allclose(frames.body_axis(np.array([[1, 0, 0, 0], [half, 0, 0, half], [half, 0, -half, 0]])),
                                   [[1, 0, 0], [0, 1, 0], [0, 0, 1]], atol=4 * EPS)
        spheres = np.array([[0.95, 0.5, 0.1], [0.05, 0.5, 0.1]])
        np.testing.assert_allclose(frames.whole(spheres, np.array([3.0, 0.5, 0.1]), np.ones(2))[:, 0], [-0.05, 0.05], atol=8 * EPS)

    def test_ends_of_rods(self):
        for polar in (True, False):
            offset, radius = rod_spheres(polar)
            rod = frames.Rod(np.array([0.0, 1, 0]), np.outer(offset, [0, 1, 0]), radius)
            self.assertEqual(rod.tapers, polar)
            self.assertAlmostEqual(rod.tip[1], offset[-1] + radius[-1], delta=4 * EPS)


class GranularPlotsTest(PlotCase):
    def build(self, **keys):
        write_granular(self.folder, **({"frames": 3} | SMALL | keys))

    def test_every_kind(self):
        self.assert_drawn(*KINDS)

    def test_ensemble_and_one_rod(self):
        shutil.rmtree(self.folder)
        self.folder.mkdir()
        self.build(runs=3, rods=1)
        self.assert_drawn(*KINDS)
        with run_dir.RunDir(self.folder) as run:
            self.assertIn("Run 1 of 3.", draw.caption(run, draw.figures_of(run)[0]))

    def test_beads_alone_and_rods_alone(self):
        self.build(rods=0)
        self.assert_drawn("snapshot", "side_view", "granular_table")
        self.build(rods=1, polar=False, beads=False)
        self.assert_drawn(*KINDS)

    def test_with_a_result_of_the_theory(self):
        write_result(self.folder)
        (self.folder / "outcome.json").write_text(json.dumps({"outcome": "contact", "time": 1.0, "min_separation": 0.1, "pair": [0, 1]}))
        self.assert_drawn(*KINDS, "trajectories", "extensional_axis", "polar_streamlines", "cut0_Ux")

    def test_options(self):
        for keys in (dict(frame=0), dict(frame=-3), dict(colour="orientation"), dict(x=[0.005, 0.02], y=[-0.002, 0.004])):
            self.build(figures=figure("snapshot", **keys))
            self.assert_drawn("fig")
        self.build(figures=figure("side_view", x=[0.0, 0.01], y=[0.001, 0.002], title="Side"))
        self.assert_drawn("fig")

    def specs(self, run, kind):
        return next(spec for spec in draw.figures_of(run) if spec.kind == kind)

    def test_beads_are_drawn_at_true_size(self):
        with run_dir.RunDir(self.folder) as run:
            beads = bed.draw_snapshot(run, self.specs(run, "snapshot")).axes[0].collections[0]
            self.assertGreaterEqual(len(beads.get_offsets()), run.granular.summary["beads"])
            np.testing.assert_allclose(beads._widths, 2 * 0.5, rtol=4 * EPS)  # half widths of circles of radius 1 a

    def test_rod_paths_have_no_line_across(self):
        with run_dir.RunDir(self.folder) as run:
            box = run.granular.box / run.granular.a
            lines = rod_tracks.draw_rod_tracks(run, self.specs(run, "rod_tracks")).axes[0].lines
            self.assertEqual(len(lines), 2)
            for line in lines:
                path = line.get_xydata()
                self.assertTrue(np.isnan(path).any())  # these paths do leave the box
                self.assertFalse(np.any(np.abs(np.diff(path, axis=0)) > 0.5 * box))

    def test_the_panel_of_paths_is_where_the_paths_are(self):
        granular = SimpleNamespace(a=1.0, sides=np.array([78.0, 78.0]))
        across = SimpleNamespace(x=np.array([[20.0, 60.0], [40.0, 130.0]]), y=np.array([[31.0, 47.0], [32.0, 46.0]]))
        self.assertEqual(rod_tracks.window_of([across], granular), ((0.0, 78.0), (23.0, 55.0)))
        self.assertEqual(rod_tracks.window_of([SimpleNamespace(x=across.x, y=across.x)], granular), ((0.0, 78.0), (0.0, 78.0)))
        self.assertEqual(sorted(rod_tracks.layout(32 / 78, True)[1]), ["box", "first"])

    def test_plates_move(self):
        with run_dir.RunDir(self.folder) as run, run.granular.trajectory("last_period.h5md") as trajectory:
            plates = bed.Plates(trajectory, A)
            times = [trajectory.frame(at).time for at in bed.phases(trajectory.frames)]
        self.assertEqual(len(times), bed.PHASES)
        for turn, time in enumerate(times):
            self.assertAlmostEqual(plates.phase(time), turn / 5, delta=1e-6)  # 1e-9 to be 0 at whole periods; times near 10 s
            self.assertAlmostEqual(plates.floor(time), plates.amplitude * np.cos(2 * np.pi * turn / 5), delta=1e-6)

    def test_report(self):
        self.assertEqual(self.plot().returncode, 0)
        page = (self.folder / "report.html").read_text()
        self.assertNotRegex(page, "https?:")
        for part in ("Granular bed", "bead with plate", "mean speed", "mm/s", "1.2 mm", "state hash", "200 Hz", "Rods in a bed"):
            self.assertIn(part, page)

    def test_missing_files_are_named(self):
        for kind, name in (("snapshot", "trajectory.h5md"), ("movie", "trajectory.h5md"), ("side_view", "last_period.h5md"),
                           ("rod_tracks", "tracks.csv"), ("granular_table", "table.csv")):
            self.build(figures=figure(kind))
            (self.folder / name).unlink()
            self.assert_fails('figure "fig"', name, "no such file")
        (self.folder / "summary.json").unlink()
        self.assert_fails("result.h5", "no such file")
        write_result(self.folder)
        (self.folder / "outcome.json").write_text("{}")
        self.assert_fails("summary.json", "holds no beads")
        (self.folder / "provenance.json").write_text('{"status": "interrupted"}')
        self.assert_fails("summary.json", "is interrupted", "resumes it")

    def test_theory_figures_need_a_result(self):
        self.build(figures=LINE)
        self.assert_fails("result.h5", "no such file")

    def test_nothing_to_draw(self):
        for name in ("trajectory.h5md", "last_period.h5md", "tracks.csv", "table.csv"):
            (self.folder / name).unlink()
        self.assert_fails("nothing to draw")

    def edit(self, change):
        with h5py.File(self.folder / "trajectory.h5md", "r+") as file:
            change(file)

    def test_wrong_trajectories(self):
        self.build(frames=0)
        self.assert_fails("trajectory.h5md", "0 frames", "nothing to draw")
        for place in ("particles/trajectory/radius", "particles/trajectory/box", "parameters/rod_of_sphere",
                      "particles/trajectory_rods/orientation"):
            self.build(figures=figure("snapshot"))
            self.edit(lambda file: file.pop(place))
            self.assert_fails("trajectory.h5md", place, "missing")
        self.build(figures=figure("snapshot"))
        self.edit(lambda file: file["parameters"].attrs.pop("order_cutoff"))
        self.assert_fails("trajectory.h5md", "parameters/order_cutoff", "missing")
        self.build(figures=figure("snapshot", frame=3))
        self.assert_fails("frames 0 to 2", "frame 3")
        (self.folder / "trajectory.h5md").write_bytes(b"not hdf5")
        self.assert_fails("trajectory.h5md", "HDF5")

    def test_other_legal_forms(self):
        """Parameters as datasets, box edges as three lengths."""
        def change(file):
            file["parameters/order_cutoff"] = file["parameters"].attrs.pop("order_cutoff")
            edges = file["particles/trajectory/box/edges"]
            matrices = edges.pop("value")[()]
            edges["value"] = np.diagonal(matrices, axis1=1, axis2=2)
        with run_dir.RunDir(self.folder) as run, run.granular.trajectory("trajectory.h5md") as trajectory:
            before = trajectory.frame(-1)
        self.edit(change)
        with run_dir.RunDir(self.folder) as run, run.granular.trajectory("trajectory.h5md") as trajectory:
            self.assertEqual(list(before.box), list(trajectory.frame(-1).box))
            self.assertEqual(trajectory.parameter("order_cutoff"), 3 * A)

    def test_wrong_tables(self):
        table, tracks = self.folder / "table.csv", self.folder / "tracks.csv"
        self.build(figures=figure("granular_table"))
        for text, words in (("t,energy\n0,1\n", ("column ", "is missing")), ("t,energy\n", ("no rows",)), ("t,energy\n0,x\n", ("numbers",)),
                            ("t,energy\n0\n", ("2 names", "1 values")), ("", ("column t",))):
            table.write_text(text)
            self.assert_fails("table.csv", *words)
        self.build(figures=figure("rod_tracks"))
        for text, words in (("t\n0\n", ("no rods",)), ("t,x0,y0,theta0,speed0\n-1,0,0,0,0\n", ("no rows", "t = 0")),
                            ("t,x0,y0\n0,0,0\n", ("column theta0",))):
            tracks.write_text(text)
            self.assert_fails("tracks.csv", *words)

    def test_one_row_tables(self):
        for name in ("table.csv", "tracks.csv"):
            lines = (self.folder / name).read_text().splitlines()
            (self.folder / name).write_text("\n".join([lines[0], lines[-1]]) + "\n")
        self.assert_drawn(*KINDS)

    def test_wrong_summary_and_keys(self):
        for keys, words in ((dict(colour="red"), ("red", "orientation")), (dict(frame=1.5), ("frame", "1.5"))):
            self.build(figures=figure("snapshot", **keys))
            self.assert_fails(*words)
        self.build(figures=figure("movie", fps=0))
        self.assert_fails("fps", "0")
        self.build(figures=figure("snapshot"))
        for text, words in (("{", ("JSON",)), ("[]", ("object",)), ("{}", ("bead_radius", "missing")),
                            ('{"bead_radius": "x"}', ("bead_radius", "not as rodwake writes it"))):
            (self.folder / "summary.json").write_text(text)
            self.assert_fails("summary.json", *words)


class FilmTest(PlotCase):
    FRAMES = 4

    def build(self):
        write_granular(self.folder, rods=1, frames=self.FRAMES, figures=figure("movie", fps=10), **SMALL)

    def film(self, ending):
        done = self.plot()
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        self.assertEqual([line.rsplit("/", 1)[-1] for line in done.stdout.split()], [f"fig{ending}", "fig.png", "report.html"])
        self.assertEqual(sorted(path.name for path in (self.folder / "figures").iterdir()), sorted([f"fig{ending}", "fig.png"]))
        return self.folder / "figures" / f"fig{ending}"

    def test_gif_without_ffmpeg(self):
        with mock.patch("shutil.which", return_value=None):
            path = self.film(".gif")
        with Image.open(path) as film:
            self.assertEqual((film.n_frames, film.info["duration"]), (self.FRAMES, 100))
        self.assertIn("data:image/gif;base64,", (self.folder / "report.html").read_text())

    @unittest.skipUnless(shutil.which("ffmpeg"), "needs ffmpeg")
    def test_mp4(self):
        self.assertEqual(self.film(".mp4").read_bytes()[4:8], b"ftyp")
        self.assertIn("<video", (self.folder / "report.html").read_text())

    def test_ffmpeg_that_fails_is_quoted(self):
        program = self.folder / "bin" / "ffmpeg"
        program.parent.mkdir()
        program.write_text("#!/bin/sh\necho no such encoder >&2\nexit 3\n")
        program.chmod(0o755)
        with mock.patch.dict(os.environ, PATH=f"{program.parent}:{os.environ['PATH']}"):
            self.assert_fails("ffmpeg", "no such encoder")
        self.assertEqual(list((self.folder / "figures").iterdir()), [])


class MadeUpTest(unittest.TestCase):
    def test_rods_keep_clear_of_beads(self):
        bed = Bed(rods=1)
        self.assertLess(bed.free(bed.beads_at(), *bed.rods_at(0.0)).sum(), len(bed.points))


if __name__ == "__main__":
    unittest.main()
