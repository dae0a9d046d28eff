"""Numbers and a little mathtext as text for a page."""

import html
import math
import re
import string
from typing import NamedTuple

from . import schema
from .errors import PlotError

GREEK = {"alpha": "α", "gamma": "γ", "eta": "η", "kappa": "κ", "mu": "μ", "nu": "ν", "xi": "ξ", "rho": "ρ", "theta": "θ", "pm": "±",
         "times": "×", "infty": "∞", "varepsilon": "ε", "epsilon": "ε", "zeta": "ζ", "lambda": "λ", "phi": "φ", "psi": "ψ",
         "Gamma": "Γ", "Delta": "Δ"}

SCRIPTS = {"_": "sub", "^": "sup"}
SIGNS = {"-": "−", "=": " = ", "\\,": "\u2009", "\\ ": "\u2009"}
RELATIONS = {"propto": "∝", "to": "→"}
TEX = re.compile(r"\\(?:mathrm|tilde)\{[^}]*\}|\\[A-Za-z]+|\\[, ]|[_^]|\{[^}]*\}|\S")
SPELT = re.compile(r"(?<![\w.\"])(alpha|eta|gamma|kappa|lambda|mu|nu|phi|psi|xi|zeta)(\d?)(?:_([A-Za-z]+))?(?!\w)")


def tex_html(tex):
    """A symbol of schema.json, `\\gamma_1`, as HTML."""
    text, script = "", ""
    for token in TEX.findall(tex):
        if token in SCRIPTS:
            script = SCRIPTS[token]
            continue
        text += f"<{script}>{atom(token)}</{script}>" if script else atom(token)
        script = ""
    return text


def atom(token):
    if token.startswith(r"\mathrm"):
        return html.escape(token[8:-1])
    if token.startswith(r"\tilde"):
        return tex_html(token[7:-1]) + "\u0303"
    if token[1:] in RELATIONS:
        return f" {RELATIONS[token[1:]]} "
    if token in SIGNS:
        return SIGNS[token]
    if token.startswith("{"):
        return tex_html(token[1:-1])
    letter = GREEK.get(token[1:], "") if token.startswith("\\") else token
    return f"<i>{letter}</i>" if letter.isalpha() and not (token.startswith("\\") and letter.isupper()) else html.escape(letter)


def text_html(text):
    """Text with formulas as TeX between dollars, as HTML."""
    return "".join(tex_html(part) if index % 2 else html.escape(part, quote=False) for index, part in enumerate(text.split("$")))


def symbol(name):
    """Of a quantity of [medium] or [coupling], as HTML."""
    return tex_html(schema.PHYSICS[name]["symbol"])


def prose(text):
    """A meaning of schema.json as HTML: Greek letters that are spelt out become letters, `x` code and ^2 a power."""
    def letter(found):
        below = ",".join(part for part in found.groups()[1:] if part)
        return f"<i>{GREEK[found[1]]}</i>" + (f"<sub>{below}</sub>" if below else "")
    text = SPELT.sub(letter, html.escape(text, quote=False))
    for plain, page in ((r"\bv0\b", "<i>v</i><sub>0</sub>"), (r"\bpi\b", "π"), (r"\^(-?\d+)\b", r"<sup>\1</sup>"), (r"`([^`]*)`", r"<code>\1</code>")):
        text = re.sub(plain, page, text)
    return text


def parts(value, digits):
    """(mantissa, exponent or None) as strings; a power of ten only where plain digits would be unreadable."""
    text = f"{value:.{digits}g}" if isinstance(value, float) else str(value)
    mantissa, mark, exponent = text.replace("-", "−").partition("e")
    return mantissa, exponent.replace("+", "").replace("−0", "−").lstrip("0") if mark else None


def is_number(value):
    return isinstance(value, (int, float)) and not isinstance(value, bool)


def number(value, digits=4):
    """A value as HTML; anything but a number is escaped text."""
    if value is None:
        return "unknown"
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


def listed(names):
    """`a, b and c`."""
    return " and ".join(filter(None, [", ".join(names[:-1]), names[-1]]))


def letter(index):
    """Of a panel."""
    return f"({string.ascii_lowercase[index % 26]})"


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


# Axis labels and scale factors: reduced results are drawn as they are, SI results with a handy prefix.

# Labels of the theory are without unit: x in f/mu is "x mu/f".
REDUCED = {"f/mu": r"\,\mu/f", "f/(mu v0)": r"\,\mu v_0/f", "mu v0/f": r"\,f/(\mu v_0)", "v0": r"/v_0"}
PREFIXES = {-9: "n", -6: r"\mu ", -3: "m", 0: "", 3: "k"}


class Axis(NamedTuple):
    factor: float  # multiply the stored values by this
    label: str     # mathtext


def prefix_for(extent):
    """(factor, prefix) that brings `extent` into 1..1000."""
    exponent = 3 * math.floor(math.log10(extent) / 3) if extent > 0 and math.isfinite(extent) else 0
    exponent = min(max(exponent, -9), 3)
    return 10.0 ** -exponent, PREFIXES[exponent]


class Units:
    def __init__(self, system):
        if system not in ("reduced", "si"):
            raise PlotError(f'result.h5: units "{system}" are neither "reduced" nor "si"')
        self.si = system == "si"

    def _axis(self, symbol, reduced, unit, extent):
        if not self.si:
            return Axis(1.0, rf"${symbol}\,{reduced}$")
        factor, prefix = prefix_for(extent)
        return Axis(factor, rf"${symbol}$ ($\mathrm{{{prefix}{unit}}}$)")

    def length(self, symbol, extent):
        return self._axis(symbol, r"\mu/f", "m", extent)

    def time(self, symbol, extent):
        return self._axis(symbol, r"\mu v_0/f", "s", extent)

    def root_length(self, symbol, length, extent):
        """|x|^(1/2) U: one length of the coordinate to the half times one of the displacement."""
        if not self.si:
            return Axis(1.0, rf"${symbol}\,(\mu/f)^{{3/2}}$")
        factor, prefix = prefix_for(extent ** (2 / 3))
        return Axis(factor ** 1.5, rf"${symbol}$ ($\mathrm{{{prefix}m}}^{{3/2}}$)")

    def equals(self, axis, symbol, value):
        """`symbol = value` with its unit, as mathtext."""
        number = math_number(value * axis.factor)
        if not self.si:
            return rf"${axis.label.strip('$')} = {number}$"
        if value == 0:
            return rf"${symbol} = 0$"
        return rf"${symbol} = {number}$ " + axis.label.split("$ ", 1)[1].strip("()")

    def parameter(self, name, value, digits=4):
        """`kappa f/(mu v0) = 0.5`, or in SI with its unit behind, as mathtext without dollars."""
        entry = schema.PHYSICS[name]
        symbol, unit = entry["symbol"], entry.get("unit", {}).get("si" if self.si else "reduced", "")
        if not self.si:
            return rf"{symbol}{REDUCED.get(unit, '')} = {math_number(value, digits)}"
        return rf"{symbol} = {math_number(value, digits)}" + (rf"\ \mathrm{{{unit.replace('1/s', 's^{-1}')}}}" if unit else "")

    def gradient_unit(self):
        """Unit of gamma times a second derivative of u, gamma in v0."""
        return r"v_0\,\mathrm{m}^{-1}" if self.si else r"v_0\mu/f"

    # The same in words, for the report.
    def length_html(self):
        return "m" if self.si else "<i>f</i>/<i>μ</i>"

    def time_html(self):
        return "s" if self.si else "<i>f</i>/(<i>μv</i><sub>0</sub>)"
