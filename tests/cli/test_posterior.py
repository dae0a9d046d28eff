"""rodwake fit with [fit.posterior]: its files, its resumption, and what it refuses."""

import json
import signal

from fits import FIT, TRUE, FitTest, columns
from rodwake import wait_until

PRIORS = """[fit.posterior]
samples = 4000
[fit.posterior.priors]
f_over_mu = { kind = "normal", mean = 2.0, sd = 1.0 }
eta = { kind = "log_uniform", low = 0.05, high = 50.0 }
xi = { kind = "uniform", low = 1.0, high = 200.0 }
"""


class PosteriorTest(FitTest):
    def setUp(self):
        super().setUp()
        self.make_profile()
        self.write("fit.toml", FIT + PRIORS)

    def files(self):
        out = self.folder / "out"
        found = json.loads((out / "posterior.json").read_text())
        del found["provenance"]
        return found, (out / "posterior.csv").read_bytes()

    def test_its_files_hold_what_they_should(self):
        self.expect(0, "fit", "fit.toml", "-o", "out", "--quiet")
        found, _ = self.files()
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

    def test_a_killed_one_goes_on_to_the_same_bytes(self):
        longer = ("fit", "fit.toml", "-o", "out", "--quiet", "-s", "fit.posterior.samples=40000")
        with self.started(*longer) as process:
            ledger = self.folder / "out/posterior_blocks.log"
            self.assertTrue(wait_until(lambda: ledger.exists() and ledger.stat().st_size > 20000, 30), "no block was done")
            self.assertIsNone(process.poll(), "it ended before it could be stopped: make it longer")
            self.stop(process, signal.SIGKILL, 5.0)
        self.expect(0, *longer)
        self.assertFalse(ledger.exists())
        resumed = self.files()
        self.expect(0, *longer, "--force", "-j", "1")
        self.assertEqual(self.files(), resumed)

    def test_wrong_priors_are_refused(self):
        for old, new, message in (
            ("low = 0.05", "low = 0.0", "log_uniform needs low above 0|beyond the bounds"),
            ("sd = 1.0", "sd = 0.0", "sd above 0"),
            ("{ kind = \"normal\", mean = 2.0, sd = 1.0 }", "{ kind = \"uniform\" }", "improper"),
            ("samples = 4000", "samples = 4001", "multiple of chains"),
            ("kind = \"normal\"", "kind = \"gauss\"", "normal"),
            ("sd = 1.0", "sdev = 1.0", "unknown key"),
        ):
            self.write("fit.toml", FIT + PRIORS.replace(old, new))
            self.assertRegex(self.expect(2, "fit", "fit.toml", "-o", "out").stderr, message)
