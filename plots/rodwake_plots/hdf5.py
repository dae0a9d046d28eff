"""Opening an HDF5 file and taking datasets from it; whatever is missing is named with its full place."""

import h5py
import numpy as np

from .errors import MissingError, PlotError


def open_file(path):
    if not path.is_file():
        raise MissingError(path, "no such file")
    try:
        return h5py.File(path, "r")
    except OSError as error:
        raise PlotError(f"{path}: not a readable HDF5 file") from error


def dataset(file, place):
    found = file.get(place)
    if not isinstance(found, h5py.Dataset):
        raise PlotError(f"{file.filename}: dataset /{place} is missing")
    return found


def parameter(file, name):
    """A number, or an array of them, of the group /parameters: a dataset or an attribute of the group."""
    group = file.get("parameters")
    for store in (group, group.attrs) if group is not None else ():
        if name in store:
            return np.asarray(store[name][()] if store is group else store[name])
    raise PlotError(f"{file.filename}: /parameters/{name} is missing")
