"""rodwake explore: a page that computes with the program's kernels, used in a browser as a reader uses it."""

import csv
import io
import json
import math
import random
import re
import runpy

import browser
import rodwake
from page_driver import Page
from rodwake import PAIR, SOURCE, ProgramTest

TOOL = SOURCE / "tools" / "explorer"
KEYS = ("coupling.kappa", "coupling.gamma1", "coupling.gamma2", "medium.eta", "medium.alpha",
        *(f"rods.{rod}.{key}" for rod in (0, 1) for key in ("position.0", "position.1", "heading")))


def starts(count, seed=1):
    """Rows of numbers in the order of KEYS: couplings of both signs from 0.3 to 300, alpha from 0.01 to 10."""
    draw = random.Random(seed)

    def log(low, high):
        return low * (high / low) ** draw.random()

    def angle():
        return draw.uniform(-math.pi, math.pi)

    rows = []
    for number in range(count):
        gammas = [draw.uniform(-10, 10), draw.uniform(-10, 10)] if number % 2 else [0.0, 0.0]
        r, where = draw.uniform(0.5, 6.0), angle()
        rows.append([log(0.3, 300) * draw.choice((-1, 1)), *gammas, log(0.3, 3), log(0.01, 10), 1.0, -2.0, angle(),
                     1.0 + r * math.cos(where), -2.0 + r * math.sin(where), angle()])
    return rows


def problem(row, t_end=40.0):
    kappa, gamma1, gamma2, eta, alpha, *poses = row
    return {"eta": eta, "alpha": alpha, "kappa": kappa, "gamma1": gamma1, "gamma2": gamma2, "t_end": t_end, "contact_distance": 0.1,
            "rtol": 1e-8, "rods": [poses[:3], poses[3:]]}


def columns(text):
    rows = list(csv.reader(io.StringIO(text)))
    return {name: [float(row[k]) for row in rows[1:]] for k, name in enumerate(rows[0])}


class CompiledTest(ProgramTest):
    def test_the_kernels_are_those_of_these_sources(self):
        """What the page computes with was compiled from the sources beside it."""
        self.assertEqual(self.tool()["changed"](), [], "run tools/explorer, which compiles explorer/kernel.wasm anew, and commit what it writes")

    def test_a_changed_source_is_seen(self):
        tool = self.tool()
        self.assertEqual(tool["code"]("int a = 1; // one\n/* two\n */ int b;"), tool["code"]("int a = 1;\n\nint b;"))
        self.assertNotEqual(tool["code"]("int a = 1;"), tool["code"]("int a = 2;"))
        known = json.loads((SOURCE / "explorer/kernel.sources.json").read_text())["sources"]
        self.assertIn("models/rods/pair_steps.cpp", known)
        self.assertGreater(len(known), 40)

    def test_the_npm_package(self):
        """Its module, as a browser runs it; names in its types are those that it exports."""
        folder = self.folder / "npm"
        self.tool()["npm"](folder)
        record = json.loads((folder / "package.json").read_text())
        self.assertEqual((record["name"], record["type"]), ("rodwake", "module"))
        for file in (*record["files"], "README.md", "LICENSE", record["exports"]["."]["default"], record["types"]):
            self.assertTrue((folder / file).is_file(), file)
        module = (folder / "index.mjs").read_text()
        exported = set(re.findall(r"(?m)^export const (\w+)", module))
        self.assertEqual(set(re.findall(r"(?m)^export (?:function|const) (\w+)", (folder / "index.d.ts").read_text())), exported)
        self.write("page.html", f'<!doctype html><script type="module">{module}\nwindow.npm = {{ {", ".join(exported)} }};</script>')
        with Page(self.folder / "page.html") as page:
            page.wait_for(lambda: page.evaluate("typeof npm === 'object'"), "the module does not run")
            record = page.evaluate("npm.ready.then(() => npm.simulate({ kappa: 100, t_end: 40, contact_distance: 0.1, rods: [[0, 2.5, 0], [0, -2.5, 0]] }))")
            self.assertEqual(record["outcome"], "contact")
            self.assertAlmostEqual(record["time"], 5.91709, delta=1e-5)  # side by side, as in studies/reports/rods.md
            self.assertEqual(page.errors, [])

    def tool(self):
        return runpy.run_path(str(TOOL))


class VerbTest(ProgramTest):
    def test_a_page_of_its_own(self):
        output = self.expect(0, "explore").stdout
        self.assertRegex(output, r"^explore\.html: \d+ kB")
        page = (self.folder / "explore.html").read_text()
        self.assertLess(len(page.encode()), 2e6)
        self.assertEqual(browser.references(page), [])
        self.refuse(2, "explore.html: already exists; --force replaces it", "explore")
        self.expect(0, "explore", "--force", "--quiet")

    def test_what_a_scene_has_and_the_page_has_not(self):
        self.write("three.toml", PAIR + "[noise]\nrotational_diffusion = 0.01\n[[rods]]\nposition = [9.0, 9.0]\n")
        for words in ("rods: 3; the page shows encounters of two", r"\[noise\]", r"medium.periodic = 40.0: .*infinite plane"):
            self.assertRegex(self.refuse(2, "no page of this scene", "explore", "three.toml", "-s", "medium.periodic=40.0").stderr, words)
        self.write("pair.toml", PAIR)
        self.refuse(2, "coupling.gamma_rows = 0.3", "explore", "pair.toml", "-s", "coupling.gamma_rows=0.3")
        self.refuse(2, "medium.fitted = true", "explore", SOURCE / "scenes/quickstart.toml")
        self.assertFalse((self.folder / "explore.html").exists())

    def test_beside_the_report_of_a_run_that_it_shows(self):
        self.write("pair.toml", PAIR)
        self.expect(0, "run", "pair.toml", "-o", "out")
        outcome = json.loads((self.folder / "out/outcome.json").read_text())
        self.assertIn('<a href="explore.html">Drag the rods</a>', (self.folder / "out/report.html").read_text())
        with Page(self.folder / "out/explore.html") as page:
            page.evaluate("rodwake.ready")
            self.assertEqual(page.evaluate("rodwake.page.paths.run.outcome"), outcome["outcome"])
            self.assertAlmostEqual(page.evaluate("rodwake.page.paths.run.time"), outcome["time"], delta=1e-6)
        self.assertIn("no explore.html: medium.periodic = 40.0", self.expect(0, "run", "pair.toml", "-o", "box", "-s", "medium.periodic=40.0").stdout)
        self.assertFalse((self.folder / "box/explore.html").exists())
        self.assertNotIn("explore.html", (self.folder / "box/report.html").read_text())

    def test_mistakes(self):
        self.write("one.toml", "schema = 1\n[medium]\neta = 1.0\nalpha = 1.0\n[[rods]]\nposition = [0.0, 0.0]\n[rods_run]\nt_end = 1.0\n")
        self.refuse(2, "rods: 1; the page shows encounters of two", "explore", "one.toml")
        self.refuse(2, "nowhere.toml", "explore", "nowhere.toml")
        self.refuse(2, "is a folder; -o names the page", "explore", "-o", ".")
        self.refuse(1, "cannot", "explore", "-o", "no/such/folder.html")


class NumbersTest(ProgramTest):
    """What the page computes beside what the program does."""

    def setUp(self):
        super().setUp()
        self.expect(0, "explore", "--quiet")

    def open(self):
        page = Page(self.folder / "explore.html")
        self.enterContext(page)
        page.evaluate("rodwake.ready")
        return page

    def test_outcomes_and_states(self):
        rows = starts(60)
        self.write("points.csv", "\n".join(",".join(str(value) for value in row) for row in [KEYS, *rows]) + "\n")
        self.write("scan.toml", PAIR.replace("t_end = 60.0\noutput_interval = 10.0", "t_end = 40.0")
                   + '[scan]\ndesign = "list"\nfile = "points.csv"\n')
        self.expect(0, "scan", "scan.toml", "-o", "scan", "--quiet")
        program = list(csv.DictReader(io.StringIO((self.folder / "scan/scan.csv").read_text())))
        page = self.open()
        found = page.evaluate(f"{json.dumps([problem(row) for row in rows])}.map(one => rodwake.simulate(one))")
        self.assertEqual([one["outcome"] for one in found], [one["outcome"] for one in program])
        self.assertGreater(len({one["outcome"] for one in found}), 2)
        for one, row in zip(found, program):
            self.assertAlmostEqual(one["time"], float(row["time"]), delta=1e-6)
            self.assertAlmostEqual(one["min_separation"], float(row["min_separation"]), delta=1e-5)  # near misses multiply rtol
        many = page.evaluate(f"""(() => {{
            const problems = {json.dumps([problem(row) for row in rows])};
            return [...rodwake.encounters(problems.flatMap(one => rodwake.flat(one, one.rods)), 1e-8)].filter((_, k) => k % 5 < 2);
        }})()""")
        names = ("contact", "pursuit", "escape", "undecided")
        self.assertEqual([names[int(code)] for code in many[::2]], [one["outcome"] for one in program])
        self.assertEqual(page.errors, [])

    def test_the_path_is_that_of_the_program(self):
        page = self.open()
        self.write("pair.toml", PAIR.replace("output_interval = 10.0", "") + "rtol = 1e-10\n")
        self.expect(0, "rods", "pair.toml", "-o", "pair", "--quiet")
        rods, record = columns((self.folder / "pair/rods.csv").read_text()), json.loads((self.folder / "pair/outcome.json").read_text())
        found = page.evaluate("rodwake.simulate({eta: 1, alpha: 1, kappa: 0.5, t_end: 60, contact_distance: 0.1, rtol: 1e-10,"
                              " rods: [[0, 2.5, 0], [0, -2.5, 0]]})")
        self.assertEqual(found["outcome"], record["outcome"])
        self.assertAlmostEqual(found["time"], 40.5953, delta=1e-4)
        last = dict(zip(("t", "x0", "y0", "theta0", "x1", "y1", "theta1"), found["path"][-1]))
        for name, value in last.items():
            self.assertAlmostEqual(value, rods[name][-1], delta=1e-6)

    def test_strain(self):
        points = [(0.5, 0.2, 1.0, 1.0), (-3.0, 0.1, 2.0, 0.3), (2.0, -4.0, 0.2, 5.0), (-40.0, 3.0, 30.0, 0.05), (1e-3, 1e-3, 1.0, 1.0)]
        self.write("points.csv", "x,y,xi,eta\n" + "".join(f"{x},{y},{1 / alpha!r},{eta}\n" for x, y, eta, alpha in points))
        exact = columns(self.expect(0, "field", "--points", "points.csv").stdout)
        page = self.open()
        for k, (x, y, eta, alpha) in enumerate(points):
            found = page.evaluate(f"rodwake.strain({x}, {y}, {{eta: {eta}, alpha: {alpha}}})")
            size = max(abs(exact[name][k]) for name in ("exx", "exy", "eyy"))
            for name, value in zip(("exx", "exy", "eyy"), found):
                self.assertAlmostEqual(value, exact[name][k], delta=1e-11 * size)  # the kernels' bound, with room for other last digits

    def test_other_problems(self):
        page = self.open()
        three = page.evaluate("rodwake.simulate({eta: 1, alpha: 1, kappa: 5, t_end: 5, rods: [[0, 2, 0], [0, -2, 0], [4, 1, 3]]})")
        self.assertEqual(len(three["path"][0]), 10)
        for call, words in (("rodwake.strain(0, 0)", "rod"), ("rodwake.simulate({rods: [[0, 0, 0]]})", "t_end is missing"),
                            ("rodwake.simulate({t_end: 1, rods: 3})", "rods must be a list"),
                            ("rodwake.simulate({t_end: -1, kappa: 1, rods: [[0, 0, 0], [1, 1, 1]]})", "t_end = -1: must be > 0"),
                            ("rodwake.simulate({t_end: 1, eta: -2, kappa: 1, rods: [[0, 0, 0], [1, 1, 1]]})", "eta")):
            self.assertRegex(page.evaluate(f"(() => {{ try {{ {call}; return 'fine'; }} catch (error) {{ return error.message; }} }})()"), words)


if __name__ == "__main__":
    rodwake.main()
