"""An axis of a scan: what it is called, in what it is even, and how it stands in a figure."""

import html
import re
from dataclasses import dataclass, field

import numpy as np
from matplotlib.ticker import MaxNLocator, SymmetricalLogLocator

from . import fit_words, ranges, schema, style, terminal, units, words
from .errors import PlotError

PREFIXED = ("m", "s", "m/s", "N")
WIDE = 25  # listed values that span more than this factor, and are positive, stand on a logarithmic axis
FEW = 7    # listed values that have a tick each
PLACES = re.compile(r"(?:granular\.)?rods\.(\d+)\.(position\.([01])|heading)")


@dataclass(frozen=True)
class Axis:
    key: str
    keys: tuple        # tied to the first: their values are those of the axis times `factors`
    factors: tuple
    symbol: str        # TeX without dollars; or words, if it is no TeX
    unit: str
    scale: str         # linear, log or choice
    low: float         # in the numbers of the file; of a choice -0.5 ...
    high: float
    values: tuple      # as listed; of a choice words
    factor: float = field(default=1.0)  # shown is the number of the file times this
    prefix: str = ""

    @property
    def is_tex(self):
        return style.is_mathtext(f"${self.symbol}$")

    @property
    def name(self):
        """For a figure."""
        return f"${self.symbol}$" if self.is_tex else style.literal(self.symbol)

    @property
    def is_choice(self):
        return self.scale == "choice"

    @property
    def sign(self):
        """Of a logarithmic axis: its ends have the same."""
        return -1.0 if self.high < 0 else 1.0

    def even(self, values):
        """Coordinates of numbers of the file in which the axis is even."""
        values = np.asarray(values, dtype=float)
        with np.errstate(divide="ignore", invalid="ignore"):
            return self.sign * np.log10(self.sign * values) if self.scale == "log" else values

    def back(self, places):
        places = np.asarray(places)
        return self.sign * 10.0 ** (self.sign * places) if self.scale == "log" else places

    @property
    def span(self):
        """Length of the axis in even coordinates."""
        return float(self.even(self.high) - self.even(self.low)) or 1.0

    @property
    def label(self):
        """For a figure, with its unit."""
        if self.factor == 1.0 and self.unit in units.REDUCED and self.is_tex:
            return f"${self.symbol}{units.REDUCED[self.unit]}$"
        if self.unit in PREFIXED:
            return rf"{self.name} ($\mathrm{{{self.prefix}{self.unit}}}$)"
        return self.name + (f" ({fit_words.unit_math(self.unit)})" if self.unit not in ("", "1") else "")

    def equals(self, value):
        """`x_1 = 3 f/mu` as mathtext; of a choice its word."""
        if self.is_choice:
            return f"{self.key.rpartition('.')[2].replace('_', ' ')}: {style.safe(self.values[int(value)])}"
        unit = rf"\ \mathrm{{{self.prefix}{self.unit}}}" if self.unit in PREFIXED else (
            r"\ " + fit_words.unit_math(self.unit).strip("$") if self.unit not in ("", "1") else "")
        told = f"= {words.math_number(float(value) * self.factor)}{unit}$"
        return f"${self.symbol} {told}" if self.is_tex else f"{self.name} ${told}"

    @property
    def name_html(self):
        return words.tex_html(self.symbol.replace(r"\ ", " ")) if self.is_tex else words.escape(self.symbol)

    @property
    def unit_html(self):
        prefix = {r"\mu ": "µ"}.get(self.prefix, self.prefix)
        return prefix + fit_words.unit_html(self.unit)

    def equals_text(self, value):
        """`κ = 3` as plain text; the axis has the unit."""
        name = html.unescape(re.sub("<[^>]*>", "", self.name_html))
        return f"{name}: {self.values[int(value)]}" if self.is_choice else f"{name} = {value * self.factor:.4g}"

    def equals_html(self, value):
        if self.is_choice:
            return f"{self.name_html}: {words.escape(self.values[int(value)])}"
        return words.equation(self.name_html, float(value) * self.factor, self.unit_html)

    def set_scale(self, axis):
        set_scale = getattr(axis.axes, f"set_{axis.axis_name}scale")
        if self.scale != "log":
            set_scale("linear")
        elif self.sign > 0:
            set_scale("log")
        else:  # the part of a symmetric one that is logarithmic
            set_scale("symlog", linthresh=-self.high / 10 * self.factor)

    def dress(self, axis, low, high):
        """Scale, limits (in numbers of the file), ticks and label of a matplotlib axis."""
        self.set_scale(axis)
        axis.axes.set(**{f"{axis.axis_name}lim": (low * self.factor, high * self.factor)})
        if self.scale == "log" and self.sign > 0:
            ranges.plain_ticks(axis, low * self.factor, high * self.factor)
            ranges.plain_decades(axis, low * self.factor, high * self.factor)
        elif self.scale == "log":
            axis.set_major_locator(SymmetricalLogLocator(axis.get_transform()))
            axis.set_minor_locator(SymmetricalLogLocator(axis.get_transform(), subs=range(2, 10)))
            ranges.plain_decades(axis, -high * self.factor, -low * self.factor)
        elif self.is_choice:
            axis.set_ticks(range(len(self.values)), [style.safe(value) for value in self.values])
            axis.set_tick_params(length=0)
        elif 1 < len(self.values) <= FEW:
            axis.set_ticks([value * self.factor for value in self.values])
        else:
            axis.set_major_locator(MaxNLocator(7, steps=[1, 2, 5, 10]))
        axis.set_label_text(self.label)


def from_json(told, place, bead_radius=None):
    """An entry of scan.json, whose file is `place`; lengths of beds are shown in a."""
    try:
        key, values = told["key"], tuple(told.get("values") or ())
        low, high = (values[0], values[-1]) if values else (told["from"], told["to"])
        if isinstance(low, str):
            return Axis(key, (key,), (1.0,), symbol_of(key, told), "", "choice", -0.5, len(values) - 0.5, values)
        low, high = (min(values), max(values)) if values else (min(low, high), max(low, high))
        low, high = float(low), float(high)
        spacing = told.get("spacing", "linear")
    except (KeyError, TypeError, ValueError) as error:
        raise PlotError(f"{place}: an axis lacks what it needs: {error}") from error
    log = spacing == "log" or (spacing == "listed" and low > 0 and high > WIDE * low)
    unit = told.get("unit") or ""
    factor, prefix = scaled(unit, max(abs(low), abs(high)), log)
    if unit == "m" and bead_radius:
        factor, prefix, unit = 1.0 / bead_radius, "", "a"
    return Axis(key, tuple(told.get("keys") or (key,)), tuple(told.get("factors") or (1.0,)), symbol_of(key, told), unit,
                "log" if log and low * high > 0 else "linear", low, high, values, factor, prefix)


def scaled(unit, extent, log):
    """(factor, prefix) of SI lengths, times, speeds and forces."""
    return units.prefix_for(extent) if unit in PREFIXED and not log else (1.0, "")


def symbol_of(key, told):
    """TeX: as the scene calls it, of starts x_1 and the like, as the program says, else the name of the key."""
    if told.get("label"):
        return said_if_plain(str(told["label"]), key)
    found = PLACES.fullmatch(key)
    if found:
        return rf"{'xy'[int(found[3])] if found[3] else chr(92) + 'theta'}_{{{found[1]}}}"
    if told.get("symbol"):
        return str(told["symbol"])
    table, _, name = key.rpartition(".")
    known = schema.KEYS.get((table, name), {}).get("symbol")
    return known or r"\mathrm{%s}" % re.sub(r"[^\w.+-]", "?", name).replace("_", r"\ ")


def said_if_plain(label, key):
    if not style.is_mathtext(f"${label}$"):
        terminal.say_once(f"scan axis {key}: label = \"{label}\" is not TeX that figures can show: it stands there as plain text")
    return label


def shown_window(axis, asked, name):
    """Limits of a figure in numbers of the file: as asked for, else the whole axis."""
    if not asked:
        return axis.low, axis.high
    if axis.scale == "log" and any(axis.sign * end <= 0 for end in asked):
        raise PlotError(f"{name} = [{asked[0]:g}, {asked[1]:g}]: the axis {axis.key} is logarithmic: numbers of its sign only")
    return tuple(map(float, asked))


def margin(axis, share):
    """The axis's ends moved outwards by this part of its length."""
    if axis.is_choice:
        return axis.low, axis.high
    low, high = axis.even(axis.low), axis.even(axis.high)
    return tuple(float(axis.back(place)) for place in (low - share * axis.span, high + share * axis.span))


