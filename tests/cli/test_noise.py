"""Rods that diffuse: what the ensemble says, that threads and stops change nothing, and what is refused."""

import csv
import json
import math
import re
import signal

import rodwake
from rodwake import ProgramTest, wait_until
from scans import journal_of

FREE = """schema = 1
[noise]
rotational_diffusion = 0.5
translational_diffusion = 0.05
runs = 4000
[[rods]]
position = [0.0, 0.0]
[[rods]]
position = [9.0, 0.0]
heading = 1.0
[rods_run]
output_times = [1.0, 4.0]
"""

PAIR = """schema = 1
[medium]
eta = 1.0
alpha = 1.0
[coupling]
kappa = 10.0
[noise]
rotational_diffusion = 0.03
runs = {runs}
[[rods]]
position = [0.0, 2.5]
[[rods]]
position = [0.0, -2.5]
[rods_run]
t_end = 20.0
output_interval = 1.0
contact_distance = 0.1
"""
RESULTS = ("noise.json", "ensemble.csv", "rods.csv", "outcome.json")


def wilson(count, of, z=1.959963984540054):
    p = count / of
    middle, half = p + z * z / (2 * of), z * math.sqrt(p * (1 - p) / of + z * z / (4 * of * of))
    return (middle - half) / (1 + z * z / of), (middle + half) / (1 + z * z / of)


class NoiseTest(ProgramTest):
    def results(self, run):
        return {name: (self.folder / run / name).read_bytes() for name in RESULTS}

    def record(self, run="out"):
        return json.loads((self.folder / run / "noise.json").read_text())

    def test_free_rods(self):
        self.write("free.toml", FREE)
        self.expect(0, "rods", "free.toml", "-o", "out")
        record = self.record()
        self.assertEqual((record["runs"], record["times"], record["runs_at_time"]), (4000, [0.0, 1.0, 4.0], [4000.0] * 3))
        self.assertEqual((record["mean_square_displacement"][0], record["heading_correlation"][0]), ([0.0, 0.0], [1.0, 1.0]))
        D = 0.5
        for k in (1, 2):
            t = record["times"][k]
            expected = {"mean_square_displacement": 2 / D**2 * (D * t - 1 + math.exp(-D * t)) + 4 * 0.05 * t, "heading_correlation": math.exp(-D * t)}
            for key, value in expected.items():
                for rod in (0, 1):  # 8 comparisons: 3.5 standard errors fail once in 270 seeds
                    self.assertLess(abs(record[key][k][rod] - value), 3.5 * record[f"{key}_error"][k][rod], key)
        self.assertEqual(record["endings"]["contact"], 0)

    def test_capture_and_threads(self):
        self.write("pair.toml", PAIR.format(runs=40))
        for threads in ("1", "2"):
            done = self.expect(0, "rods", "pair.toml", "-o", f"out{threads}", "-j", threads)
        self.assertEqual(self.results("out1"), self.results("out2"))
        self.assertEqual(json.loads((self.folder / "out1/provenance.json").read_text())["seed"], 1)
        record = self.record("out1")
        captures = sum(record["endings"][one] for one in ("contact", "pursuit"))
        self.assertIn(f"noise: {captures} of 40 runs end in contact or pursuit, capture probability", done.stdout + done.stderr)
        with open(self.folder / "out1/ensemble.csv", newline="", encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
        captured = sum(row["outcome"] in ("0", "1") for row in rows)
        self.assertEqual((len(rows), record["capture_probability"]), (40, captured / 40))
        for key, value in zip(("capture_low", "capture_high"), wilson(captured, 40)):
            self.assertAlmostEqual(record[key], value, 12)
        self.assertTrue(0 < captured < 40, "the scene tells nothing")
        contacts = [float(row["time"]) for row in rows if row["outcome"] == "0"]
        self.assertAlmostEqual(record["first_contact_time"]["mean"], sum(contacts) / len(contacts), 12)
        self.assertEqual(record["first_contact_time"]["runs"], len(contacts))
        outcome = json.loads((self.folder / "out1/outcome.json").read_text())
        self.assertEqual((outcome["time"], outcome["outcome"] == "contact"), (float(rows[0]["time"]), rows[0]["outcome"] == "0"))

    def test_too_few_runs_for_the_error_asked_for_are_reported(self):
        self.write("pair.toml", PAIR.format(runs=8).replace("runs = 8", "runs = 8\ncapture_error = 0.01\nmost_runs = 20"))
        done = self.expect(0, "rods", "pair.toml", "-o", "out")
        self.assertIn("stopped at noise.most_runs = 20 before the error of the capture probability fell to noise.capture_error = 0.01", done.stdout + done.stderr)

    def test_a_seed_makes_other_runs(self):
        self.write("pair.toml", PAIR.format(runs=3))
        for seed in ("1", "2"):
            self.expect(0, "rods", "pair.toml", "-o", f"out{seed}", "--seed", seed)
        self.assertNotEqual(self.results("out1"), self.results("out2"))
        self.assertEqual(self.record("out2")["seed"], 2)

    def test_without_noise_nothing_changes(self):
        quiet = PAIR.format(runs=1).replace("[noise]\nrotational_diffusion = 0.03\nruns = 1\n", "")
        self.write("quiet.toml", quiet)
        self.write("zero.toml", quiet + "[noise]\nrotational_diffusion = 0.0\n")
        for name in ("quiet", "zero"):
            self.expect(0, "rods", f"{name}.toml", "-o", name)
            self.assertFalse((self.folder / name / "noise.json").exists())
        self.assertEqual(*((self.folder / name / "rods.csv").read_bytes() for name in ("quiet", "zero")))

    def test_stopped_and_taken_up(self):
        self.write("pair.toml", PAIR.format(runs=600))
        self.expect(0, "rods", "pair.toml", "-o", "whole", "--quiet")
        progress = self.folder / "out/noise.log"
        with self.started("rods", "pair.toml", "-o", "out", "-j", "1", "--quiet") as process:
            wait_until(lambda: (progress.exists() and len(journal_of(progress)) > 1) or process.poll() is not None, 60)
            self.assertIsNone(process.poll(), "the run ended before it could be stopped")
            self.stop(process, signal.SIGTERM, 10.0)
        self.assertEqual(self.status("out"), "interrupted")
        self.assertFalse((self.folder / "out/noise.json").exists())
        again = self.expect(0, "rods", "pair.toml", "-o", "out")
        done = int(re.search(r"noise: resuming from run (\d+)", again.stderr)[1])
        self.assertTrue(0 < done < 600, done)
        self.assertEqual(self.results("out"), self.results("whole"))
        self.assertFalse(progress.exists())

    def test_refused(self):
        self.write("pair.toml", PAIR.format(runs=5))
        for setting, why in (("rods_run.method=bdf", "bdf, adams and erk take no noise: set method to \"auto\""),
                             ("rods_run.form=dae", "take form \"angle\" only"),
                             ("noise.rotational_diffusion=-0.1", "must be >= 0"), ("noise.translational_diffusion=-0.1", "must be >= 0"),
                             ("noise.runs=0", "must be >= 1"), ("noise.time_step=0", "must be > 0")):
            self.refuse(2, why, "rods", "pair.toml", "-s", setting, "-o", "out")
        self.refuse(2, "tradeoff compares methods that take no noise", "tradeoff", "pair.toml", "-o", "out")

    def test_scan(self):
        self.write("scan.toml", PAIR.format(runs=12) + """[scan]
design = "grid"
[[scan.axes]]
key = "noise.rotational_diffusion"
values = [0.0, 0.03, 1.0]
""")
        for threads in ("1", "2"):
            self.expect(0, "scan", "scan.toml", "-o", f"out{threads}", "-j", threads)
        read = [(self.folder / f"out{threads}/scan.csv").read_text() for threads in ("1", "2")]
        rows = [list(csv.DictReader(text.splitlines())) for text in read]
        keys = ("outcome", "time", "capture_probability", "capture_probability_low", "capture_probability_high")
        self.assertEqual(*([[row[key] for key in keys] for row in table] for table in rows))
        still, some, wild = ([float(row[key]) for key in keys[2:]] for row in rows[0])
        self.assertEqual(still, [1.0, 1.0, 1.0])
        self.write("pair.toml", PAIR.format(runs=12).replace("output_interval = 1.0\n", "output_times = [20.0]\n"))
        self.expect(0, "rods", "pair.toml", "-o", "one")
        self.assertEqual(some, [self.record("one")[key] for key in ("capture_probability", "capture_low", "capture_high")])
        self.assertLess(wild[0], some[0])
        self.refuse(2, "take no noise", "scan", "scan.toml", "-s", "rods_run.method=bdf", "-o", "bdf")

    def test_scan_with_more_runs_where_the_error_is_large(self):
        self.write("scan.toml", PAIR.format(runs=8).replace("rotational_diffusion = 0.03", "rotational_diffusion = 0.03\ncapture_error = 0.15\nmost_runs = 60")
                   + "[scan]\ndesign = \"grid\"\n[[scan.axes]]\nkey = \"noise.rotational_diffusion\"\nvalues = [0.0, 1e-6, 0.01, 0.03, 1.0]\n")
        names = ("noise.rotational_diffusion", "capture_probability", "capture_probability_low", "capture_probability_high", "capture_runs")
        tables = []
        for threads in ("1", "2"):
            self.expect(0, "scan", "scan.toml", "-o", f"out{threads}", "-j", threads)
            rows = csv.DictReader((self.folder / f"out{threads}/scan.csv").read_text().splitlines())
            tables.append([[float(row[name]) for name in names] for row in rows])
        self.assertEqual(*tables)
        for noise, share, low, high, runs in tables[0]:
            if noise == 0:
                self.assertEqual((share, low, high, runs), (1, 1, 1, 1))
                continue
            for value, expected in zip((low, high), wilson(round(share * runs), runs)):
                self.assertAlmostEqual(value, expected, 12)
            self.assertTrue(0.5 * (high - low) <= 0.15 or runs == 60)
            self.assertIn(runs, (8, 12, 18, 27, 41, 60))
        runs = [row[-1] for row in tables[0]]
        self.assertLess(runs[1], max(runs))  # certain capture takes fewer

    def test_stopped_and_resumed_runs_are_those_in_one_go(self):
        self.write("pair.toml", PAIR.format(runs=6).replace("runs = 6", "runs = 6\ncapture_error = 0.03"))
        self.expect(0, "rods", "pair.toml", "-o", "whole", "--quiet")
        self.assertGreater(self.record("whole")["runs"], 100)
        progress = self.folder / "parts/noise.log"
        with self.started("rods", "pair.toml", "-o", "parts", "-j", "1", "--quiet") as process:
            wait_until(lambda: (progress.exists() and len(journal_of(progress)) > 1) or process.poll() is not None, 60)
            self.assertIsNone(process.poll(), "the run ended before it could be stopped")
            self.stop(process, signal.SIGTERM, 10.0)
        self.expect(0, "rods", "pair.toml", "-o", "parts", "-j", "2", "--quiet")
        self.assertEqual(self.results("whole"), self.results("parts"))

    def test_runs_that_fail_are_reported(self):
        self.write("pair.toml", PAIR.format(runs=5))
        done = self.expect(1, "rods", "pair.toml", "-s", "rods_run.max_steps=20", "-o", "out")
        self.assertIn("5 of 5 runs failed, the first: ", done.stderr)
        self.assertEqual(self.record()["endings"]["failed"], 5)
        self.assertIsNone(self.record()["capture_probability"])


if __name__ == "__main__":
    rodwake.main()
