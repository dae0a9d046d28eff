"""A write, sync, rename, open, unlink or allocation fails: the program says so and ends with 1, or its results are whole; and
the same command goes on from there. A quick round; studies/validate_faults.py has the long one."""

import errno
import os
import tempfile
import unittest
from pathlib import Path

from faults import CALLS, ERRORS, VERBS, Bench, spread

SHIM = os.environ["RODWAKE_FAULTY_SYSTEM"]
MOST = {"write": 3, "fsync": 2, "rename": 2, "open": 2, "unlink": 2, "malloc": 2}  # faults of each verb


class Faults(unittest.TestCase):
    def bench(self, verb):
        folder = tempfile.TemporaryDirectory(prefix="rodwake-faults-")
        self.addCleanup(folder.cleanup)
        return Bench(verb, Path(folder.name), SHIM)

    def quick_round(self, verb):
        bench = self.bench(verb)
        seen = 0
        for call in CALLS:
            for k, number in enumerate(spread(bench.counts[call], MOST[call])):
                error = ERRORS[call][k % len(ERRORS[call])]
                with self.subTest(call=call, number=number, error=error):
                    wrong, done = bench.fault(call, number, error)
                    self.assertEqual(wrong, [], done.stderr)
                    seen += done.returncode == 1
        self.assertGreater(seen, 0, "no fault had any effect")

    def test_a_full_disk_is_reported_with_the_reason_of_the_system(self):
        bench = self.bench("rods")
        output = [bench.fault("write", number, errno.ENOSPC)[1].stderr for number in spread(bench.counts["write"], 8)]
        self.assertRegex("".join(output), "out/.*: cannot write: No space left on device")

    def test_a_fault_that_is_not_reported_is_seen(self):
        bench = self.bench("rods")
        place = bench.fresh()
        done = bench.run(place)
        self.assertEqual(bench.judge(place, done), [])
        (place / "out/rods.csv").write_text("t\n0\n")
        self.assertRegex(" ".join(bench.judge(place, done)), "silent: .*rods.csv")
        done.returncode = 1
        self.assertIn("failed, but recorded as finished", bench.judge(place, done))


for _verb in VERBS:
    if _verb not in ("plot", "tradeoff"):  # drawing takes seconds, and times differ: the long round has them
        setattr(Faults, f"test_{_verb}", lambda self, verb=_verb: self.quick_round(verb))

if __name__ == "__main__":
    unittest.main()
