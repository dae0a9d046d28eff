"""Tests of the theory's figures on a small made-up result: /usr/bin/python3 tests/plots/test_theory.py"""

import json
import re
import subprocess
import sys
import unittest
from unittest import mock

import h5py
import numpy as np

from made_up_result import ALL_KINDS, LINE, PATHS, SCENE, write_result
from plot_case import PROGRAM, PlotCase
from rodwake_plots import draw, field, run_dir, sections, trajectories


class PlotsTest(PlotCase):
    def build(self, figures=ALL_KINDS, **result):
        (self.folder / "scene.toml").write_text(SCENE + figures)
        outcome = {"outcome": "contact", "time": 40.5953, "min_separation": 0.1, "pair": [0, 1], "solver": {"steps": 321}}
        (self.folder / "outcome.json").write_text(json.dumps(outcome))
        (self.folder / "provenance.json").write_text(json.dumps({"version": "0.1.0", "libraries": {"HDF5": "1.10"}}))
        write_result(self.folder, **result)

    def edit(self, change):
        with h5py.File(self.folder / "result.h5", "r+") as file:
            change(file)

    def test_as_a_program(self):
        done = subprocess.run([sys.executable, PROGRAM, self.folder / "nowhere"], capture_output=True, text=True)
        self.assertEqual((done.returncode, done.stdout), (1, ""))
        self.assertRegex(done.stderr, r"\Arodwake plot: .*nowhere: no such run directory\n\Z")

    def test_a_listing_that_nobody_reads_to_its_end(self):
        """`rodwake plot RUN | head -1`: every figure is made, nothing is said."""
        self.build(figures=LINE + PATHS)
        with subprocess.Popen([sys.executable, PROGRAM, self.folder], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as program:
            self.assertTrue(program.stdout.readline().endswith("line.png\n"))
            program.stdout.close()
            self.assertEqual((program.stderr.read(), program.wait()), ("", 0))
        self.assertEqual(sorted(path.name for path in self.folder.glob("figures/*")), ["line.png", "paths.png"])
        self.assertTrue((self.folder / "report.html").is_file())

    def test_every_kind(self):
        self.assert_drawn("axis", "streams", "line", "scaled", "paths")

    def test_defaults_without_figures_and_variants_in_si(self):
        self.build(figures="", variants=2, units="si")
        self.assert_drawn("trajectories", "extensional_axis", "polar_streamlines", "cut0_Ux")

    def test_field_alone_needs_no_outcome(self):
        self.edit(lambda file: file.pop("rods"))
        (self.folder / "scene.toml").write_text('title = "field"\n')
        (self.folder / "outcome.json").unlink()
        self.assert_drawn("extensional_axis", "polar_streamlines", "cut0_Ux")

    def test_pdf_and_report_only(self):
        self.build(figures=LINE)
        self.assertEqual(self.plot("--pdf").returncode, 0)
        self.assertTrue((self.folder / "figures/line.pdf").read_bytes().startswith(b"%PDF"))
        (self.folder / "report.html").unlink()
        before = (self.folder / "figures/line.png").stat().st_mtime_ns
        self.assertEqual(self.plot("--report-only").returncode, 0)
        self.assertEqual(before, (self.folder / "figures/line.png").stat().st_mtime_ns)
        self.assertTrue((self.folder / "report.html").is_file())

    def test_report_is_self_contained(self):
        self.build(figures=LINE + PATHS)
        self.assertEqual(self.plot().returncode, 0)
        page = (self.folder / "report.html").read_text()
        self.assertNotRegex(page, "https?:")
        self.assertNotIn("<script", page)
        self.assertEqual(re.findall(r'src="([^"]{0,22})', page), ["data:image/png;base64,"] * 2)
        for link in re.findall(r'href="([^"]*)"', page):  # into the page, or to a file beside it
            there = f'id="{link[1:]}"' in page if link.startswith("#") else (self.folder / link).is_file()
            self.assertTrue(there, link)
        for part in ("Rods &amp; &lt;wakes&gt;", "40.5953", "rods 0 and 1", "321", "HDF5", "[[figures]]"):
            self.assertIn(part, page)

    def test_a_cut_shows_the_data_and_no_level_drawn_from_it(self):
        with run_dir.RunDir(self.folder) as run:
            specs = [spec for spec in draw.figures_of(run) if spec.kind == "cut"]
            self.assertEqual([spec.sqrt_scaled for spec in specs], [False, True])
            for spec in specs:
                zero, curve, *tail, rod = field.draw_cut(run, spec).axes[0].lines
                self.assertEqual([len(line.get_xdata()) > 2 for line in (zero, curve, rod)], [False, True, False], spec.name)
                self.assertEqual(len(tail), spec.sqrt_scaled)
                for line in tail:  # of Eq. 16 with xi = 1, not of the data, which are level at 1
                    np.testing.assert_allclose(line.get_ydata(), 0.5 / np.sqrt(np.pi), rtol=1e-12)
                    self.assertLess(line.get_xdata().max(), 0)

    def test_samples_of_a_measured_field_are_thin_lines(self):
        def thin(run):
            spec = next(spec for spec in draw.figures_of(run) if spec.kind == "trajectories")
            lines = trajectories.draw(run, spec).axes[0].lines
            return [line for line in lines if len(line.get_xdata()) == 51], trajectories.caption(run, spec)

        with run_dir.RunDir(self.folder) as run:
            lines, caption = thin(run)
            self.assertEqual(len(lines), 0)
            self.assertNotIn("draws", caption)

        def add(file):
            place = file["rods/scene"]
            for name in "xy":
                samples = np.stack([place[name][()] + shift for shift in (0.0, 0.1, 0.2)])
                samples[2, 30:] = np.nan  # ended early
                place[f"ensemble/{name}"] = samples
        self.edit(add)
        with run_dir.RunDir(self.folder) as run:
            lines, caption = thin(run)
            self.assertEqual(len(lines), 6)  # three of each rod
            self.assertEqual(sum(np.isnan(line.get_ydata()).any() for line in lines), 2)
            self.assertIn("drawn from the errors of the measured field", caption)

    def test_the_report_explains_the_keys_of_a_resolved_scene(self):
        values = {"rods_run": {"output_interval": 0.25, "form": "angle"}, "medium": {"field": "exact"}}
        rows = {row[0]: row for *_, rows in sections.scene_tables(values, sections.KeyLabels("si")) for row in rows}
        self.assertEqual(rows["<code>output_interval</code>"][2], "0.25 s")
        for key in ("output_interval", "form", "field"):
            self.assertTrue(rows[f"<code>{key}</code>"][3], key)

    def test_a_figure_whose_data_are_not_there_is_left_out(self):
        """A stage that was not run takes the figures of the others with it no more; a part that is lost is an error all the same."""
        for kind, change, expected in (("snapshot", None, "summary.json"), ("fit", None, "fit.json"), ("trajectories", lambda file: file.pop("rods"), "/rods"),
                                   ("extensional_axis", lambda file: file["field"].pop("grid"), "/field/grid")):
            self.build(figures=LINE + f'[[figures]]\nname = "lone"\nkind = "{kind}"\n')
            change and self.edit(change)
            done = self.plot()
            self.assertEqual((done.returncode, done.stderr.count("\n")), (0, 1), done.stderr)
            self.assertRegex(done.stderr, f'left out: figure "lone": .*{expected}')
            self.assertNotIn("lone.png", done.stdout)
            self.assertIn("line.png", (self.folder / "report.html").read_text())

    def test_variants_in_one_panel(self):
        self.build(figures=PATHS, variants=2)
        with run_dir.RunDir(self.folder) as run:
            apart, together = (draw.figures_of(run, overlay=overlay)[0] for overlay in (False, True))
            panels, one = trajectories.draw(run, apart), trajectories.draw(run, together)
            caption = trajectories.caption(run, together)
        self.assertGreaterEqual(len(panels.axes), 3)
        self.assertEqual([len(one.axes), len(one.legends[0].get_texts())], [1, 3])
        self.assertEqual(len({line.get_color() for line in one.axes[0].lines if len(line.get_xdata()) > 2}), 3)  # one for both rods of each
        self.assertIn("in one panel", caption)

    def test_missing_parts_are_named(self):
        self.edit(lambda file: file["field/grid"].pop("axis_angle"))
        self.assert_fails("/field/grid/axis_angle", "missing")
        self.build(figures='[[figures]]\nname = "c"\nkind = "cut"\ncut = 7\n')
        self.assert_fails("/field/cuts/7")
        self.edit(lambda file: file.attrs.__delitem__("units"))
        self.assert_fails("units")

    def test_missing_files_are_named(self):
        for name in ("outcome.json", "scene.toml", "result.h5"):
            self.build()
            (self.folder / name).unlink()
            self.assert_fails(name)

    def test_wrong_input(self):
        self.edit(lambda file: file.attrs.__setitem__("schema", 2))
        self.assert_fails("schema 2")
        self.build(figures='[[figures]]\nname = "a"\nkind = "pie"\n')
        self.assert_fails("pie", "trajectories")
        self.build(figures='[[figures]]\nname = "../a"\nkind = "cut"\n')
        self.assert_fails("../a")
        (self.folder / "result.h5").write_bytes(b"not hdf5")
        self.assert_fails("HDF5")



NOISE = """
[[figures]]
name = "noise"
kind = "noise"
"""


class NoiseTest(PlotCase):
    """Rods that diffuse."""

    build = PlotsTest.build

    def write_noise(self, folder, **changed):
        folder.mkdir(parents=True, exist_ok=True)
        both = lambda value: [value, value]
        means = {"runs": 4, "capture_probability": 0.5, "capture_low": 0.15, "capture_high": 0.85, "endings": {"contact": 2, "failed": 0},
                 "first_contact_time": {"mean": 1.5, "error": 0.1, "runs": 2}, "rotational_diffusion": 0.1, "translational_diffusion": 0.01, "speed": 1.0,
                 "times": [0.0, 1.0, 2.0], "runs_at_time": [4.0, 4.0, 0.0], "mean_square_displacement": [both(0.0), both(1.0), both(None)],
                 "mean_square_displacement_error": [both(0.0), both(0.1), both(None)], "heading_correlation": [both(1.0), both(0.9), both(None)],
                 "heading_correlation_error": [both(0.0), both(0.01), both(None)]} | changed
        (folder / "noise.json").write_text(json.dumps(means))
        (folder / "ensemble.csv").write_text("run,outcome,time,min_separation,first,second\n0,0,1.4,0.1,0,1\n1,0,1.6,0.1,0,1\n2,2,2,1,0,1\n3,,0.1,1,0,1\n")

    def test_a_scene_and_its_variants(self):
        self.build(figures=NOISE, variants=2)
        self.write_noise(self.folder)
        self.write_noise(self.folder / "variants/variant1", capture_probability=0.25)
        self.assert_drawn("noise")
        self.assertIn("0.5 (0.15 to 0.85) of 4 runs", (self.folder / "report.html").read_text())

    def test_a_single_rod_and_no_noise_of_headings(self):
        self.build(figures=NOISE)
        self.write_noise(self.folder, capture_probability=None, capture_low=None, capture_high=None, rotational_diffusion=0.0)
        self.assert_drawn("noise")

    def test_noise_that_was_not_written_is_named(self):
        self.build(figures=NOISE)
        self.assert_fails("noise.json", "no such file", "[noise]")

    def test_drawn_by_default(self):
        self.build(figures="")
        self.write_noise(self.folder)
        with run_dir.RunDir(self.folder) as run:
            self.assertIn("noise", [one.name for one in draw.figures_of(run)])


CROWD = """
[[figures]]
name = "film"
kind = "rods_movie"
fps = 10
[[figures]]
name = "order"
kind = "rods_order"
"""


class CrowdTest(PlotCase):
    """Many rods: their film, their order and clusters."""

    build = PlotsTest.build

    def build_crowd(self):
        self.build(figures=CROWD)
        (self.folder / "rods_order.csv").write_text("t,polar,nematic,clusters,mean_size,weighted_size,largest\n"
                                                    "0,0.9,0.5,2,1.5,1.7,2\n1,0.8,0.4,1,3,3,3\n")
        (self.folder / "clusters.csv").write_text("size,clusters,share\n1,0.5,0.1667\n2,0.5,0.3333\n3,0.5,0.5\n")
        mean = {"value": 0.85, "error": None, "samples": 1}
        (self.folder / "rods_order.json").write_text(json.dumps({
            "polar": mean, "nematic": mean, "mean_size": mean, "weighted_size": mean, "largest": mean, "link": 1.0, "from": 0.5, "block": 0.5, "blocks": 1,
            "units": {"length": "f/mu", "time": "f/(mu v0)"}}))

    def test_film_and_order(self):
        self.build_crowd()
        with mock.patch("shutil.which", return_value=None):
            done = self.plot()
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        self.assertEqual(sorted(path.name for path in (self.folder / "figures").iterdir()), ["film.gif", "film.png", "order.png"])
        self.assertIn("data:image/gif;base64,", (self.folder / "report.html").read_text())

    def test_order_that_was_not_written_is_named(self):
        self.build_crowd()
        (self.folder / "rods_order.json").unlink()
        done = self.plot()
        self.assertEqual(done.returncode, 0, done.stderr)  # the others are drawn
        self.assertRegex(done.stderr, r"rods_order\.json: no such file.*\[rods_order\]")
        (self.folder / "manifest.json").write_text(json.dumps({"files": {"rods_order.json": {}}}))  # it was written
        self.assert_fails("rods_order.json", "no such file", "[rods_order]")


if __name__ == "__main__":
    unittest.main()
