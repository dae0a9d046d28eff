"""integrate: right-hand sides, Jacobians and events of the user, and the equations of rods."""

import math
import unittest
from fractions import Fraction

import numpy as np
import rodwake
from program import SCENES, new_folder
from rodwake import Event

PAIR = [[0, 2.5, 0], [0, -2.5, 0]]


def swing(t, y):
    return [y[1], -y[0]]


class IntegrateTest(unittest.TestCase):
    def test_a_function_of_python(self):
        times = np.linspace(0.5, 10, 20)
        for method in ("adams", "erk", "bdf"):
            found = rodwake.integrate(swing, [1.0, 0.0], times, method=method, rtol=1e-9)
            self.assertEqual((found.status, found.y.shape, found.final_time), ("reached_end", (20, 2), 10.0))
            np.testing.assert_array_equal(found.t, times)
            # At most 83 rtol on trajectories of the size of 1 (include/rodwake/integrate/ode.hpp).
            self.assertLess(np.abs(found.y[:, 0] - np.cos(times)).max(), 83e-9, method)
            self.assertGreater(found.statistics["rhs_evaluations"], 20)

    def test_events_are_found(self):
        events = [Event(lambda t, y: y[0], direction="falling"), Event(lambda t, y: y[1] - 0.5, "up", "rising", terminal=True)]
        found = rodwake.integrate(swing, [1.0, 0.0], [20.0], events=events, rtol=1e-10)
        self.assertEqual([hit.event for hit in found.hits], [0, 1])
        self.assertAlmostEqual(found.hits[0].time, math.pi / 2, delta=1e-8)
        self.assertAlmostEqual(found.hits[1].time, 7 * math.pi / 6, delta=1e-8)  # -sin t = 1/2, rising
        self.assertEqual((found.status, found.final_time), ("stopped_at_event", found.hits[1].time))
        np.testing.assert_array_equal(found.final_y, found.hits[1].y)

    def test_a_jacobian_of_python(self):
        def stiff(t, y):
            return -1e4 * (y - math.cos(t))

        asked = []

        def jacobian(t, y):
            asked.append(t)
            return [[-1e4]]

        found = rodwake.integrate(stiff, [0.0], [1.0], method="bdf", jacobian=jacobian)
        self.assertAlmostEqual(found.final_y[0], math.cos(1.0) + 1e-4 * math.sin(1.0), delta=1e-6)
        self.assertEqual(len(asked), found.statistics["jacobian_evaluations"])
        self.assertGreater(len(asked), 0)

    def test_what_python_raises_is_raised(self):
        def broken(t, y):
            raise KeyError("mine")

        for given in ({"rhs": broken}, {"rhs": swing, "events": [Event(broken)]}, {"rhs": swing, "jacobian": broken, "method": "bdf"}):
            with self.assertRaisesRegex(KeyError, "mine"):
                rodwake.integrate(y0=[1.0, 0.0], times=[1.0], **given)

    def test_malformed_problems_are_refused(self):
        for given, word in (({"rhs": lambda t, y: [1.0]}, "returned 1 numbers; expected 2"), ({"method": "rk4"}, "rk4"), ({"times": []}, "time"),
                            ({"times": [2.0, 1.0]}, "not after"), ({"y0": None}, "y0"), ({"events": [Event(swing, direction="up")]}, "rising"),
                            ({"rtol": -1.0}, "rtol"), ({"jacobian": lambda t, y: [1.0], "method": "bdf"}, "expected 4")):
            with self.assertRaisesRegex(rodwake.InputError, word):
                rodwake.integrate(**{"rhs": swing, "y0": [1.0, 0.0], "times": [1.0], **given})

    def test_roots_inside_a_step_are_found(self):
        """Those of the closed forms, by every method (more of them: tests/integrate/test_events.cpp)."""
        table = (("cubic", lambda t, y: y[0], (-8, -120, 5), [-6, -2, 2]), ("plateau", lambda t, y: max(0, 1 - t), (0, 1, 9), [1]),
                 ("sine", lambda t, y: math.sin(2.5 * t), (0, 1, 30), math.pi / 2.5 * np.arange(1, 24)),
                 ("dip", lambda t, y: (t - 3) ** 2 - 1e-6, (0, 1, 9), [2.999, 3.001]))
        for method in ("adams", "erk", "bdf", "auto"):
            for name, value, (start, y0, end), roots in table:
                with self.subTest(name, method=method):
                    rhs = (lambda t, y: [3 * t**2 + 12 * t - 4]) if name == "cubic" else (lambda t, y: [0.0])
                    found = rodwake.integrate(rhs, [y0], [end], start=start, method=method, events=[Event(value)])
                    np.testing.assert_allclose([hit.time for hit in found.hits], roots, rtol=0, atol=1e-6)  # rtol 1e-8 of sizes below 100
                    found = rodwake.integrate(rhs, [y0], [end], start=start, method=method, events=[Event(value, terminal=True)])
                    self.assertAlmostEqual(found.final_time, roots[0], delta=1e-6)

    def test_a_candidate_time_is_looked_at(self):
        looked = []

        def spike(t, y):
            return -1.0 if abs(t - 2.345) < 1e-6 else 1.0

        def at(t_before, y_before, t, y):
            looked.append((t_before, t))
            return 2.345 if len(y) == len(y_before) == 2 and t > 2.345 else None

        for direction, count in (("any", 2), ("falling", 1)):
            found = rodwake.integrate(swing, [1.0, 0.0], [5.0], events=[Event(spike, direction=direction, candidate_time=at)])
            self.assertEqual(len(found.hits), count)
            self.assertAlmostEqual(found.hits[0].time, 2.345 - 1e-6, delta=1e-12)  # found by bracketing, rounding of t
        self.assertEqual(len(looked), 2 * found.statistics["steps"])
        self.assertEqual(rodwake.integrate(swing, [1.0, 0.0], [5.0], events=[Event(spike)]).hits, [])

    def test_what_comes_back_is_checked(self):
        ragged = [1.0, [2.0, 3.0]]
        masked = np.ma.masked_array([1.0, 2.0], mask=[False, True])
        wrong = (1j, [1.0, 2j], None, [1.0, None], "text", ["1.0", "2.0"], ragged, masked, np.array([1.0, None], object), {}, object(), [],
                 np.array([1 + 0j, 1], object), np.array(["2020-01-01"] * 2, "datetime64[D]"), np.ma.masked)
        for value in wrong:
            for function in ("right-hand side", "Jacobian", "events[0]", "candidate_time of events[0]"):
                if value is None and "candidate" in function:
                    continue  # legal: no time
                given = {"rhs": swing, "events": [Event(lambda t, y: y[0])]}
                if "right" in function:
                    given["rhs"] = lambda t, y: value
                elif "Jac" in function:
                    given.update(jacobian=lambda t, y: value, method="bdf")
                else:
                    given["events"] = [Event(lambda t, y: 1.0, candidate_time=lambda *ends: value) if "candidate" in function else Event(lambda t, y: value)]
                with self.subTest(function, value=repr(value)):
                    with self.assertRaises(rodwake.InputError) as raised:
                        rodwake.integrate(y0=[1.0, 0.0], times=[1.0], **given)
                    self.assertIn(f"{function} returned", str(raised.exception))
        for event in (True, np.True_, [1.0, 2.0], [[1.0], [2.0]]):
            with self.assertRaisesRegex(rodwake.InputError, r"events\[0\] returned"):
                rodwake.integrate(swing, [1.0, 0.0], [1.0], events=[Event(lambda t, y: event)])
        for shape, n in (((2, 2), 4), ((4,), 2)):
            with self.assertRaisesRegex(rodwake.InputError, "the (right-hand side|Jacobian) returned an array"):
                rodwake.integrate(lambda t, y: np.ones(shape if n == 4 else n), np.ones(n), [1.0], method="bdf", jacobian=lambda t, y: np.ones(shape))

    def test_kinds_of_numbers_that_are_taken(self):
        for value in ([1, 2], (1.0, np.float32(2)), np.array([[1], [2]]), np.array([Fraction(1), 2.0], object), np.array([1.0, 9.0, 2.0])[::2],
                      np.ma.masked_array([1.0, 2.0]), [True, 2]):
            found = rodwake.integrate(lambda t, y: value, [0.0, 0.0], [1.0])
            np.testing.assert_allclose(found.final_y, [1.0, 2.0], rtol=1e-12)  # rounding: rates are constant
        for value in (1, np.float64(1), np.array(1.0), np.array([1.0]), np.int8(1), Fraction(1)):
            self.assertEqual(rodwake.integrate(swing, [1.0, 0.0], [1.0], events=[Event(lambda t, y: value)]).hits, [])

    def test_arguments_of_the_wrong_kind(self):
        function, event = (lambda t, y: y[0]), Event(lambda t, y: y[0])
        kinds = ("text", None, 1j, [1.0, 2.0], object())
        table = [({"y0": y0}, "y0: ") for y0 in ("ab", [1, None], [1j, 2], [[1, 2], [3]], np.ma.masked_array([1.0, 2.0], [0, 1]), np.ones((2, 2)))]
        table += [({"times": times}, "times: ") for times in ("1", None, [1j], [[1.0, 2.0], [3.0, 4.0]], ["a"], function)]
        for name in ("start", "rtol", "atol", "max_step", "max_steps", "method", "rhs", "jacobian", "events"):
            ok = {"method": "text", "events": [], "atol": None, "jacobian": None}.get(name, object)
            table += [({name: kind}, f"{name} (is|=)") for kind in kinds if not (kind is ok or (name == "method" and kind == "text"))
                      and not (name == "events" and kind in ("text", [1.0, 2.0]))]
        table += [({"events": given}, word) for given, word in (
            (function, "events is"), ([function], r"events\[0\] is .*function.*Event"), (event, "events is"), ([event, None], r"events\[1\] is"),
            ("text", r"events\[0\] is"), ([Event(function, direction=-1)], r"events\[0\].direction is -1.*'rising'"),
            ([Event(function, direction=None)], "direction is None"), ([Event(function, direction="up")], "'up'"), ([Event(3)], r"value is 3"),
            ([Event(function, terminal="yes")], "terminal is"), ([Event(function, name=5)], "name is"), ([Event(function, candidate_time=1.0)], "candidate_time"))]
        table += [({"max_steps": 1.5}, "max_steps"), ({"max_steps": 0}, "max_steps"), ({"max_steps": 2**70}, "max_steps"), ({"max_step": -1.0}, "max_step"),
                  ({"start": math.nan}, "start"), ({"times": [math.nan]}, "time"), ({"atol": [1e-9, 1e-9]}, "atol ="), ({"rtol": True}, "rtol =")]
        for given, word in table:
            with self.subTest(given=repr(given)), self.assertRaisesRegex(rodwake.InputError, word):
                rodwake.integrate(**{"rhs": swing, "y0": [1.0, 0.0], "times": [1.0], **given})
        rods = rodwake.RodEquations(PAIR)
        for call, word in ((lambda: rodwake.integrate(rods, [0.0, 1.0], [1.0]), "y0 has 2 numbers; expected 6"), (lambda: rods(0.0, None), "y is None"),
                           (lambda: rods.jacobian(0.0, [1j] * 6), "y is")):
            with self.assertRaisesRegex(rodwake.InputError, word):
                call()

    def test_other_callbacks_of_the_wrong_kind(self):
        scene = rodwake.Scene.load(SCENES / "pair.toml")
        folder = new_folder(self)
        with self.assertRaisesRegex(TypeError, "progress: expected a function"):
            scene.run(folder / "run", progress=5)
        with self.assertRaisesRegex(TypeError, "executor: expected"):
            rodwake.scan(scene, {"coupling.kappa": [1.0]}, executor="pool")
        with self.assertRaisesRegex(TypeError, "observer: expected a function"):
            rodwake.run_bed(scene, None)
        self.assertFalse((folder / "run").exists())

    def test_the_exception_of_the_user_whatever_it_is(self):
        class Mine(BaseException):
            pass

        class Array:
            def __array__(self, *dtype):
                raise Mine("in __array__")

        def raising(kind):
            def function(*given):
                raise kind("mine")
            return function

        for kind in (Mine, KeyboardInterrupt, SystemExit, StopIteration, rodwake.InputError, MemoryError):
            for given in ({"rhs": raising(kind)}, {"rhs": swing, "jacobian": raising(kind), "method": "bdf"}, {"rhs": swing, "events": [Event(raising(kind))]},
                          {"rhs": swing, "events": [Event(lambda t, y: y[0], candidate_time=raising(kind))]}):
                with self.assertRaisesRegex(kind, "mine"):
                    rodwake.integrate(y0=[1.0, 0.0], times=[1.0], **given)
        with self.assertRaisesRegex(Mine, "in __array__"):
            rodwake.integrate(lambda t, y: Array(), [1.0, 0.0], [1.0])

    def test_a_failure_is_a_value(self):
        found = rodwake.integrate(lambda t, y: y**2, [1.0], [2.0])  # 1/(1 - t)
        self.assertEqual(found.status, "failed")
        self.assertAlmostEqual(found.final_time, 1.0, delta=1e-3)


class RodEquationsTest(unittest.TestCase):
    def test_integrated_they_are_simulate(self):
        medium = rodwake.Medium(eta=2.0, alpha=0.5)
        equations = rodwake.RodEquations(PAIR, medium, kappa=0.5, gamma1=0.1)
        times = np.linspace(1, 15, 15)
        found = rodwake.integrate(equations, times=times, rtol=1e-7)
        same = rodwake.simulate(PAIR, medium, kappa=0.5, gamma1=0.1, t_end=15.0, output_times=times, method="adams", rtol=1e-7)
        # The same steps; simulate watches separations too, which changes none of them.
        np.testing.assert_array_equal(found.y.reshape(15, 2, 3), same.poses)

    def test_an_event_of_the_user_on_rods(self):
        closer = Event(lambda t, y: math.hypot(y[0] - y[3], y[1] - y[4]) - 1.0, terminal=True)
        found = rodwake.integrate(rodwake.RodEquations(PAIR, rodwake.Medium(), kappa=0.5), times=[60.0], events=[closer], rtol=1e-10)
        contact = rodwake.simulate(PAIR, rodwake.Medium(), kappa=0.5, t_end=60.0, contact_distance=1.0, rtol=1e-10)
        self.assertAlmostEqual(found.final_time, contact.time, delta=83e-10 * contact.time)  # as above

    def test_a_term_of_the_user(self):
        """A uniform turning: without a medium rods walk in circles of radius 1/omega."""
        equations = rodwake.RodEquations([[0, 0, 0]])
        omega = 0.5

        def turning(t, y):
            return equations(t, y) + [0, 0, omega]

        found = rodwake.integrate(turning, equations.y0, [math.pi / omega], rtol=1e-10)
        np.testing.assert_allclose(found.final_y, [0, 2 / omega, math.pi], rtol=0, atol=1e-8)

    def test_rates_and_jacobian(self):
        equations = rodwake.RodEquations([[0, 1, 0.2], [3, -1, 2.0], [1, 4, -1]], rodwake.Medium(), kappa=2.0, gamma2=0.3)
        y = equations.y0
        exact, step = equations.jacobian(0.0, y), 1e-5
        for j in range(9):
            change = step * np.eye(9)[j]
            slope = (equations(0.0, y + change) - equations(0.0, y - change)) / (2 * step)
            np.testing.assert_allclose(exact[:, j], slope, rtol=0, atol=1e-7)  # step^2 and rounding 1e-16/step, times derivatives of order 10
        for wrong in (lambda: equations(0.0, y[:3]), lambda: equations.jacobian(0.0, y[:3])):
            with self.assertRaisesRegex(rodwake.InputError, "the rods have 9"):
                wrong()


if __name__ == "__main__":
    unittest.main()
