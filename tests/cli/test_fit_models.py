"""rodwake fit with [[fit.models]]: rivals on the same tracks, weighed, and whether any describes the data."""

import csv
import json
import math
import signal

import rodwake
from fits import FIT, PRIORS, FitTest
from rodwake import wait_until

PAIR = """schema = 1
[medium]
eta = 1.3
alpha = 0.8
[coupling]
{coupling}
[[rods]]
position = [0.0, 2.0]
heading = 0.1
[[rods]]
position = [1.0, -2.0]
heading = 0.4
[rods_run]
t_end = 8.0
output_interval = 0.5
"""
RIVALS = """schema = 1
[fit]
name = "strain"
parameters = ["kappa"]
fixed = { eta = 1.3, alpha = 0.8 }
[[fit.trajectories]]
file = "pair.csv"
sigma_position = 0.01
sigma_heading = 0.01
[[fit.models]]
name = "flow"
set = { "fit.parameters" = ["gamma_flow"] }
[[fit.models]]
name = "rows"
set = { "fit.parameters" = ["gamma_rows"], "fit.fixed.rows_direction" = 0.0 }
[[fit.models]]
name = "none"
set = { "fit.parameters" = [] }
"""
SIGMA = 0.01
NESTED = PRIORS + """[[fit.models]]
name = "first"
set = { "fit.parameters" = ["f_over_mu", "xi"], "fit.fixed.eta" = 1.3 }
[[fit.models]]
name = "second"
set = { "fit.parameters" = ["f_over_mu", "eta"], "fit.fixed.xi" = 40.0 }
"""


class ModelsTest(FitTest):
    def make_pair(self, coupling, bend=0.0):
        """Tracks by a mechanism, with noise; `bend` turns a rod in a way that no mechanism has."""
        self.write("made.toml", PAIR.format(coupling=coupling))
        self.expect(0, "rods", "made.toml", "-o", "made", "--quiet", "--force")
        rows = list(csv.reader((self.folder / "made/rods.csv").read_text().splitlines()))
        lines = [",".join(rows[0])]
        for row in rows[1:]:
            values = [float(value) for value in row]
            values[1:] = [value + SIGMA * self.random.standard_normal() for value in values[1:]]
            values[3] += bend * math.sin(3.0 * values[0])
            lines.append(",".join(map(repr, values)))
        self.write("pair.csv", "\n".join(lines) + "\n")

    def weigh(self, text=RIVALS, *arguments):
        found, done = self.fit(text, "--force", *arguments)
        return found, json.loads((self.folder / "out/models.json").read_text()), done

    def test_the_mechanism_that_made_the_tracks_has_the_most_weight(self):
        for name, coupling in (("strain", "kappa = 0.8"), ("flow", "gamma_flow = 1.5"), ("rows", "gamma_rows = 0.1")):
            self.make_pair(coupling)
            found, record, done = self.weigh()
            models = {one["name"]: one for one in record["models"]}
            self.assertEqual(list(models), ["strain", "flow", "rows", "none"])
            self.assertEqual(max(models, key=lambda one: models[one]["weight"]), name)
            self.assertAlmostEqual(sum(one["weight"] for one in models.values()), 1.0, places=12)
            self.assertEqual(record["weight_from"], "aic")
            self.assertAlmostEqual(models["strain"]["aic"], found["chi2"] + 2 * models["strain"]["free"], places=9)
            self.assertAlmostEqual(models["strain"]["bic"], found["chi2"] + models["strain"]["free"] * math.log(record["values"]), places=9)
            self.assertEqual(models["none"]["free"] + 1, models["flow"]["free"])
            self.assertEqual(models["strain"]["misfit"], found["misfit"])
            self.assertIsNone(models[name]["log_evidence"])
            self.assertLessEqual(max(one["cross_validation"]["difference"] for one in models.values()), 10.0)
            self.assertRegex(done.stderr, rf"fit: Of 4 models {name} has the most weight")
            self.assertEqual(done.stderr.count("fit: model "), 4)
            self.assertEqual(models[name]["misfit"]["describes"], True)

    def test_a_table_and_a_folder_of_each_rival(self):
        self.make_pair("kappa = 0.8")
        _, record, _ = self.weigh()
        out = self.folder / "out"
        rows = list(csv.DictReader((out / "models.csv").read_text().splitlines()))
        self.assertEqual([row["name"] for row in rows], [one["name"] for one in record["models"]])
        self.assertEqual([float(row["aic"]) for row in rows], [one["aic"] for one in record["models"]])
        for one in record["models"]:
            fit = json.loads((out / one["folder"] / "fit.json").read_text())
            self.assertEqual(fit["chi2"], one["chi2"])
        self.assertIn("models.csv", json.loads((out / "manifest.json").read_text())["files"])
        self.fit(RIVALS[:RIVALS.index("[[fit.models]]")], "--force")
        self.assertFalse((out / "models.json").exists() or (out / "models/flow/fit.json").exists())

    def test_data_of_no_rival_are_said_to_be_of_none(self):
        self.make_pair("kappa = 0.8", bend=0.1)
        found, record, done = self.weigh()
        self.assertFalse(found["misfit"]["describes"])
        self.assertRegex(record["text"][1], "No model offered describes the data: .* \\(p < 0.001\\)")
        self.assertRegex(done.stderr, "No model offered describes the data")

    def test_evidence_weighs_where_all_have_it(self):
        self.make_pair("kappa = 0.8")
        text = RIVALS[:RIVALS.index("[[fit.models]]")] + 'start_poses = "exact"\n'  # one parameter each
        text = text.replace("fixed =", "start = { kappa = 0.5 }\nbounds = { kappa = [0.0, 5.0] }\nfixed =")
        text += '[fit.posterior]\nsamples = 400\nevidence = true\n[[fit.models]]\nname = "flow"\nset = { "fit.parameters" = ["gamma_flow"], "fit.bounds.gamma_flow" = [0.0, 5.0] }\n'
        text += '[[fit.models]]\nname = "none"\nset = { "fit.parameters" = [] }\n'
        _, record, _ = self.weigh(text)
        self.assertEqual(record["weight_from"], "evidence")
        first, second, none = record["models"]
        self.assertEqual(none["log_evidence_stderr"], 0.0)  # of a model without parameters it is the likelihood, here of 96 values
        self.assertAlmostEqual(none["log_evidence"], -0.5 * none["chi2"] - 96 * math.log(SIGMA * math.sqrt(2.0 * math.pi)), places=6)
        for one in record["models"]:
            posterior = json.loads((self.folder / "out" / one["folder"] / "posterior.json").read_text())
            self.assertEqual(posterior["log_evidence"]["value"], one["log_evidence"])
        shares = [math.exp(one["log_evidence"] - first["log_evidence"]) for one in record["models"]]
        self.assertAlmostEqual(first["weight"], 1.0 / sum(shares), places=9)
        self.assertGreater(first["weight"], 0.99)

    def files(self):
        """What the same command must make again, but for who made it."""
        found = {}
        for path in sorted((self.folder / "out").rglob("*")):
            name = str(path.relative_to(self.folder / "out"))
            if path.name == "models.json" or path.name in ("fit.json", "posterior.json"):
                found[name] = {key: value for key, value in json.loads(path.read_text()).items() if key != "provenance"}
            elif path.suffix in (".csv", ".nc", ".txt") and path.name != "log.txt":
                found[name] = path.read_bytes()
        return found

    def test_a_killed_one_goes_on_to_the_same_bytes_and_samples_no_rival_twice(self):
        self.make_profile()
        self.write("fit.toml", FIT + NESTED)
        command = ("fit", "fit.toml", "-o", "out", "--quiet")
        with self.started(*command) as process:
            ledger = self.folder / "out/models/second/fit.log"
            self.assertTrue(wait_until(lambda: ledger.exists() and ledger.stat().st_size > 5000, 60), "no block was done")
            self.assertIsNone(process.poll(), "it ended before it could be stopped: make it longer")
            self.stop(process, signal.SIGKILL, 5.0)
        self.assertFalse((self.folder / "out/models.json").exists())
        self.expect(0, *command)
        for folder in ("", "models/first/"):
            self.assertRegex((self.folder / f"out/{folder}log.txt").read_text(), "resuming after 160 of 160 blocks")
        self.assertEqual(list((self.folder / "out").rglob("fit.log")), [])
        resumed = self.files()
        self.expect(0, *command, "--force", "-j", "1")
        self.assertEqual(self.files(), resumed)
        self.assertIn("models/second/posterior.nc", resumed)

    def test_rivals_are_sampled_for_their_evidence_alone(self):
        self.make_profile()
        self.write("fit.toml", FIT + NESTED.replace("samples = 4000", "samples = 40").replace("evidence = true\n", ""))
        for evidence, count in (("true", 3), ("default", 1)):
            keys = ("-s", "fit.posterior.evidence=true") if evidence == "true" else ()
            self.assertEqual("of each of 3 models" in self.expect(0, "check", "fit.toml", *keys).stdout, evidence == "true")
            self.expect(0, "fit", "fit.toml", "-o", evidence, "--quiet", *keys)
            self.assertEqual(len(list((self.folder / evidence).rglob("posterior.json"))), count)

    def test_rods_that_diffuse(self):
        self.make_pair("kappa = 0.8")
        alone = RIVALS[:RIVALS.index("[[fit.models]]")].replace('["kappa"]', '["kappa", "D_r"]')
        sampled = '[fit.posterior]\nsamples = 40\n[fit.posterior.priors]\nkappa = { kind = "uniform", low = 0.0, high = 2.0 }\n'
        found, _ = self.fit(alone + sampled, "--force")
        self.assertEqual(found["residuals"], 96)
        self.assertEqual(found["parameters"]["D_r"]["unit"], "rad^2 mu v0/f")
        self.assertNotIn("x.0.0", found["parameters"])
        self.assertTrue(0.0 <= found["parameters"]["D_r"]["value"] < 1e-3)  # they do not: 16 rows of 0.01 rad leave 1e-4
        self.assertLess(abs(found["parameters"]["kappa"]["value"] - 0.8), 4.0 * found["parameters"]["kappa"]["stderr"] + 0.05)
        self.assertTrue(found["misfit"]["describes"])
        held, done = self.fit(alone.replace('["kappa", "D_r"]', '["kappa"]').replace("alpha = 0.8", "alpha = 0.8, D_r = 0.05") + sampled, "--force")
        self.assertIn("the rods turn too much between rows", done.stderr)  # 0.05 0.5^2/sqrt(3) is 0.7 of sigma_position
        self.assertGreater(held["parameters"]["kappa"]["stderr"], found["parameters"]["kappa"]["stderr"])
        rows = list(csv.DictReader((self.folder / "out/posterior_trajectory_0.csv").read_text().splitlines()))
        last = [float(row["noise_high"]) - float(row["noise_low"]) for row in rows if row["coordinate"] == "2"][-1]
        self.assertGreater(last, 2.0 * (2 * 0.05 * 8.0) ** 0.5)  # wider than two standard deviations of headings that wander from 0 to 8
        for text, message in (
            (alone + '[[fit.models]]\nname = "none"\nset = { "fit.parameters" = [] }\n', "hold D_r = 0 in fit.fixed"),
            (alone.replace("sigma_heading = 0.01\n", ""), "set sigma_position and sigma_heading"),
            (alone.replace("[fit]\n", '[fit]\nloss = "huber"\n'), 'loss = "squares"'),
        ):
            self.write("fit.toml", text)
            self.assertRegex(self.expect(2, "fit", "fit.toml", "-o", "out").stderr, message)

    def test_without_the_evidence_of_one_the_weights_are_those_of_aic(self):
        self.make_profile()
        text = NESTED.replace("samples = 4000", "samples = 32").replace('"fit.fixed.xi" = 40.0', '"fit.fixed.xi" = 40.0, "fit.posterior.evidence" = false')
        _, done = self.fit(FIT + text)
        record = json.loads((self.folder / "out/models.json").read_text())
        self.assertEqual(record["weight_from"], "aic")
        self.assertIsNone(record["models"][2]["log_evidence"])
        self.assertIn("not every model has an evidence", done.stderr)
        self.assertRegex(done.stderr, "posterior of model first: the chains of")  # 32 samples are too few

    def test_rivals_whose_priors_are_wrong_are_refused(self):
        self.make_profile()
        for old, new, message in (
            ('"f_over_mu", "xi"]', '"f_over_mu", "xi", "offset"]', r"with fit.models\[0\] applied: .*offset has neither bounds nor a prior.*fit.bounds.offset"),
            ('"fit.fixed.eta" = 1.3', '"fit.fixed.eta" = 1.3, "fit.posterior.priors.xi" = { kind = "uniform", low = -10.0 }', r"fit.models\[0\] applied: .*xi"),
            ('"fit.fixed.xi" = 40.0', '"fit.fixed.xi" = 40.0, "fit.posterior.samples" = 10', r"fit.models\[1\] applied: .*multiple of chains"),
            ('set = { "fit.parameters" = ["f_over_mu", "eta"], "fit.fixed.xi" = 40.0 }', 'set = { "fit.posterior.samples" = 400 }', "gives the same model"),
        ):
            with self.subTest(new=new):
                self.write("fit.toml", FIT + NESTED.replace(old, new))
                self.assertRegex(self.expect(2, "fit", "fit.toml", "-o", "out").stderr, message)

    def test_rivals_that_cannot_be_weighed_are_refused_before_anything_runs(self):
        self.make_pair("kappa = 0.8")
        for old, new, message in (
            ('["gamma_flow"] }', '["kappa"] }', "gives the same model as the fit as written"),
            ('name = "rows"', 'name = "flow"', "is taken by"),
            ('["gamma_flow"] }', '["gamma_flow"], "fit.trajectories.0.sigma_heading" = 0.1 }', r"changes the data \(fit.trajectories\)"),
            ('["gamma_flow"] }', '["gamma_flow"], "fit.colour" = 1 }', "fit.models\\[0\\] applied"),
        ):
            self.write("fit.toml", RIVALS.replace(old, new))
            self.assertRegex(self.expect(2, "check", "fit.toml").stderr, message)


if __name__ == "__main__":
    rodwake.main()
