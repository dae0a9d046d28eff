"""Axis labels and scale factors: reduced results are drawn as they are, SI results with a handy prefix."""

import math
from typing import NamedTuple

from . import schema, words
from .errors import PlotError

# Labels of the theory are without unit: x in f/mu is "x mu/f".
REDUCED = {"f/mu": r"\,\mu/f", "f/(mu v0)": r"\,\mu v_0/f", "mu v0/f": r"\,f/(\mu v_0)", "v0": r"/v_0"}
TABLES = {"eta": "medium", "alpha": "medium", "xi": "medium", "kappa": "coupling", "gamma1": "coupling", "gamma2": "coupling"}
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
        number = words.math_number(value * axis.factor)
        if not self.si:
            return rf"${axis.label.strip('$')} = {number}$"
        if value == 0:
            return rf"${symbol} = 0$"
        return rf"${symbol} = {number}$ " + axis.label.split("$ ", 1)[1].strip("()")

    def parameter(self, name, value, digits=4):
        """`kappa f/(mu v0) = 0.5`, or in SI with its unit behind, as mathtext without dollars."""
        symbol, unit = schema.SYMBOLS[name], schema.KEYS[TABLES[name], name].get("unit", {}).get("si" if self.si else "reduced", "")
        if not self.si:
            return rf"{symbol}{REDUCED.get(unit, '')} = {words.math_number(value, digits)}"
        return rf"{symbol} = {words.math_number(value, digits)}" + (rf"\ \mathrm{{{unit.replace('1/s', 's^{-1}')}}}" if unit else "")

    def gradient_unit(self):
        """Unit of gamma times a second derivative of u, gamma in v0."""
        return r"v_0\,\mathrm{m}^{-1}" if self.si else r"v_0\mu/f"

    # The same in words, for the report.
    def length_html(self):
        return "m" if self.si else "<i>f</i>/<i>μ</i>"

    def time_html(self):
        return "s" if self.si else "<i>f</i>/(<i>μv</i><sub>0</sub>)"
