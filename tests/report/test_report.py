"""report.html in a browser: real runs, opened in headless Chromium in a wide and in a narrow window."""

import csv
import json
import math
import re
import subprocess
import sys
import tempfile
from pathlib import Path

import browser
import rodwake
from beds import BED
from rodwake import SOURCE, ProgramTest

sys.path[:0] = [str(SOURCE / "plots"), str(SOURCE / "tests" / "plots")]
from made_up_fit import write_fit  # noqa: E402
from rodwake_plots import words  # noqa: E402
from shorter import shorter  # noqa: E402

THEORY = """schema = 1
title = "A pair & its field"
[medium]
eta = 1.0
alpha = 1.0
[coupling]
kappa = 0.5
[[rods]]
position = [0.0, 1.0]
[[rods]]
position = [0.0, -1.0]
[rods_run]
t_end = 4.0
output_interval = 0.5
contact_distance = 0.1
[field]
x = [-4.0, 4.0]
y = [-3.0, 3.0]
nx = 41
ny = 31
[[field.cuts]]
along = "x"
from = -8.0
to = 4.0
count = 101
"""
FIT = """schema = 1
title = "A wake, fitted"
[fit]
parameters = ["f_over_mu", "eta", "xi"]
start = { f_over_mu = 1.0, eta = 2.0, xi = 2.0 }
starts = 3
likelihood = ["xi"]
[[fit.profiles]]
file = "profile.csv"
component = "Ux"
along = "x"
[[fit.compare]]
name = "twice as strong"
values = { f_over_mu = 4.0 }
"""
NARROW = 400  # pixels: a phone


def names(value):
    """The names in a JSON object and in the objects inside it."""
    return {key: names(inner) for key, inner in value.items()} if isinstance(value, dict) else None


class ReportCase(ProgramTest):
    def page_of(self, run):
        return (self.folder / run / "report.html").read_text(encoding="utf-8")

    def assert_good(self, page, figures, *headings):
        """Complete, with nothing fetched and nothing cut off, in a wide and in a narrow window."""
        self.assertEqual(browser.references(page), [])
        for width in (1200, NARROW):
            seen = browser.look(page, width)
            self.assertEqual(seen["width"], width)
            self.assertEqual((seen["errors"], seen["loaded"], seen["beyond"]), ([], [], []))
            self.assertTrue(seen["title"].strip())
            self.assertEqual((seen["figures"], len(seen["images"])), (figures, figures))
            for name, natural, shown in seen["images"]:
                self.assertGreater(natural, 0, f"{name}: does not decode")
                self.assertGreater(shown, 100, f"{name}: hardly to be seen")
            for heading in headings:
                self.assertIn(heading, seen["headings"])


class RealRunsTest(ReportCase):
    def test_theory(self):
        self.write("pair.toml", THEORY)
        self.expect(0, "run", "pair.toml", "-o", "out", "--quiet")
        self.assert_good(self.page_of("out"), 4, "Figures", "Parameters", "Solver", "Provenance")

    def test_bed(self):
        self.write("bed.toml", BED)
        self.expect(0, "run", "bed.toml", "-o", "out", "--quiet")
        figures = len(list((self.folder / "out/figures").glob("*.png")))
        self.assertGreaterEqual(figures, 4)
        self.assert_good(self.page_of("out"), figures, "Granular bed", "Provenance")

    def test_measured_bed(self):
        """The file behind the plots' made-up results: the program writes these names and no others."""
        data = SOURCE / "tests/plots/data"
        self.expect(0, "run", data / "measure.toml", "-o", "out", "--quiet", "-s", 'figures=[{name="bed",kind="snapshot"}]')
        made, kept = (json.loads((folder / "measure.json").read_text()) for folder in (self.folder / "out", data))
        self.assertEqual(names(made), names(kept), "write tests/plots/data/measure.json again, with the scene beside it")
        page = re.sub("<[^>]*>", "", self.page_of("out"))
        self.assertRegex(page, r"Lattice spacing\s*2\.[01]\d* a\s*of the beads")
        self.assertRegex(page, r"Grid spacing\s*1 a\s*of the grid")

    def test_fit_of_the_program(self):
        """A profile and a pair of the theory itself, with a wave laid over the profile."""
        self.write("pair.toml", THEORY)
        self.expect(0, "run", "pair.toml", "-o", "theory", "--quiet")
        rows = list(csv.DictReader((self.folder / "theory/field_cut_0.csv").read_text().splitlines()))
        self.write("profile.csv", "x,value,sigma\n" + "".join(
            f"{row['x']},{2 * float(row['Ux']) + 0.002 * math.sin(7 * i)},0.002\n" for i, row in enumerate(rows) if abs(float(row["x"])) > 0.5))
        self.write("fit.toml", FIT)
        self.expect(0, "run", "fit.toml", "-o", "out", "--quiet")
        page = self.page_of("out")
        self.assert_good(page, 4, "Fit")
        for one, truth in zip(json.loads((self.folder / "out/fit.json").read_text())["parameters"].values(), (2.0, 1.0, 1.0)):
            self.assertLess(abs(one["value"] - truth), 4 * one["stderr"])  # the wave is as good as noise of its size
            self.assertIn(words.with_error(one["value"], one["stderr"]), page)
        self.assertNotRegex(re.sub("<[^>]*>", "", page), r"\b(?:nan|inf|None|null)\b")

    def test_fit(self):
        write_fit(self.folder / "out", trajectories=1, remarks=["a word that is long: " + "f_over_mu" * 12])
        self.expect(0, "plot", "out", "--quiet")
        self.assert_good(self.page_of("out"), 5, "Fit")

    def test_the_quick_start(self):
        """The pipeline of tools/quickstart: bed, map, medium, rods in it; shorter, so its numbers mean nothing."""
        self.expect(0, "run", rodwake.SCENES / "quickstart.toml", "-o", "out", "--quiet", "-j", "2", *shorter("quickstart"))
        page = self.page_of("out")
        self.assert_good(page, 8, "Granular bed", "Fit", "Solver", "Provenance")
        found = json.loads((self.folder / "out/fit.json").read_text())
        for name in (*found["free"], "xi"):  # one error for each number, the whole one
            one = found["systematics"]["errors"][name]
            self.assertGreaterEqual(one["total"], one["jackknife"])
            self.assertIn(words.with_error(one["value"], one["total"]), page, name)
        self.assertIn("fitted medium", page)
        self.assertIn("alone gives", page)


class BrokenReportsTest(ReportCase):
    """The checks above see what is wrong."""

    @classmethod
    def setUpClass(cls):
        with tempfile.TemporaryDirectory(prefix="rodwake-test-") as folder:
            write_fit(Path(folder) / "out", profiles=(), trajectories=1, number_of_starts=1, likelihoods=(), names=("kappa",))
            subprocess.run(rodwake.command("plot", Path(folder) / "out", "--quiet"), check=True)
            cls.page = (Path(folder) / "out/report.html").read_text(encoding="utf-8")

    def refused(self, page, *found):
        with self.assertRaisesRegex(AssertionError, "|".join(found)):
            self.assert_good(page, 1)

    def test_as_it_is(self):
        self.assert_good(self.page, 1)

    def test_a_damaged_image(self):
        self.refused(re.sub(r"(base64,.{40})", r"\1AAAA", self.page, count=1), "does not decode", "cannot load")

    def test_a_missing_image(self):
        self.refused(re.sub(r"<img[^>]*>", "", self.page), r"\(1, 0\)")

    def test_what_is_fetched(self):
        for inside in ('<script src="https://example.org/a.js"></script>', '<img src="figures/fit.png">',
                       '<style>p { background: url("file:///a.png") }</style>', '<style>@import "a.css";</style>',
                       '<a href="http://example.org">more</a>', '<a href="../../secret.csv">data</a>', '<p style="background: url(a.png)"></p>'):
            self.refused(self.page.replace("<main>", "<main>" + inside), r"\[\] !=|!= \[\]")

    def test_the_browser_sees_what_is_fetched(self):
        """Without the look at the text."""
        seen = browser.look(self.page.replace("<main>", '<main><script src="https://example.org/a.js"></script>'))
        self.assertTrue(any("example.org" in text for text in seen["errors"]), seen)

    def test_an_error_in_a_script(self):
        for script, expected in (("nothing.at.all", "nothing is not defined"), ("console.error('alas')", "alas")):
            page = self.page.replace("<main>", f"<main><script>{script}</script>")
            self.refused(browser.unprotected(page), expected)
            self.refused(page, "Content Security Policy")

    def test_what_sticks_out_of_a_narrow_window(self):
        page = self.page.replace("<main>", '<main><div style="width: 500px">wide</div>')
        self.assertEqual(browser.look(page)["beyond"], [])
        self.refused(page, "DIV: wide")

    def test_no_title(self):
        self.refused(re.sub("<title>.*?</title>", "<title> </title>", self.page), "False is not true", "'' is not true")


if __name__ == "__main__":
    rodwake.main()
