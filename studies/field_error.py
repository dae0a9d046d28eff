"""Worst relative error (vector or tensor norm) of `rodwake field --points` against a table of reference values.

Run: studies/field_error.py build/release/rodwake tests/data/elastic_field.csv
"""
import csv
import math
import subprocess
import sys

QUANTITIES = {"U": ("Ux", "Uy"), "strain": ("exx", "exy", "exy", "eyy"), "lap u": ("lapx", "lapy"),
              "grad div u": ("gradx_tr", "grady_tr"), "dipole": ("dipUx", "dipUy")}


def rows(lines):
    return list(csv.DictReader(line for line in lines if not line.startswith("#")))


def error(got, want, names):
    difference = math.hypot(*(float(got[name]) - float(want[name]) for name in names))
    return difference / math.hypot(*(float(want[name]) for name in names))


program, table = sys.argv[1:3]
answer = subprocess.run([program, "field", "--points", table], capture_output=True, text=True, check=True).stdout
with open(table) as file:
    reference = rows(file)
results = rows(answer.splitlines())
assert len(results) == len(reference) > 0, "not one answer a point"
for quantity, names in QUANTITIES.items():
    worst = max(error(got, want, names) for got, want in zip(results, reference))
    print(f"{quantity:<12} worst relative error {worst:.1e} over {len(reference)} points")
