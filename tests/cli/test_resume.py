"""A run that is stopped and started again ends with the same bytes as one that was left alone."""

import json
import math
import shutil
import signal

import rodwake
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
        checkpoint = self.folder / "out/checkpoint.json"
        with self.started("rods", "crowd.toml", *SETTINGS, "-o", "out", "--quiet") as process:
            wait_until(lambda: checkpoint.exists() or process.poll() is not None, 60)
            self.assertIsNone(process.poll(), "the run ended before it could be stopped")
            self.stop(process, number, 10.0)
        self.assertTrue(checkpoint.exists())

    def go_on(self, run):
        done = self.expect(0, "rods", "crowd.toml", *SETTINGS, "-o", run)
        self.assertRegex(done.stderr, "resuming from the checkpoint at t = [1-9]")
        self.assertFalse((self.folder / run / "checkpoint.json").exists())
        self.assert_no_temporaries()

    def test_to_the_byte(self):
        self.expect(0, "rods", "crowd.toml", *SETTINGS, "-o", "whole", "--quiet")
        self.stop_after_a_checkpoint(signal.SIGTERM)
        self.assertEqual(self.status("out"), "interrupted")
        self.assertNotEqual(self.results("out"), self.results("whole"))
        shutil.copytree(self.folder / "out", self.folder / "nudged")
        self.go_on("out")
        self.assertEqual(self.results("out"), self.results("whole"))
        self.nudge(self.folder / "nudged/checkpoint.json")
        self.go_on("nudged")
        self.assertNotEqual(self.results("nudged"), self.results("whole"))

    def test_a_checkpoint_that_does_not_fit_is_named(self):
        short = ("rods", "crowd.toml", "-s", "rods_run.t_end=0.1", "-o", "out")
        self.expect(0, *short)
        self.write("out/provenance.json", '{"status": "interrupted", "stages": {"rods": "interrupted"}}')
        self.write("out/checkpoint.json", "{damaged")
        done = self.expect(0, *short)
        self.assertIn("checkpoint.json: damaged, or of another scene, field or version; starting from the beginning", done.stderr)
        self.assertEqual(self.status("out"), "finished")
        self.assertFalse((self.folder / "out/checkpoint.json").exists())

    def nudge(self, checkpoint):
        """Changes one number of the state by its last bit."""
        value = json.loads(checkpoint.read_text())
        value["state"][0] = math.nextafter(value["state"][0], math.inf)
        checkpoint.write_text(json.dumps(value))


if __name__ == "__main__":
    rodwake.main()
