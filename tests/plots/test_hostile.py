"""Run directories whose texts are hostile: no page runs or loads any of it: /usr/bin/python3 tests/plots/test_hostile.py"""

import json
import re
import shutil
import tempfile
import unittest
from pathlib import Path

import browser
import hostile
import made_up_scan as made_up
from hostile import ALIVE, NAME, TEXT, WATCH
from made_up_fit import write_fit
from made_up_measured import write_measured
from made_up_result import SCENE, write_result
from made_up_scan import KAPPA, METHOD, PLACE
from page_driver import Page
from test_medium_film import write_frames
from rodwake_plots import errors, page, scan_page


def write_theory(folder):
    folder.mkdir()
    (folder / "scene.toml").write_text(SCENE)
    (folder / "outcome.json").write_text(json.dumps({"outcome": "contact", "time": 4.0, "min_separation": 0.1, "pair": [0, 1],
                                                     "solver": {"method": "bdf", "steps": 321}}))
    (folder / "provenance.json").write_text(json.dumps({"version": "0.1.0", "command": "rodwake run a.toml", "libraries": {"HDF5": "1.10"},
                                                        "git": "abc", "cpu": "a processor", "stages": ["rods"], "status": "finished"}))
    mean = {"value": 0.85, "error": None, "samples": 1}
    (folder / "rods_order.json").write_text(json.dumps({
        "polar": mean, "nematic": mean, "mean_size": mean, "weighted_size": mean, "largest": mean, "link": 1.0, "from": 0.5, "block": 0.5,
        "blocks": 1, "units": {"length": "f/mu", "time": "f/(mu v0)"}}))
    (folder / "rods_order.csv").write_text("t,polar,nematic,clusters,mean_size,weighted_size,largest\n0,0.9,0.5,2,1.5,1.7,2\n")
    (folder / "clusters.csv").write_text("size,clusters,share\n1,0.5,0.1667\n2,0.5,0.3333\n")
    (folder / "log.txt").write_text(TEXT)
    write_result(folder, variants=1)
    write_frames(folder)


WORD = "<img src=x onerror=hit()>"
METHODS = METHOD | {"values": [WORD, "adams", "erk"]}
FOLDERS = {
    "theory": write_theory,
    "fit": lambda folder: write_fit(folder, trajectories=1, maps=1, remarks=["a remark"], flat=[{"text": "flat"}], number_of_starts=2),
    "bed": lambda folder: write_measured(folder, (0.8, 0.7), runs=2, labels=["looser"]),
    "refined": lambda folder: made_up.write_scan(folder, start=8, resolution=16, samples=4, failing=2),
    "choices": lambda folder: made_up.write_scan(folder, design="grid", axes=(PLACE, METHODS), count=7),
    "three": lambda folder: made_up.write_scan(folder, design="grid", axes=(PLACE, KAPPA, METHODS), count=4),
    "beds": made_up.write_bed_scan,
}


class HostileTest(unittest.TestCase):
    def setUp(self):
        self.place = Path(self.enterContext(tempfile.TemporaryDirectory(prefix="rodwake-hostile-")))
        self.copies = 0

    def made(self, folder, *changes):
        """Pages of a copy of the folder with these changes, none of which has anything alive; {} if there are none."""
        self.copies += 1
        copied = self.place / str(self.copies) / NAME
        shutil.copytree(folder, copied)
        for change in changes:
            change(copied)
        found, error = errors.attempt(hostile.pages, copied)
        shutil.rmtree(copied)
        self.assertTrue(found or not errors.reason(error).startswith("internal"), (changes, error))
        made, failures = found or ({}, [errors.reason(error)])
        for name, text in made.items():
            self.assertEqual([one for one in ALIVE if one in text], [], (name, changes))
        return made, failures

    def most_hostile(self, name):
        """Pages that are hostile wherever they can be and still hold all that they should."""
        folder = self.place / name
        FOLDERS[name](folder)
        self.assertEqual(self.made(folder)[1], [])
        kept = [change for change in hostile.changes(folder) if not self.made(folder, change)[1]]
        made, failures = self.made(folder, *kept)
        self.assertEqual(failures, [])
        return len(kept), made

    def test_nothing_runs(self):
        opened = 0
        (self.place / "blank.html").write_text("<!doctype html><title>blank</title>")
        with Page(self.place / "blank.html", first=WATCH) as tab:
            for name in FOLDERS:
                count, made = self.most_hostile(name)
                self.assertGreater(count, 5, name)
                for page_name, text in made.items():
                    self.assertIn("&lt;script&gt;hit()", text)
                    for how, shown in (("", text), ("-bare", browser.unprotected(text))):
                        path = self.place / f"{name}{how}-{page_name}"
                        path.write_text(shown, encoding="utf-8")
                        self.look(tab, path)
                        opened += 1
        self.assertGreaterEqual(opened, 13)

    def look(self, tab, path):
        """Nothing has run, nothing was loaded, and the page is whole."""
        tab.requests.clear()
        tab.go(path)
        if path.name.endswith("scan.html"):
            tab.evaluate("scanPage.ready")
            for point in (0, 1):
                tab.move(*tab.evaluate(f"scanPage.pointAt(scanPage.view.points[{point}])"))
                tab.click(*tab.evaluate(f"scanPage.pointAt(scanPage.view.points[{point}])"))
            tab.press("#select-view")
            self.assertGreater(tab.evaluate("document.querySelectorAll('#point td').length"), 3, path)
        else:
            self.assertEqual(tab.evaluate("[...document.images].filter(one => !one.naturalWidth).length"), 0, path)
            self.assertIn("Provenance", tab.evaluate("[...document.querySelectorAll('h2')].map(one => one.textContent)"), path)
        tab.evaluate("new Promise(done => setTimeout(done, 20))")
        self.assertEqual((tab.evaluate("hits"), tab.errors, tab.requests), (0, [], [path.resolve().as_uri()]), path)
        self.assertEqual(tab.evaluate("document.querySelectorAll('[onerror], [onload], [onfocus]').length"), 0, path)

    def test_the_policy_alone_stops_it(self):
        """Were a text not escaped one day."""
        folder = self.place / "fit"
        write_fit(folder)
        text = self.made(folder)[0]["report.html"].replace("<main>", f'<main><a href="javascript:hit()">x</a>{NAME}<script>hit()</script>')
        path = self.place / "page.html"
        for shown, hits in ((text, 0), (browser.unprotected(text), 3)):
            path.write_text(shown, encoding="utf-8")
            with Page(path, first=WATCH) as tab:
                tab.evaluate("document.querySelector('a').click()")
                tab.evaluate("new Promise(done => setTimeout(done, 100))")
                self.assertEqual(tab.evaluate("hits"), hits, tab.errors)
                self.assertEqual(any("Content Security Policy" in one for one in tab.errors), hits == 0, tab.errors)


class PiecesTest(unittest.TestCase):
    def test_json_in_a_page_holds_nothing_that_ends_a_script(self):
        content = {"a": TEXT, TEXT: ["\u2028\u2029&"]}
        text = page.json_text(content)
        self.assertEqual(json.loads(text), content)
        self.assertNotRegex(text, "[<>&\u2028\u2029]")

    def test_scripts_make_nodes_and_read_no_markup(self):
        for name in scan_page.SCRIPTS:
            self.assertNotRegex(scan_page.part(f"{name}.js"), r"innerHTML|outerHTML|insertAdjacentHTML|document\.write|\beval\b|new Function", name)

    def test_pages_hold_no_handlers(self):
        self.assertIsNone(re.search(r"\son\w+\s*=", scan_page.part("page.html")))


if __name__ == "__main__":
    unittest.main()
