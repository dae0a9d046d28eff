"""Two hundred random kills, and chains of twenty restarts. The moments: RODWAKE_TEST_SEED."""

import shutil
import signal

import rodwake
from beds import InterruptionTest, setting

SIGNALS = (signal.SIGKILL, signal.SIGTERM)


class KillTest(InterruptionTest):
    def test_kills(self):
        stopped = went_on = 0
        while stopped < 200:
            stopped += self.finish_after("run", 1, SIGNALS, 1.1 * self.seconds)
            went_on += any(step > 0 for step in self.steps_gone_on_from("run"))
            shutil.rmtree(self.folder / "run")
        self.assertGreater(went_on, 100)  # most moments come after the first checkpoint


class ChainTest(InterruptionTest):
    SETTINGS = (*setting(output__checkpoint=0.02, duration=20.0, output__frames=0.2), "--quiet")

    def test_chains(self):
        for _ in range(3):
            # 20 parts of a thirtieth on average: what is computed is lost in part, so the last one is still before the end.
            self.assertGreaterEqual(self.finish_after("run", 20, SIGNALS, self.seconds / 15.0), 15)
            shutil.rmtree(self.folder / "run")


if __name__ == "__main__":
    rodwake.main()
