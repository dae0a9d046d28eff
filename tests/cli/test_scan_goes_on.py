"""Scans that go on: a larger resolution, shares, points that failed, and what is refused."""

import json
import shutil

import rodwake
from scans import CROSSING, LedgerFile, ScanTest, axis

# Steps that ten times as many do not make up for at the slow points.
FAILING = ("-s", "rods_run.max_steps=3")


class ExtendTest(ScanTest):
    def test_a_larger_resolution_goes_on(self):
        self.scan("scan.toml", "out")
        ids = {row[0] for row in self.ledger("out")[0]}
        done = self.scan("scan.toml", "out", "-s", "scan.resolution=64")
        self.assertIn("continuing a finished run", done.stderr)
        self.assertIn(f"{len(ids)} points are in the ledger already", done.stderr)
        rows, _ = self.ledger("out")
        self.assertLess(ids, {row[0] for row in rows})
        self.assertEqual((self.json("out")["resolution"], self.json("out")["evaluated"]), (64, len(rows)))
        # what the refinement asks for is there, as in a scan from the start
        self.scan("scan.toml", "anew", "-s", "scan.resolution=64", "-s", "scan.audit=0")
        self.assertLessEqual(set(self.ledger("anew")[0]), set(rows))
        self.assertEqual(self.json("anew")["requested"], 65 * 65)

    def test_more_samples_go_on(self):
        sobol = ("-s", "scan.design=sobol")
        self.scan("grid.toml", "out", *sobol, "-s", "scan.samples=20")
        before = self.ledger("out")[0]
        self.scan("grid.toml", "out", *sobol, "-s", "scan.samples=60")
        self.assertEqual(self.ledger("out")[0][:20], before)
        self.scan("grid.toml", "whole", *sobol, "-s", "scan.samples=60")
        self.assert_same("out", "whole")

    def test_a_finished_scan_is_left_alone(self):
        self.scan("grid.toml", "out")
        for more in ((), ("-j", "1")):
            self.refuse_scan("out: holds a finished run of this scene", "grid.toml", "out", *more, code=0)
        self.scan("grid.toml", "out", "--force")

    def test_what_is_gone_of_a_finished_scan_is_made_again(self):
        self.scan("scan.toml", "out")
        shutil.copytree(self.folder / "out", self.folder / "whole")
        for gone in (["scan.csv"], ["scan.h5", "cells.csv"], ["scan.json", "boundary.csv"], ["points.log"]):
            for name in gone:
                (self.folder / "out" / name).unlink()
            done = self.scan("scan.toml", "out")
            self.assertRegex(done.stderr, f"scan: {gone[-1]}.* gone; made again")
            self.assertEqual("are in the ledger already" in done.stderr, "points.log" not in gone)
            self.assert_same("out", "whole")
            self.refuse_scan("holds a finished run", "scan.toml", "out", code=0)

    def test_a_changed_scene_is_refused_with_what_changed(self):
        self.scan("grid.toml", "out")
        for setting, expected in (("coupling.gamma1=1", r"gamma1 = 0.0 there, gamma1 = 1.0 here"),
                              ("scan.axes.0.to=10", r"to = 100.0 there, to = 10 here"),
                              ("scan.axes.1.count=5", "count = 9 there, count = 5 here"),
                              ("rods_run.t_end=61", "t_end = 60.0 there, t_end = 61.0 here"),
                              ("scan.design=sobol", 'design = "grid" there, design = "sobol" here')):
            self.refuse_scan(rf"another (scene|scan) \({expected}\); choose another folder",
                             "grid.toml", "out", "-s", setting)
        self.refuse_scan("another (scene|scan)", "scan.toml", "out")
        self.scan("grid.toml", "out", "-s", "coupling.gamma1=1", "--force")
        self.assertIn("gamma1 = 1.0", (self.folder / "out/scene.toml").read_text())

    def test_a_changed_list_is_refused(self):
        self.write("list.toml", CROSSING + '[scan]\ndesign = "list"\nfile = "points.csv"\n')
        self.write("points.csv", "coupling.kappa\n0.5\n50\n")
        self.scan("list.toml", "out")
        self.write("points.csv", "coupling.kappa\n0.5\n60\n")
        self.refuse_scan(r"points.log: is the ledger of another scan \(list: 2 rows of coupling.kappa", "list.toml", "out",
                         "-s", "scan.trajectories=1")

    def test_another_seed_of_the_audit_goes_on(self):
        self.scan("scan.toml", "out")
        self.scan("scan.toml", "out", "--seed", "5")
        self.assertEqual(json.loads((self.folder / "out/provenance.json").read_text())["seed"], 5)


class ShareTest(ScanTest):
    def shares(self, numbers, of):
        for number in numbers:
            self.scan("grid.toml", "out", "--part", f"{number}/{of}", "--quiet")

    def test_shares_merged_are_the_whole(self):
        self.scan("grid.toml", "whole")
        self.shares((3, 1, 2), 3)
        self.assertEqual([self.json(f"out/part-{n}-of-3")["evaluated"] for n in (1, 2, 3)], [27, 27, 27])
        done = self.scan("grid.toml", "out", "--merge")
        self.assertIn("3 shares taken over", done.stderr)
        self.assert_same("out", "whole")

    def test_what_is_missing_is_evaluated(self):
        self.scan("grid.toml", "whole")
        self.shares((1, 3), 4)
        self.scan("grid.toml", "out", "--merge")
        self.assert_same("out", "whole")
        self.scan("grid.toml", "out", "--merge")  # again, though it is finished
        self.assert_same("out", "whole")

    def test_a_share_that_is_computed_again_is_refused_or_goes_on(self):
        self.shares((1,), 2)
        self.refuse_scan("part-1-of-2: holds a finished run", "grid.toml", "out", "--part", "1/2", code=0)

    def test_wrong_shares(self):
        for part in ("0/3", "4/3", "1", "1/0", "a/b", "1/2x", "-1/2"):
            self.refuse_scan("--part", "grid.toml", "out", f"--part={part}")
        self.refuse_scan("--part and --merge: give one of them", "grid.toml", "out", "--part", "1/2", "--merge")
        self.refuse_scan("an adaptive scan cannot be computed in parts", "scan.toml", "out", "--part", "1/2")
        self.refuse_scan("out: holds no shares", "grid.toml", "out", "--merge")
        self.shares((1,), 2)
        self.refuse_scan(r"part-1-of-2/points.log: is the ledger of another scan \(.*t_end", "grid.toml", "out", "--merge",
                         "-s", "rods_run.t_end=61")
        (self.folder / "out/part-2-of-2").mkdir()
        self.refuse_scan("part-2-of-2/points.log: no such ledger", "grid.toml", "out", "--merge")


class FailureTest(ScanTest):
    def test_points_that_fail_are_reported_and_evaluated_again(self):
        self.scan("grid.toml", "clean")
        done = self.scan("grid.toml", "out", *FAILING, code=3)
        record, rows = self.json("out"), self.rows("out")
        failed = [row for row in rows if row["status"] == "failed"]
        self.assertEqual((record["evaluated"], record["failed"], record["left"]), (81, len(failed), 0))
        self.assertGreater(len(failed), 5)
        self.assertLess(len(failed), 81)
        self.assertEqual(sum(record["causes"].values()), len(failed))
        self.assertIn(f"{len(failed)} points failed; --rerun-failed evaluates them again", done.stderr)
        for cause, count in record["causes"].items():
            self.assertIn("the steps allowed were used up", cause)
            self.assertRegex(done.stderr, rf"{count}  failed: ")
        for row in failed:
            self.assertEqual((row["outcome"], row["time"], row["turn0"], row["retries"]), ("", "", "", "3"))
        self.assertEqual(self.status("out"), "finished")
        self.refuse_scan("holds a finished run", "grid.toml", "out", *FAILING, code=0)
        self.again(rows, {row[0] for row in self.ledger("out")[0] if row[4] == "failed"})

    def test_causes_that_differ_in_numbers_are_one(self):
        """Rods that walk head-on into each other, without a contact distance: each point fails with other numbers."""
        scene = (CROSSING.replace("contact_distance = 0.1\n", "").replace('"90 deg"', '"180 deg"').replace("0.0, -4.0", "4.0, 0.0")
                 + "[scan]\n" + axis("rods.1.position.0", 2.3, 7.1, 4))
        self.write("head_on.toml", scene)
        self.assertIn("# is this what you mean?\n  scan without rods_run.contact_distance", self.expect(0, "check", "head_on.toml").stdout)
        done = self.scan("head_on.toml", "out", code=3)
        (cause, count), = self.json("out")["causes"].items()
        self.assertEqual((count, self.json("out")["failed"]), (4, 4))
        self.assertIn("set rods_run.contact_distance, so that the run stops when two rods meet", cause)
        self.assertEqual(done.stderr.count("COLLISION"), 1)
        self.assertRegex(done.stderr, rf"  {count}  failed: .*COLLISION: .*\n.*one of them at rods\.1\.position\.0 = ")
        self.write("head_on.toml", scene.replace("t_end = 60.0", "t_end = 60.0\ncontact_distance = 0.1"))
        self.assertNotIn("is this what you mean", self.expect(0, "check", "head_on.toml").stdout)
        self.scan("head_on.toml", "met")
        self.assertEqual({row["outcome"] for row in self.rows("met")}, {"contact"})

    def again(self, before, failed):
        """With steps enough only these points are evaluated again, to what they are in the clean scan."""
        kept = dict((row[0], row) for row in self.ledger("out")[0] if row[0] not in failed)
        records = len(LedgerFile(self.folder / "out/points.log").records)
        done = self.scan("grid.toml", "out", "--rerun-failed")
        self.assertIn(f"{len(failed)} points that failed are evaluated again", done.stderr)
        evaluated = {row[0] for added in LedgerFile(self.folder / "out/points.log").records[records:] for row in added}
        self.assertEqual(evaluated, failed)
        clean = {row[0]: row for row in self.ledger("clean")[0]}
        for row in self.ledger("out")[0]:
            self.assertEqual(row, kept.get(row[0], clean[row[0]]))
        self.assertEqual(len(self.rows("out")), len(before))

    def test_points_that_fail_again(self):
        self.scan("grid.toml", "out", *FAILING, code=3)
        before = self.ledger("out")
        self.scan("grid.toml", "out", *FAILING, "--rerun-failed", code=3)
        self.assertEqual(self.ledger("out"), before)

    def test_a_limit_of_time(self):
        self.scan("grid.toml", "out", "-s", "scan.time_limit=1e-9", code=3)
        self.assertEqual({row["status"] for row in self.rows("out")}, {"time_limit"})
        self.assertEqual(self.json("out")["outcomes"], {"contact": 0, "pursuit": 0, "escape": 0, "undecided": 0, "orbit": 0, "bound": 0})
        self.scan("grid.toml", "out", "-s", "scan.time_limit=1000", "--rerun-failed")
        self.scan("grid.toml", "clean")
        self.assertEqual(self.results("out"), self.results("clean"))

    def test_a_scan_with_failures_that_is_refined(self):
        self.scan("scan.toml", "out", *FAILING, code=3)
        self.scan("scan.toml", "out", "--rerun-failed")
        self.assertEqual(self.json("out")["failed"], 0)
        self.assertEqual({row["status"] for row in self.rows("out")}, {"ok"})
        self.assertGreater(self.json("out")["boundary"]["points"], 0)


class LedgerTest(ScanTest):
    """Ledgers that cannot be gone on with are reported before anything in the folder is touched."""

    def setUp(self):
        super().setUp()
        self.scan("grid.toml", "out", "--quiet")
        self.file = self.folder / "out/points.log"

    def refuse_out(self, pattern):
        self.refuse_scan(pattern, "grid.toml", "out", "-s", "scan.trajectories=1")

    def test_of_another_version(self):
        data = bytearray(self.file.read_bytes())
        data[8] = 7
        self.file.write_bytes(data)
        self.refuse_out("points.log: is a journal of another version of rodwake")
        self.file.rename(self.file.with_name("ledger.sqlite"))
        self.refuse_out("ledger.sqlite: is the ledger of a scan of rodwake 0.3, which cannot be resumed; choose another folder")

    def test_cut_short_or_damaged(self):
        """What is whole is kept; the rest is evaluated again, to the same results."""
        self.scan("grid.toml", "whole", "--quiet")
        data = self.file.read_bytes()
        flipped = bytearray(data)
        flipped[len(data) // 2] ^= 1
        for content in (data[:len(data) // 2], data[:-10], flipped):
            self.file.write_bytes(content)
            (self.folder / "out/scan.csv").unlink()
            done = self.scan("grid.toml", "out")
            self.assertEqual("records of the ledger are damaged; their points are evaluated again" in done.stderr, content is flipped)
            self.assert_same("out", "whole")

    def test_of_something_else(self):
        self.file.write_text("nothing of the kind " * 100)
        self.refuse_out("points.log: is not a journal of rodwake")

    def test_lost(self):
        """Without its ledger a scan starts again."""
        before = self.results("out")
        self.file.unlink()
        self.scan("grid.toml", "out", "-s", "scan.trajectories=1")
        self.assertEqual(self.results("out"), before)

    def test_of_another_folder(self):
        self.scan("scan.toml", "other", "--quiet")
        shutil.copy(self.folder / "other/points.log", self.file)
        self.refuse_out(r"points.log: is the ledger of another scan \(.* there, .* here\)")

    def test_two_scans_at_a_time(self):
        with self.started("scan", "scan.toml", "-o", "busy", "-s", "scan.resolution=4096", "--quiet") as process:
            self.assertTrue(rodwake.wait_until(lambda: (self.folder / "busy/points.log").exists(), 60))
            done = self.run_program("scan", "scan.toml", "-o", "busy", "-s", "scan.resolution=4096")
            self.assertEqual(done.returncode, 2)
            self.assertRegex(done.stderr, "busy.* (used|process)")
            self.assertIsNone(process.poll())


if __name__ == "__main__":
    rodwake.main()
