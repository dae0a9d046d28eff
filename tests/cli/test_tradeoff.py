"""rodwake tradeoff: measured once, answered from then on; the keys it prints make the run it promises."""

import csv
import json
import math

import rodwake
from rodwake import PAIR, ProgramTest

CONTRACT = ["method", "form", "field", "tolerance", "error", "seconds", "rhs_evaluations"]
SHORT = PAIR.replace("60.0", "8.0").replace("output_interval = 10.0", "output_interval = 2.0")


class TradeoffTest(ProgramTest):
    def setUp(self):
        super().setUp()
        self.write("pair.toml", SHORT)

    def test_measured_once_and_answered(self):  # one measurement for all of them
        front = self.expect(0, "tradeoff", "pair.toml", "-o", "out")
        self.assertIn("erk and adams agree to", front.stderr)
        self.assertIn("method, form, field", front.stdout)
        self.rows = list(csv.DictReader((self.folder / "out/tradeoff.csv").read_text().splitlines()))
        self.table_is_as_promised()
        self.the_figure_is_there()
        self.answers_come_from_the_table()
        self.keys_make_the_run()
        self.what_is_out_of_reach_is_reported()

    def table_is_as_promised(self):
        self.assertEqual(list(self.rows[0])[:7], CONTRACT)
        self.assertEqual({row["status"] for row in self.rows}, {"ok"})
        self.assertEqual({row["method"] for row in self.rows}, {"erk", "adams", "bdf"})
        self.assertEqual({row["form"] for row in self.rows}, {"angle", "director", "dae"})
        self.assertEqual({row["field"] for row in self.rows}, {"exact", "table"})
        record = json.loads((self.folder / "out/tradeoff.json").read_text())
        agreement, least = (record["reference"][key]["final_state"] for key in ("agreement", "least_error_quoted"))
        self.assertAlmostEqual(least / agreement, 10, delta=1e-6)
        self.assertGreaterEqual(min(float(row["error"]) for row in self.rows), 0.999 * least)  # six digits in the table

    def the_figure_is_there(self):
        self.assertGreater((self.folder / "out/figures/tradeoff.png").stat().st_size, 20000)
        files = json.loads((self.folder / "out/manifest.json").read_text())["files"]
        self.assertEqual([one["name"] for one in files["tradeoff.csv"]["columns"]][:7], CONTRACT)

    def answers_come_from_the_table(self):
        before = rodwake.snapshot(self.folder / "out")
        self.keys = self.expect(0, "tradeoff", "pair.toml", "-o", "out", "--for", "1e-6").stdout.splitlines()
        self.assertEqual(rodwake.snapshot(self.folder / "out"), before)
        good = [row for row in self.rows if float(row["error"]) <= 1e-6]
        best = min(good, key=lambda row: float(row["seconds"]))
        self.assertIn(f'rods_run.method = "{best["method"]}"', self.keys)
        self.assertIn(f'rods_run.form = "{best["form"]}"', self.keys)
        self.assertIn(f'medium.field = "{best["field"]}"', self.keys)
        slow = 1.01 * max(float(row["seconds"]) for row in self.rows)
        answer = self.expect(0, "tradeoff", "pair.toml", "-o", "out", "--within", f"{1e3 * slow} ms", "--error", "path").stdout
        least = min(float(row["path"]) for row in self.rows)
        best = min((row for row in self.rows if float(row["path"]) == least), key=lambda row: float(row["seconds"]))
        self.assertIn(f"rods_run.rtol = {float(best['tolerance']):g}\n", answer)

    def keys_make_the_run(self):
        settings = [part for key in self.keys for part in ("-s", key)]
        self.expect(0, "rods", "pair.toml", "-o", "fast", "--quiet", *settings)
        tight = ("-s", "rods_run.rtol=1e-12", "-s", "rods_run.method=adams")
        self.expect(0, "rods", "pair.toml", "-o", "tight", "--quiet", *tight)
        fast, exact = (self.last_row(name) for name in ("fast", "tight"))
        self.assertLessEqual(max(abs(a - b) for a, b in zip(fast, exact)), 1e-6 * (1 + 1e-3))

    def last_row(self, name):
        return [float(cell) for cell in (self.folder / name / "rods.csv").read_text().splitlines()[-1].split(",")[1:]]

    def what_is_out_of_reach_is_reported(self):
        self.refuse(1, "most accurate one has an error of", "tradeoff", "pair.toml", "-o", "out", "--for", "1e-30")
        self.refuse(1, "fastest one has an error of", "tradeoff", "pair.toml", "-o", "out", "--within", "1us")
        self.refuse(1, "no setting has a contact_time", "tradeoff", "pair.toml", "-o", "out", "--for", "1", "--error", "contact_time")
        self.assertTrue(all(math.isfinite(float(row["error"])) for row in self.rows))

    def test_what_cannot_be_asked(self):
        self.refuse(2, "--for and --within: give one of them", "tradeoff", "pair.toml", "--for", "1e-3", "--within", "1s")
        self.refuse(2, "--within", "tradeoff", "pair.toml", "--within", "5 parsec")
        self.refuse(2, "--error", "tradeoff", "pair.toml", "--error", "size")
        self.refuse(2, "--limit", "tradeoff", "pair.toml", "--limit=-1s")
        self.write("bed.toml", 'schema = 1\n[granular]\nphi_b = 0.5\nbox = "20 a"\nduration = "0.1 s"\n')
        self.refuse(2, "no .rods_run. table", "tradeoff", "bed.toml", "--of", "rods")

    def test_dry_run_does_nothing(self):
        output = self.expect(0, "tradeoff", "pair.toml", "--dry-run").stdout
        self.assertRegex(output, r"^\d+ settings would be timed")
        self.assertFalse((self.folder / "results").exists())


if __name__ == "__main__":
    rodwake.main()
