"""The sample grids of tests/store/test_vti.cpp as another program reads them: XML, base64 and numpy, no code of ours."""

import base64
import importlib.util
import os
import subprocess
import tempfile
import unittest
import xml.etree.ElementTree as ElementTree
from pathlib import Path

import numpy as np

import rodwake

ROOT = {"type": "ImageData", "version": "1.0", "byte_order": "LittleEndian", "header_type": "UInt64"}


def only(element, tag, attributes):
    """The one child, with these attributes and no others."""
    children = list(element)
    if [child.tag for child in children] != [tag]:
        raise ValueError(f"{element.tag} holds {[child.tag for child in children]}, expected one {tag}")
    if set(children[0].attrib) != set(attributes):
        raise ValueError(f"{tag} has attributes {sorted(children[0].attrib)}")
    return children[0]


def numbers(text, kind, count):
    values = [kind(word) for word in text.split()]
    if len(values) != count:
        raise ValueError(f"{len(values)} numbers in '{text}', expected {count}")
    return values


def read_array(element, points):
    """Values [point][component]: a UInt64 count of bytes and then as many, in one run of base64."""
    if (element.tag, element.get("type"), element.get("format")) != ("DataArray", "Float64", "binary"):
        raise ValueError(f"not an array of doubles in base64: {element.attrib}")
    data = base64.b64decode(element.text.strip(), validate=True)
    count = int(np.frombuffer(data[:8], dtype="<u8")[0])
    components = int(element.get("NumberOfComponents"))
    if count != len(data) - 8 or count != 8 * points * components:
        raise ValueError(f"{len(data) - 8} bytes, {count} announced, {points} points of {components} components")
    return np.frombuffer(data[8:], dtype="<f8").reshape(points, components)


def read_vti(path):
    """Extent in points, origin, spacing and the arrays [y][x][component] by name."""
    root = ElementTree.parse(path).getroot()
    if root.tag != "VTKFile" or root.attrib != ROOT:
        raise ValueError(f"{root.tag} {root.attrib}")
    image = only(root, "ImageData", ("WholeExtent", "Origin", "Spacing"))
    piece = only(image, "Piece", ("Extent",))
    extent = numbers(image.get("WholeExtent"), int, 6)
    if piece.get("Extent") != image.get("WholeExtent") or extent[::2] != [0, 0, 0] or extent[5] != 0:
        raise ValueError(f"extent {extent}")
    nx, ny = extent[1] + 1, extent[3] + 1
    arrays = {}
    for element in only(piece, "PointData", ()):
        arrays[element.get("Name")] = read_array(element, nx * ny).reshape(ny, nx, -1)
    return (nx, ny), numbers(image.get("Origin"), float, 3), numbers(image.get("Spacing"), float, 3), arrays


def expected(nx, ny, components):
    j, i, c = np.meshgrid(np.arange(ny), np.arange(nx), np.arange(components), indexing="ij")
    return i + 100.0 * j + 0.25 * c


# The same literals as in test_vti.cpp.
BITS = [0.1, -0.0, 5e-324, np.finfo(float).max, -np.finfo(float).max, 1 / 3, 1e22, -7.0, np.finfo(float).tiny,
        np.finfo(float).eps, 5e-324, np.nan]  # an unknown number


class VtiTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        keeper = tempfile.TemporaryDirectory(prefix="rodwake-test-")
        cls.addClassCleanup(keeper.cleanup)
        cls.folder = Path(keeper.name)
        made = subprocess.run([os.environ["RODWAKE_TEST_STORE"], "[vti_samples]"], capture_output=True, text=True,
                              env={**os.environ, "RODWAKE_SAMPLES": keeper.name})
        if made.returncode:
            raise RuntimeError(made.stdout + made.stderr)

    def assert_same_bits(self, found, wanted):
        wanted = np.ascontiguousarray(wanted, dtype=float)
        self.assertEqual(found.shape, wanted.shape)
        np.testing.assert_array_equal(np.ascontiguousarray(found).view(np.uint64), wanted.view(np.uint64))

    def check_sample(self, path):
        size, origin, spacing, arrays = read_vti(path)
        self.assertEqual((size, origin, spacing), ((4, 3), [-0.1, 1 / 3, 0.0], [0.05, 2e-5, 1.0]))
        self.assertEqual(list(arrays), ["U", "height", 'a<b & "c"'])
        self.assert_same_bits(arrays["U"], expected(4, 3, 3))
        self.assert_same_bits(arrays["height"], expected(4, 3, 1))
        self.assert_same_bits(arrays['a<b & "c"'].ravel(), BITS)

    def test_every_bit_is_where_it_belongs(self):
        self.check_sample(self.folder / "sample.vti")

    def test_any_length_and_no_fields(self):
        for n in (1, 2, 3):
            size, _, _, arrays = read_vti(self.folder / f"row{n}.vti")
            self.assertEqual(size, (n, 1))
            self.assert_same_bits(arrays["f"], expected(n, 1, 1))
        self.assertEqual(read_vti(self.folder / "bare.vti")[3], {})

    def test_a_spoilt_file_fails(self):
        text = (self.folder / "sample.vti").read_text(encoding="ascii")
        data = text.split('format="binary">\n')[1].split("\n")[0]
        middle = len(data) // 2 // 4 * 4
        other = data[:middle] + ("B" if data[middle] == "A" else "A") + data[middle + 1:]
        cases = [(data, other), (data, data[4:]), (data, data[:-4]), (data, "!" + data[1:]),
                 ("0 3 0 2 0 0", "0 2 0 3 0 0"), ("0 3 0 2 0 0", "0 3 0 1 0 0"), ("0.05", "0.06"),
                 ("LittleEndian", "BigEndian"), ("UInt64", "UInt32"), ('"height"', '"U"'),
                 ('NumberOfComponents="3"', 'NumberOfComponents="1"'), ("</PointData>", "")]
        for old, new in cases:
            with self.subTest(old=old[:30], new=new[:30]):
                self.assertIn(old, text)
                (self.folder / "spoilt.vti").write_text(text.replace(old, new), encoding="ascii")
                with self.assertRaises((ValueError, AssertionError, ElementTree.ParseError)):
                    self.check_sample(self.folder / "spoilt.vti")

    @unittest.skipUnless(importlib.util.find_spec("vtkmodules"), "python3-vtk9 is not installed")
    def test_vtk_reads_it(self):
        from vtkmodules.util.numpy_support import vtk_to_numpy
        from vtkmodules.vtkIOXML import vtkXMLImageDataReader
        reader = vtkXMLImageDataReader()
        reader.SetFileName(str(self.folder / "sample.vti"))
        reader.Update()
        image = reader.GetOutput()
        self.assertEqual((image.GetDimensions(), image.GetOrigin(), image.GetSpacing()),
                         ((4, 3, 1), (-0.1, 1 / 3, 0.0), (0.05, 2e-5, 1.0)))
        points = image.GetPointData()
        self.assertEqual([points.GetArrayName(i) for i in range(points.GetNumberOfArrays())], ["U", "height", 'a<b & "c"'])
        self.assert_same_bits(vtk_to_numpy(points.GetArray("U")), expected(4, 3, 3).reshape(12, 3))
        self.assert_same_bits(vtk_to_numpy(points.GetArray(2)), BITS)


if __name__ == "__main__":
    rodwake.main()
