"""Many rods through the program: threads change no byte, order and clusters are written, the seed counts."""

import csv
import json

import rodwake
from rodwake import SCENES, ProgramTest

CROWD = SCENES / "crowd.toml"
SHORT = [part for key in ("rods_run.t_end=0.5", "rods_order.from=0.25", "rods_run.rtol=1e-3") for part in ("-s", key)]
FILES = "rods.csv", "rods_order.csv", "clusters.csv", "rods_order.json"


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


if __name__ == "__main__":
    rodwake.main()
