"""rodwake scan from scene to files: designs, tables, and that points are what rodwake rods makes of them."""

import json
import math

import h5py
import numpy as np
import rodwake
from scans import ADAPTIVE, COLUMNS, CROSSING, RESULTS, ScanTest, axis
from scans import axes as axes_of

AXES = ["coupling.kappa", "rods.1.position.0"]
FILES = {"log.txt", "manifest.json", "points.log", "provenance.json", "result.h5", "scan.csv", "scan.h5", "scan.json", "scene.toml"}


class AdaptiveTest(ScanTest):
    """One adaptive scan with boundaries, looked at from all sides."""

    def setUp(self):
        super().setUp()
        self.done = self.scan("scan.toml", "out")
        self.table = self.rows("out")
        self.record = self.json("out")

    def test_all_of_it(self):  # one scan for them all
        self.files_are_reported()
        self.rows_are_as_the_summary_says()
        self.cells_cover_the_axes()
        self.boundaries_lie_between_outcomes()
        self.datasets_are_the_table()
        self.the_ledger_is_the_table()
        self.rows_are_single_runs()

    def files_are_reported(self):
        names = {path.name for path in (self.folder / "out").iterdir()}
        self.assertEqual(names, FILES | {"cells.csv", "boundary.csv"})
        files = json.loads((self.folder / "out/manifest.json").read_text())["files"]
        self.assertEqual(set(files), names)
        for name in RESULTS:
            header = (self.folder / "out" / name).read_text().splitlines()[0].split(",")
            self.assertEqual([column["name"] for column in files[name]["columns"]], header)
        units = {column["name"]: column["unit"] for column in files["cells.csv"]["columns"]}
        self.assertEqual((units["coupling.kappa_from"], units["rods.1.position.0_to"]), ("mu v0/f", "f/mu"))

    def rows_are_as_the_summary_says(self):
        self.assertEqual(list(self.table[0]), AXES + COLUMNS)
        record = self.record
        self.assertEqual((record["design"], record["requested"], record["resolution"]), ("adaptive", 33 * 33, 32))
        self.assertEqual((record["evaluated"], record["failed"], record["left"], record["causes"]), (len(self.table), 0, 0, {}))
        self.assertLess(len(self.table), 33 * 33)
        self.assertEqual((record["audited"], record["missed"], record["missed_rate"]), (100, 0, 0.0))
        self.assertAlmostEqual(record["missed_rate_high"], 1.0 - 0.05**0.01, places=12)  # Clopper and Pearson
        for outcome, count in record["outcomes"].items():
            self.assertEqual(sum(row["outcome"] == outcome for row in self.table), count)
            self.assertIn(f"{outcome} {count}" if count else "", self.done.stderr)
        self.assertGreater(min(record["outcomes"][name] for name in ("contact", "escape")), 50)
        for row in self.table:
            self.assertEqual((row["status"], row["retries"]), ("ok", "0"))
            self.assertTrue(all(math.isfinite(float(row[name])) for name in AXES + ["time", "min_separation", "turn1"]))

    def cells_cover_the_axes(self):
        places = {(float(row[AXES[0]]), float(row[AXES[1]])): row["outcome"] for row in self.table}
        area = 0.0
        for cell in self.rows("out", "cells.csv"):
            corners = {places[float(cell[f"{AXES[0]}_{x}"]), float(cell[f"{AXES[1]}_{y}"])]
                       for x in ("from", "to") for y in ("from", "to")}
            self.assertEqual({cell["outcome"]}, corners if len(corners) == 1 else {"mixed"})
            area += (math.log(float(cell[f"{AXES[0]}_to"]) / float(cell[f"{AXES[0]}_from"]))
                     * (float(cell[f"{AXES[1]}_to"]) - float(cell[f"{AXES[1]}_from"])))
        self.assertAlmostEqual(area, math.log(1000.0) * 12.0, places=9)  # some hundred cells, rounding of each 1e-14

    def boundaries_lie_between_outcomes(self):
        """A bracket beyond each point of a curve the outcomes are those that the curve is between."""
        rows = self.rows("out", "boundary.csv")
        self.assertEqual(list(rows[0]), ["curve", "between", *AXES, "error"])
        traced = self.record["boundary"].pop("evaluated")
        self.assertGreater(traced, 5 * len(rows))  # 32 cells a side down to 1e-4: nine halvings of an edge
        self.assertLessEqual(traced, 9 * len(rows))
        self.assertEqual(self.record["boundary"], {"curves": len({row["curve"] for row in rows}), "points": len(rows), "tolerance": 1e-4, "gaps": 0})
        self.assertTrue(all(float(row["error"]) <= 0.5e-4 for row in rows))
        row = next(row for row in rows if row["between"] == "contact|escape")
        found = set()
        for step in (-1e-3, 1e-3):  # of the axes; on a grid of four places around the point
            for along in (0, 1):
                kappa, x = float(row[AXES[0]]), float(row[AXES[1]])
                kappa, x = (kappa * 1000.0**step, x) if along == 0 else (kappa, x + 12.0 * step)
                found.add(self.single_run(kappa, x)["outcome"])
        self.assertEqual(found, {"contact", "escape"})

    def datasets_are_the_table(self):
        with h5py.File(self.folder / "out/scan.h5") as file:
            points, paths = file["points"], file["trajectories"]
            for name in AXES + ["time", "min_separation", "turn0", "steps"]:
                self.assertEqual([float(row[name]) for row in self.table], list(points[name]))
            names = points.attrs["outcome_names"].decode().split(",")
            self.assertEqual([row["outcome"] for row in self.table], [names[int(k)] for k in points["outcome"]])
            self.assertEqual(set(points["status"]), {0.0})
            chosen = [self.table[int(row)] for row in paths["point"]]
            self.assertEqual(len(chosen), 20)
            self.assertTrue(np.all(np.diff(paths["t"]) >= 0.0))
            for one, t, x, y, theta in zip(chosen, paths["t"], paths["x"], paths["y"], paths["theta"]):
                self.assertEqual(t[0], 0.0)
                self.assertAlmostEqual(t[-1], float(one["time"]), delta=1e-5)
                self.assertEqual((x[0][1], y[0][1], theta[0][0]), (float(one[AXES[1]]), -4.0, 0.0))
                separation = np.hypot(x[-1][0] - x[-1][1], y[-1][0] - y[-1][1])
                # outputs are interpolated, the table holds the solver's own last step: its tolerance is 1e-8
                self.assertAlmostEqual(separation, float(one["final_separation"]), delta=1e-6)

    def the_ledger_is_the_table(self):
        rows = self.ledger("out")[0]
        self.assertEqual({(row[4], row[-1]) for row in rows}, {("ok", None)})
        numbers = [*AXES, "time", "min_separation", "retries"]
        self.assertEqual([(*row[1:3], *row[5:7], row[-2]) for row in rows], [tuple(float(row[name]) for name in numbers) for row in self.table])
        self.assertEqual([row[3] for row in rows], [row["outcome"] for row in self.table])

    def rows_are_single_runs(self):
        for row in self.table[:: len(self.table) // 4]:
            single = self.single_run(row[AXES[0]], row[AXES[1]])
            self.assertEqual(single["outcome"], row["outcome"])
            found = [float(row[name]) for name in ("time", "min_separation", "turn0", "turn1")]
            for one, other in zip(found, [single["time"], single["min_separation"], *single["turn"]]):
                self.assertAlmostEqual(one, other, delta=1e-5)  # by another integrator, both at rtol = 1e-8
            # a minimum is as flat as its place is uncertain: the root of the error
            self.assertAlmostEqual(float(row["min_separation_time"]), single["min_separation_time"], delta=1e-3)

    def single_run(self, kappa, x):
        # the point of a scan has no outputs on its way
        self.write("one.toml", CROSSING)
        self.expect(0, "rods", "one.toml", "-o", "one", "--force", "--quiet", "-s", f"coupling.kappa={kappa}",
                    "-s", f"rods.1.position.0={x}", "-s", "rods_run.output_times=[60.0]")
        return json.loads((self.folder / "one/outcome.json").read_text())


class DesignTest(ScanTest):
    def test_a_method_of_choice_gives_single_runs_to_the_bit(self):
        self.write("one.toml", CROSSING)
        method = ("-s", "rods_run.method=adams")
        self.scan("grid.toml", "chosen", *method)
        for row in self.rows("chosen")[::20]:
            self.expect(0, "rods", "one.toml", "-o", "one", "--force", "--quiet", *method, "-s", f"coupling.kappa={row[AXES[0]]}",
                        "-s", f"rods.1.position.0={row[AXES[1]]}", "-s", "rods_run.output_times=[60.0]")
            single = json.loads((self.folder / "one/outcome.json").read_text())
            self.assertEqual([single["time"], *single["turn"]], [float(row[name]) for name in ("time", "turn0", "turn1")])

    def test_a_grid_has_every_pair(self):
        self.scan("grid.toml", "out")
        rows = self.rows("out")
        self.assertEqual(len(rows), 81)
        self.assertEqual([float(row[AXES[1]]) for row in rows[:9]], list(np.linspace(-6.0, 6.0, 9)))  # the last axis runs fastest
        np.testing.assert_allclose([float(row[AXES[0]]) for row in rows[::9]], np.geomspace(0.1, 100.0, 9), rtol=1e-14)
        self.assertEqual({path.name for path in (self.folder / "out").iterdir()}, FILES)
        record = self.json("out")
        self.assertEqual((record["requested"], record["evaluated"], record["missed_rate"], record["resolution"], record["boundary"]),
                         (81, 81, None, None, None))
        self.assertEqual([one["spacing"] for one in record["axes"]], ["log", "linear"])
        self.assertEqual([one["symbol"] for one in record["axes"]][0], r"\kappa")

    def test_samples(self):
        for design in ("lhs", "sobol"):
            self.scan("grid.toml", design, "-s", f"scan.design={design}", "-s", "scan.samples=50")
            x = sorted(float(row[AXES[1]]) for row in self.rows(design))
            self.assertEqual(len(set(x)), 50)
            self.assertTrue(-6.0 < x[0] and x[-1] < 6.0)
        slices = sorted(int((float(row[AXES[1]]) + 6.0) / 12.0 * 50) for row in self.rows("lhs"))
        self.assertEqual(slices, list(range(50)))

    def test_a_list_of_points(self):
        self.write("points.csv", "# starts\ncoupling.kappa, rods.1.position.0\n0.5, -1.0\n50, 2.5\n0.1,0\n")
        self.write("list.toml", CROSSING + '[scan]\ndesign = "list"\nfile = "points.csv"\n')
        self.scan("list.toml", "out")
        self.assertEqual([(row[AXES[0]], row[AXES[1]]) for row in self.rows("out")], [("0.5", "-1"), ("50", "2.5"), ("0.1", "0")])

    def test_a_list_of_many_columns_as_a_spreadsheet_writes_it(self):
        keys = ["coupling.kappa", "rods.1.position.0", "coupling.gamma1", "coupling.gamma2", "rods.0.heading", "rods.1.heading",
                "rods.1.position.1", "rods_run.t_end"]
        rows = [[0.5, -1.0, 0.1, 0.2, 0.0, 1.5, -4.0, 60.0], [50.0, 2.5, -0.1, 0.0, 0.1, 1.6, -3.0, 50.0]]
        text = "\n  # starts\n;" + ";".join(keys) + ";\r\n" + "".join(f"{i};{';'.join(map(str, row))};\r\n" for i, row in enumerate(rows))
        self.write("points.csv", "\ufeff" + text)
        self.write("list.toml", CROSSING + '[scan]\ndesign = "list"\nfile = "points.csv"\ntrajectories = 1\n')
        self.scan("list.toml", "out")
        found = self.rows("out")
        self.assertEqual([[float(row[key]) for key in keys] for row in found], rows)
        self.assertEqual([axis["key"] for axis in self.json("out")["axes"]], keys)
        with h5py.File(self.folder / "out/scan.h5") as file:
            self.assertEqual(list(file["points/rods_run.t_end"]), [60.0, 50.0])
        self.write("few.csv", ",".join(keys[:6]) + "\n" + ",".join(map(str, rows[1][:6])) + "\n")  # the second row, its last two set by hand
        self.scan("list.toml", "few", "-s", "scan.file=few.csv", "-s", "rods.1.position.1=-3.0", "-s", "rods_run.t_end=50.0")
        for name in ("outcome", "time", "final_separation"):
            self.assertEqual(found[1][name], self.rows("few")[0][name])

    def test_certificates(self):
        self.write("adaptive.toml", CROSSING + '[scan]\ndesign = "adaptive"\nresolution = 8\naudit = 5\ntrajectories = 0\n' + axes_of(4))
        self.write("straight.toml", CROSSING.replace("kappa = 1.0", "kappa = 0.0") + "[scan]\n" + axis("rods.1.position.0", -6.0, 6.0, 9))
        self.scan("adaptive.toml", "plain")
        self.scan("adaptive.toml", "asked", "-s", "scan.certificates=true")
        self.scan("straight.toml", "straight")
        self.assertEqual({row["certificate"] for row in self.rows("plain")}, {"open"})
        self.assertEqual(self.json("plain")["certified_area"], {"verified": 0.0, "checked": 0.0, "open": 1.0})
        self.assertEqual({row["certificate"] for row in self.rows("straight")}, {"verified"})
        self.assertIsNone(self.json("straight")["certified_area"])
        rows, record = self.rows("asked"), self.json("asked")
        self.assertEqual([row["outcome"] for row in rows], [row["outcome"] for row in self.rows("plain")])
        self.assertEqual(record["certificates"], {name: sum(row["certificate"] == name for row in rows) for name in ("verified", "checked", "open")})
        self.assertGreater(record["certificates"]["verified"], 20)
        area = dict.fromkeys(("verified", "checked", "open"), 0.0)
        for cell in self.rows("asked", "cells.csv"):
            self.assertFalse(cell["outcome"] == "mixed" and cell["certificate"] != "open")
            area[cell["certificate"]] += (math.log(float(cell[f"{AXES[0]}_to"]) / float(cell[f"{AXES[0]}_from"])) / math.log(1000.0)
                                          * (float(cell[f"{AXES[1]}_to"]) - float(cell[f"{AXES[1]}_from"])) / 12.0)
        for name, share in area.items():
            self.assertAlmostEqual(record["certified_area"][name], share, places=9)  # rounding of each cell 1e-14
        self.assertGreater(area["verified"] + area["checked"], 0.2)

    def test_which_two_of_three_rods_met(self):
        three = CROSSING + "[[rods]]\nposition = [4.0, 1.0]\nheading = 3.1\n"
        self.write("three.toml", three + "[scan]\n" + axis("rods.1.position.0", -5.0, 5.0, 5) + axis("coupling.kappa", 5.0, 60.0, 3))
        self.scan("three.toml", "three")
        rows = self.rows("three")
        met = [(row["pair_i"], row["pair_j"]) for row in rows if row["outcome"] in ("contact", "pursuit")]
        self.assertGreater(len(set(met)), 1)
        self.assertEqual({(row["pair_i"], row["pair_j"]) for row in rows if row["outcome"] not in ("contact", "pursuit")} - {("", "")}, set())
        for row in rows[::3]:
            self.write("one.toml", three)
            self.expect(0, "rods", "one.toml", "-o", "one", "--force", "--quiet", *[word for key in ("rods.1.position.0", "coupling.kappa")
                                                                                    for word in ("-s", f"{key}={float(row[key])}")])
            record = json.loads((self.folder / "one/outcome.json").read_text())
            if record["outcome"] in ("contact", "pursuit"):
                self.assertEqual([int(row["pair_i"]), int(row["pair_j"])], record["pair"])
        self.write("two.toml", CROSSING + "[scan]\n" + axis("rods.1.position.0", -5.0, 5.0, 2))
        self.scan("two.toml", "two")
        self.assertNotIn("pair_i", self.rows("two")[0])

    def test_words_and_ties(self):
        self.write("words.toml", CROSSING + '[scan]\n[[scan.axes]]\nkey = "rods_run.method"\nvalues = ["bdf", "adams", "erk"]\n'
                   '[[scan.axes]]\nkeys = ["coupling.gamma1", "coupling.gamma2"]\nfactor = [1.0, -1.0]\nvalues = [1.0, 2.0]\n')
        self.scan("words.toml", "out")
        rows = self.rows("out")
        self.assertEqual([(row["rods_run.method"], row["coupling.gamma1"]) for row in rows],
                         [(method, gamma) for method in ("bdf", "adams", "erk") for gamma in ("1", "2")])
        record = self.json("out")["axes"]
        self.assertEqual((record[0]["values"], record[1]["keys"], record[1]["factors"]),
                         (["bdf", "adams", "erk"], ["coupling.gamma1", "coupling.gamma2"], [1.0, -1.0]))
        self.assertEqual({outcome for row in rows[::2] for outcome in [row["outcome"]]}, {rows[0]["outcome"]})
        with h5py.File(self.folder / "out/scan.h5") as file:
            self.assertEqual(file["points"].attrs["rods_run.method_names"].decode(), "bdf,adams,erk")

    def test_units_and_ends_that_vary(self):
        self.write("turn.toml", CROSSING + "[scan]\n" + axis("rods.1.heading", '"10 deg"', '"90 deg"', 5) + axis("rods_run.t_end", 5.0, 80.0, 3))
        self.scan("turn.toml", "out")
        rows = self.rows("out")
        self.assertAlmostEqual(float(rows[0]["rods.1.heading"]), math.pi / 18.0, places=15)
        self.assertEqual(self.json("out")["axes"][0]["unit"], "rad")
        for row in rows:
            self.assertLessEqual(float(row["time"]), float(row["rods_run.t_end"]))
            if row["outcome"] != "contact":
                self.assertEqual(row["time"], row["rods_run.t_end"])

    def test_one_and_three_axes(self):
        one = ADAPTIVE.replace(axes_of(16), axis("rods.1.position.0", -6.0, 6.0, 16))
        three = ADAPTIVE.replace(axes_of(16), axes_of(4) + axis("coupling.gamma1", -1.0, 1.0, 4)).replace("resolution = 32", "resolution = 8")
        for name, text, corners in (("one", one, 2), ("three", three, 8)):
            self.write(f"{name}.toml", text)
            self.scan(f"{name}.toml", name)
            self.assertGreater(self.json(name)["boundary"]["points"], 0)
            self.assertEqual(len(self.rows(name, "cells.csv")[0]) - 2, {2: 2, 8: 6}[corners])

    def test_observables_refine(self):
        plain = ADAPTIVE.replace("boundary_tolerance = 1e-4\n", "").replace("audit = 100", "audit = 0")
        self.write("fine.toml", plain + '[[scan.refine]]\nobservable = "final_angle"\nstep = 0.1\n')
        self.write("plain.toml", plain)
        for name in ("plain", "fine"):
            self.scan(f"{name}.toml", name)
        self.assertGreater(self.json("fine")["evaluated"], self.json("plain")["evaluated"])
        self.assertEqual(self.json("fine")["missed_rate"], None)

    def test_no_trajectories(self):
        self.scan("grid.toml", "out", "-s", "scan.trajectories=0")
        with h5py.File(self.folder / "out/scan.h5") as file:
            self.assertNotIn("trajectories", file)


class SameTest(ScanTest):
    def test_threads_do_not_change_a_byte(self):
        for scene in ("scan", "grid"):
            for threads in (1, 2, 5):
                self.scan(f"{scene}.toml", f"{scene}{threads}", "-j", threads)
            self.assert_same(f"{scene}1", f"{scene}2")
            self.assert_same(f"{scene}1", f"{scene}5")


if __name__ == "__main__":
    rodwake.main()
