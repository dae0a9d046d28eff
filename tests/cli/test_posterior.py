"""rodwake fit with [fit.posterior]: its files, its resumption, and what it refuses."""

import json
import signal
import unittest

import h5py
import numpy as np
import xarray
from fits import FIT, PRIORS, TRUE, FitTest, columns
from rodwake import wait_until


class PosteriorTest(FitTest):
    def setUp(self):
        super().setUp()
        self.make_profile()
        self.write("fit.toml", FIT + PRIORS)

    def files(self):
        out = self.folder / "out"
        found = json.loads((out / "posterior.json").read_text())
        del found["provenance"]
        return found, *((out / name).read_bytes() for name in ("posterior.csv", "posterior.nc", "posterior_curve_0.csv"))

    def test_its_files_hold_what_they_should(self):
        self.expect(0, "fit", "fit.toml", "-o", "out", "--quiet")
        found, *_ = self.files()
        self.assertEqual(set(found["parameters"]), set(TRUE))
        for name, one in found["parameters"].items():
            self.assertLess(one["rhat"], 1.01, name)
            self.assertGreater(one["ess"], 1000, name)
            self.assertLess(abs(one["mean"] - TRUE[name]), 4.0 * one["sd"], name)  # four standard deviations
            self.assertTrue(one["q025"] < one["median"] < one["q975"])
        self.assertLess(found["log_evidence"]["stderr"], 0.05)
        samples = columns(self.folder / "out" / found["samples"])
        self.assertEqual(len(samples["eta"]), 4000)
        self.assertAlmostEqual(samples["eta"].mean(), found["parameters"]["eta"]["mean"], places=10)

    def test_arviz_finds_its_layout(self):
        """By xarray, which ArviZ reads with; and by the dimension scales alone."""
        self.expect(0, "fit", "fit.toml", "-o", "out", "--quiet", "-s", "fit.posterior.samples=400")
        path, samples = self.folder / "out/posterior.nc", columns(self.folder / "out/posterior.csv")
        with xarray.open_dataset(path, group="posterior", engine="h5netcdf") as data:
            self.assertEqual(dict(data.sizes), {"chain": 4, "draw": 100})
            self.assertEqual(list(data["draw"].values[:3]), [0, 1, 2])
            for name in TRUE:
                self.assertEqual(data[name].dims, ("chain", "draw"))
                np.testing.assert_array_equal(data[name].values.ravel(), samples[name])
        with xarray.open_dataset(path, group="log_likelihood", engine="h5netcdf") as data:
            self.assertEqual(data["data"].dims, ("chain", "draw", "residual"))
            np.testing.assert_allclose(data["data"].sum("residual").values.ravel(), samples["log_likelihood"], rtol=1e-9)  # by z and back
        with xarray.open_dataset(path, group="sample_stats", engine="h5netcdf") as data:
            prior = data["lp"].values.ravel() - samples["log_likelihood"]
            expected = -0.5 * (samples["f_over_mu"] - 2.0) ** 2 - np.log(samples["eta"])
            np.testing.assert_allclose(prior - prior[0], expected - expected[0], atol=1e-9)
        with h5py.File(path) as file:
            self.assertEqual([file["posterior/eta"].dims[axis][0].name for axis in (0, 1)], ["/posterior/chain", "/posterior/draw"])

    def test_its_figures_and_its_part_of_the_report(self):
        self.expect(0, "fit", "fit.toml", "-o", "out", "--quiet", "-s", "fit.posterior.samples=400")
        self.expect(0, "plot", "out")
        for kind in ("posterior", "posterior_trace", "posterior_predictive"):
            self.assertTrue((self.folder / f"out/figures/{kind}.png").is_file(), kind)
        page = (self.folder / "out/report.html").read_text()
        for words in ("<h3>Posterior</h3>", "even in the logarithm", "Logarithm of the evidence"):
            self.assertIn(words, page)
        bands = columns(self.folder / "out/posterior_curve_0.csv")
        known = np.isfinite(bands["low"])
        for wide, narrow in (("noise_low", "low"), ("low", "median")):
            self.assertTrue((bands[wide] <= bands[narrow])[known].all())
        data = columns(self.folder / "out/fit_profile_0.csv")
        inside = [np.interp(data["x"], bands["x"][known], bands[name][known]) for name in ("noise_low", "noise_high")]
        share = np.mean((data["value"] > inside[0]) & (data["value"] < inside[1]))
        self.assertTrue(0.85 < share <= 1.0, share)  # 0.95 of 53 points, three standard deviations

    def test_ctrl_c_and_the_same_command(self):
        longer = ("fit", "fit.toml", "-o", "out", "--quiet", "-s", "fit.posterior.samples=16000")
        with self.started(*longer) as process:
            ledger = self.folder / "out/fit.log"
            self.assertTrue(wait_until(lambda: ledger.exists() and ledger.stat().st_size > 8000, 30), "no block was done")
            self.stop(process, signal.SIGINT, 20.0)
        self.assertFalse((self.folder / "out/posterior.json").exists())
        self.expect(0, *longer)
        self.assertIn("posterior: resuming after", (self.folder / "out/log.txt").read_text())
        self.assertTrue((self.folder / "out/posterior.json").exists())

    def test_a_killed_one_goes_on_to_the_same_bytes(self):
        longer = ("fit", "fit.toml", "-o", "out", "--quiet", "-s", "fit.posterior.samples=16000")
        with self.started(*longer) as process:
            ledger = self.folder / "out/fit.log"
            self.assertTrue(wait_until(lambda: ledger.exists() and ledger.stat().st_size > 8000, 30), "no block was done")
            self.assertIsNone(process.poll(), "it ended before it could be stopped: make it longer")
            self.stop(process, signal.SIGKILL, 5.0)
        self.expect(0, *longer)
        self.assertFalse(ledger.exists())
        resumed = self.files()
        self.expect(0, *longer, "--force", "-j", "1")
        self.assertEqual(self.files(), resumed)

    def test_of_rods(self):
        self.write("rods.toml", """schema = 1
[fit]
parameters = ["kappa"]
fixed = { eta = 1.0, alpha = 0.5 }
bounds = { kappa = [0.0, 3.0] }
[[fit.trajectories]]
file = "pair.csv"
sigma_position = 0.02
sigma_heading = 0.02
start_poses = "exact"
[fit.posterior]
samples = 200
chains = 2
""")
        rows = "".join(f"{t},{t},0,0,{t},{1.5 + 0.01 * t},0.01\n" for t in range(4))
        self.write("pair.csv", "t,x0,y0,theta0,x1,y1,theta1\n" + rows)
        self.expect(0, "fit", "rods.toml", "-o", "rods", "--quiet")
        found = json.loads((self.folder / "rods/posterior.json").read_text())["parameters"]["kappa"]
        self.assertEqual(found["prior"], {"kind": "uniform", "low": 0.0, "high": 3.0})
        self.assertTrue(0.0 < found["q025"] < found["q975"] < 3.0)
        self.assertEqual(set(columns(self.folder / "rods/posterior_trajectory_0.csv")["rod"]), {0.0, 1.0})
        self.expect(0, "plot", "rods")
        self.assertTrue((self.folder / "rods/figures/posterior_trajectories.png").is_file())

    def test_wrong_priors_are_refused(self):
        for old, new, message in (
            ("low = 0.05", "low = 0.0", "log_uniform needs low above 0|beyond the bounds"),
            ("sd = 1.0", "sd = 0.0", "sd above 0"),
            ("{ kind = \"normal\", mean = 2.0, sd = 1.0 }", "{ kind = \"uniform\" }", r"a uniform prior needs low and high, because fit\.bounds\.\w+ is not set"),
            ("samples = 4000", "samples = 4001", "multiple of chains"),
            ("kind = \"normal\"", "kind = \"gauss\"", "normal"),
            ("sd = 1.0", "sdev = 1.0", "unknown key"),
        ):
            self.write("fit.toml", FIT + PRIORS.replace(old, new))
            self.assertRegex(self.expect(2, "fit", "fit.toml", "-o", "out").stderr, message)


if __name__ == "__main__":
    unittest.main()
