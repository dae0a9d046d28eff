"""A run that is stopped and started again ends with the same bytes as one that was left alone."""

import json
import shutil
import signal

import numpy as np

import rodwake
from beds import flip_byte
from rodwake import ProgramTest, wait_until

# Thirty-six rods turning each other need some 20000 steps of BDF at this tolerance and a checkpoint comes after 15000
# (models/rods/simulate.cpp): one in every run, and seconds left after it. One bit lost shows.
SETTINGS = ("-s", "coupling.kappa=1", "-s", "rods_run.method=bdf", "-s", "rods_run.rtol=1e-13", "-s", "rods_run.t_end=60",
            "-s", "rods_run.output_interval=1.5")
RESULTS = ("rods.csv", "outcome.json")


class ResumeTest(ProgramTest):
    def setUp(self):
        super().setUp()
        self.write("crowd.toml", rodwake.crowd(36))

    def results(self, run):
        return {name: (self.folder / run / name).read_bytes() for name in RESULTS}

    def stop_after_a_checkpoint(self, number):
        checkpoint = self.folder / "out/rods_checkpoint.rwc"
        with self.started("rods", "crowd.toml", *SETTINGS, "-o", "out", "--quiet") as process:
            wait_until(lambda: checkpoint.exists() or process.poll() is not None, 60)
            self.assertIsNone(process.poll(), "the run ended before it could be stopped")
            self.stop(process, number, 10.0)
        self.assertTrue(checkpoint.exists())

    def go_on(self, run):
        done = self.expect(0, "rods", "crowd.toml", *SETTINGS, "-o", run)
        self.assertRegex(done.stderr, "resuming from the checkpoint at t = [1-9]")
        self.assertFalse((self.folder / run / "rods_checkpoint.rwc").exists())
        self.assert_no_temporaries()

    def test_to_the_byte(self):
        self.expect(0, "rods", "crowd.toml", *SETTINGS, "-o", "whole", "--quiet")
        self.stop_after_a_checkpoint(signal.SIGTERM)
        self.assertEqual(self.status("out"), "interrupted")
        self.assertNotEqual(self.results("out"), self.results("whole"))
        self.assertIn("state of rods by rodwake", self.expect(0, "info", "out/rods_checkpoint.rwc").stdout)
        self.go_on("out")
        self.assertEqual(self.results("out"), self.results("whole"))

    def test_a_checkpoint_that_does_not_fit_is_named(self):
        short = ("rods", "crowd.toml", "-s", "rods_run.t_end=0.1", "-o", "out")
        self.expect(0, *short)
        self.write("out/provenance.json", '{"status": "interrupted", "stages": {"rods": "interrupted"}}')
        before = self.results("out")
        shutil.copy(self.folder / "out/rods_end.rwc", self.folder / "out/rods_checkpoint.rwc")
        flip_byte(self.folder / "out/rods_checkpoint.rwc")
        done = self.expect(0, *short)
        self.assertIn("rods_checkpoint.rwc: damaged, or of another scene, field or version; starting from the beginning", done.stderr)
        self.assertEqual(self.results("out"), before)
        self.assertEqual(self.status("out"), "finished")
        self.assertFalse((self.folder / "out/rods_checkpoint.rwc").exists())

    def test_a_later_end_goes_on_and_an_earlier_one_is_refused(self):
        def run(folder, end, *more, code=0):
            return self.expect(code, "rods", "crowd.toml", "-s", "coupling.kappa=1", "-s", "rods_run.rtol=1e-8",
                               "-s", f"rods_run.t_end={end}", "-o", folder, *more).stderr
        def rows(folder):
            return np.loadtxt(self.folder / folder / "rods.csv", delimiter=",", skiprows=1)
        half = ("-s", "rods_run.output_interval=0.5")
        run("out", 4, *half)
        early = rows("out")
        self.assertIn("going on from the end of the earlier run at t = 4", run("out", 8, *half))
        run("whole", 8, *half)
        np.testing.assert_array_equal(rows("out")[:len(early)], early)
        np.testing.assert_allclose(rows("out"), rows("whole"), rtol=0, atol=1e-6)
        self.assertFalse(np.array_equal(rows("out"), rows("whole")))  # the solver started anew at t = 4
        closest = [json.loads((self.folder / name / "outcome.json").read_text())["min_separation"] for name in ("out", "whole")]
        self.assertAlmostEqual(*closest, delta=1e-6)
        self.assertIn("t_end = 8.0 there, t_end = 4.0 here", run("out", 4, *half, code=2))
        self.assertIn("holds a finished run", run("out", 8, *half))

        # Every second row of the run is one of this: it goes on. A row that it does not have: from the beginning.
        self.assertIn("at t = 8", run("out", 16, "-s", "rods_run.output_interval=1"))
        self.assertIn("starting from the beginning, as ", run("out", 30, "-s", "rods_run.output_interval=0.7"))
        run("other", 30, "-s", "rods_run.output_interval=0.7")
        self.assertEqual(self.results("out"), self.results("other"))
        self.assertIn("starting from the beginning, as ", run("out", 31, "-s", "rods_run.output_interval=0.7"))  # the last part began

    def test_the_end_takes_its_rows_from_the_table(self):
        self.write("crowd.toml", rodwake.crowd(36).replace("schema = 1", 'schema = 1\nunits = "si"\n[scales]\nf_over_mu = 0.73\nv0 = 1.3'))
        def run(end):
            return self.expect(0, "rods", "crowd.toml", "-s", "rods_run.rtol=1e-8", "-s", f"rods_run.t_end={end}",
                               "-s", "rods_run.output_interval=0.5", "-o", "out").stderr
        run(1)
        size = (self.folder / "out/rods_end.rwc").stat().st_size
        table = self.folder / "out/rods.csv"
        run(2)
        self.assertEqual((self.folder / "out/rods_end.rwc").stat().st_size, size)
        early = table.read_text()
        self.assertIn("going on from the end of the earlier run at t = ", run(3))
        self.assertTrue(table.read_text().startswith(early))
        table.write_text(early)
        self.assertIn("rods.csv: is not the table of the run that ended in rods_end.rwc; starting", run(4))

    def test_order_is_of_rods_with_the_same_end(self):
        order = '[rods_order]\nlink = 4.0\n'
        self.write("crowd.toml", rodwake.crowd(16) + order)
        short = ("crowd.toml", "-s", "rods_run.rtol=1e-6", "-o", "out", "--quiet")
        self.expect(0, "run", *short, "-s", "rods_run.t_end=2")
        done = self.expect(2, "measure", *short, "-s", "rods_run.t_end=4")
        self.assertIn("t_end = 2.0 there, t_end = 4.0 here", done.stderr)
        self.expect(0, "run", *short, "-s", "rods_run.t_end=4")
        times = np.loadtxt(self.folder / "out/rods_order.csv", delimiter=",", skiprows=1)[:, 0]
        self.assertEqual(times[-1], 4.0)


if __name__ == "__main__":
    rodwake.main()
