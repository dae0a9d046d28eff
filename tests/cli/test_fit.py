"""rodwake fit: known parameters come back from made-up profiles, and what the data cannot tell is said."""

import json
import resource

import numpy as np
import rodwake
from fits import FIELD, FIT, FITTED, KEYS, SIGMA, TRUE, X, FitTest, columns, profile_text, wake

PRECISE = SIGMA / 8  # eta has an upper and a lower limit


class RecoveryTest(FitTest):
    def test_a_profile_gives_its_parameters_back(self):
        self.make_profile()
        found, done = self.fit(FIT)
        self.assert_recovered(found, TRUE)
        self.assertEqual(found["termination"], "converged")
        self.assertEqual(found["dof"], len(X) - 3)
        self.assertLess(abs(found["chi2"] - found["dof"]), 4.0 * np.sqrt(2.0 * found["dof"]))  # four standard deviations of chi2
        self.assertLess(found["parameters"]["eta"]["stderr"], 0.5 * TRUE["eta"])  # the errors are not just large
        alpha = found["derived"]["alpha"]
        self.assertLess(abs(alpha["value"] - 0.1), 4.0 * alpha["stderr"])
        self.assertRegex(done.stderr, r"fit: eta = 1\.\d+ \+- 0\.\d+")
        self.assertEqual(self.status("out"), "finished")
        self.assertIn("results in out; rodwake plot out draws them", done.stderr)

    def limited(self, megabytes):
        """The program with no more address space than that."""
        limit = megabytes * 2**20
        options = {"preexec_fn": lambda: resource.setrlimit(resource.RLIMIT_AS, (limit, limit))}
        if self.run_program("--version", **options).returncode != 0:
            self.skipTest("this build needs more memory to say its version: it is one with sanitizers")
        return options

    def test_many_points_take_memory_for_the_points_only(self):
        """Numbers for each pair of 8000 points would take 512 MB."""
        places = np.linspace(4.0, 40.0, 8000)
        self.make_profile(places=places)
        self.write("fit.toml", FIT)
        self.expect(0, "fit", "fit.toml", "-o", "out", "--quiet", **self.limited(400))
        found = json.loads((self.folder / "out/fit.json").read_text())
        self.assert_recovered(found, TRUE)
        self.assertGreater(found["profiles"][0]["excess"]["stderr"], 0.0)

    def test_too_little_memory_is_said_in_words(self):
        self.make_profile(places=np.linspace(4.0, 40.0, 100000), sigma=1.0)
        self.write("fit.toml", FIT)
        done = self.expect(1, "fit", "fit.toml", "-o", "out", "--quiet", **self.limited(90))
        self.assertRegex(done.stderr, "rodwake: not enough memory; .* fewer rows")

    def test_errors_that_are_too_small_are_noticed(self):
        """The check above can fail: noise ten times sigma does not fit."""
        self.make_profile(sigma=10 * SIGMA)
        self.write("ux.csv", (self.folder / "ux.csv").read_text().replace(f",{10 * SIGMA!r}", f",{SIGMA!r}"))
        found, done = self.fit(FIT)
        self.assertGreater(found["chi2"], 10.0 * found["dof"])
        self.assertRegex(done.stderr, "poor chi2")

    def test_fit_json_and_its_tables_hold_what_they_should(self):
        self.make_profile(sigma=PRECISE)
        self.make_profile("uy.csv", X, 4.0, "Uy", sigma=PRECISE)
        text = FIT.replace("[[fit.profiles]]", 'likelihood = ["eta"]\nstarts = 3\n[[fit.profiles]]') + """[[fit.profiles]]
file = "uy.csv"
component = "Uy"
at = 4.0
role = "predict"
[[fit.compare]]
name = "double"
values = { f_over_mu = 4.4, alpha = 0.2 }
"""
        found, done = self.fit(text, "-s", "fit.core=5.0")
        self.assertEqual(set(found), KEYS["fit"])
        for name in TRUE:
            self.assertEqual(set(found["parameters"][name]), KEYS["parameter"])
        self.assertEqual(set(found["profiles"][0]), KEYS["profile"])
        self.assertEqual(set(found["starts"][0]), KEYS["start"])
        self.assertEqual(set(found["compare"][0]), KEYS["compare"])
        self.assertEqual(np.shape(found["correlation"]), (3, 3))
        described = {one["name"].partition(".")[0] for one in json.loads((self.folder / "out/manifest.json").read_text())["files"]["fit.json"]["values"]}
        self.assertEqual(set(found) - described, {"flat", "trajectories", "maps", "systematics"})  # empty here
        eta, likelihood = found["parameters"]["eta"], found["likelihood"]["eta"]
        self.assertTrue(likelihood["low"] < eta["value"] < likelihood["high"])
        self.assert_tables(found)
        self.assert_scores(found)
        interval, excess = f"{likelihood['low']:.5g} to {likelihood['high']:.5g}", found["profiles"][1]["excess"]
        self.assertIn(f"eta: 95 % interval by the profile likelihood {interval}", done.stderr)
        self.assertIn(f"uy: predicted; data over prediction {excess['scale']:.4g} +- {excess['stderr']:.2g}", done.stderr)

    def assert_tables(self, found):
        for index, profile in enumerate(found["profiles"]):
            data = columns(self.folder / "out" / profile["data"])
            curve = columns(self.folder / "out" / profile["curve"])
            self.assertEqual(list(data), ["x", "value", "sigma", "model", "band", "residual", "used"])
            self.assertEqual(list(curve), ["x", "model", "band", "compare_0"])
            np.testing.assert_array_equal(data["x"], X)
            np.testing.assert_array_equal(data["used"] > 0, np.abs(X) >= 5.0)
            self.assertEqual((profile["points"], profile["used"]), (len(X), np.sum(np.abs(X) >= 5.0)))
            used = data["used"] > 0
            chi2 = np.sum(((data["value"] - data["model"])[used] / PRECISE)**2)
            self.assertAlmostEqual(chi2, profile["chi2"], delta=1e-9 * chi2)
            np.testing.assert_allclose(data["residual"], (data["value"] - data["model"]) / PRECISE, rtol=1e-9, atol=1e-9)
            self.assertTrue(np.all(data["band"] > 0.0))
            exact = wake(self, curve["x"], found["profiles"][index]["at"], profile["component"], "x", None,
                         **{name: one["value"] for name, one in found["parameters"].items()})
            np.testing.assert_allclose(curve["model"], exact, atol=1e-12)  # round-off of xi/f and back

    def assert_scores(self, found):
        """Two points in a row: what is predicted fits by a factor of 1, twice the force by one of about a half."""
        predicted = found["profiles"][1]["excess"]
        self.assertLess(abs(predicted["scale"] - 1.0), 4.0 * predicted["stderr"])
        other = found["compare"][0]
        self.assertAlmostEqual(other["values"]["xi"], 22.0)  # alpha = 0.2 with f_over_mu = 4.4
        self.assertAlmostEqual(other["values"]["eta"], found["parameters"]["eta"]["value"])
        self.assertLess(abs(other["profiles"][0]["excess"]["scale"] - 0.5), 0.05)
        self.assertGreater(other["chi2"], 100.0 * found["chi2"])

    def test_a_box_has_images_and_the_plane_is_biased(self):
        self.make_profile(box=78.0)
        inside, _ = self.fit(FIT, "-s", "fit.box=78 a")
        self.assert_recovered(inside, TRUE)
        plane, _ = self.fit(FIT, out="plane")
        self.assertGreater(plane["chi2"], 2.0 * inside["chi2"])
        self.assertEqual((inside["box"], plane["box"]), (78.0, None))

    def test_as_many_values_as_parameters_without_sigma_leave_the_errors_unknown(self):
        x = np.array([-20.0, -5.0, 12.0])
        value = wake(self, x, 0.0, "Ux", "x", None, **TRUE)
        self.write("ux.csv", "x,value\n" + "".join(f"{a!r},{b!r}\n" for a, b in zip(x.tolist(), value.tolist())))
        found, done = self.fit(FIT)
        for name, true in TRUE.items():
            self.assertRegex(done.stderr, rf"fit: {name} = .*error unknown")
            self.assertIsNone(found["parameters"][name]["stderr"])
            self.assertAlmostEqual(found["parameters"][name]["value"], true, delta=1e-3 * true)  # three values fix three parameters

    def test_a_range_leaves_out_the_other_places(self):
        self.make_profile()
        found, _ = self.fit(FIT, "-s", "fit.profiles.0.range=[-20.0, 30.0]")
        read = columns(self.folder / "out" / found["profiles"][0]["data"])["x"]
        np.testing.assert_array_equal(read, X[(X >= -20.0) & (X <= 30.0)])
        self.refuse(2, "no points to fit within fit.profiles.range", "fit", "fit.toml", "-o", "none", "-s",
                    "fit.profiles.0.range=[900.0, 901.0]")

    def test_fixed_and_tied_parameters(self):
        self.make_profile(f2d_over_mu=1.1)
        found, _ = self.fit(FIT.replace('"eta", "xi"]', '"eta"]').replace("[[fit.prof", 'fixed = { xi = 22.0 }\n'
                                        'tied = { f2d_over_mu = ["f_over_mu", 0.5] }\n[[fit.prof'))
        self.assert_recovered(found, {"f_over_mu": 2.2, "eta": 1.3})
        self.assertEqual(found["parameters"]["xi"]["value"], 22.0)
        self.assertTrue(found["parameters"]["xi"]["fixed"])
        tied = found["parameters"]["f2d_over_mu"]
        self.assertEqual((tied["tied_to"], tied["free"]), ("f_over_mu", False))
        self.assertAlmostEqual(tied["value"], 0.5 * found["parameters"]["f_over_mu"]["value"])
        self.assertEqual(found["free"], ["f_over_mu", "eta"])

    def test_runs_in_one_file_and_equal_places_are_counted_for_what_they_are(self):
        self.make_profile()
        once, _ = self.fit(FIT, "-s", "fit.independent_spacing=4.0", out="once")
        first = (self.folder / "ux.csv").read_text()
        rows = [row.split(",") for row in first.splitlines()[1:]]
        self.write("ux.csv", first + "".join(f"{float(x) + 1e-6!r},{value},{sigma}\n" for x, value, sigma in rows))  # the same values, by another run
        twice, _ = self.fit(FIT, "-s", "fit.independent_spacing=4.0", out="twice")
        self.assertEqual((once["dof"], twice["dof"]), (10, 24))  # 53 and 106 points worth a quarter each, rounded
        self.assertAlmostEqual(twice["parameters"]["xi"]["stderr"] / once["parameters"]["xi"]["stderr"], 2**-0.5, delta=1e-3)  # what 1e-6 in the places changes, and the end of the search
        self.assert_recovered(twice, TRUE)
        self.write("ux.csv", "x,value,sigma\n" + 40 * "5.0,0.3,0.01\n5.0,0.31,0.01\n")
        self.refuse(2, "80 data points worth 1 independent ones cannot fix 3 parameters", "fit", "fit.toml", "-o", "none", "-s", "fit.independent_spacing=4.0")

    def test_lengths_with_a_unit_are_in_the_unit_of_the_data(self):
        """One profile in bead radii (0.4 mm), and the same in mm and in um, beside keys in any unit."""
        self.make_profile(at=4.0, box=78.0)
        keys = 'box = "{} mm"\ncore = "{} um"\nindependent_spacing = "{} cm"\n'.format(0.4 * 78, 2400, 0.06)
        text = FIT.replace("[[fit.prof", keys + "[[fit.prof") + 'at = "1.6 mm"\nrange = ["-12 mm", "6 mm"]\n'
        radii, _ = self.fit(text, out="radii")
        self.assert_recovered(radii, TRUE)
        data = columns(self.folder / "ux.csv")
        for unit, a in (("mm", 0.4), ("um", 400.0)):
            self.write("ux.csv", profile_text(data["x"] * a, data["value"] * a, SIGMA * a))
            scaled, _ = self.fit(text, "-s", f"fit.length_unit={unit}", "-s", f"fit.start={{ f_over_mu = {1.5 * a}, eta = 2.0, xi = {15 * a} }}", out=unit)
            self.assert_same_fit(radii, scaled, a)
            self.assertEqual(scaled["parameters"]["xi"]["unit"], unit)
        # columns in units of their own: places in mm, displacements in um
        self.write("ux.csv", profile_text(data["x"] * 0.4, data["value"] * 400, SIGMA * 400))
        mixed, _ = self.fit(text, "-s", "fit.profiles.0.place_unit=mm", "-s", "fit.profiles.0.value_unit=um", out="mixed")
        self.assert_same_fit(radii, mixed, 1.0)
        self.refuse(2, r'fit\.box.*cannot convert to "px": fit\.length_unit = "px" is not a unit', "check", "fit.toml", "-s", "fit.length_unit=px")
        self.refuse(2, r'place_unit = "px" cannot be converted to length_unit = "a"', "check", "fit.toml", "-s", "fit.profiles.0.place_unit=px")
        self.assertIn("core = 6.0", self.expect(0, "check", "fit.toml", "-s", "fit.length_unit=px", "-s", "fit.box=78 px", "-s", "fit.core=6 px", "-s",
                                                "fit.independent_spacing=1.5", "-s", "fit.profiles.0.at=4", "-s", "fit.profiles.0.range=[-30, 15]").stdout)

    def assert_same_fit(self, one, other, length):
        """In a unit of length that is `length` times as small; the searches end within 1e-6 of an error."""
        for name, factor in (("f_over_mu", length), ("eta", 1.0), ("xi", length)):
            a, b = one["parameters"][name], other["parameters"][name]
            self.assertAlmostEqual(b["value"] / factor, a["value"], delta=1e-4 * a["stderr"])
            self.assertAlmostEqual(b["stderr"] / factor, a["stderr"], delta=1e-4 * a["stderr"])
        self.assertEqual((one["dof"], one["profiles"][0]["used"]), (other["dof"], other["profiles"][0]["used"]))

    def test_the_default_start_goes_with_the_data(self):
        self.make_profile(at=2.0)
        text = FIT.replace("start = { f_over_mu = 1.5, eta = 2.0, xi = 15.0 }\n", "") + "at = 2.0\n"
        usual, _ = self.fit(text, out="usual")
        data = columns(self.folder / "ux.csv")
        for a in (1e9, 1e-9, 400.0):
            self.write("ux.csv", profile_text(data["x"] * a, data["value"] * a, SIGMA * a))
            scaled, _ = self.fit(text, "-s", f"fit.profiles.0.at={2 * a}", out=f"scaled{a}")
            self.assert_same_fit(usual, scaled, a)
            low, high = scaled["parameters"]["xi"]["bounds"]
            self.assertTrue(low < scaled["parameters"]["xi"]["value"] < high)

    def test_places_and_displacements_in_different_units_are_noticed(self):
        self.make_profile(at=4.0)
        data = columns(self.folder / "ux.csv")
        for factor, expected in ((1000.0, True), (1e-5, True), (1.0, False)):
            self.write("ux.csv", profile_text(data["x"], data["value"] * factor, SIGMA * factor))
            found, done = self.fit(FIT + "at = 4.0\n", out=f"out{factor}")
            self.assertEqual("give place_unit or value_unit" in done.stderr, expected)
            self.assertEqual(any("value_unit" in remark for remark in found["remarks"]), expected)

    def test_a_point_without_a_sigma_is_left_out_and_said(self):
        self.make_profile()
        lines = (self.folder / "ux.csv").read_text().splitlines()
        self.write("ux.csv", "\n".join([*lines[:5], lines[5].rsplit(",", 1)[0] + ",", *lines[6:], ""]))
        found, done = self.fit(FIT)
        self.assertEqual(found["profiles"][0]["points"], len(X) - 1)
        self.assertRegex(done.stderr, "1 points without a sigma are left out")

    def test_files_are_looked_for_beside_the_scene_and_where_the_program_runs(self):
        self.make_profile()
        self.write("scenes/fit.toml", FIT)
        self.expect(0, "fit", "scenes/fit.toml", "-o", "here", "--quiet")
        self.write("scenes/ux.csv", (self.folder / "ux.csv").read_text())
        self.expect(0, "fit", "scenes/fit.toml", "-o", "beside", "--quiet")
        files = [json.loads((self.folder / out / "fit.json").read_text())["profiles"][0]["file"] for out in ("here", "beside")]
        self.assertEqual(files, ["ux.csv", "scenes/ux.csv"])


class NotIdentifiableTest(FitTest):
    def setUp(self):
        super().setUp()
        # On the axis U_y of a monopole is 0 by symmetry: these data tell nothing but the offset.
        self.make_profile("ux.csv", X, 0.0, "Uy", offset_y=0.5)
        self.text = FIT.replace('"xi"]', '"xi", "offset_y"]').replace('file = "ux.csv"', 'file = "ux.csv"\ncomponent = "Uy"')

    def test_what_the_data_do_not_fix_is_said(self):
        found, done = self.fit(self.text)
        for name in TRUE:
            self.assertIsNone(found["parameters"][name]["stderr"], name)
            self.assertRegex(done.stderr, rf"fit: {name} = .*not fixed by the data")
        self.assert_recovered(found, {"offset_y": 0.5})
        self.assertEqual(found["rank"], 1)
        unknown = [[1.0 if i == j else None for j in range(4)] for i in range(4)]  # three of four have no error
        self.assertEqual(found["correlation"], unknown)
        self.assertEqual(len(found["flat"]), 3)
        self.assertTrue(found["remarks"])
        self.assertRegex((self.folder / "out/log.txt").read_text(), "warning.* the data do not fix eta")

    def test_such_a_medium_is_not_taken(self):
        self.write("run.toml", self.text + FIELD + FITTED)
        done = self.expect(1, "run", "run.toml", "-o", "out")
        self.assertRegex(done.stderr, r"medium\.fitted: the data do not fix eta and xi; give eta and xi in \[medium\]")
        self.assertTrue((self.folder / "out/fit.json").exists())
        self.assertFalse((self.folder / "out/medium.json").exists())
        self.assertEqual(self.status("out"), "failed")

    def test_a_parameter_at_its_bound_is_said(self):
        self.make_profile()
        found, done = self.fit(FIT, "-s", "fit.bounds.eta=[0.1, 0.6]", "-s", "fit.start.eta=0.5", out="bound")
        self.assertEqual(found["parameters"]["eta"]["at_bound"], "upper")
        self.assertIsNone(found["parameters"]["eta"]["stderr"])
        force, eta, xi = (found["free"].index(name) for name in ("f_over_mu", "eta", "xi"))
        self.assertEqual([found["correlation"][eta][k] for k in (force, eta, xi)], [None, 1.0, None])
        self.assertGreater(abs(found["correlation"][force][xi]), 0.01)
        low, high = (found["parameters"]["eta"][key] for key in ("low", "high"))
        self.assertTrue(0.1 <= low < high == 0.6)
        self.assertRegex(done.stderr, rf"eta = 0.6 \(at its upper bound\), 95 % interval {low:.5g} to 0.6")


if __name__ == "__main__":
    rodwake.main()
