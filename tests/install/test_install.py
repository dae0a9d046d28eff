"""cmake --install, then find_package(rodwake) and the examples from the install tree alone, as a user of the library."""

import os
import shutil
import subprocess
import tempfile
import unittest
from pathlib import Path

import rodwake

CMAKE = os.environ.get("RODWAKE_CMAKE", "cmake")
EXAMPLES = rodwake.SOURCE / "examples"


def run(*command, **options):
    return subprocess.run([str(word) for word in command], text=True, capture_output=True, **options)


class InstallTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        keeper = tempfile.TemporaryDirectory(prefix="rodwake-install-")
        cls.addClassCleanup(keeper.cleanup)
        cls.folder = Path(keeper.name)
        cls.prefix = cls.folder / "prefix"
        cls.installed = run(CMAKE, "--install", os.environ["RODWAKE_BINARY_DIR"], "--prefix", cls.prefix)

    def setUp(self):
        self.assertEqual(self.installed.returncode, 0, self.installed.stderr)

    def build(self, name, *, source=None, prefix=None):
        """Configures and builds a copy of an example, far from the source tree; the last process."""
        copy, build = self.folder / name, self.folder / f"build-{name}"
        shutil.copytree(source or EXAMPLES / name, copy)
        done = run(CMAKE, "-S", copy, "-B", build, "-G", "Ninja", f"-DCMAKE_PREFIX_PATH={prefix or self.prefix}")
        return done if done.returncode else run(CMAKE, "--build", build)

    def output_of(self, name):
        done = self.build(name)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        done = run(self.folder / f"build-{name}" / name)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        return done.stdout

    def number_after(self, label, text):
        for line in text.splitlines():
            if line.startswith(label):
                return float(line.removeprefix(label).split()[0])
        self.fail(f"no line {label!r} in:\n{text}")

    def test_every_example_is_tried(self):
        tried = {name.removeprefix("test_example_") for name in dir(self) if name.startswith("test_example_")}
        self.assertEqual({path.name for path in EXAMPLES.iterdir()}, tried)

    def test_example_pair(self):
        text = self.output_of("pair")
        self.assertIn("outcome      contact", text)
        # rtol 1e-10; the global error of adams is up to 1000 times that (include/rodwake/integrate/ode.hpp).
        self.assertLess(self.number_after("true error", text), 1e-7)

    def test_example_own_ode(self):
        text = self.output_of("own_ode")
        self.assertIn("6 passes in", text)  # the quarter period is 0.83 s, the run 10 s long
        # rtol 1e-10; the global error of adams is up to 1000 times that (the same header).
        self.assertLess(self.number_after("true error", text), 1e-7)

    def test_example_own_fit(self):
        text = self.output_of("own_fit")
        self.assertIn("converged", text)
        self.assertLess(abs(self.number_after("pull of b", text)), 2.0)  # the ripple is smaller than the errors it stands for

    def test_a_version_that_is_not_there_is_refused(self):
        source = self.folder / "future"
        source.mkdir()
        (source / "CMakeLists.txt").write_text("cmake_minimum_required(VERSION 3.25)\nproject(future LANGUAGES CXX)\n"
                                               "find_package(rodwake 99 REQUIRED)\n")
        done = self.build("future-copy", source=source)
        self.assertNotEqual(done.returncode, 0)
        self.assertIn("99", done.stderr)

    def test_without_the_install_tree_nothing_builds(self):
        done = self.build("own_ode_alone", source=EXAMPLES / "own_ode", prefix=self.folder / "nowhere")
        self.assertNotEqual(done.returncode, 0)
        self.assertIn("rodwake", done.stderr)

    def test_the_installed_program_makes_its_own_figures(self):
        program = self.prefix / "bin/rodwake"
        scene = self.prefix / "share/rodwake/scenes/pair.toml"
        done = run(program, "run", scene, "-o", self.folder / "out")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertTrue((self.folder / "out/report.html").is_file())
        # Not those of the source tree it was built from: with another plotting program in place, that one is run.
        plots = self.prefix / "share/rodwake/plots/rodwake_plot.py"
        plots.rename(plots.with_suffix(".kept"))
        self.addCleanup(plots.with_suffix(".kept").replace, plots)
        plots.write_text("print('the installed one')\n")
        self.assertEqual(run(program, "plot", self.folder / "out").stdout, "the installed one\n")

    def test_installed_files_name_no_folder_of_the_source(self):
        texts = [p for p in self.prefix.rglob("*") if p.suffix in (".hpp", ".cmake", ".py", ".toml", ".md", ".css")]
        self.assertGreater(len(texts), 40)
        for path in texts:
            self.assertNotIn(str(rodwake.SOURCE), path.read_text(), path)


if __name__ == "__main__":
    rodwake.main()
