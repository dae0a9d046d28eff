"""The types of the package, by mypy; and that the stub and the documentation are complete."""

import ast
import inspect
import os
import subprocess
import sys
import unittest

import rodwake
from program import SOURCE, new_folder
from rodwake import _core

USE = """
import numpy as np
import rodwake

medium = rodwake.Medium(eta=1.0, alpha=2.0)
strain: "np.ndarray[object, np.dtype[np.float64]]" = rodwake.strain([1.0], 2.0, medium)
outcome: str = rodwake.simulate([[0, 0, 0]], medium, t_end=1.0).outcome
turned: "np.ndarray[object, np.dtype[np.float64]]" = rodwake.wakes([[0, 0, 0]], medium).strain_gradient
again: rodwake.RodResult = rodwake.classify([0.0, 1.0], [[0, 0, 0], [1, 0, 0]], medium, law=lambda t, y: np.ones(3))
frames: rodwake.Trajectory = rodwake.open_run("out").trajectory(run=0)
scene: rodwake.Scene = rodwake.Scene.load("pair.toml").set("coupling.kappa", 3.0)
run: rodwake.Run = scene.run("out", progress=lambda what, value, end, unit: print(what, value / end))
value: float = rodwake.fit_wake([rodwake.Profile([1.0], [2.0])], ["eta"]).parameters["eta"].value
share: "float | None" = rodwake.simulate_noise([[0, 0, 0]], medium, rotational_diffusion=0.1, t_end=1.0).capture_probability
order: rodwake.Measured = rodwake.Tracks.from_arrays(np.zeros((2, 3, 2)), frames_per_second=1.0).order(block=2.0)
force: float = rodwake.fit_map([rodwake.Map([0.0, 1.0], [0.0, 1.0], np.eye(2), np.eye(2), (9.0, 9.0))], ["force"]).parameters["force"].value
"""


def mypy(path):
    """With a cache that stays: reading the libraries' types takes half a minute."""
    done = subprocess.run([sys.executable, "-m", "mypy", "--strict", "--follow-imports=silent", "--ignore-missing-imports", "--cache-dir",
                           os.path.join(os.environ["RODWAKE_BINARY_DIR"], "mypy_cache"), str(path)],
                          capture_output=True, text=True, env={"MYPYPATH": str(SOURCE / "python")})
    return done.stdout + done.stderr


class TypesTest(unittest.TestCase):
    def test_the_package(self):
        self.assertIn("Success: no issues found", mypy(SOURCE / "python/rodwake"))

    def test_who_uses_it(self):
        good, bad = new_folder(self) / "good.py", new_folder(self) / "bad.py"
        good.write_text(USE)
        self.assertIn("Success", mypy(good))
        bad.write_text(USE + "medium.eta = 2.0\nrodwake.simulate([[0, 0, 0]], medium, t_end='long')\n")
        said = mypy(bad)
        self.assertIn('Property "eta"', said)
        self.assertIn('"t_end"', said)


class CompleteTest(unittest.TestCase):
    def test_completion_shows_what_is_for_users(self):
        self.assertEqual(set(dir(rodwake)), {*rodwake.__all__, "plots"})
        for name in dir(rodwake):
            self.assertTrue(hasattr(rodwake, name))

    def test_the_stub_names_what_the_module_has(self):
        def named(body):
            return {node.name for node in body if isinstance(node, (ast.ClassDef, ast.FunctionDef))}

        stub = ast.parse((SOURCE / "python/rodwake/_core.pyi").read_text())
        public = {name for name, value in vars(_core).items() if not name.startswith("_") and callable(value)}
        self.assertEqual(named(stub.body), public)
        for node in (node for node in stub.body if isinstance(node, ast.ClassDef)):
            members = {name for name in vars(getattr(_core, node.name)) if not name.startswith("_")}
            self.assertEqual({name for name in named(node.body) if not name.startswith("__")}, members, node.name)

    def test_everything_public_is_documented(self):
        for name in rodwake.__all__:
            thing = getattr(rodwake, name)
            if name == "__version__":
                continue
            self.assertTrue(inspect.getdoc(thing), name)
            if inspect.isclass(thing) and not issubclass(thing, Exception):
                for member, value in vars(thing).items():
                    if not member.startswith("_") and (callable(value) or isinstance(value, property)):
                        self.assertTrue(inspect.getdoc(value), f"{name}.{member}")


if __name__ == "__main__":
    unittest.main()
