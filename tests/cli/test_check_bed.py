"""rodwake check of a granular bed: how many beads, how long, what does not fit."""

import math
import re

import rodwake
from rodwake import PAIR, ProgramTest

BED = """schema = 1
[granular]
phi_b = 0.80
box = "78 a"
duration = "10 s"
"""
ROD = "[[granular.rods]]\nposition = [\"20 a\", \"46.5 a\"]\n"


class CheckBedTest(ProgramTest):
    def check(self, text, *settings):
        self.write("bed.toml", text)
        return self.expect(0, "check", "bed.toml", *(f"-s{setting}" for setting in settings)).stdout

    def refuse_bed(self, pattern, text, *settings):
        self.write("bed.toml", text)
        self.refuse(2, pattern, "check", "bed.toml", *(f"-s{setting}" for setting in settings))

    def number(self, pattern, text):
        found = re.search(pattern, text)
        self.assertIsNotNone(found, text)
        return float(found[1])

    def beads(self, text):
        return self.number(r"(\d+) beads of radius", text)

    def equilibration(self, *settings):
        return self.number(r"of equilibration \(([\d.e+-]+) s\)", self.check(BED, "granular.box=24 a", *settings))  # whose steps are timed at once

    def test_number_of_beads(self):
        """N = round(phi_b L^2/(pi a^2)), L = 78 a."""
        self.assertEqual(self.beads(self.check(BED)), 1549)
        for phi_b in (0.7, 0.74, 0.78):
            self.assertEqual(self.beads(self.check(BED, f"granular.phi_b={phi_b}")), round(phi_b * 78**2 / math.pi))
        self.assertEqual(self.beads(self.check(BED, "granular.beads=12")), 12)
        self.assertIn("phi_b = 0.8, of which the beads cover 0.7999", self.check(BED))  # 1549 pi/78^2

    def test_the_area_of_rods_is_taken_off_if_it_counts(self):
        alone = self.beads(self.check(BED + ROD, "granular.phi_b=0.78", "granular.count_rod_area=false"))
        text = self.check(BED + ROD, "granular.phi_b=0.78")
        self.assertIn("phi_b = 0.78 with the rods' shadows, of which the beads cover", text)
        shared = self.beads(text)
        self.assertEqual(alone, round(0.78 * 78**2 / math.pi))
        # The shadow of the rod is within that of two rectangles 4.5 mm long, as thick as its thin and its thick end.
        bead = math.pi * 0.4**2
        self.assertGreater(alone - shared, math.floor(4.0 * 0.8 / bead))
        self.assertLess(alone - shared, math.ceil(4.5 * 1.1 / bead))
        self.refuse_bed(r"bed\.toml: \[granular\] .*the rods alone cover", BED + ROD,
                        "granular.phi_b=1e-4")
        self.assertIn("beads: there are none", self.check(BED + ROD, "granular.phi_b=1e-4", "granular.count_rod_area=false"))
        self.assertNotIn("shadows", self.check(BED))

    def test_default_equilibration(self):
        self.assertEqual(self.equilibration(), 0.5)
        self.assertEqual(self.equilibration("granular.start=restart", "granular.restart_from=x.h5"), 0)
        for phi_b, seconds in [(0.3, 1), (0.60, 1), (0.65, 1.5), (0.70, 2), (0.71, 5), (0.72, 8), (0.74, 9), (0.76, 10), (0.78, 17),
                               (0.80, 24), (0.83, 24)]:
            # Steps are whole and times printed with six digits.
            self.assertAlmostEqual(self.equilibration("granular.start=random", f"granular.phi_b={phi_b}"), seconds, delta=1e-4)
        self.assertEqual(self.equilibration("granular.start=random", "granular.equilibrate=0.25"), 0.25)

    def test_steps_and_cost(self):
        text = self.check(BED, "granular.runs=3")
        self.assertIn("100000 steps of 0.0001 s from t = 0 (10 s) after 5000 of equilibration", text)
        self.assertIn("; 3 runs\n", text)
        each, all_runs = map(float, re.search(r"about (\S+) CPU seconds each, (\S+) for 3 runs", text).groups())
        self.assertAlmostEqual(all_runs, 3.0 * each, delta=0.1 * all_runs)  # two digits are printed
        self.assertIn("1000000 steps of 0.0001 s", self.check(BED, "granular.duration=100"))
        self.assertIn("1 steps of 0.0001 s", self.check(BED, "granular.duration=1e-9"))
        self.assertIn("101 frames of 1549 spheres (h5md), at most 9.39 MB", text)
        self.assertIn("101 frames of 1549 spheres (h5md, xyz), at most 31.3 MB", self.check(BED, "granular.runs=1"))
        self.assertIn("no frames; a table of 1001 rows", self.check(BED, "granular.output.formats=[]", "granular.output.last_period=false"))

    def test_the_step_follows_the_plates(self):
        for gamma, steps in ((0, 50), (7, 50), (20, 143), (50, 357)):  # physics: granular/surfaces.hpp
            text = self.check(BED, f"granular.plates.gamma={gamma}", "granular.duration=1 s", "granular.box=24 a")
            self.assertIn(f"{200 * steps} steps of {1 / (200 * steps):g} s from t = 0 (1 s)", text)
        self.assertIn("50000 steps of 2e-05 s", self.check(BED, "granular.time_step=2e-5", "granular.duration=1 s", "granular.box=24 a"))

    def test_the_end_at_a_travel(self):
        self.assertIn("with the rods held; ends earlier if the rods have travelled 39 a on average; 1 run\n",
                      self.check(BED + ROD, "granular.stop_at_travel=39 a"))
        self.refuse_bed(r"stop_at_travel needs \[\[granular\.rods\]\]", BED, "granular.stop_at_travel=39 a")

    def test_plates(self):
        self.assertIn("amplitude 43.49 um (Gamma = 7)", self.check(BED))  # 7 g/(2 pi 200 Hz)^2
        still = self.check(BED, "granular.plates.gamma=0")
        self.assertIn("vibration: gamma is 0", still.split("# not modelled")[1])
        self.assertNotIn("amplitude", still)

    def test_contacts_of_pairs(self):
        text = self.check(BED, "granular.contacts.particle_particle.friction=0.5", "granular.contacts.bead_rod.restitution=0.9",
                          "granular.contacts.rod_rod.friction=0.1", "granular.contacts.rod_wall.restitution=0.2")
        self.assertIn("bead-bead 0.5/0.3, bead-rod 0.5/0.9, rod-rod 0.1/0.3, bead-wall 0.2/0.3, rod-wall 0.03/0.2", text)

    def test_rods(self):
        text = self.check(BED + ROD + "kind = \"apolar\"\nimposed_speed = \"1 mm/s\"\n")
        self.assertRegex(text, r"rod 0: apolar, 13 spheres, 4\.5 mm long, .* at \(20 a, 46\.5 a\) heading 0 rad, dragged at 1 mm/s")
        self.assertIn("pinned", self.check(BED + ROD, "granular.rods.0.imposed_speed=0"))
        self.assertIn("rods in the bed: no [[granular.rods]]", self.check(BED))

    def test_seed(self):
        self.assertIn("seed 5\n", self.check(BED, "granular.seed=5"))
        self.assertIn("seed 6\n", self.expect(0, "check", "bed.toml", "-s", "granular.seed=5", "--seed", "6").stdout)

    def test_what_does_not_fit(self):
        for pattern, settings in [(r"gap = .*larger than the bead diameter", ["granular.plates.gap=0.8 mm"]),
                                  (r"rod 0: gap = .*thickest", ["granular.plates.gap=1.0 mm"]),
                                  (r"use fewer beads", ["granular.beads=2000"]),
                                  (r"steps a period", ["granular.time_step=1e-3"]),
                                  (r"rod 0: .*odd", ["granular.rods.0.kind=apolar", "granular.rods.0.spheres=12"]),
                                  (r"box = .*at least 8 bead radii", ["granular.rods=[]", "granular.box=7 a"])]:
            with self.subTest(settings):
                self.refuse_bed(r"bed\.toml: \[granular\] (.|\n)*" + f"(?:{pattern})", BED + ROD, *settings)
        overlapping = BED + ROD + ROD
        self.refuse_bed(r"rods 0 and 1 overlap", overlapping)

    def test_other_scenes_have_no_bed(self):
        self.write("pair.toml", PAIR)
        self.assertIn("granular bed: no [granular] table", self.expect(0, "check", "pair.toml").stdout.split("# not modelled")[1])


if __name__ == "__main__":
    rodwake.main()
