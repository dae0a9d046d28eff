"""tools/quickstart: the steps it takes, with stand-ins for apt, cmake and the program that record what they are asked. Recipes of packages."""

import os
import re
import shutil
import subprocess
import unittest

import rodwake
from rodwake import SOURCE, ProgramTest

STAND_INS = {
    "dpkg-query": 'echo "install ok installed"',
    "id": "echo $UID_WANTED",
    "apt-get": 'echo "apt-get $*" >> "$RECORD"',
    "cmake": 'echo "cmake $*" >> "$RECORD"\nif [ "$1" = --install ]; then mkdir -p "$4/bin"; cp "$BIN/rodwake" "$4/bin"; fi',
    "rodwake": 'echo "rodwake $*" >> "$RECORD"',
}


class QuickstartTest(ProgramTest):
    def setUp(self):
        super().setUp()
        shutil.copytree(SOURCE / "tools", self.folder / "tree/tools")
        for name, text in STAND_INS.items():
            self.write(f"bin/{name}", f"#!/bin/sh\n{text}\n").chmod(0o755)

    def quickstart(self, *options, user=1000, path=""):
        record = self.folder / "record"
        record.unlink(missing_ok=True)
        done = subprocess.run([self.folder / "tree/tools/quickstart", *options], cwd=self.folder, text=True, capture_output=True, env={
            "PATH": f"{self.folder / 'bin'}:{path}:{os.environ['PATH']}", "HOME": str(self.folder / "home"), "BIN": str(self.folder / "bin"),
            "RECORD": str(record), "UID_WANTED": str(user)})
        return done, record.read_text().splitlines() if record.exists() else []

    def test_a_user_gets_the_command_in_local(self):
        done, steps = self.quickstart()
        self.assertEqual(done.returncode, 0, done.stderr)
        prefix = self.folder / "home/.local"
        self.assertEqual([step.split()[:3] for step in steps], [
            ["cmake", "--preset", "release"], ["cmake", "--build", "--preset"],
            ["cmake", "--install", str(self.folder / "tree/build/release")],
            *(["rodwake", "run", str(self.folder / f"tree/scenes/{name}.toml")] for name in ("attraction", "quickstart"))])
        self.assertIn(f'export PATH="{prefix}/bin:$PATH"', done.stdout)
        done, _ = self.quickstart(path=prefix / "bin")
        self.assertNotIn("export PATH", done.stdout)

    def test_a_prefix(self):
        done, steps = self.quickstart("--prefix", "here")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertTrue(steps[2].endswith(f"--prefix {self.folder / 'here'}"))
        self.assertTrue((self.folder / "here/bin/rodwake").is_file())

    def test_root_gets_it_for_all(self):
        self.write("bin/cmake", '#!/bin/sh\necho "cmake $*" >> "$RECORD"\ncase $1 in --install) exit 7 ;; esac\n')
        done, steps = self.quickstart(user=0)
        self.assertEqual((done.returncode, steps[-1].split()[-1]), (7, "/usr/local"))  # an error ends it: nothing is run

    def test_packages_only(self):
        self.assertEqual(self.quickstart("--deps-only")[1], [])

    def test_it_installs_what_program_figures_and_package_need(self):
        self.write("bin/dpkg-query", "#!/bin/sh\n")  # nothing is there
        done, steps = self.quickstart("--deps-only", user=0)
        self.assertEqual((done.returncode, steps[0]), (0, "apt-get update -qq"), done.stderr)
        asked = set(steps[1].split("--no-install-recommends ")[1].split())
        self.assertLessEqual({"g++", "libsundials-dev", "python3-matplotlib", "pybind11-dev"}, asked)
        self.assertEqual(asked & {"chromium", "doxygen", "mkdocs", "mypy", "catch2", "ccache", "libbenchmark-dev", "clang-tidy"}, set())

    def test_each_section_of_packages_is_installed_by_ci_and_by_another(self):
        sections = set(re.findall(r"(?m)^\[(\w+)\]$", (SOURCE / "tools/packages.txt").read_text()))
        asked = {path.name: set(" ".join(re.findall(r"install_packages ([\w ]+)", path.read_text())).split())
                 for path in (*(SOURCE / "tools").iterdir(), SOURCE / ".ci/run") if path.is_file() and path.name != "setup.sh"}
        sections -= {"explorer", "wheel", "compilers"}  # what the explorer compiles is in the tree; CI builds no wheel and makes no study
        self.assertEqual((asked.pop("run"), set().union(*asked.values())), (sections, sections))

    def test_usage(self):
        for options in (["--prefix"], ["--prefix", ""], ["--nonsense"], ["--deps-only", "x"]):
            done, steps = self.quickstart(*options)
            self.assertEqual((done.returncode, steps), (2, []), options)
            self.assertIn("usage: tools/quickstart", done.stderr)

    def test_the_container_repeats_it(self):
        text = (SOURCE / "Containerfile").read_text()
        self.assertIn("RUN /opt/rodwake/tools/quickstart --deps-only\nRUN /opt/rodwake/tools/quickstart\n", text)
        self.assertIn("FROM debian:12\n", text)


RECIPES = {"conda": SOURCE / "tools/recipes/conda/meta.yaml", "spack": SOURCE / "tools/recipes/spack/package.py"}
# What the build calls a package, as others do.
OTHER_NAMES = {"eigen3": "eigen", "hdf5c": "hdf5", "hwy": "libhwy|highway", "nlohmann_json": "nlohmann[_-]json",
               "boost": "boost|libboost-headers", "xxhash": "xxhash"}


class RecipesTest(unittest.TestCase):
    def missing(self, recipe):
        """What the build asks for and the recipe does not name."""
        asked = re.findall(r"(?m)^set\(RODWAKE_FIND_\w+ (\w+)", (SOURCE / "cmake/dependencies.cmake").read_text())
        named = [name.lower() for name in asked if name not in ("Threads", "MPI")] + ["xxhash", "random123", "pybind11"]
        return [name for name in named if not re.search(rf"[\s\"'-](py-)?({OTHER_NAMES.get(name, name)})[\s\"'@]", recipe)]

    def test_each_library_is_named(self):
        for name, path in RECIPES.items():
            text = path.read_text()
            self.assertEqual(self.missing(text), [], name)
            self.assertEqual(self.missing(text.replace("nlopt", "nothing")), ["nlopt"], name)

    def test_versions_are_the_projects(self):
        version, = re.findall(r"project\(rodwake VERSION ([\d.]+)", (SOURCE / "CMakeLists.txt").read_text())
        self.assertIn(f'set version = "{version}"', RECIPES["conda"].read_text())
        self.assertIn(f'    version("{version}")', RECIPES["spack"].read_text())
        self.assertIn(f"version: {version}\n", (SOURCE / "CITATION.cff").read_text())

    def test_spack_reads_it(self):
        compile(RECIPES["spack"].read_text(), "package.py", "exec")


if __name__ == "__main__":
    rodwake.main()
