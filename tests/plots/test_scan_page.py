"""scan.html in headless Chromium, what it shows: /usr/bin/python3 tests/plots/test_scan_page.py"""

import json
import tomllib
import unittest

import numpy as np

import browser
import made_up_scan as made_up
from made_up_scan import GAMMA, KAPPA, METHOD, OUTCOMES, PLACE
from page_case import NARROW, WIDE, PageCase, grouped, shown
from page_driver import Page


class ShownTest(PageCase):
    KEYS = dict(start=16, resolution=128, failing=6, samples=40)

    def test_self_contained(self):
        self.assertEqual(browser.references(self.path.read_text()), [])
        page = self.open()
        self.assert_clean(page)
        self.assertEqual(page.evaluate("performance.getEntriesByType('resource').filter(one => !/^(data|blob):/.test(one.name)).length"), 0)

    def test_the_look_at_what_is_wrong_can_fail(self):
        for inside, found in (("<script>nothing.at.all</script>", "nothing is not defined"),
                              ("<script>console.error('alas')</script>", "alas"),
                              ('<img src="https://example.org/a.png">', "example.org")):
            path = self.folder / "spoilt.html"
            path.write_text(browser.unprotected(self.path.read_text()).replace("<main>", "<main>" + inside))
            with Page(path) as page, self.assertRaisesRegex(AssertionError, found):
                page.wait_for(lambda: len(page.requests) + len(page.errors) > 1, "nothing was seen", 10)
                self.assert_clean(page)

    def test_nothing_sticks_out(self):
        for width in (WIDE, NARROW):
            seen = browser.look(self.path.read_text(), width)
            self.assertEqual((seen["width"], seen["errors"], seen["loaded"], seen["beyond"]), (width, [], [], []))
        page = self.open(NARROW)
        page.click(*self.place(page, self.row_near(10, 0)))
        self.assertEqual(page.evaluate("document.documentElement.scrollWidth"), NARROW)

    def test_colours_at_known_places(self):
        page = self.open()
        for place, name in (((10, 0), "contact"), ((20, 3), "pursuit"), ((1, -4), "escape")):
            self.assert_pixel(page, self.row_near(*place), name)
        with self.assertRaises(AssertionError):
            self.assert_pixel(page, self.row_near(10, 0), "escape")

    def test_hover_shows_the_point(self):
        page, rows = self.open(), self.table()
        for place in ((10, 0), (1, -4), (20, 3)):
            row = self.row_near(*place)
            page.move(*self.place(page, row))
            tip = page.text("#tip")
            self.assertIn(rows[row]["outcome"], tip)
            self.assertIn(f"point {grouped(row)}", tip)
            for key, digits in (("coupling.kappa", 5), ("rods.1.position.0", 5), ("final_separation", 4)):
                self.assertIn(shown(float(rows[row][key]), digits), tip)
        page.move(2, 2)
        self.assertEqual(page.evaluate("document.getElementById('tip').hidden"), True)
        self.assert_clean(page)

    def test_hover_finds_the_nearest_of_all(self):
        """Against a search through all points, at places all over the diagram and after zooming."""
        page = self.open()
        for _ in range(2):
            found = page.evaluate("""(() => {
                const { view } = scanPage, all = [...view.points], wrong = [], marks = document.getElementById("marks");
                const { left, top } = marks.getBoundingClientRect();
                for (let index = 0; index < 200; ++index) {
                    const x = view.box.left + view.box.width * (index * 0.618034 % 1);
                    const y = view.box.top + view.box.height * (index * 0.754878 % 1);
                    const away = point => Math.hypot(view.place(point)[0] - x, view.place(point)[1] - y);
                    marks.dispatchEvent(new PointerEvent("pointermove", { clientX: x + left, clientY: y + top }));
                    if (away(view.current) > Math.min(...all.map(away)) * (1 + 1e-9) + 1e-6) wrong.push([x, y]);
                }
                return wrong;
            })()""")
            self.assertEqual(found, [])
            page.press("#nearer")

    def test_failed_points_say_so(self):
        page, rows = self.open(), self.table()
        row = next(index for index, one in enumerate(rows) if one["status"] != "ok")
        page.move(*self.place(page, row))
        self.assertIn("not_finite", page.text("#tip"))

    def test_click_draws_the_trajectory_of_the_point(self):
        page, stored = self.open(), self.stored()
        sample = int(np.abs(self.points[stored["point"], 1]).argmin())
        row = int(stored["point"][sample])
        self.assertEqual(page.evaluate("document.getElementById('path').width * !document.getElementById('walk').hidden"), 0)
        page.click(*self.place(page, row))
        self.assertIn("Of this very point", page.text("#walk-text"))
        self.assertIn(OUTCOMES[self.codes[row]], page.text("#point-name"))
        self.assert_walk(page, stored, sample)
        self.assert_clean(page)

    def test_the_look_at_the_trajectory_can_fail(self):
        page, stored = self.open(), self.stored()
        page.click(*self.place(page, int(stored["point"][0])))
        stored["x"][0] = stored["x"][0][::-1] + np.linspace(0, 30, len(stored["x"][0]))[:, None] ** 2
        with self.assertRaisesRegex(AssertionError, "is not drawn"):
            self.assert_walk(page, stored, 0)

    def test_click_takes_the_nearest_stored_one_and_says_how_far(self):
        page, stored = self.open(), self.stored()
        page.evaluate("scanPage.kernels.then(() => { scanPage.scan.engine = null; })")  # as where the page cannot compute
        row = self.row_near(0.3, 1.5, where=~np.isin(np.arange(len(self.points)), stored["point"]))
        page.click(*self.place(page, row))
        even = np.stack([np.log10(self.points[:, 0]) / 3, self.points[:, 1] / 12], axis=-1)
        away = np.hypot(*(even[stored["point"]] - even[row]).T)
        sample = int(away.argmin())
        text = page.text("#walk-text")
        self.assertIn(f"that of point {grouped(stored['point'][sample])}:", text)
        self.assertIn(f"{float(f'{100 * away[sample]:.2g}'):g}\u2009%", text)
        self.assert_walk(page, stored, sample)

    def test_the_clock_moves_the_rods(self):
        page, stored = self.open(), self.stored()
        row = int(stored["point"][3])
        page.click(*self.place(page, row))
        self.assertIn(shown(stored["t"][3, -1], 4), page.text("#time"))
        before = page.evaluate("document.getElementById('path').toDataURL()")
        page.evaluate("document.getElementById('clock').value = 500")
        page.evaluate("document.getElementById('clock').dispatchEvent(new Event('input'))")
        self.assertIn(shown(stored["t"][3, -1] / 2, 4), page.text("#time"))
        self.assertNotEqual(page.evaluate("document.getElementById('path').toDataURL()"), before)

    def test_dark_and_light(self):
        page = self.open(dark=True)
        self.assert_pixel(page, self.row_near(10, 0), "contact")
        ground = "getComputedStyle(document.body).backgroundColor"
        dark, map_ = page.evaluate(ground), "document.getElementById('map').toDataURL()"
        before = page.evaluate(map_)
        page.set_dark(False)
        self.assertNotEqual(page.evaluate(ground), dark)
        page.wait_for(lambda: page.evaluate(map_) != before, "the diagram is not drawn again", 10)

    def test_a_page_that_cannot_be_drawn_says_so(self):
        text = self.path.read_text()
        start = text.index('id="array1"')
        self.path.write_text(text[:start] + text[start:].replace(">eJ", ">AA", 1))
        with Page(self.path) as page:
            page.wait_for(lambda: not page.evaluate("document.getElementById('trouble').hidden"), "nothing is said")
            self.assertIn("could not be drawn", page.text("#trouble"))


class OtherPagesTest(PageCase):
    def test_three_axes(self):
        self.build(axes=(KAPPA, PLACE, GAMMA), start=8, resolution=32)
        page = self.open()
        self.assertIn("γ1", page.text("#slices").replace("\n", ""))
        values = page.evaluate("[...document.querySelector('#slices select').options].map(one => +one.value)")
        page.choose("#slices select", str(values[1] if values[1] % 1 else int(values[1])))
        row = self.row_near(10, 0, where=self.points[:, 2] == 0)
        page.move(*self.place(page, row))
        self.assertEqual(page.evaluate("scanPage.view.current"), row)
        self.assert_pixel(page, row, OUTCOMES[self.codes[row]])
        page.choose("#up", "coupling.gamma1")
        self.assert_clean(page)

    def test_grids_and_choices(self):
        self.build(design="grid", axes=(PLACE, METHOD), count=25)
        page = self.open()
        page.click(*self.place(page, 12 * 3 + 1))
        self.assertIn("adams", page.text("#point"))
        page.press("#scene")
        self.assertEqual(tomllib.loads(page.downloaded("point-37.toml"))["rods_run"]["method"], "adams")
        self.assert_clean(page)

    def test_one_axis(self):
        self.build(design="grid", axes=(PLACE,), count=41)
        page = self.open()
        self.assertEqual(page.evaluate("document.getElementById('up').value"), "final_separation")
        self.assert_clean(page)

    def test_beds(self):
        self.folder = self.folder / "bed"
        made_up.write_bed_scan(self.folder)
        self.write_page()
        page = self.open()
        page.click(*self.place(page, 5))
        self.assertIn("has stored no trajectories", page.text("#walk-text"))
        self.assertIn("change of separation", page.text("#point"))
        self.assert_clean(page)

    def test_scenes_that_cannot_be_written(self):
        self.build(design="grid", axes=(KAPPA | {"key": "rods.7.heading", "keys": ["rods.7.heading"]},), count=5)
        page = self.open()
        self.assertIn("No scenes of points: rods.7.heading", page.text("#scene-text"))
        page.click(*self.place(page, 2))
        with self.assertRaisesRegex(AssertionError, "disabled"):
            page.press("#scene")

    def test_titles_are_escaped(self):
        self.build(design="grid", count=3)
        scene = self.folder / "scene.toml"
        scene.write_text(scene.read_text().replace("Capture of", "</script><script>alert(1)</script>{{data}} &"))
        self.write_page()
        page = self.open()
        self.assertIn("<script>alert(1)</script>{{data}} &", page.text("h1"))
        self.assert_clean(page)

    def test_written_beside_the_report(self):
        self.build(design="grid", count=5)
        self.path.unlink()
        done = self.plot("--report-only") if (self.folder / "figures").is_dir() else self.plot()
        self.assertEqual((done.returncode, done.stdout.splitlines()[-1]), (0, str(self.folder / "scan.html")))

    def test_as_many_points_as_a_large_scan_has(self):
        """More points than two bytes count: all of them are there and are found; how long it takes is printed, not asserted."""
        self.build(design="sobol", count=70_000, samples=200)
        page = self.open()
        row = 67_890
        page.click(*self.place(page, row))
        self.assertEqual(page.evaluate("scanPage.view.clicked"), row)
        page.choose("#colour", "time")
        page.press("#select-view")
        page.press("#csv")
        self.assertEqual(page.downloaded("selection.csv").count("\n"), 70_001)
        size = self.path.stat().st_size / 1e6
        print(f"\n70000 points: page of {size:.1f} MB, {json.dumps(page.evaluate('scanPage.timings'))} ms")


if __name__ == "__main__":
    unittest.main()
