"""scan.html in headless Chromium, used with pointer and keys: /usr/bin/python3 tests/plots/test_scan_page_use.py"""

import csv
import io
import json
import tomllib
import unittest

import h5py
import numpy as np

import made_up_scan as made_up
import rodwake
from made_up_scan import OUTCOMES
from page_case import PageCase, grouped


class UsedTest(PageCase):
    KEYS = dict(start=16, resolution=128, failing=6, samples=40)

    def test_wheel_zooms_about_the_pointer(self):
        page = self.open()
        row = self.row_near(20, 3)
        before = self.place(page, row)
        page.wheel(*before, -400)
        low, high = page.evaluate("[scanPage.view.low, scanPage.view.high]")
        self.assertAlmostEqual(high[1] - low[1], 12 * np.exp(-0.6), delta=1e-9)  # the page's rate: exp(0.0015 a pixel)
        np.testing.assert_allclose(self.place(page, row), before, atol=1)
        page.key("0")  # not on the diagram: nothing
        self.assertLess(page.evaluate("scanPage.view.high[1]"), 6)
        page.press("#whole")
        self.assertEqual(page.evaluate("scanPage.view.high"), [2, 6])

    def test_drag_selects_and_csv_is_what_scan_csv_says(self):
        page, rows = self.open(), self.table()
        ends = [self.place(page, self.row_near(*place)) for place in ((2, -2), (30, 3))]
        page.drag((ends[0][0] - 3, ends[0][1] + 3), ends[0], ((ends[0][0] + ends[1][0]) / 2, ends[0][1]), (ends[1][0] + 3, ends[1][1] - 3))
        low, high = np.sort([self.points[self.row_near(*place)] for place in ((2, -2), (30, 3))], axis=0)
        inside = np.flatnonzero(((self.points >= low) & (self.points <= high)).all(axis=1))
        self.assertIn(f"{grouped(len(inside))} points selected", page.text("#selected"))
        page.press("#csv")
        found = list(csv.DictReader(io.StringIO(page.downloaded("selection.csv"))))
        self.assertEqual([int(one["point"]) for one in found], inside.tolist())
        for one, row in zip(found, inside):
            self.assertEqual(list(one)[1:], list(rows[row]))
            for name, cell in rows[row].items():
                self.assertEqual(one[name] if name in ("outcome", "status", "certificate") else one[name] and float(one[name]),
                                 cell if name in ("outcome", "status", "certificate") else cell and float(cell), (row, name))
        self.assert_clean(page)

    def test_select_view_zoom_and_clear(self):
        page = self.open()
        page.press("#select-view")
        self.assertIn(grouped(len(self.points)), page.text("#selected"))
        page.press("#clear")
        self.assertEqual(page.text("#selected"), "Nothing selected")
        with self.assertRaisesRegex(AssertionError, "disabled"):
            page.press("#csv")
        rows = [self.row_near(*place) for place in ((2, -2), (30, 3))]
        page.drag(*(self.place(page, row) for row in rows))
        page.press("#zoom-selection")
        low, high = page.evaluate("[scanPage.view.low, scanPage.view.high]")
        pixel = 12 / page.evaluate("scanPage.view.box.height")  # what the pointer can tell
        np.testing.assert_allclose((low[1], high[1]), self.points[rows, 1], atol=pixel)

    def test_shift_drag_moves_the_view(self):
        page = self.open()
        row = self.row_near(10, 0)
        x, y = self.place(page, row)
        page.drag((x, y), (x + 20, y + 10), (x + 60, y + 40), shift=True)
        np.testing.assert_allclose(self.place(page, row), (x + 60, y + 40), atol=1)
        self.assertEqual(page.text("#selected"), "Nothing selected")

    def test_keys(self):
        page = self.open()
        page.evaluate("document.getElementById('marks').focus()")
        page.key("ArrowRight")
        first = page.evaluate("scanPage.view.current")
        self.assertGreaterEqual(first, 0)
        page.key("ArrowRight")
        second = page.evaluate("scanPage.view.current")
        self.assertGreater(self.points[second, 0], self.points[first, 0])
        page.key("ArrowUp")
        third = page.evaluate("scanPage.view.current")
        self.assertGreater(self.points[third, 1], self.points[second, 1])
        self.assertIn(f"Point {third}:", page.text("#said"))
        self.assertIn(OUTCOMES[self.codes[third]], page.text("#said"))
        page.key("ArrowDown")
        page.key("ArrowLeft")
        page.key("Enter")
        self.assertEqual(page.evaluate("scanPage.view.clicked"), page.evaluate("scanPage.view.current"))
        self.assertFalse(page.evaluate("document.getElementById('walk').hidden"))
        page.key("+")
        self.assertLess(page.evaluate("scanPage.view.high[1] - scanPage.view.low[1]"), 12)
        for _ in range(40):  # past the edge of the view: it follows
            page.key("ArrowLeft")
        self.assertTrue(page.evaluate("scanPage.view.holds(scanPage.view.current)"))
        page.key("0")
        page.press("#select-view")
        page.evaluate("document.getElementById('marks').focus()")
        page.key("Escape")
        self.assertEqual(page.text("#selected"), "Nothing selected")

    def test_every_control_is_reached_by_tab(self):
        page = self.open()
        seen = set()
        for _ in range(40):
            page.key("Tab")
            seen.add(page.evaluate("document.activeElement.id"))
        self.assertLessEqual({"across", "up", "colour", "nearer", "farther", "whole", "drag", "marks", "select-view"}, seen)

    def test_axes_and_colours(self):
        page = self.open()
        page.choose("#colour", "time")
        self.assertIn("not captured", page.text("#legend"))
        page.choose("#up", "final_separation")
        page.choose("#across", "rods.1.position.0")
        place = self.place(page, self.row_near(1, -4))
        page.move(*place)
        np.testing.assert_allclose(self.place(page, page.evaluate("scanPage.view.current")), place, atol=1)  # points may lie on each other
        with self.assertRaisesRegex(AssertionError, "no choice"):
            page.choose("#colour", "status")
        self.assert_clean(page)

    def test_the_legend_hides_outcomes(self):
        page = self.open()
        page.evaluate("[...document.querySelectorAll('#legend button')].find(one => one.textContent.includes('escape')).click()")
        row = self.row_near(1, -4)
        page.move(*self.place(page, row))
        self.assertNotEqual(self.codes[page.evaluate("scanPage.view.current")], OUTCOMES.index("escape"))
        self.assertEqual(page.evaluate("document.querySelectorAll('#legend button[aria-pressed=false]').length"), 1)

    def test_scene_of_the_point(self):
        page, rows = self.open(), self.table()
        row = self.row_near(10, 0)
        page.click(*self.place(page, row))
        page.press("#scene")
        text = page.downloaded(f"point-{row}.toml")
        wanted = tomllib.loads(made_up.SCENE)
        wanted["coupling"]["kappa"] = float(rows[row]["coupling.kappa"])
        wanted["rods"][1]["position"][0] = float(rows[row]["rods.1.position.0"])
        self.assertEqual(tomllib.loads(text), wanted)
        (self.folder / "point.toml").write_text(text)

    def test_the_program_runs_that_scene(self):
        self.test_scene_of_the_point()
        runner = rodwake.ProgramTest("expect")
        runner.folder = self.folder
        runner.expect(0, "rods", "point.toml", "-o", "out", "--quiet", "-s", "rods_run.t_end=1")
        with h5py.File(self.folder / "out/result.h5") as file:
            run = file["rods/scene"]
            row = self.row_near(10, 0)
            self.assertEqual((run.attrs["kappa"], run["x"][0, 1]), tuple(self.points[row]))

    def test_a_click_computes_the_path_of_the_point(self):
        """That of the program, although the scan has none of it stored."""
        page = self.open()
        page.evaluate("scanPage.kernels")
        row = self.row_near(30, -1, where=~np.isin(np.arange(len(self.points)), page.evaluate("[...scanPage.scan.samples.point]")))
        page.click(*self.place(page, row))
        self.assertIn("Computed here, of this very point", page.text("#walk-text"))
        page.press("#scene")
        (self.folder / "point.toml").write_text(page.downloaded(f"point-{row}.toml"))
        runner = rodwake.ProgramTest("expect")
        runner.folder = self.folder
        runner.expect(0, "rods", "point.toml", "-o", "computed", "--quiet")
        record = json.loads((self.folder / "computed/outcome.json").read_text())
        with h5py.File(self.folder / "computed/result.h5") as file:
            run = file["rods/scene"]
            for name in ("x", "y", "theta"):
                found = page.evaluate(f"scanPage.walk.samples.{name}.slice(-2)")
                np.testing.assert_allclose(found, run[name][-1], rtol=0, atol=1e-6)
        self.assertEqual(page.evaluate("scanPage.walk.samples.outcome"), record["outcome"])


if __name__ == "__main__":
    unittest.main()
