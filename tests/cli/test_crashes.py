"""A machine that stops at any moment leaves a folder that the same command finishes, to the bytes of an undisturbed run. A quick round;
studies/validate_crashes.py has the long one."""

import random
import tempfile
import unittest
from pathlib import Path

import crashes

STATES = 12  # of each verb


class Crashes(unittest.TestCase):
    def bench(self, verb):
        folder = tempfile.TemporaryDirectory(prefix="rodwake-crashes-")
        self.addCleanup(folder.cleanup)
        return crashes.Bench(verb, Path(folder.name) / "bench")

    def quick_round(self, verb):
        bench, seen = self.bench(verb), set()
        for number, state in enumerate(crashes.crash_states(bench.first, bench.record(bench.first), STATES, random.Random(1), seen)):
            with self.subTest(state=number):
                ending, wrong, message = bench.judge(state)
                self.assertEqual(wrong, "", f"{ending}: {message}")
        self.assertEqual(len(seen), STATES)

    def test_logs_of_a_bed_go_after_the_checkpoint_that_needs_them(self):
        bench = self.bench("dem")
        ops = bench.record(bench.first).ops

        def removed(ending):
            return [(number, op) for number, op in enumerate(ops) for path, file in op.names.items() if path.endswith(ending) and file is None]
        checkpoint, previous = removed("/checkpoint.rwc")[-1], removed("/checkpoint.rwc.previous")[-1]
        logs = removed(".log")
        self.assertGreater(len(logs), 0)
        self.assertLessEqual(max(checkpoint[1].safe, previous[1].safe), logs[0][0])
        self.assertLessEqual(checkpoint[1].safe, previous[0])  # the last state is in place first

    def test_what_the_end_of_a_bed_left_behind_is_removed(self):
        bench = self.bench("dem")
        tree = crashes.tree_of(bench.place)
        tree["out/checkpoint.rwc.previous"], tree["out/rows.log"] = tree["out/final.rwc"], b""
        tree["out/provenance.json"] = tree["out/provenance.json"].replace(b'"finished"', b'"interrupted"')
        del tree["out/manifest.json"]  # it would be written last
        self.assertEqual(bench.judge(tree)[:2], ("resumed", ""))
        self.assertFalse({"out/checkpoint.rwc.previous", "out/rows.log"} & crashes.tree_of(bench.place).keys())

    def test_what_a_crash_leaves(self):
        """Bytes without sync may be lost, in part or in whole; names that were not synced too."""
        recorder = crashes.Recorder("/r", {".": None})
        recorder.make("out", folder=True)
        recorder.sync(".")
        recorder.make("out/a")
        recorder.put("out/a", 0, b"12345678")
        recorder.sync("out/a")
        recorder.put("out/a", 8, b"9")

        def left(length, fate):
            return crashes.state_of({".": None}, recorder.ops, recorder.folders, length, lambda op: fate)
        self.assertEqual(left(4, 1), {".": None, "out": None, "out/a": b"123456789"})
        self.assertEqual(left(4, 0), {".": None, "out": None})  # the name was never synced
        recorder.sync("out")
        self.assertEqual(left(4, 0), {".": None, "out": None, "out/a": b"12345678"})
        self.assertEqual(left(4, -1)["out/a"], b"12345678\0")
        self.assertEqual(left(2, 0.5), {".": None, "out": None, "out/a": b""})

    def test_a_state_that_is_wrong_is_seen(self):
        bench = self.bench("rods")
        tree = dict(bench.first)
        bench.put(tree)
        bench.call(bench.command)
        tree = crashes.tree_of(bench.place)
        self.assertEqual(bench.judge(tree)[:2], ("finished", ""))
        tree["out/rods.csv"] = b"t\n0\n"
        self.assertRegex(bench.judge(tree)[1], "silent: .*rods.csv")


for _verb in ("rods", "scan", "dem"):
    setattr(Crashes, f"test_{_verb}", lambda self, verb=_verb: self.quick_round(verb))

if __name__ == "__main__":
    unittest.main()
