"""The unit of every number of every result file against what is in it.

Physics does not know our units: a bed whose lengths, times and masses are those of another times 4, 2 and 512 does the same (gravity stays,
4/2^2; all factors are powers of two, so rounding stays too). A number must then grow as its declared unit says; one in m/s that is called
a/s does not. The same with scenes of the theory in SI. Prefixes and radians are beyond this; test_measure.py compares values."""

import csv
import json
import math
import re
import shutil
import unittest

import h5py
import numpy as np
from rodwake import ProgramTest

L, T, M = 4.0, 2.0, 512.0
BASE = {"m": L, "s": T, "kg": M, "N": M * L / T**2, "J": M * L**2 / T**2, "Hz": 1 / T} | dict.fromkeys(
    ("", "1", "a", "rad", "deg", "runs", "radii"), 1.0)
WITHOUT = re.compile(r"cpu_seconds|wall_seconds|cost\..*|solver\.(rtol|atol|field_tolerance|director_drift)")  # of the machine
SAME = 1e-4  # of the largest of its kind: fits of decays end within 1e-5 of their values; a wrong unit is off by 2 at least
ATTRIBUTES = {"bead_radius": "m", "spacing": "a", "mean_speed_a_per_s": "a/s", "offset_x": "a", "offset_y": "a", "phi_b": "1",
              "eta": "1", "nu": "1", "alpha": "1", "xi": "m", "kappa": "1/s", "gamma1": "m/s", "gamma2": "m/s", "time": "s",
              "min_separation": "m", "contact_distance": "m", "at": "m"}  # of result.h5 and measure.h5
H5MD = {"position/value": "m", "velocity/value": "m/s", "time": "s", "edges/value": "m", "mass": "kg", "radius": "m",
        "angular_momentum/value": "kg m^2/s"}
PARAMETERS = {"bead_radius": "m", "box": "m", "gap": "m", "frequency": "1/s", "gamma": "1", "amplitude": "m", "gravity": "m/s^2",
              "time_step": "s", "run": "1", "phi_b": "1", "beads_fraction": "1", "order_cutoff": "m"}


def growth(unit):
    """By what a number in this unit grows; KeyError for a unit that is none."""
    above, _, below = unit.replace("(", "").replace(")", "").partition("/")
    return math.prod(BASE[name] ** int(power or 1) for name, power in re.findall(r"([A-Za-z]+|1)\^?(-?\d+)?", above)) / math.prod(
        BASE[name] ** int(power or 1) for name, power in re.findall(r"([A-Za-z]+|1)\^?(-?\d+)?", below))


def bed(length, time, mass):
    a, s, rho = 0.4e-3 * length, time, mass / length**3
    rod = f"""[[granular.rods]]
position = ["8 a", "{{}} a"]
length = {4.5e-3 * length}
thick_diameter = {1.1e-3 * length}
thin_diameter = {0.8e-3 * length}
density = {8500 * rho}
"""
    return f"""schema = 1
[granular]
bead_radius = {a}
bead_density = {2700 * rho}
phi_b = 0.8
box = "32 a"
start_speed = {0.02 * length / time}
time_step = {1e-4 * s}
equilibrate = {0.05 * s}
duration = {1.0 * s}
runs = 2
plates = {{ gap = {1.2e-3 * length}, frequency = {200 / s} }}
output = {{ frames = {0.025 * s}, table = {0.01 * s} }}
{rod.format(8)}{rod.format(24)}[measure]
order = true
order_interval = {0.05 * s}
order_cutoff = "2.9 a"
microrheology = true
flow = true
flow_lag = {0.05 * s}
displacement = "phase"
pairs = true
force = true
phonons = true
phonon_interval = {0.005 * s}
mechanics = true
heading_diffusion = true
block = {0.25 * s}
[rods_order]
link = "8 a"
block = {0.2 * s}
"""


def theory(length, time, more):
    a, s, v = length, time, length / time
    return f"""schema = 1
units = "si"
[scales]
f_over_mu = {1e-3 * a}
v0 = {2e-3 * v}
[medium]
eta = 1.0
xi = {1e-3 * a}
[coupling]
kappa = {1.0 / s}
gamma1 = {1e-3 * v}
[[rods]]
position = [0.0, {2e-3 * a}]
[[rods]]
position = [0.0, {-2e-3 * a}]
[rods_run]
t_end = {4.0 * s}
output_interval = {0.5 * s}
contact_distance = {1e-4 * a}
""" + more(a, s)


def fields(a, s):
    return f"""[field]
x = [{-2e-3 * a}, {2e-3 * a}]
y = [{-2e-3 * a}, {2e-3 * a}]
nx = 5
ny = 5
[[field.cuts]]
along = "x"
at = {1e-3 * a}
from = {-2e-3 * a}
to = {2e-3 * a}
count = 5
[rods_order]
link = {3e-3 * a}
from = {1.0 * s}
"""


def noisy(a, s):
    return f"""[noise]
rotational_diffusion = {0.02 / s}
translational_diffusion = {1e-8 * a**2 / s}
runs = 8
"""


def scanned(a, s):
    return f"""[scan]
design = "grid"
[[scan.axes]]
key = "coupling.kappa"
from = {0.5 / s}
to = {4.0 / s}
count = 3
[[scan.axes]]
key = "rods.1.position.0"
from = {-2e-3 * a}
to = {2e-3 * a}
count = 3
"""


def numbers(node, name=""):
    """(dotted name, number) of what a JSON file holds and needs a unit: counts and flags, which are whole, do not."""
    if isinstance(node, (dict, list)):
        for key, value in node.items() if isinstance(node, dict) else enumerate(node):
            yield from numbers(value, f"{name}.{key}" if name else str(key))
    elif isinstance(node, float):
        yield name, node


def text(attribute):
    return attribute.decode() if isinstance(attribute, bytes) else str(attribute)


class UnitsTest(ProgramTest):
    def compare(self, scene, *verbs):
        """Every file of two runs; returns their names."""
        for folder, scale in (("one", (1.0, 1.0, 1.0)), ("other", (L, T, M))):
            self.write(f"{folder}.toml", scene(*scale))
            shutil.rmtree(self.folder / folder, ignore_errors=True)
            for verb in verbs:
                self.expect(0, verb, f"{folder}.toml", "-o", folder, "--quiet", "-j", 1)
        files = json.loads((self.folder / "one/manifest.json").read_text())["files"]
        self.checked, self.wrong = 0, []
        for name, entry in files.items():
            if name.endswith(".csv"):
                self.table(name, {column["name"]: column["unit"] for column in entry["columns"]})
            elif name.endswith(".json") and "values" in entry:
                self.record(name, {value["name"]: value["unit"] for value in entry["values"]})
            elif name.endswith((".h5", ".h5md")):
                self.datasets(name)
        self.assertFalse(self.wrong, "\n".join(self.wrong))
        return set(files)

    def pair(self, name):
        return self.folder / "one" / name, self.folder / "other" / name

    def grows(self, what, unit, one, other):
        one, other = (np.atleast_1d(np.asarray(part, dtype=float)) for part in (one, other))
        expected = growth(unit) * one
        size = np.nanmax(np.abs(expected), initial=0.0)
        self.checked += one.size
        if not np.allclose(other, expected, rtol=0, atol=SAME * size, equal_nan=True):
            row = int(np.nanargmax(np.nan_to_num(np.abs(other - expected), nan=np.inf)))
            self.wrong.append(f"{what}: {one[row]:.9g} {unit} became {other[row]:.9g}, not {expected[row]:.9g}")

    def table(self, name, units):
        first, second = (list(csv.DictReader(line for line in file.read_text().splitlines() if not line.startswith("#")))
                         for file in self.pair(name))
        for column in first[0]:
            texts = [row[column] for row in first]
            if not re.search(WITHOUT, column) and any(re.fullmatch(r"[-+.\de]+", text) for text in texts):
                self.grows(f"{name} {column}", units[column], *([float(row[column] or "nan") for row in rows] for rows in (first, second)))

    def record(self, name, units):
        first, second = (dict(numbers(json.loads(file.read_text()))) for file in self.pair(name))
        for key, value in first.items():
            parts = key.split(".")
            known = next((end for end in range(len(parts), 0, -1) if ".".join(parts[:end]) in units), None)
            if re.fullmatch(WITHOUT, key):
                continue
            if known is None:
                self.wrong.append(f"{name} {key}: no unit is declared")
            else:
                self.grows(f"{name} {key}", units[".".join(parts[:known])], value, second.get(key, math.nan))

    def datasets(self, name):
        """By the attribute `unit` of each dataset, in H5MD by its name; attributes by theirs."""
        one, other = (h5py.File(file) for file in self.pair(name))
        with one, other:
            one.visititems(lambda place, item: self.dataset(name, place, item, other[place]))
            for key, value in one.attrs.items():
                self.attribute(name, key, ATTRIBUTES, value, other.attrs[key])

    def dataset(self, name, place, one, other):
        for key, value in one.attrs.items():
            self.attribute(f"{name} /{place}", key, PARAMETERS if place == "parameters" else ATTRIBUTES, value, other.attrs[key])
        if isinstance(one, h5py.Dataset) and one.size and one.dtype.kind == "f":
            by_name = (unit for end, unit in H5MD.items() if place.endswith(end))
            unit = text(one.attrs["unit"]) if "unit" in one.attrs else next(by_name, None) if name.endswith(".h5md") else None
            if unit is not None:
                self.grows(f"{name} /{place}", unit, one[()].ravel(), other[()].ravel())

    def attribute(self, where, key, units, one, other):
        if isinstance(one, (float, np.floating)) and key not in units:
            self.wrong.append(f"{where} {key}: no unit is known")
        elif isinstance(one, (float, np.floating)):
            self.grows(f"{where} {key}", units[key], one, other)

    def test_bed(self):
        files = self.compare(bed, "dem", "measure")
        for name in ("measure.json", "summary.json", "tracks.csv", "table.csv", "runs.csv", "pairs.csv", "phonons.csv", "heading.csv"):
            self.assertTrue(any(file.endswith(name) for file in files), name)
        self.assertGreater(self.checked, 10000)

    def test_theory(self):
        for more, verbs, name in ((fields, ("rods", "field"), "rods_order.json"), (noisy, ("rods",), "noise.json"),
                                  (scanned, ("scan",), "scan.csv")):
            with self.subTest(name):
                self.assertIn(name, self.compare(lambda length, time, _, more=more: theory(length, time, more), *verbs))

    def test_a_wrong_unit_is_seen(self):
        self.checked, self.wrong = 0, []
        self.grows("speed", "a/s", 1e-3, 1e-3 * L / T)
        self.grows("speed", "m/s", 1e-3, 1e-3 * L / T)
        self.assertEqual(self.wrong, ["speed: 0.001 a/s became 0.002, not 0.0005"])
        for unit, expected in (("kg/m^2", M / L**2), ("({length})/(s)".format(length="m"), L / T), ("a^-2", 1.0), ("N s", M * L / T), ("m s-1", L / T)):
            self.assertEqual(growth(unit), expected, unit)


if __name__ == "__main__":
    unittest.main()
