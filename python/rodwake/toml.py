"""Values as a scene file has them."""

from __future__ import annotations

import json
from typing import Any, Mapping

import numpy as np

from . import arguments
from .errors import InputError


_LEGAL = "a scene holds numbers, strings, true, false, lists and tables of them"


def toml(value: Any, key: str = "") -> str:
    """Numbers, strings ("5 s" has a unit), true, false, lists and mappings of them; NumPy's too."""
    if hasattr(value, "tolist"):  # of NumPy
        if arguments.is_masked(value) or np.asarray(value).dtype.kind not in "biufUO":  # most others would turn into numbers
            raise InputError(f"{key or 'values'}: {value!r}: {_LEGAL}, none of them masked")
        value = value.tolist()
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        return json.dumps(value, ensure_ascii=False)
    if isinstance(value, (list, tuple)):
        return f"[{', '.join(toml(one, key) for one in value)}]"
    if isinstance(value, Mapping):
        return "{" + ", ".join(f"{name} = {toml(one, name)}" for name, one in value.items()) + "}"
    if isinstance(value, (int, float)):
        return repr(value)
    raise TypeError(f"{f'{key}: ' if key else ''}{_LEGAL}, not {type(value).__name__}")
