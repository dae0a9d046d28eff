"""rodwake check: what a scene takes, as counts and as times of this machine, of which only the form is tested."""

import rodwake
from rodwake import PAIR, ProgramTest

TIME = r"[\d.]+ [mun]?s"


class CostTest(ProgramTest):
    def cost(self, scene, *settings):
        self.write("scene.toml", scene)
        return self.expect(0, "check", "scene.toml", *(f"-s{one}" for one in settings)).stdout.split("# expected cost\n")[1]

    def test_rods(self):
        self.assertRegex(self.cost(PAIR), rf"  rods: 1 run to t = 60, {TIME} for a right-hand side\n")
        noise = "[noise]\nrotational_diffusion = 0.01\nruns = 7\n"
        self.assertRegex(self.cost(PAIR + noise, "rods_run.t_end=30"), rf"  rods: 7 runs to t = 30, {TIME} for a right-hand side\n")

    def test_maps_scans_and_fits(self):
        field = self.cost((rodwake.SOURCE / "scenes/sup_ufield.toml").read_text(), "field.nx=11", "field.ny=10")
        self.assertRegex(field, rf"  field map: 110 points of {TIME} in the exact field, about {TIME}\n")
        scan = self.cost((rodwake.SOURCE / "scenes/phase_perpendicular.toml").read_text())
        self.assertRegex(scan, r"  scan: \S+ ms a point, \S+ points if one boundary crosses it, about \S+ CPU seconds\n")

    def test_quiet_says_nothing_of_a_valid_scene(self):
        self.write("scene.toml", PAIR)
        done = self.expect(0, "check", "scene.toml", "--quiet")
        self.assertEqual(done.stdout + done.stderr, "")
        self.refuse(2, r"eta", "check", "scene.toml", "--quiet", "-s", "medium.eta=-3")


if __name__ == "__main__":
    rodwake.main()
