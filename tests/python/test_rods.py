"""simulate: the bits of the program, outcomes, errors."""

import math
import unittest

import numpy as np
import rodwake
from program import SCENES, run_scene

SIDE_BY_SIDE = [[0, 2.5, 0], [0, -2.5, 0]]


class SimulateTest(unittest.TestCase):
    def test_the_bits_of_the_program(self):
        run = run_scene(self, SCENES / "pair.toml")
        ours = rodwake.simulate(SIDE_BY_SIDE, rodwake.Medium(), kappa=0.5, t_end=60.0, output_times=np.arange(0, 60.25, 0.25), contact_distance=0.1)
        theirs = run.rods()
        np.testing.assert_array_equal(ours.t, theirs.t)
        np.testing.assert_array_equal(ours.poses, theirs.poses)
        self.assertEqual((ours.outcome, ours.time), (theirs.attributes["outcome"], theirs.attributes["time"]))
        self.assertEqual(ours.outcome, run.outcome["outcome"])

    def test_the_bits_of_the_program_in_other_settings(self):
        for method, form, box in (("bdf", "director", None), ("adams", "angle", 60.0)):
            changes = ["coupling.gamma1=0.3", f"rods_run.method={method}", f"rods_run.form={form}", "rods_run.rtol=1e-6", "rods_run.t_end=10"]
            run = run_scene(self, SCENES / "pair.toml", *changes, *([f"medium.periodic={box}"] if box else []))
            ours = rodwake.simulate(SIDE_BY_SIDE, rodwake.Medium(periodic=box), kappa=0.5, gamma1=0.3, t_end=10.0, contact_distance=0.1, method=method,
                                    form=form, rtol=1e-6, output_times=np.arange(0, 10.25, 0.25))
            np.testing.assert_array_equal(ours.poses, run.rods().poses)

    def test_what_a_result_tells(self):
        result = rodwake.simulate(SIDE_BY_SIDE, rodwake.Medium(), kappa=0.5, t_end=60.0, contact_distance=0.1)
        self.assertEqual((result.outcome, result.status, result.pair), ("contact", "stopped_at_event", (0, 1)))
        self.assertAlmostEqual(result.time, 40.595264757446582, delta=40.6 * 83e-8)  # 34 digits; 83 rtol (integrate/ode.hpp)
        self.assertEqual((result.t.shape, result.poses.shape, result.turn.shape), ((1,), (1, 2, 3), (2,)))
        self.assertEqual(result.t[-1], result.time)
        self.assertAlmostEqual(result.min_separation, 0.1, delta=1e-9)
        self.assertGreater(result.statistics["steps"], 10)
        self.assertIn(result.method, ("erk", "bdf"))
        self.assertIn("came within 0.1", result.reason)
        self.assertIn("contact", repr(result))

    def test_arrays_outlive_the_result(self):
        result = rodwake.simulate(SIDE_BY_SIDE, rodwake.Medium(), kappa=0.5, t_end=5.0)
        poses, copy = result.poses, result.poses.copy()
        del result
        np.testing.assert_array_equal(poses, copy)

    def test_without_a_medium_rods_walk_straight(self):
        result = rodwake.simulate([[1, 2, math.pi / 2]], t_end=3.0, output_times=[0.0, 1.0])
        np.testing.assert_array_equal(result.t, [0, 1, 3])
        np.testing.assert_allclose(result.poses[:, 0], [[1, 2, math.pi / 2], [1, 3, math.pi / 2], [1, 5, math.pi / 2]], rtol=0, atol=1e-13)
        self.assertIsNone(result.pair)
        self.assertEqual(result.status, "reached_end")

    def test_a_failure_is_a_value(self):
        result = rodwake.simulate(SIDE_BY_SIDE, rodwake.Medium(), kappa=0.5, t_end=30.0, max_steps=3)
        self.assertEqual(result.status, "failed")
        self.assertIn("max_steps", result.message)

    def test_a_start_within_the_contact_distance_is_a_contact(self):
        met = rodwake.simulate(SIDE_BY_SIDE, rodwake.Medium(), kappa=0.5, t_end=1.0, output_times=[0.0, 1.0], contact_distance=9.0)
        self.assertEqual((met.outcome, met.time, list(met.t), met.status), ("contact", 0.0, [0.0], "stopped_at_event"))
        self.assertEqual(met.poses.tolist(), [np.asarray(SIDE_BY_SIDE, float).tolist()])

    def test_bad_input_is_refused(self):
        good = {"poses": SIDE_BY_SIDE, "medium": rodwake.Medium(), "t_end": 1.0}
        for change, word in (({"poses": [[0, 0], [1, 1]]}, r"\(N, 3\)"), ({"poses": [[0, 0, 0], [0, 0, 1]]}, "same place"),
                             ({"method": "euler"}, "adams"), ({"form": "quaternion"}, "director"), ({"t_end": -1.0}, "t_end|time"),
                             ({"output_times": [2.0, 1.0]}, "time"), ({"rtol": 1.0}, "rtol"), ({"contact_distance": -1.0}, "contact"),
                             ({"poses": np.zeros((0, 3))}, "rod"), ({"poses": [[0, math.nan, 0]]}, "finite|nan")):
            with self.assertRaisesRegex(rodwake.InputError, word):
                rodwake.simulate(**{**good, **change})
        with self.assertRaises(TypeError):
            rodwake.simulate(SIDE_BY_SIDE, "water", t_end=1.0)


if __name__ == "__main__":
    unittest.main()
