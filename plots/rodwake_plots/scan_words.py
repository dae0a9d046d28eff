"""What is said of a scan: fixed parameters, numbers of points, how far the picture can be trusted."""

from typing import NamedTuple

import numpy as np

from . import fit_words, scan_columns, schema, words
from .scan_run import CERTIFICATES, OUTCOMES
from .scan_scene import ALIKE

FIXED = {"medium": ("eta", "xi"), "coupling": schema.COUPLINGS, "granular": ("phi_b",)}
MOST_RODS = 4
DESIGNS = {"grid": "a grid", "list": "a list of points", "lhs": "a Latin hypercube", "sobol": "a Sobol sequence",
           "adaptive": "adaptive refinement"}


def scanned(scan):
    """Keys that the axes set, and those that say the same."""
    keys = {key for axis in scan.axes for key in axis.keys}
    for table, alike in ALIKE:
        if any(f"{table}.{name}" in keys for name in alike):
            keys |= {f"{table}.{name}" for name in alike}
    return keys


def fixed(run):
    """(symbol as TeX, value, unit) of the couplings and the medium, where no axis sets them."""
    taken = scanned(run.scan)
    system = "si" if run.units.si else "reduced"
    for table, names in FIXED.items():
        for name in names:
            value = run.scene.get(table, {}).get(name)
            if name == "xi" and system == "reduced" and words.is_number(value) and value and "medium.xi" not in taken:
                yield schema.PHYSICS["alpha"]["symbol"], 1.0 / value, ""  # the same in reduced units, as the paper has it
                continue
            if words.is_number(value) and f"{table}.{name}" not in taken:
                entry = schema.KEYS[table, name]
                yield entry["symbol"], float(value), entry.get("unit", {}).get(system, "")


def fixed_title(run):
    """For the head of a figure, couplings and lengths with their units."""
    if run.units.si:
        unit = {one: r"\ " + fit_words.unit_math(one).strip("$") if one else "" for _, _, one in fixed(run)}
        return ",  ".join(f"${symbol} = {words.math_number(value)}{unit[one]}$" for symbol, value, one in fixed(run))
    return ",  ".join(f"${symbol}{words.REDUCED.get(one, '')} = {words.math_number(value)}$" for symbol, value, one in fixed(run))


def fixed_html(run):
    parts = [words.equation(words.tex_html(symbol), value, fit_words.unit_html(unit)) for symbol, value, unit in fixed(run)]
    parts += [f"{axis.equals_html(value)} of those scanned" for axis, value in held(run.scan)]
    return f" Fixed: {', '.join(parts)}." if parts else ""


def starts_html(run):
    """Where the rods start, the axes by their symbols."""
    rods = run.scene.get("rods") or []
    if not 0 < len(rods) <= MOST_RODS:
        return ""
    symbol = {key: (axis, factor) for axis in run.scan.axes for key, factor in zip(axis.keys, axis.factors)}
    starts = []
    for index, rod in enumerate(rods):
        place = [start(symbol, f"rods.{index}.position.{side}", value) for side, value in enumerate(rod.get("position", ()))]
        heading = start(symbol, f"rods.{index}.heading", rod.get("heading", 0.0))
        starts.append(f"rod {index} from ({', '.join(place)}), heading {heading}")
    return f" Starts: {'; '.join(starts)}."


def start(symbols, key, value):
    if key not in symbols:
        return words.number(value, 4)
    axis, factor = symbols[key]
    return axis.name_html if factor == 1.0 else f"{'−' if factor == -1.0 else words.number(factor) + ' '}{axis.name_html}"


def ties_html(scan):
    """Keys that an axis sets together."""
    ties = []
    for axis in scan.axes:
        if len(axis.keys) > 1:
            ties.append(f"{axis.name_html} sets " + ", ".join(
                f"<code>{words.escape(key)}</code>" + ("" if factor == 1.0 else f" (times {words.number(float(factor))})")
                for key, factor in zip(axis.keys, axis.factors)))
    return f" {'; '.join(ties)}." if ties else ""


def count(number):
    """12 345, so that it does not break."""
    return f"{number:,}".replace(",", "\u2009")


def axes_html(scan):
    return words.listed([axis.name_html for axis in scan.axes])


def outcomes_html(scan):
    """`contact 120, escape 30`, those that occur; of repeated points their runs."""
    if scan.runs > 1:
        counts = [(name, scan.runs_that_end(name)) for name in OUTCOMES]
    else:
        counts = [(name, int((scan.outcome == index).sum())) for index, name in enumerate(OUTCOMES)]
    return ("runs: " if scan.runs > 1 else "") + ", ".join(f"{name} {count(number)}" for name, number in counts if number)


def failures_html(scan):
    """How many points failed, and why."""
    failed = int(scan.failed.sum())
    if not failed:
        return ""
    causes = scan.record.get("causes") or {}
    why = "; ".join(f"{words.escape(cause)} ({count(number)})" for cause, number in causes.items() if words.is_number(number))
    return f" {count(failed)} point{'s' if failed > 1 else ''} failed" + (f": {why}." if why else ".")


def left_html(scan):
    left = scan.record.get("left")
    return f" {count(left)} points are not evaluated yet." if words.is_number(left) and left else ""


def missed_html(scan):
    """How often the colour is wrong where nobody looked, as far as the scan has checked."""
    rate, high, audited = (scan.record.get(key) for key in ("missed_rate", "missed_rate_high", "audited"))
    if not (words.is_number(rate) and words.is_number(audited) and audited):
        return ""
    bound = f"; with 95 % confidence below {percent(high)}" if words.is_number(high) else ""
    missed = scan.record.get("missed")
    tried = f"{count(missed)} of {count(audited)}" if words.is_number(missed) else count(audited)
    return f" Missed rate: {percent(rate)} of the area outside the boundary ({tried} random points{bound})."


def certificates_html(scan):
    """How well the outcomes are known."""
    points, area = (scan.record.get(key) for key in ("certificates", "certified_area"))
    if not isinstance(points, dict) or not any(points.get(name) for name in ("verified", "checked")):
        return ""
    counts = ", ".join(f"{name} {count(points[name])}" for name in CERTIFICATES if points.get(name))
    shares = ", ".join(f"{name} {percent(area[name])}" for name in CERTIFICATES if area.get(name)) if isinstance(area, dict) else ""
    return f" Outcomes of points: {counts}" + (f"; of the area: {shares}." if shares else ".")


def percent(share):
    return f"{words.number(float(100 * share), 2)} %"


def design_html(scan):
    """How the points were chosen."""
    text = DESIGNS.get(scan.design, words.escape(scan.design))
    resolution = scan.record.get("resolution")
    return text + (f" to {count(resolution)} cells a side" if scan.design == "adaptive" and words.is_number(resolution) else "")


def what(run, spec):
    """What the colours show."""
    if spec.colour == "outcome" and run.scan.runs > 1:
        return "The outcome that most runs of a point had; capture is contact, bound, orbit or pursuit"
    if spec.colour == "outcome":
        return "Outcome; capture is contact, bound, orbit or pursuit"
    column, unit = scan_columns.quantity(spec.colour, run.scan), scan_columns.unit_html(run, spec.colour)
    meaning = scan_columns.meaning(spec.colour, run.scan)
    return words.escape(column.name[0].upper() + column.name[1:]) + (f" in {unit}" if unit else "") + (f" ({meaning})" if meaning else "")


def points_html(scan):
    """How many points there are, by what design, with how many runs each."""
    each = f", {count(scan.runs)} runs each" if scan.runs > 1 else ""
    return f"{count(len(scan.failed))} points by {design_html(scan)}{each}"


def caption(run, spec):
    scan = run.scan
    text = f"{what(run, spec)}, over {axes_html(scan)}: {points_html(scan)}"
    text += f", {outcomes_html(scan)}." if (scan.outcome >= 0).any() else "."
    trust = failures_html(scan) + left_html(scan) + missed_html(scan) + certificates_html(scan)
    return text + shown_html(run, spec) + trust + fixed_html(run) + starts_html(run) + ties_html(scan)


def shown_html(run, spec):
    """What the lines are, and what stands in the panels."""
    scan, text = run.scan, ""
    if spec.kind == "phase_diagram" and spec.boundary and len(scan.axes) == 2 and scan.boundary:
        tolerance = (scan.record.get("boundary") or {}).get("tolerance")
        near = f", good to {words.number(float(tolerance))} of an axis" if words.is_number(tolerance) else ""
        text += " Lines: critical values." if scan.is_critical else f" Lines: boundaries traced by bisection{near}."
    if spec.kind == "phase_diagram" and len(scan.axes) == 2 and scan.has_cells and scan.open_cells.any():
        text += " Hatched: cells that are not known to have one outcome."
    if spec.kind == "phase_diagram" and spec.cells and scan.has_cells and len(scan.axes) > 1:
        text += " Thin lines: cells of the refinement."
    if spec.kind == "phase_diagram" and len(scan.axes) > 2:
        parts = slices(scan, spec.slices)
        text += f" Panel{'s' if len(parts) > 1 else ''}: {', '.join(part.html for part in parts)}."
        if scan.design not in ("grid", "adaptive") and not scan.axes[2].is_choice:
            share = thickness(scan, [part.at for part in parts]) / scan.axes[2].span
            text += f" Each shows the points within {percent(share / 2)} of that axis."
    return text


# Which points of a scan a panel shows: all of two axes, those at a value of the third.

MOST_PANELS = 4


class Slice(NamedTuple):
    rows: np.ndarray  # of points
    at: float         # place on the third axis, even coordinates; nan: there is none
    title: str        # mathtext
    html: str


def slices(scan, asked=()):
    """A Slice for each panel."""
    if len(scan.axes) < 3:
        return [Slice(np.ones(len(scan.failed), dtype=bool), np.nan, "", "")]
    axis, places = scan.axes[2], scan.places[:, 2]
    there = np.unique(places)
    at = wanted(scan, axis, there, asked)
    others = at_middle(scan)
    values = axis.back(at)
    return [Slice(others & near(scan, places, one, at), one, axis.equals(value), axis.equals_html(value)) for one, value in zip(at, values)]


def wanted(scan, axis, there, asked):
    """Places of the panels: as asked for or spread over the axis; of a grid and of choices places that it has."""
    if len(asked):
        at = axis.even(np.asarray(asked, dtype=float))
    elif len(there) <= MOST_PANELS:
        at = there
    elif scan.design in ("grid", "adaptive"):
        at = np.linspace(there[0], there[-1], MOST_PANELS)
    else:  # in the middles of slabs that share the axis
        at = axis.even(axis.low) + (np.arange(MOST_PANELS) + 0.5) / MOST_PANELS * axis.span
    if scan.design == "grid" or axis.is_choice:
        at = there[np.abs(there[:, None] - at).argmin(axis=0)]
    return list(dict.fromkeys(at.tolist()))


def near(scan, places, one, at):
    """Points of this slice: those there, and of scattered points those up to half-way to the next slice."""
    if scan.design in ("grid", "adaptive") or scan.axes[2].is_choice:
        return np.abs(places - one) <= 1e-9 * scan.axes[2].span
    return np.abs(places - one) <= thickness(scan, at) / 2


def thickness(scan, at):
    """Of the slab of scattered points that a panel shows, in even coordinates."""
    return np.diff(sorted(at)).min() if len(at) > 1 else scan.axes[2].span / MOST_PANELS


def at_middle(scan):
    """A fourth axis and further ones stay at their middle values, where points share values."""
    kept = np.ones(len(scan.failed), dtype=bool)
    for index in range(3, len(scan.axes)):
        there = np.unique(scan.places[:, index])
        if scan.design == "grid" or scan.axes[index].is_choice:
            kept &= scan.places[:, index] == there[len(there) // 2]
    return kept


def held(scan):
    """(axis, its middle value) of the axes that at_middle holds."""
    for index in range(3, len(scan.axes)):
        there = np.unique(scan.places[:, index])
        if scan.design == "grid" or scan.axes[index].is_choice:
            yield scan.axes[index], float(scan.axes[index].back(there[len(there) // 2]))


# The parts of the report that tell of a scan.

PAGE = "scan.html"


def scan_headline(run):
    """One sentence under the title."""
    scan = run.scan
    text = (f"{count(len(scan.failed))} points over {axes_html(scan)}, {outcomes_html(scan)}."
            f"{failures_html(scan)} <code>{PAGE}</code> next to this page shows every point.")
    return f'<p class="outcome"><span class="tag">scan</span>{text}</p>'


def point_rows(scan):
    """Rows (what, value) of how the points were chosen and what became of them."""
    record = scan.record
    yield "Design", design_html(scan)
    adaptive = scan.design == "adaptive"
    asked = "Points of a full grid" if adaptive else "Requested runs" if scan.of_beds else "Requested points"
    for key, name in (("requested", asked), ("evaluated", "Evaluated"),
                      ("failed", "Failed"), ("left", "Not evaluated yet")):
        if words.is_number(record.get(key)) and (record[key] or key in ("requested", "evaluated")):
            yield name, count(record[key])
    total = record.get("evaluated") if scan.of_beds else len(scan.outcome)
    for cause, number in (record.get("causes") or {}).items():
        yield f"Failed: {words.escape(cause)}", words.number(number)
    for index, name in enumerate(OUTCOMES):
        number = scan.runs_that_end(name) if scan.of_beds else int((scan.outcome == index).sum())
        if number:
            share = "" if adaptive else f" ({percent(number / total)})"  # points crowd at boundaries
            yield f"Outcome {name}", count(number) + share
    missed = missed_html(scan).strip().rstrip(".")
    if missed:
        yield missed.split(": ")[0], missed.split(": ", 1)[1]
    known = certificates_html(scan).strip().rstrip(".")
    if known:
        yield known.split(": ")[0], known.split(": ", 1)[1]
    boundary = record.get("boundary")
    if isinstance(boundary, dict):
        yield "Traced boundary", (f"{words.number(boundary.get('curves'))} curves of {words.number(boundary.get('points'))} points, "
                                  f"good to {words.number(boundary.get('tolerance'))} of an axis")
    if scan.samples:
        yield "Stored trajectories", count(len(scan.samples.point))
    if words.is_number(record.get("wall_seconds")):
        yield "Time", f"{words.number(float(record['wall_seconds']))} s"


def axis_rows(scan):
    """Rows (key, symbol, range, spacing)."""
    for axis in scan.axes:
        keys = "<br>".join(f"<code>{words.escape(key)}</code>" + ("" if factor == 1.0 else f" × {words.number(float(factor))}")
                           for key, factor in zip(axis.keys, axis.factors))
        if axis.is_choice:
            yield keys, axis.name_html, ", ".join(map(words.escape, axis.values)), "choice"
        else:
            ends = f"{words.number(axis.low * axis.factor, 6)} to {words.number(axis.high * axis.factor, 6)} {axis.unit_html}".rstrip()
            yield keys, axis.name_html, ends, "logarithmic" if axis.scale == "log" else "linear"
