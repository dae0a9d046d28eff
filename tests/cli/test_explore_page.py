"""The page of rodwake explore, used by pointer, touch, wheel and keys."""

import csv
import io
import json
import math
import re
import tempfile
import time
import xml.etree.ElementTree
from pathlib import Path

import rodwake
from page_driver import Page
from rodwake import PAIR, ProgramTest

WIDTHS = (360, 768, 1440)


class PageTest(ProgramTest):
    """One page for all tests of a class: each starts it again."""
    size, scene = (1440, 1000), None

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.kept = tempfile.TemporaryDirectory(prefix="rodwake-explore-")
        cls.addClassCleanup(cls.kept.cleanup)
        cls.path = Path(cls.kept.name) / "explore.html"
        rodwake.subprocess.run(rodwake.command("explore", "-o", cls.path, "--quiet"), check=True)
        cls.page = Page(cls.path, *cls.size)
        cls.enterClassContext(cls.page)
        cls.page.evaluate("rodwake.ready")

    def setUp(self):
        super().setUp()
        self.page.evaluate("rodwake.page.store.change({...rodwake.page.start, time: 0}, false); rodwake.page.paths.solve();"
                           " rodwake.page.store.change(rodwake.page.paths.whole()); scrollTo(0, 0)")
        self.frame()

    def tearDown(self):
        self.assertEqual(self.page.errors, [])
        super().tearDown()

    def frame(self):
        """Until what was changed is drawn."""
        self.page.evaluate("new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done)))")

    def state(self, key):
        return self.page.evaluate(f"rodwake.page.store.state.{key}")

    def at(self, selector):
        """The middle of an element, in view."""
        return self.page.evaluate(f"""(() => {{
            const one = document.querySelector({json.dumps(selector)});
            one.scrollIntoView({{ block: "center" }});
            const box = one.getBoundingClientRect();
            return [box.left + box.width / 2, box.top + box.height / 2];
        }})()""")

    def focus(self, selector):
        self.page.evaluate(f"document.querySelector({json.dumps(selector)}).focus()")

    def control(self, key, shift=False):
        event = {"key": key, "code": f"Key{key.upper()}", "windowsVirtualKeyCode": ord(key.upper()), "modifiers": 2 + (8 if shift else 0)}
        self.page.send("Input.dispatchKeyEvent", type="rawKeyDown", **event)
        self.page.send("Input.dispatchKeyEvent", type="keyUp", **event)


class PointerTest(PageTest):
    def test_dragging_a_rod_moves_it_and_its_future(self):
        for stage in ("#paths-stage", "#wake-stage"):
            before, end = self.state("x1"), self.page.evaluate("rodwake.page.paths.run.time")
            x, y = self.at(f"{stage} .handle.body.rod1")
            scale = self.page.evaluate("rodwake.page.paths.stage.scale")
            self.page.drag((x, y), (x + 10, y), (x + 60, y - 20))
            self.frame()
            self.assertAlmostEqual(self.state("x1") - before, 60 / scale, delta=0.2 / scale)  # places are tenths of a pixel
            self.assertNotEqual(self.page.evaluate("rodwake.page.paths.run.time"), end)

    def test_turning_a_rod(self):
        x, y = self.at("#paths-stage .handle.head.rod0")
        self.page.drag((x, y), (x - 46, y - 46))
        self.assertAlmostEqual(self.state("theta0"), math.pi / 2, delta=0.05)  # 46 pixels are the handle's distance, to one

    def test_sliders_and_the_time_are_dragged(self):
        before = self.state("kappa")
        x, y = self.at("#slider-kappa")
        self.page.drag((x, y), (x - 10, y), (x - 50, y))
        self.frame()
        self.assertLess(self.state("kappa"), 0)
        self.page.press("#undo")  # one gesture
        self.assertEqual(self.state("kappa"), before)
        x, y = self.at("#scrub")
        self.page.drag((x - 20, y), (x - 10, y), (x, y))
        self.assertAlmostEqual(self.state("time") / self.page.evaluate("rodwake.page.paths.run.time"), 0.5, delta=0.05)  # the knob's width

    def test_the_ground_and_the_wheel(self):
        for stage in ("#wake-stage", "#paths-stage"):
            left, wide = self.state("left"), self.state("wide")
            x, y = self.at(stage)
            self.page.drag((x, y + 100), (x - 50, y + 100))
            self.assertGreater(self.state("left"), left)
            self.page.move(x, y)
            self.page.wheel(x, y, 300)
            self.page.wait_for(lambda wide=wide: self.state("wide") > 1.2 * wide, "the wheel does not zoom", 5)
        for selector, more in (("#nearer", False), ("#farther", True)):
            wide = self.state("wide")
            self.page.press(selector)
            self.assertEqual(self.state("wide") > wide, more)
        self.page.press("#fit")
        self.assertEqual(self.page.evaluate("rodwake.page.paths.whole().wide"), self.state("wide"))

    def test_swapped_rods(self):
        self.page.press("#swap")
        self.assertEqual([self.state(key) for key in ("y0", "y1")], [-2.5, 2.5])

    def test_the_diagram_gives_its_encounters(self):
        self.page.wait_for(lambda: self.page.evaluate("rodwake.page.diagram.done"), "the diagram is not done", 60)
        x, y = self.at("#diagram-stage canvas")
        self.page.move(x + 80, y - 60)
        self.assertRegex(self.page.text("#diagram-tip"), r"^x₁ = [\d.]+, κ = [\d.]+: (contact|pursuit|orbit|escape|undecided)")
        outcome = re.search(r": (\w+)", self.page.text("#diagram-tip"))[1]
        self.page.click(x + 80, y - 60)
        self.frame()
        self.assertEqual(self.page.text("#badge"), outcome)
        self.assertGreater(self.state("x1"), 0)
        shares = self.page.evaluate("rodwake.page.diagram.shares()")
        self.assertAlmostEqual(sum(shares), 1.0)
        self.page.choose("#across", "alpha")
        self.page.choose("#up", "gamma1")
        self.frame()
        self.page.wait_for(lambda: self.page.evaluate("rodwake.page.diagram.done"), "the other diagram is not done", 60)
        self.assertNotEqual(self.page.evaluate("rodwake.page.diagram.shares()"), shares)

    def test_cells_are_what_the_encounters_are(self):
        """Computed cells by themselves, the others as their surroundings: of a sample one in a hundred may lie on a thin feature."""
        self.page.wait_for(lambda: self.page.evaluate("rodwake.page.diagram.done"), "the diagram is not done", 60)
        wrong = self.page.evaluate("""(() => {
            const { diagram } = rodwake.page, wrong = [0, 0];
            for (let cell = 7; cell < 128 * 128; cell += 61) {
                const [code] = rodwake.encounters(diagram.numbersAt((cell % 128 + 0.5) / 128, (Math.floor(cell / 128) + 0.5) / 128), 1e-8);
                if (diagram.shown[cell] !== code) ++wrong[diagram.known[cell]];
            }
            return wrong;
        })()""")
        self.assertLessEqual(wrong[1], 2)  # of 269, at rtol 1e-6 for 1e-8
        self.assertLessEqual(wrong[0], 3)


class TouchTest(PageTest):
    size = (360, 740)

    def setUp(self):
        super().setUp()
        self.page.send("Emulation.setTouchEmulationEnabled", enabled=True, maxTouchPoints=2)

    def touch(self, *steps):
        """The places of all fingers, step by step; then all are lifted."""
        for number, fingers in enumerate([*steps, ()]):
            kind = "touchEnd" if not fingers else "touchMove" if number and len(fingers) == len(steps[number - 1]) else "touchStart"
            self.page.send("Input.dispatchTouchEvent", type=kind, touchPoints=[{"x": x, "y": y, "id": k} for k, (x, y) in enumerate(fingers)])
        self.frame()

    def test_one_finger_moves_and_turns_rods(self):
        x, y = self.at("#paths-stage .handle.body.rod0")
        before = self.state("y0")
        self.touch([(x, y)], [(x, y + 20)], [(x, y + 40)])
        self.assertLess(self.state("y0"), before - 0.3)
        x, y = self.at("#wake-stage .handle.head.rod1")
        self.touch([(x, y)], [(x - 20, y - 40)], [(x - 46, y - 46)])
        self.assertAlmostEqual(self.state("theta1"), math.pi / 2, delta=0.05)

    def test_one_finger_moves_the_ground_and_picks_from_the_diagram(self):
        left = self.state("left")
        x, y = self.at("#wake-stage")
        self.touch([(x, y + 100)], [(x - 30, y + 100)], [(x - 60, y + 100)])
        self.assertGreater(self.state("left"), left)
        x, y = self.at("#diagram-stage canvas")
        self.touch([(x + 40, y - 30)], [(x + 60, y - 30)])
        self.assertGreater(self.state("x1"), 0)

    def test_two_fingers_zoom(self):
        for stage, name in (("#paths-stage", "paths"), ("#wake-stage", "wake")):
            x, y = self.at(stage)
            before, below = self.page.evaluate("rodwake.page.store.state"), self.below(name, x, y)
            self.touch([(x, y - 30)], [(x, y - 30), (x, y + 30)], [(x, y - 45), (x, y + 45)], [(x, y - 60), (x, y + 60)])
            self.assertAlmostEqual(self.state("wide"), before["wide"] / 2, delta=0.01)  # views have six digits
            for here, there in zip(self.below(name, x, y), below):
                self.assertAlmostEqual(here, there, delta=0.01)
            self.page.press("#undo")  # one gesture
            self.assertEqual(self.state("wide"), before["wide"])

    def test_two_fingers_on_a_rod_leave_it(self):
        x, y = self.at("#paths-stage .handle.body.rod0")
        wide, place = self.state("wide"), [self.state(key) for key in ("x0", "y0", "theta0")]
        self.touch([(x, y)], [(x, y), (x + 60, y)], [(x - 20, y), (x + 80, y)])
        self.assertEqual([self.state(key) for key in ("x0", "y0", "theta0")], place)
        self.assertAlmostEqual(self.state("wide"), wide * 0.6, delta=0.01)
        self.assertFalse(self.page.evaluate("document.body.classList.contains('dragging')"))

    def below(self, name, x, y):
        return self.page.evaluate(f"rodwake.page.{name}.stage.toPlane({{ clientX: {x}, clientY: {y} }})")


class KeyTest(PageTest):
    def test_rods_by_keys(self):
        self.focus("#paths-stage .handle.body.rod0")
        self.page.key("ArrowRight")
        step = self.state("x0")
        self.page.key("ArrowUp", shift=True)
        self.assertAlmostEqual(self.state("y0"), 2.5 + step / 10)
        self.focus("#paths-stage .handle.head.rod1")
        self.page.key("ArrowLeft")
        self.assertAlmostEqual(self.state("theta1"), math.radians(5))
        self.assertIn("5 degrees", self.page.evaluate("document.querySelector('#paths-stage .head.rod1').ariaLabel"))

    def test_tab_reaches_every_control(self):
        self.page.evaluate("""(() => {
            window.missed = new Set([...document.querySelectorAll("button, input, select, summary, canvas[tabindex]")].filter(one =>
                !one.disabled && one.checkVisibility()));
            document.addEventListener("focusin", event => missed.delete(event.target));
            document.activeElement.blur();
        })()""")
        for _ in range(120):
            self.page.key("Tab")
        self.assertEqual(self.page.evaluate("[...missed].map(one => one.outerHTML)"), [])

    def test_sliders_and_numbers(self):
        for name in ("kappa", "gamma1", "gamma2", "alpha", "eta", "t_end", "contact_distance"):
            before = self.state(name)
            self.focus(f"#slider-{name}")
            for _ in range(20):
                self.page.key("ArrowLeft")
            self.assertLess(self.state(name), before, name)
            self.assertEqual(float(self.page.evaluate(f"document.querySelector('#slider-{name}-number').value")), self.state(name))
        self.type_into("#slider-kappa-number", "12.5")
        self.assertEqual(self.state("kappa"), 12.5)
        self.type_into("#slider-alpha-number", "-3")  # not legal
        self.assertGreater(self.state("alpha"), 0)
        self.type_into("#pose-theta0", "-45")
        self.assertAlmostEqual(self.state("theta0"), -math.pi / 4)
        self.type_into("#pose-x1", "3.25")
        self.assertEqual(self.state("x1"), 3.25)

    def type_into(self, selector, text):
        self.page.evaluate(f"(() => {{ const one = document.querySelector('{selector}'); one.focus(); one.select(); }})()")
        self.page.send("Input.insertText", text=text)
        self.page.key("Enter")

    def test_undo_and_redo(self):
        start = self.state("kappa")
        self.page.press("#presets button:nth-child(2)")
        self.assertEqual(self.page.text("#sentence")[:5], "Rod 1")
        self.control("z")
        self.assertEqual(self.state("kappa"), start)
        self.control("z", shift=True)
        self.assertEqual(self.state("kappa"), 30)
        self.page.press("#undo")
        self.assertEqual(self.state("kappa"), start)
        self.page.press("#redo")
        self.page.press("#reset")
        self.assertEqual(self.state("kappa"), start)

    def test_time(self):
        self.focus("#scrub")
        for _ in range(5):
            self.page.key("ArrowRight")
        self.frame()
        self.assertAlmostEqual(self.state("time"), 5 / 500 * self.page.evaluate("rodwake.page.paths.run.time"), delta=1e-9)
        self.assertIn(f"t = {self.state('time'):.2f}", self.page.text("#time"))
        self.page.press("#play")
        self.page.wait_for(lambda: self.state("time") > 0.5, "it does not play", 10)
        self.page.press("#play")
        self.assertFalse(self.page.evaluate("rodwake.page.playing"))
        self.page.evaluate("document.activeElement.blur()")
        self.page.key(" ")
        self.assertTrue(self.page.evaluate("rodwake.page.playing"))
        self.page.key(" ")

    def test_the_view_by_keys(self):
        self.page.evaluate("document.activeElement.blur()")
        for key, ratio in (("+", 0.8), ("-", 1.0), ("-", 1.25), ("0", 1.0)):
            self.page.key(key)
            self.assertAlmostEqual(self.state("wide") / self.page.evaluate("rodwake.page.paths.whole().wide"), ratio, delta=1e-4)

    def test_the_diagram_by_keys(self):
        self.focus("#diagram-stage canvas")
        self.page.key("ArrowRight")
        self.page.key("ArrowDown")
        self.assertGreater(self.state("x1"), 0)
        self.assertLess(self.state("kappa"), 100)

    def test_presets_end_as_they_say(self):
        for preset in self.page.evaluate("[...document.querySelectorAll('#presets button')].map(one => one.textContent)"):
            number = self.page.evaluate(f"[...document.querySelectorAll('#presets button')].findIndex(one => one.textContent === '{preset}') + 1")
            self.page.press(f"#presets button:nth-child({number})")
            self.frame()
            ends = {"Attraction": "contact", "Pursuit": "pursuit", "Weak coupling": "escape", "Spiral": "contact", "Screened": "undecided",
                    "Polar couplings": "contact", "Repulsion": "escape", "Orbit": "orbit"}
            self.assertEqual(self.page.text("#badge"), ends[preset])
            self.assertEqual(self.page.text("#check"), "Checked: a run a hundred times tighter ends alike.")

    def test_what_the_wake_shows(self):
        def picture():
            self.frame()
            return self.page.evaluate("rodwake.page.wake.stage.canvas.toDataURL()")
        seen = {picture()}
        for selector, values in (("#colour", ("trace", "displacement", "none", "strain")), ("#lines", ("laplacian", "gradient", "none", "axes")),
                                 ("#source", ("1", "both"))):
            for value in values:
                self.page.choose(selector, value)
                seen.add(picture())
        self.assertEqual(len(seen), 9)  # of eleven, two are the first again


class FilesTest(PageTest):
    def test_the_address_holds_all(self):
        self.page.press("#presets button:nth-child(6)")
        self.page.choose("#colour", "trace")
        before = self.page.evaluate("rodwake.page.store.state")
        self.page.wait_for(lambda: "colour=trace" in self.page.evaluate("location.hash"), "the address is not written", 5)
        address = self.page.evaluate("location.hash")
        self.page.press("#reset")
        self.page.wait_for(lambda: "gamma1" not in self.page.evaluate("location.hash"), "the address is not written", 5)
        self.page.evaluate(f"location.hash = {json.dumps(address)}")
        self.page.wait_for(lambda: self.state("gamma1") == 10, "the address is not read", 5)
        after = self.page.evaluate("rodwake.page.store.state")
        self.assertEqual({key: after[key] for key in before}, before)
        self.page.evaluate("location.hash = '#kappa=nonsense&alpha=-1&colour=pink&wide=0&eta=2'")  # what is not legal is left out
        self.page.wait_for(lambda: self.state("eta") == 2, "the address is not read", 5)
        self.assertEqual((self.state("kappa"), self.state("alpha"), self.state("colour")), (100, 1, "strain"))

    def test_addresses_that_nobody_meant(self):
        self.page.evaluate("location.hash = '#constructor=1&toString=2&__proto__=3&eta=3'")
        self.page.wait_for(lambda: self.state("eta") == 3, "the address is not read", 5)
        self.page.evaluate("location.hash = '#t_end=1e12&kappa=1e12&alpha=1e-12'")
        self.page.wait_for(lambda: "steps by t =" in self.page.evaluate("document.querySelector('#outcome').textContent"), "no word of the steps", 60)
        began = time.monotonic()
        for _ in range(3):  # the diagram's cells go on, a few at a time
            self.frame()
        self.assertLess(time.monotonic() - began, 60)

    def test_the_view_holds_the_wake_behind_the_rods(self):
        self.page.evaluate("rodwake.page.store.change({kappa: 0.5, t_end: 60})")
        self.frame()
        view = self.page.evaluate("rodwake.page.paths.whole()")
        self.assertLessEqual(view["left"], -10)  # ten screening lengths
        self.assertGreater(view["left"] + view["wide"], 40)  # where they meet

    def test_the_pages_that_it_cites_are_there(self):
        for name in re.findall(r"docs/[\w.]+\.md", (rodwake.SOURCE / "explorer/page.html").read_text()):
            self.assertTrue((rodwake.SOURCE / name).is_file(), name)

    def test_the_program_runs_the_scene(self):
        self.page.press("#presets button:nth-child(6)")
        self.page.evaluate("document.querySelector('details').open = true")
        self.page.press("#save-scene")
        self.write("encounter.toml", self.page.downloaded("encounter.toml"))
        self.expect(0, "rods", "encounter.toml", "-o", "out", "--quiet")
        record = json.loads((self.folder / "out/outcome.json").read_text())
        self.page.press("#paths-csv")
        path = list(csv.DictReader(io.StringIO(self.page.downloaded("rods.csv"))))
        rods = list(csv.DictReader(io.StringIO((self.folder / "out/rods.csv").read_text())))
        self.assertEqual(list(path[0]), list(rods[0])[:7])
        self.assertEqual(record["outcome"], self.page.text("#badge"))
        for name, value in path[-1].items():
            self.assertAlmostEqual(float(value), float(rods[-1][name]), delta=1e-6)

    def test_pictures_and_tables(self):
        drawing = xml.etree.ElementTree.fromstring(self.press_and_get("#paths-svg", "encounter.svg"))
        self.assertEqual(len(drawing.findall("{http://www.w3.org/2000/svg}path")), 6)
        for selector, name in (("#paths-png", "encounter.png"), ("#wake-png", "wake.png"), ("#diagram-png", "diagram.png")):
            self.page.press(selector)
            self.assertEqual(self.page.arrived(name).read_bytes()[:4], b"\x89PNG")
        wake = list(csv.DictReader(io.StringIO(self.press_and_get("#wake-csv", "wake.csv"))))[::311]
        # rod 0 walks along x from (0, 2.5) in a medium of eta = 1, alpha = 1
        self.write("points.csv", "x,y,xi,eta\n" + "".join(f"{row['x']},{float(row['y']) - 2.5!r},1,1\n" for row in wake))
        exact = list(csv.DictReader(io.StringIO(self.expect(0, "field", "--points", "points.csv").stdout)))
        for row, one in zip(wake, exact):
            for name in ("Ux", "Uy", "exx", "exy", "eyy", "lapx", "grady_tr"):
                self.assertAlmostEqual(float(row[name]), float(one[name]), delta=1e-9)

    def test_the_table_of_the_diagram_is_that_of_a_scan(self):
        self.page.wait_for(lambda: self.page.evaluate("rodwake.page.diagram.done"), "the diagram is not done", 60)
        cells = list(csv.DictReader(io.StringIO(self.press_and_get("#diagram-csv", "diagram.csv"))))[::97]
        self.assertEqual(list(cells[0]), ["x1", "kappa", "outcome"])
        self.write("points.csv", "rods.1.position.0,coupling.kappa\n" + "".join(f"{cell['x1']},{cell['kappa']}\n" for cell in cells))
        self.write("scan.toml", self.page.evaluate("document.querySelector('#scene').textContent") + '[scan]\ndesign = "list"\nfile = "points.csv"\n')
        self.expect(0, "scan", "scan.toml", "-o", "scan", "--quiet")
        program = csv.DictReader(io.StringIO((self.folder / "scan/scan.csv").read_text()))
        differ = sum(cell["outcome"] != point["outcome"] for cell, point in zip(cells, program, strict=True))
        self.assertLessEqual(differ, len(cells) // 50)  # cells are computed at rtol 1e-6, points at 1e-8

    def test_copies(self):
        self.page.evaluate("navigator.clipboard.writeText = text => { window.copied = text; return Promise.resolve(); }; 0")
        self.page.evaluate("document.querySelector('details').open = true")
        for selector, text in (("#copy-link", "location.href.split('#')[0] + '#'"), ("#copy-scene", "document.querySelector('#scene').textContent")):
            self.page.press(selector)
            self.page.wait_for(lambda: self.page.text(selector) == "Copied", "it is not copied", 5)
            self.assertTrue(self.page.evaluate(f"copied.startsWith({text})"))

    def press_and_get(self, selector, name):
        self.page.press(selector)
        return self.page.downloaded(name)


class LooksTest(PageTest):
    def test_nothing_is_wider_than_the_window(self):
        for width in WIDTHS:
            self.page.send("Emulation.setDeviceMetricsOverride", width=width, height=800, deviceScaleFactor=1, mobile=width < 500)
            self.frame()
            self.assertEqual(self.page.evaluate("document.documentElement.scrollWidth"), width)
        self.page.send("Emulation.setDeviceMetricsOverride", width=1440, height=1000, deviceScaleFactor=1, mobile=False)

    def test_every_control_has_a_name(self):
        unnamed = self.page.evaluate("""[...document.querySelectorAll("button, input, select, canvas[tabindex]")].filter(one =>
            !(one.textContent.trim() && one.tagName === "BUTTON") && !one.ariaLabel && !one.labels?.length).map(one => one.outerHTML)""")
        self.assertEqual(unnamed, [])
        self.assertEqual(self.page.requests, [self.path.as_uri()])  # one file, no network

    def test_themes(self):
        def paper():
            return self.page.evaluate("getComputedStyle(document.body).backgroundColor")
        light = paper()
        self.page.set_dark(True)
        dark = paper()
        self.assertNotEqual(light, dark)
        self.page.choose("#theme", "light")
        self.assertEqual(paper(), light)
        self.page.set_dark(False)
        self.page.choose("#theme", "dark")
        self.assertEqual(paper(), dark)
        self.page.choose("#theme", "auto")

    def test_without_web_assembly_it_says_so(self):
        with Page(self.path, first="delete window.WebAssembly;") as page:
            self.assertIn("WebAssembly, which this browser does not have", page.text("#trouble"))
            self.assertFalse(page.evaluate("document.querySelector('#work').offsetParent !== null"))


class SceneTest(ProgramTest):
    def test_it_starts_with_the_scene(self):
        self.write("a.toml", PAIR.replace("kappa = 0.5", "kappa = 7.5\ngamma1 = 2.0\npolar_basis = \"divergence\""))
        self.expect(0, "explore", "a.toml", "-o", "a.html", "-s", "rods.1.heading=0.25", "--quiet")
        with Page(self.folder / "a.html") as page:
            page.evaluate("rodwake.ready")
            found = page.evaluate("rodwake.page.store.state")
            self.assertEqual([found[key] for key in ("kappa", "gamma1", "gamma2", "theta1", "t_end")], [7.5, 1.0, 1.0, 0.25, 60.0])
            self.assertEqual(page.errors, [])


if __name__ == "__main__":
    rodwake.main()
