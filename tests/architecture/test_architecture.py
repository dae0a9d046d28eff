"""Rules of the source tree: the order of the parts, one place for each library, no machine paths, no empty test."""

import json
import os
import re
import subprocess
import tempfile
import unittest
from pathlib import Path

import rodwake

SOURCE = rodwake.SOURCE

PAGE = "docs/architecture.md"


def cells_of_table(text, *names):
    """Rows of the Markdown table whose header begins with these names, a list of cells each."""
    rows = [[cell.strip() for cell in line.strip("|").split("|")] for line in text.splitlines() if line.startswith("|")]
    at = next(i for i, row in enumerate(rows) if tuple(row[:len(names)]) == names)
    width = len(rows[at])
    taken = []
    for row in rows[at + 2:]:
        if len(row) != width or set(row[0]) <= {"-", ":"}:
            break
        taken.append(row)
    return taken


def layout(text):
    """Of the page's two tables: {part: folder}, of C++ parts only, and {part: parts that it may include}."""
    table = cells_of_table(text, "part", "may include")
    ends = next((i for i, row in enumerate(table) if row[0] == "part"), len(table))
    allowed = {row[0]: {row[0], *re.findall(r"\w+", row[1])} for row in table[:ends]}
    named = {row[0]: re.findall(r"\(\.\./([\w/]+)\)", row[1])[0] for row in cells_of_table(text, "part", "folder")}
    return {part: named[part] for part in allowed}, allowed


FOLDERS, ALLOWED = layout((SOURCE / PAGE).read_text())
TOPS = {folder.split("/")[0] for folder in FOLDERS.values()}
# Libraries that stay in one part, or a few.
ONLY_IN = {
    "integrate": re.compile(r"^(sundials|cvodes|cvode|arkode|idas|ida|kinsol|nvector|sunmatrix|sunlinsol|sunnonlinsol)\b"),
    "store": re.compile(r"^(hdf5|H5|hdf5_hl)"),
    "scene": re.compile(r"^toml\+\+"),
    "fitting": re.compile(r"^nlopt"),
    "fitting|measure": re.compile(r"^unsupported/Eigen"),  # Levenberg and Marquardt's search
    "cli": re.compile(r"^(CLI/|spdlog/sinks/stdout)"),  # the terminal
    "app|cli": re.compile(r"^spdlog/"),
    "core": re.compile(r"^Random123/"),
    "store|granular": re.compile(r"^xxhash\.h"),
    "scan": re.compile(r"^mpi\.h"),
    "elastic|rods|granular|measure": re.compile(r"^hwy/"),
}
KINDS = "app/bed/measures"  # a file a measure; they open no files
NO_FILES = re.compile(r"^(fstream|iostream|ostream|cstdio)$")
# What turns a scene into a plan, and tells of it.
PLANS = {f"app/{name}.cpp" for name in (
    "run/describe", "run/plan", "run/schema", "theory/rods", "bed/granular", "bed/measure", "bed/measure_parts",
    "bed/describe_granular", "fit/fit_plan", "fit/settle_data", "fit/describe_fit", "scan/scan",
    "scan/scan_problem")}
# A measure is known to its own part and to the file of its kind: a header named as a file of that folder is one's.
MEASURES = {path.stem for path in (SOURCE / KINDS).glob("*.cpp")}
# The folders of the stages, which describe themselves to app/run; measures describe their values to its glossary and schema.
STAGES = {"bed", "fit", "scan", "theory", "explore"}
INCLUDE = re.compile(r'^\s*#\s*include\s*["<]([^">]+)[">]', re.MULTILINE)
# A folder of somebody's machine: homes, and where clusters and containers keep work. Not /usr, /etc or /dev, which all have.
MACHINE_PATH = re.compile(r"(?:(?<=file://)|(?<![\w.~})/*-]))(?:"
                          r"/root\b|/(?:home|Users|work|workdir|workspaces?|scratch|projects?|builds|mnt|media|nfs|srv)/\w|/(?:var/)?tmp/\w"
                          r"|[A-Za-z]:[\\/]+Users\b)")


def part_of(path):
    """"rods" for include/rodwake/rods/x.hpp and models/rods/x.cpp, "app" for app/bed/x.cpp: of the folders around it the deepest."""
    if path.parts[0] == "include":
        return path.parts[2]
    around = [part for part, folder in FOLDERS.items() if path.is_relative_to(folder)]
    return max(around, key=lambda part: len(FOLDERS[part]), default=path.parts[1] if len(path.parts) > 1 else "")


def part_included(path, name):
    """The part that an include names, as far as one can tell without the compiler; "" for a library or a neighbour."""
    if name.startswith("rodwake/"):  # from anywhere
        return name.split("/")[1]
    target = Path(os.path.normpath(path.parent / name))
    if ".." in name and target.parts[0] in TOPS:  # by a way through the tree
        return "" if part_of(target) == part_of(path) else part_of(target)
    steps = [step for step in name.split("/")[:-1] if step not in (".", "..", *TOPS - {"fitting"})]
    first = steps[0] if steps else ""
    if first and (part_of(path) == "app" or first not in ALLOWED) and (SOURCE / "app" / first).is_dir():
        return "app"  # "bed/x.hpp": its slices, and app is on the path
    return first if first in ALLOWED else ""  # "rods/x.hpp": tests put the folders of the parts on the path


def wrong_includes(path, text):
    """What this file of a part includes that it may not, in words."""
    part = part_of(path)
    if part not in ALLOWED:
        return [f"{path}: part {part} has no place in the order of the parts"]
    wrong = []
    for name in INCLUDE.findall(text):
        of_part = part_included(path, name)
        if of_part and of_part not in ALLOWED[part]:
            wrong.append(f"{path}: {part} must not include {name}")
        if path.is_relative_to("app/run") and name.split("/")[0] in STAGES and name != "bed/measure_kind.hpp":
            wrong.append(f"{path}: run knows its stages by StageKind, and so must not include {name}")
        for owner, library in ONLY_IN.items():
            if library.match(name) and part not in owner.split("|"):
                wrong.append(f"{path}: only {owner} may include {name}")
        if (path.is_relative_to(KINDS) or str(path) in PLANS) and (NO_FILES.match(name) or name.startswith(("spdlog/", "rodwake/store/"))):
            wrong.append(f"{path}: plans and measures open no files, and so must not include {name}")
        if name.startswith("rodwake/measure/") and Path(name).stem in MEASURES and part != "measure" and path != Path(KINDS, f"{Path(name).stem}.cpp"):
            wrong.append(f"{path}: only the measure's own file may include {name}")
    return wrong


def wrong_links(part, text):
    """rodwake::<part> targets in a part's CMakeLists.txt that it may not link."""
    return [name for name in re.findall(r"rodwake::(\w+)", text) if name not in ALLOWED[part]]


def tracked(root=SOURCE):
    """Files under version control, and new ones that are not ignored."""
    listed = subprocess.run(["git", "-C", root, "ls-files", "--cached", "--others", "--exclude-standard"],
                            capture_output=True, text=True, check=True).stdout.splitlines()
    return [Path(name) for name in listed if (root / name).is_file()]


def text_of(path, root=SOURCE):
    return (root / path).read_text(encoding="utf-8", errors="replace")


def test_cases(text):
    """Name and tags of each C++ test."""
    return re.findall(r'TEST_CASE\(\s*"((?:[^"\\]|\\.)*)"(?:,\s*"([^"]*)")?\s*\)', text)


def part_files(root=SOURCE):
    """Sources of the parts, and the list of targets that each part links."""
    inside = [p for p in tracked(root) if p.parts[0] in ("include", *TOPS)]
    return ([p for p in inside if p.suffix in (".hpp", ".cpp", ".inc", ".in")],
            [p for p in inside if p.name == "CMakeLists.txt" and str(p.parent) in FOLDERS.values()])


def wrong_in_tree(root=SOURCE):
    sources, lists = part_files(root)
    return ([wrong for path in sources for wrong in wrong_includes(path, text_of(path, root))]
            + [f"{path}: {part_of(path)} must not link {name}" for path in lists for name in wrong_links(part_of(path), text_of(path, root))])


class OrderTest(unittest.TestCase):
    def test_nothing_goes_back(self):
        for files in part_files():
            self.assertEqual({part_of(path) for path in files}, set(ALLOWED))
        self.assertEqual(wrong_in_tree(), [])

    def test_what_is_planted_in_a_tree_is_found(self):
        with tempfile.TemporaryDirectory(prefix="rodwake-house-") as folder:
            root = Path(folder)
            subprocess.run(["git", "init", "-q", root], check=True)
            for part, place in (("fitting", "fitting"), ("rods", "models/rods"), ("store", "src/store"), ("core", "include/rodwake/core")):
                (root / place).mkdir(parents=True)
                (root / place / "planted.hpp").write_text('#include "rodwake/cli/log.hpp"\n')
                (root / place / "good.hpp").write_text(f'#include "rodwake/{part}/planted.hpp"\n')
                (root / place / "CMakeLists.txt").write_text(f"rodwake_part({part} PRIVATE rodwake::core rodwake::cli)\n")
            found = {line.replace("must not include rodwake/cli/log.hpp", "include").replace("must not link cli", "link") for line in wrong_in_tree(root)}
            self.assertEqual(found, {"fitting/planted.hpp: fitting include", "fitting/CMakeLists.txt: fitting link",
                                     "models/rods/planted.hpp: rods include", "models/rods/CMakeLists.txt: rods link",
                                     "src/store/planted.hpp: store include", "src/store/CMakeLists.txt: store link",
                                     "include/rodwake/core/planted.hpp: core include"})

    def test_the_check_sees_what_is_wrong(self):
        for path, line in [("include/rodwake/elastic/a.hpp", '#include "rodwake/rods/model.hpp"'),
                           ("models/elastic/a.cpp", "  #  include <rodwake/integrate/ode.hpp>"),
                           ("models/rods/a.cpp", '#include "rodwake/scene/scene.hpp"'),
                           ("src/store/a.cpp", '#include "rodwake/scene/scene.hpp"'),
                           ("app/scene/a.cpp", '#include "rodwake/store/csv.hpp"'),
                           ("app/scene/a.cpp", '#include "../cli/log.hpp"'),
                           ("app/scene/a.cpp", '#include "../run/session.hpp"'),
                           ("models/measure/a.cpp", '#include "rodwake/app/run.hpp"'),
                           ("app/run/a.cpp", '#include "rodwake/cli/log.hpp"'),
                           ("app/bed/a.cpp", "#include <spdlog/sinks/stdout_color_sinks.h>"),
                           ("app/scene/a.cpp", "#include <spdlog/logger.h>"),
                           ("src/store/a.cpp", '#include "rodwake/app/rods.hpp"'),
                           ("fitting/a.cpp", '#include "rodwake/scene/scene.hpp"'),
                           ("fitting/a.cpp", '#include "../src/store/hash.hpp"'),
                           ("fitting/a.cpp", '#include "scene/reader.hpp"'),
                           ("include/rodwake/fitting/a.hpp", '#include "rodwake/app/fit.hpp"'),
                           ("models/rods/a.cpp", '#include "../../fitting/loss.hpp"'),
                           ("models/rods/a.cpp", '#include "rodwake/fitting/loss.hpp"'),
                           ("models/measure/a.cpp", '#include "../rods/couplings.hpp"'),
                           ("src/integrate/a.cpp", '#include "rods/interaction.hpp"'),
                           ("models/rods/a.cpp", '#include "bed/measure_parts.hpp"'),
                           ("app/scene/a.cpp", '#include "run/session.hpp"'),
                           ("src/core/a.cpp", '#include "rodwake/new/a.hpp"'),
                           ("models/rods/a.cpp", "#include <cvodes/cvodes.h>"),
                           ("app/cli/a.cpp", "#include <sundials/sundials_context.h>"),
                           ("app/cli/a.cpp", "#include <hdf5.h>"),
                           ("app/cli/a.cpp", "#include <xxhash.h>"),
                           ("src/core/a.cpp", "#include <hwy/highway.h>"),
                           ("app/bed/measures/a.cpp", "#include <fstream>"),
                           ("app/run/plan.cpp", "#include <fstream>"),
                           ("app/run/plan.cpp", "#include <spdlog/logger.h>"),
                           ("app/run/a.cpp", '#include "fit/fit_stage.hpp"'),
                           ("app/run/plan.cpp", '#include "rodwake/store/csv.hpp"'),
                           ("app/bed/a.cpp", '#include "rodwake/measure/flow.hpp"'),
                           ("app/bed/measures/order.cpp", '#include "rodwake/measure/flow.hpp"'),
                           ("src/new/a.cpp", "")]:
            self.assertEqual(len(wrong_includes(Path(path), line)), 1, line)
        for path, line in [("models/rods/a.cpp", '#include "rodwake/integrate/ode.hpp"'),
                           ("src/integrate/a.cpp", "#include <arkode/arkode_erkstep.h>"),
                           ("src/store/a.cpp", "#include <xxhash.h>"),
                           ("fitting/a.cpp", '#include "rodwake/rods/simulate.hpp"\n#include "loss.hpp"\n#include <nlopt.hpp>'),
                           ("models/measure/a.cpp", '#include "../granular/shape.hpp"'),
                           ("app/bed/a.cpp", '#include <spdlog/logger.h>\n#include "rodwake/store/csv.hpp"\n#include "rodwake/app/rods.hpp"'),
                           ("app/scene/a.cpp", '#include "rodwake/granular/problem.hpp"\n#include "rodwake/fitting/method.hpp"'),
                           ("models/granular/a.cpp", "#include <xxhash.h>"),
                           ("app/bed/a.cpp", '#include <fstream>\n#include "rodwake/measure/measures.hpp"'),
                           ("app/bed/measures/flow.cpp", '#include <filesystem>\n#include "rodwake/measure/flow.hpp"'),
                           ("include/rodwake/measure/pairs.hpp", '#include "rodwake/measure/order.hpp"'),
                           ("models/granular/a.cpp", "#include <hwy/highway.h>"),
                           ("src/store/a.cpp", "#include <hdf5.h>\n// #include nothing\n#include <vector>"),
                           ("app/bed/a.cpp", '#include "run/session.hpp"\n#include "scan/scan_parts.hpp"\n#include "granular_run.hpp"'),
                           ("app/cli/a.cpp", '#include "rodwake/rods/simulate.hpp"')]:
            self.assertEqual(wrong_includes(Path(path), line), [], line)

    def test_wrong_links_are_seen(self):
        self.assertEqual(wrong_links("elastic", "PUBLIC rodwake::core PRIVATE rodwake::rods"), ["rods"])
        self.assertEqual(wrong_links("fitting", "PUBLIC rodwake::elastic rodwake::scene PRIVATE rodwake::store"), ["scene", "store"])

    def test_plans_are_there(self):
        self.assertEqual([name for name in PLANS if not (SOURCE / name).is_file()], [])

    def test_the_order_has_no_cycle(self):
        for part, allowed in ALLOWED.items():
            self.assertEqual([other for other in allowed - {part} if part in ALLOWED[other]], [], part)

    def test_headers_of_ours_are_in_the_tree(self):
        """A compiler that misses one there looks into /usr/local, where an earlier rodwake may be installed."""
        for path in tracked():
            if path.suffix in (".hpp", ".cpp"):
                for name in INCLUDE.findall(text_of(path)):
                    self.assertTrue(not name.startswith("rodwake/") or (SOURCE / "include" / name).is_file(), f"{path}: {name}")

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
        def whole(*texts):  # in pieces here, so that these are not found themselves
            return [text.replace("%", "") for text in texts]

        for text in whole("/%work/x", "see /%root/x", "/%tmp/x", "/%home/x", '"/%Users/x"', "=/%scratch/x", "(/%workspace/x)", "/%var/tmp/x",
                          "/%mnt/x", "file:///%home/x", r"C:\%Users\x", "/%builds/x"):
            self.assertRegex(text, MACHINE_PATH)
        for text in whole("/tools/x", "framework/main", "https://example.org/%work/x", "~/%work/x", "${sourceDir}/build/x", "results/%work/x",
                          "a/%home/b", "/usr/bin/python3", "/dev/full", "/particles/trajectory", "time/%work", "/*/%work/*"):
            self.assertNotRegex(text, MACHINE_PATH)

    def test_scripts_can_be_run(self):
        for path in tracked():
            if text_of(path).startswith("#!"):
                self.assertTrue(os.access(SOURCE / path, os.X_OK), f"{path}: starts with #!, and may not be executed")

    def test_long_files_and_tabs(self):
        """Over 500 lines a file is due for a split; generated tables and data are not read by people."""
        for path in tracked():
            if path.suffix in (".hpp", ".cpp", ".py"):
                text = text_of(path)
                self.assertLessEqual(text.count("\n"), 500, path)
                self.assertNotIn("\t", text, path)


class TestsTest(unittest.TestCase):
    def test_every_test_program_has_tests(self):
        programs = os.environ["RODWAKE_TEST_PROGRAMS"].split(":")
        self.assertGreaterEqual(len(programs), 6)
        for program in programs:
            listed = subprocess.run([program, "--list-test-names-only"], capture_output=True, text=True).stdout.split("\n")
            self.assertGreater(len([name for name in listed if name]), 0, program)

    def test_every_test_is_alone(self):
        """Run by tests/support/alone, after its home was emptied; but for what empties it, and for the build of the rest."""
        ctest = Path(os.environ["RODWAKE_CMAKE"]).with_name("ctest")
        listing = subprocess.run([ctest, "--show-only=json-v1"], cwd=os.environ["RODWAKE_BINARY_DIR"], capture_output=True, text=True, check=True)
        tests = [test for test in json.loads(listing.stdout)["tests"] if "_NOT_BUILT-" not in test["name"]]
        self.assertGreater(len(tests), 100)
        own = {test["name"] for test in tests if not test["command"][0].endswith("/tests/support/alone")}
        self.assertEqual(own - {"compile"}, {"home", "headers (long)"})  # "compile" only with benchmarks
        for test in tests:
            properties = {one["name"]: one["value"] for one in test["properties"]}
            self.assertNotIn("ENVIRONMENT", properties, test["name"])
            self.assertEqual(properties.get("FIXTURES_REQUIRED", ["home"]), ["home"], test["name"])
            self.assertEqual("FIXTURES_REQUIRED" in properties, test["name"] not in own, test["name"])

    def test_sources_with_tests_are_named_alike(self):
        """test_*.cpp has tests, and nothing else has; helpers are named for what they give."""
        for path in tracked():
            if path.parts[0] == "tests" and path.suffix == ".cpp":
                self.assertEqual(path.name.startswith("test_"), "TEST_CASE(" in text_of(path), path)

    def test_tests_with_threads_have_their_tag(self):
        """ThreadSanitizer runs the tagged ones. Named here: too long for it, and a short run beside it is tagged."""
        cases = [case for path in tracked() if path.parts[0] == "tests" and path.suffix == ".cpp" for case in test_cases(text_of(path))]
        untagged = [name for name, tags in cases if re.search(r"\bthreads?\b", name) and "[threads]" not in tags]
        self.assertEqual(untagged, ["threads do not change a bit"])
        self.assertGreater(sum("[threads]" in tags for _, tags in cases), 30)
        self.assertEqual(test_cases('TEST_CASE("two threads",\n    "[a][threads]") {\nTEST_CASE("one thread") {'),
                         [("two threads", "[a][threads]"), ("one thread", "")])

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
