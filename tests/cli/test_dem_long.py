"""Two hundred random kills, and chains of twenty restarts. The moments: RODWAKE_TEST_SEED."""

import shutil
import signal

import rodwake
from beds import InterruptionTest

SIGNALS = (signal.SIGKILL, signal.SIGTERM)


class LongInterruptionTest(InterruptionTest):
    def test_kills(self):
        stopped = went_on = 0
        while stopped < 200:
            stopped += self.finish_after("run", 1, SIGNALS, 1.1 * self.seconds)
            went_on += any(step > 0 for step in self.steps_gone_on_from("run"))
            shutil.rmtree(self.folder / "run")
        self.assertGreater(went_on, 100)  # most moments come after the first checkpoint

    def test_chains(self):
        for _ in range(5):
            stopped = self.finish_after("run", 20, SIGNALS, 0.2 * self.seconds)
            self.assertGreaterEqual(stopped, 5)
            shutil.rmtree(self.folder / "run")


if __name__ == "__main__":
    rodwake.main()
