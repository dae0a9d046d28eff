"""rodwake fit: one that was stopped goes on, and every wrong input is refused before anything is written."""

import json
import signal

import numpy as np
import rodwake
from fits import FIELD, FIT, FITTED, FitTest, columns, compare_fits
from rodwake import PAIR, wait_until


class ResumeTest(FitTest):
    STARTS = ("-s", "fit.starts=60", "-s", "fit.box=78.0", "-s", "fit.likelihood=[\"eta\"]")

    def setUp(self):
        super().setUp()
        self.make_profile(box=78.0)
        self.write("fit.toml", FIT)

    def command(self, *arguments):
        return ("fit", "fit.toml", "-o", "out", "--quiet", *self.STARTS, *arguments)

    def stopped(self, number):
        with self.started(*self.command()) as process:
            ledger = self.folder / "out/fit.log"
            self.assertTrue(wait_until(lambda: ledger.exists() and ledger.stat().st_size > 5000, 30), "no start was done")
            self.assertIsNone(process.poll(), "the fit ended before it could be stopped: make it longer")
            return self.stop(process, number, 5.0)

    def result(self):
        return json.loads((self.folder / "out/fit.json").read_text())

    def test_an_interrupted_fit_goes_on_and_ends_the_same(self):
        self.expect(0, *self.command())
        whole = self.result()
        for number, code in ((signal.SIGKILL, -9), (signal.SIGINT, 130), (signal.SIGTERM, 143)):
            self.expect_stop(number, code)
            self.expect(0, *self.command())
            compare_fits(self, self.result(), whole)
            self.assertFalse((self.folder / "out/fit.log").exists())

    def expect_stop(self, number, code):
        (self.folder / "out/provenance.json").write_text('{"status": "failed", "stages": {"fit": "failed"}}')
        for file in (self.folder / "out").glob("fit*"):
            file.unlink()
        returned, _, err = self.stopped(number)
        self.assertEqual(returned, code, err)
        self.assertTrue((self.folder / "out/fit.log").exists())
        if number != signal.SIGKILL:
            best = self.result()
            self.assertEqual(best["termination"], "interrupted")
            self.assertLess(len(best["starts"]), 100)
            self.assertEqual(self.status("out"), "interrupted")

    def test_a_ledger_of_other_data_or_a_damaged_one_is_not_used(self):
        self.stopped(signal.SIGKILL)
        self.make_profile(box=78.0, offset=0.3)  # other noise, too
        self.expect(0, *self.command())
        other = self.result()
        self.expect(0, *self.command("--force"))
        again = self.result()
        again["provenance"]["command"] = other["provenance"]["command"]
        compare_fits(self, other, again)
        self.write("out/provenance.json", '{"status": "failed", "stages": {"fit": "failed"}}')
        self.write("out/fit.log", "nonsense" * 100)
        self.expect(0, *self.command())
        compare_fits(self, self.result(), other)

    def test_threads_and_seed(self):
        results = []
        for arguments in ((), ("-j", "2"), ("--seed", "7")):
            self.expect(0, *self.command("--force", *arguments))
            results.append(self.result())
        one, two, other = results
        two["provenance"] = one["provenance"]
        compare_fits(self, two, one)
        self.assertEqual((one["seed"], other["seed"]), (1, 7))
        self.assertNotEqual(one["starts"][5]["start"], other["starts"][5]["start"])
        self.assertIn("seed = 7", (self.folder / "out/scene.toml").read_text())


class BadDataTest(FitTest):
    GOOD = "x,value,sigma\n" + "".join(f"{x},{1.0 / (1 + x * x)},0.1\n" for x in range(1, 9))

    def refused(self, data, pattern, text=FIT, *arguments):
        if data is not None:
            self.write("ux.csv", data)
        self.write("fit.toml", text)
        self.refuse(2, pattern, "fit", "fit.toml", "-o", "out", *arguments)
        self.refuse(2, pattern, "run", "fit.toml", "-o", "out", *arguments)

    def test_the_good_one_is_good(self):
        self.write("ux.csv", self.GOOD)
        self.fit(FIT)
        self.write("ux.csv", self.GOOD + "9,1,nan\n")  # so pandas writes what is missing; of a value it is refused
        self.assertIn("ux.csv: 1 points without a sigma are left out", self.fit(FIT, "--force")[1].stderr)

    def test_bad_files(self):
        self.refused(None, "ux.csv: no such file to fit; looked for .*ux.csv")
        for data, pattern in (
                ("x,values,sigma\n1,2,3\n", r'ux\.csv:1:1: no column "value"; the header must have at least x,value'),
                ("", r"ux\.csv: no header line"),
                ("x,value,sigma\n", r"ux\.csv: holds no points"),
                (self.GOOD + "9,nan,0.1\n", r"ux\.csv:10:3: value = nan: must be finite"),
                (self.GOOD + "inf,1,0.1\n", r"ux\.csv:10:1: x = inf: must be finite"),
                (self.GOOD + "9,1,0\n", r"ux\.csv:10: sigma = 0: must be above 0"),
                (self.GOOD + "9,1,-0.1\n", r"ux\.csv:10: sigma = -0.1: must be above 0"),
                (self.GOOD + "9,1\n", r"ux\.csv:10:\d+: 2 fields, but the header has 3"),
                (self.GOOD + "9,one,0.1\n", r"ux\.csv:10:3: value: expected a number"),
                (self.GOOD + "0,1,0.1\n", r"ux\.csv:10: the model is infinite at the rod's centre"),
                ("x,value,sigma\n1,2,0.1\n2,3,0.1\n", r"2 .*3 "),
                ("x,value,sigma\n1,2,0.1\n2,2,0.1\n3,2,0.1\n4,2,0.1\n", r"all 4 values are equal \(2\)")):
            with self.subTest(data=data[-20:]):
                self.refused(data, pattern)

    def test_what_is_there_but_is_no_regular_file(self):
        (self.folder / "ux.csv").mkdir()
        self.refused(None, "ux.csv: is not a regular file")
        self.refused(None, "/dev/null: is not a regular file", FIT.replace("ux.csv", "/dev/null"))

    def test_points_on_an_image_of_the_rod(self):
        """In a box of 30, along x and beside it, ahead and behind; at an angle the image along x is at 30 sqrt(2)."""
        half, far = np.pi / 4, 30.0 * 2.0**0.5
        for heading, place, at in ((0.0, 30.0, 0.0), (0.0, -60.0, 0.0), (0.0, 30.0, -30.0), (np.pi / 2, 30.0, 60.0), (half, far, 0.0), (half, far, far)):
            self.refused(self.GOOD + f"{place!r},1,0.1\n", r"ux\.csv:10: \(.*\) is the position of an image of the rod in the box of 30", FIT,
                         "-s", "fit.box=30.0", "-s", f"fit.heading={heading!r}", "-s", f"fit.profiles.0.at={at!r}")
        for elsewhere in (("fit.heading=0.3", "fit.box=30.0"), ("fit.heading=0.0", "fit.box=31.0")):
            self.write("ux.csv", self.GOOD + "30,1,0.1\n")
            self.fit(FIT, "-s", elsewhere[1], "-s", elsewhere[0], out=elsewhere[0])

    def test_a_curve_over_an_image_leaves_it_out(self):
        self.write("ux.csv", self.GOOD + "52,0.1,0.1\n")  # the curve has 401 places, 20.4 among them
        found, _ = self.fit(FIT, "-s", "fit.box=26.5")
        curve = columns(self.folder / "out" / found["profiles"][0]["curve"])
        self.assertNotIn(26.5, curve["x"])
        self.assertEqual(len(curve["x"]), 400)

    def test_residuals_that_cannot_be_at_the_start(self):
        alpha = FIT.replace('"xi"]', '"alpha"]').replace("f_over_mu = 1.5", "f_over_mu = 0.0").replace("xi = 15.0", "alpha = 0.2")
        self.refused(self.GOOD, r"the model cannot be computed.*start of the fit: f_over_mu = 0, eta = 2, alpha = 0\.2\); change fit\.start", alpha)
        for row, text in (("9,1,1e-320\n", "ux.csv:10: the residual"), ("9,1e300,0.1\n", "ux.csv:10: the residual"),
                          ("9,1,1e-200\n", "ux.csv:10: the residual")):
            self.refused(self.GOOD + row, text + r".*change fit\.start")
        self.refuse(2, "ux.csv:10: the residual", "check", "fit.toml")

    def test_bad_scenes(self):
        self.write("ux.csv", self.GOOD)
        for setting, pattern in (
                ("fit.bounds.eta=[2.0, 1.0]", "bounds of eta are reversed"),
                ('fit.parameters=["f_over_mu", "etta", "xi"]', r'did you mean "eta"\?'),
                ("fit.start.eta=-0.5", "eta starts at -0.5, outside its default bounds"),
                ("fit.core=100", r"ux: no points are left outside the core of 100"),
                ("fit.fixed.eta=1.0", "eta is fitted .* and fixed"),
                ("fit.method=crs", "f_over_mu has none")):
            with self.subTest(setting=setting):
                self.refused(None, pattern, FIT, "-s", setting)
        self.write("bare.csv", "x,value\n1,2\n2,3\n")
        self.refused(None, "some profiles have a column sigma and some have none", FIT + '[[fit.profiles]]\nfile = "bare.csv"\n')
        self.refuse(2, r"no \[fit\] table, so there is nothing to fit", "fit", self.write("pair.toml", PAIR))

    def test_a_fitted_medium_needs_run(self):
        self.write("ux.csv", self.GOOD)
        self.write("fit.toml", FIT + FIELD + FITTED)
        self.refuse(2, "rodwake run fits first", "field", "fit.toml", "-o", "out")


if __name__ == "__main__":
    rodwake.main()
