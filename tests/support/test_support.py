"""The helpers of the tests of the program must be able to fail."""

import signal
import time

import rodwake
from rodwake import PAIR, ProgramTest, snapshot, wait_until


class SupportTest(ProgramTest):
    def test_expect_wants_the_exit_code(self):
        self.expect(0, "info")
        with self.assertRaises(self.failureException):
            self.expect(1, "info")
        with self.assertRaises(self.failureException):
            self.expect(0, "no-such-verb")

    def test_refuse_wants_the_text_and_no_trace(self):
        self.refuse(2, "no such verb", "nonsense")
        with self.assertRaises(self.failureException):
            self.refuse(2, "another text", "nonsense")
        self.write("pair.toml", PAIR)
        with self.assertRaises(self.failureException):  # it works, and leaves files
            self.refuse(0, "", "rods", "pair.toml")

    def test_snapshot_sees_new_changed_and_touched_files(self):
        path = self.write("a/b", "1")
        first = snapshot(self.folder)
        self.assertEqual(snapshot(self.folder), first)
        time.sleep(0.01)
        path.write_text("1")
        touched = snapshot(self.folder)
        self.assertNotEqual(touched, first)
        self.write("c", "")
        self.assertNotEqual(snapshot(self.folder), touched)

    def test_temporaries_are_seen(self):
        self.assert_no_temporaries()
        self.write("run/result.h5.tmp12", "")
        with self.assertRaises(self.failureException):
            self.assert_no_temporaries()

    def test_wait_until_gives_up(self):
        self.assertFalse(wait_until(lambda: False, 0.05))
        self.assertTrue(wait_until(lambda: True, 0.0))

    def test_stop_fails_if_the_process_goes_on(self):
        self.write("long.toml", rodwake.crowd(300))
        with self.started("rods", "long.toml", "--quiet", preexec_fn=lambda: signal.pthread_sigmask(
                signal.SIG_BLOCK, {signal.SIGTERM})) as process:
            with self.assertRaisesRegex(self.failureException, "SIGTERM"):
                self.stop(process, signal.SIGTERM, 0.3)
        self.assertIsNotNone(process.returncode)


if __name__ == "__main__":
    rodwake.main()
