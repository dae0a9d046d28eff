"""A hundred random kills of a scan, and chains of twenty. The moments: RODWAKE_TEST_SEED."""

import rodwake
from scans import ANY, KILL, StoppedScanTest


class KillTest(StoppedScanTest):
    SETTINGS = (*StoppedScanTest.SETTINGS, "-s", "scan.resolution=64")

    def test_kills(self):
        stopped = 0
        while stopped < 100:
            stopped += self.finish_after("run", 1, KILL, self.seconds)
            self.remove("run")

    def test_chains(self):
        for _ in range(3):
            self.assertGreaterEqual(self.finish_after("run", 20, ANY, 0.2 * self.seconds), 5)
            self.remove("run")


if __name__ == "__main__":
    rodwake.main()
