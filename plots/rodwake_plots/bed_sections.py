"""The parts of the report that tell of the granular bed."""

import math

from . import bed_run, fit_words, schema, words

PAIRS = (("bead_bead", "bead with bead", "particle_particle"), ("bead_rod", "bead with rod", "particle_particle"),
         ("rod_rod", "rod with rod", "particle_particle"), ("bead_wall", "bead with plate", None), ("rod_wall", "rod with plate", None))
ROUNDING = 1e-9  # degrees
SHOWN = {"simulated_time", "T_xy", "T_z", "max_overlap", "psi6", "pressure", "rods", "beads", "phi_b", "beads_fraction", "bead_radius", "box", "container", "runs"}


def bed_headline(run):
    """One sentence under the title."""
    bed = run.granular
    runs = f"{len(bed.members)} runs of " if not bed.single else ""
    time = bed.summary.get("simulated_time")
    lasting = f" over {words.number(time, 4)} s" if words.is_number(time) else ""
    rods = f"{words.number(len(bed.rods))} rod{'s' if len(bed.rods) != 1 else ''} without beads{lasting}"
    text = f"{runs}{words.number(bed.need('beads'))} beads at {words.equation('<i>φ<sub>b</sub></i>', bed.phi_b, digits=3)}{lasting}"
    text = text if bed.need("beads") else runs + rods
    speeds = [rod.get("mean_speed") for rod in bed.rods]
    if speeds and all(map(words.is_number, speeds)):
        numbers = ", ".join(words.number(speed * 1e3, 3) for speed in speeds)
        text += f"; mean speed of the rod{'s' if len(speeds) > 1 else ''} {numbers} mm/s, positive thin end first"
    return f'{absorbing(bed.summary)}<p class="outcome"><span class="tag">granular</span>{text}.</p>'


def absorbing(summary):
    """Of a bed that has stopped: before all else, for no number that follows is one of a bed that moves."""
    still, runs = int(summary.get("absorbing_runs", summary.get("absorbing_state")) or 0), summary.get("finished_runs", 1)
    return ('<p class="verdict"><strong>The bed does not move:</strong> '
            f"{words.number(still)} of {words.number(runs)} runs ended in an absorbing state, in which the beads bounce in step with the plates "
            "and meet no other. No number below is a property of a bed, and it has no phase.</p>") if still else ""


def tracks_headline(run):
    """The same of what a camera saw, with what was left out."""
    tracks = run.tracks
    text = (f"{words.number(tracks['frames'])} frames of {words.number(tracks['beads_per_frame'], 4)} beads, "
            f"{words.number(tracks['particles'])} tracks of {words.number(tracks['mean_length'], 4)} frames on average, "
            f"{words.number(100 * tracks['lost_share'], 2)} % lost; {words.equation('<i>φ<sub>b</sub></i>', tracks['phi_b'], digits=3)}")
    rods = tracks.get("rods", 0)
    text += f"; {words.number(rods)} rod{'s' if rods > 1 else ''}" if rods else ""
    text += "".join(f"; {words.number(one['rows'])} {words.escape(one['why'])}" for one in tracks["left_out"])
    return f'<p class="outcome"><span class="tag">tracks</span>{text}.</p>'


def modelled_rows(run):
    """Rows (what, value) of what was simulated, from the resolved scene and the summary."""
    bed, scene = run.granular, run.scene.get("granular", {})
    sides = " × ".join(words.number(float(side / bed.a), 4) for side in bed.sides)
    if bed.need("beads"):
        yield from beads_rows(bed, scene)
    dish = f"a dish of diameter {words.number(float(bed.sides[0] / bed.a), 4)} <i>a</i> with a vertical wall"
    yield ("Container", dish if bed.container == "circle" else f"{sides} <i>a</i>, with a vertical wall") if bed.container else (
        "Box", f"{sides} <i>a</i>, periodic in <i>x</i> and <i>y</i>")
    if isinstance(scene.get("plates"), dict):
        yield "Plates", describe_plates({"gap": bed.summary.get("gap", 0.0), **scene["plates"]}, scene.get("gravity", 0.0))
    yield from ((f"Rod {number}", describe_rod(rod)) for number, rod in enumerate(scene.get("rods", [])))


def beads_rows(bed, scene):
    yield "Beads", (f"{words.number(bed.need('beads'))} spheres, {words.equation('<i>a</i>', bed.a * 1e3, 'mm')}"
                    f"{of_density(scene.get('bead_density'))}")
    alone = bed.summary.get("beads_fraction")
    yield "Requested area fraction", words.equation("<i>φ<sub>b</sub></i>", bed.phi_b) + (
        f"; the beads alone cover {words.number(alone)} of the {'container' if bed.container else 'box'}" if words.is_number(alone) else "")


def of_density(value):
    return f", {words.number(value)} kg/m³" if words.is_number(value) else ""


def describe_plates(values, gravity):
    gap, frequency, gamma = (values.get(key, 0.0) for key in ("gap", "frequency", "gamma"))
    text = f"{words.equation('<i>w</i>', gap * 1e3, 'mm')} apart"
    if not (gamma and frequency):
        return text + ", static"
    moving = f"{text}, moving together with {words.equation('<i>f</i>', frequency, 'Hz')}"
    moving += f", {words.equation('<i>Γ</i>', gamma)}"
    if not gravity:
        return moving
    return f"{moving}, {words.equation('<i>A</i>', gamma * gravity / (2 * math.pi * frequency) ** 2 * 1e6, 'µm')}"


def describe_rod(rod):
    kind = words.escape(rod.get("kind", "motile"))
    where = ", ".join(words.number(float(part) * 1e3, 4) for part in rod["position"]) if "position" in rod else ""
    text = f"{kind}, starts at ({where}) mm" if where else kind
    if words.is_number(rod.get("heading")):
        text += f" heading {words.number(math.degrees(rod['heading']), 4)}°"
    speed = rod.get("imposed_speed")
    return text + (f", held at {words.number(speed * 1e3)} mm/s" if words.is_number(speed) else "")


def contact_rows(run):
    """Rows (pair, friction, restitution)."""
    given = run.scene.get("granular", {}).get("contacts", {})
    for key, name, common in PAIRS:
        both = {**(given.get(common) or {}), **(given.get(key) or {})}
        if both:
            yield name, words.number(both.get("friction", "–")), words.number(both.get("restitution", "–"))


def summary_rows(run):
    """Rows (quantity, value, meaning) of summary.json."""
    summary = run.granular.summary
    known = (("simulated_time", "Simulated time", "s", "from <i>t</i> = 0 on"),
             ("T_xy", "<i>T</i><sub>xy</sub>", "m²/s²", "(var <i>v<sub>x</sub></i> + var <i>v<sub>y</sub></i>)/2, centre of mass removed"),
             ("T_z", "<i>T</i><sub>z</sub>", "m²/s²", "var <i>v<sub>z</sub></i>, centre of mass removed"),
             ("psi6", "<i>ψ</i><sub>6</sub>, rows of table.csv", "", f"|⟨<i>ψ</i><sub>6,<i>i</i></sub>⟩| over the beads; neighbours nearer than {cutoff(run)}"),
             ("max_overlap", "Largest overlap", "", "of the smaller radius"))
    part = bed_run.parts_of(run)[0]
    for key, name, unit, meaning in known:
        if key == "psi6" and part.has(bed_run.RESULTS) and part.value("order", "psi6"):
            continue  # the report has it among the measures, over more frames and with the cut-off of g(r)
        if words.is_number(summary.get(key)) and (key == "simulated_time" or run.granular.need("beads")):
            yield name, f"{words.number(summary[key])} {unit}".strip(), meaning
    pressure = (summary.get("pressure") or {}).get("mean")
    if words.is_number(pressure):
        yield "Pressure", f"{words.number(pressure * 1e3)} mN/m", "in the plane, momentum that crosses a line per time and length"
    for number, rod in enumerate(run.granular.rods):
        yield from rod_measured(number, rod)


def cutoff(run):
    """granular.order_cutoff, whose default follows from phi_b."""
    asked = run.scene.get("granular", {}).get("order_cutoff")
    return f"{words.number(asked / run.granular.a)} <i>a</i>" if words.is_number(asked) else "1.4 lattice spacings"


def rod_measured(number, rod):
    kind = words.escape(rod.get("kind", ""))
    if words.is_number(rod.get("mean_speed")):
        yield f"Rod {number}, mean speed", f"{words.number(rod['mean_speed'] * 1e3)} mm/s", f"{kind}; positive thin end first"
    if words.is_number(rod.get("net_turn")):
        turn = math.degrees(rod["net_turn"])
        yield f"Rod {number}, net turn", f"{words.number(turn if abs(turn) > ROUNDING else 0)}°", f"{kind}; counter-clockwise"


def other_summary(run):
    """What else the summary holds: cost, hash and the like."""
    return {key: value for key, value in run.granular.summary.items() if key not in SHOWN}


# The part of the report that tells what was measured: measure.json in words.

MEASURED_TITLED = [entry for entry in schema.MEASURED if "title" in entry]
MEASURED_NUMBERS = [entry for entry in MEASURED_TITLED if "factor" in entry]
MEASURED_TEXTS = [entry for entry in MEASURED_TITLED if "factor" not in entry]


def measures_table(run):
    """The parts side by side; nothing where nothing was measured."""
    parts = [part for part in bed_run.parts_of(run) if part.has(bed_run.RESULTS)]
    if not parts:
        return (), []
    names = [words.label_html(part.label) for part in parts] if len(parts) > 1 else ["Value"]
    rows = [*(text_row(parts, entry) for entry in MEASURED_TEXTS), *(number_row(parts, entry) for entry in MEASURED_NUMBERS)]
    return ("Quantity", *names, "Meaning"), [row for row in rows if row]


def text_row(parts, entry):
    values = [part.value(entry["measure"], entry["key"]) for part in parts]
    meaning = words.text_html(entry["meaning"])
    if entry["key"] == "phase" and len(parts) == 1:
        meaning = words.escape(parts[0].value("order", "reason") or "") or meaning
    cells = ["" if value is None else words.escape(value) for value in values]
    return (words.text_html(entry["title"]), *cells, meaning) if any(values) else None


def number_row(parts, entry):
    cells = [measure_cell(part, entry) for part in parts]
    return (words.text_html(entry["title"]), *cells, words.text_html(entry["meaning"])) if any(cells) else None


def measure_cell(part, entry):
    """Speeds are in mm/s all over the report, whatever the file has."""
    table, key, factor, unit = entry["measure"], entry["key"], entry["factor"], fit_words.unit_html(entry["unit"])
    found = part.value(table, key)
    if found is None:
        return ""
    if entry["unit"] == "a/s":
        factor, unit = 1e3 * part.a, "mm/s"
    if not isinstance(found, dict):
        value = part.number(table, key)
        return f"{words.number(value * factor if isinstance(value, float) else value)} {unit}".strip()
    estimate = part.estimate(table, key)
    if estimate is None:
        return ""
    text = words.with_error(estimate.value, estimate.error, factor)
    text = f"({text})" if unit and "±" in text and not text.startswith("(") else text
    return f"{text} {unit}".strip()
