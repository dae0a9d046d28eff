"""What the program says of scenes: schema.json, which `rodwake info --schema` prints."""

import json
from pathlib import Path

ALL = json.loads(Path(__file__).with_name("schema.json").read_text(encoding="utf-8"))
KEYS = {(key["table"], key["key"]): key for key in ALL["keys"]}
TABLES = {table["table"]: table["meaning"] for table in ALL["tables"]}
FIGURES = {kind["kind"]: kind for kind in ALL["figures"]}  # in the order of reports
FIT_PARAMETERS = {one["name"]: one for one in ALL["fit_parameters"]}
MEASURED = ALL["measures"]  # values of measure.json, in the order of the report
PROFILES_UNIT = "of the profiles"  # unit of lengths in [fit]: whatever the measured files are in
# Symbols of the physics by name, TeX without dollars.
SYMBOLS = {key["key"]: key["symbol"] for key in ALL["keys"] if key["table"] in ("medium", "coupling") and "symbol" in key}


def subject(kind):
    """Whose results a figure of this kind shows: bed, measure, theory or fit."""
    return FIGURES[kind]["subject"]
