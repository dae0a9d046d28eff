"""rodwake scan of beds: shares, ranks of an MPI job, what check says, what is refused; rodwake dem on ranks."""

import json
import shutil

import rodwake
from ranks import RanksTest
from scans import ScanTest, axis, rows_of

BED = """schema = 1
[granular]
beads = 20
box = "30 a"
duration = "0.02 s"
equilibrate = "0 s"
runs = 3
[granular.output]
formats = []
last_period = false
"""
PAIR = """[[granular.rods]]
position = ["15 a", "6 a"]
[[granular.rods]]
position = ["15 a", "-6 a"]
"""
GRID = BED + PAIR + """[scan]
[[scan.axes]]
key = "granular.beads"
values = [10, 30, 20]
[[scan.axes]]
keys = ["granular.rods.0.position.1", "granular.rods.1.position.1"]
factor = [0.5, -0.5]
label = "d_0"
values = ["10 a", "14 a"]
"""
SERIES = BED + PAIR + """[[variants]]
name = "more"
set = { "granular.beads" = 30 }
"""
TABLES = ("scan.csv", "scan_runs.csv")


class BedScanTest(ScanTest):
    def setUp(self):
        super().setUp()
        self.write("beds.toml", GRID)

    def tables(self, run):
        return [(self.folder / run / name).read_bytes() for name in TABLES]

    def assert_same_tables(self, one, other):
        self.assertEqual(self.tables(one), self.tables(other))


class SameTest(BedScanTest, RanksTest):
    def test_ranks_do_not_change_a_byte(self):
        self.scan("beds.toml", "threads", "--quiet")
        for count in (2, 3):
            self.ranks(count, "scan", "beds.toml", "-o", f"ranks{count}", "--quiet")
            self.assert_same_tables("threads", f"ranks{count}")
        self.scan("beds.toml", "other", "--quiet", "--seed", 7)
        self.assertNotEqual(self.tables("threads"), self.tables("other"))

    def test_shares_are_the_whole_and_runs_are_added(self):
        self.scan("beds.toml", "whole", "--quiet")
        for part in (1, 2, 3):
            self.scan("beds.toml", "parts", "--part", f"{part}/3", "--quiet")
        self.scan("beds.toml", "parts", "--merge", "--quiet")
        self.assert_same_tables("whole", "parts")
        for run in ("whole", "parts"):
            self.scan("beds.toml", run, "--quiet", "-s", "granular.runs=4")
        self.assert_same_tables("whole", "parts")
        self.assertEqual({row["runs"] for row in self.rows("whole")}, {"4"})
        self.assertEqual((self.json("whole")["requested"], self.json("whole")["evaluated"]), (24, 24))

    def test_granular_ensembles_on_ranks(self):
        self.write("series.toml", SERIES)
        self.expect(0, "dem", "series.toml", "-o", "threads", "--quiet")
        self.ranks(2, "dem", "series.toml", "-o", "ranks", "--quiet")
        for name in ("runs.csv", "variants/more/runs.csv"):
            one, other = (rows_of(self.folder / run / name) for run in ("threads", "ranks"))
            self.assertEqual(len(one), 3)
            for row in one + other:
                del row["cpu_seconds"]
            self.assertEqual(one, other)
        self.ranks(2, "dem", "series.toml", "-o", "ranks", "--quiet", "-s", "granular.runs=5")
        self.assertEqual(len(rows_of(self.folder / "ranks/variants/more/runs.csv")), 5)

    def test_other_verbs_on_ranks_are_refused(self):
        done = self.ranks(2, "run", "beds.toml", "-o", "out", code=2)
        self.assertIn("only rodwake scan and rodwake dem work under mpiexec", done.stderr)
        self.assertFalse((self.folder / "out").exists())


class RepeatTest(RanksTest):
    """A run of an ensemble that came to no end is made by the next command, without the others."""

    def setUp(self):
        super().setUp()
        self.write("bed.toml", BED + PAIR)
        self.expect(0, "dem", "bed.toml", "-o", "whole", "--quiet", *self.LONG)

    LONG = ("-s", "granular.duration=0.2", "-s", "granular.runs=5")

    def ended(self):
        return {file.parent.name: file.read_bytes() for file in (self.folder / "out/runs").glob("*/summary.json")}

    def assert_ended_alone(self, before):
        """As in one go; of runs that were at their end not a byte, and so no CPU time, has changed."""
        after = self.ended()
        self.assertEqual({name: after[name] for name in before}, before)
        whole, out = (json.loads((self.folder / run / "summary.json").read_text()) for run in ("whole", "out"))
        self.assertEqual((out["state_hash"], out["finished_runs"]), (whole["state_hash"], 5))

    def fails_once(self, begin):
        begin(0, "-s", "granular.runs=2")
        in_the_way = self.folder / "out/runs/0003"
        in_the_way.write_text("")
        self.assertIn("runs/0003", begin(1).stderr)
        before = self.ended()
        self.assertEqual(sorted(before), ["0001", "0002", "0004", "0005"])
        in_the_way.unlink()
        begin(0)
        self.assert_ended_alone(before)

    def test_one_that_failed_on_threads(self):
        self.fails_once(lambda code, *more: self.expect(code, "dem", "bed.toml", "-o", "out", "--quiet", *self.LONG, *more))

    def test_one_that_failed_on_a_rank(self):
        self.fails_once(lambda code, *more: self.ranks(2, "dem", "bed.toml", "-o", "out", "--quiet", *self.LONG, *more, code=code))

    def test_a_rank_that_was_killed(self):
        for _ in range(10):  # the other rank may be at the end before the kill arrives
            shutil.rmtree(self.folder / "out", ignore_errors=True)
            with self.job(2, "dem", "bed.toml", "-o", "out", "--quiet", *self.LONG) as process:
                self.assertTrue(rodwake.wait_until(self.ended, 60))
                self.kill_rank_of(process, 1)
                self.await_end(process)
            before = self.ended()
            if 0 < len(before) < 5:
                break
        self.assertTrue(0 < len(before) < 5, before.keys())
        self.ranks(2, "dem", "bed.toml", "-o", "out", "--quiet", *self.LONG)
        self.assert_ended_alone(before)


class TableTest(BedScanTest):
    def test_intervals_hold_the_shares_and_errors_the_scatter(self):
        self.scan("beds.toml", "out", "--quiet")
        for row in self.rows("out"):
            self.assertEqual(row["status"], "ok")
            self.assertAlmostEqual(sum(float(row[name]) for name in ("contact", "pursuit", "escape", "undecided")), 1.0)
            for name in ("contact", "undecided"):
                self.assertLessEqual(float(row[f"{name}_low"]), float(row[name]))
                self.assertGreaterEqual(float(row[f"{name}_high"]), float(row[name]))
            mine = [float(one["T_xy"]) for one in self.rows("out", "scan_runs.csv") if one["granular.beads"] == row["granular.beads"]
                    and one["granular.rods.0.position.1"] == row["granular.rods.0.position.1"]]
            self.assertEqual(len(mine), 3)
            self.assertAlmostEqual(float(row["T_xy"]), sum(mine) / 3, delta=1e-15)  # of 1e-4: rounding
        self.assertEqual(self.json("out")["axes"][1]["label"], "d_0")

    def test_a_plot_of_what_was_scanned(self):
        self.write("beds.toml", GRID + '[[figures]]\nname = "speed"\nkind = "scan_curve"\ncolumn = "mean_speed0"\n')
        self.scan("beds.toml", "out", "--quiet")
        self.expect(0, "plot", "out", "--quiet")
        for name in ("figures/speed.png", "report.html", "scan.html"):
            self.assertTrue((self.folder / "out" / name).exists(), name)

    def test_run_scans_instead_of_the_bed_as_written(self):
        self.expect(0, "run", "beds.toml", "-o", "out", "--quiet", "--no-figures")
        self.assertEqual(self.status("out"), "finished")
        self.assertFalse((self.folder / "out/runs").exists())
        self.assertEqual(len(rows_of(self.folder / "out/scan.csv")), 6)


class CheckTest(BedScanTest):
    def test_check_counts_points_and_runs_and_tells_the_cost(self):
        output = self.expect(0, "check", "beds.toml").stdout
        self.assertIn("6 points (grid) of 3 runs of the bed each, 18 runs in all", output)
        self.assertRegex(output, r"scan: 18 runs, about .* CPU seconds each \(the bed as written\), .* in all")
        self.assertIn("20 beads of radius", output)

    def test_refused(self):
        for pattern, lines in (("granular.runs is how many runs each point of the scan has", axis("granular.runs", 1, 5, 5)),
                               ("granular.output.frames is not what a scan of beds can vary", axis("granular.output.frames", 1, 5, 5)),
                               ("coupling.kappa is not what a scan of beds can vary", axis("coupling.kappa", 1, 5, 5)),
                               ("outcomes of beds are random", 'design = "adaptive"\n' + axis("granular.beads", 10, 30, 64)),
                               ("6 points of 3 runs, 18 runs in all, more than scan.max_points = 17", "max_points = 17\n"
                                + axis("granular.beads", 10, 30, 6)),
                               ("at most 100000", axis("granular.plates.gamma", 1, 5, 100_001))):
            self.write("bad.toml", BED + PAIR + "[scan]\n" + lines)
            with self.subTest(pattern):
                self.refuse_scan(pattern, "bad.toml", "out")
                self.refuse(2, pattern, "check", "bad.toml")
        self.refuse_scan("makes the start of each run anew", "beds.toml", "out", "-s", "granular.start=restart",
                         "-s", "granular.restart_from=final.rwc")

    def test_another_bed_is_refused(self):
        self.scan("beds.toml", "out", "--quiet")
        self.refuse_scan("another scene|another scan", "beds.toml", "out", "-s", "granular.duration=0.03")


if __name__ == "__main__":
    rodwake.main()
