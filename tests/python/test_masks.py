"""Arrays that are none, or have masks: data without the masked rows, or a message that names the argument."""

import pickle
import unittest
import warnings
from dataclasses import replace
from fractions import Fraction

import numpy as np
import rodwake
from program import SCENES
from rodwake import Map, Profile, Track
from test_fit_maps import FREE, KEYS, some_map
from test_fitting import PLACES, noisy_profile

PAIR = [[0, 2.5, 0], [0, -2.5, 0]]
MEDIUM = rodwake.Medium()
NAMES = ["f_over_mu", "eta", "xi"]
BED = 'schema = 1\n[granular]\nbeads = 40\nbox = "16 a"\nstart = "lattice"\nequilibrate = "0 s"\nduration = "0.01 s"\n'


def masked(values, *hidden):
    """With masks on some, counted along the flat array."""
    found = np.ma.masked_array(values)
    found.mask = np.isin(np.arange(found.size), hidden).reshape(found.shape)
    return found


def none_of(good):
    """What is no array of numbers, in the shape of one that is."""
    shape = np.shape(good)
    filled = np.ones(shape)
    for value in (filled + 1j, filled > 0, filled.astype(str), filled.astype("S3"), filled.astype("datetime64[s]"), filled.astype("timedelta64[ns]"),
                  np.full(shape, None), np.full(shape, 1j, object), np.full(shape, True, object), np.full(shape, {}, object)):
        yield value, value.dtype.name
    yield from ((value, repr(value)) for value in ("abc", {}, {"x": 1.0}, object(), [[1.0], [2.0, 3.0]], lambda: 1))


class FitTest(unittest.TestCase):
    def assert_same(self, ours, theirs):
        self.assertEqual((ours.chi2, ours.dof, repr(ours.parameters)), (theirs.chi2, theirs.dof, repr(theirs.parameters)))
        np.testing.assert_array_equal(ours.residuals, theirs.residuals)

    def test_masked_rows_of_a_profile_are_left_out(self):
        whole = noisy_profile()
        kept = np.delete(np.arange(81), [10, 40])
        fewer = rodwake.fit_wake([Profile(whole.place[kept], whole.value[kept], whole.sigma[kept], at=1.0)], NAMES)
        outliers = whole.value.copy()
        outliers[[10, 40]] = 1e6
        for changes in ({"value": masked(outliers, 10, 40)}, {"value": masked(outliers, 10), "sigma": masked(whole.sigma, 40)},
                        {"value": outliers, "place": masked(whole.place, 10, 40)}):
            found = rodwake.fit_wake([replace(whole, **changes)], NAMES)
            self.assert_same(found, fewer)
            np.testing.assert_array_equal(found.profiles[0].place, PLACES[kept])
        self.assert_same(rodwake.fit_wake([replace(whole, value=masked(whole.value))], NAMES), rodwake.fit_wake([whole], NAMES))
        with self.assertRaises(rodwake.InputError):
            rodwake.fit_wake([replace(whole, value=masked(outliers, *range(81)))], NAMES)

    def test_masked_rows_of_a_track_are_left_out(self):
        run = rodwake.simulate(PAIR, MEDIUM, kappa=0.5, t_end=20.0, output_times=np.linspace(0, 20, 21), rtol=1e-10)
        keys = {"parameters": ["kappa"], "fixed": {"eta": 1.0, "alpha": 1.0}}
        kept = np.delete(np.arange(21), [0, 7])
        fewer = rodwake.fit_rods([Track(run.t[kept], run.poses[kept], 1e-3, 1e-3)], **keys)
        wrong = run.poses.copy()
        wrong[[0, 7], 1, 0] = 1e6
        hidden = masked(wrong, 3, 7 * 6 + 3)  # six numbers a row
        for t, poses in ((run.t, hidden), (run.t, list(hidden)), (masked(run.t, 0, 7), wrong)):
            self.assert_same(rodwake.fit_rods([Track(t, poses, 1e-3, 1e-3)], **keys), fewer)

    def test_masked_bins_of_a_map_hold_no_data(self):
        holes, hidden = some_map(3), some_map(3)
        for field in (holes.Ux, holes.Uy):
            field[4:6, 7:9] = np.nan
        mask = np.isnan(holes.Ux)
        for field in (hidden.Ux, hidden.Uy):
            field[mask] = 1e6
        hidden = replace(hidden, Ux=np.ma.masked_array(hidden.Ux, mask), Uy=np.ma.masked_array(hidden.Uy, mask))
        self.assert_same(rodwake.fit_map([hidden], FREE, **KEYS), rodwake.fit_map([holes], FREE, **KEYS))

    def test_what_are_no_data_is_reported_with_its_name(self):
        good, plain = noisy_profile(), some_map()
        track = Track([0.0, 1.0], np.zeros((2, 1, 3)), 1e-3, 1e-3)
        sets = [("profiles", rodwake.fit_wake, good, NAMES, {}, ("place", "value", "sigma")),
                ("tracks", rodwake.fit_rods, track, ["kappa"], {"fixed": {"eta": 1.0, "alpha": 1.0}}, ("t", "poses")),
                ("maps", rodwake.fit_map, plain, FREE, KEYS, ("x", "y", "Ux", "Uy", "sigma_x", "sigma_y"))]
        for name, fit, one, free, keys, fields in sets:
            for given in ("abc", b"abc", {}, {"a": 1}, None, 3.0, np.array(3.0), one, lambda: one):
                with self.subTest(name, given=repr(given)), self.assertRaisesRegex(rodwake.InputError, f"^{name}: expected a list of"):
                    fit(given, free, **keys)
                if given is not one:
                    with self.subTest(name, item=repr(given)), self.assertRaisesRegex(rodwake.InputError, rf"^{name}\[1\]: expected a list of rodwake"):
                        fit([one, given], free, **keys)
                    with self.subTest(name, names=repr(given)), self.assertRaisesRegex(rodwake.InputError, "^parameters: expected a list of names"):
                        fit([one], given, **keys)
            for field in fields:
                for value, said in none_of(getattr(one, field)):
                    with self.subTest(name, field=field, value=said), self.assertRaisesRegex(rodwake.InputError, rf"^{name}\[0\]\.{field}: expected"):
                        fit([replace(one, **{field: value})], free, **keys)

    def test_values_beside_the_arrays(self):
        plain, track = some_map(), Track([0.0, 1.0], np.zeros((2, 1, 3)), 1e-3, 1e-3)
        for changes, word in ((dict(x=masked(plain.x, 2)), r"maps\[0\]\.x: 1 of 24 values are masked"), (dict(box=(60.0, np.ma.masked)), "box"),
                              (dict(box=60.0), "box"), (dict(box=None), "box"), (dict(speed="fast"), "speed")):
            with self.subTest(word), self.assertRaisesRegex(rodwake.InputError, word):
                rodwake.fit_map([replace(plain, **changes)], FREE, **KEYS)
        for changes, word in ((dict(independent=0.0), r"tracks\[0\]\.independent = 0"), (dict(independent=None), "independent"),
                              (dict(contact_distance=-1.0), "contact_distance"), (dict(contact_distance=np.nan), "contact_distance"),
                              (dict(sigma_position=np.ma.masked), "sigma_position"), (dict(sigma_heading=1j), "sigma_heading"),
                              (dict(t=[0.0]), r"\(T, N, 3\)"), (dict(poses=np.zeros((2, 3))), r"\(T, N, 3\)")):
            with self.subTest(word), self.assertRaisesRegex(rodwake.InputError, word):
                rodwake.fit_rods([replace(track, **changes)], ["kappa"], fixed={"eta": 1.0, "alpha": 1.0})
        for options, word in ((dict(start={"xi": np.ma.masked}), "xi: "), (dict(start={"xi": object()}), "xi: "), (dict(threads="all"), "threads"),
                              (dict(threads=-1), "threads")):
            with self.subTest(word), self.assertRaisesRegex(rodwake.InputError, word):
                rodwake.fit_wake([noisy_profile()], NAMES, **options)

    def test_a_fit_can_be_sent(self):
        found = rodwake.fit_wake([noisy_profile()], NAMES)
        other = pickle.loads(pickle.dumps(found))
        self.assert_same(other, found)
        self.assertEqual((other.report(), repr(other)), (found.report(), repr(found)))


class ArgumentTest(unittest.TestCase):
    """Each argument that is an array: name, a good value, and the call."""

    @classmethod
    def setUpClass(cls):
        cls.bed = rodwake.Bed(rodwake.Scene.parse(BED))
        cls.pair = rodwake.Scene.load(SCENES / "pair.toml")

    def arguments(self):
        times, rows, walk = [0.0, 1.0], [[0.0, 0, 0], [1.0, 0, 0]], {"medium": MEDIUM, "t_end": 1.0}
        noisy = {**walk, "rotational_diffusion": 0.1, "runs": 2}
        yield "poses", PAIR, lambda value: rodwake.simulate(value, **walk)
        yield "output_times", times, lambda value: rodwake.simulate(PAIR, **walk, output_times=value)
        yield "poses", PAIR, lambda value: rodwake.simulate_noise(value, **noisy)
        yield "output_times", times, lambda value: rodwake.simulate_noise(PAIR, **noisy, output_times=value)
        yield "t", times, lambda value: rodwake.classify(value, rows)
        yield "poses", rows, lambda value: rodwake.classify(times, value)
        yield "law", [1.0, 0, 0], lambda value: rodwake.classify(times, rows, law=lambda t, y: value)
        yield "poses", PAIR, lambda value: rodwake.wakes(value, MEDIUM)
        yield "rods", PAIR, lambda value: rodwake.strain(9.0, 9.0, MEDIUM, rods=value)
        yield "poses", PAIR, lambda value: rodwake.RodEquations(value, MEDIUM)
        yield "y0", [1.0, 0.0], lambda value: rodwake.integrate(lambda t, y: [0, 0], value, [1.0])
        yield "y0", PAIR, lambda value: rodwake.integrate(rodwake.RodEquations(PAIR), value, [1.0])
        yield "times", [1.0, 2.0], lambda value: rodwake.integrate(lambda t, y: [0, 0], [1.0, 0.0], value)
        yield "places", [[0.0, 0.0]], lambda value: self.bed.body_acceleration(value)
        yield "axes", [1.0, 2.0], lambda value: rodwake.scan(self.pair, {"coupling.kappa": value})

    def test_masked_values_are_refused(self):
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            for name, good, call in self.arguments():
                lists = [masked(np.array(good, float), 0), np.ma.masked_array(good).tolist()]
                lists[1][0] = np.ma.masked if np.ndim(good) == 1 else masked(np.array(good[0], float), 0)
                for value in lists:
                    with self.subTest(name, good=good, value=repr(value)), self.assertRaisesRegex(rodwake.InputError, f"^{name}.*masked"):
                        call(value)

    def test_what_are_no_numbers_is_refused(self):
        for name, good, call in self.arguments():
            for value, said in none_of(good):
                pattern = "axes|coupling.kappa" if name == "axes" else rf"^{name}\b"  # keys may have words and flags: the scene tells
                with self.subTest(name, good=good, value=said), self.assertRaisesRegex(rodwake.InputError, pattern):
                    call(value)

    def test_masks_that_hide_nothing_are_taken(self):
        for name, good, call in self.arguments():
            if name != "axes":
                with self.subTest(name, good=good):
                    call(np.ma.masked_array(good, dtype=float))
        walked = rodwake.simulate([np.ma.masked_array([0, 2.5, 0]), [0, Fraction(-5, 2), 0]], MEDIUM, kappa=0.5, t_end=5.0)
        np.testing.assert_array_equal(walked.poses, rodwake.simulate(PAIR, MEDIUM, kappa=0.5, t_end=5.0).poses)

    def test_places_of_a_field_may_be_masked(self):
        row = masked(np.array([2.0, 3.0]), 1)
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            for x in (row, [row, row], masked(np.array([2.0, None], object), 1), [2.0, np.ma.masked]):
                values = rodwake.strain(x, 1.0, MEDIUM).reshape(-1, 2, 2, 2)
                self.assertTrue(np.isnan(values[:, 1]).all())
                np.testing.assert_array_equal(values[:, 0], rodwake.strain([2.0] * len(values), 1.0, MEDIUM))
        for value, said in none_of([1.0, 2.0]):
            for given in ({"x": value, "y": 1.0}, {"x": 1.0, "y": value}):
                name = "x" if given["x"] is value else "y"
                with self.subTest(said, name=name), self.assertRaisesRegex(rodwake.InputError, f"^{name}: expected numbers"):
                    rodwake.displacement(**given, medium=MEDIUM)

    def test_numbers_that_are_none_are_refused(self):
        wrong = (np.ma.masked, np.ma.masked_array(0.5, mask=True), np.timedelta64(5, "ns"), np.datetime64(5, "ns"), np.array(5, "timedelta64[ns]"),
                 np.array("5"), np.array(True), np.array(1j), np.array(None), np.True_, b"5", [0.5], {})
        for name, call in (("kappa", lambda value: rodwake.simulate(PAIR, MEDIUM, t_end=1.0, kappa=value)),
                           ("contact_distance", lambda value: rodwake.simulate(PAIR, MEDIUM, t_end=1.0, contact_distance=value)),
                           ("eta", lambda value: rodwake.Medium(eta=value)), ("periodic", lambda value: rodwake.Medium(periodic=value)),
                           ("rtol", lambda value: rodwake.integrate(lambda t, y: [0], [0.0], [1.0], rtol=value)),
                           ("runs", lambda value: rodwake.simulate_noise(PAIR, MEDIUM, t_end=1.0, rotational_diffusion=0.1, runs=value)),
                           ("max_steps", lambda value: rodwake.integrate(lambda t, y: [0], [0.0], [1.0], max_steps=value)),
                           ("coupling.kappa", lambda value: rodwake.Scene.load(SCENES / "pair.toml").set("coupling.kappa", np.asanyarray(value)))):
            for value in wrong:
                with self.subTest(name, value=repr(value)), warnings.catch_warnings():
                    warnings.simplefilter("error")
                    with self.assertRaisesRegex((rodwake.InputError, TypeError) if "." in name else rodwake.InputError, name):
                        call(value)
        with self.assertRaisesRegex(rodwake.InputError, "max_steps"):
            rodwake.simulate(PAIR, MEDIUM, t_end=1.0, max_steps=np.ma.masked_array(3, mask=True))

    def test_negative_distances_and_places_that_are_none(self):
        for distance in (-0.1, 0.0, np.nan, np.inf):
            for call in (lambda **given: rodwake.simulate(PAIR, MEDIUM, t_end=1.0, **given),
                         lambda **given: rodwake.classify([0.0, 1.0], [[0, 0, 0], [1, 0, 0]], **given),
                         lambda **given: rodwake.simulate_noise(PAIR, MEDIUM, t_end=1.0, rotational_diffusion=0.1, **given)):
                with self.assertRaisesRegex(rodwake.InputError, "contact_distance"):
                    call(contact_distance=distance)
        for places in ([[np.nan, 0.0]], [[0.0, np.inf]], [[0.0, 0.0, np.nan]]):
            with self.assertRaisesRegex(rodwake.InputError, "places: (nan|inf)"):
                self.bed.body_acceleration(places)
        for law in (lambda t, y: [1.0, 2.0], lambda t, y: np.ones(3 if t == 0 else 6), lambda t, y: None):
            with self.assertRaisesRegex(rodwake.InputError, "law: expected a function that returns 3 numbers"):
                rodwake.classify([0.0, 1.0], [[0, 0, 0], [1, 0, 0]], law=law)


if __name__ == "__main__":
    unittest.main()
