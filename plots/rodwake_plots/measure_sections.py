"""The part of the report that tells what was measured: measure.json in words."""

from . import fit_words, measured, schema, words

TITLED = [told for told in schema.MEASURED if "title" in told]
NUMBERS = [told for told in TITLED if "factor" in told]
TEXTS = [told for told in TITLED if "factor" not in told]


def heads_and_rows(run):
    """The parts side by side; nothing where nothing was measured."""
    parts = [part for part in measured.parts(run) if part.has(measured.RESULTS)]
    if not parts:
        return (), []
    names = [words.label_html(part.label) for part in parts] if len(parts) > 1 else ["Value"]
    rows = [*(text_row(parts, told) for told in TEXTS), *(number_row(parts, told) for told in NUMBERS)]
    return ("Quantity", *names, "Meaning"), [row for row in rows if row]


def text_row(parts, told):
    values = [part.told(told["measure"], told["key"]) for part in parts]
    meaning = words.text_html(told["meaning"])
    if told["key"] == "phase" and len(parts) == 1:
        meaning = words.escape(parts[0].told("order", "reason") or "") or meaning
    cells = ["" if value is None else words.escape(value) for value in values]
    return (words.text_html(told["title"]), *cells, meaning) if any(values) else None


def number_row(parts, told):
    cells = [cell(part, told) for part in parts]
    return (words.text_html(told["title"]), *cells, words.text_html(told["meaning"])) if any(cells) else None


def cell(part, told):
    """Speeds are in mm/s all over the report, whatever the file has."""
    table, key, factor, unit = told["measure"], told["key"], told["factor"], fit_words.unit_html(told["unit"])
    if told["unit"] == "a/s":
        factor, unit = 1e3 * part.granular.a, "mm/s"
    found = part.told(table, key)
    if found is None:
        return ""
    if not isinstance(found, dict):
        value = part.number(table, key)
        return f"{words.number(value * factor if isinstance(value, float) else value)} {unit}".strip()
    estimate = part.estimate(table, key)
    if estimate is None:
        return ""
    text = words.with_error(estimate.value, estimate.error, factor)
    text = f"({text})" if unit and "±" in text and not text.startswith("(") else text
    return f"{text} {unit}".strip()
