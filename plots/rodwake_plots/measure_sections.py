"""The part of the report that tells what was measured: measure.json in words."""

from . import measured, words

# table, key, name, unit, factor, meaning
ESTIMATES = (
    ("order", "psi6", "<i>ψ</i><sub>6</sub>", "", 1.0, "global bond order"),
    ("order", "local_psi6", "|<i>ψ</i><sub>6,<i>i</i></sub>|", "", 1.0, "mean over beads of the local bond order"),
    ("order", "neighbours", "Neighbours", "", 1.0, "of a bead, mean"),
    ("order", "cutoff", "Cut-off", "<i>a</i>", 1.0, "beads nearer than this are neighbours"),
    ("order", "g_minimum", "First minimum of <i>g</i>(<i>r</i>)", "<i>a</i>", 1.0, ""),
    ("order", "exponent", "<i>η</i><sub>6</sub>", "", 1.0, "of <i>g<sub>B</sub></i> ∝ <i>r</i><sup>−<i>η</i><sub>6</sub></sup>, fitted"),
    ("order", "length", "<i>ξ</i><sub>6</sub>", "<i>a</i>", 1.0, "of <i>g<sub>B</sub></i> ∝ exp(−<i>r</i>/<i>ξ</i><sub>6</sub>), fitted"),
    ("microrheology", "stiffness", "Stiffness", "<i>a</i><sup>−2</sup>", 1.0, "1/(<i>s</i> Δ̃(<i>s</i>)) for <i>s</i> → 0"),
    ("microrheology", "spring", "Spring constant", "µN/m", 1e6, "of what holds a bead: 4<i>mT<sub>xy</sub></i> times the stiffness"),
    ("microrheology", "s_low", "Extrapolated from", "1/s", 1.0, "lowest <i>s</i> used"),
    ("microrheology", "s_high", "Extrapolated to", "1/s", 1.0, "highest <i>s</i> used"),
    ("microrheology", "temperature", "<i>T<sub>xy</sub></i>", "m²/s²", 1.0, "of the measured frames"),
    ("flow", "drag", "Beads dragged", "<i>a</i>", 1.0, "way of the marked beads along the rod's first heading"),
    ("flow", "drag_share", "Share dragged", "", 1.0, "the same over the rod's own way"),
    ("flow", "near_speed", "Speed near the rod", "<i>a</i>/s", 1.0, "mean of the beads' flow within 6 <i>a</i>"),
    ("displacement", "mean_speed", "Speed of the rod", "<i>a</i>/s", 1.0, "along its heading, while the displacement was measured"),
    ("displacement", "spacing", "Lattice spacing", "<i>a</i>", 1.0, "from the Bragg peaks"),
    ("displacement", "row_angle", "Angle of the rows", "rad", 1.0, "of the close-packed rows from <i>x</i>"),
    ("displacement", "contrast", "Bragg contrast", "", 1.0, "largest peak"),
    ("displacement", "block_correlation", "Correlation of blocks", "", 1.0, "of one block of time with the next; the errors allow for it"),
    ("displacement", "blocks", "Blocks", "", 1.0, "of time, for the errors"),
    ("displacement", "frames", "Frames", "", 1.0, "measured for the displacement"),
    ("pairs", "half_box_change", "Δ<i>y</i>", "<i>a</i>", 1.0, "change of the separation while the pair goes half the box"),
    ("pairs", "not_there", "Runs short of half the box", "", 1.0, "left out of Δ<i>y</i>"),
    ("pairs", "non_reciprocity", "Non-reciprocity", "", 1.0, "1: the rear rod alone turns, −1: the front rod alone"),
    ("pairs", "turn_rear", "Turn of the rear rod", "rad", 1.0, "towards the other's first place"),
    ("pairs", "turn_front", "Turn of the front rod", "rad", 1.0, "towards the other's first place"),
    ("pairs", "contact", "Contact", "runs", 1.0, "how runs ended"),
    ("pairs", "pursuit", "Pursuit", "runs", 1.0, "how runs ended"),
    ("pairs", "escape", "Escape", "runs", 1.0, "how runs ended"),
    ("force", "force", "Force", "µN", 1e6, "of the rod on the beads, along its heading"),
    ("force", "speed", "Speed", "mm/s", 1e3, "of the rod along its heading"),
)
TEXTS = (("order", "phase", "Phase", "of the beads, by the decay of <i>g<sub>B</sub></i>"),
         ("displacement", "method", "Estimator", "of the displacement"))


def heads_and_rows(run):
    """The parts side by side; nothing where nothing was measured."""
    parts = [part for part in measured.parts(run) if part.has(measured.RESULTS)]
    if not parts:
        return (), []
    names = [words.label_html(part.label) for part in parts] if len(parts) > 1 else ["Value"]
    rows = [*(text_row(parts, *told) for told in TEXTS), *(number_row(parts, *told) for told in ESTIMATES)]
    return ("Quantity", *names, "Meaning"), [row for row in rows if row]


def text_row(parts, table, key, name, meaning):
    values = [part.told(table, key) for part in parts]
    if key == "phase" and len(parts) == 1:
        meaning = words.escape(parts[0].told("order", "reason") or "") or meaning
    return (name, *("" if value is None else words.escape(value) for value in values), meaning) if any(values) else None


def number_row(parts, table, key, name, unit, factor, meaning):
    cells = [cell(part, table, key, unit, factor) for part in parts]
    return (name, *cells, meaning) if any(cells) else None


def cell(part, table, key, unit, factor):
    found = part.told(table, key)
    if found is None:
        return ""
    if not isinstance(found, dict):
        value = part.number(table, key)
        return f"{words.number(value * factor if isinstance(value, float) else value)} {unit}".strip()
    estimate = part.estimate(table, key)
    if estimate is None:
        return ""
    text = words.with_error(estimate.value, estimate.error, factor)
    text = f"({text})" if unit and "±" in text and not text.startswith("(") else text
    return f"{text} {unit}".strip()
