"""rodwake design: experiments that tell rivals apart, weighed before they are done."""

import csv
import json

import rodwake
from rodwake import ProgramTest

EXPERIMENT = """schema = 1
[medium]
eta = 1.3
alpha = 0.8
[[rods]]
position = [0.0, 1.5]
heading = 0.1
[[rods]]
position = [1.0, -1.5]
heading = 0.4
[rods_run]
t_end = 4.0
output_interval = 1.0
[fit]
name = "strain"
parameters = ["kappa"]
bounds = { kappa = [0.3, 1.0] }
fixed = { eta = 1.3, alpha = 0.8 }
[fit.posterior]
[[fit.trajectories]]
file = "not_yet.csv"
sigma_position = 0.02
sigma_heading = 0.02
start_poses = "exact"
[[fit.models]]
name = "none"
set = { "fit.parameters" = [] }
"""


class DesignTest(ProgramTest):
    def setUp(self):
        super().setUp()
        self.write("experiment.toml", EXPERIMENT)

    def weigh(self, *arguments):
        done = self.expect(0, "design", "experiment.toml", "-o", "out", "--sets", "6", "--force", *arguments)
        return json.loads((self.folder / "out/design.json").read_text()), done.stdout

    def test_rods_that_pass_near_tell_more_and_rods_far_away_nothing(self):
        record, printed = self.weigh("--vary", "rods.1.position.1=-1.5,-400")
        near, far = record["designs"]
        self.assertEqual(near["settings"], {"rods.1.position.1": "-1.5"})
        self.assertGreater(near["information"], 0.8)  # of 1 bit
        self.assertLess(abs(far["information"]), 0.01)  # wakes of 400 f/mu turn nobody
        self.assertEqual((record["best"], record["models"]), (0, ["strain", "none"]))
        self.assertGreater(near["log_bayes"]["strain"]["none"], 3.0)
        self.assertLess(abs(far["log_bayes"]["strain"]["none"]), 0.1)
        self.assertRegex(printed, r"(?s)0\.\d\d \+- .*rods.1.position.1=-1.5\n.*rods.1.position.1=-400")
        rows = list(csv.DictReader((self.folder / "out/design.csv").read_text().splitlines()))
        self.assertEqual([float(row["information"]) for row in rows], [one["information"] for one in record["designs"]])
        self.assertTrue((self.folder / "out/figures/design.png").is_file())
        (self.folder / "out/figures/design.png").unlink()
        self.expect(0, "plot", "out")
        self.assertTrue((self.folder / "out/figures/design.png").is_file())
        self.assertEqual([row["rods.1.position.1"] for row in rows], ["-1.5", "-400"])

    def test_more_runs_and_smaller_errors_tell_more(self):
        record, _ = self.weigh("--runs", "1,25", "-s", "fit.trajectories.0.sigma_heading=0.5", "-s", "fit.trajectories.0.sigma_position=0.5")
        one, many = record["designs"]
        self.assertEqual((one["runs"], many["runs"]), (1, 25))
        self.assertGreater(many["information"], one["information"] + 0.2)
        exact, _ = self.weigh("-s", "fit.trajectories.0.sigma_heading=0.1", "-s", "fit.trajectories.0.sigma_position=0.1")
        for key in ("information", "right"):  # 25 runs are one of a fifth of the errors
            self.assertAlmostEqual(exact["designs"][0][key], many[key], places=6)

    def test_the_same_for_any_threads_and_from_a_list(self):
        self.write("designs.csv", "rods.1.position.1,rods.1.heading\n-1.5,0.4\n-2.5,0.4\n")
        record, _ = self.weigh("--list", "designs.csv", "-j", "1")
        again, _ = self.weigh("--list", "designs.csv", "-j", "2")
        self.assertEqual(record["designs"], again["designs"])
        self.assertEqual(record["designs"][1]["settings"], {"rods.1.position.1": "-2.5", "rods.1.heading": "0.4"})
        self.assertNotEqual(record["designs"], self.weigh("--list", "designs.csv", "--seed", "5")[0]["designs"])

    def test_rods_that_diffuse_tell_less(self):
        still, wandering = self.weigh("--vary", "fit.fixed.D_r=0.0,0.3")[0]["designs"]
        self.assertGreater(still["information"], wandering["information"] + 0.2)

    def test_what_cannot_be_weighed_is_refused(self):
        for old, new, message in (
            ("[fit.posterior]\n", "", r"\[fit.posterior\] is missing"),
            ("sigma_heading = 0.02\n", "", "sigma_position and sigma_heading"),
            (EXPERIMENT[EXPERIMENT.index("[[fit.models]]"):], "", "no models to compare"),
            ('"fit.parameters" = []', '"fit.parameters" = ["D_r"]', "set it to 0 in fit.fixed"),
            ("[rods_run]\nt_end = 4.0\noutput_interval = 1.0\n", "", "rods_run"),
        ):
            with self.subTest(new=new):
                self.write("experiment.toml", EXPERIMENT.replace(old, new))
                self.refuse(2, message, "design", "experiment.toml", "-o", "out")
        self.write("experiment.toml", EXPERIMENT)
        self.refuse(2, "--vary rods.1: expected key=values", "design", "experiment.toml", "--vary", "rods.1")
        self.refuse(2, "rods.1.headin", "design", "experiment.toml", "--vary", "rods.1.headin=1,2")
        self.refuse(2, "--runs: 0", "design", "experiment.toml", "--runs", "0")
        self.expect(0, "design", "experiment.toml", "-o", "out", "--dry-run")
        self.assertFalse((self.folder / "out").exists())
        self.expect(0, "design", "experiment.toml", "-o", "out", "--sets", "2", "--quiet")
        self.refuse(2, "already exists; --force replaces it", "design", "experiment.toml", "-o", "out")


if __name__ == "__main__":
    rodwake.main()
