"""rodwake scan can be stopped anywhere, by anything, and goes on to the same tables."""

import signal

import rodwake
from rodwake import wait_until
from scans import ANY, COLUMNS, KILL, ScanTest, StoppedScanTest

SECONDS = 10.0  # what is promised: a scan stops, and writes its tables, within this time
ENDLESS = ("-s", "scan.resolution=8192", "-s", "scan.trajectories=20")


class RestartTest(StoppedScanTest):
    def test_kills(self):
        self.finish_often(4, 1, KILL, self.seconds)

    def test_a_chain(self):
        self.finish_often(3, 5, ANY, 0.5 * self.seconds)


class SlowPointsTest(StoppedScanTest):
    """A point that is stopped half way is as if it had not been begun."""

    SETTINGS = (*StoppedScanTest.SETTINGS, "-s", "rods_run.method=bdf", "-s", "rods_run.rtol=1e-12", "-s", "scan.resolution=16")

    def test_signals(self):
        self.finish_often(6, 3, (signal.SIGTERM, signal.SIGINT), 0.5 * self.seconds)


class SignalTest(ScanTest):
    def stop_at_work(self, number, run, *arguments):
        """Once some hundred points are there."""
        with self.started("scan", "scan.toml", "-o", run, *ENDLESS, *arguments) as process:
            at_work = wait_until(lambda: (self.folder / run / "points.log").exists() and self.points(run) > 500
                                 or process.poll() is not None, 60)
            self.assertTrue(at_work and process.poll() is None, "the scan did not get to work, or ended")
            return self.stop(process, number, SECONDS)

    def test_results_are_written_on_a_signal(self):
        for number, code in ((signal.SIGINT, 130), (signal.SIGTERM, 143)):
            run = f"run{code}"
            self.assertEqual(self.stop_at_work(number, run, "--quiet"), (code, "", ""))
            self.assertEqual(self.status(run), "interrupted")
            rows, record = self.rows(run), self.json(run)
            self.assertEqual(len(rows), self.points(run))
            self.assertEqual((record["complete"], record["evaluated"]), (False, len(rows)))
            self.assertGreater(record["left"], 0)
            self.assertEqual(list(rows[0])[2:], COLUMNS)
            self.assertTrue((self.folder / run / "scan.h5").exists())
            self.assert_no_temporaries()

    def test_it_says_how_to_go_on(self):
        _, _, err = self.stop_at_work(signal.SIGINT, "run")
        self.assertIn("stopped by a signal; results so far are in run; the same command resumes", err)

    def test_a_stop_before_the_first_point(self):
        for seconds in (0.0, 0.02, 0.05, 0.1):
            if not self.is_finished("run"):
                self.interrupt(signal.SIGTERM, seconds, "scan", "grid.toml", "-o", "run", "--quiet")
        if not self.is_finished("run"):
            self.scan("grid.toml", "run")
        self.scan("grid.toml", "whole")
        self.assert_same("run", "whole")

    def test_a_share_goes_on(self):
        part = ("scan", "grid.toml", "-o", "out", "-s", "scan.axes.0.count=60", "-s", "scan.axes.1.count=60")
        self.interrupt(signal.SIGTERM, 0.3, *part, "--part", "1/2", "--quiet")
        if not self.is_finished("out/part-1-of-2"):
            self.expect(0, *part, "--part", "1/2")
        self.assertEqual(self.json("out/part-1-of-2")["evaluated"], 1800)


if __name__ == "__main__":
    rodwake.main()
