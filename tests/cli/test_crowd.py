"""Many rods through the program: threads change no byte, order and clusters are written, the seed counts, and the order is
measured again from a run that is there."""

import csv
import json

import rodwake
from rodwake import SCENES, ProgramTest

CROWD = SCENES / "crowd.toml"
SHORT = [part for key in ("rods_run.t_end=0.5", "rods_order.from=0.25", "rods_run.rtol=1e-3") for part in ("-s", key)]
ORDER = "rods_order.csv", "clusters.csv", "rods_order.json"
FILES = "rods.csv", *ORDER


class CrowdTest(ProgramTest):
    def rods(self, name, *options):
        self.expect(0, "rods", CROWD, "--quiet", "-o", self.folder / name, *SHORT, *options)
        return {file: (self.folder / name / file).read_bytes() for file in FILES}

    def test_threads_change_no_byte_and_the_seed_does(self):
        one = self.rods("one", "-j", "1")
        for threads in "2", "3":
            self.assertEqual(self.rods(threads, "-j", threads), one)
        self.assertNotEqual(self.rods("seed", "--seed", "5")["rods.csv"], one["rods.csv"])

    def test_order_and_clusters(self):
        files = self.rods("order")
        series = list(csv.DictReader(files["rods_order.csv"].decode().splitlines()))
        self.assertEqual([float(row["t"]) for row in series], [0, 0.25, 0.5])
        means = json.loads(files["rods_order.json"])
        late = [float(row["polar"]) for row in series[1:]]
        self.assertAlmostEqual(means["polar"]["value"], sum(late) / 2, delta=1e-12)
        self.assertEqual((means["instants"], means["units"]["length"]), (2, "f/mu"))
        clusters = list(csv.DictReader(files["clusters.csv"].decode().splitlines()))
        self.assertAlmostEqual(sum(float(row["share"]) for row in clusters), 1, delta=1e-12)
        self.assertAlmostEqual(sum(float(row["size"]) * float(row["clusters"]) for row in clusters), 200, delta=1e-9)

    def measured(self, name, *options, code=0):
        return self.expect(code, "measure", CROWD, "--quiet", "-o", self.folder / name, *SHORT, *options).stderr

    def test_measured_again_without_integrating(self):
        wide, again = self.rods("run"), ("-s", "rods_order.link=1", "-s", "rods_order.from=0.1")
        before = (self.folder / "run/rods.csv").stat().st_mtime_ns
        near = self.rods("near", *again)
        self.assertNotEqual(near["clusters.csv"], wide["clusters.csv"])
        self.assertIn("holds the stage order of another scene", self.measured("run", *again, code=2))
        self.measured("run", "--force", *again)
        for file in ORDER:
            self.assertEqual((self.folder / "run" / file).read_bytes(), near[file], file)
        self.assertEqual((self.folder / "run/rods.csv").stat().st_mtime_ns, before)
        stages = json.loads((self.folder / "run/provenance.json").read_text())["stages"]
        self.assertEqual(stages, {"rods": "finished", "order": "finished"})
        self.assertEqual(json.loads((self.folder / "run/manifest.json").read_text()), json.loads((self.folder / "near/manifest.json").read_text()))

    def test_nothing_to_measure(self):
        self.assertIn("holds no rodwake run; rodwake rods SCENE makes one", self.measured("none", code=2))
        kept = self.rods("run")
        for force in (), ("--force",):  # not this scene's rods
            self.assertIn("of another scene", self.measured("run", "-s", "coupling.kappa=1", *force, code=2))
        self.assertEqual((self.folder / "run/rods.csv").read_bytes(), kept["rods.csv"])
        self.assertIn("no [measure] table and no [rods_order]", self.expect(2, "measure", SCENES / "pair.toml").stderr)


if __name__ == "__main__":
    rodwake.main()
