"""Beds in the hands of Python: frames, the program's bits, errors."""

import unittest

import numpy as np
import rodwake
from program import new_folder

TEXT = """schema = 1
[granular]
beads = 60
box = "22 a"
equilibrate = "0.01 s"
duration = "0.03 s"
[granular.output]
frames = "0.01 s"
[[granular.rods]]
kind = "motile"
position = ["11 a", "11 a"]
heading = 0.5
"""


class BedTest(unittest.TestCase):
    def setUp(self):
        self.scene = rodwake.Scene.parse(TEXT)

    def test_an_observer_sees_each_frame_of_the_program(self):
        seen = []
        bed = rodwake.run_bed(self.scene, lambda bed: seen.append((bed.time, bed.positions, bed.velocities, bed.rods)), threads=2)
        run = self.scene.run(new_folder(self))
        frames, beads = run.trajectory(), run.trajectory().species == 0
        np.testing.assert_array_equal([time for time, *_ in seen], frames.time)
        for k, (_, positions, velocities, rods) in enumerate(seen):
            self.assertEqual((positions.shape, rods.shape), ((60, 3), (1, 3)))
            # Files hold the place in the box and the image: what is made of both is rounded once, in metres.
            np.testing.assert_allclose(positions, frames.position[k][beads], rtol=0, atol=4 * np.spacing(bed.box))
            np.testing.assert_array_equal(velocities, frames.velocity[k][beads])
            np.testing.assert_allclose(rods[0, :2], frames.rod_position[k][0, :2], rtol=0, atol=4 * np.spacing(bed.box))
        self.assertEqual(bed.state_hash, run.json("summary.json")["state_hash"])
        self.assertTrue(bed.finished)

    def test_a_force_on_the_beads(self):
        pushed = rodwake.Scene.parse(TEXT + '[granular.body_force]\nkind = "gaussian"\nacceleration = 0.5\ndirection = "90 deg"\nwidth = "2 a"\n'
                                     'speed = "10 mm/s"\nposition = ["5 a", "6 a"]\n')
        bed = rodwake.Bed(pushed)
        np.testing.assert_array_equal(bed.body_acceleration(), np.zeros((60, 2)))  # it settles first
        bed = rodwake.run_bed(pushed, lambda bed: False)
        a, t = bed.bead_radius, bed.time
        places = np.array([[5 * a, 6 * a + 0.01 * t], [5 * a + 2 * a, 6 * a + 0.01 * t], [5 * a + bed.box, 6 * a + 0.01 * t]])
        np.testing.assert_allclose(bed.body_acceleration(places), [[0, 0.5], [0, 0.5 * np.exp(-0.5)], [0, 0.5]], rtol=1e-9, atol=1e-15)
        self.assertEqual(bed.body_acceleration().shape, (60, 2))
        self.assertEqual(bed.state_hash, pushed.run(new_folder(self)).json("summary.json")["state_hash"])
        free = rodwake.run_bed(self.scene, lambda bed: False)
        self.assertNotEqual(bed.state_hash, free.state_hash)
        np.testing.assert_array_equal(free.body_acceleration([[0, 0]]), [[0, 0]])
        with self.assertRaisesRegex(rodwake.InputError, "expected an array of shape"):
            bed.body_acceleration([0, 0])

    def test_steps_add_up(self):
        one, other = rodwake.Bed(self.scene), rodwake.Bed(self.scene)
        self.assertLess(one.time, 0)  # it settles first
        one.advance(steps=140)
        for steps in (1, 49, 51, 39):
            other.advance(steps=steps)
        self.assertEqual((one.step, one.state_hash), (other.step, other.state_hash))
        one.advance(time=1e-3)
        self.assertEqual(one.step, other.step + 10)
        self.assertNotEqual(one.state_hash, other.state_hash)
        self.assertNotEqual(rodwake.Bed(self.scene, run=1).state_hash, rodwake.Bed(self.scene).state_hash)

    def test_what_a_bed_tells(self):
        bed = rodwake.Bed(self.scene)
        bed.advance()
        self.assertEqual((bed.step, bed.time), (0, 0.0))
        self.assertAlmostEqual(bed.box, 22 * 0.4e-3)
        self.assertEqual((bed.bead_radius, bed.time_step), (0.4e-3, 1e-4))
        velocities = bed.velocities - bed.velocities.mean(axis=0)
        self.assertAlmostEqual(bed.temperatures[0], (velocities[:, :2]**2).mean(), delta=1e-12)
        self.assertTrue(0 <= bed.psi6 <= 1)
        self.assertIn("60 beads, 1 rods", repr(bed))

    def test_an_observer_may_end_or_fail(self):
        seen = []
        bed = rodwake.run_bed(self.scene, lambda bed: len(seen) == 1 or seen.append(bed.time), every=0.005)
        self.assertEqual((seen, bed.time), ([0.0], 0.005))
        with self.assertRaises(ZeroDivisionError):
            rodwake.run_bed(self.scene, lambda bed: 1 / 0)

    def test_what_cannot_be_done_is_reported(self):
        bed = rodwake.Bed(self.scene)
        for ask, word in ((lambda: bed.advance(steps=0), "0 steps"), (lambda: bed.advance(steps=1, time=1), "one of them"),
                          (lambda: rodwake.Bed(self.scene.copy().set("granular.phi_b", 5)), "phi_b"),
                          (lambda: rodwake.Bed(self.scene.set({"granular.start": "restart", "granular.restart_from": "x.rwc"})), "Scene.run")):
            with self.assertRaisesRegex(rodwake.InputError, word):
                ask()
        for ask, word in ((lambda: bed.advance(steps=1.5), "steps = 1.5"), (lambda: bed.advance(steps="one"), "steps = 'one'"), (lambda: bed.advance(steps=True), "steps"),
                          (lambda: bed.advance(time=float("nan")), "time = nan"), (lambda: bed.advance(time=float("inf")), "time = inf"),
                          (lambda: bed.advance(time=-1.0), "time = -1"), (lambda: rodwake.Bed(self.scene, run=-1), "run = -1"),
                          (lambda: rodwake.Bed(self.scene, threads=0.5), "threads = 0.5"), (lambda: bed.body_acceleration("here"), "places"),
                          (lambda: rodwake.run_bed(self.scene, print, every=0), "every = 0")):
            with self.assertRaisesRegex(rodwake.InputError, word):
                ask()
        for ask, word in ((lambda: rodwake.Bed("bed.toml"), "scene: expected a rodwake.Scene, not str"), (lambda: rodwake.run_bed(self.scene, None), "observer")):
            with self.assertRaisesRegex(TypeError, word):
                ask()


if __name__ == "__main__":
    unittest.main()
