"""Nothing is defined twice: the linker keeps one of two inline functions (or classes) of one name and drops the other
without a word, so an unoptimised build computes something else than an optimised one, which has inlined both."""

import re
import unittest
from collections import defaultdict

import rodwake
from test_architecture import text_of, tracked

NOT_CODE = re.compile(r'//[^\n]*|/\*.*?\*/|"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])*\'|^\s*#(?:\\\n|[^\n])*', re.DOTALL | re.MULTILINE)
NAMESPACE = re.compile(r"(?:inline\s+)?namespace\b\s*([\w:]*)$")
CLASS = re.compile(r"(?:template\s*<.*>\s*)?(?:struct|class|union|enum(?:\s+(?:class|struct))?)\s+(?:alignas\(\w+\)\s+)?(\w+)(?:\s+final)?(?:\s*:[^:].*)?$",
                   re.DOTALL)
FUNCTION = re.compile(r"([\w:~]+|operator\W{1,3})\s*\((.*)\)[\w\s]*(?:->.*)?(?::.*)?$", re.DOTALL)
DEFAULT = re.compile(r"\s*=[^,]*")


def parameters(text):
    """Types of parameters: their names and defaults taken off."""
    types = []
    for one in DEFAULT.sub("", text).split(","):
        words = re.sub(r"\s+", " ", one).strip()
        types.append(re.sub(r"(?<=[\w>&*]) ?\b\w+$", "", words) if re.search(r"[ &*>]\w+$", words) else words)
    return ",".join(types)


def defined(head):
    """What `head {` defines at namespace scope and the linker takes once, or None. A function that is neither inline nor
    a template is not asked after: two of it do not link."""
    if found := CLASS.match(head):
        return found[1]
    found = FUNCTION.search(head)
    if not found or re.match(r"static\b", head) or not re.search(r"\b(inline|constexpr|template)\b", head):
        return None
    return f"{found[1]}({parameters(found[2])})"


def definitions(text):
    """Names that a file defines at namespace scope and others see, with namespaces and types of parameters."""
    code = NOT_CODE.sub(" ", text)
    scopes, start, found = [], 0, []
    for at, char in enumerate(code):
        if char in ";{}":
            head = re.sub(r"\s+", " ", code[start:at]).strip()
            start = at + 1
            if char == "{":
                space = NAMESPACE.match(head)
                if space is None and None not in scopes and "" not in scopes:
                    name = defined(head)
                    if name:
                        found.append("::".join(scopes) + "::" + name)
                scopes.append(space[1] if space else None)
            elif char == "}" and scopes:
                scopes.pop()
    return found


def twice(files):
    """Definitions that stand in more than one of these {path: text}."""
    places = defaultdict(set)
    for path, text in files.items():
        for name in definitions(text):
            places[name].add(str(path))
    return {name: sorted(paths) for name, paths in places.items() if len(paths) > 1}


class OneDefinitionTest(unittest.TestCase):
    def test_nothing_is_defined_twice(self):
        files = {p: text_of(p) for p in tracked() if p.suffix in (".hpp", ".cpp") and p.parts[0] in ("include", "app", "src", "models", "fitting")}
        self.assertEqual(twice(files), {})
        self.assertGreater(sum(len(definitions(text)) for text in files.values()), 300)  # the parser reads the tree

    def test_json_is_written_in_one_place(self):
        """nlohmann's dump throws at bytes that are not UTF-8 unless set otherwise."""
        written = [str(p) for p in tracked() if p.suffix in (".hpp", ".cpp") and p.parts[0] in ("include", "app", "src", "models", "fitting", "python")
                   and ".dump(" in text_of(p)]
        self.assertEqual(written, ["include/rodwake/core/json_text.hpp"])

    def test_two_bodies_of_one_inline_function_are_seen(self):
        one = "namespace rodwake::granular {\ninline double nearest(double difference, double box) {\n    return difference - box; // {\n}\n}"
        two = "namespace rodwake::granular {\ninline double nearest(double d,\n                      double box) { return 0.0; }\n}"
        self.assertEqual(twice({"a.hpp": one, "b.hpp": two}), {"rodwake::granular::nearest(double,double)": ["a.hpp", "b.hpp"]})
        self.assertEqual(twice({"a.hpp": one, "b.hpp": two.replace("granular", "measure")}), {})
        self.assertEqual(twice({"a.hpp": one, "b.hpp": two.replace("double d,", "float d,")}), {})  # an overload
        self.assertEqual(twice({"a.hpp": one, "b.cpp": two.replace("double box) { return 0.0; }", "double box);")}), {})
        self.assertEqual(twice({"a.hpp": one, "b.cpp": "namespace rodwake::granular { namespace {" + two.split("{", 1)[1] + "}"}), {})

    def test_two_classes_of_one_name_are_seen(self):
        for kind in ("struct", "class", "enum class"):
            one = f'namespace rodwake::rods {{\n{kind} Cells {{ int a; }};\nstd::string s = "}}";\n}}'
            self.assertEqual(twice({"a.cpp": one, "b.cpp": one}), {"rodwake::rods::Cells": ["a.cpp", "b.cpp"]})
            hidden = one.replace("rods {", "rods { namespace {") + "}"
            self.assertEqual(twice({"a.cpp": one, "b.cpp": hidden}), {})


if __name__ == "__main__":
    rodwake.main()
