"""rodwake dem can be stopped anywhere, by anything, and goes on to the same end."""

import contextlib
import errno
import json
import os
import re
import resource
import shutil
import signal
import subprocess
import time

import rodwake
from beds import FINAL, BedTest, InterruptionTest, flip_byte, setting
from rodwake import snapshot, wait_until

SECONDS = 5.0  # what is promised: a run stops within this time
ENDLESS = setting(duration=5000.0, output__frames=1.0, output__table=1.0)


class RestartTest(InterruptionTest):
    def test_kills(self):
        stopped = went_on = 0
        for k in range(8):
            stopped += self.finish_after(f"run{k}", 1, ((signal.SIGKILL, signal.SIGTERM)[k % 2],), self.seconds)
            went_on += any(step > 0 for step in self.steps_gone_on_from(f"run{k}"))
        self.assertGreaterEqual(stopped, 4)
        self.assertGreaterEqual(went_on, 2)

    def test_killed_before_the_first_file(self):
        self.write("run/provenance.json.tmp123", "")
        self.dem("run", *self.SETTINGS)
        self.assert_same("run", "whole")
        self.assert_no_temporaries()
        self.write("other/table.csv.tmp123", "")  # none of that
        self.dem("other", *self.SETTINGS, code=2)

    def test_a_chain(self):
        self.assertGreaterEqual(self.finish_after("run", 5, (signal.SIGKILL, signal.SIGTERM), 0.5 * self.seconds), 2)


class SignalTest(BedTest):
    def begin(self, *arguments):
        return self.started("dem", "bed.toml", "-o", "out", *ENDLESS, *arguments)

    def test_stop(self):
        for number, code in ((signal.SIGTERM, 143), (signal.SIGINT, 130)):
            shutil.rmtree(self.folder / "out", ignore_errors=True)  # logs of the first round would tell of the second too early
            with self.begin("--quiet") as process:
                self.wait_for(process, "out/rows.log")
                time.sleep(0.1)
                self.assertEqual(self.stop(process, number, SECONDS), (code, "", ""))
            self.assertTrue(self.out("out", "checkpoint.rwc").exists())
            self.assertEqual(self.status("out"), "interrupted")
            self.assert_no_temporaries()

    def test_large_output_is_announced(self):
        """61 spheres, 999501 frames and 50 of the last period: 60 bytes each at the end, 48 in the logs."""
        large = setting(duration=19990.0, output__frames=0.02)
        words = "frames of a run take up to 3.66 GB, and 2.93 GB more until it has ended; for less, granular.output.frames above 0.02 s, every_bead above 1"
        self.assertIn(words, self.expect(0, "check", "bed.toml", *large).stdout)
        self.assertNotIn("frames of a run take", self.expect(0, "check", "bed.toml").stdout)
        with self.started("dem", "bed.toml", "-o", "out", *large) as process:
            self.wait_for(process, "out/rows.log")
            self.assertEqual(self.stop(process, signal.SIGTERM, SECONDS)[0], 143)
        self.assertIn(words, self.out("out", "log.txt").read_text())

    def test_rows_go_on_as_if_it_had_not_stopped(self):
        """Twenty rows over the run are printed, whenever it was stopped."""
        keys = setting(duration=60.0, equilibrate=0, output__table=0.05, output__frames=1.0)
        times = lambda: [float(row) for row in re.findall(r" (\d+\.\d{3}) +\d\.\d{4}e", self.out("out", "log.txt").read_text())]
        with self.started("dem", "bed.toml", "-o", "out", *keys) as process:
            self.assertTrue(wait_until(lambda: self.out("out", "log.txt").exists() and len(times()) > 7, 30))
            self.assertEqual(self.stop(process, signal.SIGTERM, SECONDS)[0], 143)
        before = len(times())
        self.dem("out", *keys)
        self.assertLess(before, 20)
        self.assertGreater(len(times()), before)
        self.assertGreater(min(one - other for one, other in zip(times()[1:], times())), 3.0 - 0.1)  # 60 s/20, a row late at most

    def test_checkpoint_on_demand(self):
        with self.started("dem", "bed.toml", "-o", "out", *setting(duration=6.0)) as process:
            self.wait_for(process, "out/rows.log")
            self.assertFalse(self.out("out", "checkpoint.rwc").exists())
            process.send_signal(signal.SIGUSR1)
            self.assertTrue(wait_until(lambda: self.out("out", "checkpoint.rwc").exists(), SECONDS))
            process.communicate(timeout=60)
        self.assertEqual(process.returncode, 0)
        self.assertEqual(self.names("out"), FINAL)

    def test_ensemble(self):
        parts = [f"runs/{k:04}" for k in (1, 2)]
        with self.begin("--quiet", "-j", 2, *setting(runs=3)) as process:
            self.wait_for(process, *(f"out/{part}/rows.log" for part in parts))
            process.send_signal(signal.SIGUSR1)  # every run that is under way
            self.assertTrue(wait_until(lambda: all(self.out("out", f"{part}/checkpoint.rwc").exists() for part in parts), SECONDS))
            self.assertIsNone(process.poll())
            self.assertEqual(self.stop(process, signal.SIGTERM, SECONDS), (143, "", ""))
        self.assertFalse(self.out("out", "runs/0003").exists())

    def test_an_ensemble_goes_on(self):
        ensemble = setting(runs=2, duration=1.0, output__checkpoint=0.02)
        self.dem("whole", *ensemble, "--quiet")
        with self.started("dem", "bed.toml", "-o", "out", *ensemble, "-j", 2, "--quiet") as process:
            self.wait_for(process, "out/runs/0001/checkpoint.rwc")
            self.assertEqual(self.stop(process, signal.SIGTERM, SECONDS)[0], 143)
        self.dem("out", *ensemble, "--quiet")
        self.assertEqual(self.hash("out"), self.hash("whole"))
        for run in ("runs/0001", "runs/0002"):
            self.assert_same(f"out/{run}", f"whole/{run}")
            self.assertEqual(*(self.summary(f"{one}/{run}")["cost"]["particle_steps"] for one in ("out", "whole")))

    def test_one_finished_run_tells_no_error(self):
        ensemble = (*setting(runs=2, duration=1.0), "-j", 1, "--quiet")
        with self.started("dem", "bed.toml", "-o", "out", *ensemble) as process:
            self.wait_for(process, "out/runs/0001/summary.json")
            self.assertEqual(self.stop(process, signal.SIGTERM, SECONDS)[0], 143)
        names = ("T_xy_error", "T_z_error", "psi6_error")
        found = json.loads(self.out("out", "summary.json").read_text())
        self.assertEqual((found["finished_runs"], *(found[name] for name in names)), (1, None, None, None))
        self.dem("out", *ensemble)
        found = json.loads(self.out("out", "summary.json").read_text())
        self.assertEqual(found["finished_runs"], 2)
        self.assertGreater(min(found[name] for name in names), 0)


class CheckpointTest(BedTest):
    """A run that was stopped after two checkpoints, and what became of them."""

    SETTINGS = (*setting(duration=2.0, output__checkpoint=0.01), "--quiet")

    def setUp(self):
        super().setUp()
        self.made_once("whole", "dem", "bed.toml", *self.SETTINGS)
        with self.started("dem", "bed.toml", "-o", "out", *self.SETTINGS) as process:
            self.wait_for(process, "out/checkpoint.rwc.previous")
            self.assertEqual(self.stop(process, signal.SIGTERM, SECONDS)[0], 143)
        self.newest, self.previous = self.out("out", "checkpoint.rwc"), self.out("out", "checkpoint.rwc.previous")

    def go_on(self):
        done = self.dem("out", *(part for part in self.SETTINGS if part != "--quiet"))
        self.assertGreater(self.steps_gone_on_from("out")[-1], 0)
        self.assert_same("out", "whole")
        return done.stderr

    def test_damaged(self):
        flip_byte(self.newest)
        self.assertRegex(self.go_on(), r"checkpoint\.rwc: .*resuming from .*checkpoint\.rwc\.previous")

    def test_missing(self):
        self.newest.unlink()
        self.assertRegex(self.go_on(), r"checkpoint\.rwc: is missing; resuming from .*checkpoint\.rwc\.previous")

    def test_both_damaged(self):
        for file in (self.newest, self.previous):
            flip_byte(file)
        before = snapshot(self.folder / "out")
        done = self.dem("out", *self.SETTINGS, code=2)
        self.assertRegex(done.stderr, r"checkpoint\.rwc.*checkpoint\.rwc\.previous.*remove the files there to start again")
        after = snapshot(self.folder / "out")
        self.assertLessEqual({"checkpoint.rwc", "checkpoint.rwc.previous", "rows.log", "frames.log", "last_period.log"}, before.keys())
        for name in before:
            if name.endswith((".rwc", ".previous", ".log")) and name != "log.txt":
                self.assertEqual(after.get(name), before[name], name)

    def test_of_another_scene(self):
        for other in (setting(phi_b=0.6), ("--seed", "7"), setting(output__frames=0.02), setting(duration=3.0)):
            done = self.dem("out", *self.SETTINGS, *other, code=2)
            self.assertRegex(done.stderr, r"another scene \((.+) = .+ there, \1 = .+ here\); choose another folder with -o, or --force")
        self.assertIn("phi_b = 0.7", self.out("out", "scene.toml").read_text())  # the record of the good run stays
        self.go_on()

    def test_force_starts_anew(self):
        self.dem("out", *self.SETTINGS, "--force")
        self.assertEqual(self.steps_gone_on_from("out"), [])
        self.assert_same("out", "whole")


class FullDiskTest(BedTest):
    """Frames come fast and checkpoints often; there is room for some of them."""

    SETTINGS = (*setting(duration=2.0, output__frames=0.002, output__checkpoint=0.01), "--quiet")

    def go_on(self, run):
        """With room again."""
        self.made_once("whole", "dem", "bed.toml", *self.SETTINGS)
        self.assertTrue((self.folder / run / "checkpoint.rwc").exists())
        self.dem(run, *self.SETTINGS)
        self.assertGreater(self.steps_gone_on_from(run)[-1], 0)
        self.assert_same(run, "whole")

    @staticmethod
    def small_files():
        signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
        resource.setrlimit(resource.RLIMIT_FSIZE, (1500000, resource.RLIM_INFINITY))

    def test_files_cannot_grow(self):
        done = self.dem("out", *self.SETTINGS, code=1, preexec_fn=self.small_files)
        self.assertRegex(done.stderr, r"rodwake: .*frames\.log: .*" + os.strerror(errno.EFBIG))
        self.assert_no_temporaries()
        self.go_on("out")

    @contextlib.contextmanager
    def small_disk(self):
        folder = self.folder / "small"
        folder.mkdir()
        if subprocess.run(["mount", "-t", "tmpfs", "-o", "size=2m", "none", folder], capture_output=True).returncode != 0:
            self.skipTest("needs the right to mount")
        try:
            yield folder
        finally:
            subprocess.run(["umount", folder], check=True)

    def test_full(self):
        with self.small_disk() as folder:
            done = self.dem("small/out", *self.SETTINGS, code=1)
            self.assertRegex(done.stderr, "rodwake: .*" + os.strerror(errno.ENOSPC))
            self.assert_no_temporaries()
            self.assertNotEqual(self.status("small/out"), "finished")
            subprocess.run(["mount", "-o", "remount,size=64m", folder], check=True)
            self.go_on("small/out")


if __name__ == "__main__":
    rodwake.main()
