"""rodwake tradeoff --of bed, fit and field: measured once, gone on with after Ctrl-C, answered as keys of the scene."""

import csv
import json
import signal

import rodwake
from rodwake import PAIR, ProgramTest

BED = """schema = 1
[granular]
phi_b = 0.5
box = "16 a"
duration = "0.4 s"
equilibrate = "0.1 s"
[[granular.rods]]
kind = "motile"
position = ["8 a", "8 a"]
heading = 0.0
[measure]
order = true
order_interval = "0.048 s"
from = "0.1 s"
block = "0.1 s"
"""
FIELD = """schema = 1
[medium]
eta = 0.5
alpha = 2.0
[field]
x = [-3.0, 3.0]
y = [-2.0, 2.0]
nx = 11
ny = 7
[[figures]]
name = "field"
kind = "extensional_axis"
"""
FIT = """schema = 1
[fit]
parameters = ["f_over_mu", "xi"]
start = { f_over_mu = 2.0, xi = 8.0 }
fixed = { eta = 1.0 }
bounds = { f_over_mu = [0.1, 100.0], xi = [1.0, 100.0] }
[[fit.profiles]]
file = "profile.csv"
component = "Ux"
along = "x"
at = 2.0
"""


class WaysTest(ProgramTest):
    def ways(self, part):
        return json.loads((self.folder / f"out/tradeoff_{part}/ways.json").read_text())

    def tradeoff(self, code, scene, *words):
        return self.expect(code, "tradeoff", scene, "-o", "out", *words)

    def test_field(self):
        self.write("field.toml", FIELD)
        table = self.tradeoff(0, "field.toml", "--error", "strain").stdout
        self.assertIn("strain, against the exact field", table)
        ways = self.ways("field")["ways"]
        errors = [next(f["bias"] for f in way["found"] if f["quantity"] == "strain") for way in ways]
        self.assertEqual(errors[0], min(errors))
        for tolerance, error in zip((1e-4, 1e-6, 1e-8, 1e-10), errors[1:]):
            self.assertLess(error, tolerance)
        self.assertGreater((self.folder / "out/tradeoff_field/figures/ways.png").stat().st_size, 10000)
        before = rodwake.snapshot(self.folder / "out")
        answer = self.tradeoff(0, "field.toml", "--for", "strain 1e-3")
        self.assertIn("measured already", answer.stderr)
        self.assertIn('medium.field = "', answer.stdout)
        self.assertEqual(rodwake.snapshot(self.folder / "out"), before)
        self.assertIn("there is displacement, strain, gradients", self.tradeoff(2, "field.toml", "--error", "heat").stderr)
        self.assertIn("another scene", self.tradeoff(2, "field.toml", "-s", "medium.eta=0.6").stderr)

    def test_fit(self):
        self.write("points.csv", "x,y,xi,eta\n" + "".join(f"{x},2.0,12.0,1.0\n" for x in range(-20, 21)))
        rows = csv.DictReader(self.expect(0, "field", "--points", "points.csv").stdout.splitlines())
        noise = [0.02 * ((7919 * k) % 11 - 5) for k in range(41)]
        self.write("profile.csv", "x,value,sigma\n" + "".join(f"{row['x']},{3 * float(row['Ux']) + e},0.06\n" for row, e in zip(rows, noise)))
        self.write("fit.toml", FIT)
        answer = self.tradeoff(0, "fit.toml", "--for", "optimum 1e-3")
        self.assertIn("standard errors) in", answer.stderr)
        keys = answer.stdout.splitlines()
        self.assertEqual([line.split(" = ")[0] for line in keys], ["fit.method", "fit.polish", "fit.starts", "fit.likelihood"])
        ways = self.ways("fit")["ways"]
        self.assertEqual({way["status"] for way in ways}, {"ok"})
        self.assertTrue(any("mlsl" in way["keys"][0] for way in ways))  # all bounded: searches of the whole box too
        error = {tuple(way["keys"]): {f["quantity"]: f["bias"] for f in way["found"]} for way in ways}
        by_likelihood = [found["interval"] for key, found in error.items() if not key[3].endswith("[]")]
        by_curvature = [found["interval"] for key, found in error.items() if key[3].endswith("[]") and found["optimum"] < 1e-3]
        self.assertLess(max(by_likelihood), min(by_curvature))
        self.write("found.toml", FIT.replace("[[fit", "\n".join(line.removeprefix("fit.") for line in keys) + "\n[[fit", 1))
        self.expect(0, "fit", "found.toml", "-o", "found", "--quiet")

    def test_bed(self):
        self.write("bed.toml", BED)
        self.assertIn("granular.time_step", self.tradeoff(0, "bed.toml", "--dry-run").stdout)
        self.assertFalse((self.folder / "out").exists())
        answer = self.tradeoff(0, "bed.toml", "--limit", "0.2s", "--for", "T_z 5%")
        self.assertIn("from the scatter of", answer.stderr)
        self.assertRegex(answer.stdout, r'granular.time_step = "\S+ s"\ngranular.duration = "\S+ s"\nmeasure.interval = "\S+ s"\ngranular.runs = \d+\n')
        record = self.ways("bed")
        self.assertTrue(record["finished"])
        names = [f["quantity"] for f in record["ways"][0]["found"]]
        self.assertEqual(names[:4], ["rod_speed", "T_xy", "T_z", "psi6"])
        self.assertIn("order.psi6", names)
        self.assertTrue(all(way["runs"] >= 4 for way in record["ways"]))
        self.the_table_follows_from_the_runs(record["ways"])
        self.assertIn("--for: much is not a number", self.tradeoff(2, "bed.toml", "--limit", "0.2s", "--for", "T_z much").stderr)

    def test_a_longer_limit_adds_runs(self):
        self.write("bed.toml", BED)
        self.tradeoff(0, "bed.toml", "--limit", "0.01s")
        first = self.ways("bed")["ways"]
        before = [way["runs"] for way in first]
        self.tradeoff(0, "bed.toml", "--limit", f"{8 * min(way['seconds'] for way in first)}s")  # twice the least number of runs
        after = self.ways("bed")["ways"]
        self.assertEqual({way["status"] for way in after}, {"ok"})
        self.assertTrue(all(way["runs"] >= old for way, old in zip(after, before)))
        self.assertGreater(sum(way["runs"] for way in after), sum(before))
        self.expect(0, "dem", "bed.toml", "-o", "out", "--quiet")  # its folder is nobody's run yet

    def the_table_follows_from_the_runs(self, ways):
        """Scatter and bias of T_z once more, from runs.csv."""
        def sample(k):
            with open(self.folder / f"out/tradeoff_bed/ways/{k}/runs.csv", encoding="utf-8") as table:
                return [float(row["T_z"]) for row in csv.DictReader(table)]
        means = [sum(sample(k)) / len(sample(k)) for k in range(len(ways))]
        for k, way in enumerate(ways):
            found = next(f for f in way["found"] if f["quantity"] == "T_z")
            values = sample(k)
            scatter = (sum((v - means[k]) ** 2 for v in values) / (len(values) - 1)) ** 0.5
            self.assertAlmostEqual(found["scatter"] / scatter, 1, delta=1e-9)
            self.assertAlmostEqual(found["bias"], means[k] - means[0], delta=1e-9 * means[0])

    def test_stopped_and_taken_up(self):
        self.write("bed.toml", BED)
        words = ["tradeoff", "bed.toml", "-o", "out", "--limit", "0.2s"]
        with self.started(*words) as process:
            self.assertTrue(rodwake.wait_until((self.folder / "out/tradeoff_bed/ways.json").exists, 60))
            code, _, _ = self.stop(process, signal.SIGINT, 20)
        self.assertEqual(code, 130)
        done = self.ways("bed")["ways"][0]
        self.assertFalse(self.ways("bed")["finished"])
        self.expect(0, *words)
        self.assertEqual(self.ways("bed")["ways"][0], done)

    def test_what_there_is_not(self):
        self.write("pair.toml", PAIR)
        self.assertIn("no [granular] table", self.tradeoff(2, "pair.toml", "--of", "bed").stderr)
        self.assertIn("no [fit] table", self.tradeoff(2, "pair.toml", "--of", "fit").stderr)
        self.assertIn("of rods a plain number", self.tradeoff(2, "pair.toml", "--for", "2%").stderr)
        self.assertIn("heat is none of final_state", self.tradeoff(2, "pair.toml", "--error", "heat").stderr)


if __name__ == "__main__":
    rodwake.main()
