"""The helpers of the tests of the program must be able to fail."""

import os
import signal
import subprocess
import time
from pathlib import Path

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
        self.refuse(2, "no such command", "nonsense")
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


class AloneTest(ProgramTest):
    def alone(self, *words, **environment):
        done = subprocess.run([Path(__file__).parent / "alone", self.folder, *words], capture_output=True, text=True,
                              env={"PATH": os.environ["PATH"], **environment})
        return done.returncode, done.stdout, done.stderr

    def test_the_environment_is_named(self):
        strange = {name: "strange" for name in ("CMAKE_PREFIX_PATH", "rodwake_ROOT", "OMP_NUM_THREADS", "MPLBACKEND", "XDG_CACHE_HOME", "LANG",
                                                "PYTHONPATH", "PYTHONSTARTUP", "RODWAKE_PROGRAM", "ZDOTDIR", "HOME", "LC_ALL", "TZ")}
        code, out, _ = self.alone("GIVEN=1", "env", **strange, TMPDIR="/dev/shm", RODWAKE_TEST_SEED="7")
        seen = dict(line.split("=", 1) for line in out.splitlines())
        self.assertEqual((code, seen.pop("PATH").split(":")[1:]), (0, os.environ["PATH"].split(":")))
        self.assertEqual(seen, {"HOME": str(self.folder), "LC_ALL": "C.UTF-8", "TZ": "UTC0", "TMPDIR": "/dev/shm", "RODWAKE_TEST_SEED": "7", "GIVEN": "1"})

    def test_the_rodwake_of_the_path_is_none(self):
        self.write("bin/rodwake", "#!/bin/sh\nexit 0\n").chmod(0o755)
        code, _, said = self.alone("sh", "-c", "rodwake info", PATH=f"{self.folder / 'bin'}:{os.environ['PATH']}")
        self.assertEqual(code, 70)
        self.assertIn("the rodwake of the PATH", said)


class CommandTest(ProgramTest):
    def test_one_thread_where_none_is_asked_for(self):
        for words, expected in ((("rods", "x.toml"), ["rods", "-j", "1", "x.toml"]), (("scan", "-j2"), ["scan", "-j2"]), ((), []),
                                (("dem", "--threads", 3), ["dem", "--threads", "3"]), (("field", "--points", "-"), ["field", "--points", "-"]),
                                (("check", "x.toml"), ["check", "x.toml"])):
            self.assertEqual(rodwake.command(*words)[1:], expected)


if __name__ == "__main__":
    rodwake.main()
