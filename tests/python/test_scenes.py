"""Scenes: read, changed, checked, run; progress, Ctrl-C, results."""

import json
import logging
import os
import pickle
import signal
import subprocess
import sys
import threading
import time
import unittest

import numpy as np
import rodwake
from program import SCENES, new_folder, run_scene

PAIR = SCENES / "pair.toml"
SMALL_BED = 'schema = 1\n[granular]\nbeads = 40\nbox = "16 a"\nstart = "lattice"\nequilibrate = "0 s"\nduration = "%s"\n[granular.output]\nframes = "0.01 s"\n'


class ReadTest(unittest.TestCase):
    def test_a_scene_is_read_and_written(self):
        scene = rodwake.Scene.load(PAIR)
        self.assertEqual((scene.stages, scene.title, scene.path), (["field", "rods"], "Two rods attract in an elastic medium", str(PAIR)))
        self.assertEqual(rodwake.Scene.parse(scene.to_toml()).to_toml(), scene.to_toml())

    def test_values_are_set_as_by_the_program(self):
        scene = rodwake.Scene.load(PAIR)
        changed = scene.copy().set("coupling.kappa", 3).set("rods.1.position", np.array([1.0, -2.0])).set("rods_run.method", "bdf").set("rods_run.rtol", 1e-6)
        text = changed.to_toml()
        for line in (r"kappa = 3\b", r"position = \[1(\.0)?, -2(\.0)?\]", 'method = "bdf"', "# atol: rtol / 100"):
            self.assertRegex(text, line)
        self.assertNotIn('method = "bdf"', scene.to_toml())  # of which it is a copy
        self.assertEqual(pickle.loads(pickle.dumps(changed)).to_toml(), text)
        scene.set({"coupling.kappa": 7, "rods_run.t_end": 5.0})
        self.assertRegex(scene.to_toml(), r"(?s)kappa = 7\b.*t_end = 5\b")
        with self.assertRaises(rodwake.SceneError):
            scene.set("coupling.kappa", "much")
        self.assertRegex(scene.to_toml(), r"kappa = 7\b")  # as it was

    def test_all_problems_of_a_scene_are_reported(self):
        with self.assertRaises(rodwake.SceneError) as raised:
            rodwake.Scene.load(PAIR).set("coupling.kapa", 1).set("medium.eta", -3)
        with self.assertRaises(rodwake.SceneError) as raised:
            rodwake.Scene.parse(PAIR.read_text().replace("kappa", "kapa").replace("eta = 1.0", "eta = -3"), "mine.toml")
        self.assertEqual([problem.line for problem in raised.exception.problems], [7, 11])
        self.assertIn("mine.toml:11", str(raised.exception))
        self.assertIn('did you mean "kappa"', str(raised.exception))
        with self.assertRaisesRegex(rodwake.InputError, "no such file"):
            rodwake.Scene.load("nowhere.toml")
        with self.assertRaises(TypeError):
            rodwake.Scene.load(PAIR).set("coupling.kappa", object())
        scene = rodwake.Scene.load(PAIR)
        for ask, word in ((lambda: rodwake.Scene.load(3), "path: expected"), (lambda: rodwake.Scene.load(None), "path: expected"),
                          (lambda: rodwake.Scene.parse(None), "text: expected"), (lambda: scene.set(3, 4), "key: expected"),
                          (lambda: scene.run(None), "folder: expected"), (lambda: scene.run("x", stages=[3]), "stages: expected"),
                          (lambda: scene.run("x", progress=3), "progress: expected a function"), (lambda: scene.check(3), "folder: expected")):
            with self.assertRaisesRegex(TypeError, word):
                ask()
        for options, word in (({"threads": -1}, "threads = -1"), ({"threads": 10**30}, "threads"), ({"threads": "two"}, "threads"), ({"seed": -1}, "seed = -1"),
                              ({"seed": 1.5}, "seed = 1.5"), ({"seed": True}, "seed")):
            with self.assertRaisesRegex(rodwake.InputError, word):
                scene.run("x", **options)

    def test_check_tells_what_is_modelled(self):
        text = rodwake.Scene.load(PAIR).check()
        self.assertRegex(text, r"(?s)^modelled\n.*2 rods to t = 60.*not modelled\n.*no \[granular\]")
        self.assertNotIn("expected cost", text)
        self.assertIn("for a right-hand side", rodwake.Scene.load(PAIR).check(cost=True))


class RunTest(unittest.TestCase):
    def test_results_are_those_of_the_program(self):
        folder = new_folder(self)
        with self.assertLogs("rodwake", logging.INFO) as logs:
            ours = rodwake.Scene.load(PAIR).set("coupling.kappa", 2.0).run(folder / "ours", stages=["rods"])
        theirs = run_scene(self, PAIR, "coupling.kappa=2.0")
        self.assertEqual((ours.folder / "rods.csv").read_bytes(), (theirs.folder / "rods.csv").read_bytes())
        self.assertEqual((ours.status, ours.outcome["outcome"]), ("finished", "contact"))
        self.assertTrue(any("contact" in line for line in logs.output), logs.output)
        self.assertIn(".set('coupling.kappa', 2.0)", json.loads((ours.folder / "provenance.json").read_text())["command"])

    def test_the_command_makes_the_run_again(self):
        """From a text, with a seed, and when the text is too long to be kept."""
        folder, text = new_folder(self), SMALL_BED % "0.01 s"
        for name, scene in (("short", text), ("long", text + "# " + 70_000 * "x" + "\n")):
            run = rodwake.Scene.parse(scene).set("granular.phi_b", 0.3).run(folder / name, seed=7)
            command = run.json("provenance.json")["command"]
            self.assertRegex(command, r"parse\('schema.*phi_b.*seed=7" if name == "short" else r"load\(.*scene\.toml.*seed=7")
            again = eval(command.replace(f".run({str(folder / name)!r}", f".run({str(folder / 'again' / name)!r}"))
            self.assertEqual(again.json("summary.json")["state_hash"], run.json("summary.json")["state_hash"])

    def test_a_bed_has_the_bits_of_the_program(self):
        scene = new_folder(self) / "bed.toml"
        scene.write_text(SMALL_BED % "0.05 s")
        ours = rodwake.Scene.load(scene).run(scene.parent / "ours")
        theirs = run_scene(self, scene, verb="dem")
        self.assertEqual(ours.json("summary.json")["state_hash"], theirs.json("summary.json")["state_hash"])
        frames = ours.trajectory()
        self.assertEqual((frames.position.shape, frames.time.shape, frames.rod_position.shape), ((6, 40, 3), (6,), (6, 0, 3)))
        np.testing.assert_array_equal(frames.position, theirs.trajectory().position)
        np.testing.assert_allclose(frames.box[:2], 16 * 0.4e-3, rtol=1e-15)

    def test_a_finished_run_is_not_overwritten(self):
        folder, scene = new_folder(self), rodwake.Scene.load(PAIR)
        scene.run(folder)
        made = (folder / "rods.csv").stat().st_mtime_ns
        again = scene.run(folder)  # its results, as they are
        self.assertEqual((again.status, (folder / "rods.csv").stat().st_mtime_ns), ("finished", made))
        self.assertEqual(scene.run(folder, force=True).status, "finished")

    def test_unknown_stages_are_refused(self):
        with self.assertRaisesRegex(rodwake.InputError, "no stage 'fit'"):
            rodwake.Scene.load(PAIR).run(new_folder(self), stages=["fit"])

    def test_progress_is_reported_and_may_end_the_run(self):
        calls = []

        def tell(what, value, end, unit):
            calls.append((what, value, end, unit))
            if len(calls) == 2:
                raise RuntimeError("enough")

        folder = new_folder(self)
        with self.assertRaisesRegex(RuntimeError, "enough"):
            rodwake.Scene.parse(SMALL_BED % "60 s").run(folder, progress=tell, threads=1)
        self.assertEqual(len(calls), 2)
        self.assertEqual(calls[0][0], "dem")
        self.assertAlmostEqual(calls[0][2], 60.0)
        self.assertLess(calls[0][1], calls[1][1])
        self.assertEqual(rodwake.open_run(folder).status, "interrupted")

    def test_a_failed_solve_is_reported(self):
        with self.assertLogs("rodwake", logging.ERROR), self.assertRaisesRegex(rodwake.RunError, "the steps allowed were used up"):
            rodwake.Scene.load(PAIR).set("rods_run.max_steps", 3).run(new_folder(self))

    def test_python_goes_on_while_it_runs(self):
        """Another thread counts during a call: it could not if the interpreter were held."""
        counted, stop = [0], threading.Event()

        def count():
            while not stop.is_set():
                counted[0] += 1
                time.sleep(0.001)

        other = threading.Thread(target=count)
        other.start()
        try:
            before = counted[0]
            rodwake.displacement(np.linspace(1, 2, 400_000), 0.5, rodwake.Medium())
            self.assertGreater(counted[0] - before, 10)
        finally:
            stop.set()
            other.join()


class InterruptTest(unittest.TestCase):
    def interrupted(self, text):
        """Runs a Python text, presses Ctrl-C once it has printed a line, and gives what it printed then."""
        script = "import numpy as np\nimport rodwake\nprint('begun', flush=True)\ntry:\n    " + text + "\nexcept KeyboardInterrupt:\n    print('KeyboardInterrupt')\n"
        with subprocess.Popen([sys.executable, "-c", script], stdout=subprocess.PIPE, text=True, env=os.environ) as child:
            child.stdout.readline()
            time.sleep(0.5)
            child.send_signal(signal.SIGINT)
            return child.communicate(timeout=60)[0]

    def test_a_run_of_a_scene(self):
        folder = new_folder(self)
        (folder / "bed.toml").write_text(SMALL_BED % "1000 s")
        printed = self.interrupted(f"rodwake.Scene.load({str(folder / 'bed.toml')!r}).run({str(folder / 'run')!r}, threads=1)")
        self.assertEqual(printed, "KeyboardInterrupt\n")
        self.assertEqual(rodwake.open_run(folder / "run").status, "interrupted")

    def test_simulate(self):
        rods = "[[8.0 * i, 8.0 * k, 0.1 * i * k] for i in range(12) for k in range(12)]"
        self.assertEqual(self.interrupted(f"rodwake.simulate({rods}, rodwake.Medium(), kappa=5, t_end=1e7, max_steps=10**9)"), "KeyboardInterrupt\n")

    def test_a_field_of_many_points(self):
        self.assertEqual(self.interrupted("rodwake.displacement(np.linspace(1, 2, 10**7), 0.5, rodwake.Medium(periodic=9.0))"), "KeyboardInterrupt\n")


class OpenTest(unittest.TestCase):
    def test_what_a_run_holds(self):
        run = rodwake.Scene.load(PAIR).run(new_folder(self))
        self.assertEqual(run.files["rods.csv"], "rods against time")
        self.assertEqual(run.units("rods.csv")["x1"], "f/mu")
        table = run.table("rods.csv")
        np.testing.assert_array_equal(np.asarray(table["x0"]), run.rods().poses[:, 0, 0])
        field = run.field()
        self.assertEqual((field["Ux"].values.shape, field["Ux"].unit, field["axis_angle"].unit), ((121, 181), "f/mu", "rad"))
        row = 3  # of the grid, beside the rod
        exact = rodwake.displacement(field["x"].values, field["y"].values[row], rodwake.Medium())
        np.testing.assert_array_equal(field["Ux"].values[row], exact[:, 0])
        self.assertEqual(run.scene().to_toml(), rodwake.Scene.load(PAIR).to_toml())
        self.assertEqual(run.dataset("field/cuts/0/Ux").values.shape, (561,))

    def test_tables_without_pandas(self):
        run = rodwake.Scene.load(PAIR).run(new_folder(self), stages=["rods"])
        with_pandas = run.table("rods.csv")
        hidden = {name: sys.modules.pop(name) for name in list(sys.modules) if name.split(".")[0] == "pandas"}
        sys.modules["pandas"] = None  # importing it fails
        try:
            table = run.table("rods.csv")
        finally:
            del sys.modules["pandas"]
            sys.modules.update(hidden)
        self.assertEqual(table.dtype.names, ("t", "x0", "y0", "theta0", "x1", "y1", "theta1"))
        np.testing.assert_array_equal(table["y0"], np.asarray(with_pandas["y0"]))

    def test_an_ensemble_and_its_parts(self):
        """Two runs of a bed and of a variant: the whole, each run, their trajectories."""
        text = SMALL_BED % "0.02 s" + '[[variants]]\nname = "thin"\n[variants.set]\n"granular.beads" = 30\n'
        whole = rodwake.Scene.parse(text.replace("beads = 40", "beads = 40\nruns = 2")).run(new_folder(self) / "run")
        self.assertEqual([one.folder.name for one in whole.members], ["0001", "0002"])
        first, second = whole.trajectory()
        self.assertFalse(np.array_equal(first.position, second.position))
        np.testing.assert_array_equal(whole.trajectory(run=1).position, second.position)
        self.assertRegex(repr(first), "3 frames, t = 0 to 0.02 s, 40 beads, 0 rods")
        for part, beads in (("runs/0002", 40), ("variants/thin/runs/0001", 30)):
            one = rodwake.open_run(whole.folder / part)
            self.assertEqual((one.status, one.members, one.scene().to_toml()), ("finished", [], whole.scene().to_toml()))
            self.assertEqual(one.trajectory().position.shape, (3, beads, 3))
            self.assertEqual(one.trajectory(run=0).position.shape, (3, beads, 3))
            self.assertIn("summary.json", one.files)
            self.assertEqual(one.units("table.csv"), whole.units(f"{part}/table.csv"))
            self.assertEqual(one.json("summary.json")["beads"], beads)
        self.assertEqual(len(rodwake.open_run(whole.folder / "variants/thin").trajectory()), 2)
        self.assertRegex(repr(whole), r"finished: 2 runs \(members\), ")
        for ask, word in ((lambda: whole.trajectory(run=2), "run = 2: .* from 0 to 1"), (lambda: whole.trajectory("result.h5", run=0), "no such file"),
                          (lambda: whole.members[0].trajectory("summary.json"), "HDF5"), (lambda: whole.members[0].rods(), "no such file"),
                          (lambda: rodwake.open_run(whole.folder / "variants"), "part"),
                          (lambda: rodwake.plots.figures(whole.members[0]), "part of a run"), (lambda: whole.table("scene.toml"), "no table")):
            with self.assertRaisesRegex(rodwake.InputError, word):
                ask()

    def test_a_run_that_has_not_ended(self):
        """As one looks that was killed, before its manifest was written."""
        run = rodwake.Scene.load(PAIR).run(new_folder(self) / "run", stages="rods")
        files, units = run.files, run.units("rods.csv")
        (run.folder / "manifest.json").unlink()
        again = rodwake.open_run(run.folder)
        self.assertEqual(({**again.files, "manifest.json": files["manifest.json"]}, again.units("rods.csv")), (files, units))
        (run.folder / "manifest.json").write_text("[1]")
        with self.assertRaisesRegex(rodwake.RunError, "manifest.json: damaged JSON"):
            rodwake.open_run(run.folder)

    def test_what_is_not_there_is_reported(self):
        folder = new_folder(self)
        (folder / "notes.txt").write_text("mine")
        for place, word in ((folder / "notes.txt", "is a file"), (folder / "nowhere", "no such folder")):
            with self.assertRaisesRegex(rodwake.InputError, word):
                rodwake.open_run(place)
        with self.assertRaisesRegex(rodwake.InputError, "no run of rodwake"):
            rodwake.open_run(folder)
        run = rodwake.Scene.load(PAIR).run(folder / "run", stages=["rods"])
        with self.assertRaisesRegex(rodwake.InputError, "no run of rodwake.*folders run"):
            rodwake.open_run(folder)
        for given in (None, 3, ["a"]):
            with self.assertRaises(TypeError):
                rodwake.open_run(given)
        for ask, word in ((lambda: run.table("no.csv"), "Run.files"), (run.field, r"\[field\]"), (lambda: run.rods("other"), "scene"),
                          (lambda: run.dataset("a/b"), "datasets"), (lambda: run.dataset("rods"), "is a group"), (run.trajectory, "trajectory.h5md")):
            with self.assertRaisesRegex(rodwake.InputError, word):
                ask()


if __name__ == "__main__":
    unittest.main()
