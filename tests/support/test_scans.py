"""The helpers of the tests of scans must be able to fail."""

import shutil
import struct

import rodwake
from scans import KILL, LedgerFile, ScanTest, StoppedScanTest


class ScansTest(ScanTest):
    def test_any_difference_is_seen(self):
        self.scan("grid.toml", "one", "--quiet")
        shutil.copytree(self.folder / "one", self.folder / "other")
        self.assert_same("one", "other")
        ledger = self.folder / "other/points.log"
        content = ledger.read_bytes()
        number, kappa = LedgerFile(ledger).records[0][0][:2]
        at = content.index(struct.pack("<qd", number, kappa)) + 8
        ledger.write_bytes(content[:at] + bytes([content[at] ^ 1]) + content[at + 1:])  # the last bit of kappa
        self.assert_differ("one", "other")
        table = self.folder / "one/scan.csv"
        for change in (lambda text: text.replace("1", "2", 1), lambda text: text + "\n"):
            shutil.rmtree(self.folder / "other")
            shutil.copytree(self.folder / "one", self.folder / "other")
            self.write("other/scan.csv", change(table.read_text()))
            self.assert_differ("one", "other")

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
