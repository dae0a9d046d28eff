"""Ctrl-C and SIGTERM: the run stops within seconds and keeps what it has."""

import csv
import json
import os
import shutil
import signal
import time

import h5py
import rodwake
from rodwake import PAIR, ProgramTest, wait_until

SECONDS = 5.0  # what is promised: a run stops within this time


class SignalTest(ProgramTest):
    def begin(self, *arguments):
        """Context: the program, once it is at work in `out`."""
        return self.started(*arguments, "-o", "out")

    def wait_for_start(self, process):
        started = wait_until(lambda: (self.folder / "out/scene.toml").exists() or process.poll() is not None, 30)
        self.assertTrue(started and process.poll() is None, "the run did not start")

    def interrupt(self, number, *arguments):
        with self.begin(*arguments) as process:
            self.wait_for_start(process)
            return self.stop(process, number, SECONDS)

    def test_a_long_run_stops_and_keeps_its_results(self):
        self.write("crowd.toml", rodwake.crowd(200))
        for number, code in ((signal.SIGINT, 130), (signal.SIGTERM, 143)):
            shutil.rmtree(self.folder / "out", ignore_errors=True)
            returned, _, err = self.interrupt(number, "rods", "crowd.toml")
            self.assertEqual(returned, code, err)
            self.assertIn("stopped by a signal", err)
            self.assertEqual(self.status("out"), "interrupted")
            self.assert_results_kept()
            self.assert_no_temporaries()

    def test_a_second_signal_soon_after_the_first_changes_nothing(self):
        """Terminals and `timeout` signal a program and its group, so one wish to stop may arrive twice."""
        self.write("crowd.toml", rodwake.crowd(200))
        with self.begin("rods", "crowd.toml") as process:
            self.wait_for_start(process)
            process.send_signal(signal.SIGINT)
            time.sleep(0.2)
            returned, _, err = self.stop(process, signal.SIGINT, SECONDS)
        self.assertEqual(returned, 130, err)
        self.assertEqual(self.status("out"), "interrupted")
        self.assert_results_kept()
        self.assert_no_temporaries()

    def assert_results_kept(self):
        outcome = json.loads((self.folder / "out/outcome.json").read_text())
        self.assertEqual((outcome["outcome"], outcome["solver"]["status"]), ("undecided", "interrupted"))
        rows = list(csv.DictReader((self.folder / "out/rods.csv").read_text().splitlines()))
        self.assertEqual(float(rows[0]["t"]), 0.0)
        self.assertEqual(float(rows[-1]["t"]), outcome["time"])
        with h5py.File(self.folder / "out/result.h5") as file:
            self.assertEqual(list(file["/rods/scene/t"]), [float(row["t"]) for row in rows])

    def test_an_interrupted_run_can_be_started_again(self):
        self.write("crowd.toml", rodwake.crowd(200))
        self.interrupt(signal.SIGTERM, "rods", "crowd.toml")
        self.expect(0, "rods", "crowd.toml", "-o", "out", "-s", "rods_run.t_end=0.01", "--force")
        self.assertEqual(self.status("out"), "finished")

    def test_quiet_is_quiet_when_interrupted(self):
        self.write("crowd.toml", rodwake.crowd(200))
        self.assertEqual(self.interrupt(signal.SIGTERM, "run", "crowd.toml", "--quiet"), (143, "", ""))

    def test_a_part_of_a_field_is_not_stored(self):
        self.write("field.toml", "schema = 1\n[medium]\neta = 1.0\nalpha = 1.0\n[field]\nx = [-9.0, 9.0]\ny = [-9.0, 9.0]\n"
                   "nx = 2000\nny = 2000\n")
        returned, _, err = self.interrupt(signal.SIGTERM, "field", "field.toml")
        self.assertEqual(returned, 143, err)
        self.assertEqual(self.status("out"), "interrupted")
        with h5py.File(self.folder / "out/result.h5") as file:
            self.assertNotIn("field", file)

    def test_the_figures_stop_too(self):
        # A module of this name stands in the way of the real one and takes its time.
        slow = self.write("slow/h5py.py", f"import time\nopen({str(self.folder / 'drawing')!r}, 'w')\ntime.sleep(100)\n").parent
        self.write("pair.toml", PAIR)
        with self.started("run", "pair.toml", "-o", "out", env={**os.environ, "PYTHONPATH": str(slow)}) as process:
            self.assertTrue(wait_until((self.folder / "drawing").exists, 30), "the figures were not begun")
            returned, _, err = self.stop(process, signal.SIGTERM, SECONDS)
        self.assertEqual(returned, 143, err)
        self.assertEqual(self.status("out"), "finished")  # the results are whole; figures can be drawn any time

    def test_a_checkpoint_request_does_not_stop_the_run(self):
        self.write("crowd.toml", rodwake.crowd(200))
        with self.begin("rods", "crowd.toml") as process:
            self.wait_for_start(process)
            process.send_signal(signal.SIGUSR1)
            self.assertFalse(wait_until(lambda: process.poll() is not None, 0.5))


if __name__ == "__main__":
    rodwake.main()
