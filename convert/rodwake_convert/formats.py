"""Which format a file has: by its first bytes, then by the ending of its name. Imports no library that reads one."""

import os

MODULES = {"csv": "table", "trackmate": "trackmate", "lammps": "lammps", "xyz": "xyz", "gsd": "gsd_film", "h5md": "h5md"}
WRITERS = {"csv": "CSV", "lammps": "a dump", "xyz": "XYZ", "gsd": "GSD", "h5md": "H5MD"}
LIBRARIES = {"csv": "CSV", "trackmate": "XML", "lammps": "LAMMPS", "xyz": "XYZ", "gsd": "GSD", "h5md": "HDF5"}
ENDINGS = {".xyz": "xyz", ".extxyz": "xyz", ".gsd": "gsd", ".h5md": "h5md", ".h5": "h5md", ".hdf5": "h5md", ".dump": "lammps", ".lammpstrj": "lammps",
           ".lammpsdump": "lammps", ".xml": "trackmate", ".csv": "csv"}


def by_name(path):
    return ENDINGS.get(os.path.splitext(path.removesuffix(".gz"))[1].lower())


def of_file(path):
    with open(path, "rb") as file:
        start = file.read(256)
    if start.startswith(b"\x89HDF\r\n\x1a\n"):
        return "h5md"
    if start.startswith(b"\xdf\x65\xdf\x65\xdf\x65\xdf\x65"):
        return "gsd"
    text = start.removeprefix(b"\xef\xbb\xbf").lstrip(b" \t\r\n")
    if text.startswith(b"<"):
        return "trackmate"
    if text.startswith(b"ITEM:"):
        return "lammps"
    lines = text.splitlines()
    if len(lines) > 1 and lines[0].strip().isdigit():
        return "xyz"
    return by_name(path) or "csv"
