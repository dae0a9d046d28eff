"""medium.field = "dynamic" through the program: results, the same bytes resumed and on more threads, what is refused."""

import json
import signal

import h5py
import numpy as np

import rodwake
from rodwake import ProgramTest, wait_until

SCENE = """schema = 1
[medium]
eta = 1.0
alpha = 1.0
field = "dynamic"
[medium.dynamic]
box = 16.0
force_width = 0.6
modes = 30
[coupling]
kappa = 10.0
[[rods]]
position = [0.0, 2.0]
[[rods]]
position = [0.0, -2.0]
[rods_run]
t_end = 20.0
output_interval = 1.0
contact_distance = 0.6
"""
RESULTS = ("rods.csv", "outcome.json")
LONG = "-s", "medium.dynamic.modes=60", "-s", "rods_run.rtol=1e-12", "-s", "rods_run.contact_distance=0.05"


class DynamicTest(ProgramTest):
    def setUp(self):
        super().setUp()
        self.write("pair.toml", SCENE)

    def results(self, run):
        return {name: (self.folder / run / name).read_bytes() for name in RESULTS}

    def outcome(self, run):
        return json.loads((self.folder / run / "outcome.json").read_text())

    def rods(self, run, *options):
        return self.expect(0, "rods", "pair.toml", "-o", run, *options)

    def test_memory_delays_a_meeting_and_threads_change_no_byte(self):
        self.rods("one", "-j", "1")
        self.rods("two", "-j", "2")
        self.assertEqual(self.results("one"), self.results("two"))
        self.assertEqual([self.outcome("one")["solver"][key] for key in ("method", "evaluation")], ["etdrk4", "sums"])
        self.rods("steady", "-s", "medium.field=exact", "-s", "medium.periodic=16")
        self.assertEqual([self.outcome(run)["outcome"] for run in ("one", "steady")], ["contact", "contact"])
        self.assertNotAlmostEqual(self.outcome("one")["time"], self.outcome("steady")["time"], delta=0.05)

    def test_the_steady_closure_runs_rods_without_the_medium(self):
        closed = "-s", "medium.dynamic.closure=steady"
        self.rods("memory")
        self.rods("steady", *closed)
        self.rods("threads", *closed, "-j", "2")
        self.assertEqual(self.results("steady"), self.results("threads"))
        outcome = self.outcome("steady")
        self.assertEqual((outcome["outcome"], outcome["solver"]["method"]), ("contact", "erk"))
        self.assertNotAlmostEqual(outcome["time"], self.outcome("memory")["time"], delta=0.01)
        self.assertIn("medium without memory: 30 x 30 modes", self.expect(0, "check", "pair.toml", *closed).stdout)

    def test_resumed_to_the_byte(self):
        self.rods("whole", *LONG)
        checkpoint = self.folder / "out/rods_checkpoint.rwc"
        with self.started("rods", "pair.toml", *LONG, "-o", "out", "--quiet") as process:
            wait_until(lambda: (self.folder / "out/provenance.json").exists() or process.poll() is not None, 60)
            self.assertIsNone(process.poll(), "the run ended before it could be stopped")
            self.stop(process, signal.SIGTERM, 10.0)
        self.assertTrue(checkpoint.exists())
        done = self.rods("out", *LONG)
        self.assertIn("resuming from the checkpoint at t = ", done.stderr)
        self.assertEqual(self.results("out"), self.results("whole"))

    def test_a_later_end_goes_on(self):
        rows = {}
        self.rods("out", "-s", "rods_run.t_end=1", "-s", "rods_run.output_interval=0.25")
        for run in ("out", "whole"):
            done = self.rods(run, "-s", "rods_run.t_end=2", "-s", "rods_run.output_interval=0.25")
            self.assertEqual("going on from the end of the earlier run at t = 1" in done.stderr, run == "out")
            rows[run] = np.loadtxt(self.folder / run / "rods.csv", delimiter=",", skiprows=1)
        np.testing.assert_allclose(rows["out"], rows["whole"], rtol=0, atol=1e-6)

    def film(self, run):
        with h5py.File(self.folder / run / "medium_film.h5", "r") as file:
            return {name: file[name][()] for name in ("t", "x", "y", "ux", "uy", "rods/x", "rods/y", "rods/theta")}

    def assert_same_film(self, one, other):
        for name, values in self.film(one).items():
            np.testing.assert_array_equal(values, self.film(other)[name], name)

    def test_a_film_is_stored_and_changes_no_byte_of_the_rods(self):
        film = "-s", "medium.dynamic.film_interval=0.5", "-s", "medium.dynamic.film_grid=32", "-s", "rods_run.t_end=2"
        self.rods("filmed", "-j", "1", *film)
        self.rods("threads", "-j", "2", *film)
        self.rods("plain", "-s", "rods_run.t_end=2")
        self.assertEqual(self.results("filmed"), self.results("plain"))
        self.assert_same_film("filmed", "threads")
        frames = self.film("filmed")
        np.testing.assert_allclose(frames["t"], [0, 0.5, 1, 1.5, 2], rtol=0, atol=1e-15)
        self.assertEqual(frames["ux"].shape, (5, 32, 32))
        self.assertEqual((frames["x"][0], frames["x"][1]), (-8.0, -7.5))
        # where a rod pushes along x the medium goes along x: the largest is near a rod
        _, row, column = np.unravel_index(np.abs(frames["ux"]).argmax(), frames["ux"].shape)
        self.assertLess(abs(abs(frames["y"][row]) - 2.0), 0.6)
        self.assertFalse((self.folder / "filmed/medium_film.log").exists())
        manifest = json.loads((self.folder / "filmed/manifest.json").read_text())["files"]
        self.assertIn("the sum of the fields of all rods", manifest["medium_film.h5"]["what"])
        with h5py.File(self.folder / "filmed/medium_film.h5", "r") as file:
            self.assertIn("rods pair.toml", file.attrs["command"].decode() if isinstance(file.attrs["command"], bytes) else file.attrs["command"])
            self.assertEqual(file["ux"].attrs["unit"], file["x"].attrs["unit"])
        output = self.expect(0, "check", "pair.toml", *film).stdout
        self.assertIn("film of the medium: 5 frames of 32 x 32 points, 82.2 kB in medium_film.h5", output)

    def test_the_film_of_a_resumed_run_is_the_same(self):
        film = *LONG, "-s", "medium.dynamic.film_interval=0.02", "-s", "medium.dynamic.film_grid=30", "-s", "rods_run.t_end=5"
        self.rods("whole", *film)
        log = self.folder / "out/medium_film.log"
        with self.started("rods", "pair.toml", *film, "-o", "out", "--quiet") as process:
            wait_until(lambda: (log.exists() and log.stat().st_size > 100_000) or process.poll() is not None, 60)
            self.assertIsNone(process.poll(), "the run ended before it could be stopped")
            self.stop(process, signal.SIGTERM, 10.0)
        self.assertLess(len(self.film("out")["t"]), len(self.film("whole")["t"]))
        self.assertIn("resuming from the checkpoint at t = ", self.rods("out", *film).stderr)
        self.assertEqual(self.results("out"), self.results("whole"))
        self.assert_same_film("out", "whole")

    def test_a_film_whose_log_is_gone_begins_anew(self):
        film = *LONG, "-s", "medium.dynamic.film_interval=0.1", "-s", "medium.dynamic.film_grid=30", "-s", "rods_run.t_end=4"
        self.rods("whole", *film)
        checkpoint = self.folder / "out/rods_checkpoint.rwc"
        with self.started("rods", "pair.toml", *film, "-o", "out", "--quiet") as process:
            wait_until(lambda: (self.folder / "out/medium_film.log").exists() or process.poll() is not None, 60)
            self.stop(process, signal.SIGTERM, 10.0)
        self.assertTrue(checkpoint.exists())
        (self.folder / "out/medium_film.log").unlink()
        self.assertIn("starting from the beginning", self.rods("out", *film).stderr)
        self.assert_same_film("out", "whole")

    def test_check_tells_what_is_modelled_and_what_it_costs(self):
        output = self.expect(0, "check", "pair.toml").stdout
        self.assertIn("medium with memory: 30 x 30 modes, force width 0.6, from steady fields", output)
        self.assertIn("each rod in its own field: medium.dynamic.self_field is false", output)
        self.assertIn("rods: 1 run to t = ", output)

    def test_many_rods_get_a_mesh_and_threads_change_no_byte(self):
        many = "-s", "medium.dynamic.evaluation=mesh", "-s", "rods_run.t_end=2", "-s", "rods_run.rtol=1e-6"
        self.rods("one", "-j", "1", *many)
        self.rods("two", "-j", "2", *many)
        self.assertEqual(self.results("one"), self.results("two"))
        self.rods("sums", "-j", "1", *many, "-s", "medium.dynamic.evaluation=sums")
        self.assertEqual([self.outcome(run)["solver"]["evaluation"] for run in ("one", "sums")], ["mesh", "sums"])
        mesh, sums = (self.outcome(run)["turn"] for run in ("one", "sums"))
        self.assertNotEqual(mesh, sums)
        for a, b in zip(mesh, sums, strict=True):  # a rod's own field is left out to first order, no better
            self.assertAlmostEqual(a, b, delta=0.2 * abs(b))
        output = self.expect(0, "check", "pair.toml", *many).stdout
        self.assertIn("fields of many rods by fast Fourier transforms", output)
        self.assertIn("each rod in its own field: left out to first order in its turning", output)

    def test_own_field_and_inertia(self):
        own = "-s", "medium.dynamic.self_field=true", "-s", "rods_run.t_end=2"
        self.rods("own", *own)
        self.assertEqual(len(self.outcome("own")["own_turn"]), 2)
        self.rods("others", "-s", "rods_run.t_end=2")
        self.assertNotIn("own_turn", self.outcome("others"))
        self.rods("inertia", *own, "-s", "medium.dynamic.inertia=0.2")
        self.assertNotAlmostEqual(self.outcome("inertia")["turn"][0], self.outcome("own")["turn"][0], delta=1e-3)
        self.assertIn("inertia of the medium: 0.2", self.expect(0, "check", "pair.toml", "-s", "medium.dynamic.inertia=0.2").stdout)

    def test_what_does_not_fit_is_refused(self):
        for setting, said in (("medium.dynamic.force_width=0.5", r"force_width = 0.5 is below the grid spacing box/modes = 0.5333"),
                              ("medium.dynamic.box=2", r"box = 2 is less than 4 force_width = 2.4"),
                              ("rods.0.position=[0.0,-1.5] rods_run.contact_distance=0.3", r"rods\[0\] and rods\[1\] start 0.5 apart, closer than force_width = 0.6"),
                              ("rods_run.method=bdf", r"a method of their own"),
                              ("medium.dynamic.inertia=-1", r"medium.dynamic.inertia = -1: must be >= 0"),
                              ("medium.periodic=16", r"leave one out")):
            settings = [word for one in setting.split() for word in ("-s", one)]
            self.assertRegex(self.expect(2, "check", "pair.toml", *settings).stderr, said)
        done = self.expect(2, "tradeoff", "pair.toml")
        self.assertIn("there are no settings to compare", done.stderr)


if __name__ == "__main__":
    rodwake.main()
