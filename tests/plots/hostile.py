"""Hostile texts in the files of a run directory, and the pages made of it. A change makes one place of a folder hostile."""

import copy
import csv
import functools
import io
import json
import operator
import tomllib
from unittest import mock

import h5py
from PIL import Image, PngImagePlugin

import plot_case  # noqa: F401: puts the plots on the path
from rodwake_plots import draw, errors, page, report, run_dir, scan_page, trajectories

NAME = "n\"'><img src=x onerror=hit()>"  # without slash and comma: of a file, a group, a column
TEXT = NAME + """<script>hit()</script><svg onload=hit()></svg></title></style></script>" onfocus="hit()" autofocus="
\u2028{{data}}$\\frac{$<!--<script>"""
WITH_NUMBERS = ("outcome.json", "provenance.json", "rods_order.json", "scan.json")  # others are looked at as they are read
ALIVE = ("<img src=x", "<script>hit", "<svg onload", "<!--", '" onfocus="hit')  # in a page: of a text that was not escaped
WATCH = "window.hits = 0; window.hit = () => { ++window.hits; };"  # before the scripts of a page


def png():
    """Hostile where a picture is pointed at."""
    info, out = PngImagePlugin.PngInfo(), io.BytesIO()
    info.add_itxt(page.HOVER, json.dumps([[0.5, 0.5, TEXT]]))
    Image.new("RGB", (40, 30), "white").save(out, "PNG", pnginfo=info)
    return out.getvalue()


def pages(folder):
    """({name: page}, what of them could not be made), with a figure of each kind that there is, none of which is drawn."""
    overlaps = mock.patch.object(trajectories, "lie_on_each_other", return_value=False)  # slow, and no text
    with run_dir.RunDir(folder) as run, mock.patch.object(draw, "png", return_value=png()), overlaps:
        failures, of_kind = [], {one.kind: one for one in draw.figures_of(run)}
        found = {"report.html": report.document(run, [(one, "") for one in of_kind.values()], failures)}
        if run.has_scan:
            found["scan.html"], error = errors.attempt(scan_page.document, run)
            failures += [errors.reason(error)] if error else []
        return {name: page for name, page in found.items() if page}, failures


def changes(folder):
    """One for each text and each table of the files in the folder, for some numbers, and for the title alone."""
    found = [functools.partial(retitle, name="scene.toml")]
    for path in sorted(folder.iterdir()):
        of = {".json": of_record, ".toml": of_record, ".csv": of_table, ".h5": of_hdf5}.get(path.suffix)
        found += of(path) if of else []
    return found


def retitle(folder, name):
    """With the scene as it was laid out; hostile in a comment, too."""
    lines = [line for line in (folder / name).read_text().splitlines() if not line.startswith("title")]
    one_line = TEXT.replace("\n", " ").replace("\u2028", "")
    (folder / name).write_text("\n".join([f"title = {json.dumps(TEXT)}", f"# {one_line}", *lines]) + "\n")


def of_record(path):
    """Of a scene or a JSON file."""
    found = places(read(path), numbers=path.name in WITH_NUMBERS)
    return [functools.partial(respell, name=path.name, place=place, is_table=is_table) for place, is_table in found]


def respell(folder, name, place, is_table):
    value = read(folder / name)
    if is_table:
        table = at(value, place)
        table[TEXT] = copy.deepcopy(next(iter(table.values()), TEXT))
    else:
        at(value, place[:-1])[place[-1]] = TEXT
    (folder / name).write_text(toml(value) if name.endswith(".toml") else json.dumps(value), encoding="utf-8")


def read(path):
    return (tomllib.loads if path.suffix == ".toml" else json.loads)(path.read_text(encoding="utf-8"))


def places(value, numbers, place=()):
    """(path, whether it leads to a table; else to a text, or to a number if asked for). Of a list its first items."""
    if isinstance(value, dict):
        yield place, True
        for key, inner in value.items():
            yield from places(inner, numbers, (*place, key))
    elif isinstance(value, list):
        for index, item in enumerate(value[:2 if value and isinstance(value[0], dict) else 1]):
            yield from places(item, numbers, (*place, index))
    elif isinstance(value, str) or numbers:
        yield place, False


def at(value, place):
    return functools.reduce(operator.getitem, place, value)


def toml(value):
    return "\n".join(f"{json.dumps(key)} = {inline(inner)}" for key, inner in value.items())


def inline(value):
    if isinstance(value, dict):
        return "{" + ", ".join(f"{json.dumps(key)} = {inline(inner)}" for key, inner in value.items()) + "}"
    return "[" + ", ".join(map(inline, value)) + "]" if isinstance(value, list) else json.dumps(value)


def of_table(path):
    """One more column, and each text in the first row of a CSV file."""
    rows = list(csv.reader(table_lines(path)))
    texts = [column for column, cell in enumerate(rows[1]) if cell and not is_number(cell)] if len(rows) > 1 else []
    return [functools.partial(widen, name=path.name)] + [functools.partial(rewrite, name=path.name, column=column) for column in texts]


def table_lines(path):
    return [line for line in path.read_text().splitlines() if not line.startswith("#")]


def widen(folder, name):
    head, *rows = table_lines(folder / name)
    (folder / name).write_text("\n".join([f"{head},{NAME}", *(f"{row},1" for row in rows)]) + "\n")


def rewrite(folder, name, column):
    head, first, *rows = table_lines(folder / name)
    cells, out = next(csv.reader([first])), io.StringIO()
    cells[column] = NAME
    csv.writer(out, lineterminator="").writerow(cells)
    (folder / name).write_text("\n".join([head, out.getvalue(), *rows]) + "\n")


def is_number(text):
    try:
        return float(text) is not None
    except ValueError:
        return False


def of_hdf5(path):
    """Each attribute that is a text; a run of the rods with a hostile name."""
    found = []
    with h5py.File(path) as file:
        def visit(name, item):
            found.extend((name, key) for key, value in item.attrs.items() if isinstance(value, (str, bytes)))
        visit("/", file)
        file.visititems(visit)
        named = [functools.partial(rename, name=path.name)] if "rods/scene" in file else []
    return named + [functools.partial(retell, name=path.name, place=place, key=key) for place, key in found]


def rename(folder, name):
    with h5py.File(folder / name, "r+") as file:
        file["rods"].copy("scene", NAME)
        del file["rods"][NAME].attrs["label"]


def retell(folder, name, place, key):
    with h5py.File(folder / name, "r+") as file:
        file[place].attrs[key] = TEXT
