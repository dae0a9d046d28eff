"""Numbers and a little mathtext as text for a page."""

import html
import math
import re

GREEK = {"alpha": "α", "gamma": "γ", "eta": "η", "kappa": "κ", "mu": "μ", "nu": "ν", "xi": "ξ", "theta": "θ", "pm": "±",
         "times": "×", "infty": "∞", "varepsilon": "ε", "epsilon": "ε", "zeta": "ζ", "lambda": "λ", "phi": "φ", "psi": "ψ",
         "Gamma": "Γ", "Delta": "Δ"}

SYMBOLS = {"eta": "<i>η</i>", "alpha": "<i>α</i>", "xi": "<i>ξ</i>", "nu": "<i>ν</i>", "kappa": "<i>κ</i>",
           "gamma1": "<i>γ</i><sub>1</sub>", "gamma2": "<i>γ</i><sub>2</sub>"}


def parts(value, digits):
    """(mantissa, exponent or None) as strings; a power of ten only where plain digits would be unreadable."""
    text = f"{value:.{digits}g}" if isinstance(value, float) else str(value)
    mantissa, mark, exponent = text.replace("-", "−").partition("e")
    return mantissa, exponent.replace("+", "").replace("−0", "−").lstrip("0") if mark else None


def is_number(value):
    return isinstance(value, (int, float)) and not isinstance(value, bool)


def number(value, digits=4):
    """A value as HTML; anything but a number is escaped text."""
    if not is_number(value):
        return escape(value)
    mantissa, exponent = parts(value, digits)
    if exponent is None:
        return mantissa
    power = f"10<sup>{exponent}</sup>"
    return power if mantissa == "1" else f"{mantissa} × {power}"


def math_number(value, digits=4):
    """The same as mathtext."""
    mantissa, exponent = parts(value, digits)
    mantissa = mantissa.replace("−", "-")
    if exponent is None:
        return mantissa
    lead = "" if mantissa == "1" else rf"{mantissa}\times "
    return rf"{lead}10^{{{exponent.replace('−', '-')}}}"


def equation(symbol, value, unit="", digits=4):
    """`symbol = value unit`, which does not break across lines."""
    return f'<span class="eq">{symbol} = {number(value, digits)}{" " + unit if unit else ""}</span>'


def escape(value):
    return html.escape(str(value))


def label_html(text):
    """A run's label, mathtext included, as HTML."""
    def formula(match):
        inner = re.sub(r"\\([a-zA-Z]+) ?", lambda m: GREEK.get(m[1], ""), match[1].replace(r"\,", "\u2009"))
        inner = re.sub(r"_\{?([\w]+)\}?", r"<sub>\1</sub>", html.escape(inner))
        return re.sub(r"[{}\\]", "", inner)
    parts = re.split(r"(\$[^$]*\$)", text)
    return "".join(formula(re.fullmatch(r"\$([^$]*)\$", part)) if re.fullmatch(r"\$[^$]*\$", part) else html.escape(part)
                   for part in parts)


def with_error(value, error, factor=1.0):
    """`value ± error` with two digits of the error; an unknown error (nan or None) is left out."""
    value *= factor
    if error is None or not math.isfinite(error) or error < 0:
        return number(float(value), 4)
    error *= factor
    size = max(abs(value), error)
    power = math.floor(math.log10(size)) if size > 0 else 0
    scale = 10.0 ** power if not -3 <= power <= 4 else 1.0
    value, error = value / scale, error / scale
    digits = max(0, 1 - math.floor(math.log10(error))) if error > 0 else 3
    if digits > 8:  # an error as small as rounding
        return f"{number(value * scale, 9)} ± {number(error * scale, 2)}"
    text = f"{value:.{digits}f} ± {error:.{digits}f}".replace("-", "−")
    return text if scale == 1.0 else f"({text}) × 10<sup>{str(power).replace('-', '−')}</sup>"
