"""simulate: the bits of the program, outcomes, errors."""

import math
import pickle
import tempfile
import unittest
from pathlib import Path

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

    def test_bodies_are_those_of_the_program(self):
        run = run_scene(self, SCENES / "rods_with_bodies.toml", "rods_run.t_end=3", "rods.1.body=", "body.thin_diameter=0.2", "body.mobility_ratio=0.5")
        ours = rodwake.simulate([[0, 0, 0.2], [1.6, -1.3, 1.7]], rodwake.Medium(), kappa=2.0, t_end=3.0,
                                body={"spheres": 8, "length": 1.3, "thick_diameter": 0.32, "stall_overlap": 0.04, "mobility_ratio": 0.5})
        np.testing.assert_array_equal(ours.poses, run.rods().poses)
        self.assertEqual((ours.outcome, ours.min_gap), (run.outcome["outcome"], run.outcome["min_gap"]))
        self.assertEqual(pickle.loads(pickle.dumps(ours)), ours)
        self.assertTrue(math.isnan(rodwake.simulate(SIDE_BY_SIDE, t_end=1.0).min_gap))
        for body, word in (({"spheres": 2}, "spheres is 2"), ({"size": 1}, "body"), ({"length": -1.0}, "length"), (3, "body")):
            with self.subTest(word), self.assertRaisesRegex((rodwake.InputError, TypeError), word):
                rodwake.simulate(SIDE_BY_SIDE, t_end=1.0, body=body)

    def test_by_default_the_path_of_the_program(self):
        """The output times of a scene that says nothing of them, to the last bit, and the time of contact."""
        with tempfile.TemporaryDirectory() as folder:
            scene = Path(folder) / "pair.toml"
            scene.write_text((SCENES / "pair.toml").read_text().replace("output_interval", "# output_interval"))
            for t_end, rows in ((60.0, 137), (30.0, 201)):  # contact at 40.6
                theirs = run_scene(self, scene, f"rods_run.t_end={t_end}").rods()
                ours = rodwake.simulate(SIDE_BY_SIDE, rodwake.Medium(), kappa=0.5, t_end=t_end, contact_distance=0.1)
                self.assertEqual(ours.poses.shape, (rows, 2, 3))
                np.testing.assert_array_equal(ours.t, theirs.t)
                np.testing.assert_array_equal(ours.poses, theirs.poses)
        end = rodwake.simulate(SIDE_BY_SIDE, rodwake.Medium(), kappa=0.5, t_end=30.0, output_times=[])
        self.assertEqual((end.t.tolist(), end.poses.shape), ([30.0], (1, 2, 3)))
        np.testing.assert_array_equal(end.poses[-1], ours.poses[-1])

    def test_what_a_result_tells(self):
        result = rodwake.simulate(SIDE_BY_SIDE, rodwake.Medium(), kappa=0.5, t_end=60.0, contact_distance=0.1, output_times=[])
        self.assertEqual((result.outcome, result.status, result.pair), ("contact", "stopped_at_event", (0, 1)))
        self.assertAlmostEqual(result.time, 40.595264757446582, delta=40.6 * 83e-8)  # 34 digits; 83 rtol (integrate/ode.hpp)
        self.assertEqual((result.t.shape, result.poses.shape, result.turn.shape), ((1,), (1, 2, 3), (2,)))
        self.assertEqual(result.t[-1], result.time)
        self.assertAlmostEqual(result.min_separation, 0.1, delta=1e-9)
        self.assertGreater(result.statistics["steps"], 10)
        self.assertIn(result.method, ("erk", "bdf"))
        self.assertIn("came within 0.1", result.reason)
        self.assertIn("contact at t = 40.59", repr(result))
        self.assertNotIn("contact_distance", repr(result))
        open_end = rodwake.simulate(SIDE_BY_SIDE, rodwake.Medium(), kappa=0.5, t_end=5.0)
        self.assertRegex(repr(open_end), "undecided at t = 5.0, 2 rods, 201 times; no contact_distance: rods that meet run into the singularity")
        self.assertNotIn("contact_distance", repr(rodwake.simulate([[0, 0, 0]], t_end=1.0)))
        failed = rodwake.simulate(SIDE_BY_SIDE, rodwake.Medium(), kappa=0.5, t_end=30.0, max_steps=3)
        self.assertRegex(repr(failed), "failed: .*max_steps")

    def test_a_result_can_be_sent(self):
        for result in (rodwake.simulate(SIDE_BY_SIDE, rodwake.Medium(), kappa=0.5, t_end=5.0), rodwake.simulate([[0, 0, 0]], t_end=1.0)):
            other = pickle.loads(pickle.dumps(result))
            for name in (name for name in dir(result) if not name.startswith("_")):
                np.testing.assert_array_equal(getattr(other, name), getattr(result, name), name)
            self.assertEqual(repr(other), repr(result))

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
        for change in ({"kappa": "big"}, {"kappa": None}, {"kappa": 1j}, {"kappa": True}, {"kappa": math.nan}, {"gamma1": [1, 2]}, {"gamma2": math.inf},
                       {"poses": "side by side"}, {"poses": None}, {"poses": [[0, 0, 1j]]}, {"poses": [1, 2, 3]}, {"t_end": None}, {"t_end": "long"},
                       {"t_end": 10**400}, {"output_times": 5.0}, {"output_times": "all"}, {"output_times": [[1.0]]}, {"contact_distance": -1},
                       {"contact_distance": "0.1"}, {"rtol": "1e-8"}, {"atol": -1.0}, {"max_steps": 0}, {"max_steps": 1e3}, {"max_steps": 10**30}):
            with self.subTest(change), self.assertRaisesRegex(rodwake.InputError, next(iter(change))):
                rodwake.simulate(**{**good, **change})
        for change in ({"medium": "water"}, {"medium": 1.0}, {"method": 3}, {"form": None}):
            with self.subTest(change), self.assertRaisesRegex(TypeError, next(iter(change)) + ": expected"):
                rodwake.simulate(**{**good, **change})
        with self.assertRaisesRegex(rodwake.InputError, "kappa = 'big'"):
            rodwake.RodEquations(SIDE_BY_SIDE, rodwake.Medium(), kappa="big")
        with self.assertRaisesRegex(TypeError, "medium: expected a rodwake.Medium or None, not str"):
            rodwake.RodEquations(SIDE_BY_SIDE, "water")
        self.assertEqual(repr(rodwake.RodEquations(SIDE_BY_SIDE)), "<RodEquations: 2 rods>")


class ClassifyTest(unittest.TestCase):
    """Cubics between 200 rows: times and separations to 1e-4 of what the run itself tells, which follows its own steps."""

    def test_runs_of_the_theory_end_as_they_say(self):
        # A pair that meets, one of which the rear follows, one that parts, one too short to tell, two that pass in a box, three rods.
        runs = ((SIDE_BY_SIDE, dict(kappa=0.5, t_end=60.0, contact_distance=0.1)), (SIDE_BY_SIDE, dict(kappa=-0.5, t_end=200.0, contact_distance=0.1)),
                ([[0, 0, 0], [3, 0.4, 0]], dict(kappa=5.0, t_end=400.0, contact_distance=0.1)), (SIDE_BY_SIDE, dict(kappa=0.5, t_end=3.0)),
                ([[0, 0, 0], [9, 1.5, 3.0]], dict(kappa=0.1, t_end=40.0, contact_distance=0.2)),
                ([[0, 0, 0], [3, 3, -1.5], [-2, 1, 0.5]], dict(kappa=1.0, t_end=30.0, contact_distance=0.1)))
        endings = set()
        for poses, options in runs:
            medium = rodwake.Medium(periodic=20.0 if options["kappa"] == 0.1 else None)
            run = rodwake.simulate(poses, medium, **options)
            endings.add(run.outcome)
            wrapped = run.poses.copy()
            wrapped[..., 2] = (wrapped[..., 2] + np.pi) % (2 * np.pi) - np.pi
            if medium.periodic:
                wrapped[..., :2] %= medium.periodic
            for law in (None, rodwake.RodEquations(poses, medium, kappa=options["kappa"])):
                found = rodwake.classify(run.t, wrapped, medium, contact_distance=options.get("contact_distance"), law=law)
                self.assertEqual((found.outcome, found.pair, found.status), (run.outcome, run.pair, run.status), run)
                for name in ("time", "min_separation", "separation"):
                    self.assertAlmostEqual(getattr(found, name), getattr(run, name), delta=1e-4 * max(1, getattr(run, name)), msg=f"{name} {run}")
                np.testing.assert_allclose(found.turn, run.turn, rtol=0, atol=1e-4)
        self.assertTrue({"contact", "escape", "undecided"} <= endings, endings)

    def test_a_contact_between_rows(self):
        """Straight walkers that cross, in closed form; what happens lies between the rows at 4.9 and 5.6."""
        poses = [[-5.0, 0.0, 0.0], [0.1, -5.0, math.pi / 2]]
        path = rodwake.simulate(poses, t_end=14.0, output_times=np.arange(0, 14.1, 0.7))
        # Their offset (t - 5.1, 5 - t) has the square 2 t^2 - 20.2 t + 51.01, least 0.005 and 0.02 first here.
        first = (20.2 - math.sqrt(20.2**2 - 8 * (51.01 - 0.02))) / 4
        found = rodwake.classify(path.t, path.poses, contact_distance=math.sqrt(0.02))
        self.assertEqual((found.outcome, found.pair), ("contact", (0, 1)))
        self.assertAlmostEqual(found.time, first, delta=1e-9)  # the cubic of the square is exact for straight walkers
        self.assertAlmostEqual(found.min_separation, math.sqrt(0.02), delta=1e-12)
        passed = rodwake.classify(path.t, path.poses, contact_distance=0.07)
        self.assertAlmostEqual(passed.min_separation, 0.1 / math.sqrt(2), delta=1e-9)
        self.assertEqual(passed.outcome, "escape")
        self.assertIn("no contact_distance", repr(rodwake.classify(path.t + 3.0, path.poses)))
        self.assertEqual(rodwake.classify(path.t + 3.0, path.poses, contact_distance=9.0).time, 3.0)  # they start in contact

    def test_a_law_of_ones_own(self):
        """The theory's law written anew with wakes ends as simulate does."""
        medium = rodwake.Medium()

        def law(t, y):
            theta = y[2::3]
            n = np.stack([np.cos(theta), np.sin(theta)], axis=-1)
            drive = 0.5 * np.einsum("aij,aj->ai", rodwake.wakes(y, medium).strain, n)
            return np.column_stack([n, n[:, 0] * drive[:, 1] - n[:, 1] * drive[:, 0]]).ravel()

        met = rodwake.Event(lambda t, y: np.hypot(y[0] - y[3], y[1] - y[4]) - 0.1, "contact", terminal=True)
        solved = rodwake.integrate(law, np.ravel(SIDE_BY_SIDE), np.linspace(0, 60, 201)[1:], events=[met])
        found = rodwake.classify([*solved.t, solved.final_time], [*solved.y, solved.final_y], medium, contact_distance=0.1, law=law)
        self.assertEqual(found.outcome, "contact")
        self.assertAlmostEqual(found.time, 40.595264757446582, delta=40.6 * 1e-6)  # 34 digits; 83 rtol, and the cubic's last row

    def test_what_is_refused(self):
        t, poses = [0.0, 1.0], [[[0, 0, 0]], [[1, 0, 0]]]
        for change, word in (({"t": [0.0]}, r"\(T,\)"), ({"t": [1.0, 0.0]}, "rise"), ({"t": [0.0, math.nan]}, "finite"), ({"t": "now"}, "t: expected"),
                             ({"poses": [[0, 0], [1, 0]]}, "3 N"), ({"poses": [[[0, 0, 0]], [[5, 0, 0]]]}, "speed 1"), ({"t": [0.0], "poses": [[[0, 0, 0]]]}, "two rows"),
                             ({"poses": [[[0, 0, 0]], [[1e-3, 0, 0]]]}, "f/mu"), ({"contact_distance": 0}, "contact_distance"), ({"poses": None}, "poses"),
                             ({"law": lambda t, y: [1.0, 2.0, 3.0, 4.0, 5.0, 6.0]}, "law")):
            with self.subTest(word), self.assertRaisesRegex(rodwake.InputError, word):
                rodwake.classify(**{"t": t, "poses": poses, **change})
        for change in ({"medium": "water"}, {"law": 3}):
            with self.assertRaisesRegex(TypeError, next(iter(change))):
                rodwake.classify(**{"t": t, "poses": poses, **change})
        self.assertEqual(rodwake.classify(t, poses).outcome, "undecided")


if __name__ == "__main__":
    unittest.main()
