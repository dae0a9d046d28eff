"""studies/medium: what it makes of data whose answer is known."""

import json
import math
import sys
import tempfile
import types
import unittest
from pathlib import Path

import h5py
import numpy as np
import rodwake
from rodwake import SOURCE

sys.path.insert(0, str(SOURCE / "studies"))
import lab  # noqa: E402
import validate_wakes as wakes  # noqa: E402
from medium import bed, hard, moments, monopole, moving, pairs, scaling, spread, static, strain, tail  # noqa: E402

TRUE = np.array([4.6e4, 4.2e4, 1.5e4, 1.35e4])  # c11, c22, c12, c66, a^2/s^2
FORCE = 8000.0                                   # a^3/s^2


def crystal(columns=36, rows=42, spacing=2.13):
    """An unstrained triangular lattice and its box."""
    row = spacing * math.sqrt(0.75)
    x, y = np.meshgrid(np.arange(columns), np.arange(rows))
    return np.stack([(spacing * (x + 0.5 * (y % 2))).ravel(), row * y.ravel()], axis=1), np.array([columns * spacing, rows * row])


def pushed(sign, direction, noise=0.1, drift=0.1, frames=400):
    """Frames of a crystal that a Gaussian force which goes with it has displaced: plane waves of the answer; noise, the same in the first frame."""
    places, box = crystal()
    start = places + np.random.default_rng(direction).normal(scale=0.1, size=places.shape)
    random = np.random.default_rng(10 + 2 * direction + sign)
    q = 2 * np.pi * np.array([(m, n) for m in range(-9, 10) for n in range(-9, 10) if (m, n) != (0, 0)]) / box
    answer = static.predicted(TRUE, q, direction, FORCE, box)
    u = sign * (np.exp(1j * (start - box / 2) @ q.T) @ answer).real
    time = 0.1 * np.arange(frames)
    centre = np.zeros((frames, 2))
    centre[:, direction] = sign * drift * time
    moved = start + np.where(time[:, None, None] > 0, u, 0.0) + noise * random.normal(size=(frames, *start.shape)) * (time > 0)[:, None, None]
    return types.SimpleNamespace(box=box, time=time, place=moved, centre=centre)


class PushTest(unittest.TestCase):
    def test_constants_come_back_from_a_pushed_crystal(self):
        cases = []
        for direction in (0, 1):
            pair = [pushed(sign, direction) for sign in (1, -1)]
            q = static.modes(pair[0].box)
            cases.append((q, direction, FORCE, pair[0].box, static.response(pair, q, direction, 0.1)))
        best, errors, chi2, dof = static.fit(cases)
        for value, error, true in zip(best, errors, TRUE):
            self.assertLess(abs(value - true), 4 * error)  # by chance beyond it once in a thousand, with 8 blocks
            self.assertLess(error, 0.04 * true)            # of C12, which is known least; C66 to 0.3 %
        self.assertLess(abs(best[3] / TRUE[3] - 1), 0.01)  # 3 errors: an estimator that is 1 % too stiff fails
        self.assertLess(chi2, 3 * dof)

    def test_beads_that_hopped_do_not_count(self):
        """One bead in ten: counted as not displaced they would make the crystal stiffer by a tenth."""
        pair = [pushed(sign, 0, noise=0.0) for sign in (1, -1)]
        q = static.modes(pair[0].box)
        before = static.response(pair, q, 0, 0.1)
        gone = np.random.default_rng(4).random(len(pair[0].place[0])) < 0.1
        for frames in pair:
            frames.place[1:, gone] += [2.13, 0.0]
            self.assertAlmostEqual(static.share_hopped(frames), gone.mean(), delta=1e-9)
        after = static.response(pair, q, 0, 0.1)
        scale = (after * before.conj()).sum().real / (np.abs(before) ** 2).sum()
        self.assertLess(abs(scale - 1), 0.02)  # what the beads left out carry differs from a tenth by sqrt(0.1/1512) = 0.8 %

    def test_constants_come_back_from_the_pressure_of_strained_boxes(self):
        """p = p0 - C e with noise between runs, and curvature, which two strains of opposite sign take out."""
        random, e, runs, noise = np.random.default_rng(3), 0.004, 40, 1e-6
        stiffness = np.array([[9.8e-3, 2.7e-3], [2.9e-3, 9.9e-3]])  # of xx and yy, by strain along x and y
        def pressures(axis, sign):
            return 8e-4 - sign * e * stiffness[:, axis] + 0.05 * e * e + noise * random.normal(size=(runs, 2))
        found = [strain.slopes(pressures(axis, 1), pressures(axis, -1), e) for axis in (0, 1)]
        for axis in (0, 1):
            for part, (value, error) in enumerate(found[axis]):
                self.assertLess(abs(value - stiffness[part, axis]), 4 * error)
                self.assertAlmostEqual(error, noise / np.sqrt(2 * runs) / e, delta=0.3 * error)  # of 40 runs an error is known to 11 %
        (c11, c21), (c12, c22) = found
        self.assertAlmostEqual(strain.shear(c11, c22, c12, c21)[0], 3.525e-3, delta=4 * noise / np.sqrt(8 * runs) / e)

    def test_a_drag_is_reported_with_its_side(self):
        self.assertEqual(scaling.shown((-144.0, 37.0)), "< 0")
        self.assertEqual(scaling.shown((2.0, 2.2)), "2.0 +- 2.2")
        self.assertEqual(scaling.below((2.0, 3.0), (14.0, 4.0)), "2.4")
        self.assertEqual(scaling.below((2.0, math.nan), (14.0, 4.0)), "-")

    def test_amplitudes_over_all_masks(self):
        found = {"systematics": {"masks": [{"parameters": {"amplitude": {"value": value}}} for value in (1.0, 1.1, 1.5)]}}
        for value, expected in zip(monopole.over_masks(found), (1.2, 0.25)):
            self.assertAlmostEqual(value, expected)


class MovingTest(unittest.TestCase):
    def test_amplitude_and_drag_come_back_with_their_sign(self):
        """A force that moves at 10 a/s: a wake fixed to it, seen in frames at which it is elsewhere each time."""
        places, box = crystal()
        start = places - places.mean(axis=0)
        q = moving.modes(box)
        everywhere = np.concatenate([q, -q])
        wake = moving.predicted(TRUE, 20.0, 150.0, everywhere, 10.0, box, 1.27)
        time, random, place = 0.0997 * np.arange(300), np.random.default_rng(3), [start]
        for t in time[1:]:
            centre = box / 2 + [10.0 * t, 0.0]
            u = (np.exp(1j * (start - centre) @ everywhere.T) @ wake).real
            place.append(start + u + random.normal(scale=0.008, size=u.shape))
        frames = types.SimpleNamespace(box=box, time=time, place=np.array(place), centre=np.zeros((300, 2)))
        data, speed = moving.answer(frames, q, 10.0)
        self.assertEqual(speed, 10.0)
        best, errors, chi2, dof = moving.fit(data, TRUE, 150.0, q, speed, box, 1.27)
        for value, error, true in zip(best, errors, (1.0, 20.0)):
            self.assertLess(abs(value - true), 4 * error)  # by chance beyond it once in a thousand, with 8 blocks
            self.assertLess(error, 0.2 * true)
        self.assertLess(chi2, 3 * dof)


def noisy(U, x, y, sigma, runs):
    """Maps of runs alike, whose chi2 takes bins for worth less than one value."""
    random, error = np.random.default_rng(5), np.full(U[0].shape, sigma)
    found = [U + random.normal(scale=sigma * math.sqrt(spread.INDEPENDENT), size=U.shape) for _ in range(runs)]
    return [{"x": x, "y": y, "Ux": one[0], "Uy": one[1], "sigma_x": error, "sigma_y": error} for one in found]


class SpreadTest(rodwake.ProgramTest):
    X, Y = (np.arange(-n, n, 2.0) + 1.0 for n in (36, 33))
    ZETA, RHO, VISCOSITY, SPEED, F = 14.0, 1.3, 200.0, 10.0, 4e4

    def medium(self, viscosity=VISCOSITY):
        return spread.Medium(self.X, self.Y, TRUE, self.ZETA, self.RHO, viscosity, self.SPEED)

    def maps(self, medium, share, sigma, runs=4, second=(0.0, 0.0)):
        """Rod, dipoles of some 40 a f, a share of the force on 20 a ahead, and noise."""
        half = monopole.ROD_LENGTH / 2
        p_xx, p_yy = medium.dipoles()
        q_xxx, q_xyy = medium.moments(2)
        U = self.F * ((1 - share) * medium.line(-half, half) + share * medium.line(0, 20) + 40 * p_xx + 50 * p_yy + second[0] * q_xxx + second[1] * q_xyy)
        return noisy(U, self.X, self.Y, sigma, runs)

    def test_share_of_the_force_comes_back_and_chi2_knows_the_viscosity(self):
        for share in (0.0, 0.3):
            found = self.maps(self.medium(), share, 0.002)
            value, error, *_ = spread.with_line(found, self.medium(), self.F, 20.0)
            self.assertLess(abs(value - share), 6 * error)  # by chance beyond it once in a hundred, with 4 runs
            self.assertLess(error, 0.1)
            dof = spread.with_line(found, self.medium(), self.F, 20.0)[3]
            with_viscosity, without = (spread.with_line(found, medium, self.F, 20.0)[2] for medium in (self.medium(), self.medium(0.0)))
            self.assertLess(abs(with_viscosity / spread.INDEPENDENT - dof), 6 * math.sqrt(2 * dof))
            self.assertGreater(without, 1.5 * with_viscosity)

    def test_the_medium_is_that_of_the_program(self):
        one = self.maps(self.medium(), 0.0, 1e-6, runs=1, second=(700.0, -400.0))[0]
        rows = [",".join(repr(float(value)) for value in (x, y, one["Ux"][j, i], one["Uy"][j, i], 1e-6, 1e-6))
                for j, y in enumerate(self.Y) for i, x in enumerate(self.X)]
        self.write("map.csv", "\n".join(["x,y,Ux,Uy,sigma_x,sigma_y", *rows]) + "\n")
        constants = ", ".join(f"{name} = {value}" for name, value in zip(("c11", "c22", "c12", "c66"), TRUE))
        self.write("fit.toml", f"""schema = 1
[fit]
parameters = ["amplitude", "p_xx", "p_yy", "q_xxx", "q_xyy"]
fixed = {{ force = {self.F}, {constants}, zeta = {self.ZETA}, rho = {self.RHO}, eta_s = {self.VISCOSITY} }}
rod_length = {monopole.ROD_LENGTH}
source_width = 2.0
[[fit.maps]]
files = ["map.csv"]
box = [72.0, 66.0]
speed = {self.SPEED}
[[fit.masks]]
strip = 8.0
radius = 10.0
""")
        self.expect(0, "fit", "fit.toml", "-o", "out", "--quiet")
        found = json.loads((self.folder / "out/fit.json").read_text())["parameters"]
        for name, true in (("amplitude", 1.0), ("p_xx", 40 * self.F), ("p_yy", 50 * self.F), ("q_xxx", 700 * self.F), ("q_xyy", -400 * self.F)):
            self.assertAlmostEqual(found[name]["value"] / true, 1.0, delta=1e-4)  # the noise of 1e-6 a, of displacements of 0.1 a


class MomentsTest(unittest.TestCase):
    X, Y = (np.arange(-n, n, 2.0) + 1.0 for n in (72, 66))
    ZETA, RHO, SPEED, F = 14.0, 1.3, 10.0, 4e4
    TRUE_MOMENTS = (4.0, 5.0, -6.0, 3.0)  # P_xx and P_yy over 10 a f, Q_xxx and Q_xyy over 100 a^2 f

    def medium(self, drag):
        return spread.Medium(self.X, self.Y, TRUE, drag, self.RHO, 0.0, self.SPEED)

    def mean(self):
        fields = moments.sources(self.medium(self.ZETA), self.F, 2)
        U = sum(strength * field for strength, field in zip((1.0, *self.TRUE_MOMENTS), fields))
        return moments.Mean(noisy(U, self.X, self.Y, 0.05, runs=6), self.medium, self.ZETA, self.F, spread.INDEPENDENT)

    def test_a_compact_source_is_known_by_amplitude_drag_and_chi2(self):
        mean = self.mean()
        value, error = mean.amplitude(2)
        self.assertLess(abs(value - 1.0), 5 * error)  # by chance beyond it once in 250, with 6 runs
        self.assertLess(np.ptp(mean.over_masks(2)), 10 * error)
        best, chi2, dof = mean.fit(2)
        for found, true in zip(best[1:], self.TRUE_MOMENTS):
            self.assertAlmostEqual(found, true, delta=0.05)  # some ten errors, and less than what a wrong factor or sign would make
        self.assertLess(abs(chi2 / spread.INDEPENDENT - dof), 6 * math.sqrt(2 * dof))  # as in SpreadTest
        drag, error = mean.drag(2)
        self.assertLess(abs(drag - self.ZETA), 5 * error)
        self.assertLess(error, 0.2 * self.ZETA)
        self.assertLess(mean.gain(2), 20.0)  # chi2 of one degree of freedom

    def test_dipoles_alone_do_not_pass_for_it(self):
        mean = self.mean()
        _, chi2, dof = mean.fit(1)
        self.assertGreater(chi2, 1.5 * dof)
        self.assertGreater(np.ptp(mean.over_masks(1)), 3 * np.ptp(mean.over_masks(2)))
        drag, error = mean.drag(1)
        self.assertGreater(abs(drag - self.ZETA), 5 * error)

    def test_second_moments_left_out_turn_the_drag_negative_as_in_the_bed(self):
        """At 2.8 a/s, with the moments found there; the made-up map of the fit says the same as the data."""
        self.SPEED, self.TRUE_MOMENTS = 2.8, (3.9, 6.0, -1.8, -2.3)
        mean = self.mean()
        drag, error = mean.drag(1)
        self.assertLess(drag, -5 * error)
        made_up, _ = mean.made_up().drag(1)
        self.assertLess(abs(made_up - drag), 5 * error)
        self.assertLess(abs(mean.made_up().drag(2)[0] - self.ZETA), 0.1 * self.ZETA)  # chi2 is a parabola to some per cent
        drag, error = mean.drag(2)
        self.assertLess(abs(drag - self.ZETA), 5 * error)

    def test_scatter_of_the_runs_is_what_no_model_can_fit(self):
        maps = noisy(np.ones((2, 66, 72)), self.X, self.Y, 0.01, runs=5)
        for one in maps:
            one["used"] = np.ones(one["Ux"].shape)
        maps[0]["used"][:20] = 0.0
        chi2, dof = moments.scatter(maps, spread.INDEPENDENT)
        self.assertAlmostEqual(dof, spread.INDEPENDENT * 2 * 46 * 72 * 4)
        # noise of variance INDEPENDENT sigma^2, so chi2 is INDEPENDENT times that of so many values
        self.assertLess(abs(chi2 - dof), 4 * math.sqrt(2 * dof * spread.INDEPENDENT))

    def test_moments_are_those_of_a_rod_that_walks_along_x(self):
        found = {"systematics": {"errors": {name: {"value": -30.0, "jackknife": 3.0} for name in ("p_xx", "q_xxx")}}}
        for sign in (1.0, -1.0):
            force = sign * 10.0 * bed.A**3, 0.0
            for name, expected in (("p_xx", -3.0), ("q_xxx", -3.0 * sign)):
                for value, wanted in zip(moments.over_force(found, name, force, 1.0), (expected, 0.3)):
                    self.assertAlmostEqual(value, wanted)


class SlipTest(rodwake.ProgramTest):
    def test_a_row_that_slipped_is_seen_beyond_the_mask_only(self):
        x = y = np.arange(-30.0, 31.0, 2.0)
        for place, expected in (((15, 15), 0.1), ((15, 28), 1.05)):  # on the row, and 26 a beside it
            u = np.full((31, 31), 0.1)
            u[place[1], place[0]] = -1.05
            with h5py.File(self.folder / "measure.h5", "w") as file:
                for name, value in (("x", x), ("y", y), ("Ux", u)):
                    file[f"displacement/{name}"] = value
            self.assertEqual(scaling.largest_displacement(self.folder), expected)


class ShapeTest(unittest.TestCase):
    def test_slope_and_asymmetry_of_known_profiles(self):
        x = np.arange(-76.0, 77.0)
        profiles = np.array([scale * np.abs(x - 0.5) ** -0.5 for scale in (0.9, 1.0, 1.1)])
        slope, error = scaling.slope(x, profiles)
        self.assertAlmostEqual(slope, -0.5, delta=0.02)  # x - 0.5 for x
        self.assertLess(error, 1e-9)                     # a factor has no slope
        behind, _ = scaling.asymmetry(x, np.where(x < 0, 2.0, 1.0) * np.where(np.abs(x) < 60, 1.0, 0.0) * np.ones((3, 1)))
        self.assertAlmostEqual(behind, 2.0)

    def test_a_rod_has_turned_when_it_stays_turned(self):
        t = np.arange(10.0)
        theta = np.array([0, 0.3, 0, 0, 0.25, 0.3, 0.3, 0.4, 0.4, 0.4])
        self.assertEqual(pairs.latency({"t": t, "theta0": theta}, 0), 4.0)
        self.assertTrue(math.isnan(pairs.latency({"t": t, "theta0": 0 * theta}, 0)))

    def test_means_and_errors(self):
        self.assertEqual(lab.weighted([(1.0, 1.0), (3.0, 1.0)]), (2.0, math.sqrt(0.5)))
        value, error = lab.ratio((2.0, 0.2), (4.0, 0.0))
        self.assertAlmostEqual(value, 0.5)
        self.assertAlmostEqual(error, 0.05)


def one_sided(seen):
    """U_x of a made-up wake: 40 a long behind, 20 a ahead."""
    return 0.3 * np.exp(-np.abs(seen[:, 1]) / 40) * np.exp(np.where(seen[:, 0] < 0, seen[:, 0] / 40, -seen[:, 0] / 20))


class TailTest(unittest.TestCase):
    def frames(self, speed):
        columns, rows = np.meshgrid(np.arange(437), np.arange(168))
        start = tail.SPACING * np.stack([(columns + 0.5 * (rows % 2)).ravel(), (math.sqrt(0.75) * rows).ravel()], axis=1)
        random = np.random.default_rng(1)
        for time in (-0.1, *np.arange(8.2, 17.0, 0.8)):
            seen = start + [0.3 * time, 0.0] - tail.SIDES / 2 - [speed * time, 0.0]  # the bed drifts
            seen -= tail.SIDES * np.round(seen / tail.SIDES)
            moved = np.stack([one_sided(seen) * (time > 0), np.zeros(len(start))], axis=1)
            yield time, start + moved + random.normal(scale=0.05, size=start.shape) * (time > 0) + [0.3 * time, 0.0]

    def field(self, speed=50.0):
        frames, tail.frames_of = tail.frames_of, lambda run: self.frames(speed)
        try:
            beads, ux, uy = tail.reduced(None, speed)
        finally:
            tail.frames_of = frames
        return np.stack([ux, uy]) / beads

    def test_a_made_up_wake_comes_back(self):
        field = self.field()
        within = np.stack(np.meshgrid(np.linspace(-2.4, 2.4, 5), np.linspace(-3.61, 3.61, 5)), axis=-1).reshape(-1, 2)  # of a bin, 6 by 9 a
        middles = np.stack(np.meshgrid(*tail.bins()), axis=-1).reshape(-1, 1, 2)
        truth = np.zeros(field.shape)
        truth[0] = one_sided((middles + within).reshape(-1, 2)).reshape(-1, 25).mean(axis=1).reshape(field.shape[1:])
        truth[0] -= 0.3 * 60 * 80 / tail.SIDES.prod()  # the mean, which the bed's own drift hides
        found, far = tail.amplitude(field, truth)
        # 0.05 a of noise in some 170 beads a bin: 0.004 a
        self.assertAlmostEqual(found, 1.0, delta=0.01)
        self.assertLess(np.std((field - truth)[:, far]), 0.006)
        behind, ahead = tail.sides_and_decay(field, 27.6)[:2]
        self.assertAlmostEqual(behind, 0.3 * math.exp(-2 * 27.6 / 40), delta=0.02)
        self.assertAlmostEqual(ahead, 0.3 * math.exp(-2 * 27.6 / 20), delta=0.02)

    def test_a_wake_the_other_way_round_is_not_taken_for_it(self):
        field = self.field()
        self.assertGreater(abs(tail.amplitude(field[:, :, ::-1], field)[0] - 1.0), 0.1)

    def test_the_theory_from_rest_becomes_steady(self):
        # the longest wave decays by exp(-0.06 t) at 50 a/s, on the way from 8 to 18 s
        steady, rest = tail.theory(50.0, False), tail.theory(50.0)
        self.assertLess(np.abs(rest - steady).max(), 0.02)
        self.assertGreater(np.abs(rest - steady).max(), 1e-5)
        behind, ahead = tail.sides_and_decay(steady, tail.screening(50.0))[:2]
        self.assertGreater(behind, 4 * ahead)


class HardTest(unittest.TestCase):
    def test_the_approximant_goes_on_where_ten_terms_end(self):
        """ln(1 + x)/x at x = 1.2, beyond the radius of its series; then the series of hard discs, which lacks 3 % at phi = 0.6."""
        own, hard.B = hard.B, tuple((-1)**n / (n + 1) for n in range(10))
        try:
            self.assertAlmostEqual(hard.pade(0.6), math.log(2.2) / 1.2, places=6)
            self.assertGreater(abs(hard.series(0.6)[0] - math.log(2.2) / 1.2), 0.1)
        finally:
            hard.B = own
        self.assertAlmostEqual(hard.series(0.1)[0], hard.pade(0.1), places=8)
        self.assertAlmostEqual(hard.pade(0.3), 2.06352, places=5)
        self.assertLess(hard.series(0.6)[0], 0.98 * hard.pade(0.6))  # short by 3 %
        self.assertLess(abs(hard.pade(0.6, 5) / hard.pade(0.6) - 1), 3e-4)

    def test_contact_value_is_extrapolated_from_the_bins(self):
        r = 1.025 + 0.05 * np.arange(80)
        true = np.where(r > 2, np.exp(1.5 - 2.2 * (r - 2) + 1.1 * (r - 2)**2), 0.0)
        g = true * (1 + 0.005 * np.random.default_rng(1).normal(size=len(r)))
        value, error = hard.contact(r, g, 0.005 * g)
        self.assertLess(abs(value - math.exp(1.5)), 4 * error)
        self.assertLess(error, 0.03 * value)  # 8 bins of 0.5 %, three parameters, 1.5 bins beyond them
        self.assertTrue(math.isnan(hard.contact(r[:22], g[:22], g[:22])[0]))

    def test_onset_and_the_limit_of_the_step(self):
        value, error = hard.onset([0.70, 0.71, 0.72], [(0.2, 0.01), (0.3, 0.02), (0.5, 0.02)])
        self.assertAlmostEqual(value, 0.715)
        self.assertAlmostEqual(error, 0.05 * 0.02 * math.sqrt(0.5))
        self.assertTrue(math.isnan(hard.onset([0.70, 0.71], [(0.5, 0.01), (0.6, 0.01)])[0]))
        self.assertEqual(hard.without_step((1.02, 0.0), (1.01, 0.0))[0], 1.0)

    def test_a_run_is_reduced_to_what_hard_discs_are_known_by(self):
        """Two runs whose impulses carry four and six times what the motion does: Z = 5 and 7."""
        phi, beads, T = 0.5, 1500, np.array([2.5e-3, 2.4e-3])
        area = beads * math.pi * bed.A**2 / phi
        p = np.array([5, 7]) * beads * hard.MASS * T / area
        with tempfile.TemporaryDirectory() as scratch:
            folder = Path(scratch)
            (folder / "summary.json").write_text(json.dumps({"box": math.sqrt(area), "beads": beads, "beads_fraction": phi, "runs": 2, "T_xy": 2.45e-3,
                                                             "T_z": 2e-3}))
            (folder / "measure.json").write_text(json.dumps({"order": {"psi6": {"value": 0.1, "error": 0.01}, "class": "exponential",
                                                                       "exponent": {"value": 0.5, "error": None}}}))
            (folder / "runs.csv").write_text("p_xx,p_yy,T_xy\n" + "".join(f"{1.1 * one},{0.9 * one},{t}\n" for one, t in zip(p, T)))
            (folder / "gr.csv").write_text("r,g,sigma\n" + "".join(f"{2.025 + 0.05 * k},3,0.01\n" for k in range(10)))
            row = hard.reduced(folder)
        self.assertAlmostEqual(row["Z"], 6)
        self.assertAlmostEqual(row["Z_error"], 1)
        self.assertAlmostEqual(row["P"], 6 * 4 * phi / math.pi)  # Z rho sigma^2
        self.assertAlmostEqual(row["contact"], 3)
        self.assertTrue(math.isnan(row["exponent_error"]))


class WakesTest(unittest.TestCase):
    def test_f_over_mu_and_eta_come_back_from_maps_relative_to_the_zone_ahead(self):
        x = np.arange(-39, 39) + 0.5
        medium = spread.Medium(x, x, (3.2, 3.2, 1.2, 1.0), 1 / 600, 0.0, 0.0, 1.0, 1.0)
        U = 1.5 * medium.line(-5.6, 5.6) + 3 * medium.dipoles()[0] - 2 * medium.dipoles()[1] + 10 * medium.moments(2)[0]
        zone = (x > 0.3 * 78) & (x < 0.45 * 78)
        U -= U[:, :, zone].mean(axis=2, keepdims=True)
        U[0] += 0.3 * (x[zone].mean() - x) / 78  # some beads are dragged along, and all others stay behind
        exact = U.reshape(2, 26, 3, 26, 3).mean(axis=(2, 4))[:, 13:]
        maps = exact + 0.02 * np.random.default_rng(1).normal(size=(8, *exact.shape))
        (scale, log, chi2), errors, masks = wakes.fitted(maps, 900.0)
        self.assertLess(abs(scale - 1.5), 3 * math.hypot(errors[0], masks[0]))
        self.assertLess(abs(log - math.log(2.2)), 3 * math.hypot(errors[1], masks[1]))
        self.assertLess(max(errors[0], masks[0]), 0.15)
        self.assertLess(chi2, 1.7)  # 7/5 with sigma from eight runs
        # Straight lines give the strain exactly.
        X, Y = np.meshgrid(wakes.CENTRES, wakes.CENTRES[13:])
        self.assertAlmostEqual(wakes.strain(np.array([-0.004 * Y, 0.002 * X])), -0.001, delta=1e-12)


if __name__ == "__main__":
    rodwake.main()
