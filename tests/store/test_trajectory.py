"""The sample trajectories of tests/store/test_trajectory.cpp as other programs read them: h5py, MDAnalysis, ASE."""

import importlib.util
import math
import os
import shlex
import subprocess
import tempfile
import unittest
from fractions import Fraction
from pathlib import Path

import h5py
import numpy as np

import rodwake

SIDE, HEIGHT = 0.0312, 0.0014
BEADS, SPHERES, RODS = 9, 15, 2
GROUPS = ("particles/trajectory", "particles/trajectory_rods")


def installed(module):
    return importlib.util.find_spec(module) is not None


def objects(file):
    """(path, object) of everything in the file; what is linked twice comes twice."""
    def below(group):
        for name, item in group.items():
            yield item.name, item
            if isinstance(item, h5py.Group):
                yield from below(item)
    return list(below(file))


def same_object(a, b):
    return h5py.h5o.get_info(a.id).addr == h5py.h5o.get_info(b.id).addr


def is_fixed_string(owner, name):
    type_ = h5py.h5a.open(owner.id, name.encode()).get_type()
    return isinstance(type_, h5py.h5t.TypeStringID) and not type_.is_variable_str()


def attribute_problems(file):
    """Rules of metadata and attributes that the file breaks."""
    version = file["h5md"].attrs["version"]
    if version.dtype.kind != "i" or version.tolist() != [1, 1]:
        yield "h5md/version"
    if next(iter(file["particles"])) != "trajectory":
        yield "trajectory is not the first group of particles"
    for path, name in [("h5md/author", "name"), ("h5md/creator", "name"), ("h5md/creator", "version")]:
        if not is_fixed_string(file[path], name):
            yield f"{path}: {name}"
    for path, item in objects(file):
        for name in item.attrs:
            if name == "unit":
                yield f"{path} has a unit"
            if not isinstance(item.attrs[name], (np.ndarray, np.generic)) and not is_fixed_string(item, name):
                yield f"{path}: {name} is not of fixed length"


def element_problems(file, path, item, frames):
    """Rules that an element in time breaks: common step and time, as many rows as frames."""
    first = file["particles/trajectory/position"]
    for name in ("step", "time"):
        if name not in item or not same_object(item[name], first[name]):
            yield f"{path}/{name} is not the common one"
    if len(item["value"]) != frames:
        yield f"{path} has {len(item['value'])} rows"
    wanted = 1 if item["value"].shape[1:] and "box" not in path else 1024
    if item["value"].chunks[0] != wanted:
        yield f"{path} has chunks of {item['value'].chunks[0]} rows"


def box_problems(file, group):
    box = file[f"{group}/box"]
    if box.attrs["dimension"] != 3 or box.attrs["dimension"].shape != ():
        yield f"{group}: dimension"
    if not is_fixed_string(box, "boundary") or box.attrs["boundary"].tolist() != [b"periodic", b"periodic", b"none"]:
        yield f"{group}: boundary"


def problems(file):
    """Every rule of H5MD and its readers that the file breaks, in words."""
    frames = len(file["particles/trajectory/position/step"])
    found = list(attribute_problems(file))
    for group in GROUPS:
        if group in file:
            found += box_problems(file, group)
    for path, item in objects(file):
        if isinstance(item, h5py.Group) and "value" in item:
            found += element_problems(file, path, item, frames)
    return found


class SampleTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        keeper = tempfile.TemporaryDirectory(prefix="rodwake-test-")
        cls.addClassCleanup(keeper.cleanup)
        cls.folder = Path(keeper.name)
        made = subprocess.run([os.environ["RODWAKE_TEST_STORE"], "[samples]"], capture_output=True, text=True,
                              env={**os.environ, "RODWAKE_SAMPLES": keeper.name})
        if made.returncode:
            raise RuntimeError(made.stdout + made.stderr)
        cls.truth = {}
        for line in (cls.folder / "truth.txt").read_text().splitlines():
            name, *values = line.split()
            cls.truth.setdefault(name, []).append(np.array(values, dtype=float))

    def open(self, name):
        file = h5py.File(self.folder / name, "r")
        self.addCleanup(file.close)
        return file

    def assert_same_bits(self, found, wanted):
        found, wanted = np.asarray(found), np.asarray(wanted).reshape(np.shape(found))
        self.assertEqual(found.dtype, np.float64)
        np.testing.assert_array_equal(found.view(np.uint64), wanted.view(np.uint64))


class H5mdTest(SampleTest):
    def test_no_rule_is_broken(self):
        for name in ("sample.h5md", "deflated.h5md", "no_rods.h5md"):
            self.assertEqual(problems(self.open(name)), [], name)

    def test_broken_rules_are_seen(self):
        def unlink(file):
            del file["observables/plate_z/time"]
            file["observables/plate_z/time"] = file["particles/trajectory/position/time"][:]

        def variable(file):
            file["h5md/author"].attrs["name"] = "a name"

        def unit(file):
            file["particles/trajectory/position/value"].attrs["unit"] = np.bytes_("m")

        def first(file):
            file.create_group("particles/rods")

        def version(file):
            file["h5md"].attrs["version"] = np.array([1.0, 1.0])

        def short(file):
            file["observables/plate_z/value"].resize(2, axis=0)

        def boundary(file):
            file["particles/trajectory/box"].attrs["boundary"] = np.array([b"periodic"] * 3)

        for breaking, text in [(unlink, "plate_z/time is not the common one"), (variable, "h5md/author: name"),
                               (unit, "has a unit"), (first, "not the first"), (version, "h5md/version"),
                               (short, "plate_z has 2 rows"), (boundary, "trajectory: boundary")]:
            broken = self.folder / "broken.h5md"
            broken.write_bytes((self.folder / "sample.h5md").read_bytes())
            with h5py.File(broken, "r+") as file:
                breaking(file)
                self.assertIn(text, "\n".join(problems(file)))

    def test_values_keep_their_bits(self):
        for name in ("sample.h5md", "deflated.h5md"):
            file = self.open(name)
            self.assertEqual(file["particles/trajectory/position/step"][:].tolist(), [0, 500, 1000, 1500])
            self.assert_same_bits(file["particles/trajectory/position/time"], self.truth["time"])
            self.assert_same_bits(file["particles/trajectory/velocity/value"], self.truth["velocity"])
            rods = file["particles/trajectory_rods"]
            for quantity in ("velocity", "orientation", "angular_momentum"):
                self.assert_same_bits(rods[f"{quantity}/value"], self.truth[f"rod_{quantity}"])
            for number, observable in enumerate(("kinetic_energy", "plate_z")):
                self.assert_same_bits(file[f"observables/{observable}/value"], [row[number] for row in self.truth["observables"]])

    def test_positions_are_in_the_box_and_can_be_unwrapped(self):
        file = self.open("sample.h5md")
        for group, name, count in zip(GROUPS, ("position", "rod_position"), (SPHERES, RODS)):
            place, image = file[f"{group}/position/value"][:], file[f"{group}/image/value"][:]
            self.assertEqual(place.shape, (4, count, 3))
            self.assertTrue((place[..., :2] >= 0).all() and (place[..., :2] < SIDE).all())
            self.assertGreater(np.abs(image[..., :2]).max(), 1)  # the sample does leave the box
            self.assertFalse(image[..., 2].any())
            truth = np.reshape(self.truth[name], place.shape)
            self.assert_same_bits(place[..., 2].copy(), truth[..., 2].copy())
            # In exact arithmetic nothing is lost but the rounding of the place: half an ulp of the side.
            for p, i, t in zip(place[..., :2].flat, image[..., :2].flat, truth[..., :2].flat):
                self.assertLessEqual(abs(Fraction(p) + int(i) * Fraction(SIDE) - Fraction(t)), Fraction(math.ulp(SIDE)) / 2)

    def test_constants(self):
        file = self.open("sample.h5md")
        spheres = file["particles/trajectory"]
        self.assertEqual(spheres["species"][:].tolist(), [0] * BEADS + [1] * (SPHERES - BEADS))
        self.assertEqual(spheres["species"].dtype.kind, "i")
        self.assertEqual(spheres["id/value"][:].tolist(), [list(range(1, SPHERES + 1))] * 4)
        self.assert_same_bits(spheres["radius"][:BEADS], [4e-4] * BEADS)
        self.assert_same_bits(spheres["mass"][BEADS:], [5e-6] * (SPHERES - BEADS))
        self.assert_same_bits(file["particles/trajectory_rods/mass"], [1.5e-5, 1.6e-5])
        for group in GROUPS:
            self.assert_same_bits(file[f"{group}/box/edges/value"], [np.diag([SIDE, SIDE, HEIGHT])] * 4)
        self.assertEqual(file["parameters/rod_of_sphere"][:].tolist(), [0, 0, 0, 1, 1, 1])
        self.assertEqual(file["parameters"].attrs["time_step"], 2e-5)
        self.assertEqual(file["parameters/units"].attrs["length"], b"m")
        self.assertEqual(file["parameters/kinds"].attrs["rod"], 1)
        self.assertEqual(file["rodwake"].attrs["seed"], 2**64 - 1)
        self.assertEqual(file["rodwake"].attrs["command"].decode(), 'rodwake dem "zwei Stäbe.toml"')

    def test_deflated_is_smaller(self):
        self.assertTrue(self.open("deflated.h5md")["particles/trajectory/position/value"].compression)
        self.assertIsNone(self.open("sample.h5md")["particles/trajectory/position/value"].compression)


@unittest.skipUnless(installed("MDAnalysis"), "python3-mdanalysis is not installed")
class MdanalysisTest(SampleTest):
    def universe(self, name):
        import MDAnalysis
        universe = MDAnalysis.Universe.empty(SPHERES, trajectory=True, velocities=True)
        universe.load_new(str(self.folder / name), format="H5MD", convert_units=False)
        return universe

    def test_every_frame_is_read(self):
        for name in ("sample.h5md", "deflated.h5md", "no_rods.h5md"):
            file, universe = self.open(name), self.universe(name)
            self.assertEqual(universe.trajectory.n_frames, 4)
            for index, step in enumerate(universe.trajectory):
                self.assertEqual(step.time, self.truth["time"][index][0])
                self.assertEqual(step.data["step"], 500 * index)
                self.assertEqual(step.data["plate_z"], self.truth["observables"][index][1])
                # It keeps positions, velocities and boxes in single precision.
                np.testing.assert_array_equal(step.positions, file["particles/trajectory/position/value"][index].astype("f4"))
                np.testing.assert_array_equal(step.velocities, file["particles/trajectory/velocity/value"][index].astype("f4"))
                np.testing.assert_array_equal(step.dimensions, np.array([SIDE, SIDE, HEIGHT, 90, 90, 90], dtype="f4"))

    def test_positions_of_the_extended_xyz_are_read_as_plain_xyz(self):
        import MDAnalysis
        universe = MDAnalysis.Universe(str(self.folder / "radii.xyz"))
        self.assertEqual(universe.atoms.names.tolist(), ["Al"] * BEADS + ["Cu"] * (SPHERES - BEADS))
        places = self.open("sample.h5md")["particles/trajectory/position/value"]
        for index, step in enumerate(universe.trajectory):
            np.testing.assert_array_equal(step.positions, (places[index] / 4e-4).astype("f4"))


def read_xyz(path):
    """Frames of an extended XYZ file: pairs of the second line's entries and the columns by name."""
    lines = path.read_text(encoding="ascii").splitlines()
    while lines:
        count, head, rows = int(lines[0]), lines[1], lines[2:]
        entries = dict(word.split("=", 1) for word in shlex.split(head))
        fields = np.array([row.split() for row in rows[:count]])
        columns, at = {}, 0
        for name, kind, width in zip(*[iter(entries["Properties"].split(":"))] * 3):
            columns[name] = fields[:, at:at + int(width)].astype({"S": str, "R": float, "I": int}[kind])
            at += int(width)
        if at != fields.shape[1]:
            raise ValueError(f"{fields.shape[1]} columns, {at} properties")
        yield entries, columns
        lines = rows[count:]


class ExtendedXyzTest(SampleTest):
    def test_frames_are_those_of_h5md(self):
        file = self.open("sample.h5md")["particles/trajectory"]
        frames = list(read_xyz(self.folder / "sample.xyz"))
        self.assertEqual(len(frames), 4)
        for index, (entries, columns) in enumerate(frames):
            self.assertEqual(entries["pbc"], "T T F")
            self.assertEqual(float(entries["Time"]), self.truth["time"][index][0])
            self.assertEqual(int(entries["Step"]), 500 * index)
            self.assertEqual(float(entries["plate_z"]), self.truth["observables"][index][1])
            self.assertEqual([float(x) for x in entries["Lattice"].split()], [SIDE, 0, 0, 0, SIDE, 0, 0, 0, HEIGHT])
            self.assertEqual(columns["species"][:, 0].tolist(), ["Al"] * BEADS + ["Cu"] * (SPHERES - BEADS))
            self.assertEqual(columns["kind"][:, 0].tolist(), ["bead"] * BEADS + ["rod"] * (SPHERES - BEADS))
            self.assertEqual(columns["id"][:, 0].tolist(), list(range(1, SPHERES + 1)))
            rods = [int(rod) + 1 for rod in self.open("sample.h5md")["parameters/rod_of_sphere"][:]]
            self.assertEqual(columns["molecule"][:, 0].tolist(), [0] * BEADS + rods)
            self.assert_same_bits(columns["pos"], file["position/value"][index])
            self.assert_same_bits(columns["velo"], file["velocity/value"][index])
            self.assert_same_bits(columns["radius"], file["radius"][:])

    def test_lengths_in_units_of_the_bead_radius(self):
        file = self.open("sample.h5md")["particles/trajectory"]
        entries, columns = next(read_xyz(self.folder / "radii.xyz"))
        self.assertEqual(float(entries["Lattice"].split()[0]), SIDE / 4e-4)
        self.assert_same_bits(columns["pos"], file["position/value"][0] / 4e-4)
        self.assert_same_bits(columns["velo"], file["velocity/value"][0] / 4e-4)
        self.assert_same_bits(columns["radius"], file["radius"][:] / 4e-4)

    def test_the_reader_sees_a_missing_column(self):
        text = (self.folder / "sample.xyz").read_text().replace("radius:R:1", "radius:R:2")
        (self.folder / "broken.xyz").write_text(text)
        with self.assertRaises(ValueError):
            list(read_xyz(self.folder / "broken.xyz"))


@unittest.skipUnless(installed("ase"), "python3-ase is not installed")
class AseTest(SampleTest):
    def test_every_frame_is_read(self):
        import ase.io
        file = self.open("sample.h5md")["particles/trajectory"]
        frames = ase.io.read(self.folder / "sample.xyz", index=":", format="extxyz")
        self.assertEqual(len(frames), 4)
        for index, atoms in enumerate(frames):
            self.assertEqual(atoms.get_chemical_symbols(), ["Al"] * BEADS + ["Cu"] * (SPHERES - BEADS))
            self.assertEqual(atoms.pbc.tolist(), [True, True, False])
            self.assertEqual(atoms.info["Step"], 500 * index)
            self.assertEqual(atoms.info["Time"], self.truth["time"][index][0])
            self.assert_same_bits(atoms.positions, file["position/value"][index])
            self.assert_same_bits(atoms.arrays["velo"], file["velocity/value"][index])
            self.assert_same_bits(atoms.arrays["radius"], file["radius"][:])
            self.assert_same_bits(np.array(atoms.cell), np.diag([SIDE, SIDE, HEIGHT]))


if __name__ == "__main__":
    rodwake.main()
