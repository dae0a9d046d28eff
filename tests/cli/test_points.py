"""rodwake field --points: the field at the points of a table, and what is wrong with a table."""

import csv
import math
import os
from unittest import mock

import rodwake
from rodwake import SOURCE, ProgramTest

HEADER = "x,y,xi,eta,Ux,Uy,exx,exy,eyy,lapx,lapy,gradx_tr,grady_tr,dipUx,dipUy"
# Vectors and tensors: the components of each. A tensor's xy component counts twice in its norm.
QUANTITIES = [("Ux", "Uy"), ("exx", "exy", "exy", "eyy"), ("lapx", "lapy"), ("gradx_tr", "grady_tr"), ("dipUx", "dipUy")]
# What include/rodwake/elastic/field.hpp guarantees, in each quantity's norm.
TOLERANCE = 2e-13


def rows_of(text):
    lines = (line for line in text.splitlines() if not line.startswith("#"))
    return [{name: float(value) for name, value in row.items()} for row in csv.DictReader(lines)]


def worst_error(rows, expected, quantities=QUANTITIES):
    """Largest relative error of any quantity of any row."""
    worst = 0.0
    for row, wanted in zip(rows, expected, strict=True):
        for names in quantities:
            norm = math.hypot(*(wanted[n] for n in names))
            worst = max(worst, math.hypot(*(row[n] - wanted[n] for n in names)) / norm)
    return worst


class PointsTest(ProgramTest):
    def points(self, text, code=0, **options):
        self.write("points.csv", text)
        return self.expect(code, "field", "--points", "points.csv", **options)

    def failed(self, text, pattern):
        """One bad point: nan in its row, the others as ever, exit 3."""
        self.write("points.csv", text)
        done = self.expect(3, "field", "--points", "points.csv")
        self.assertRegex(done.stderr, pattern)
        bad = [row for row in rows_of(done.stdout) if math.isnan(row["Ux"])]
        self.assertEqual(len(bad), 1)
        self.assertIn("1 of ", done.stderr)
        self.assertTrue(all(math.isnan(bad[0][name]) for names in QUANTITIES for name in names))

    def refused(self, text, pattern):
        self.write("points.csv", text)
        return self.refuse(2, pattern, "field", "--points", "points.csv")

    def test_reference_table(self):
        table = SOURCE / "tests/data/elastic_field.csv"
        expected = rows_of(table.read_text())
        self.assertGreater(len(expected), 300)
        out = self.expect(0, "field", "--points", table).stdout
        self.assertEqual(out.splitlines()[0], HEADER)
        rows = rows_of(out)
        for row, wanted in zip(rows, expected, strict=True):  # inputs come back to the bit
            self.assertEqual([row[n] for n in ("x", "y", "xi", "eta")], [wanted[n] for n in ("x", "y", "xi", "eta")])
        self.assertLess(worst_error(rows, expected), TOLERANCE)

    def test_the_comparison_can_fail(self):
        good = {n: 1.0 for names in QUANTITIES for n in names}
        self.assertEqual(worst_error([good], [good]), 0.0)
        for name in good:
            self.assertGreater(worst_error([{**good, name: 1.0 + 4 * TOLERANCE}], [good]), TOLERANCE, name)
        with self.assertRaises(ValueError):
            worst_error([good], [good, good])

    def test_any_order_extra_columns_comments_line_ends_and_forms_of_numbers(self):
        plain = self.points("x,y,xi,eta\n-1.5,0.25,100,0.5\n2,-3,0.1,-0.5\n").stdout
        self.assertEqual(self.points("# comment\r\nname,eta,y,xi,Ux,x\r\nrod one,5e-1,+.25,1E2,,-1.5\r\n\r\n"
                                     "#\r\n,-0.5, -3 ,1e-1,nan,2.0e0").stdout, plain)
        self.assertEqual(self.points("\ufeffx,y,xi,eta\n-1.5,0.25,100,0.5\n2,-3,0.1,-0.5\n").stdout, plain)
        self.assertEqual(len(rows_of(plain)), 2)

    def test_quotes_and_an_empty_column_of_boxes(self):
        plain = self.points("x,y,xi,eta\n1,2,3,4\n5,6,7,8\n").stdout
        self.assertEqual(self.points('"x","y",xi,"eta"\n"1","2",3,4\n5,6,"7",8\n').stdout, plain)
        self.assertEqual(self.points('x,y,xi,eta,L\n1,2,3,4,\n5,6,7,8,""\n').stdout, plain)
        self.refused('"x",y,xi,eta\n"1,2,3,4\n', r"points\.csv:2:1: a quote is opened and not closed")

    def test_points_go_to_standard_output_only(self):
        self.write("points.csv", "x,y,xi,eta\n1,1,1,1\n")
        self.refuse(2, "--output: field --points writes to standard output", "field", "--points", "points.csv", "-o", "out")
        self.refuse(2, "--threads: field --points makes no use of it", "field", "--points", "points.csv", "-j", "2")
        self.refuse(2, "--backend: applies to --points only", "field", rodwake.THEORY_PAIR, "--backend", "exact")

    def test_seventeen_digits(self):
        text = self.points("x,y,xi,eta\n0.1,0.30000000000000004,1,1\n").stdout.splitlines()[1]
        self.assertTrue(text.startswith("0.10000000000000001,0.30000000000000004,1,1,"))
        for field in text.split(","):
            self.assertEqual(f"{float(field):.17g}", field)

    def test_header_only(self):
        self.assertEqual(self.points("x,y,xi,eta\n").stdout, HEADER + "\n")

    def test_points_outside_the_domain(self):
        self.failed("x,y,xi,eta\n1,1,1,1\n\n0,0,1,1\n", r"points\.csv:4:1: ")
        self.failed("x,y,xi,eta\n1,1,0,1\n", r"points\.csv:2:1: .*xi")
        self.failed("x,y,xi,eta\n1,1,-2,1\n", r"points\.csv:2:1: .*xi")
        self.failed("x,y,xi,eta\n1,1,1,-1\n", r"points\.csv:2:1: .*eta")
        self.failed("x,y,xi,eta\n1,1,1,-3\n", r"points\.csv:2:1: .*eta")

    def test_tables_that_cannot_be_read(self):
        self.refused("", r"points\.csv: no header line; expected at least x,y,xi,eta")
        self.refused("x,y,eta\n1,1,1\n", r'points\.csv:1:1: no column "xi"')
        self.refused("x,y,xi,eta\n1,1,1,1\n1,one,1,1\n", r'points\.csv:3:3: y: expected a number, found "one"')
        self.refused("x,y,xi,eta\n1,1,nan,1\n", r"points\.csv:2:5: xi = nan: must be finite")
        self.refused("x,y,xi,eta\n1,1,1\n", r"points\.csv:2:\d+: 3 fields, but the header has 4")
        self.refused("x,y,xi,eta\n1,,1,1\n", r"points\.csv:2:3: y: expected a number")
        self.refuse(2, "nope.csv: cannot read", "field", "--points", "nope.csv")
        self.refuse(2, "is a folder", "field", "--points", ".")

    def test_periodic_boxes_of_the_reference(self):
        table = SOURCE / "tests/data/periodic_field.csv"
        expected = rows_of(table.read_text())
        self.assertEqual(len(expected), 60)
        out = self.expect(0, "field", "--points", table).stdout
        self.assertEqual(out.splitlines()[0], HEADER)
        worst = worst_error(rows_of(out), expected, QUANTITIES[:2])
        self.assertLess(worst, 1e-10)  # what include/rodwake/elastic/periodic.hpp promises
        expected[7]["exy"] *= 1 + 1e-6
        self.assertGreater(worst_error(rows_of(out), expected, QUANTITIES[:2]), 1e-10)

    def test_a_box_changes_only_the_rows_that_have_it(self):
        plain = self.points("x,y,xi,eta\n0.1,0.2,3,1\n0.3,-0.2,3,1\n0.3,0.1,2,5\n").stdout.splitlines()
        mixed = self.points("L,x,y,xi,eta\n,0.1,0.2,3,1\n2,0.3,-0.2,3,1\n,0.3,0.1,2,5\n").stdout.splitlines()
        self.assertEqual([plain[1], plain[3]], [mixed[1], mixed[3]])
        self.assertNotEqual(plain[2], mixed[2])
        moved = rows_of(self.points("x,y,xi,eta,L\n0.3,-0.2,3,1,2\n2.3,-4.2,3,1,2\n0.3,-0.2,3,1.5,2\n0.3,-0.2,3,1,2\n").stdout)
        self.assertLess(worst_error([moved[1]], [moved[0]]), 1e-12)  # rounding of 2.3 - 2
        self.assertGreater(worst_error([moved[2]], [moved[0]]), 1e-3)
        self.assertEqual(moved[3], moved[0])

    def test_bad_boxes(self):
        for box in ("0", "-2"):
            self.failed(f"x,y,xi,eta,L\n1,1,1,1,\n1,1,1,1,{box}\n", rf"points\.csv:3:1: box = {box}: .* > 0")
        self.refused("x,y,xi,eta,L\n1,1,1,1,inf\n", r"points\.csv:2:\d+: ")
        self.failed("x,y,xi,eta,L\n1,1,1,1,1e9\n", r"points\.csv:2:1: box = 1e\+09: .*infinite plane")
        self.failed("x,y,xi,eta,L\n1,1,1,1,5\n10,-5,1,1,5\n", r"points\.csv:3:1: field at x = 10, y = -5: .*singular there, at the rod or one of its images")
        self.failed("x,y,xi,eta,L\n1,1,1,-2,5\n", r"points\.csv:2:1: .*eta")

    def test_tables(self):
        places = [(0.05 * 1.005**k, 2.4 * k) for k in range(1200)]
        text = "x,y,xi,eta\n" + "".join(f"{r * math.cos(a):.17g},{r * math.sin(a):.17g},2,1.3\n" for r, a in places)
        exact = rows_of(self.points(text).stdout)
        keep = {"XDG_CACHE_HOME": str(self.folder / "cache")}
        with mock.patch.dict(os.environ, keep):
            table = ["field", "--points", "points.csv", "--backend", "table", "--table-tolerance", "1e-2"]
            rows = rows_of(self.expect(0, *table).stdout)
            self.assertEqual(rows_of(self.expect(0, *table).stdout), rows)  # the second time from the file
        self.assertEqual(len(list((self.folder / "cache" / "rodwake").glob("plane-*.rwt"))), 1)
        strain = [("exx", "exy", "exy", "eyy")]
        self.assertLess(worst_error(rows, exact, strain), 1e-2)
        self.assertGreater(worst_error(rows, exact, strain), 1e-5)  # and it did come from the table
        self.assertEqual(worst_error(rows, exact, [("Ux", "Uy")]), 0.0)

    def test_what_is_not_available_is_said(self):
        self.write("points.csv", "x,y,xi,eta\n1,1,1,1\n")
        self.refuse(2, "--table-tolerance: .*--backend table", "field", "--points", "points.csv", "--table-tolerance", "1e-6")
        self.refuse(2, "backend", "field", "--points", "points.csv", "--backend", "magic")

    def test_dry_run_checks_and_prints_nothing(self):
        self.write("points.csv", "x,y,xi,eta\n1,1,1,1\n")
        done = self.expect(0, "field", "--points", "points.csv", "--dry-run")
        self.assertEqual(done.stdout, "")
        self.write("points.csv", "x,y,xi,eta\n0,0,1,1\n")
        self.refuse(3, "points.csv:2:1", "field", "--points", "points.csv", "--dry-run")

    def test_standard_input(self):
        text = "x,y,xi,eta\n1,2,3,4\n0,0,1,1\n"
        piped = self.expect(3, "field", "--points", "-", input=text)
        self.assertIn("standard input:3:1: ", piped.stderr)
        self.assertEqual(piped.stdout, self.points(text, 3).stdout)


if __name__ == "__main__":
    rodwake.main()
