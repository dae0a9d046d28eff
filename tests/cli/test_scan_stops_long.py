"""A hundred random kills of a scan, and chains of twenty. The moments: RODWAKE_TEST_SEED."""

import rodwake
from scans import ANY, KILL, StoppedScanTest


class KillTest(StoppedScanTest):
    SETTINGS = (*StoppedScanTest.SETTINGS, "-s", "scan.resolution=64")

    def test_kills(self):
        self.finish_often(100, 1, KILL, self.seconds)

    def test_chains(self):
        self.finish_often(30, 20, ANY, 0.2 * self.seconds)


if __name__ == "__main__":
    rodwake.main()
