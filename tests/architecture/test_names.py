"""Names that the field does not know are gone from C++ and Python, and a type's name has one meaning."""

import re
import unittest
from collections import defaultdict

import rodwake
from test_architecture import text_of, tracked

PARTS = ("app", "fitting", "include", "models", "python", "src")
NOT_CODE = re.compile(r'//[^\n]*|/\*.*?\*/|"(?:\\.|[^"\\\n])*"', re.DOTALL)
DEPRECATED = re.compile(r".*\[\[deprecated.*")  # an alias for users of the release before
# What stands for each of them now.
GONE = {
    "told": "reported, described, decided, ...",
    "TOLD": "METADATA",
    "Telling": "ProgressPrinter",
    "Told": "Field",
    "seen_from": "relative_position",
    "RodPlace": "RodPosition",
    "BedYield": "BedObservables",
    "PairCourse": "PairFrame",
    "ProblemCalls": "UserFunctions",
    "Tallies": "Counters",
    "Dispenser": "WorkQueue",
    "at_own_place": "self_image_field",
    "by_heading": "heading_derivative",
    "by_medium": "medium_derivatives",
    "reset_late_keys": "reset_postprocessing_keys",
    "EvenTimes": "UniformTimes",
    "stderr_": "standard_error",
    "take_seed": "apply_seed",
    "free_x": "unwrapped_x",
    "carve": "clear_overlaps",
    "LatePart": "TailWindow",
    "late_from": "tail_start",
    "WakeSums": "InteractionOptions",
}
# Words of prose, too: these are looked for in the code alone.
GONE_FROM_CODE = {
    "Way": "Candidate",
    "Found": "of its own meaning",
    "Seen": "RelativePosition",
    "Leader": "FrontRodTracker",
    "Ahead": "RelativeDisplacement",
    "Wrapped": "PeriodicCoordinate",
    "Driver": "RefinementCriterion",
    "Team": "ThreadPool",
    "Phases": "PhaseFactors",
    "Place": "a position or point",
    "Places": "positions or points",
    "Wanted": "FieldRequest",
    "Form": "Formulation",
    "conclude": "classify_outcome",
}
TYPE = re.compile(r"\b(?:struct|class|enum(?:\s+class)?)\s+((?:\w+::)*\w+)\s*(?:final\s*)?(?::[^;{()]*)?\{")
# Types of two parts that a user of both tells apart by the namespace, and two makes of one class.
MOST_SHARED_TYPES = 20


def sources(python=False):
    """{path: text} of the C++ of the program and its libraries; with all Python, but for this list."""
    return {str(path): DEPRECATED.sub("", text_of(path)) for path in tracked()
            if path.suffix in (".cpp", ".hpp") and path.parts[0] in PARTS or python and path.suffix == ".py" and path.name != "test_names.py"}


def standing(files):
    """Words that are gone and stand in these {path: text} all the same, with where."""
    everywhere = re.compile(rf"\b(?:{'|'.join(GONE)})\b")
    in_code = re.compile(rf"\b(?:{'|'.join(GONE_FROM_CODE)})\b")
    return [f"{path}: {word}" for path, text in files.items()
            for word in everywhere.findall(text) + ([] if path.endswith(".py") else in_code.findall(NOT_CODE.sub(" ", text)))]


def shared_types(files):
    """Names of types that more than one file defines."""
    defined = defaultdict(set)
    for path, text in files.items():
        for name in TYPE.findall(NOT_CODE.sub(" ", text)):
            defined[name].add(path)
    return {name: sorted(paths) for name, paths in defined.items() if len(paths) > 1}


class NamesTest(unittest.TestCase):
    def test_words_that_are_gone_do_not_come_back(self):
        self.assertEqual(standing(sources(python=True)), [])

    def test_a_word_that_came_back_is_found(self):
        self.assertEqual(standing({"a.cpp": "// it is told\nstruct Team {};"}), ["a.cpp: told", "a.cpp: Team"])
        self.assertEqual(standing({"a.cpp": '// A Team of rods, "Seen"\nconst char* text = "Seen";'}), [])

    def test_few_names_of_types_have_two_meanings(self):
        shared = shared_types({path: text for path, text in sources().items() if not path.startswith("python")})
        self.assertLessEqual(len(shared), MOST_SHARED_TYPES, shared)
        self.assertEqual(shared_types({"a.cpp": "struct A { int x; };", "b.hpp": "class A : B {", "c.hpp": "struct A;"}), {"A": ["a.cpp", "b.hpp"]})


if __name__ == "__main__":
    rodwake.main()
