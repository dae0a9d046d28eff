"""rodwake replay: frames of a finished bed made again to the bit, and measures of a bed that stored none."""

import signal

import h5py
import numpy as np
import rodwake
from beds import BedTest, flip_byte, setting

KEPT = setting(output__archive=0.05)
NO_FRAMES = setting(output__formats="[]", output__last_period="false")


class ReplayTest(BedTest):
    def frames(self, file):
        """{time: places, velocities and orientations} of a trajectory."""
        with h5py.File(self.folder / file) as opened:
            time = opened["particles/trajectory/position/time"][()]
            parts = [opened[f"particles/{name}/value"][()] for name in ("trajectory/position", "trajectory/image", "trajectory/velocity",
                                                                        "trajectory_rods/position", "trajectory_rods/orientation")]
        return {round(t, 9): [part[k] for part in parts] for k, t in enumerate(time)}

    def assert_same_frames(self, made, stored):
        for time, parts in made.items():
            for one, other in zip(parts, stored[time]):
                np.testing.assert_array_equal(one, other, err_msg=f"t = {time}")

    def test_frames_to_the_bit(self):
        self.expect(0, "dem", "bed.toml", "-o", "bed", *KEPT, "--quiet")
        stored = self.frames("bed/trajectory.h5md")
        output = self.expect(0, "replay", "bed", "--from", "0.07", "--to", "0.15").stdout
        self.assertIn("bed/replay/trajectory.h5md: 9 frames from 0.07 to 0.15 s, made from the state at 0.05 s", output)
        made = self.frames("bed/replay/trajectory.h5md")
        self.assertEqual(len(made), 9)
        self.assert_same_frames(made, stored)
        # between stored frames, by three threads, from the archive alone, and the end
        self.expect(0, "replay", "bed/archive.rwc", "-o", "fine", "--frames", "0.001", "-j", "3", "--quiet")
        fine = self.frames("fine/trajectory.h5md")
        self.assertEqual(len(fine), 201)
        self.assert_same_frames({time: fine[time] for time in stored}, stored)
        self.assertIn(f"state at the end {self.hash('bed')}", self.expect(0, "replay", "bed", "-o", "end", "--from", "0.2").stdout)
        self.assertIn("archive of a granular run", self.expect(0, "info", "bed/archive.rwc").stdout)

    def test_a_run_without_an_archive_is_made_from_its_start(self):
        self.expect(0, "dem", "bed.toml", "-o", "bed", "--quiet")
        self.assertIn("made from the state at -0.02 s", self.expect(0, "replay", "bed", "--from", "0.1").stdout)
        self.assert_same_frames(self.frames("bed/replay/trajectory.h5md"), self.frames("bed/trajectory.h5md"))
        self.assertIn("1 stretches", self.expect(0, "replay", "bed", "--verify").stdout)

    def test_interrupted_runs_keep_the_same_archive(self):
        keys = (*KEPT, *setting(duration=2.0, output__checkpoint=0.02))
        self.expect(0, "dem", "bed.toml", "-o", "whole", *keys, "--quiet")
        for _ in range(2):
            if self.status_of("parts") != "finished":
                self.interrupt(signal.SIGTERM, 0.2, "dem", "bed.toml", "-o", "parts", *keys)
        if self.status_of("parts") != "finished":
            self.expect(0, "dem", "bed.toml", "-o", "parts", *keys, "--quiet")
        self.assertEqual((self.folder / "parts/archive.rwc").read_bytes(), (self.folder / "whole/archive.rwc").read_bytes())
        self.assertFalse((self.folder / "parts/archive.log").exists())
        self.assertIn("41 stretches made again, all to the bit", self.expect(0, "replay", "whole", "--verify", "-j", "2").stdout)

    def test_measured_without_a_stored_frame(self):
        measure = ("-s", "measure.order=true", "-s", "measure.microrheology=true", "-s", "measure.block=0.1", "-s", "measure.interval=0.005")
        self.expect(0, "dem", "bed.toml", "-o", "bed", *KEPT, *NO_FRAMES, "--quiet")
        self.expect(0, "measure", "bed.toml", "-o", "bed", *KEPT, *NO_FRAMES, *measure, "--quiet")
        self.expect(0, "run", "bed.toml", "-o", "on_the_way", *KEPT, *NO_FRAMES, *measure, "--no-figures", "--quiet")
        for name in "gr.csv", "gB.csv", "msd.csv", "stiffness.csv":
            self.assertEqual((self.folder / "bed" / name).read_text(), (self.folder / "on_the_way" / name).read_text(), name)
        # frames that were stored, and are too far apart
        fine = ("-s", "measure.interval=0.001")
        self.expect(0, "measure", "bed.toml", "-o", "bed", *KEPT, *NO_FRAMES, *measure, *fine, "--force", "--quiet")
        self.assertNotEqual((self.folder / "bed/msd.csv").read_text(), (self.folder / "on_the_way/msd.csv").read_text())

    def test_what_cannot_be(self):
        self.refuse(2, "nowhere: no such run directory", "replay", "nowhere")
        self.expect(0, "dem", "bed.toml", "-o", "bed", *KEPT, "--quiet")
        for times in (["--from", "0.3"], ["--from", "-1"], ["--to", "5"], ["--from", "0.1", "--to", "0.05"]):
            self.refuse(2, "the run goes from 0 to 0.2 s", "replay", "bed", *times)
        self.refuse(2, "at least a step", "replay", "bed", "--frames", "1e-9")
        self.expect(0, "replay", "bed", "--from", "0.2", "--quiet")
        self.refuse(2, "already exists; --force replaces it", "replay", "bed")
        self.expect(0, "replay", "bed", "--force", "--from", "0.2", "--quiet")
        flip_byte(self.folder / "bed/archive.rwc")
        self.refuse(2, "archive.rwc: .*damaged", "replay", "bed", "--verify")


if __name__ == "__main__":
    rodwake.main()
