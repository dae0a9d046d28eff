"""rodwake check: what it says will be modelled and what not."""

import csv
import json

import rodwake
from rodwake import PAIR, THEORY_PAIR, ProgramTest

MEDIUM = "[medium]\neta = 1.0\nalpha = 1.0\n"


class CheckTest(ProgramTest):
    def not_modelled(self, scene, *options):
        self.write("scene.toml", scene)
        text = self.expect(0, "check", "scene.toml", *options).stdout
        return text.split("# not modelled\n")[1].split("\n\n")[0]

    def test_a_tolerance_of_the_table_is_not_used_with_exact(self):
        line = 'medium.table.tolerance: not used with field = "exact"'
        self.assertNotIn(line, self.not_modelled(PAIR))
        for spelling in ("table.tolerance = 1e-8\n", "[medium.table]\ntolerance = 1e-8\n"):
            self.assertIn(line, self.not_modelled(PAIR.replace(MEDIUM, MEDIUM + 'field = "exact"\n' + spelling)))

    def test_noise(self):
        self.assertIn("noise: no [noise] table", self.not_modelled(PAIR))
        self.assertIn("noise: rotational_diffusion and translational_diffusion are 0", self.not_modelled(PAIR + "[noise]\nrotational_diffusion = 0.0\n"))
        self.write("noisy.toml", PAIR + "[noise]\nrotational_diffusion = 0.01\nruns = 7\n")
        output = self.expect(0, "check", "noisy.toml").stdout
        self.assertRegex(output, r"noise: D_r = 0\.01, D_t = 0, 7 runs, steps of at most 0\.0\d+ \(0\.05 of the shortest")
        self.assertIn("diffusion of positions: noise.translational_diffusion is 0", output)

    def test_alpha_is_a_unit_of_length(self):
        """Not with polar couplings, rows, noise, a box or a medium with memory: these have a length of their own."""
        said = "is a unit of length"
        pair = PAIR.replace("alpha = 1.0", "alpha = 0.5").replace("kappa = 0.5", "kappa = 5.0")
        self.write("pair.toml", pair)
        self.assertIn("  alpha = 0.5 is a unit of length: with alpha = 1 and lengths and times multiplied by 0.5 (start, contact distance, t_end) "
                      "the encounter is the same\n", self.expect(0, "check", "pair.toml").stdout)
        scaled = PAIR.replace("kappa = 0.5", "kappa = 5.0").replace("2.5]", "1.25]").replace("t_end = 60.0", "t_end = 30.0")
        self.write("scaled.toml", scaled.replace("output_interval = 10.0", "output_interval = 5.0").replace("distance = 0.1", "distance = 0.05"))
        for name in ("pair", "scaled"):
            self.expect(0, "rods", f"{name}.toml", "-o", name, "-s", "rods_run.rtol=1e-12")
        one, other = self.outcome("pair"), self.outcome("scaled")
        self.assertEqual((one["outcome"], other["outcome"]), ("contact", "contact"))
        self.assertAlmostEqual(0.5 * one["time"], other["time"], delta=1e-9)
        self.assertNotIn(said, self.expect(0, "check", THEORY_PAIR).stdout)  # alpha = 1
        for settings in (["coupling.gamma1=0.1"], ["coupling.gamma_flow=0.1"], ["coupling.gamma_rows=0.1", "coupling.rows_direction=0.0"],
                         ["noise.rotational_diffusion=0.1"], ["medium.periodic=40.0"], ["medium.field=table"], ["coupling.kappa=0.0"],
                         ["medium.field=dynamic", "medium.dynamic.box=40.0", "medium.dynamic.modes=128"], ["rods.1="]):
            with self.subTest(settings):
                options = [word for setting in settings for word in ("-s", setting)]
                self.assertNotIn(said, self.expect(0, "check", "pair.toml", *options).stdout)

    def test_rods_that_start_in_contact(self):
        """One rule: contact at 0 in a single run, in each variant, with noise and in a scan, and everybody says so."""
        near = PAIR.replace("contact_distance = 0.1", "contact_distance = 5.0")
        variants = '[[variants]]\nname = "one_place"\nset = {"rods.1.position" = [0.0, 2.5]}\n[[variants]]\nname = "apart"\nset = {"rods_run.contact_distance" = 4.9}\n'
        said = r"rods: rods 0 and 1 start 5 apart, within the contact distance \(5\): the run ends in contact at time 0"
        self.write("near.toml", near + variants)
        record = self.expect(0, "check", "near.toml").stdout
        self.assertRegex(record, r"# is this what you mean\?\n  " + said + r"\n  rods \(one_place\): rods 0 and 1 start 0 apart.*\n\n")
        self.assertRegex(self.expect(0, "rods", "near.toml", "-o", "near").stderr, said)
        ends = [self.outcome("near"), self.outcome("near/variants/one_place")]
        for end, apart in zip(ends, (5.0, 0.0)):
            self.assertEqual([end[key] for key in ("outcome", "time", "min_separation", "pair", "turn")], ["contact", 0.0, apart, [0, 1], [0.0, 0.0]])
        self.assertGreater(self.outcome("near/variants/apart")["time"], 0.0)
        self.assertEqual(len((self.folder / "near/rods.csv").read_text().splitlines()), 2)
        self.write("noisy.toml", near + "[noise]\nrotational_diffusion = 0.01\nruns = 7\n")
        self.expect(0, "rods", "noisy.toml", "-o", "noisy")
        record = json.loads((self.folder / "noisy/noise.json").read_text())
        self.assertEqual((record["endings"]["contact"], record["capture_probability"], record["first_contact_time"]["mean"]), (7, 1.0, 0.0))
        self.write("scan.toml", near + '[scan]\n[[scan.axes]]\nkey = "rods.1.position.1"\nvalues = [-2.5, 2.5]\n')
        self.expect(0, "scan", "scan.toml", "-o", "scan")
        rows = list(csv.DictReader((self.folder / "scan/scan.csv").read_text().splitlines()))
        for end, row in zip(ends, rows, strict=True):
            self.assertEqual((row["outcome"], row["status"]), (end["outcome"], "ok"))
            for key in ("time", "min_separation", "min_separation_time"):
                self.assertEqual(float(row[key]), end[key])

    def outcome(self, folder):
        return json.loads((self.folder / folder / "outcome.json").read_text())

    def test_output_times_from_zero_and_without_an_end(self):
        scene = PAIR.replace("t_end = 60.0\noutput_interval = 10.0", "output_times = [0, 5, 10]")
        self.write("pair.toml", scene)
        self.assertIn("2 rods to t = 10,", self.expect(0, "check", "pair.toml").stdout)
        self.expect(0, "rods", "pair.toml", "-o", "out")
        rows = (self.folder / "out/rods.csv").read_text().splitlines()[1:]
        self.assertEqual([float(row.split(",")[0]) for row in rows], [0.0, 5.0, 10.0])


if __name__ == "__main__":
    rodwake.main()
