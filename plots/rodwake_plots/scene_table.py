"""The resolved scene as tables: known keys with symbol and meaning, any others as they stand."""

from . import fit_keys, granular_keys, words
from .units import Units

LENGTH, TIME, NONE = "length", "time", ""

# table: key -> (symbol, meaning, unit)
MEANINGS = {
    "medium": {
        "eta": ("<i>η</i>", "coefficient of grad div over shear modulus, (<i>λ</i> + <i>μ</i>)/<i>μ</i>", NONE),
        "xi": ("<i>ξ</i>", "screening length <i>μ</i>/(<i>ζv</i><sub>0</sub>)", LENGTH),
        "alpha": ("<i>α</i>", "(<i>f</i>/<i>μ</i>)/<i>ξ</i>", NONE),
        "field": ("", "how the field is evaluated: <i>exact</i> sums the closed form at every point", NONE),
        "table": ("", "interpolation of the field; not used with <i>exact</i>", NONE),
        "periodic": ("", "side of the periodic box of the medium", LENGTH),
        "fitted": ("", "<i>η</i> and <i>ξ</i> come from the fit of this scene", NONE),
    },
    "coupling": {
        "kappa": ("<i>κ</i>", "turning towards the extensional axis of the strain", NONE),
        "gamma1": ("<i>γ</i><sub>1</sub>", "first polar coupling", NONE),
        "gamma2": ("<i>γ</i><sub>2</sub>", "second polar coupling", NONE),
        "polar_basis": ("", "which pair of gradients <i>γ</i><sub>1</sub>, <i>γ</i><sub>2</sub> multiply", NONE),
    },
    "rods_run": {
        "t_end": ("<i>t</i><sub>end</sub>", "end of the integration", TIME),
        "contact_distance": ("", "separation that counts as contact", LENGTH),
        "output_times": ("", "times written out", TIME),
        "output_interval": ("", "time between rows of rods.csv", TIME),
        "form": ("", "variables of the equations: <i>angle</i> is one heading <i>θ</i> a rod", NONE),
        "method": ("", "integration method", NONE),
        "rtol": ("", "relative tolerance", NONE),
        "atol": ("", "absolute tolerance", NONE),
        "max_steps": ("", "most steps allowed", NONE),
    },
    "noise": {
        "rotational_diffusion": ("", "rotational diffusion of the headings", NONE),
    },
    "field": {
        "x": ("", "range of the grid along <i>x</i>", LENGTH),
        "y": ("", "range of the grid along <i>y</i>", LENGTH),
        "nx": ("", "grid points along <i>x</i>", NONE),
        "ny": ("", "grid points along <i>y</i>", NONE),
    },
    "scales": {
        "f_over_mu": ("<i>f</i>/<i>μ</i>", "unit of length", "m"),
        "v0": ("<i>v</i><sub>0</sub>", "self-propulsion speed", "m/s"),
        "bead_radius": ("<i>a</i>", "bead radius", "m"),
    },
}
NAMES = {"medium": "Medium", "coupling": "Coupling", "rods_run": "Integration", "noise": "Noise", "scales": "Scales", "field": "Field of one rod",
         "rods": "Rods at the start", "cuts": "Cuts of the field", "variants": "Variants", "measure": "Measures", "fit": "Fit"}
COLUMNS = {"position": LENGTH, "heading": "rad", "at": LENGTH, "from": LENGTH, "to": LENGTH}  # units in listings
SKIPPED = {"figures"}  # the figures speak for themselves


def tables(scene, units):
    """(name, heads, rows) for each table of the scene."""
    for key, value in scene.items():
        if key in SKIPPED or not value:
            continue
        if key == "granular":
            yield from granular_tables(value)
        elif isinstance(value, dict):
            yield NAMES.get(key, key), ("Key", "Symbol", "Value", "Meaning"), rows(key, value, units)
            names, columns = (fit_keys.NAMES, {}) if key == "fit" else (NAMES, COLUMNS)
            yield from ((names.get(inner, inner), *listing(items, units, columns)) for inner, items in value.items() if is_listing(items))
        elif is_listing(value):
            yield NAMES.get(key, key), *listing(value, units)


def granular_tables(values):
    si, names = Units("si"), granular_keys.NAMES
    flat = {key: value for key, value in values.items() if not isinstance(value, dict)}
    yield names["granular"], ("Key", "Symbol", "Value", "Meaning"), rows("granular", flat, si)
    for key, inner in values.items():
        if isinstance(inner, dict) and inner:
            yield names.get(key, key), ("Key", "Symbol", "Value", "Meaning"), rows(key, inner, si)
        elif is_listing(inner):
            yield names.get(key, key), *listing(inner, si, granular_keys.COLUMNS)


def rows(table, values, units):
    return [row(table, key, value, units) for key, value in values.items() if not is_listing(value)]


def row(table, key, value, units):
    symbol, meaning, unit = (MEANINGS | granular_keys.MEANINGS | fit_keys.MEANINGS).get(table, {}).get(key, ("", "", NONE))
    return f"<code>{words.escape(key)}</code>", symbol, f"{shown(value)} {unit_of(units, unit)}".strip(), meaning


def unit_of(units, unit):
    return {LENGTH: units.length_html(), TIME: units.time_html()}.get(unit, unit)


def is_listing(value):
    return isinstance(value, list) and bool(value) and all(isinstance(item, dict) for item in value)


def listing(items, units, columns=COLUMNS):
    """One row an item, one column a key."""
    keys = list(dict.fromkeys(key for item in items for key in item))
    unit = {key: unit_of(units, columns[key]) for key in keys if key in columns}
    return (["No."] + [words.escape(key.replace("_", " ")) + (f" ({unit[key]})" if key in unit else "") for key in keys],
            [[str(index)] + [shown(item.get(key, "")) for key in keys] for index, item in enumerate(items)])


def shown(value):
    """Long lists are told by their ends: output times run to thousands."""
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, dict):
        return ", ".join(f"{words.escape(key)} = {shown(one)}" for key, one in value.items())
    if isinstance(value, list):
        few = value if len(value) <= 8 else value[:3] + ["…"] + value[-2:]
        text = ", ".join(shown(one) for one in few)
        return text if len(value) <= 8 else f"{text} ({len(value)} values)"
    return words.number(value, 6)
