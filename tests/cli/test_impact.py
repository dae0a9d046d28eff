"""rodwake impact --cases: the contact law at the rows of a table, and what is wrong with a table."""

import csv
import math

import rodwake
from rodwake import SOURCE, ProgramTest

HEADER = "Px,Py,Pz,wx,wy,wz"
INPUT = "Kxx,Kxy,Kxz,Kyy,Kyz,Kzz,vx,vy,vz,mu,e"
TOLERANCE = 1e-12  # what include/rodwake/granular/impact.hpp says, and the accuracy of the table


def rows_of(text):
    lines = (line for line in text.splitlines() if not line.startswith("#"))
    return list(csv.DictReader(lines))


def error_of(row, wanted):
    """Relative error of the impulse."""
    p = [float(wanted[n]) for n in ("Px", "Py", "Pz")]
    return math.dist([float(row[n]) for n in ("Px", "Py", "Pz")], p) / math.hypot(*p)


class ImpactTest(ProgramTest):
    def cases(self, *rows, header=INPUT):
        self.write("cases.csv", "\n".join((header, *rows)) + "\n")
        return self.expect(0, "impact", "--cases", "cases.csv").stdout

    def refused(self, pattern, *rows, header=INPUT):
        self.write("cases.csv", "\n".join((header, *rows)) + "\n")
        return self.refuse(2, pattern, "impact", "--cases", "cases.csv").stderr

    def test_reference_table(self):
        table = SOURCE / "tests/granular/data/stronge_impacts.csv"
        expected = rows_of(table.read_text())
        self.assertEqual(len(expected), 240)
        out = self.expect(0, "impact", "--cases", table).stdout
        self.assertEqual(out.splitlines()[0], HEADER)
        for row, wanted in zip(rows_of(out), expected, strict=True):
            self.assertLess(error_of(row, wanted), TOLERANCE)

    def test_the_comparison_can_fail(self):
        good = {"Px": 1.0, "Py": 0.5, "Pz": 2.0}
        self.assertEqual(error_of(good, good), 0.0)
        for name in good:
            self.assertGreater(error_of({**good, name: good[name] + 1e-11}, good), TOLERANCE)

    def test_closed_forms(self):
        text = self.cases("1,0,0,1,0,2,3,4,-1,0,0.5", "3.5,0,0,3.5,0,1,0.3,0.4,-1,0.5,1", "1,0,0,1,0,1,1,2,0.5,0.3,0.3")
        rows = [[float(x) for x in line.split(",")] for line in text.splitlines()[1:]]
        for row, wanted in zip(rows, ([0, 0, 0.75, 3, 4, 0.5], [-0.6 / 7, -0.8 / 7, 2, 0, 0, 1], [0, 0, 0, 1, 2, 0.5]),
                               strict=True):
            for x, y in zip(row, wanted, strict=True):
                self.assertAlmostEqual(x, y, delta=1e-14)  # a few roundings

    def test_any_order_extra_columns_and_comments(self):
        plain = self.cases("2,0,0.4,1,0,1,0.3,0,-3,0.5,0.7")
        self.write("other.csv", "# a comment\nkind,e,mu,vz,vy,vx,Kzz,Kyz,Kyy,Kxz,Kxy,Kxx,Px\n\nrod,0.7,0.5,-3,0,0.3,1,0,1,0.4,0,2,\n#\n")
        self.assertEqual(self.expect(0, "impact", "--cases", "other.csv").stdout, plain)

    def test_seventeen_digits(self):
        for field in self.cases("2,0.1,0.4,1,0.2,1,0.3,0.1,-3,0.1,0.7").splitlines()[1].split(","):
            self.assertEqual(f"{float(field):.17g}", field)

    def test_header_only_and_dry_run(self):
        self.assertEqual(self.cases(), HEADER + "\n")
        self.write("cases.csv", INPUT + "\n1,0,0,1,0,1,0,0,-1,0.1,0.5\n")
        self.assertEqual(self.expect(0, "impact", "--cases", "cases.csv", "--dry-run").stdout, "")

    def test_values_out_of_range_are_all_listed(self):
        text = self.refused(r"cases\.csv:2:1: mu = -0\.1: must be >= 0", "1,0,0,1,0,1,0,0,-1,-0.1,0.5",
                            "1,0,0,1,0,1,0,0,-1,0.1,1.5", "1,0,0,1,0,1,0,0,-1,0.1,-1e-9", "1,0,2,1,0,1,0,0,-1,0.1,0.5",
                            "0,0,0,0,0,0,0,0,-1,0.1,0.5", "1,1,0,1,0,1,0,0,-1,0.1,0.5")
        for pattern in (r"cases\.csv:3:1: e = 1\.5: must be from 0 to 1", r"cases\.csv:4:1: e = -1e-09",
                        r"cases\.csv:5:1: K is not positive definite", r"cases\.csv:6:1: K is not positive definite",
                        r"cases\.csv:7:1: K is not positive definite"):
            self.assertRegex(text, pattern)

    def test_results_beyond_a_double(self):
        self.refused(r"cases\.csv:2:1: .*beyond the range", "1e-200,0,0,1e-200,0,1e-200,0,0,-1e200,0.1,0.5")

    def test_tables_that_cannot_be_read(self):
        self.refused(r'cases\.csv:1:1: no column "Kyz"', header=INPUT.replace("Kyz,", ""))
        self.refused(r'cases\.csv:2:\d+: e: expected a number, found "x"', "1,0,0,1,0,1,0,0,-1,0.1,x")
        self.refused(r"cases\.csv:2:\d+: vz = nan: must be finite", "1,0,0,1,0,1,0,0,nan,0.1,0.5")
        self.refuse(2, "nope.csv: cannot read", "impact", "--cases", "nope.csv")
        self.refuse(2, "--cases is required", "impact")
        self.write("cases.csv", INPUT + "\n")
        self.refuse(2, "-o: rodwake impact has no such option", "impact", "--cases", "cases.csv", "-o", "out")


if __name__ == "__main__":
    rodwake.main()
