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
# Searches only the given folders, not /usr/local, where tools/quickstart has put rodwake, nor PATH, environment and registries.
ALONE = "".join(f"set(CMAKE_FIND_USE_{place} OFF)\n" for place in ("CMAKE_SYSTEM_PATH", "SYSTEM_ENVIRONMENT_PATH", "CMAKE_ENVIRONMENT_PATH",
                                                                  "PACKAGE_ROOT_PATH", "PACKAGE_REGISTRY", "SYSTEM_PACKAGE_REGISTRY"))


def run(*command, **options):
    return subprocess.run([str(word) for word in command], text=True, capture_output=True, **options)


class InstallTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        keeper = tempfile.TemporaryDirectory(prefix="rodwake-install-")
        cls.addClassCleanup(keeper.cleanup)
        cls.folder = Path(keeper.name)
        cls.prefix = cls.folder / "prefix"
        (cls.folder / "alone.cmake").write_text(ALONE)
        cls.alone = f"-DCMAKE_PROJECT_INCLUDE={cls.folder / 'alone.cmake'}"
        cls.installed = run(CMAKE, "--install", os.environ["RODWAKE_BINARY_DIR"], "--prefix", cls.prefix)

    def setUp(self):
        self.assertEqual(self.installed.returncode, 0, self.installed.stderr)

    def build(self, name, *options, source=None, prefix=None, **how):
        """Configures and builds a copy of an example, far from the source tree; the last process."""
        copy, build = self.folder / name, self.folder / f"build-{name}"
        shutil.copytree(source or EXAMPLES / name, copy)
        done = run(CMAKE, "-S", copy, "-B", build, "-G", "Ninja", f"-DCMAKE_PREFIX_PATH={prefix or self.prefix}", *options, **how)
        if done.returncode == 0 and prefix is None:  # not a rodwake that happens to be installed beside it
            self.assertIn(f"rodwake_DIR:PATH={self.prefix}", (build / "CMakeCache.txt").read_text())
        return done if done.returncode else run(CMAKE, "--build", build)

    def find(self, name, call, *options, then="", **how):
        """Configures a project in C++ of nothing but this call of find_package, and some lines more."""
        source = self.folder / f"source-{name}"
        source.mkdir()
        (source / "CMakeLists.txt").write_text(f"cmake_minimum_required(VERSION 3.25)\nproject({name} LANGUAGES CXX)\n"
                                               f"find_package({call})\n{then}\n")
        return self.build(name, *options, source=source, **how)

    def output_of(self, name, *arguments):
        done = self.build(name)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        done = run(self.folder / f"build-{name}" / name, *arguments)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        return done.stdout

    def number_after(self, label, text):
        for line in text.splitlines():
            if line.startswith(label):
                return float(line.removeprefix(label).split()[0])
        self.fail(f"no line {label!r} in:\n{text}")

    def test_every_example_is_tried(self):
        tried = {name.removeprefix("test_example_") for name in dir(self) if name.startswith("test_example_")}
        self.assertEqual({path.parent.name for path in EXAMPLES.glob("*/CMakeLists.txt")}, tried)

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

    def test_example_own_scene(self):
        scene = rodwake.SOURCE / "scenes/pair.toml"
        self.assertEqual(self.output_of("own_scene", scene, "coupling.kappa", "0.5"), "contact at t = 40.5953 f/(mu v0)\n")
        for arguments, pattern in ((("coupling.kapa", "1"), "kapa.*kappa"), (("coupling.kappa", "nan"), "kappa = nan")):
            done = run(self.folder / "build-own_scene" / "own_scene", scene, *arguments)
            self.assertNotEqual(done.returncode, 0)
            self.assertRegex(done.stderr, pattern)

    def test_a_version_that_is_not_there_is_refused(self):
        for version in ("0.2", "99"):
            with self.subTest(version):
                done = self.find(f"version_{version}", f"rodwake {version} REQUIRED", self.alone)
                self.assertNotEqual(done.returncode, 0)
                self.assertIn(version, done.stderr)

    def test_every_part_is_a_component(self):
        """The parts are the folders of public headers; the package lists them, and each can be asked for."""
        parts = sorted(path.name for path in (rodwake.SOURCE / "include/rodwake").iterdir() if path.is_dir())
        self.assertIn("measure", parts)
        each = "".join(f"find_package(rodwake REQUIRED COMPONENTS {part})\nget_target_property(x rodwake::{part} TYPE)\n" for part in parts)
        done = self.find("parts", "rodwake REQUIRED",
                         then=each + "list(SORT rodwake_PARTS)\nfile(WRITE parts.txt \"${rodwake_PARTS}\")")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual((self.folder / "parts/parts.txt").read_text().split(";"), parts)

    def test_a_part_that_is_not_there_is_refused(self):
        done = self.find("nonsense", "rodwake REQUIRED COMPONENTS rods nonsense")
        self.assertNotEqual(done.returncode, 0)
        self.assertRegex(done.stderr, r"no\s+part\s+nonsense;\s+there\s+are\s+core,")
        done = self.find("optional", "rodwake REQUIRED COMPONENTS rods OPTIONAL_COMPONENTS nonsense",
                         then="if(rodwake_nonsense_FOUND OR NOT rodwake_rods_FOUND)\n  message(FATAL_ERROR found)\nendif()")
        self.assertEqual(done.returncode, 0, done.stderr)

    def test_a_part_asks_for_no_library_of_another(self):
        others = ("HDF5", "HDF5C", "NLopt", "tomlplusplus", "nlohmann_json", "Boost", "CLI11", "spdlog")
        absent = [f"-DCMAKE_DISABLE_FIND_PACKAGE_{name}=TRUE" for name in others]
        done = self.build("rods_alone", *absent, source=EXAMPLES / "pair")
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        for part, library in (("store", "HDF5C"), ("fitting", "NLopt"), ("scene", "tomlplusplus")):  # what is switched off is off
            done = self.find(f"without_{library}", f"rodwake REQUIRED COMPONENTS {part}", *absent)
            self.assertNotEqual(done.returncode, 0)
            self.assertIn(library, done.stderr)

    def test_a_project_needs_no_C_compiler(self):
        done = self.find("no_c", "rodwake REQUIRED", env={**os.environ, "CC": "/no/such/compiler"},
                         then="get_property(languages GLOBAL PROPERTY ENABLED_LANGUAGES)\nif(C IN_LIST languages)\n"
                              "  message(FATAL_ERROR \"C was switched on\")\nendif()")
        self.assertEqual(done.returncode, 0, done.stderr)

    def test_without_the_install_tree_nothing_builds(self):
        done = self.build("own_ode_alone", self.alone, source=EXAMPLES / "own_ode", prefix=self.folder / "nowhere")
        self.assertNotEqual(done.returncode, 0)
        self.assertIn("rodwake", done.stderr)

    def test_what_is_installed_elsewhere_is_not_seen(self):
        """A package in each place that CMake looks at by itself: found there if nothing is said, and not found alone.
        Of a name of its own: rodwake itself may be in /usr/local."""
        package, registry = self.folder / "elsewhere/lib/cmake/stub", self.folder / "home/.cmake/packages/stub"
        for path in (package, registry, self.folder / "elsewhere/bin", self.folder / "asks"):
            path.mkdir(parents=True)
        (package / "stubConfig.cmake").touch()
        prefix = self.folder / "elsewhere"
        (registry / "there").write_text(str(prefix))
        (self.folder / "asks/CMakeLists.txt").write_text("cmake_minimum_required(VERSION 3.25)\nproject(asks LANGUAGES NONE)\nfind_package(stub)\n"
                                                         "message(STATUS \"found: ${stub_FOUND}\")\n")
        places = {"system": ({}, [f"-DCMAKE_INSTALL_PREFIX={prefix}"]),  # stands in one list with /usr/local
                  "path": ({"PATH": f"{prefix / 'bin'}:{os.environ['PATH']}"}, []), "registry": ({"HOME": str(self.folder / "home")}, []),
                  "environment": ({"CMAKE_PREFIX_PATH": str(prefix)}, []), "root": ({"stub_ROOT": str(prefix)}, [])}
        for name, (environment, options) in places.items():
            for found, alone in (("1", []), ("0", [self.alone])):
                done = run(CMAKE, "-S", self.folder / "asks", "-B", self.folder / f"asked-{name}-{found}", "-G", "Ninja", *options, *alone,
                           env={**os.environ, **environment})
                self.assertIn(f"found: {found}\n", done.stdout, (name, done.stderr))

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

    def test_the_installed_program_has_its_scenes_completion_and_manual_page(self):
        for name, options in (("man/man1/rodwake.1", ["--man"]), ("bash-completion/completions/rodwake", ["--completion", "bash"]),
                              ("zsh/site-functions/_rodwake", ["--completion", "zsh"])):
            self.assertEqual((self.prefix / "share" / name).read_text(), run(self.prefix / "bin/rodwake", "info", *options).stdout)
        self.assertEqual(run(self.prefix / "bin/rodwake", "explore", "-o", self.folder / "explore.html").returncode, 0)
        own = self.prefix / "share/rodwake/scenes/own.toml"
        own.write_text("# Mine.\nschema = 1\n")
        self.addCleanup(own.unlink)
        self.assertIn("own\n    Mine.\n", run(self.prefix / "bin/rodwake", "scenes").stdout)
        self.assertEqual(run(self.prefix / "bin/rodwake", "scenes", "-o", self.folder / "copied").returncode, 0)
        self.assertTrue((self.folder / "copied/fitting/data/profile_Ux_x.csv").is_file())

    def test_a_debian_package(self):
        config = Path(os.environ["RODWAKE_BINARY_DIR"]) / "CPackConfig.cmake"
        quick = "CPACK_DEBIAN_COMPRESSION_TYPE=gzip"  # xz of the whole package takes half a minute
        done = run("cpack", "--config", config, "-D", quick, "-B", self.folder / "deb")
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        package, = (self.folder / "deb").glob("rodwake_*.deb")
        needed = run("dpkg-deb", "-f", package, "Depends").stdout
        for name in ("libc6", "libsundials-", "libhdf5-", "libnlopt", "python3-matplotlib", "python3-h5py"):
            self.assertIn(name, needed)
        self.assertEqual(run("dpkg-deb", "-x", package, self.folder / "root").returncode, 0)
        done = run(self.folder / "root/usr/bin/rodwake", "scenes", "pair")
        self.assertEqual(done.stdout, (rodwake.SOURCE / "scenes/pair.toml").read_text(), done.stderr)
        self.assertTrue((self.folder / "root/usr/share/man/man1/rodwake.1.gz").is_file())

    def test_installed_files_name_no_folder_of_the_source(self):
        texts = [p for p in self.prefix.rglob("*") if p.suffix in (".hpp", ".cmake", ".py", ".toml", ".md", ".css")]
        self.assertGreater(len(texts), 40)
        for path in texts:
            self.assertNotIn(str(rodwake.SOURCE), path.read_text(), path)


if __name__ == "__main__":
    rodwake.main()
