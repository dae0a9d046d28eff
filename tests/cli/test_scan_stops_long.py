"""A hundred random kills of a scan on threads, a hundred of ranks under mpiexec, and chains of twenty. The moments: RODWAKE_TEST_SEED."""

import rodwake
from ranks import ScanRanksTest
from scans import ANY, KILL, StoppedScanTest


class KillTest(StoppedScanTest):
    SETTINGS = (*StoppedScanTest.SETTINGS, "-s", "scan.resolution=64")

    def test_kills(self):
        self.finish_often(100, 1, KILL, self.seconds)

    def test_chains(self):
        self.finish_often(30, 20, ANY, 0.2 * self.seconds)


class DeathTest(ScanRanksTest):
    def test_ranks(self):
        self.write("scan.toml", (self.folder / "scan.toml").read_text().replace("resolution = 32", "resolution = 64"))
        self.scan("scan.toml", "whole", "--quiet")
        for rank in (0, 1):
            self.finish_after_deaths(rank, 50)


if __name__ == "__main__":
    rodwake.main()
