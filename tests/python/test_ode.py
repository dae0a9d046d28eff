"""integrate: right-hand sides, Jacobians and events of the user, and the equations of rods."""

import math
import unittest

import numpy as np
import rodwake
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
