"""rodwake dem: what a granular run leaves, what is the same of two runs, and what it refuses."""

import json
import math
import re
import shutil
import time

import h5py
import numpy
import rodwake
from beds import BED, FINAL, BedTest, columns, flip_byte, setting
from rodwake import SCENES, snapshot

A = 0.4e-3  # radius of a bead, m
SHORT = setting(duration=0.02, output__frames=0.005)
BEADS_ONLY = setting(rods=[])


class FilesTest(BedTest):
    def test_what_is_left(self):
        self.dem("out")
        self.assertEqual(self.names("out"), FINAL)
        self.assertEqual(self.status("out"), "finished")
        self.assert_finite("out")
        summary = self.summary("out")
        self.assertLessEqual({"simulated_time", "cpu_seconds", "wall_seconds", "T_xy", "T_z", "max_overlap", "psi6", "rods",
                              "state_hash"}, summary.keys())
        self.assertEqual(summary["simulated_time"], 2000 * 1e-4)
        self.assertGreater(summary["wall_seconds"], 0.0)
        self.assertGreater(summary["cpu_seconds"], 0.0)
        for name, most in (("T_xy", 1.0), ("T_z", 1.0), ("max_overlap", 0.1), ("psi6", 1.0)):
            self.assertTrue(0.0 < summary[name] < most, (name, summary[name]))
        self.assertEqual([set(rod) >= {"mean_speed", "net_turn"} for rod in summary["rods"]], [True])
        self.assertRegex(summary["state_hash"], "^[0-9a-f]{16}$")

    def test_the_cost(self):
        """All time belongs to some part, and what is said at the end is what stands in the file."""
        began = time.monotonic()
        done = self.dem("out", *setting(runs=2), "-j", 1)
        passed = time.monotonic() - began
        parts = ("start", "flight", "rods", "search", "impulses", "records", "measures", "output", "other")
        runs = [self.summary(f"out/runs/000{k}") for k in (1, 2)]
        both = self.summary("out")["cost"]
        for run in runs:
            cost = run["cost"]
            self.assertEqual(cost["particle_steps"], (run["beads"] + 12) * round(0.22 / run["time_step"]))
            self.assertGreater(min(cost[name] for name in parts if name != "measures"), 0.0)
            self.assertEqual(cost["measures"], 0.0)
            # what is timed by itself takes less than the run, and little of the run is left out
            self.assertGreater(sum(cost[name] for name in parts), 0.95 * run["wall_seconds"])
            self.assertAlmostEqual(cost["particle_steps_per_second"] * sum(cost[name] for name in parts[1:]), cost["particle_steps"],
                                   delta=1e-12 * cost["particle_steps"])
        for name in (*parts, "particle_steps"):
            self.assertEqual(both[name], sum(run["cost"][name] for run in runs))
        self.assertLess(sum(both[name] for name in parts), passed)
        log = self.out("out", "log.txt").read_text()
        self.assertNotIn("cost", done.stderr)
        rate = float(re.search(r"debug: dem: cost .* of wall clock summed over 2 runs, (\S+) particle steps a second", log)[1])
        self.assertAlmostEqual(rate / both["particle_steps_per_second"], 1.0, delta=0.01)  # three digits
        lines = {line.split("  ")[0] for line in re.findall(r"debug:  +(.*%)$", log, re.M)}
        for words in ("flight, bounces off the plates", "motion of the rods", "search for contacts", "impulses between pairs",
                      "samples, rows of the table"):
            self.assertIn(words, lines)
        self.assertNotIn("measures", lines)

    def test_tables(self):
        self.dem("out")
        table, tracks = columns(self.out("out", "table.csv")), columns(self.out("out", "tracks.csv"))
        self.assertEqual(list(table), ["t", "energy", "kinetic", "T_xy", "T_z", "psi6", "contacts", "floor_impulse",
                                       "lid_impulse", "max_overlap", "p_xx", "p_xy", "p_yy"])
        self.assertEqual(list(tracks), ["t", "x0", "y0", "z0", "theta0", "pitch0", "speed0", "pushed0"])
        # Rows at whole multiples of 5 ms from -20 ms to 200 ms: 200 steps before t = 0, 2000 after, every 50.
        self.assertEqual(table["t"], [50 * i * 1e-4 for i in range(-4, 41)])
        self.assertEqual(tracks["t"], table["t"])
        self.assertEqual((tracks["x0"][0], tracks["y0"][0], tracks["theta0"][0]), (8 * A, 8 * A, 0.0))
        self.assertEqual(table["max_overlap"][-1], self.summary("out")["max_overlap"])
        # Rows count the same impulses as the summary, and the same samples but the first.
        pressure = self.summary("out")["pressure"]
        for name in ("xx", "yy"):
            rows = [p for t, p in zip(table["t"], table[f"p_{name}"]) if t > 0.0]
            self.assertAlmostEqual(sum(rows) / len(rows) / pressure[name], 1.0, delta=0.01)
        self.assertEqual(pressure["mean"], (pressure["xx"] + pressure["yy"]) / 2)
        # Speeds are means between rows, so from t = 0 on their mean is that of the run, to roundings of 41 numbers.
        speeds = [s for t, s in zip(tracks["t"], tracks["speed0"]) if t > 0.0]
        self.assertAlmostEqual(sum(speeds) / len(speeds), self.summary("out")["rods"][0]["mean_speed"],
                               delta=1e-14 * sum(map(abs, speeds)))
        self.assertAlmostEqual(tracks["theta0"][-1] - tracks["theta0"][4], self.summary("out")["rods"][0]["net_turn"], delta=1e-15)

    def test_frames(self):
        self.dem("out", *setting(output__formats='["xyz", "h5md"]'))
        beads = self.summary("out")["beads"]
        with h5py.File(self.out("out", "trajectory.h5md")) as file:
            position = file["/particles/trajectory/position"]
            # a frame every 100 steps from t = 0 to 0.2 s; 12 spheres make the rod
            self.assertEqual(position["value"].shape, (21, beads + 12, 3))
            self.assertEqual(list(position["time"]), [100 * i * 1e-4 for i in range(21)])
        lines = self.out("out", "trajectory.xyz").read_text().splitlines()
        self.assertEqual(len(lines), 21 * (beads + 12 + 2))
        self.assertEqual([float(re.search(r"[Tt]ime=(\S+)", lines[i])[1]) for i in range(1, len(lines), beads + 14)],
                         [100 * i * 1e-4 for i in range(21)])
        with h5py.File(self.out("out", "last_period.h5md")) as file:
            times = file["/particles/trajectory/position/time"][()]
        self.assertEqual((len(times), times[0], times[-1]), (51, 1950 * 1e-4, 0.2))  # a period is 50 steps, a frame each

    def test_frames_of_some_beads(self):
        """Beads 0, 7, 14, ... and the rod are those of the frames of all; the run does not notice. What needs all says so."""
        formats = setting(output__formats='["xyz", "h5md"]', duration=0.02, output__frames=0.01)
        self.dem("all", *formats)
        self.dem("some", *formats, *setting(output__every_bead=7))
        self.assertEqual(self.hash("some"), self.hash("all"))
        beads = self.summary("all")["beads"]
        kept = [*range(0, beads, 7), *range(beads, beads + 12)]
        for name in ("trajectory.h5md", "last_period.h5md"):
            with h5py.File(self.out("all", name)) as whole, h5py.File(self.out("some", name)) as part:
                for what in ("position", "velocity"):
                    numpy.testing.assert_array_equal(part[f"/particles/trajectory/{what}/value"],
                                                     whole[f"/particles/trajectory/{what}/value"][:, kept])
                self.assertEqual(list(part["/particles/trajectory/id/value"][()].ravel()[:len(kept)]), kept)
        lines = self.out("some", "trajectory.xyz").read_text().splitlines()
        self.assertEqual(len(lines), 3 * (len(kept) + 2))
        measured = ("measure", "bed.toml", "-o", "some", "-s", "measure.order=true", *formats, *setting(output__every_bead=7))
        self.assertIn("measure while it runs", self.expect(2, *measured).stderr)
        self.assertIn("granular.output.every_bead = 1", self.expect(
            2, "check", SCENES / "granular_quick.toml", *setting(output__every_bead=2)).stderr)

    def test_formats_that_are_not_wanted(self):
        self.dem("xyz", *setting(output__formats='["xyz"]', output__last_period="false"))
        self.assertEqual(self.names("xyz"), FINAL - {"trajectory.h5md", "last_period.h5md"})
        self.dem("none", *setting(output__formats="[]"))
        self.assertEqual(self.names("none"), FINAL - {"trajectory.h5md", "trajectory.xyz"})
        self.dem("h5md", *setting(output__formats='["h5md"]'))
        self.assertEqual(self.names("h5md"), FINAL - {"trajectory.xyz"})
        self.dem("beads", *BEADS_ONLY)
        self.assertEqual(self.names("beads"), FINAL - {"tracks.csv"})
        self.assertEqual(self.hash("xyz"), self.hash("none"))  # what is looked at changes nothing

    def test_the_file_of_frames_tells_what_it_holds(self):
        self.dem("out", *SHORT)
        text = self.expect(0, "info", "out/trajectory.h5md").stdout
        self.assertIn("particles/trajectory/position", text)
        self.assertIn("finished run", self.expect(0, "info", "out").stdout)

    def test_run_draws(self):
        self.expect(0, "run", SCENES / "granular_quick.toml", "-o", "out", "--quiet", *setting(duration=0.1, equilibrate=0),
                    "-s", 'figures=[{name="bed",kind="snapshot"}]')
        self.assertLessEqual(FINAL | {"report.html"}, self.names("out"))
        self.assertEqual({p.stem for p in (self.folder / "out/figures").glob("*.png")}, {"bed"})

    def test_quiet_and_dry(self):
        done = self.dem("out", "--quiet", *SHORT)
        self.assertEqual((done.stdout, done.stderr), ("", ""))
        before = snapshot(self.folder)
        self.assertIn("beads of radius", self.expect(0, "dem", "bed.toml", "--dry-run").stdout)
        self.assertEqual(snapshot(self.folder), before)

    def test_check_says_what_is_run(self):
        checked = self.expect(0, "check", "bed.toml").stdout
        self.dem("out")
        self.assertEqual(int(re.search(r"(\d+) beads of radius", checked)[1]), self.summary("out")["beads"])
        self.assertIn(f"phi_b = 0.7 with the rods' shadows, of which the beads cover {self.summary('out')['beads_fraction']:.4f}", checked)
        self.assertEqual(self.summary("out")["phi_b"], 0.7)  # as asked, to the bit
        self.assertAlmostEqual(self.summary("out")["beads_fraction"], self.summary("out")["beads"] * math.pi / 16**2, delta=1e-12)
        self.assertIn("a table of 41 rows", checked)  # from t = 0 on
        self.assertIn("21 frames of", checked)


class SameTest(BedTest):
    def test_seeds(self):
        self.dem("one", *SHORT)
        self.dem("again", *SHORT)
        self.assert_same("one", "again")
        self.dem("other", *SHORT, "--seed", "2")
        self.assertNotEqual(self.hash("other"), self.hash("one"))
        self.dem("key", *SHORT, *setting(seed=2))
        self.assertEqual(self.hash("key"), self.hash("other"))

    def test_differences_are_seen(self):
        self.dem("one", *SHORT)
        for name in ("table.csv", "tracks.csv", "trajectory.h5md", "last_period.h5md", "summary.json"):
            with self.subTest(name):
                shutil.copytree(self.folder / "one", self.folder / f"not_{name}")
                self.assert_same("one", f"not_{name}")
                self.change(self.out(f"not_{name}", name))
                with self.assertRaises(self.failureException):
                    self.assert_same("one", f"not_{name}")

    def change(self, file):
        if file.suffix == ".h5md":
            with h5py.File(file, "r+") as opened:
                value = opened["/particles/trajectory/position/value"]
                value[0, 0, 0] = numpy.nextafter(value[0, 0, 0], 1.0)
        elif file.suffix == ".json":
            file.write_text(re.sub(r'"state_hash": "(.)', lambda m: m[0][:-1] + ("0" if m[1] != "0" else "1"), file.read_text()))
        else:
            flip_byte(file)

    def ensemble(self, run, *arguments):
        """runs.csv without its column of CPU time, and the hash of all."""
        self.dem(run, *SHORT, *arguments)
        runs = columns(self.out(run, "runs.csv"))
        del runs["cpu_seconds"]
        return runs, self.hash(run)

    def test_ensembles_on_any_number_of_threads(self):
        one = self.ensemble("one", *setting(runs=3), "-j", 1)
        self.assertEqual(one[0]["run"], [1, 2, 3])
        self.assertEqual(len(set(one[0]["T_xy"])), 3)
        for threads in (2, 3):
            self.assertEqual(self.ensemble(f"on{threads}", *setting(runs=3), "-j", threads), one)
        # The number of a run is part of what is random: the first of an ensemble is the run alone.
        self.dem("alone", *SHORT)
        self.assert_same("alone", "one/runs/0001")
        self.assertEqual(self.summary("one/runs/0002")["run"], 2)
        self.assertNotEqual(self.hash("one/runs/0002"), self.hash("alone"))
        self.assertNotEqual(self.ensemble("less", *setting(runs=2))[1], one[1])

    def test_an_ensemble_grows(self):
        four = self.ensemble("four", *setting(runs=4))
        self.ensemble("grown", *setting(runs=2))
        record = json.loads(self.out("grown", "provenance.json").read_text())
        self.out("grown", "provenance.json").write_text(json.dumps({**record, "status": "interrupted"}))
        before = snapshot(self.folder / "grown/runs")
        self.assertEqual(self.ensemble("grown", *setting(runs=4)), four)
        after = snapshot(self.folder / "grown/runs")
        self.assertEqual({name: after.get(name) for name in before}, before)

    def test_one_run_on_threads(self):
        big = (*BEADS_ONLY, *setting(phi_b=0.785, box='"200 a"', equilibrate=0, duration=0.0015, output__frames=0.0005, output__table=0.0005))
        self.dem("one", *big, "-j", 1)
        self.assertEqual(self.summary("one")["beads"], round(0.785 * 200**2 / math.pi))
        self.dem("two", *big, "-j", 2)
        self.assert_same("one", "two")


class GuardTest(BedTest):
    def test_a_time_step_that_is_too_large(self):
        for rods in ([], BEADS_ONLY):
            done = self.dem("out", "--force", *rods, *setting(phi_b=0.8, time_step=5e-4), code=1)
            self.assertRegex(done.stderr, r"run 1: step \d+ \(t = .* s\): .*(bead|rod).*time_step.*too large; 0\.0005 s was used")
            self.assertEqual(self.status("out"), "failed")
            self.assertIn("table.csv", self.names("out"))
            self.assertNotIn("summary.json", self.names("out"))
            self.assert_finite("out")

    def test_in_an_ensemble(self):
        done = self.dem("out", *setting(phi_b=0.8, time_step=5e-4, runs=2), code=1)
        self.assertRegex(done.stderr, r"run 1: step (.|\n)*run 2: step ")


class ExtremesTest(BedTest):
    def refuse_bed(self, pattern, *arguments):
        self.refuse(2, pattern, "dem", "bed.toml", "-o", "out", *arguments)

    def test_what_cannot_be_is_refused_before_anything_is_written(self):
        self.write("full.toml", BED.replace("phi_b = 0.7", "beads = 80"))
        self.refuse(2, r"together .*; use fewer beads", "dem", "full.toml", "-o", "out")
        for pattern, keys in [(r"gap = .*bead diameter", {"plates__gap": 0.7e-3}), (r"phi_b = 0.95: must be", {"phi_b": 0.95}),
                              (r"rod 0.*box", {"box": '"9 a"', "phi_b": 0.1, "count_rod_area": "false"}),
                              (r"bed\.toml|phi_bb|did you mean", {"phi_bb": 0.7}),
                              (r"no such checkpoint", {"start": '"restart"', "restart_from": '"nowhere/final.rwc"'})]:
            with self.subTest(keys):
                self.refuse_bed(pattern, *setting(**keys))

    def test_what_cannot_be_does_not_replace_a_run(self):
        self.dem("out", *SHORT)
        self.refuse_bed("gap", "--force", *setting(plates__gap=0.7e-3))
        self.refuse_bed("restart_from lies in out", "--force", *setting(start='"restart"', restart_from='"out/final.rwc"'))

    def test_one_bead(self):
        self.dem("out", *BEADS_ONLY, *setting(beads=1, phi_b=0.7), code=2)
        self.write("bed.toml", BED.replace("phi_b = 0.7", "beads = 1"))
        self.dem("out", *BEADS_ONLY)
        self.assertEqual(self.summary("out")["beads"], 1)
        self.assertEqual(self.summary("out")["T_xy"], 0.0)  # in the frame of the centre of mass
        self.assert_finite("out")

    def test_any_number_of_beads(self):
        """Also one more than the thousands that are moved together."""
        for beads in (2, 3, 2048, 2049, 2050):
            self.write("bed.toml", f"schema = 1\n[granular]\nbeads = {beads}\nbox = \"92 a\"\nequilibrate = 0\nduration = 2e-4\n")
            self.dem("out", "--force", "--quiet")
            self.assertEqual(self.summary("out")["beads"], beads)

    def test_no_beads(self):
        self.write("bed.toml", BED.replace("phi_b = 0.7", "beads = 0"))
        self.dem("out")
        self.assert_finite("out")

    def test_static_plates(self):
        self.dem("out", *setting(plates__gamma=0, duration=0.5, equilibrate=0))
        table = columns(self.out("out", "table.csv"))
        self.assertLess(table["T_z"][-1], 1e-6 * table["T_z"][0])
        self.assertLess(table["kinetic"][-1], 0.01 * table["kinetic"][0])  # what is left rolls: nothing stops that
        self.assert_finite("out")

    # The heading is read off an axis that is turned 11000 times by pitching: roundings add up like the sum.
    TURN = 2200 * 2.0**-53

    def test_an_absorbing_state_is_reported(self):
        """At Gamma = 7 and 150 Hz beads alone end up in step with the plates; at 200 Hz they move."""
        locked = setting(rods=[], plates__frequency='"150 Hz"', duration=0.4)
        self.assertRegex(self.dem("locked", *locked).stderr, "1 of 1 runs ended in an absorbing state")
        self.assertRegex((self.folder / "locked" / "log.txt").read_text(), r"absorbing state.*150 Hz.*gamma \(7\)")
        self.assertIs(self.summary("locked")["absorbing_state"], True)
        self.assertNotIn("absorbing", self.dem("moving", *setting(rods=[], duration=0.4)).stderr)
        self.assertIs(self.summary("moving")["absorbing_state"], False)
        self.dem("both", *locked, "-s", "granular.runs=2")
        self.assertEqual(self.summary("both")["absorbing_runs"], 2)

    def test_an_absorbing_state_is_seen_beside_a_rod_that_stirs(self):
        self.write("stirred.toml", 'schema = 1\n[granular]\nbeads = 300\nbox = "36 a"\nduration = "0.3 s"\n'
                   '[granular.plates]\ngap = "1.1 mm"\nfrequency = "50 Hz"\ngamma = 3.0\n[[granular.rods]]\nlength = "3.2 mm"\n'
                   'thick_diameter = "0.9 mm"\nthin_diameter = "0.6 mm"\nposition = ["10 a", "10 a"]\nimposed_speed = "0.01 m/s"\n'
                   "[measure]\norder = true\norder_interval = 0.03\nblock = 0.06\n[[figures]]\nname = \"bed\"\nkind = \"snapshot\"\n")
        done = self.expect(0, "run", "stirred.toml", "-o", "stirred")
        self.assertRegex(done.stderr, "1 of 1 runs ended in an absorbing state")
        order = json.loads((self.folder / "stirred/measure.json").read_text())["order"]
        self.assertEqual((order["class"], order["phase"]), ("undetermined", "undetermined"))
        self.assertIn("a bed that does not move has no phase", done.stderr)
        page = (self.folder / "stirred/report.html").read_text()
        self.assertRegex(page, r'<h2>Abstract</h2>\s*<p class="verdict"><strong>The bed does not move')

    def test_pinned(self):
        self.dem("out", *setting(rods__0__imposed_speed=0, rods__0__heading=0.4))
        track = columns(self.out("out", "tracks.csv"))
        for name in ("x0", "y0"):
            self.assertEqual(len(set(track[name])), 1, name)
        for heading in track["theta0"]:
            self.assertAlmostEqual(heading, 0.4, delta=self.TURN)
        self.assertEqual(self.summary("out")["rods"][0]["mean_speed"], 0.0)
        self.dem("free", *setting(rods__0__heading=0.4))  # which moves
        self.assertGreater(len(set(columns(self.out("free", "tracks.csv"))["x0"])), 1)

    def test_dragged(self):
        self.dem("out", *setting(rods__0__imposed_speed=1e-3))
        track = columns(self.out("out", "tracks.csv"))
        rounding = 2000 * 2.0**-53 * 16 * A  # of the sum over all steps
        for t, x, y, heading in zip(track["t"], track["x0"], track["y0"], track["theta0"]):
            self.assertAlmostEqual(x, 8 * A + 1e-3 * max(t, 0.0), delta=rounding)
            self.assertEqual(y, 8 * A)
            self.assertAlmostEqual(heading, 0.0, delta=self.TURN)
        self.assertAlmostEqual(self.summary("out")["rods"][0]["mean_speed"], 1e-3, delta=rounding / 0.2)

    def test_starts(self):
        self.dem("first")
        self.dem("restart", *SHORT, *setting(start='"restart"', restart_from='"first/final.rwc"', equilibrate=0))
        self.dem("random", *SHORT, *setting(start='"random"', equilibrate=0.01))
        self.dem("turned", *SHORT, *setting(orientation='"90 deg"'))
        self.dem("lattice", *SHORT)
        self.assertEqual(len({self.hash(run) for run in ("restart", "random", "turned", "lattice")}), 4)
        for run in ("restart", "random", "turned"):
            self.assert_finite(run)
        self.assertEqual(columns(self.out("restart", "table.csv"))["t"][0], 0.0)  # no equilibration

    def test_a_restart_from_a_bed_that_is_another_is_refused(self):
        self.dem("first", *SHORT)
        self.dem("bare", *SHORT, *BEADS_ONLY)
        start = setting(start='"restart"', restart_from='"first/final.rwc"')
        for keys, expected in (({"box": '"6.2 mm"'}, r"the box is 0\.0064 x 0\.0064 m there and 0\.0062 x 0\.0062 m in the scene"),
                           ({"box": '["6.4 mm", "6.6 mm"]'}, r"0\.0064 x 0\.0064 m there and 0\.0064 x 0\.0066 m in the scene"),
                           ({"box": '"6.4 mm"', "bead_radius": '"0.38 mm"'}, r"bead_radius is 0\.0004 m there and 0\.00038 m in the scene"),
                           ({"phi_b": 0.75}, r"their number is \d+ there and \d+ in the scene"),
                           ({"rods": "[]"}, "the number of rods is 1 there and 0 in the scene"),
                           ({"rods__0__length": '"4.4 mm"'}, r"a rod is 0\.0045 m long, .* there and 0\.0044 m long, .* in the scene"),
                           ({"rods__0__thin_diameter": '"0.7 mm"'}, r"0\.0008 m thick, .* there and .* 0\.0007 m thick")):
            self.refuse_bed(r"first/final\.rwc: granular\.start = \"restart\": .*" + expected, *SHORT, *start, *setting(**keys))
        bare = setting(start='"restart"', restart_from='"bare/final.rwc"')  # beads only: rods may be put in
        done = self.dem("less", *SHORT, *bare, *setting(phi_b=0.6))
        self.assertRegex(done.stderr, r"dem: \d+ of the \d+ beads of bare/final\.rwc are taken out")

    def test_what_is_gone_of_a_finished_bed_is_made_again(self):
        bed = (*SHORT, *setting(runs=2), "-s", "measure.order=true")
        self.dem("out", *bed)
        shutil.copytree(self.folder / "out", self.folder / "whole")
        for gone in (["runs.csv"], ["summary.json", "runs/0001/summary.json", "runs/0002/measure.rwc"], ["runs/0002/table.csv"],
                     ["runs/0001/trajectory.h5md", "runs/0001/final.rwc"]):
            for name in gone:
                self.out("out", name).unlink()
            self.assertRegex(self.dem("out", *bed).stderr, "granular: .* gone; made again")
            self.assertEqual(self.names("out"), self.names("whole"))
            for run in ("/runs/0001", "/runs/0002"):
                self.assert_same("out" + run, "whole" + run)
                self.assertEqual(*(self.out(top + run, "measure.rwc").read_bytes() for top in ("out", "whole")))
                record = [{key: value for key, value in self.summary(top + run).items() if key not in ("cost", "cpu_seconds", "wall_seconds")}
                        for top in ("out", "whole")]
                self.assertEqual(*record)
        self.refuse(0, "holds a finished run", "dem", "bed.toml", "-o", "out", *bed)

    def test_a_damaged_restart(self):
        self.dem("first", *SHORT)
        flip_byte(self.out("first", "final.rwc"))
        self.refuse_bed(r"first/final\.rwc", *setting(start='"restart"', restart_from='"first/final.rwc"'))


if __name__ == "__main__":
    rodwake.main()
