"""The parts of the report that tell of a scan."""

from . import scan_words, words
from .scan_run import OUTCOMES

PAGE = "scan.html"


def headline(run):
    """One sentence under the title."""
    scan = run.scan
    text = (f"{scan_words.count(len(scan.failed))} points over {scan_words.axes_html(scan)}, {scan_words.outcomes_html(scan)}."
            f"{scan_words.failures_html(scan)} <code>{PAGE}</code> beside this page shows every point.")
    return f'<p class="outcome"><span class="tag">scan</span>{text}</p>'


def points(scan):
    """Rows (what, value) of how the points were chosen and what became of them."""
    told = scan.told
    yield "Design", scan_words.design_html(scan)
    adaptive = scan.design == "adaptive"
    asked = "Points of a full grid" if adaptive else "Runs asked for" if scan.of_beds else "Points asked for"
    for key, name in (("requested", asked), ("evaluated", "Evaluated"),
                      ("failed", "Failed"), ("left", "Not evaluated yet")):
        if words.is_number(told.get(key)) and (told[key] or key in ("requested", "evaluated")):
            yield name, scan_words.count(told[key])
    total = told.get("evaluated") if scan.of_beds else len(scan.outcome)
    for cause, number in (told.get("causes") or {}).items():
        yield f"Failed: {words.escape(cause)}", words.number(number)
    for index, name in enumerate(OUTCOMES):
        number = scan.runs_that_end(name) if scan.of_beds else int((scan.outcome == index).sum())
        if number:
            share = "" if adaptive else f" ({scan_words.percent(number / total)})"  # points crowd at boundaries
            yield f"Outcome {name}", scan_words.count(number) + share
    missed = scan_words.missed_html(scan).strip().rstrip(".")
    if missed:
        yield missed.split(": ")[0], missed.split(": ", 1)[1]
    boundary = told.get("boundary")
    if isinstance(boundary, dict):
        yield "Traced boundary", (f"{words.number(boundary.get('curves'))} curves of {words.number(boundary.get('points'))} points, "
                                  f"good to {words.number(boundary.get('tolerance'))} of an axis")
    if scan.samples:
        yield "Stored trajectories", scan_words.count(len(scan.samples.point))
    if words.is_number(told.get("wall_seconds")):
        yield "Time", f"{words.number(float(told['wall_seconds']))} s"


def axes(scan):
    """Rows (key, symbol, range, spacing)."""
    for axis in scan.axes:
        keys = "<br>".join(f"<code>{words.escape(key)}</code>" + ("" if factor == 1.0 else f" × {words.number(float(factor))}")
                           for key, factor in zip(axis.keys, axis.factors))
        if axis.is_choice:
            yield keys, axis.name_html, ", ".join(map(words.escape, axis.values)), "choice"
        else:
            ends = f"{words.number(axis.low * axis.factor, 6)} to {words.number(axis.high * axis.factor, 6)} {axis.unit_html}".rstrip()
            yield keys, axis.name_html, ends, "logarithmic" if axis.scale == "log" else "linear"
