"""Tests of scans whose files are missing or wrong, and of the report: /usr/bin/python3 tests/plots/test_scan_files.py"""

import json
import re
import shutil
import unittest

import h5py

from made_up_result import LINE, write_result
from made_up_result import SCENE as THEORY
from scan_case import ScanCase, figure  # first: puts the plots on the path
from rodwake_plots import scan_words


class FilesTest(ScanCase):
    """What is missing or wrong is named."""
    KEYS = dict(design="grid", count=7)

    def test_no_scan(self):
        (self.folder / "scan.json").unlink()
        write_result(self.folder)
        (self.folder / "outcome.json").write_text("{}")
        self.ask(figure())
        self.assert_fails("scan.json: no such file", "rodwake scan")

    def test_broken_files(self):
        for name, change, *words in (
                ("scan.json", lambda text: text[:-1], "scan.json: not valid JSON"),
                ("scan.json", lambda text: "[]", "not a JSON object"),
                ("scan.json", lambda text: json.dumps(json.loads(text) | {"axes": None}), "axes is missing"),
                ("scan.json", lambda text: json.dumps(json.loads(text) | {"axes": []}), "without axes"),
                ("scan.json", lambda text: text.replace('"from": 0.1, ', ""), "an axis is not as rodwake writes it: KeyError: 'from'"),
                ("scan.csv", lambda text: text.replace("outcome", "ending", 1), "column outcome is missing"),
                ("scan.csv", lambda text: text.replace("escape", "fled", 1), "'fled' is none of contact, pursuit"),
                ("scan.csv", lambda text: text.splitlines()[0] + "\n", "holds no points"),
                ("scan.csv", lambda text: text.replace("coupling.kappa", "kappa", 1), "column coupling.kappa is missing")):
            with self.subTest(words):
                self.build()
                self.rewrite(name, change)
                self.assert_fails(*words)

    def test_broken_cells(self):
        self.build(design="adaptive", start=8, resolution=16)
        self.rewrite("cells.csv", lambda text: text.replace("coupling.kappa_to", "kappa_to", 1))
        self.assert_fails("cells.csv: column coupling.kappa_to is missing")

    def test_no_cells_yet(self):
        """A refinement that was interrupted has its points alone."""
        self.build(design="adaptive", start=8, resolution=16)
        (self.folder / "cells.csv").unlink()
        made, _ = self.draw()
        self.assertEqual(len(made.axes[0].collections[0].get_offsets()), len(self.points))

    def test_broken_trajectories(self):
        with h5py.File(self.folder / "scan.h5", "r+") as file:
            del file["trajectories/x"]
        self.assert_fails("dataset /trajectories/x is missing")

    def test_keys_of_a_figure(self):
        for keys, words in ((dict(colour=3), "colour = 3 cannot be: string"), (dict(cells="yes"), "cells = yes cannot be: boolean (true, false)"),
                            (dict(slices=["a"]), "slices = ['a'] cannot be: 1 to 9 numbers")):
            self.ask(figure(**keys))
            self.assert_fails(words)

    def test_nothing_captured(self):
        self.rewrite("scan.csv", lambda text: text.replace("contact", "escape").replace("pursuit", "escape"))
        self.assert_drawn("phase_diagram", "phase_final_separation", "phase_non_reciprocity")
        self.ask(figure(colour="time"))
        self.assert_fails("column time holds no numbers of points that end in contact")


class ReportTest(ScanCase):
    KEYS = dict(start=8, resolution=64, failing=4)

    def page(self):
        done = self.plot()
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        return (self.folder / "report.html").read_text()

    def test_what_is_reported(self):
        self.ask(figure())
        page = re.sub("<[^>]*>", "", self.page())
        for part in ("Scan", "adaptive refinement to 64 cells a side", "Failed: the state is no longer finite4", "Missed rate0.2 %",
                     "Outcome contact", "0.1 to 100 μ v0/f", "logarithmic", "Stored trajectories24", scan_words.PAGE, "Axes"):
            self.assertIn(part, page)
        self.assertNotRegex(page, r"\b(?:nan|inf|None|null)\b")

    def test_beside_other_figures(self):
        """A scene that asks for figures, none of the scan, shows its phase diagram all the same."""
        write_result(self.folder)
        (self.folder / "outcome.json").write_text(json.dumps({"outcome": "contact", "time": 4.0, "min_separation": 0.1, "pair": [0, 1]}))
        (self.folder / "scene.toml").write_text(THEORY + LINE)
        self.assert_drawn("line", "phase_diagram")
        (self.folder / "scene.toml").write_text(THEORY + LINE.replace('"line"', '"phase_diagram"'))
        shutil.rmtree(self.folder / "figures")
        self.assert_drawn("phase_diagram", "phase_diagram_of_scan")


if __name__ == "__main__":
    unittest.main()
