"""Two rods of the theory: who is captured, and who notices."""

from . import judge, results
from .entry import Row, Run, Subject

ATTRACTION = Run("attraction", "attraction.toml")
PURSUIT = Run("nonreciptheory", "nonreciptheory.toml")
POLAR, APOLAR = Run("pletraj_a", "pletraj_a.toml"), Run("pletraj_b", "pletraj_b.toml")
BY_KAPPA, BY_GAMMA = Run("capture_kappa", "capture_kappa.toml"), Run("capture_gamma", "capture_gamma.toml")
BOTH = Run("capture_gamma_negative", "capture_gamma.toml", ("coupling.kappa=-100",))
MEMORY = ("medium.field=dynamic", "rods_run.contact_distance=1")
STEADY = (*MEMORY, "medium.dynamic.closure=steady")  # the same box and forces, wakes as the paper has them
LARGE = ("medium.dynamic.box=120", "medium.dynamic.modes=288", "rods_run.output_interval=0.25")  # trails of alpha = 10 go far
ATTRACTION_MEMORY, ATTRACTION_STEADY = Run("attraction_memory", "attraction.toml", MEMORY), Run("attraction_steady", "attraction.toml", STEADY)
PURSUIT_MEMORY = Run("pursuit_memory", "nonreciptheory.toml", MEMORY + LARGE)
PURSUIT_STEADY = Run("pursuit_steady", "nonreciptheory.toml", STEADY + LARGE)
CLOSURE_ERROR = 0.05  # of a contact time, or of a turn in radians: what counts as no difference
CAPTURED = ("contact", "pursuit")
FIGURE_START = 1.0  # dx of pletraj_a.toml and pletraj_b.toml


def meets(folder):
    record = results.read_json(folder, "outcome")
    return judge.holds(record["outcome"] == "contact", f"{record['outcome']} at t = {record['time']:.2f} f/(μ v₀)")


def front_rests(folder):
    record = results.read_json(folder, "outcome")
    front, rear = sorted(map(abs, record["turn"]))
    return judge.holds(record["outcome"] in CAPTURED and front < 1e-3 * rear,
                       f"{record['outcome']}; the front rod turns by {front:.1e} rad, the rear one by {rear:.2f} rad")


def closure_holds(memory, steady):
    """The same ending, and the same time of contact, or the same turns, but for CLOSURE_ERROR."""
    one, other = (results.read_json(folder, "outcome") for folder in (memory, steady))
    ours = "; ".join(f"{name}: {record['outcome']} at t = {record['time']:.2f} f/(μ v₀)" for name, record in (("dynamic medium", one), ("steady", other)))
    if one["outcome"] != other["outcome"]:
        return judge.holds(False, ours, "the endings differ")
    if one["outcome"] == "contact":
        off, what = abs(other["time"] / one["time"] - 1), "of the time"
    else:
        off, what = max(abs(a - b) for a, b in zip(one["turn"], other["turn"])), "rad of turn"
    return judge.holds(off <= CLOSURE_ERROR, ours, f"{off:.2g} {what} (criterion: at most {CLOSURE_ERROR:g})")


def captures(row):
    """Whether a point of a scan ends in capture; None if it could not be integrated."""
    return row["outcome"] in CAPTURED if row["status"] == "ok" else None


def encounters(folder, wanted, key="coupling.kappa"):
    """(value of key, start, whether captured) of the points of a scan that are wanted."""
    return [(float(row[key]), float(row["rods.1.position.0"]), captures(row)) for row in results.table(folder / "scan.csv") if wanted(row)]


def kappa(low, high):
    return lambda row: low <= float(row["coupling.kappa"]) <= high


def every(found, expected, name=lambda other: ""):
    """The verdict on "all starts do as expected"; `name` tells of those that do not. One that could not be integrated leaves it open."""
    if not found:
        return judge.unknown("no such starts")
    other, failed = ([start for start in found if start[2] is ends] for ends in (not expected, None))
    ours = f"{len(found) - len(other) - len(failed)} of {len(found)} starts {'captured' if expected else 'not captured'}"
    if failed:
        ours += f", {len(failed)} could not be integrated"
    if failed and not other:
        return judge.unknown("not all could be integrated", ours)
    return judge.holds(not other, ours, name(other) if other else "")


def all_captured(folder):
    return every(encounters(folder, kappa(100, 100)), True)


def always_captured(folder):
    return every(encounters(folder, kappa(0.1, 1e3)), True,
                 lambda other: "escapes at κ = " + ", ".join(f"{value:g}" for value in sorted({value for value, *_ in other})))


def negative_free(folder):
    return every(encounters(folder, kappa(-100, -100)), False, lambda other: "contact at dx = " + ", ".join(f"{dx:g}" for _, dx, _ in other))


def figure_b(_, scan):
    found = {value: captured for value, dx, captured in encounters(scan, kappa(-100, 100)) if dx == FIGURE_START and abs(value) == 100}
    if len(found) < 2 or None in found.values():
        return judge.unknown("no such starts, or they could not be integrated")
    return judge.holds(found == {100.0: True, -100.0: False}, f"from dx = 1: κ = 100 {'is' if found[100.0] else 'is not'} captured, "
                       f"κ = -100 {'is' if found[-100.0] else 'is not'}")


def figure_a(_, scan):
    here = encounters(scan, lambda row: float(row["rods.1.position.0"]) == FIGURE_START, "coupling.gamma1")
    return every(here, False)


def gamma_free(folder):
    found = [(row["coupling.gamma1"], row["coupling.gamma2"], captures(row)) for row in results.table(folder / "scan.csv")]
    return every(found, False, lambda other: "captured at (γ₁, γ₂) = " + "; ".join(f"({one}, {two})" for one, two in sorted({start[:2] for start in other})))


CLOSURE = "time derivative and θ' left out: wakes are steady and turn with their rods at once; "
NEAR_CROSSING = "For other starts than the paper's: rods that would nearly meet on straight paths (dx = 5) meet, whatever the coupling."
PAIRS = Subject("Theory: two rods", (
    Row("attraction_b", "Fig. 9 (b)", "side by side 5 f/μ apart, κf/(μv₀) = 0.5, η = α = 1: they come together", meets,
        (ATTRACTION,), ("attraction_b",)),
    Row("nonrecip_a", "Fig. 12 (a)", "κf/(μv₀) = 100: the rear rod turns and captures, the front one moves oblivious",
        front_rests, (PURSUIT,), ("nonreciptheory_a",)),
    Row("closure_attraction", "Eq. (16)", CLOSURE + "κf/(μv₀) = 0.5, α = 1, side by side", closure_holds, (ATTRACTION_MEMORY, ATTRACTION_STEADY)),
    Row("closure_pursuit", "Eq. (16)", CLOSURE + "κf/(μv₀) = 100, α = 10, perpendicular", closure_holds, (PURSUIT_MEMORY, PURSUIT_STEADY), (),
        "The wake that the rear rod left before it turned stays, and turns the front rod, which steady wakes leave alone."),
    Row("kappa_100", "text at Fig. 12", "perpendicular starts at κf/(μv₀) = 100 are always captured (η = 1, α = 10)", all_captured,
        (BY_KAPPA,)),
    Row("kappa_positive", "text at Fig. 12", "γ = 0 and κ > 0 always leads to capture (here η = 1, α = 10)", always_captured, (BY_KAPPA,),
        ("phase_diagram",), "Weak coupling turns the rear rod too slowly: the rods pass each other. Of the couplings tried only "
        "κ = 100 and 300 capture every start."),
    Row("pletraj_a", "Fig. 11 (a)", "κ = 0, γ₁, γ₂ = ±10 v₀, α = 10: no capture", figure_a, (POLAR, BY_GAMMA), ("pletraj_a",)),
    Row("gamma_all", "text at Fig. 11", "κ = 0, γ₁, γ₂ = ±10 v₀: in all cases capture does not take place", gamma_free, (BY_GAMMA,),
        ("phase_diagram",), NEAR_CROSSING + " (10, -10) captures over a wider range of starts."),
    Row("gamma_kappa", "text at Fig. 11", "γ₁, γ₂ = ±10 v₀ and κ < 0 (here -100): no capture", gamma_free, (BOTH,), ("phase_diagram",),
        NEAR_CROSSING),
    Row("pletraj_b", "Fig. 11 (b)", "κf/(μv₀) = 100 captures, -100 does not (α = 10, η = 1)", figure_b, (APOLAR, BY_KAPPA), ("pletraj_b",)),
    Row("kappa_negative", "text at Fig. 11", "κf/(μv₀) = -100: no capture", negative_free, (BY_KAPPA,), (), NEAR_CROSSING),
))
