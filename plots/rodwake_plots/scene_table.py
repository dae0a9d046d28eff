"""The resolved scene as tables: keys with symbol, unit and meaning from schema.json, any others as they stand."""

from . import fit_words, schema, words

HEADS = ("Key", "Symbol", "Value", "Meaning")
SKIPPED = {"figures"}  # the figures speak for themselves


class Told:
    """What schema.json says of the keys of one scene; `lengths` is the name of the unit of the fitted profiles."""

    def __init__(self, system, lengths=""):
        self.system, self.lengths = system, lengths

    def unit(self, table, key):
        unit = schema.KEYS.get((table, key), {}).get("unit", {}).get(self.system, "")
        return fit_words.unit_html(self.lengths if unit == schema.PROFILES_UNIT else unit)

    def symbol(self, table, key):
        return words.tex_html(schema.KEYS.get((table, key), {}).get("symbol", ""))

    def meaning(self, table, key):
        inner = schema.TABLES.get(joined(table, key), "")
        return words.prose(schema.KEYS.get((table, key), {}).get("meaning", inner))


def tables(scene, told):
    """(name as HTML, meaning as HTML, heads, rows) for each table of the scene."""
    for key, value in scene.items():
        if key not in SKIPPED:
            yield from of_table(key, value, told)


def of_table(path, value, told):
    """This table and the tables in it; a list of tables has a row for each."""
    if is_listing(value):
        yield heading(f"[[{path}]]"), meaning(f"{path}[]"), *listing(f"{path}[]", value, told)
    elif isinstance(value, dict) and value:
        inner = {key: one for key, one in value.items() if is_listing(one) or is_table(joined(path, key), one)}
        rows = [row(path, key, one, told) for key, one in value.items() if key not in inner]
        if rows:
            yield heading(f"[{path}]"), meaning(path), HEADS, rows
        for key, one in inner.items():
            yield from of_table(joined(path, key), one, told)


def is_table(path, value):
    """Whether it is told by itself; one that says two things of a pair of surfaces is a row of its table."""
    return isinstance(value, dict) and path in schema.TABLES and not path.startswith("granular.contacts.")


def is_listing(value):
    return isinstance(value, list) and bool(value) and all(isinstance(item, dict) for item in value)


def heading(name):
    return f"<code>{words.escape(name)}</code>"


def meaning(path):
    return words.prose(schema.TABLES.get(path, ""))


def joined(table, key):
    return f"{table}.{key}" if table else key


def row(table, key, value, told):
    return (f"<code>{words.escape(key)}</code>", told.symbol(table, key), with_unit(value, told.unit(table, key)),
            told.meaning(table, key))


def with_unit(value, unit):
    """A string has its unit already: what SI does not hold exactly is written as "2.5 f/mu". Speeds are in mm/s."""
    if unit == "m/s" and words.is_number(value):
        value, unit = 1e3 * value, "mm/s"
    return shown(value) if isinstance(value, str) else f"{shown(value)} {unit}".strip()


def listing(table, items, told):
    """One row an item, one column a key."""
    keys = list(dict.fromkeys(key for item in items for key in item))
    unit = {key: told.unit(table, key) for key in keys}
    speeds = {key for key in keys if unit[key] == "m/s"}
    unit |= dict.fromkeys(speeds, "mm/s")
    items = [item | {key: 1e3 * item[key] for key in speeds if words.is_number(item.get(key))} for item in items]
    return (["No."] + [words.escape(key.replace("_", " ")) + (f" ({unit[key]})" if unit[key] else "") for key in keys],
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
