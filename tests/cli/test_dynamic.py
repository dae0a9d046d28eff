"""medium.field = "dynamic" through the program: results, the same bytes resumed and on more threads, what is refused."""

import json
import signal

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
        self.assertEqual(self.outcome("one")["solver"]["method"], "etdrk4")
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
        checkpoint = self.folder / "out/checkpoint.json"
        with self.started("rods", "pair.toml", *LONG, "-o", "out", "--quiet") as process:
            wait_until(lambda: (self.folder / "out/provenance.json").exists() or process.poll() is not None, 60)
            self.assertIsNone(process.poll(), "the run ended before it could be stopped")
            self.stop(process, signal.SIGTERM, 10.0)
        self.assertTrue(checkpoint.exists())
        done = self.rods("out", *LONG)
        self.assertIn("going on from the checkpoint at t = ", done.stderr)
        self.assertEqual(self.results("out"), self.results("whole"))

    def test_check_tells_what_is_modelled_and_what_it_costs(self):
        told = self.expect(0, "check", "pair.toml").stdout
        self.assertIn("medium with memory: 30 x 30 modes, force width 0.6, from steady fields", told)
        self.assertIn("each rod in its own field: medium.dynamic.self_field is false", told)
        self.assertRegex(told, r"rods: about .*: \d+ steps")

    def test_many_rods_get_a_mesh_and_threads_change_no_byte(self):
        many = "-s", "medium.dynamic.evaluation=mesh", "-s", "rods_run.t_end=2", "-s", "rods_run.rtol=1e-6"
        self.rods("one", "-j", "1", *many)
        self.rods("two", "-j", "2", *many)
        self.assertEqual(self.results("one"), self.results("two"))
        self.rods("sums", "-j", "1", *many, "-s", "medium.dynamic.evaluation=sums")
        mesh, sums = (self.outcome(run)["turn"] for run in ("one", "sums"))
        self.assertNotEqual(mesh, sums)
        for a, b in zip(mesh, sums, strict=True):  # a rod's own field is left out to first order, no better
            self.assertAlmostEqual(a, b, delta=0.2 * abs(b))
        told = self.expect(0, "check", "pair.toml", *many).stdout
        self.assertIn("fields of many rods by fast Fourier transforms", told)
        self.assertIn("each rod in its own field: left out to first order in its turning", told)

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
                              ("rods.0.position=[0.0, -1.5]", r"rods\[0\] and rods\[1\] start 0.5 apart, closer than force_width = 0.6"),
                              ("rods_run.method=bdf", r"a method of their own"),
                              ("medium.dynamic.inertia=-1", r"medium.dynamic.inertia = -1: must be >= 0"),
                              ("medium.periodic=16", r"leave one out")):
            self.assertRegex(self.expect(2, "check", "pair.toml", "-s", setting).stderr, said)
        done = self.expect(2, "tradeoff", "pair.toml")
        self.assertIn("there is nothing to choose", done.stderr)


if __name__ == "__main__":
    rodwake.main()
