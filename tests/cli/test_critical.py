"""Critical values: where the end of an encounter changes, as numbers with errors."""

import csv
import json
import math

import rodwake
from ranks import ScanRanksTest
from rodwake import wait_until
from scans import CROSSING, ScanTest, rows_of

# A rod at right angles, 5 f/mu beside the other one (alpha = eta = 1).
START = CROSSING.replace("[0.0, -4.0]", "[0.0, -5.0]")
CRITICAL = '[scan]\ndesign = "critical"\nsolve_for = "coupling.kappa"\ntrajectories = 0\n'
STRAIGHT = START.replace("kappa = 1.0", "kappa = 0.0") + (
    '[scan]\ndesign = "critical"\nsolve_for = "rods.1.position.0"\nfrom = 0.0\nto = 9.0\nbetween = ["contact", "other"]\n'
    "tolerance = 1e-13\ntrajectories = 0\n")


class CriticalTest(ScanTest):
    def values(self, run):
        with open(self.folder / run / "critical.csv", newline="", encoding="utf-8") as file:
            return list(csv.DictReader(file))

    def record(self, run):
        return json.loads((self.folder / run / "critical.json").read_text())

    def solve(self, run, scan, *arguments, scene=START, rtol="1e-11"):
        self.write(f"{run}.toml", scene + CRITICAL + scan)
        self.scan(f"{run}.toml", run, "-s", f"rods_run.rtol={rtol}", *arguments)
        return self.values(run)

    def near(self, row, value, error):
        self.assertAlmostEqual(float(row["value"]), value, delta=error)
        self.assertLessEqual(float(row["low"]), float(row["value"]))
        self.assertGreaterEqual(float(row["high"]), float(row["value"]))

    def test_a_separatrix(self):
        """Contact begins where the rods run up to the wide orbit: the digits, the eigenvalue and the slope are of independent codes."""
        one, = self.solve("wide", 'from = 25.0\nto = 28.0\ncount = 4\nbetween = ["contact", "pursuit"]\n')
        self.assertEqual((one["kind"], one["below"], one["above"]), ("separatrix", "pursuit", "contact"))
        self.near(one, 26.05842651829, 3e-7)  # the tolerance, 1e-8 of it
        self.assertAlmostEqual(float(one["lambda"]), 0.17642976, delta=1e-5)  # the orbit moves with kappa
        self.assertLess(float(one["lambda_error"]), 0.01 * float(one["lambda"]))
        self.assertGreater(float(one["closest_below"]), 0.2)
        self.assertLess(float(one["closest_above"]), 0.1)

    def test_an_unbinding(self):
        one, = self.solve("part", 'from = 17.0\nto = 19.0\ncount = 4\ntolerance = 1e-6\n')
        self.assertEqual((one["kind"], one["below"], one["above"]), ("unbinding", "escape", "pursuit"))
        self.near(one, 18.1468754, 2e-6)

    def test_a_fold_and_a_shrinking_orbit(self):
        """From next to the tight orbit: it is born at the fold, and ends where it has shrunk to the contact distance."""
        near = START.replace("alpha = 1.0", "alpha = 0.3").replace("[0.0, -5.0]", "[-1.7, -1.55]").replace('"90 deg"', "1.45")
        fold, shrunk = self.solve("fold", 'from = 22.0\nto = 25.0\ncount = 7\naudit = 0\nbetween = ["orbit", "other"]\n', scene=near)
        self.assertEqual((fold["kind"], fold["below"], fold["above"]), ("fold", "pursuit", "orbit"))
        self.near(fold, 22.9407130019, 1e-9)
        self.assertEqual((shrunk["kind"], shrunk["below"], shrunk["above"]), ("grazing", "orbit", "contact"))
        self.near(shrunk, 24.2495989, 1e-7)

    def test_straight_walkers(self):
        """At right angles, the closest approach is |x - 5|/sqrt(2), and at a difference h of the headings sqrt(50) |cos(h/2 + pi/4)| from
        (5, -5): two roots each in closed form."""
        self.write("straight.toml", STRAIGHT)
        away = 0.1 * math.sqrt(2.0)
        half = 2.0 * math.asin(0.1 / math.sqrt(50.0))
        for run, roots, settings in (("place", (5.0 - away, 5.0 + away), ()),
                                     ("heading", (math.pi / 2.0 - half, math.pi / 2.0 + half),
                                      ("scan.solve_for=rods.1.heading", "rods.1.position.0=5", "scan.from=0.2", "scan.to=3"))):
            self.scan("straight.toml", run, *(word for one in settings for word in ("-s", one)))
            rows = self.values(run)
            self.assertEqual([row["kind"] for row in rows], ["grazing"] * 2)
            for row, root in zip(rows, roots):
                self.near(row, root, 1e-12)
                for side in ("closest_below", "closest_above"):
                    self.assertAlmostEqual(float(row[side]), 0.1, delta=1e-11)

    def test_against_an_independent_integrator(self):
        """Values made in long double: Gragg-Bulirsch-Stoer extrapolation to 1e-16, Bessel functions of Boost, bisection to 1e-14. The last
        is of rods that at some values part each in the other's trail, which nothing decides."""
        for number, (kind, ends, value, settings) in enumerate((
                ("separatrix", ("contact", "pursuit"), 2.2238337888404217,
                 "medium.alpha=1.217 medium.eta=1.086 coupling.kappa=39.23 coupling.gamma2=1.89 rods.1.position.0=-1.255 rods.1.position.1=-1.565 "
                 "rods_run.contact_distance=0.247 scan.solve_for=rods.1.heading scan.from=1.5 scan.to=3"),
                ("grazing", ("escape", "contact"), 1.6253974724333972,
                 "medium.alpha=1.013 coupling.kappa=-49.81 coupling.gamma1=-5.88 rods.1.position.0=1.368 rods.1.position.1=-4.73 "
                 "rods.1.heading=1.169 rods_run.contact_distance=0.171 scan.solve_for=medium.eta scan.from=1 scan.to=3"),
                ("grazing", ("escape", "contact"), -2.2653098349718898,
                 "medium.alpha=2.283 medium.eta=1.76 coupling.kappa=-52.84 coupling.gamma1=-2.28 rods.1.position.0=0.721 "
                 "rods.1.heading=1.62 rods_run.contact_distance=0.158 scan.solve_for=rods.1.position.1 scan.from=-3 scan.to=-2"))):
            one, = self.solve(f"made{number}", 'from = 1.0\nto = 2.0\ncount = 4\naudit = 0\nbetween = ["contact", "other"]\ntolerance = 1e-9\n',
                              *(word for one in settings.split() for word in ("-s", one)))
            self.assertEqual((one["kind"], one["below"], one["above"]), (kind, *ends))
            self.near(one, value, 1e-8 * abs(value))
            self.assertLessEqual(float(one["low"]), value)
            self.assertGreaterEqual(float(one["high"]), value)

    def test_a_triple_point(self):
        """Between two values of alpha the orbits end: two curves become one."""
        self.solve("triple", 'from = 22.0\nto = 26.0\ncount = 5\naudit = 0\ntolerance = 1e-5\nbetween = ["any"]\n'
                   '[[scan.axes]]\nkey = "medium.alpha"\nvalues = [0.6875, 0.875]\n', rtol="1e-8")
        below, above = self.record("triple")["triple_points"][0]
        self.assertEqual([side["at"]["medium.alpha"] for side in (below, above)], [0.6875, 0.875])
        self.assertEqual([(one["kind"], *one["outcomes"]) for one in below["values"]],
                         [("separatrix", "pursuit", "orbit"), ("grazing", "orbit", "contact")])
        self.assertEqual([(one["kind"], *one["outcomes"]) for one in above["values"]], [("separatrix", "pursuit", "contact")])

    def test_similarity(self):
        """Lengths times alpha remove alpha: kappa_c at 2.1 from 2.5 is that at 1.05 from 5."""
        part = 'from = 25.0\nto = 40.0\ncount = 6\nbetween = ["contact", "pursuit"]\ntolerance = 1e-11\n'
        one, = self.solve("one", part, "-s", "medium.alpha=2.1", "-s", "rods.1.position.1=-2.5", "-s", "rods_run.contact_distance=0.05",
                          "-s", "rods_run.t_end=30")
        other, = self.solve("other", part, "-s", "medium.alpha=1.05")
        self.assertAlmostEqual(float(one["value"]) / float(other["value"]), 1.0, delta=1e-9)

    def test_predicted_values(self):
        """Along alpha values are predicted from those before: they cost a fifth of bisection, and are what bisection finds."""
        part = 'from = 10.0\nto = 120.0\nspacing = "log"\ncount = 8\ntolerance = 1e-6\n'
        axis = '[[scan.axes]]\nkey = "medium.alpha"\nfrom = 0.5\nto = 8.0\nspacing = "log"\ncount = 81\n'
        many = self.solve("many", part + axis, rtol="1e-8")
        self.assertEqual({row["kind"] for row in many}, {"unbinding"})
        self.assertEqual(len(many), 81)
        bisection = math.log2(110.0 / 2e-5)
        self.assertLess(sum(float(row["encounters"]) for row in many), 81 * bisection / 4)  # 81 values: an eighth begins
        alphas = ", ".join(many[k]["medium.alpha"] for k in (37, 61))
        few = self.solve("few", part + f'[[scan.axes]]\nkey = "medium.alpha"\nvalues = [{alphas}]\n', rtol="1e-8")
        for row, alone in zip((many[37], many[61]), few):
            self.near(row, float(alone["value"]), 2e-6 * float(alone["value"]))
            self.assertLess(float(row["high"]) - float(row["low"]), 4e-6 * float(row["value"]))

    def test_where_there_is_none(self):
        self.write("straight.toml", STRAIGHT.replace("tolerance = 1e-13", "tolerance = 1e-8\ncount = 2"))
        self.scan("straight.toml", "blind", "-s", "scan.audit=0")
        self.assertEqual(self.values("blind"), [])
        point, = self.record("blind")["points"]
        self.assertEqual((point["status"], point["outcomes"]), ("none", {"escape": 2}))

    def test_a_strip_between_values(self):
        """Contact in 0.1 % of the range, elsewhere at each of 200 starts: random values find it as often as they should."""
        share, values, starts = 1e-3, 300, 200
        text = STRAIGHT.replace("contact_distance = 0.1", f"contact_distance = {9.0 * share / math.sqrt(8.0)}")
        self.write("strip.toml", text.replace("tolerance = 1e-13", f"tolerance = 1e-4\ncount = 2\naudit = {values}") +
                   f'[[scan.axes]]\nkey = "rods.1.position.1"\nfrom = -8.5\nto = -0.5\ncount = {starts}\n')
        self.scan("strip.toml", "out")
        record = self.record("out")
        found = sum(point["count"] == 2 for point in record["points"])
        self.assertEqual(found, sum(point["count"] > 0 for point in record["points"]))
        rate = 1.0 - (1.0 - share)**values
        self.assertAlmostEqual(found / starts, rate, delta=4.0 * math.sqrt(rate * (1.0 - rate) / starts))
        self.assertGreater(record["audit"]["missed_rate_high"], share)
        self.assertAlmostEqual(record["audit"]["found"] / record["audit"]["values"], share, delta=0.3 * share)

    def test_undecided_encounters_leave_a_range(self):
        """Where the limit of time is too short to decide, the bracket is what is known; the value is 26.0584 (separatrix)."""
        one, = self.solve("short", 'from = 25.0\nto = 28.0\ncount = 4\naudit = 0\nbetween = ["contact", "pursuit"]\n', "-s", "rods_run.t_end_limit=70")
        self.assertEqual((one["below"], one["above"], one["lambda"]), ("pursuit", "contact", ""))
        self.assertLess(float(one["low"]), 26.05842651829)
        self.assertGreater(float(one["high"]), 26.05842651829)
        self.assertGreater(float(one["high"]) - float(one["low"]), 1e-3)

    def test_refused(self):
        self.write("critical.toml", START + CRITICAL + "from = 1.0\nto = 50.0\n")
        for message, setting in (("needs solve_for", "scan.solve_for="), ("give a number that an encounter depends on", "scan.solve_for=rods_run.rtol"),
                                 ("is part of capture", 'scan.between=["capture", "pursuit"]'), ("neither an outcome", 'scan.between=["capture", "flight"]'),
                                 ("is in the list already", 'scan.between=["escape", "escape"]'), ("takes two different ends", 'scan.between=["escape"]'), ("the axis is empty", "scan.to=1.0"),
                                 ("needs outcomes that are certain", "noise.rotational_diffusion=0.1")):
            self.refuse_scan(message, "critical.toml", "out", "-s", setting)


class SameBytesTest(ScanRanksTest):
    """Of values that are predicted from others, on threads and ranks, and after a kill."""

    def test_same_bytes(self):
        self.write("scan.toml", START + CRITICAL + 'from = 14.0\nto = 40.0\ncount = 4\naudit = 2\ntolerance = 1e-5\nbetween = ["any"]\n'
                   '[[scan.axes]]\nkey = "medium.alpha"\nfrom = 0.8\nto = 1.6\ncount = 11\n')

        def table(run):
            return (self.folder / run / "critical.csv").read_bytes()

        self.scan("scan.toml", "one", "-j", "1")
        self.scan("scan.toml", "two", "-j", "2")
        self.assertEqual(table("one"), table("two"))
        self.ranks(2, "scan", "scan.toml", "-o", "ranks", "--quiet")
        self.assertEqual(table("one"), table("ranks"))
        log = self.folder / "killed" / "critical.log"
        with self.started("scan", "scan.toml", "-o", "killed", "-j", "2", "--quiet") as process:
            self.assertTrue(wait_until(lambda: log.exists() and log.stat().st_size > 2000 or process.poll() is not None, 60))
            process.kill()
        self.assertFalse((self.folder / "killed" / "critical.csv").exists(), "it ended before it was killed")
        self.scan("scan.toml", "killed", "-j", "2")
        self.assertEqual(table("one"), table("killed"))
        rows = rows_of(self.folder / "one" / "critical.csv")
        self.assertLess(len({row["branch"] for row in rows}), len(rows) / 4)


if __name__ == "__main__":
    rodwake.main()
