"""mpiexec -n N rodwake scan: the same tables as on threads, and nothing lost when ranks die."""

import os
import signal
import subprocess

import rodwake
from ranks import ENVIRONMENT, ScanRanksTest, command, processes_below, rank_of


class SameTablesTest(ScanRanksTest):
    def test_any_number_of_ranks(self):
        self.scan("scan.toml", "whole", "--quiet")
        for ranks in (2, 3):
            self.ranks(ranks, "scan", "scan.toml", "-o", f"run{ranks}", "--quiet")
            self.assert_same(f"run{ranks}", "whole")

    def test_a_wrong_scene_is_refused_on_all_ranks(self):
        done = self.ranks(2, "scan", "scan.toml", "-o", "run", "-s", "scan.resolution=33", code=2)
        self.assertIn("scan.resolution", done.stderr)

    def test_a_rank_that_cannot_go_on_ends_the_job(self):
        other = ["-s", "scan.max_points=1"]  # of the second rank alone, as a file that only one node has
        whole = ("scan", "scan.toml", "-o", "run", "--quiet", "-s", "scan.resolution=8192")
        done = subprocess.run([*command(1, *whole), ":", *command(1, *whole, *other)[1:]], cwd=self.folder, env=ENVIRONMENT,
                              capture_output=True, text=True, timeout=60, check=False)
        self.assertEqual(done.returncode, 1, done.stderr)
        self.assertIn("rank 1: ", done.stderr)
        self.assertIn("scan.max_points", done.stderr)


class DeathTest(ScanRanksTest):
    def test_a_rank_dies(self):
        self.scan("scan.toml", "whole", "--quiet")
        for rank in (0, 1):
            self.finish_after_deaths(rank, 2)

    def test_a_signal_to_a_large_scan_ends_before_mpiexec_loses_patience(self):
        """It kills ranks a second after the signal, in which large tables cannot be written. Rank 0 ends in time wherever it is,
        so on busy cores the record may still be the one of the beginning. Both say that the same command resumes."""
        for to_rank in (False, True):
            process = subprocess.Popen(command(2, "scan", "scan.toml", "-o", "run", "-s", "scan.resolution=8192"), cwd=self.folder,
                                       env=ENVIRONMENT, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
            self.assertTrue(rodwake.wait_until(lambda: self.points("run") > (300_000 if to_rank else 150_000), 200))
            target = next(one for one in processes_below(process.pid) if rank_of(one) == 0) if to_rank else process.pid
            os.kill(target, signal.SIGINT)
            output = process.communicate(timeout=60)[1]
            self.assertIn("stopped by a signal; results so far are in run", output)
            self.assertEqual(process.returncode, 130 if to_rank else 1, output)  # mpiexec's own code of a job that it ended is 1
            self.assertFalse((self.folder / "run/rodwake.lock").exists())
            self.assertIn(self.status("run"), ("interrupted", "unfinished"))

    def test_a_signal_to_the_job_keeps_what_is_done(self):
        with self.job(2, "scan", "scan.toml", "-o", "run", "--quiet", "-s", "scan.resolution=8192") as process:
            self.assertTrue(rodwake.wait_until(lambda: self.points("run") > 500, 60))
            process.send_signal(signal.SIGTERM)
            process.wait(30)
        self.assertGreater(self.points("run"), 500)


if __name__ == "__main__":
    rodwake.main()
