"""Rules of the source tree: the order of the parts, one place for each library, no machine paths, no empty test."""

import os
import re
import subprocess
import unittest
from pathlib import Path

import rodwake

SOURCE = rodwake.SOURCE

# Which parts a part may include. What is not listed is an error, so a new part has to be placed here.
ALLOWED = {
    "core": {"core"},
    "integrate": {"integrate", "core"},
    "elastic": {"elastic", "core"},
    "rods": {"rods", "elastic", "integrate", "core"},
    "granular": {"granular", "core"},
    "measure": {"measure", "granular", "elastic", "core"},
    "fitting": {"fitting", "measure", "rods", "elastic", "integrate", "core"},
    "scene": {"scene", "elastic", "core"},
    "store": {"store", "core"},
    "cli": {"cli", "scene", "store", "fitting", "measure", "granular", "rods", "elastic", "integrate", "core"},
}
# Libraries that stay in one part, or a few.
ONLY_IN = {
    "integrate": re.compile(r"^(sundials|cvodes|cvode|arkode|idas|ida|kinsol|nvector|sunmatrix|sunlinsol|sunnonlinsol)\b"),
    "store": re.compile(r"^(hdf5|H5|hdf5_hl)"),
    "scene": re.compile(r"^toml\+\+"),
    "fitting": re.compile(r"^(nlopt|unsupported/Eigen)"),
    "cli": re.compile(r"^(CLI|spdlog)/"),
    "core": re.compile(r"^Random123/"),
    "store|granular": re.compile(r"^xxhash\.h"),
    "granular|measure": re.compile(r"^hwy/"),
}
INCLUDE = re.compile(r'^\s*#\s*include\s*["<]([^">]+)[">]', re.MULTILINE)
MACHINE_PATH = re.compile(r"/(?:work|root|tmp/bash\w*|home/\w+)(?:/|\b)")


def part_of(path):
    """"rods" for include/rodwake/rods/x.hpp, models/rods/x.cpp and src/rods/x.cpp."""
    parts = path.parts
    if parts[0] == "fitting":
        return parts[0]
    return parts[2] if parts[0] == "include" else parts[1]


def wrong_includes(path, text):
    """What this file of a part includes that it may not, in words."""
    part = part_of(path)
    if part not in ALLOWED:
        return [f"{path}: part {part} has no place in the order of the parts"]
    wrong = []
    for name in INCLUDE.findall(text):
        # "rodwake/rods/x.hpp" from anywhere, "rods/x.hpp" because tests put src and models on the path.
        of_part = re.match(r"(?:rodwake/|\.\./)?(\w+)/", name)
        if of_part and (of_part[1] in ALLOWED or name.startswith("rodwake/")) and of_part[1] not in ALLOWED[part]:
            wrong.append(f"{path}: {part} must not include {name}")
        for owner, library in ONLY_IN.items():
            if library.match(name) and part not in owner.split("|"):
                wrong.append(f"{path}: only {owner} may include {name}")
    return wrong


def wrong_links(part, text):
    """rodwake::<part> targets in a part's CMakeLists.txt that it may not link."""
    return [name for name in re.findall(r"rodwake::(\w+)", text) if name not in ALLOWED[part]]


def tracked():
    """Files under version control, and new ones that are not ignored."""
    listed = subprocess.run(["git", "-C", SOURCE, "ls-files", "--cached", "--others", "--exclude-standard"],
                            capture_output=True, text=True, check=True).stdout.splitlines()
    return [Path(name) for name in listed if (SOURCE / name).is_file()]


def text_of(path):
    return (SOURCE / path).read_text(encoding="utf-8", errors="replace")


class OrderTest(unittest.TestCase):
    def test_no_include_goes_back(self):
        sources = [p for p in tracked() if p.suffix in (".hpp", ".cpp", ".inc", ".in") and p.parts[0] in ("include", "src", "models", "fitting")]
        self.assertEqual({part_of(p) for p in sources}, set(ALLOWED))
        self.assertEqual([wrong for p in sources for wrong in wrong_includes(p, text_of(p))], [])

    def test_the_check_sees_what_is_wrong(self):
        for path, line in [("include/rodwake/elastic/a.hpp", '#include "rodwake/rods/model.hpp"'),
                           ("models/elastic/a.cpp", "  #  include <rodwake/integrate/ode.hpp>"),
                           ("models/rods/a.cpp", '#include "rodwake/scene/scene.hpp"'),
                           ("src/store/a.cpp", '#include "rodwake/scene/scene.hpp"'),
                           ("src/scene/a.cpp", '#include "rodwake/store/csv.hpp"'),
                           ("src/scene/a.cpp", '#include "../cli/log.hpp"'),
                           ("src/integrate/a.cpp", '#include "rods/interaction.hpp"'),
                           ("src/core/a.cpp", '#include "rodwake/new/a.hpp"'),
                           ("models/rods/a.cpp", "#include <cvodes/cvodes.h>"),
                           ("src/cli/a.cpp", "#include <sundials/sundials_context.h>"),
                           ("src/cli/a.cpp", "#include <hdf5.h>"),
                           ("src/cli/a.cpp", "#include <xxhash.h>"),
                           ("src/core/a.cpp", "#include <hwy/highway.h>"),
                           ("src/new/a.cpp", "")]:
            self.assertEqual(len(wrong_includes(Path(path), line)), 1, line)
        for path, line in [("models/rods/a.cpp", '#include "rodwake/integrate/ode.hpp"'),
                           ("src/integrate/a.cpp", "#include <arkode/arkode_erkstep.h>"),
                           ("src/store/a.cpp", "#include <xxhash.h>"),
                           ("models/granular/a.cpp", "#include <xxhash.h>"),
                           ("models/granular/a.cpp", "#include <hwy/highway.h>"),
                           ("src/store/a.cpp", "#include <hdf5.h>\n// #include nothing\n#include <vector>"),
                           ("src/cli/a.cpp", '#include "rodwake/rods/simulate.hpp"')]:
            self.assertEqual(wrong_includes(Path(path), line), [], line)

    def test_no_part_links_back(self):
        for folder in ("src", "models"):
            for lists in (SOURCE / folder).glob("*/CMakeLists.txt"):
                self.assertEqual(wrong_links(lists.parent.name, lists.read_text()), [], lists)
        self.assertEqual(wrong_links("elastic", "PUBLIC rodwake::core PRIVATE rodwake::rods"), ["rods"])

    def test_public_headers_show_no_library_that_is_private(self):
        """SUNDIALS, HDF5, JSON, fmt and the rest are how, not what: only Eigen is part of the interface."""
        for path in tracked():
            if path.parts[0] == "include":
                foreign = [n for n in INCLUDE.findall(text_of(path)) if "/" in n and not n.startswith(("rodwake/", "Eigen/"))]
                self.assertEqual(foreign, [], path)


class TreeTest(unittest.TestCase):
    def test_no_machine_paths(self):
        me = Path(__file__).resolve()
        found = [f"{path}: {match[0]}" for path in tracked() if (SOURCE / path).resolve() != me
                 for match in MACHINE_PATH.finditer(text_of(path))]
        self.assertEqual(found, [])

    def test_machine_paths_are_seen(self):
        for text in ("/work/main", "see /root/x", "/tmp/bash_jobs", "/home/someone/x"):
            self.assertRegex(text, MACHINE_PATH)
        for text in ("/tools/x", "framework/main", "https://example.org/working", "~/x"):
            self.assertNotRegex(text, MACHINE_PATH)

    def test_long_files_and_tabs(self):
        """Over 400 lines a file is due for a split; generated tables and data are not read by people."""
        for path in tracked():
            if path.suffix in (".hpp", ".cpp", ".py"):
                text = text_of(path)
                self.assertLessEqual(text.count("\n"), 400, path)
                self.assertNotIn("\t", text, path)


class TestsTest(unittest.TestCase):
    def test_every_test_program_has_tests(self):
        programs = os.environ["RODWAKE_TEST_PROGRAMS"].split(":")
        self.assertGreaterEqual(len(programs), 6)
        for program in programs:
            listed = subprocess.run([program, "--list-test-names-only"], capture_output=True, text=True).stdout.split("\n")
            self.assertGreater(len([name for name in listed if name]), 0, program)

    def test_every_test_script_has_tests(self):
        scripts = [p for p in tracked() if p.name.startswith("test_") and p.suffix == ".py"]
        self.assertGreater(len(scripts), 5)
        for path in scripts:
            self.assertRegex(text_of(path), r"(?m)^    def test_\w+\(self\):", path)
            self.assertRegex(text_of(path), r'(?m)^if __name__ == "__main__":', path)

    def test_every_test_folder_is_registered(self):
        lists = text_of("tests/CMakeLists.txt")
        for folder in sorted(p for p in (SOURCE / "tests").iterdir() if p.is_dir() and p.name not in ("data", "__pycache__")):
            self.assertRegex(lists, rf"(rodwake_tests\(|rodwake_python_tests\(|/){folder.name}[ )/]", folder)


if __name__ == "__main__":
    rodwake.main()
