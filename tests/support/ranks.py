"""The program on the ranks of an MPI job, and ranks that are killed."""

import contextlib
import os
import random
import shutil
import signal
import subprocess
import time
import unittest
from pathlib import Path

from rodwake import PROGRAM, ProgramTest
from scans import ScanTest

# Containers run tests as root and with fewer cores than ranks.
ENVIRONMENT = {**os.environ, "OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1",
               "OMPI_MCA_rmaps_base_oversubscribe": "1", "OMPI_MCA_btl_base_warn_component_unused": "0"}


def has_ranks():
    output = subprocess.run([PROGRAM, "info"], capture_output=True, text=True, check=False).stdout
    return not any(line.split() == ["MPI", "none"] for line in output.splitlines())


def command(ranks, *arguments):
    return ["mpiexec", "-n", str(ranks), PROGRAM, *map(str, arguments)]


def rank_of(process):
    """Of a process by its number; None for one that is no rank or is gone."""
    try:
        words = Path(f"/proc/{process}/environ").read_bytes().split(b"\0")
    except OSError:
        return None
    return next((int(word.split(b"=")[1]) for word in words if word.startswith(b"OMPI_COMM_WORLD_RANK=")), None)


def processes_below(parent):
    found = []
    for entry in Path("/proc").iterdir():
        with contextlib.suppress(OSError, ValueError, IndexError):
            if int((entry / "stat").read_text().rsplit(")", 1)[1].split()[1]) == parent:
                found += [int(entry.name), *processes_below(int(entry.name))]
    return found


@unittest.skipUnless(has_ranks(), "built without MPI")
class RanksTest(ProgramTest):
    def on_ranks(self, count, *arguments):
        """The finished job."""
        return subprocess.run(command(count, *arguments), cwd=self.folder, env=ENVIRONMENT, capture_output=True, text=True,
                              timeout=240, check=False)

    def ranks(self, count, *arguments, code=0):
        """The job, which must end with this code."""
        done = self.on_ranks(count, *arguments)
        self.assertEqual(done.returncode, code, f"{arguments}\nstdout: {done.stdout}\nstderr: {done.stderr}")
        return done

    @contextlib.contextmanager
    def job(self, ranks, *arguments):
        with subprocess.Popen(command(ranks, *arguments), cwd=self.folder, env=ENVIRONMENT, stdout=subprocess.DEVNULL,
                              stderr=subprocess.DEVNULL) as process:
            try:
                yield process
            finally:
                for one in [*processes_below(process.pid), process.pid] if process.poll() is None else []:
                    with contextlib.suppress(OSError):
                        os.kill(one, signal.SIGKILL)

    def kill_rank_of(self, process, rank):
        """Whether it was there to be killed."""
        victims = [one for one in processes_below(process.pid) if rank_of(one) == rank]
        for one in victims:
            with contextlib.suppress(OSError):
                os.kill(one, signal.SIGKILL)
        return bool(victims)

    def await_end(self, process):
        """Of a job whose rank was killed. mpiexec itself may hang in its own clean-up; the ranks must not."""
        try:
            process.wait(60)
        except subprocess.TimeoutExpired:
            left = [one for one in processes_below(process.pid) if rank_of(one) is not None]
            self.assertEqual(left, [], "ranks that outlive the one that was killed")


class ScanRanksTest(RanksTest, ScanTest):
    """The moments of deaths: RODWAKE_TEST_SEED."""

    def setUp(self):
        super().setUp()
        self.random = random.Random(os.environ.get("RODWAKE_TEST_SEED", "1"))

    def kill_rank(self, rank, run, seconds):
        """Kills the rank after that time; whether it was there to be killed."""
        with self.job(2, "scan", "scan.toml", "-o", run, "--quiet") as process:
            end = time.monotonic() + seconds
            while time.monotonic() < end and process.poll() is None:
                time.sleep(0.005)
            killed = self.kill_rank_of(process, rank)
            self.await_end(process)
        return killed

    def finish_after_deaths(self, rank, deaths):
        """Scans in folders of their own in which this rank dies at a random moment, until there were so many; each is finished
        by threads, and is then as one that was left alone ("whole")."""
        started = time.monotonic()
        self.ranks(2, "scan", "scan.toml", "-o", "timed", "--quiet")
        seconds = time.monotonic() - started
        shutil.rmtree(self.folder / "timed")
        died = runs = 0
        while died < deaths:
            self.assertLess(runs, 3 * deaths + 10, f"rank {rank} died in {died} of {runs} scans only")
            died += self.kill_rank(rank, "run", self.random.uniform(0.0, seconds))
            if not self.is_finished("run"):
                self.scan("scan.toml", "run", "--quiet")
            self.assert_same("run", "whole")
            self.assert_no_temporaries()
            shutil.rmtree(self.folder / "run")
            runs += 1
