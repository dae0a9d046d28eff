"""Rods of the theory: rods/<case> of a run's result.h5. A rod with a body is the discs of its row, or a pose; one without is a pose."""

import numpy as np

from .errors import shown
from .frames import Frame, Part, box_of, turned


def read(source, file):
    names = file.names("rods")
    case = source.options.group or ("scene" if "scene" in names else names[0])
    if case not in names:
        source.fail(f"no rods of the case {shown(case)} (--group); there are: {', '.join(map(shown, names))}")
    group = f"rods/{case}/"
    t, x, y, theta = (file.guarded(group + name, lambda data=file.dataset(group + name, "f"): data[()]) for name in ("t", "x", "y", "theta"))
    if x.ndim != 2 or not (x.shape == y.shape == theta.shape and len(t) == len(x)):
        source.fail(f"{group}: t, x, y and theta are not of one length: the file is damaged")
    source.length_unit = str(file.attribute(group + "x", "unit") or "")
    rod, along, radius = discs(file, group, x.shape[1]) if source.options.rods == "spheres" else (None, None, None)
    source.expect_rows(len(t), x.shape[1] if rod is None else len(rod))
    box, height = None, 1.0 if radius is None else 2 * radius.max()  # viewers take no flat box
    if file.has(group + "box"):
        sides = file.dataset(group + "box", "f")[()]
        box = box_of(source, f": {group}box", [0.0, 0.0, -height / 2], np.diag([*sides, height]), (True, True, False))
    source.type_names = ["rod"]
    for k in range(len(t)):
        if source.past(k):
            return
        if not source.wanted(k):
            continue
        source.report(k / len(t))
        place, heading = np.column_stack([x[k], y[k], np.zeros(len(x[k]))]), theta[k]
        if rod is not None:
            ahead = np.column_stack([np.cos(heading), np.sin(heading), np.zeros(len(heading))])
            place, heading = place[rod] + along[:, None] * ahead[rod], heading[rod]
        rods = Part(place, np.arange(len(place)), species=np.zeros(len(place), np.int32), radius=radius, orientation=turned(heading))
        yield Frame(k, k, float(t[k]), box, rods, is_rod=np.full(len(place), rod is None))


def discs(file, group, count):
    """Of all discs: their rod, place along it, + ahead, and radius (rods/body.hpp). Without bodies: none."""
    if not file.has(group + "body"):
        return None, None, None
    shape = [file.dataset(f"{group}body/{name}", "f")[()] for name in ("spheres", "length", "thick_diameter", "thin_diameter")]
    if any(values.shape != (count,) for values in shape):
        file.source.fail(f"{group}body is not of {count} rods: the file is damaged")
    rods, places, radii = [], [], []
    for k, (number, length, thick, thin) in enumerate(zip(*shape)):
        share = np.linspace(0, 1, int(number)) if number > 1 else np.array([0.5])
        rods.append(np.full(len(share), k))
        places.append((share - 0.5) * (length - (thick + thin) / 2))
        radii.append(thick / 2 + share * (thin - thick) / 2)
    return np.concatenate(rods), np.concatenate(places), np.concatenate(radii)
