"""Figures of scans of beds as the program writes them: /usr/bin/python3 tests/plots/test_scan_beds.py"""

import contextlib
import csv
import io
import json
import unittest

import numpy as np

import made_up_scan as made_up
from scan_case import ScanCase
from rodwake_plots import run_dir, scan_columns, scan_words

RUNS = 40


class BedScanCase(ScanCase):
    """The made-up ensembles with intervals of their shares, counts of runs, and what scan.json tells of beds."""

    def build(self):
        made_up.write_bed_scan(self.folder)
        self.tell(subject="beds", points=21, runs=RUNS, bead_radius=0.0004, requested=21 * RUNS, evaluated=21 * RUNS, failed=RUNS,
                  outcomes={"contact": 100, "pursuit": 0, "escape": 700, "undecided": 0})
        self.change_rows(self.with_intervals)

    def tell(self, **keys):
        self.rewrite("scan.json", lambda text: json.dumps(json.loads(text) | keys))

    def change_rows(self, change):
        path = self.folder / "scan.csv"
        rows = [change(row) for row in csv.DictReader(path.read_text().splitlines())]
        path.write_text("\n".join(",".join(row) for row in [list(rows[0]), *(row.values() for row in rows)]) + "\n")

    @staticmethod
    def with_intervals(row):
        ends = {"contact_low": -0.05, "contact_high": 0.1}
        return row | {name: str(float(row["contact"]) + apart) if row["contact"] else "" for name, apart in ends.items()}


class BedScanTest(BedScanCase):
    def test_shares_have_their_intervals_as_bars(self):
        made, caption = self.draw("scan_curve", column="contact")
        drawn = [one for one in made.axes[0].containers if one.has_yerr]
        self.assertEqual(len(drawn), 3)
        for bars in drawn:
            below, above = self.ends(bars)
            np.testing.assert_allclose(below, 0.05, rtol=1e-9)  # differences of numbers near 1: rounding
            np.testing.assert_allclose(above, 0.1, rtol=1e-9)
        self.assertIn("bars: 95 % interval", caption)
        self.assertIn(f"{RUNS} runs each", caption)

    @staticmethod
    def ends(bars):
        y = bars[0].get_ydata()
        segments = np.array([segment[:, 1] for segment in bars[2][0].get_segments()])
        return y - segments[:, 0], segments[:, 1] - y

    def test_times_are_those_of_capture(self):
        """The lock of a pursuit has a time in a bed; a pursuit of the theory has none."""
        with run_dir.RunDir(self.folder) as run:
            self.assertEqual(scan_columns.label(run, "time", 1.0)[1], r"time to capture $t$ ($\mathrm{s}$)")
            self.assertEqual(scan_columns.meaning("time", run.scan), "")
            self.assertEqual(scan_columns.quantity("time", run.scan).of, ("contact", "pursuit"))
            self.tell(subject="rods")
        with run_dir.RunDir(self.folder) as run:
            self.assertEqual(scan_columns.quantity("time", run.scan).of, ("contact",))
            self.assertIn("no time of its own", scan_columns.meaning("time", run.scan))

    def test_lengths_are_in_a(self):
        made, _ = self.draw("scan_curve", column="delta_y")
        self.assertEqual([text.get_text() for text in made.axes[0].get_legend().get_texts()][:3],
                         [r"$y_{0} = 6\ a$", r"$y_{0} = 9\ a$", r"$y_{0} = 12\ a$"])
        with run_dir.RunDir(self.folder) as run:
            self.assertEqual(scan_columns.unit(run, "min_separation", 1.0), (1.0, "$a$"))
            self.assertEqual(scan_columns.unit_html(run, "time"), "s")

    def test_an_axis_is_called_as_the_scene_says(self):
        record = json.loads((self.folder / "scan.json").read_text())["axes"]
        self.tell(axes=[record[0], record[1] | {"label": "d_0"}])
        made, _ = self.draw("scan_curve", column="delta_y")
        self.assertEqual(made.axes[0].get_legend().get_texts()[0].get_text(), r"$d_0 = 6\ a$")
        self.tell(axes=[record[0], record[1] | {"label": r"\no{d"}])
        with contextlib.redirect_stderr(io.StringIO()) as said:
            made, _ = self.draw("scan_curve", column="delta_y")
        self.assertEqual(made.axes[0].get_legend().get_texts()[0].get_text(), r"\no{d $= 6\ a$")
        self.assertIn("scan axis granular.rods.0.position.1: label", said.getvalue())

    def test_runs_are_counted(self):
        with run_dir.RunDir(self.folder) as run:
            self.assertEqual(scan_words.outcomes_html(run.scan), "runs: contact 100, escape 700")
            rows = dict(scan_words.point_rows(run.scan))
            self.assertEqual(rows["Requested runs"], "840")
            self.assertTrue(rows["Outcome escape"].startswith("700"))

    def test_columns_that_say_something_of_another_are_no_choice(self):
        with run_dir.RunDir(self.folder) as run:
            names = scan_columns.names(run.scan)
        self.assertIn("contact", names)
        for name in ("contact_low", "contact_high", "delta_y_error"):
            self.assertNotIn(name, names)

    def test_without_half_a_box_another_number_is_drawn(self):
        self.change_rows(lambda row: row | {"delta_y": "", "delta_y_error": "", "mean_speed0": "0.002"})
        self.assert_drawn("phase_diagram", "scan_mean_speed0")


if __name__ == "__main__":
    unittest.main()
