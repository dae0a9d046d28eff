"""rodwake measure: the same numbers from the running bed and from its frames, equal to a computation of their own, and clear
words where there is nothing to measure."""

import csv
import json
import shutil
import signal

import h5py
import numpy as np
import rodwake
from beds import columns
from rodwake import ProgramTest, wait_until

BED = """schema = 1
[granular]
phi_b = 0.80
box = "32 a"
equilibrate = "0.05 s"
duration = "1 s"
[granular.output]
frames = "0.025 s"
last_period = false
[[granular.rods]]
position = ["16 a", "16 a"]
[measure]
order = true
order_interval = "0.05 s"
order_cutoff = "2.9 a"
microrheology = true
flow = true
flow_lag = "0.05 s"
displacement = "phase"
force = true
block = "0.25 s"
"""
A = 0.4e-3
FILES = {"measure.json", "measure.h5", "gr.csv", "gB.csv", "msd.csv", "stiffness.csv", "memory_kernel.csv",
         "marked.csv", "displacement.vti", "flow.vti", "profile_Ux_x.csv",
         "profile_Ux_y.csv", "profile_Uy_x.csv", "profile_Uy_y.csv"}


def read(file):
    """A CSV file by column; comment lines skipped, empty fields NaN."""
    lines = [line for line in file.read_text().splitlines() if not line.startswith("#")]
    rows = list(csv.DictReader(lines))
    return {name: np.array([float(row[name] or "nan") for row in rows]) for name in rows[0]}


def datasets(file):
    found = {}
    with h5py.File(file) as opened:
        opened.visititems(lambda name, item: found.update({name: item[()].tobytes()}) if isinstance(item, h5py.Dataset) else None)
    return found


class Trajectory:
    def __init__(self, file):
        with h5py.File(file) as opened:
            beads = int(np.sum(opened["particles/trajectory/species"][...] == 0))
            spheres = opened["particles/trajectory"]
            self.box = spheres["box/edges/value"][0][0, 0]
            self.t = spheres["position/time"][...]
            self.place = spheres["position/value"][:, :beads, :2]
            self.free = self.place + self.box * spheres["image/value"][:, :beads, :2]


class MeasureTest(ProgramTest):
    def setUp(self):
        super().setUp()
        self.write("bed.toml", BED)

    def made(self, run="run", *arguments):
        return self.made_once(run, "dem", "bed.toml", "--quiet", *arguments)

    def measured(self, run="run", *arguments):
        self.expect(0, "measure", "bed.toml", "-o", run, "--quiet", *arguments)
        return json.loads((self.folder / run / "measure.json").read_text())

    def assert_same(self, one, other):
        """Every measured file, to the bit; measure.json but for who made it."""
        for name in FILES:
            ours, theirs = self.folder / one / name, self.folder / other / name
            if name == "measure.json":
                ours, theirs = (json.loads(path.read_text()) for path in (ours, theirs))
                ours.pop("provenance"), theirs.pop("provenance")
                self.assertEqual(ours, theirs)
            elif name == "measure.h5":
                self.assertEqual(datasets(ours), datasets(theirs))
            else:
                self.assertEqual(ours.read_bytes(), theirs.read_bytes(), name)


class SameBitsTest(MeasureTest):
    def test_streaming_and_offline(self):
        run = self.made()
        self.measured()
        self.assertTrue(FILES <= {path.name for path in run.iterdir()})
        shutil.copytree(run, self.folder / "offline")
        (self.folder / "offline/measure.rwc").unlink()
        self.measured("offline", "--force")
        self.assert_same("run", "offline")
        with self.assertRaises(AssertionError):  # the comparison sees a difference
            self.measured("offline", "--force", "-s", "measure.order_cutoff=2.5 a")
            self.assert_same("run", "offline")

    def test_interrupted_run(self):
        long = ("-s", "granular.duration=6 s", "-s", "granular.output.checkpoint=0.05")
        self.made("whole", *long)
        self.measured("whole", *long)
        with self.started("dem", "bed.toml", "-o", "cut", "--quiet", *long) as process:
            self.assertTrue(wait_until((self.folder / "cut/checkpoint.rwc").exists, 30))
            self.stop(process, signal.SIGTERM, 5.0)
        self.expect(0, "dem", "bed.toml", "-o", "cut", "--quiet", *long)
        self.measured("cut", *long)
        self.assert_same("whole", "cut")

    def test_run_is_dem_and_measure(self):
        self.made()
        self.measured()
        self.expect(0, "run", "bed.toml", "-o", "all", "--quiet", "--no-figures")
        self.assert_same("run", "all")
        self.assertEqual(self.status("all"), "finished")

    def test_trajectory_elsewhere(self):
        run = self.made()
        self.measured()
        keys = ("-s", f"measure.trajectory={run / 'trajectory.h5md'}", "-s", "measure.force=false")
        self.expect(0, "measure", "bed.toml", "-o", "other", "--quiet", *keys)
        self.assertEqual((run / "gB.csv").read_bytes(), (self.folder / "other/gB.csv").read_bytes())
        self.assertEqual(self.status("other"), "finished")

    def test_threads(self):
        for run, threads in (("one", 1), ("two", 2)):
            self.made(run, "-s", "granular.runs=3", "-j", threads)
            self.measured(run, "-s", "granular.runs=3", "-j", threads)
        self.assert_same("one", "two")


class NumbersTest(MeasureTest):
    """Against NumPy, on the stored frames: 1e-12 relative to the largest value allows for another order of sums."""

    def setUp(self):
        super().setUp()
        self.run_folder = self.made()
        self.found = self.measured()
        self.trajectory = Trajectory(self.run_folder / "trajectory.h5md")

    def close(self, ours, theirs, tolerance=1e-12):
        ours, theirs = np.asarray(ours, dtype=float), np.asarray(theirs, dtype=float)
        self.assertEqual(ours.shape, theirs.shape)
        self.assertLessEqual(np.max(np.abs(ours - theirs)), tolerance * np.max(np.abs(theirs)))

    def pairs(self, places):
        apart = places[None, :, :] - places[:, None, :]
        return apart - self.trajectory.box * np.round(apart / self.trajectory.box)

    def test_order(self):
        frames = self.trajectory.place[::2]
        self.assertGreaterEqual(len(frames), 20)
        box, count = self.trajectory.box, frames.shape[1]
        bins, wide = read(self.run_folder / "gr.csv"), read(self.run_folder / "gB.csv")
        edges = np.arange(len(bins["r"]) + 1) * 0.05 * A
        histogram, total, weight, psi6 = 0, 0, 0, []
        for places in frames:
            apart = self.pairs(places)
            r = np.hypot(apart[..., 0], apart[..., 1])
            bond = np.exp(6j * np.arctan2(apart[..., 1], apart[..., 0]))
            near = (r < 2.9 * A) & (r > 0)
            local = np.where(near, bond, 0).sum(1) / np.maximum(near.sum(1), 1)
            psi6.append(abs(local.mean()))
            upper = np.triu_indices(count, 1)
            histogram = histogram + np.histogram(r[upper], edges)[0]
            product = (np.conj(local)[:, None] * local[None, :]).real[upper]
            k = np.floor(r[upper] / A).astype(int)
            inside = k < 1000
            total = total + np.bincount(k[inside], minlength=100)
            weight = weight + np.bincount(k[inside], product[inside], minlength=100)
        area = np.pi * (edges[1:] ** 2 - edges[:-1] ** 2)
        ideal = len(frames) * count * (count - 1) / 2 * area / box**2
        self.close(bins["g"], histogram / ideal)
        self.close(self.found["order"]["psi6"]["value"], np.mean(psi6))
        k = np.floor(wide["r"]).astype(int)
        self.close(wide["pairs"], total[k])
        self.close(wide["gB"], weight[k] / total[k])

    def test_mean_square_displacement(self):
        free = self.trajectory.free - self.trajectory.free.mean(1, keepdims=True)
        msd = read(self.run_folder / "msd.csv")
        interval = self.trajectory.t[1]
        for lag, value, origins in zip(msd["lag"], msd["msd"], msd["origins"]):
            k = round(lag / interval)
            if k > 16:  # later octaves take every second frame
                continue
            self.close(value * A**2, np.mean(np.sum((free[k:] - free[:-k]) ** 2, axis=2)))
            self.assertEqual(origins, len(free) - k)

    def test_spacings(self):
        """That of the lattice is the beads', that of the grid the scene's, 1 a."""
        found, count = self.found["displacement"], self.trajectory.place.shape[1]
        self.assertEqual(found["spacing"], 1.0)
        # The lattice closes in the box, so its sites are a whole number to rounding: those of the beads and of what the rod displaces.
        sites = 2 / np.sqrt(3) * (self.trajectory.box / A / found["lattice_spacing"]) ** 2
        self.assertLess(abs(sites - round(sites)), 1e-9 * sites)
        self.assertTrue(count < sites < 1.1 * count, (sites, count))

    def test_units_and_errors(self):
        with h5py.File(self.run_folder / "measure.h5") as opened:
            self.assertEqual(opened["displacement/Ux"].attrs["unit"], b"a")
            for group in ("displacement", "flow"):
                for values in opened[group].values():
                    self.assertTrue(np.all(np.isfinite(values[...])))
        for name in FILES:
            if name.endswith(".csv"):
                columns = read(self.run_folder / name)
                if name == "memory_kernel.csv":  # no measure.bead_drag was given
                    self.assertTrue(np.all(np.isnan([columns.pop("kernel"), columns.pop("kernel_error")])))
                self.assertTrue(all(np.all(np.isfinite(values)) for values in columns.values()), name)
        self.assertIsNone(self.found["force"]["force"]["error"])  # one run: not known, not zero
        summary = json.loads((self.run_folder / "summary.json").read_text())
        self.assertEqual(self.found["phi_b"], summary["phi_b"])
        self.assertAlmostEqual(self.found["force"]["speed"]["value"] * A, summary["rods"][0]["mean_speed"], delta=1e-12)  # of some mm/s
        units = {value["name"]: value["unit"] for value in json.loads((self.run_folder / "manifest.json").read_text())["files"]["measure.json"]["values"]}
        self.assertEqual([units[name] for name in ("force.speed", "force.force", "microrheology.spring", "microrheology.stiffness", "order.psi6")],
                         ["a/s", "N", "N/m", "a^-2", "1"])


class ManyCasesTest(MeasureTest):
    def test_variants(self):
        self.write("bed.toml", BED + '[[variants]]\nname = "loose"\nset = { "granular.phi_b" = 0.6 }\n'
                   '[[variants]]\nname = "wide"\nset = { "granular.runs" = 2 }\n')
        keys = ("-s", "measure.displacement=none")
        self.made("run", *keys)
        self.measured("run", *keys)
        series = read_text(self.folder / "run/series.csv")
        self.assertEqual([row["name"] for row in series], ["scene", "loose", "wide"])
        self.assertEqual([row["phi_b"] for row in series], ["0.80000000000000004", "0.59999999999999998", "0.80000000000000004"])
        self.assertEqual([row["runs"] for row in series], ["1", "1", "2"])
        self.assertEqual(series[0]["delta_y"], "")
        self.assertLess(float(series[1]["psi6"]), float(series[0]["psi6"]))
        for case in ("variants/loose", "variants/wide"):
            self.assertTrue((self.folder / "run" / case / "measure.json").is_file())

    def test_pairs(self):
        self.write("bed.toml", BED.replace('position = ["16 a", "16 a"]', 'position = ["8 a", "10 a"]\n'
                   '[[granular.rods]]\nposition = ["8 a", "22 a"]'))
        keys = ("-s", "measure.displacement=none", "-s", "measure.pairs=true", "-s", "granular.runs=2")
        run = self.made("run", *keys)
        pairs = self.measured("run", *keys)["pairs"]
        self.assertEqual(pairs["not_there"], 2)
        self.assertEqual(pairs["contact"] + pairs["pursuit"] + pairs["escape"] + pairs["undecided"], 2)
        rows = read(run / "pairs.csv")
        self.assertTrue(np.all(np.isnan(rows["half_box_change"])))
        last = columns(run / "runs/0001/tracks.csv")
        change = abs(last["y0"][-1] - last["y1"][-1]) - abs(last["y0"][0] - last["y1"][0])
        self.assertAlmostEqual(rows["last_change"][0], change / A, places=6)

    def test_pairs_as_the_run_sees_them(self):
        """The run follows a pair every 7 steps, the tracks have a row every 0.01 s: half a box apart by one row at most. The rods
        stand beside each other across the edge of the box."""
        self.write("bed.toml", BED.replace("32 a", "24 a").replace('position = ["16 a", "16 a"]', 'position = ["8 a", "22 a"]\n'
                   '[[granular.rods]]\nposition = ["8 a", "6 a"]'))
        keys = ("-s", "measure.displacement=none", "-s", "measure.pairs=true", "-s", "granular.runs=2", "-s", "granular.duration=9 s", "-s", "granular.stop_at_travel=12 a",
                "-s", "granular.output.formats=[]")
        run = self.made("run", *keys, "-j", 2)
        self.measured("run", *keys)
        ours, theirs = read(run / "pairs.csv"), read(run / "runs.csv")
        self.assertTrue(np.all(theirs["half_box_time"] > 0))
        self.assertLess(np.max(np.abs(ours["half_box_change"] - theirs["half_box_separation_change"] / A)), 0.1)
        self.assertAlmostEqual(ours["separation"][0], 8.0, places=1)


def read_text(file):
    lines = [line for line in file.read_text().splitlines() if not line.startswith("#")]
    return list(csv.DictReader(lines))


class RefusalTest(MeasureTest):
    def test_nothing_to_measure(self):
        self.refuse(2, "holds no rodwake run; rodwake dem SCENE makes one", "measure", "bed.toml", "-o", "run")
        self.write("none.toml", BED[:BED.index("[measure]")])
        self.refuse(2, r"no \[measure\] table", "measure", "none.toml", "-o", "run")
        self.refuse(2, "no such file|cannot be opened", "measure", "bed.toml", "-o", "new", "-s",
                    "measure.trajectory=missing.h5md", "-s", "measure.force=false")

    def test_measured_already(self):
        self.made()
        self.measured()
        self.refuse(0, "holds a finished run .* --force", "measure", "bed.toml", "-o", "run")

    def test_another_bed(self):
        self.made()
        self.refuse(2, "belongs to another scene .*phi_b", "measure", "bed.toml", "-o", "run", "-s", "granular.phi_b=0.7")
        trajectory = f"measure.trajectory={self.folder / 'run/trajectory.h5md'}"
        for key, words in (("granular.box=31 a", "side of the box"), ("granular.phi_b=0.7", "number of beads"),
                           ("granular.bead_radius=0.41 mm", "side of the box")):
            self.refuse(2, words + ".*another bed", "measure", "bed.toml", "-o", "other", "-s", trajectory, "-s", key)

    def test_frames_that_do_not_fit(self):
        run = self.made()
        (run / "measure.rwc").unlink()
        done = self.expect(2, "measure", "bed.toml", "-o", "run", "--quiet", "-s", "measure.interval=0.04 s",
                           "-s", "measure.order_interval=0.04 s", "-s", "measure.microrheology=false")
        self.assertRegex(done.stderr, "frames are 0.025 s apart; measure.interval = 0.04 s is no whole multiple")

    def test_other_keys_without_a_trajectory(self):
        self.made("run", "-s", "granular.output.formats=[]")
        done = self.expect(2, "measure", "bed.toml", "-o", "run", "-s", "granular.output.formats=[]", "-s",
                           "measure.order_cutoff=2.5 a")
        self.assertRegex(done.stderr, "stored no trajectory")

    def test_force_keeps_what_is_there_until_the_new_keys_can_be_measured(self):
        run = self.made("run", "-s", "granular.output.formats=[]")
        self.measured("run", "-s", "granular.output.formats=[]")
        done = self.expect(2, "measure", "bed.toml", "-o", "run", "--force", "-s", "granular.output.formats=[]", "-s",
                           "measure.order_cutoff=2.5 a")
        self.assertRegex(done.stderr, "stored no trajectory")
        self.assertTrue((run / "measure.json").exists())
        self.measured("run", "--force", "-s", "granular.output.formats=[]")

    def test_a_distance_that_the_rod_does_not_come(self):
        far = ("-s", "measure.from=1000 a")
        self.made("stored")
        self.made("recorded", *far)
        message = "no frame to measure: the rod travels less than measure.from = 1000 a; run longer"
        self.assertIn("trajectory.h5md: " + message, self.expect(2, "measure", "bed.toml", "-o", "stored", "--quiet", *far).stderr)
        self.assertIn("order: " + message, self.expect(1, "measure", "bed.toml", "-o", "recorded", "--quiet", *far).stderr)
        found = json.loads((self.folder / "recorded/measure.json").read_text())
        self.assertIn("force", found)  # what needs no frames is kept
        self.assertIn(message, found["not_measured"]["order"])

    def test_truncated(self):
        run = self.made()
        (run / "measure.rwc").unlink()
        whole = (run / "trajectory.h5md").read_bytes()
        for part in (0.0, 0.3, 0.9):
            (run / "trajectory.h5md").write_bytes(whole[:int(part * len(whole))])
            done = self.expect(2, "measure", "bed.toml", "-o", "run", "--quiet")
            self.assertRegex(done.stderr, "trajectory.h5md")
            self.assertFalse((run / "measure.json").exists())

    def test_damaged_records(self):
        run = self.made()
        data = bytearray((run / "measure.rwc").read_bytes())
        data[len(data) // 2] ^= 1
        (run / "measure.rwc").write_bytes(bytes(data))
        done = self.expect(2, "measure", "bed.toml", "-o", "run", "--quiet")
        self.assertRegex(done.stderr, "measure.rwc: .*damaged")

    def test_one_frame(self):
        keys = ("-s", "granular.output.frames=1 s", "-s", "granular.duration=0.5 s", "-s", "measure.order_interval=1 s",
                "-s", "measure.block=1 s")
        self.refuse(2, "microrheology needs at least 32 frames, and there are 1", "dem", "bed.toml", "-o", "run", *keys)
        keys = (*keys, "-s", "measure.microrheology=false")
        self.made("run", *keys)
        done = self.expect(1, "measure", "bed.toml", "-o", "run", "--quiet", *keys)
        self.assertIn("measure: flow: ", done.stderr)
        found = json.loads((self.folder / "run/measure.json").read_text())
        self.assertIn("flow", found["not_measured"])  # with its reason; the others are there
        self.assertNotIn("flow", found)
        self.assertIsNone(found["order"]["psi6"]["error"])
        self.assertEqual(found["order"]["psi6"]["samples"], 1)
        self.assertIsNone(found["order"]["exponent"]["value"])
        self.assertTrue(np.all(np.isnan(read(self.folder / "run/gB.csv")["sigma"])))

    def test_no_crystal(self):
        keys = ("-s", "granular.phi_b=0.4")
        done = self.expect(1, "run", "bed.toml", "-o", "run", "--quiet", "--no-figures", *keys)
        self.assertRegex(done.stderr, "measure: displacement: .*crystal")
        found = json.loads((self.folder / "run/measure.json").read_text())
        self.assertEqual(set(found["not_measured"]), {"displacement"})
        self.assertTrue({"order", "microrheology", "flow", "force"} <= set(found))
        self.assertFalse((self.folder / "run/profile_Ux_x.csv").exists())

    def test_other_keys_leave_nothing_old(self):
        run = self.made()
        self.measured()
        self.measured("run", "--force", "-s", "measure.order=false", "-s", "measure.displacement=none")
        names = {path.name for path in run.iterdir()}
        self.assertFalse({"gr.csv", "profile_Ux_x.csv", "displacement.vti"} & names)
        self.assertIn("flow.vti", names)

    def test_what_is_decided_when_runs_are_put_together_needs_no_frames(self):
        keys = ("-s", "granular.output.formats=[]")
        self.made("run", *keys)
        one = self.measured("run", *keys)
        two = self.measured("run", "--force", *keys, "-s", "measure.mirror=true", "-s", "measure.reference=far")
        self.assertEqual((one["displacement"]["reference"], two["displacement"]["reference"]), ("box", "far"))


if __name__ == "__main__":
    rodwake.main()
