"""Parameters of a fit by name, value and unit: as HTML for the report and its captions, as mathtext for the figures."""

import math
import re

from . import schema, words

POSES = {"x": ("x", "x"), "y": ("y", "y"), "heading": (r"\theta", "θ")}  # as TeX and in HTML
LETTER = "([A-Za-ln-rt-z])"  # a length of the problem; m and s are units


def symbol(name):
    """Mathtext without dollars."""
    known = schema.FIT_PARAMETERS.get(name)
    pose = pose_of(name)
    if pose:
        return rf"{POSES[pose[0]][0]}_{{{pose[2]}}}^{{({pose[1]})}}"
    return known["symbol"] if known else r"\mathrm{%s}" % re.sub(r"[^\w.+-]", "?", name).replace("_", r"\ ")


def symbol_html(name):
    pose = pose_of(name)
    if pose:
        return f"<i>{POSES[pose[0]][1]}</i><sub>{pose[2]}</sub><sup>({pose[1]})</sup>"
    return words.tex_html(schema.FIT_PARAMETERS[name]["symbol"]) if name in schema.FIT_PARAMETERS else words.escape(name)


def pose_of(name):
    """(what, trajectory, rod) of a part of a start that was fitted."""
    found = re.fullmatch(r"(x|y|heading)\.(\d+)\.(\d+)", name)
    return found.groups() if found else None


def meaning(name):
    pose = pose_of(name)
    if pose:
        return f"{pose[0]} of rod {pose[2]} at the start of trajectory {pose[1]}"
    return words.prose(schema.FIT_PARAMETERS[name]["meaning"]) if name in schema.FIT_PARAMETERS else ""


def unit_html(unit):
    """`a^2`, `v0 mu/f`: letters in italics, powers raised."""
    if unit in ("", "1"):
        return ""
    text = re.sub(rf"(?<![\w&]){LETTER}(?![\w;])", r"<i>\1</i>", words.escape(unit))
    text = re.sub(r"(?<![\w<&;])(mu|kappa|xi)(?!\w)", lambda m: f"<i>{words.GREEK[m[1]]}</i>", text).replace("v0", "<i>v</i><sub>0</sub>")
    return re.sub(r"\^(?:\(([-\d/.]+)\)|(-?[\d.]+))", lambda m: f"<sup>{(m[1] or m[2]).replace('-', '−')}</sup>", text)


def axis(letter, unit):
    """`x/a`, or `x / mm`."""
    if re.fullmatch(LETTER, unit):
        return rf"${letter}/{unit}$"
    return rf"${letter}$ / {words_of(unit)}"


def length(value, unit):
    """`4 a` as mathtext without dollars; 0 needs no unit."""
    number = words.math_number(float(value))
    return "0" if value == 0 else rf"{number}\,{unit}" if re.fullmatch(LETTER, unit) else rf"{number}\ \mathrm{{{words_of(unit)}}}"


def words_of(unit):
    """A unit that mathtext takes for text."""
    return re.sub(r"[^\w µ./*-]", "", unit).replace("_", " ")


def line(profile):
    """What a profile shows, `U_x(x, 4 a)`, as (mathtext, HTML)."""
    component, along, at = str(profile.get("component", "U")), str(profile.get("along", "x")), profile.get("at", 0.0)
    return component[1:] or "?", along, at if words.is_number(at) else 0.0


def line_math(profile, unit):
    component, along, at = line(profile)
    fixed = length(at, unit)
    return rf"$U_{component}({f'x, {fixed}' if along == 'x' else f'{fixed}, y'})$"


def line_html(profile, unit):
    component, along, at = line(profile)
    fixed = "0" if at == 0 else f"{words.number(float(at))} {unit_html(unit)}"
    inside = f"<i>x</i>, {fixed}" if along == "x" else f"{fixed}, <i>y</i>"
    return f'<span class="eq"><i>U<sub>{words.escape(component)}</sub></i>({inside})</span>'


def value(parameter):
    """`2.20 ± 0.04 a` as HTML."""
    return with_unit(words.with_error(parameter.value, parameter.error), parameter.unit) + (
        ", not fixed by the data" if parameter.error == math.inf else "")


def values(parameters):
    """The free ones with their errors."""
    return ", ".join(f'<span class="eq">{symbol_html(one.name)} = {value(one)}</span>' for one in parameters)


def medium_values(fit):
    """What maps say of the medium, with errors of every cause; nothing of other fits."""
    units = {name: one.unit for name, one in fit.parameters.items()} | {name: unit for name, (_, _, unit) in fit.derived.items()}
    known = {name: fit.systematics.get(name) or {} for name in ("f_over_mu", "eta", "xi")}
    if not all(words.is_number(one.get("total")) for one in known.values()):
        return ""
    return ", ".join(f'<span class="eq">{symbol_html(name)} = {with_unit(words.with_error(one["value"], one["total"]), units[name])}</span>'
                     for name, one in known.items())


def with_unit(text, unit):
    unit = unit_html(unit)
    return f"({text}) {unit}" if unit and "±" in text and not text.startswith("(") else f"{text} {unit}".strip()


def plain_math(text):
    """A number of `words`, HTML, as mathtext without dollars."""
    text = re.sub(r"<sup>(.*?)</sup>", r"^{\1}", text).replace("±", r"\pm").replace("×", r"\times").replace("−", "-")
    return text.replace(" ", r"\,")


def excess(profile):
    """(factor by which the data exceed the prediction, its error) or None."""
    found = profile.get("excess")
    if not isinstance(found, dict) or not words.is_number(found.get("scale")):
        return None
    error = found.get("stderr")
    return float(found["scale"]), float(error) if words.is_number(error) else math.nan


def excess_html(found):
    text = words.with_error(*found)
    return f"({text})" if "±" in text and not text.startswith("(") else text


def chance_html(probability):
    """`p = 0.03`, `p < 0.001`."""
    if not math.isfinite(probability):
        return "<i>p</i> not known"
    return "<i>p</i> &lt; 0.001" if probability < 0.001 else f"<i>p</i> = {words.number(probability, 2)}"


def without_folders(text):
    """A message of the program without the folders of its files."""
    return re.sub(r"(?<![\w.])[\w.~-]*/(?:[^\s,;:/]+/)*(?=[^\s,;:/]+\.\w)", "", text)


def predicted(profile):
    return profile.get("role") == "predict"


def interval_html(low, high, unit=""):
    """`1.1 to 1.5`; a side without an end is described in words."""
    if not math.isfinite(low) and not math.isfinite(high):
        return "unbounded"
    if not math.isfinite(low):
        return with_unit(f"below {words.number(high)}", unit)
    if not math.isfinite(high):
        return with_unit(f"above {words.number(low)}", unit)
    return with_unit(f"{words.number(low)} to {words.number(high)}", unit)


def quantity(parameter):
    """Axis label of a parameter."""
    unit = "" if parameter.unit in ("", "1") else unit_math(parameter.unit)
    return rf"${symbol(parameter.name)}$" + (f" ({unit})" if unit else "")


def unit_math(unit):
    """`a^2`, `v0 mu/f` as mathtext with dollars."""
    text = re.sub(r"[^\w^/() .*+-]", "", unit).replace("v0", "v_0")
    text = re.sub(r"\^(?:\(([-\d/.]+)\)|(-?[\d.]+))", lambda m: f"^{{{m[1] or m[2]}}}", text)
    text = re.sub(r"(?<![\w\\])(mu|kappa|xi)(?!\w)", r"\\\1{}", text)
    text = re.sub(r"(?<![\w\\])([A-Za-zµ]{2,}|[ms])(?!\w)", r"\\mathrm{\1}", text)
    return f"${text.replace(' ', chr(92) + ',')}$"
