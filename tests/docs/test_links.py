"""Pages as text: every link and anchor leads somewhere, the site's contents hold every page, lists are lists to every reader."""

import re
import sys
import tempfile
import unittest
from pathlib import Path

import rodwake
from rodwake import SOURCE

sys.path.insert(0, str(SOURCE / "tools/site_parts"))
import links  # noqa: E402

ROOT_PAGES = ["README.md", "CHANGELOG.md", "CONTRIBUTING.md"]
PAGES = [*ROOT_PAGES, *sorted(f"docs/{path.name}" for path in (SOURCE / "docs").glob("*.md"))]
REPORTS = sorted(f"studies/reports/{path.name}" for path in (SOURCE / "studies/reports").glob("*.md"))  # linked from pages, not in the site
ITEM = re.compile(r"\s*([*-]|\d+\.) ")
VERDICTS = ("matches", "differs", "inconclusive")
NUMBER = re.compile(r"(?<![\w.])\d[\d.]*(?: \d{3}\b)*(?:e-?\d+)?")


# Numbers that more than one page has, as each of them writes it. The first is where the number was measured or is counted. Those of
# docs/validation.md and docs/benchmarks.md are compared with their reports one by one.
QUOTED = (
    ("142 times", ("studies/reports/granular", "docs/benchmarks")), ("0.46 to 0.76", ("studies/reports/house", "docs/benchmarks")),
    ("-10.11", ("studies/reports/granular", "docs/findings", "studies/reports/measure", "studies/reports/bed")),
    ("507", ("studies/reports/rods",)), ("351", ("studies/reports/rods",)), ("601", ("studies/reports/rods", "docs/benchmarks")), ("0.60 s", ("docs/cpp",)),
    ("36 tried", ("studies/reports/house",)), ("`gamma2` | 16 |", ("docs/extending",)), ("16, 6", ("studies/reports/house",)),
    ("$|\\theta'|\\,\\alpha r^2/4", ("docs/theory", "docs/memory", "docs/findings")), ("parameters of a line", ("docs/findings", "studies/reports/measure")))
# What pages said that was wrong or is no more so.
GONE = ("auxetic media", "129 times less", "1.06 times", "-10.9 a", "-10.9 ±", "1.2 s a right-hand side", "14 tried", "Assumed, not yet measured",
        "\\xi/v_0 \\ll", "Every number stands", "hard discs near melting", "rod's stiffness holds", "*Soft*", "needs 455",
        "decay length of the theory", "begins to fade", "In the crystal its rows turn the rods", "its rows do, then")


def rows_of(text):
    """Cells of the rows of all tables."""
    return [[cell.strip() for cell in re.split(r"(?<!\\)\|", line)[1:-1]] for line in text.splitlines() if line.startswith("| ")]


def missing_numbers(cell, sources):
    """Numbers of a cell that no source has. Powers of ten of an equation are the text's own."""
    numbers = NUMBER.findall(re.sub(r"\$[^$]*\$", "", cell))
    plain = re.sub(r"(?<=\d) (?=\d{3}\b)", "", " ".join(sources))
    known = set(NUMBER.findall(plain))
    return [number for number in numbers if number.replace(" ", "").rstrip(".") not in known]


def in_contents(text):
    """The pages that the contents of mkdocs.yml name."""
    return re.findall(r"^ +- [^:]+: (\S+\.md)$", text[text.index("\nnav:"):], re.MULTILINE)


def lists_without_blank(text):
    """Lines at which a list follows a paragraph at once: GitHub shows a list, others one long line."""
    found, before = [], ""
    for number, line in links.outside_code(text):
        if ITEM.match(line) and not line.startswith(" ") and before.strip() and not ITEM.match(before) and not before.startswith(" "):
            found.append(number)
        before = line
    return found


def long_lines(text):
    """Lines above 120 characters that are neither table, equation, image nor comment."""
    return [number for number, line in links.outside_code(text)
            if len(line) > 120 and not line.lstrip().startswith(("|", "![", "<!--")) and "\\" not in line and "$$" not in line]


def split_links(text):
    """Lines at which a link ends into the tree that began on the line before: the checks here and the site read such a link on one line."""
    return [number for number, line in links.outside_code(text) if re.match(r"[^\[]*\]\((?!https?:)[\w./#-]+\)", line)]


class PagesTest(unittest.TestCase):
    def test_links_lead_somewhere(self):
        self.assertGreater(sum(len(list(links.links(page, (SOURCE / page).read_text()))) for page in PAGES), 50)
        self.assertEqual(links.broken(SOURCE, PAGES + REPORTS), [])

    def test_contents_hold_every_page(self):
        named = in_contents((SOURCE / "mkdocs.yml").read_text())
        self.assertEqual(sorted(named), sorted(page.removeprefix("docs/") for page in PAGES))

    def test_lists_and_lines(self):
        for page in PAGES:
            text = (SOURCE / page).read_text()
            self.assertEqual(lists_without_blank(text), [], page)
            self.assertEqual(split_links(text), [], page)
            if page != "docs/scene.md":  # made by the program
                self.assertEqual(long_lines(text), [], page)

    def test_one_count_of_the_papers_rows(self):
        """docs/paper.md has them; the first line of its verdicts and README repeat how many match, differ and are inconclusive."""
        paper = (SOURCE / "docs/paper.md").read_text()
        rows = tuple(paper.count(f"| **{verdict}**") for verdict in VERDICTS)
        self.assertGreater(min(rows), 10)
        for page, words in (("docs/paper.md", "{} matches, {} differs, {} inconclusive"), ("README.md", "{} agree, {} disagree and {} are inconclusive")):
            self.assertIn(words.format(*rows), " ".join((SOURCE / page).read_text().split()), page)

    def test_pages_agree_on_what_they_quote(self):
        for words, pages in QUOTED:
            for page in pages:
                self.assertTrue(words in " ".join((SOURCE / f"{page}.md").read_text().split()), f"{page} has no {words}")
        for page in [page for page in PAGES if page != "CHANGELOG.md"]:
            text = " ".join((SOURCE / page).read_text().split())
            self.assertEqual([words for words in GONE if words in text], [], page)

    def test_claims_have_the_numbers_of_their_reports(self):
        """A row of docs/validation.md: what, against what, how good, where, what it means. "The same" is the report of the row above."""
        page, claims, report = "docs/validation.md", 0, ""
        for cells in rows_of((SOURCE / page).read_text()):
            if len(cells) != 5 or cells[0] == "claim":
                continue
            named = {link.target for link in links.links(page, cells[3])}
            report = [(SOURCE / name).read_text() for name in named] or report
            self.assertEqual(missing_numbers(cells[2], report), [], cells)
            claims += 1
        self.assertEqual(claims, 25)

    def test_benchmarks_are_those_of_the_reports(self):
        reports = [(SOURCE / name).read_text() for name in REPORTS]
        rows = rows_of((SOURCE / "docs/benchmarks.md").read_text())
        self.assertGreater(len(rows), 30)
        for cells in rows:
            self.assertEqual(missing_numbers("; ".join(cell for cell in cells if not cell.startswith("`")), reports), [], cells)

    def test_equations_have_numbers_of_their_own(self):
        for page in PAGES:
            tags = re.findall(r"\\tag\{(\w+)\}", (SOURCE / page).read_text())
            self.assertEqual(sorted(tags), sorted(set(tags)), page)

    def test_certificates_are_verified(self):
        """Rounding is allowed for, not enclosed, so nothing is proved."""
        for page in [page for page in PAGES if page not in ("CHANGELOG.md", "docs/scene.md")]:
            text = re.sub(r"not proved|, not proved", "", (SOURCE / page).read_text())
            self.assertEqual(re.findall(r".*\bproved\b.*", text), [], page)

    def test_one_version(self):
        """CMakeLists.txt has it; the record to cite and the changelog repeat it."""
        version = re.search(r"^project\(rodwake VERSION (\S+)", (SOURCE / "CMakeLists.txt").read_text(), re.MULTILINE)[1]
        self.assertEqual(re.search(r"^version: (\S+)$", (SOURCE / "CITATION.cff").read_text(), re.MULTILINE)[1], version)
        self.assertEqual(re.search(r"^## (\d\S*)", (SOURCE / "CHANGELOG.md").read_text(), re.MULTILINE)[1], version)


class CheckTest(unittest.TestCase):
    """What the checks above would find."""

    def test_broken_links(self):
        with tempfile.TemporaryDirectory() as name:
            root = Path(name)
            (root / "docs").mkdir()
            (root / "docs/a.md").write_text("# A b, c\n## `Two` things\n## Same\n## Same\n[up](../README.md) [me](#a-b-c)\n"
                                            "[no](#a-b) `[code](gone.md)` [web](https://example.org/gone.md)\n```\n[x](gone.md)\n```\n"
                                            "![image](images/gone.png)\n")
            (root / "README.md").write_text("[a](docs/a.md#two-things) [s](docs/a.md#same-1)\n[gone](docs/a.md#three) [out](../x.md)\n")
            self.assertEqual(links.broken(root, ["README.md", "docs/a.md"]), [
                "README.md:2: docs/a.md has no heading #three", "README.md:2: there is no ../x.md",
                "docs/a.md:6: docs/a.md has no heading #a-b", "docs/a.md:10: there is no docs/images/gone.png"])

    def test_contents(self):
        self.assertEqual(in_contents("x:\n  - Not: this.md\nnav:\n  - Start:\n      - A: a.md\n  - B, c: b.md\n"), ["a.md", "b.md"])

    def test_lists(self):
        self.assertEqual(missing_numbers("0.46 to 3.5e-7, $10^8$ of 23 400 points in 12", ["0.46", "3.5e-7", "23 400 us"]), ["12"])
        self.assertEqual(split_links("[a](b.md)\n[a\nlink](b.md#c)\n$x\\right](y + z)$\n"), [3])
        self.assertEqual(rows_of("| a | b \\| c |\n|---|---|\ntext\n"), [["a", "b \\| c"]])
        self.assertEqual(lists_without_blank("Text\n* no list\n\n* one\n  more\n* two\n\n1. x\n"), [2])
        self.assertEqual(long_lines("x" * 60 + " " + "y" * 60 + "\n| " + "z " * 70 + "|\n"), [1])


if __name__ == "__main__":
    rodwake.main()
