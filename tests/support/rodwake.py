"""Runs the program as a user does: in a fresh folder, with what it prints and leaves to look at."""

import atexit
import contextlib
import json
import os
import shutil
import signal
import subprocess
import tempfile
import time
import unittest
from pathlib import Path

PROGRAM = Path(os.environ.get("RODWAKE_PROGRAM", "rodwake"))
SOURCE = Path(os.environ.get("RODWAKE_SOURCE_DIR", Path(__file__).parents[2]))
SCENES = SOURCE / "scenes"
THEORY_PAIR = SCENES / "pair.toml"

PAIR = """schema = 1
title = "a pair"
[medium]
eta = 1.0
alpha = 1.0
[coupling]
kappa = 0.5
[[rods]]
position = [0.0, 2.5]
[[rods]]
position = [0.0, -2.5]
[rods_run]
t_end = 60.0
output_interval = 10.0
contact_distance = 0.1
"""

STAGE_VERBS = {"field", "rods", "dem", "measure", "fit", "scan", "tradeoff", "run"}


def command(*arguments):
    """The program with these arguments, on one thread if they do not say how many: tests run beside each other."""
    words = [str(word) for word in arguments]
    given = any(word.startswith(("-j", "--threads", "--points")) for word in words)  # points of a field make no use of threads
    return [PROGRAM, *words[:1], *(["-j", "1"] if words and words[0] in STAGE_VERBS and not given else []), *words[1:]]


def crowd(count, spacing=3.0):
    """A scene of many rods walking apart on a square lattice: minutes of work for some hundred."""
    side = int(count**0.5)
    rods = "".join(f"[[rods]]\nposition = [{spacing * (k % side)}, {spacing * (k // side)}]\nheading = {k % 7}.0\n"
                   for k in range(count))
    return ("schema = 1\n[medium]\neta = 1.0\nalpha = 1.0\n[coupling]\nkappa = 0.001\n"
            "[rods_run]\nt_end = 1000.0\nrtol = 1e-12\n" + rods)


def snapshot(folder):
    """Content and time of change of every file below a folder, by relative name."""
    return {str(path.relative_to(folder)): (path.read_bytes(), path.stat().st_mtime_ns)
            for path in sorted(Path(folder).rglob("*")) if path.is_file()}


def wait_until(condition, seconds):
    """Returns whether the condition came true in that time."""
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        if condition():
            return True
        time.sleep(0.02)
    return bool(condition())


FINISHED = {}  # of made_once(), removed when the process ends


class ProgramTest(unittest.TestCase):
    """Each test has a fresh current folder, self.folder."""

    def setUp(self):
        keeper = tempfile.TemporaryDirectory(prefix="rodwake-test-")
        self.addCleanup(keeper.cleanup)
        self.folder = Path(keeper.name)

    def write(self, name, text):
        path = self.folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, newline="")
        return path

    def run_program(self, *arguments, env=None, **options):
        """The finished process; never raises for an exit code."""
        return subprocess.run(command(*arguments), cwd=self.folder, text=True, capture_output=True, timeout=600,
                              env={**os.environ, **(env or {})}, **options)

    def expect(self, code, *arguments, **options):
        """Runs, checks the exit code, and that an error is reported on stderr and only there; returns the process."""
        done = self.run_program(*arguments, **options)
        self.assertEqual(done.returncode, code, f"{arguments}\nstdout: {done.stdout}\nstderr: {done.stderr}")
        if code in (1, 2):
            self.assertEqual(done.stdout, "", arguments)
            self.assertNotEqual(done.stderr, "", arguments)
        return done

    def made_once(self, run, *arguments):
        """The folder of a finished run: the program makes it for the first test that asks for these scenes and arguments, the others
        get a copy."""
        key = (arguments, *(path.read_text() for path in sorted(self.folder.glob("*.toml"))))
        if key in FINISHED:
            shutil.copytree(Path(FINISHED[key].name) / "run", self.folder / run)
        else:
            self.expect(0, *arguments, "-o", run)
            FINISHED[key] = tempfile.TemporaryDirectory(prefix="rodwake-finished-")
            atexit.register(FINISHED[key].cleanup)
            shutil.copytree(self.folder / run, Path(FINISHED[key].name) / "run")
        return self.folder / run

    def refuse(self, code, pattern, *arguments, **options):
        """An error with this text that leaves no file behind or changed."""
        before = snapshot(self.folder)
        done = self.expect(code, *arguments, **options)
        self.assertRegex(done.stderr, pattern)
        self.assertEqual(snapshot(self.folder), before, arguments)
        return done

    def status(self, run):
        return json.loads((self.folder / run / "provenance.json").read_text())["status"]

    def assert_no_temporaries(self):
        self.assertEqual([p for p in self.folder.rglob("*") if ".tmp" in p.name], [])

    @contextlib.contextmanager
    def started(self, *arguments, **options):
        """The running process; killed if the block leaves it running."""
        process = subprocess.Popen(command(*arguments), cwd=self.folder, text=True, stdout=subprocess.PIPE,
                                   stderr=subprocess.PIPE, **options)
        try:
            yield process
        finally:
            if process.poll() is None:
                process.kill()
            process.communicate()

    def stop(self, process, number, seconds):
        """Sends the signal; exit code, stdout and stderr, and fails if the process needs longer than `seconds`."""
        process.send_signal(number)
        try:
            out, err = process.communicate(timeout=seconds)
        except subprocess.TimeoutExpired:
            self.fail(f"still running {seconds} s after {signal.Signals(number).name}")
        return process.returncode, out, err

    def interrupt(self, number, seconds, *arguments):
        """Signals the program after this time; whether it still ran. One that ended before must have ended well."""
        with subprocess.Popen(command(*arguments), cwd=self.folder, stdout=subprocess.DEVNULL,
                              stderr=subprocess.PIPE, text=True) as process:
            try:
                time.sleep(seconds)
                process.send_signal(number)
                _, err = process.communicate(timeout=30)
            finally:
                process.kill()
        expected = (0, -signal.SIGKILL if number == signal.SIGKILL else 128 + number)
        if process.returncode == -number != expected[1]:
            return True  # before the program had its handlers in place
        self.assertIn(process.returncode, expected, err)
        return process.returncode != 0


def main():
    unittest.main(argv=[__file__], verbosity=1)
