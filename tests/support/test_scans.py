"""The helpers of the tests of scans must be able to fail."""

import shutil

import numpy as np
import rodwake
from scans import KILL, ScanTest, StoppedScanTest


def last_bit_of_point_3(records):
    at = records["id"] == 3
    records["turn0"][at] = np.nextafter(records["turn0"][at], 10.0)


def a_second_more(records):
    records["seconds"] += 1.0


class ScansTest(ScanTest):
    def test_any_difference_is_seen(self):
        self.scan("grid.toml", "one", "--quiet")
        shutil.copytree(self.folder / "one", self.folder / "other")
        self.assert_same("one", "other")
        self.change_records("other", last_bit_of_point_3)
        self.assert_differ("one", "other")
        table = self.folder / "one/scan.csv"
        for change in (lambda text: text.replace("1", "2", 1), lambda text: text + "\n"):
            shutil.rmtree(self.folder / "other")
            shutil.copytree(self.folder / "one", self.folder / "other")
            self.write("other/scan.csv", change(table.read_text()))
            self.assert_differ("one", "other")

    def test_seconds_do_not_count(self):
        self.scan("grid.toml", "one", "--quiet")
        before = self.ledger("one")
        took = self.seconds("one")
        self.change_records("one", a_second_more)
        self.assertNotEqual(self.seconds("one"), took)
        self.assertEqual(self.ledger("one"), before)

    def test_another_file_of_trajectories_is_seen(self):
        self.scan("grid.toml", "one", "--quiet")
        self.scan("grid.toml", "other", "--quiet", "-s", "scan.trajectories=4")
        self.assert_differ("one", "other")

    def test_scan_wants_the_exit_code(self):
        with self.assertRaises(self.failureException):
            self.scan("grid.toml", "one", "-s", "rods_run.t_ende=1")

    def assert_differ(self, one, other):
        with self.assertRaises(self.failureException):
            self.assert_same(one, other)


class StoppedScansTest(StoppedScanTest):
    SETTINGS = (*StoppedScanTest.SETTINGS, "-s", "scan.resolution=16")

    def test_another_end_is_seen(self):
        self.scan("scan.toml", "run", *self.SETTINGS, "-s", "scan.boundary_tolerance=1e-2")
        with self.assertRaises(self.failureException):
            self.finish_after("run", 0, KILL, 0.0)


if __name__ == "__main__":
    rodwake.main()
