"""simulate_noise: the bits of the program, shapes, what is refused."""

import math
import unittest

import numpy as np
import rodwake
from program import SCENES, new_folder, run_scene

SIDE_BY_SIDE = [[0, 2.5, 0], [0, -2.5, 0]]
ENDINGS = np.array(["contact", "pursuit", "escape", "undecided"])
PAIR = dict(kappa=10.0, t_end=20.0, output_times=np.arange(0, 20.5, 0.5), contact_distance=0.1, rotational_diffusion=0.02)


class NoiseTest(unittest.TestCase):
    def test_the_bits_of_the_program(self):
        run = run_scene(self, SCENES / "noise.toml", "noise.runs=24", "noise.rotational_diffusion=0.02", "noise.seed=5", "rods_run.t_end=20")
        theirs = run.json("noise.json")
        ours = rodwake.simulate_noise(SIDE_BY_SIDE, rodwake.Medium(), runs=24, seed=5, threads=2, **PAIR)
        self.assertEqual(ours.capture_probability, theirs["capture_probability"])
        self.assertEqual(ours.capture_interval, (theirs["capture_low"], theirs["capture_high"]))
        self.assertTrue(0 < ours.capture_probability < 1)
        self.assertEqual((ours.time_step, ours.failure), (theirs["time_step"], ""))
        default = rodwake.simulate_noise(SIDE_BY_SIDE, rodwake.Medium(), runs=3, rotational_diffusion=0.02, t_end=20.0)
        np.testing.assert_array_equal(default.t, rodwake.simulate(SIDE_BY_SIDE, t_end=20.0).t)  # the output times of a scene
        np.testing.assert_array_equal(ours.t, theirs["times"])
        np.testing.assert_array_equal(ours.runs_at_time, theirs["runs_at_time"])
        for name in ("mean_square_displacement", "heading_correlation"):
            for key in (name, f"{name}_error"):
                np.testing.assert_array_equal(getattr(ours, key), np.array(theirs[key], dtype=float), key)
        table = run.table("ensemble.csv")
        np.testing.assert_array_equal(ours.outcomes, ENDINGS[np.asarray(table["outcome"]).astype(int)])
        np.testing.assert_array_equal(ours.times, table["time"])
        np.testing.assert_array_equal(ours.min_separations, table["min_separation"])
        np.testing.assert_array_equal(ours.pairs, np.column_stack([table["first"], table["second"]]))

    def test_shapes_and_what_is_reported(self):
        result = rodwake.simulate_noise(SIDE_BY_SIDE, rodwake.Medium(), runs=6, **PAIR)
        self.assertEqual((result.outcomes.shape, result.pairs.shape, result.t.shape), ((6,), (6, 2), (41,)))
        self.assertEqual(result.mean_square_displacement.shape, (41, 2))
        self.assertEqual(result.runs_at_time[0], 6)
        self.assertRegex(repr(result), r"6 runs, capture probability [^;]*>$")
        self.assertIn("no contact_distance", repr(rodwake.simulate_noise(SIDE_BY_SIDE, rodwake.Medium(), rotational_diffusion=0.1, runs=2, t_end=1.0)))
        more = rodwake.simulate_noise(SIDE_BY_SIDE, rodwake.Medium(), runs=9, threads=3, **PAIR)
        np.testing.assert_array_equal(more.times[:6], result.times)  # runs are the same whatever their number

    def test_more_runs_where_the_capture_probability_is_uncertain(self):
        run = run_scene(self, SCENES / "noise.toml", "noise.runs=8", "noise.capture_error=0.12", "noise.most_runs=40",
                        "noise.rotational_diffusion=0.02", "rods_run.t_end=20")
        ours = rodwake.simulate_noise(SIDE_BY_SIDE, rodwake.Medium(), runs=8, capture_error=0.12, most_runs=40, threads=2, **PAIR)
        low, high = ours.capture_interval
        self.assertGreater(ours.outcomes.size, 8)
        self.assertLessEqual(0.5 * (high - low), 0.12)
        theirs = run.json("noise.json")
        self.assertEqual((ours.outcomes.size, ours.capture_interval), (theirs["runs"], (theirs["capture_low"], theirs["capture_high"])))
        same = rodwake.simulate_noise(SIDE_BY_SIDE, rodwake.Medium(), runs=ours.outcomes.size, **PAIR)
        np.testing.assert_array_equal(same.times, ours.times)

    def test_a_free_rod_forgets_its_heading(self):
        result = rodwake.simulate_noise([[0, 0, 0.3]], rotational_diffusion=0.5, runs=2000, t_end=2.0, output_times=[0.0, 1.0])
        self.assertIsNone(result.capture_probability)
        self.assertIsNone(result.capture_interval)
        np.testing.assert_array_equal(result.pairs, -1)
        for t, value, error in zip(result.t[1:], result.heading_correlation[1:, 0], result.heading_correlation_error[1:, 0]):
            self.assertLess(abs(value - math.exp(-0.5 * t)), 4 * error)  # the seed is fixed: 4 sigma is a wrong law
            self.assertLess(error, 0.02)

    def test_failed_runs_are_counted(self):
        result = rodwake.simulate_noise(SIDE_BY_SIDE, rodwake.Medium(), runs=3, max_steps=4, **PAIR)
        self.assertEqual(list(result.outcomes), ["failed"] * 3)
        self.assertIsNone(result.capture_probability)
        self.assertIn("max_steps", result.failure)

    def test_what_is_refused(self):
        for changes, word in ((dict(runs=0), "runs = 0"), (dict(seed=-1), "seed = -1"), (dict(rotational_diffusion=-1.0), "D_r|rotational|diffusion"),
                              (dict(time_step=0.0), "step"), (dict(output_times=[5.0, 1.0]), "output_times: 1"),
                              (dict(output_times=[0.0, 1e6]), "output_times: 1000000"), (dict(output_times=[float("nan")]), "output_times: nan"),
                              (dict(output_times=[-1.0]), "output_times: -1"), (dict(capture_error=0.1, most_runs=0), "most_runs = 0")):
            with self.subTest(changes), self.assertRaisesRegex(rodwake.InputError, word):
                rodwake.simulate_noise(SIDE_BY_SIDE, rodwake.Medium(), **{**PAIR, "runs": 2, **changes})
        for poses, changes, word in (([[float("nan"), 0, 0]], {}, "poses: nan"), ([[0, 0, 0]], dict(capture_error=0.1), "two rods")):
            with self.subTest(poses), self.assertRaisesRegex(rodwake.InputError, word):
                rodwake.simulate_noise(poses, None, rotational_diffusion=0.1, t_end=1.0, runs=2, **changes)


class MeasuredNoiseTest(unittest.TestCase):
    def test_the_measured_noise_of_a_bed(self):
        scene = rodwake.Scene.parse('schema = 1\n[granular]\nbeads = 0\nbox = "22 a"\nequilibrate = "0.05 s"\nduration = "0.4 s"\nruns = 2\n'
                                    '[[granular.rods]]\nposition = ["5 a", "6 a"]\n[measure]\nheading_diffusion = true\nblock = "0.4 s"\n')
        found = scene.run(new_folder(self)).json("measure.json")["heading_diffusion"]
        self.assertEqual((found["lag_high"], found["parts"], found["f_over_mu"]), (0.1, 2, 2.2))
        self.assertAlmostEqual(found["rotational_diffusion"]["value"], 2.2 * found["D_r"]["value"] / found["speed"]["value"], delta=1e-12)


if __name__ == "__main__":
    unittest.main()
