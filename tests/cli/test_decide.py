"""How pairs end for good: orbits, and points of scans that go on until they are decided."""

import json

import rodwake
from scans import CROSSING, ScanTest

# From a right angle into the tight orbit (rodwake.pair_equilibria: 0.8874119340 f/mu apart, omega 1.5516891196).
ORBIT = CROSSING.replace("alpha = 1.0", "alpha = 0.3").replace("kappa = 1.0", "kappa = 23.5").replace("[0.0, -4.0]", "[0.0, -5.0]")
# Undecided at t = 4, then contact, escape or orbit.
SHORT = (ORBIT.replace("t_end = 60.0", "t_end = 4.0") + '[scan]\ndesign = "grid"\ntrajectories = 3\n'
         '[[scan.axes]]\nkey = "coupling.kappa"\nvalues = [3.0, 23.5, 40.0]\n')


class DecideTest(ScanTest):
    def setUp(self):
        super().setUp()
        self.write("orbit.toml", ORBIT)
        self.write("short.toml", SHORT)

    def outcome(self, run, *arguments):
        self.expect(0, "rods", "orbit.toml", "-o", run, "--quiet", *arguments)
        return json.loads((self.folder / run / "outcome.json").read_text())

    def test_an_orbit(self):
        """Whichever the solver, the numbers are those of the fixed point."""
        for method in ("erk", "bdf"):
            found = self.outcome(method, "-s", f"rods_run.method={method}")
            self.assertEqual(found["outcome"], "orbit")
            self.assertAlmostEqual(found["separation"], 0.8874119340, delta=1e-9)  # the digits that are given
            self.assertAlmostEqual(found["omega"], -1.5516891196, delta=1e-9)
            self.assertIn("rods 0 and 1 orbit each other 0.887412 apart, once in a time of 4.04926", found["reason"])
        mirrored = self.outcome("mirrored", "-s", "rods.1.position.1=5.0", "-s", "rods.1.heading=-90 deg")
        self.assertAlmostEqual(mirrored["omega"], 1.5516891196, delta=1e-9)

    def test_a_pursuit_says_whether_it_lasts(self):
        found = self.outcome("out", "-s", "medium.alpha=1.0", "-s", "coupling.kappa=30", "-s", "rods.1.position.0=-6")
        self.assertEqual((found["outcome"], found["stable"]), ("pursuit", True))
        self.assertGreater(found["separation"], 1.0)
        self.assertIsInstance(found["separation_grows"], bool)

    def test_points_go_on_until_they_are_decided(self):
        self.scan("short.toml", "short")
        self.assertEqual([row["outcome"] for row in self.rows("short")], ["undecided"] * 3)
        self.scan("short.toml", "batch", "-s", "scan.decide=true")
        self.scan("short.toml", "alone", "-s", "scan.decide=true", "-s", "rods_run.method=erk")
        for run in ("batch", "alone"):
            rows = self.rows(run)
            self.assertEqual([row["outcome"] for row in rows], ["escape", "orbit", "contact"])
            self.assertEqual([row["separation"] != "" for row in rows], [False, True, False])
            self.assertAlmostEqual(float(rows[1]["separation"]), 0.8874119340, delta=1e-9)
            for row in rows:
                self.assertGreater(float(row["time"]), 4.0)
        self.scan("short.toml", "long", "-s", "rods_run.t_end=200")
        whole, parts = self.rows("long")[2], self.rows("alone")[2]
        for column in ("time", "turn0", "turn1", "min_separation"):  # the run began anew at t = 4, 8, ...: rtol is 1e-8
            self.assertAlmostEqual(float(whole[column]), float(parts[column]), delta=1e-5, msg=column)

    def test_a_limit(self):
        self.scan("short.toml", "out", "-s", "scan.decide=true", "-s", "rods_run.t_end_limit=6")
        self.assertEqual([(row["outcome"], row["time"]) for row in self.rows("out")[:2]], [("undecided", "6")] * 2)
        log = (self.folder / "out/log.txt").read_text()
        self.assertIn("scan: 2 points are undecided at rods_run.t_end_limit", log)
        self.assertRegex(log, r"1  rods 0 and 1 show no pursuit \(.*\), no escape \(.*\), no orbit \(.*\)\n.*this was at coupling.kappa = 3\n")

    def test_refused(self):
        self.refuse_scan("t_end_limit needs scan.decide = true", "short.toml", "out", "-s", "rods_run.t_end_limit=6")
        self.refuse_scan("must be at least t_end", "short.toml", "out", "-s", "scan.decide=true", "-s", "rods_run.t_end_limit=2")
        self.refuse_scan("scan.decide is for rods without", "short.toml", "out", "-s", "scan.decide=true", "-s", "noise.rotational_diffusion=0.1")


if __name__ == "__main__":
    rodwake.main()
