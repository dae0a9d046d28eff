"""Tests of what makes the report a page to read: abstract, contents, links, values under the pointer: /usr/bin/python3 tests/plots/test_report_page.py"""

import io
import re
import unittest
from types import SimpleNamespace

import matplotlib.image
import numpy as np
from PIL import Image

from fit_case import FitCase, figure
from rodwake_plots import canvas, fit_result, page, report, run_dir, sections


def text(html):
    return re.sub("<[^>]*>", "", html)


class AbstractTest(FitCase):
    def sentences(self, **changes):
        self.rewrite(**changes)
        with run_dir.RunDir(self.folder) as run:
            return [text(one) for one in sections.sentences(run)]

    def test_whether_the_theory_fits(self):
        for chance, said in ((0.39, "fits Ux(x, 0) and Ux(0, y)"), (0.01, "fits only poorly"), (1e-5, "does not fit")):
            first = self.sentences(probability=chance)[0]
            self.assertTrue(first.startswith(f"The theory {said}"), first)
            self.assertIn("χ² = 61.3 for 59 degrees of freedom", first)

    def test_unknown_errors_give_no_verdict(self):
        self.assertIn("is unknown", self.sentences(error_factor=2.5)[0])
        self.assertIn("is unknown", self.sentences(dof=0)[0])

    def test_one_verdict(self):
        """All tests together: a small chi2 does not hide a region that is off, and no second sentence contradicts the first."""
        for worst, said in (("fit.h5, run 1, U_x, middle third has chi2 90 where 20 is expected", "run 1, Ux?.*has χ² 90"), ("chi2 is 61.3 for 59 degrees of freedom", "χ² = 61.3 for 59")):
            sentences = self.sentences(misfit={"describes": False, "probability": 1e-4, "worst": "/x/run/" * worst.startswith("fit") + worst})
            self.assertRegex(sentences[0], r"^The theory does not fit Ux\(x, 0\) and Ux\(0, y\) within the errors: ")
            self.assertIn("(p &lt; 0.001)", sentences[0])
            self.assertNotIn("/home", sentences[0])
            self.assertEqual(sum("fit " in one and "theory" in one for one in sentences), 1)

    def predicted(self, share, behind, ahead):
        """The sentence about a line whose data are off by so many sigma on each side of the rod."""
        self.rewrite(profiles=[one | {"independent": share, "excess": {"scale": 0.95, "stderr": 0.16}} for one in self.record["profiles"]])
        path = self.folder / "fit_profile_2.csv"
        rows = [line.split(",") for line in path.read_text().splitlines()]
        names = rows[0]
        for row in rows[1:]:
            one = dict(zip(names, map(float, row)))
            off = behind if one["x"] < 0 else ahead
            row[names.index("value")] = repr(one["model"] + off * one["sigma"])
        path.write_text("\n".join(map(",".join, rows)) + "\n")
        with run_dir.RunDir(self.folder) as run:
            return [text(one) for one in sections.sentences(run)][1]

    def test_predictions(self):
        sentences = self.predicted(0.25, 7.0, 0.5)
        self.assertRegex(sentences, r"^Uy\(x, 4 a\) was predicted, not fitted: behind the rod off by \d+ % \(rms 7 σ\), ahead within the errors \(rms 0\.5 σ\)\.$")
        sentences = self.predicted(0.25, 1.0, 0.5)
        self.assertIn("behind the rod within the errors (rms 1 σ), ahead within the errors (rms 0.5 σ); the data are (0.95 ± 0.16) times the theory.", sentences)

    def test_where_xi_comes_from(self):
        drag = {"value": 900.0, "stderr": None, "low": 900.0, "high": 900.0, "free": False, "fixed": True, "unit": "a^2", "start": 900.0, "bounds": [None, None]}
        sentences = self.sentences(parameters={name: one for name, one in self.record["parameters"].items() if name != "xi"} | {"drag_area": drag},
                              free=[name for name in self.record["free"] if name != "xi"], derived={"xi": {"value": 600.0, "stderr": 20.0, "unit": "a"}},
                              systematics={"held": [{"name": "drag_area", "error": 18.0}], "errors": {}})
        self.assertRegex(sentences[1], r"^ξ is not read from the map: it is the drag of the plates, .* = \(900 ± 18\) a2, measured in this run by the drift of the bed")
        self.assertNotIn("long wake", " ".join(sentences))  # there is no map whose box could be too small

    def test_other_values(self):
        self.assertEqual(self.sentences(chi2=18.5)[-1], "The values paper give χ² = 99.1, this fit 18.5.")

    def test_lines_that_are_there_twice_have_their_names(self):
        self.rewrite()
        fit = fit_result.FitResult(self.folder)
        one, two = fit.profiles[2], fit.profiles[2] | {"name": "ahead"}
        self.assertNotIn("profile_Uy_x", sections.predicted_place(fit, one))
        fit.record["profiles"].append(two)
        self.assertIn("<q>ahead</q>", sections.predicted_place(fit, two))


class PageTest(FitCase):
    def test_contents_lead_to_what_is_there(self):
        self.ask(figure("fit"), figure("fit_correlation", name="second"))
        self.assertEqual(self.plot("--pdf").returncode, 0)
        page = (self.folder / "report.html").read_text()
        links = re.findall(r'href="([^"]*)"', page)
        self.assertEqual([link for link in links if link.startswith("#figure-")], ["#figure-1", "#figure-2"])
        for link in links:
            self.assertTrue(f'id="{link[1:]}"' in page if link.startswith("#") else (self.folder / link).is_file(), link)
        for name in ("fit.json", "fit_profile_3.csv", "figures/fig.pdf", "figures/second.pdf", "scene.toml"):
            self.assertIn(name, links)
        self.assertEqual(page.count('<svg class="hover"'), 1)
        self.assertEqual(page.count("<circle"), page.count(", theory "))

    def test_how_to_make_it_again(self):
        run = SimpleNamespace(version="0.1.0", path=self.folder, output=self.folder, provenance={"command": "/usr/bin/rodwake scan 'my scene.toml' -j 2", "version": "0.2.0", "git": "abc",
                                                           "seed": 7, "wall_seconds": 12.7})
        made = text(report.reproduce(run))
        self.assertIn("rodwake scan scene.toml -o again", made)
        self.assertIn("rodwake 0.2.0, git abc, seed 7; it took 13 s", made)
        for other in ("rodwake.Scene.load('a.toml').set('x', 1).run('b', stages=['rods'])", "rodwake measure folder", "rodwake -j 2 scan a.toml", None):
            run.provenance = other and {"command": other}
            self.assertIn("rodwake run scene.toml -o again", text(report.reproduce(run)))

    def test_many_pictures_lose_colours_before_the_page_grows(self):
        noise = np.random.default_rng(0).random((300, 300, 3))
        out = io.BytesIO()
        matplotlib.image.imsave(out, noise, format="png", metadata={page.HOVER: "[[0.5,0.5,\"χ\"]]"})
        made = report.slim(out.getvalue())
        self.assertLess(len(made), 0.5 * len(out.getvalue()))
        self.assertEqual(page.hover_of_png(made), [[0.5, 0.5, "χ"]])


class HoverTest(unittest.TestCase):
    def test_a_place_is_where_the_point_is_drawn(self):
        made = canvas.figure(4, 3)
        axes = made.subplots()
        axes.plot([1.0], [20.0], "s", color="#ff0000", markersize=6, markeredgewidth=0)
        axes.set(xlim=(0, 4), ylim=(0, 100), xlabel="a long label below")
        made.legend(["outside"], loc="upper left", bbox_to_anchor=(1.0, 1.0))  # grows the picture to the right
        canvas.settle(made)
        found = page.hover_places(made, [(axes, 1.0, 20.0, "here"), (axes, 9.0, 20.0, "outside the panel")], made.bbox_inches)
        self.assertEqual([one[2] for one in found], ["here"])
        out = io.BytesIO()
        made.savefig(out, format="png", dpi=200, metadata=page.hover_metadata(found))
        self.assertEqual(page.hover_of_png(out.getvalue()), found)
        pixels = np.asarray(Image.open(out).convert("RGB")).astype(int)
        rows, columns = np.nonzero((pixels[..., 0] > 200) & (pixels[..., 1:].max(axis=-1) < 60))
        inner = columns < pixels.shape[1] * 0.6  # not the legend's
        self.assertAlmostEqual(columns[inner].mean() / pixels.shape[1], found[0][0], delta=0.006)
        self.assertAlmostEqual(rows[inner].mean() / pixels.shape[0], found[0][1], delta=0.006)

    def test_very_many_are_thinned_evenly(self):
        x, y = np.random.default_rng(1).random((2, 20000))
        kept = page.thinned(x, y, np.arange(20000))
        self.assertTrue(1200 < len(kept) <= 1600, len(kept))
        self.assertTrue(all(np.histogram2d(x[kept], y[kept], bins=10)[0].ravel() > 5))
        self.assertEqual(len(page.thinned(x, y, np.arange(100))), 100)

    def test_texts_stay_inside_and_are_escaped(self):
        made = page.hover_overlay([[0.1, 0.5, "a<b"], [0.9, 0.5, "c"]], 400, 300)
        self.assertIn("a&lt;b", made)
        self.assertEqual(made.count('text-anchor="end"'), 1)
        self.assertEqual(page.hover_overlay([], 400, 300), "")

    def test_a_picture_without_places(self):
        out = io.BytesIO()
        matplotlib.image.imsave(out, np.zeros((4, 4, 3)), format="png")
        self.assertEqual(page.hover_of_png(out.getvalue()), [])


if __name__ == "__main__":
    unittest.main()
