"""Numbers and a little mathtext as text for a page."""

import html
import math
import re

GREEK = {"alpha": "α", "gamma": "γ", "eta": "η", "kappa": "κ", "mu": "μ", "nu": "ν", "xi": "ξ", "theta": "θ", "pm": "±",
         "times": "×", "infty": "∞", "varepsilon": "ε", "epsilon": "ε", "zeta": "ζ", "lambda": "λ"}
SUPERSCRIPT = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


def number(value, digits=4):
    """4 significant digits; a power of ten only where plain digits would be unreadable."""
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        return str(value)
    if not math.isfinite(value):
        return str(value)
    text = f"{value:.{digits}g}" if isinstance(value, float) else str(value)
    mantissa, mark, exponent = text.partition("e")
    mantissa = mantissa.replace("-", "−")
    if not mark:
        return mantissa
    power = "10" + str(int(exponent)).translate(SUPERSCRIPT)
    return power if mantissa == "1" else f"{mantissa} × {power}"


def escape(value):
    return html.escape(str(value))


def label_html(text):
    """A run's label, mathtext included, as HTML."""
    def formula(match):
        inner = re.sub(r"\\([a-zA-Z]+) ?", lambda m: GREEK.get(m[1], ""), match[1])
        inner = re.sub(r"_\{?([\w]+)\}?", r"<sub>\1</sub>", html.escape(inner))
        return re.sub(r"[{}\\]", "", inner)
    parts = re.split(r"(\$[^$]*\$)", text)
    return "".join(formula(re.fullmatch(r"\$([^$]*)\$", part)) if re.fullmatch(r"\$[^$]*\$", part) else html.escape(part)
                   for part in parts)
