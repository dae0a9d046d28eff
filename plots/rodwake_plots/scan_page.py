"""scan.html: one page that shows every point of a scan, and needs no other file."""

import re
from pathlib import Path

import numpy as np
from matplotlib.colors import LogNorm

from . import files, page, scan_columns, scan_raster, scan_scene, scan_words, style, words
from .errors import PlotError
from .scan_run import OUTCOMES
from .schema import Spec

PARTS = Path(__file__).with_name("scan_page")
NOTHING_ON_DARK = "#343943"
SCRIPTS = ("data", "scales", "paint", "frame", "compute", "controls", "view", "page")
EXPLORER = Path(__file__).parents[2] / "explorer"  # beside the plots, in the source tree as in an installation


def write(run):
    path = run.output / scan_words.PAGE
    files.write(path, document(run))
    print(path)


def document(run):
    with style.applied(style.SETTINGS):  # the colours of the page are those of figures without a style of the user's
        blobs, content = contents(run)
    kernels = [(EXPLORER / name).read_text(encoding="utf-8") for name in ("kernel.js", "rodwake.js")] if content["kernel"] else []
    script = "\n".join(('"use strict";', "(() => {", *kernels, *(part(f"{name}.js") for name in SCRIPTS), "})();"))
    values = {"head": page.head(run.title, part("page.css"), script, bool(kernels)), "title": words.escape(run.title), "sub": sub(run),
              "about": scan_words.caption(run, Spec("scan", "scan_page", colour="outcome")), "version": words.escape(run.version),
              "content": page.json_text(content), "data": "\n".join(blobs), "script": script}
    return re.sub(r"\{\{(\w+)\}\}", lambda found: values[found[1]], part("page.html"))


def part(name):
    return (PARTS / name).read_text(encoding="utf-8")


def sub(run):
    scan = run.scan
    return f"{scan_words.count(len(scan.failed))} points by {scan_words.design_html(scan)}, rodwake {words.escape(run.version)}"


def contents(run):
    """(scripts that hold the numbers, their description for the page)."""
    scan, box = run.scan, page.Box()
    content = {"points": len(scan.failed), "design": scan.design, "outcomes": outcomes(),
            "nothing": {"light": scan_columns.NOTHING, "dark": NOTHING_ON_DARK},
            "axes": [axis(one) for one in scan.axes], "columns": columns(run, box), "maps": maps(box),
            "rodColours": style.ROD_COLOURS, "cells": cells(scan, box), "boundary": boundary(scan, box),
            "samples": samples(scan, box), "lengthUnit": page.marked(run.units.length_html()),
            "timeUnit": page.marked(run.units.time_html()),
            **scenes(run)}
    content["kernel"] = kernel(run, box) if content["scene"] else None
    return box.scripts, content


def kernel(run, box):
    """The kernels that compute a clicked point's path, for scans of what they have: few rods on the plane, in the exact field, in
    reduced units, without noise."""
    file, text = EXPLORER / "kernel.wasm", run.scene_text
    theory = all(re.search(rf"(?m)^{line}", text) for line in (r"\[medium\]", r"\[\[rods\]\]", r"\[rods_run\]", 'units = "reduced"', 'field = "exact"'))
    if not theory or re.search(r"(?m)^(\[noise\]|\[granular\]|periodic =)", text) or text.count("[[rods]]") > 8 or not file.is_file():
        return None
    return box.add(np.frombuffer(file.read_bytes(), dtype=np.uint8))


def outcomes():
    return [{"name": name, "colour": scan_columns.COLOURS[name]} for name in OUTCOMES]


def axis(one):
    return {"key": one.key, "marked": page.marked(one.name_html), "unit": page.marked(one.unit_html), "scale": one.scale,
            "factor": one.factor, "low": one.low, "high": one.high, "sign": one.sign, "words": list(one.values) if one.is_choice else None}


def columns(run, box):
    """Every column of scan.csv, in its order."""
    scan = run.scan
    axes = {one.key: index for index, one in enumerate(scan.axes)}
    found = []
    for name, values in scan.columns.items():
        if name in axes and scan.axes[axes[name]].is_choice:
            column = {"words": list(scan.axes[axes[name]].values), "data": box.add(scan.place(axes[name]).astype(np.uint8))}
        elif name == "outcome":
            column = {"words": list(OUTCOMES), "data": box.add(scan.outcome.astype(np.uint8))}  # -1 becomes 255
        elif isinstance(values, list):
            kinds = sorted(set(values))
            column = {"words": kinds, "data": box.add(np.array([kinds.index(value) for value in values], dtype=np.uint8))}
        else:
            column = {"data": box.add(values.astype(float))} | ({} if name in axes else colouring(run, name))
        found.append({"name": name} | column)
    return found


def colouring(run, name):
    """What a column of numbers means and how it colours points; without "norm" it does not."""
    column = scan_columns.quantity(name, run.scan)
    html = words.escape(column.name) + (f" {words.tex_html(column.symbol)}" if column.symbol else "")
    found = {"label": column.name, "marked": page.marked(html), "unit": page.marked(scan_columns.unit_html(run, name, shown=False)),
             "of": [OUTCOMES.index(one) for one in column.of] or None}
    if name not in scan_columns.names(run.scan):
        return found
    try:
        norm, _, colours = scan_columns.scaling(name, scan_columns.values(run.scan, name))
    except PlotError:
        return found
    balanced = colours is scan_columns.BALANCED
    return found | {"norm": [float(norm.vmin), float(norm.vmax)], "log": isinstance(norm, LogNorm),
                    "map": "balanced" if balanced else "field"}


def maps(box):
    """Colour maps of the figures, 256 times red, green, blue."""
    table = np.linspace(0, 1, 256)
    return {name: box.add(np.round(255 * made(table)[:, :3]).astype(np.uint8).ravel())
            for name, made in (("field", style.FIELD_MAP), ("balanced", scan_columns.BALANCED))}


def cells(scan, box):
    """Leaves on the finest lattice with the points at their corners."""
    if not scan.has_cells or len(scan.axes) not in (2, 3):
        return None
    leaves = scan_raster.Leaves(scan)
    lattice = leaves.lattice
    return {"count": len(leaves.low), "origin": lattice.origin.tolist(), "size": lattice.size.tolist(), "top": lattice.count.tolist(),
            "low": box.add(leaves.low.astype(np.int32)), "high": box.add(leaves.high.astype(np.int32)),
            "corners": box.add(leaves.corners.astype(np.int32)), "outcome": box.add(leaves.outcome.astype(np.uint8))}


def boundary(scan, box):
    """Places in even coordinates, one curve after the other; `ends` is where each ends."""
    if not scan.boundary or len(scan.axes) != 2:
        return None
    places = [np.stack([axis.even(curve.places[:, index]) for index, axis in enumerate(scan.axes)], axis=-1) for curve in scan.boundary]
    return {"ends": np.cumsum([len(place) for place in places]).tolist(), "places": box.add(np.concatenate(places))}


def samples(scan, box):
    """The stored trajectories; single precision is more than a screen shows."""
    found = scan.samples
    if found is None:
        return None
    return {"count": len(found.point), "steps": found.t.shape[1], "rods": found.x.shape[2], "point": box.add(found.point.astype(np.int32)),
            **{name: box.add(getattr(found, name).astype(np.float32)) for name in ("t", "x", "y", "theta")}}


def scenes(run):
    """The scene of a point, with places for the axes; or why there is none."""
    scan = run.scan
    first = [scan.columns[one.key][0] if one.is_choice else float(scan.place(index)[0]) for index, one in enumerate(scan.axes)]
    try:
        parts = scan_scene.checked(run.scene_text, scan.axes, first)
    except scan_scene.NoTemplate as error:
        return {"scene": None, "noScene": str(error)}
    return {"scene": [one if isinstance(one, str) else one._asdict() for one in parts]}
