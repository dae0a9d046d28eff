"""rodwake fit with [[fit.models]]: rivals on the same tracks, weighed, and whether any describes the data."""

import csv
import json
import math

import rodwake
from fits import FitTest

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
            found, told, done = self.weigh()
            models = {one["name"]: one for one in told["models"]}
            self.assertEqual(list(models), ["strain", "flow", "rows", "none"])
            self.assertEqual(max(models, key=lambda one: models[one]["weight"]), name)
            self.assertAlmostEqual(sum(one["weight"] for one in models.values()), 1.0, places=12)
            self.assertEqual(told["weight_from"], "aic")
            self.assertAlmostEqual(models["strain"]["aic"], found["chi2"] + 2 * models["strain"]["free"], places=9)
            self.assertAlmostEqual(models["strain"]["bic"], found["chi2"] + models["strain"]["free"] * math.log(told["values"]), places=9)
            self.assertEqual(models["none"]["free"] + 1, models["flow"]["free"])
            self.assertEqual(models["strain"]["misfit"], found["misfit"])
            self.assertIsNone(models[name]["log_evidence"])
            self.assertLessEqual(max(one["cross_validation"]["difference"] for one in models.values()), 10.0)
            self.assertRegex(done.stderr, rf"fit: Of 4 models {name} has the most weight")
            self.assertEqual(done.stderr.count("fit: model "), 4)
            self.assertEqual(models[name]["misfit"]["describes"], True)

    def test_a_table_and_a_folder_of_each_rival(self):
        self.make_pair("kappa = 0.8")
        _, told, _ = self.weigh()
        out = self.folder / "out"
        rows = list(csv.DictReader((out / "models.csv").read_text().splitlines()))
        self.assertEqual([row["name"] for row in rows], [one["name"] for one in told["models"]])
        self.assertEqual([float(row["aic"]) for row in rows], [one["aic"] for one in told["models"]])
        for one in told["models"]:
            fit = json.loads((out / one["folder"] / "fit.json").read_text())
            self.assertEqual(fit["chi2"], one["chi2"])
        self.assertIn("models.csv", json.loads((out / "manifest.json").read_text())["files"])
        self.fit(RIVALS[:RIVALS.index("[[fit.models]]")], "--force")
        self.assertFalse((out / "models.json").exists() or (out / "models/flow/fit.json").exists())

    def test_data_of_no_rival_are_said_to_be_of_none(self):
        self.make_pair("kappa = 0.8", bend=0.1)
        found, told, done = self.weigh()
        self.assertFalse(found["misfit"]["describes"])
        self.assertRegex(told["text"][1], "No model offered describes the data: .* \\(p < 0.001\\)")
        self.assertRegex(done.stderr, "No model offered describes the data")

    def test_evidence_weighs_where_all_have_it(self):
        self.make_pair("kappa = 0.8")
        text = RIVALS[:RIVALS.index("[[fit.models]]")] + 'start_poses = "exact"\n'  # one parameter each
        text = text.replace("fixed =", "start = { kappa = 0.5 }\nbounds = { kappa = [0.0, 5.0] }\nfixed =")
        text += '[fit.posterior]\nsamples = 400\n[[fit.models]]\nname = "flow"\nset = { "fit.parameters" = ["gamma_flow"], "fit.bounds.gamma_flow" = [0.0, 5.0] }\n'
        _, told, _ = self.weigh(text)
        self.assertEqual(told["weight_from"], "evidence")
        first, second = told["models"]
        for one in told["models"]:
            posterior = json.loads((self.folder / "out" / one["folder"] / "posterior.json").read_text())
            self.assertEqual(posterior["log_evidence"]["value"], one["log_evidence"])
        self.assertAlmostEqual(first["weight"], 1.0 / (1.0 + math.exp(second["log_evidence"] - first["log_evidence"])), places=9)

    def test_rivals_that_cannot_be_weighed_are_refused_before_anything_runs(self):
        self.make_pair("kappa = 0.8")
        for old, new, message in (
            ('["gamma_flow"] }', '["kappa"] }', "leaves the same model as the fit as written"),
            ('name = "rows"', 'name = "flow"', "is taken by"),
            ('["gamma_flow"] }', '["gamma_flow"], "fit.trajectories.0.sigma_heading" = 0.1 }', r"changes the data \(fit.trajectories\)"),
            ('["gamma_flow"] }', '["gamma_flow"], "fit.colour" = 1 }', "fit.models\\[0\\] applied"),
        ):
            self.write("fit.toml", RIVALS.replace(old, new))
            self.assertRegex(self.expect(2, "check", "fit.toml").stderr, message)


if __name__ == "__main__":
    rodwake.main()
