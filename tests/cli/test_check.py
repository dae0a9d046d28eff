"""rodwake check: what it says will be modelled and what not."""

import rodwake
from rodwake import PAIR, ProgramTest

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
        told = self.expect(0, "check", "noisy.toml").stdout
        self.assertRegex(told, r"noise: D_r = 0\.01, D_t = 0, 7 runs, steps of at most 0\.0\d+ \(0\.05 of the shortest")
        self.assertIn("diffusion of places: noise.translational_diffusion is 0", told)

    def test_output_times_from_zero_and_without_an_end(self):
        scene = PAIR.replace("t_end = 60.0\noutput_interval = 10.0", "output_times = [0, 5, 10]")
        self.write("pair.toml", scene)
        self.assertIn("2 rods to t = 10,", self.expect(0, "check", "pair.toml").stdout)
        self.expect(0, "rods", "pair.toml", "-o", "out")
        rows = (self.folder / "out/rods.csv").read_text().splitlines()[1:]
        self.assertEqual([float(row.split(",")[0]) for row in rows], [0.0, 5.0, 10.0])


if __name__ == "__main__":
    rodwake.main()
