"""Packages: a wheel that pip installs where there is no compiler, no library of the project and no network, and a .deb."""

import contextlib
import io
import os
import runpy
import shutil
import subprocess
import tempfile
import unittest
import zipfile
from pathlib import Path

from rodwake import SOURCE

BARE = {"PATH": "/usr/bin:/bin", "HOME": "/nonexistent"}


def run(*words, folder, **environment):
    return subprocess.run([str(word) for word in words], cwd=folder, env=BARE | environment, capture_output=True, text=True, timeout=600)


class WheelTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        keeper = tempfile.TemporaryDirectory(prefix="rodwake-wheel-")
        cls.addClassCleanup(keeper.cleanup)
        cls.folder = Path(keeper.name)
        build = Path(os.environ["RODWAKE_BINARY_DIR"]).parent / "wheel"
        subprocess.run([SOURCE / "tools/wheel", "--build", build, "--into", cls.folder], check=True, capture_output=True)
        (cls.wheel,) = cls.folder.glob("rodwake-*.whl")
        subprocess.run(["/usr/bin/python3", "-m", "venv", "--system-site-packages", cls.folder / "env"], check=True)
        done = run(cls.folder / "env/bin/pip", "install", "--no-index", "--no-deps", cls.wheel, folder=cls.folder)
        if done.returncode:
            raise AssertionError(done.stderr)

    def test_size(self):
        self.assertLess(self.wheel.stat().st_size, 25e6)

    def test_package_and_program(self):
        done = run("env/bin/python", "-c", "import rodwake; print(rodwake.__file__, rodwake.Medium(eta=1.0, alpha=1.0))", folder=self.folder)
        self.assertIn(str(self.folder / "env/lib"), done.stdout, done.stderr)
        done = run("env/bin/rodwake", "scenes", "-o", ".", folder=self.folder)
        self.assertEqual(done.returncode, 0, done.stderr)
        done = run("env/bin/rodwake", "run", "scenes/pair.toml", "-o", "out", folder=self.folder)
        self.assertEqual(done.returncode, 0, done.stderr)
        for name in ("outcome.json", "report.html", "figures/trajectories.png"):
            self.assertTrue((self.folder / "out" / name).is_file(), name)

    def test_libraries_are_those_of_the_wheel(self):
        site = next((self.folder / "env/lib").glob("python3*/site-packages"))
        for file in (site / "rodwake/program/bin/rodwake", *(site / "rodwake").glob("_core.*.so")):
            for line in run("ldd", file, folder=self.folder).stdout.splitlines():
                if "hdf5" in line or "sundials" in line or "nlopt" in line:
                    self.assertIn(str(site), line)

    def test_a_folder_of_this_machine_is_found(self):
        tree = self.folder / "tree"
        with zipfile.ZipFile(self.wheel) as wheel:
            wheel.extractall(tree)
        audit = runpy.run_path(str(SOURCE / "tools/wheel"))["audit"]
        audit(tree)
        (tree / "rodwake/note.py").write_text(f"# {SOURCE}/x\n")
        with self.assertRaisesRegex(SystemExit, "is named in rodwake/note.py"), contextlib.redirect_stderr(io.StringIO()):
            audit(tree)
        (tree / "rodwake/note.py").unlink()
        lost = next((tree / "rodwake.libs").glob("libhdf5*"))
        shutil.move(lost, self.folder)
        with self.assertRaisesRegex(SystemExit, f"not in the wheel: .*{lost.name}"):
            audit(tree)


class DebianTest(unittest.TestCase):
    def setUp(self):
        keeper = tempfile.TemporaryDirectory(prefix="rodwake-deb-")
        self.addCleanup(keeper.cleanup)
        self.folder = Path(keeper.name)

    def package(self, name):
        config = Path(os.environ["RODWAKE_BINARY_DIR"]) / "CPackConfig.cmake"
        done = run("cpack", "--config", config, "-B", self.folder / name, folder=self.folder)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        (package,) = (self.folder / name).glob("rodwake_*.deb")
        return package

    def errors(self, package):
        done = run("lintian", "--allow-root", "--tag-display-limit", "0", package, folder=self.folder)
        return [line for line in done.stdout.splitlines() if line.startswith("E:")]

    def test_lintian_finds_no_error_and_the_bytes_are_the_same_again(self):
        first = self.package("first")
        self.assertEqual(self.errors(first), [])
        self.assertEqual(first.read_bytes(), self.package("second").read_bytes())

    def test_lintian_finds_one_that_is_there(self):
        tree = self.folder / "tree"
        run("dpkg-deb", "-R", self.package("made"), tree, folder=self.folder)
        (tree / "usr/share/doc/rodwake/copyright").unlink()
        run("dpkg-deb", "-Zxz", "-b", tree, self.folder / "bad.deb", folder=self.folder)
        self.assertTrue(any("no-copyright-file" in line for line in self.errors(self.folder / "bad.deb")))


if __name__ == "__main__":
    unittest.main()
