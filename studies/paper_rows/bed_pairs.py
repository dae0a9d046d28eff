"""Two rods in the bed: avoidance, attraction, pursuit; and the paper's films."""

from math import nan, sqrt

from . import dish, judge, mechanism, results
from .bed import FLOW, drags, leaves
from .entry import Row, Run, Subject

CRYSTAL = Run("pair_crystal", "pair_crystal.toml", (), ("granular.runs=16",))
FLUID = Run("pair_fluid", "pair_fluid.toml", (), ("granular.runs=16",))
DENSITY = Run("pair_density", "pair_density.toml", (), ("scan.axes.0.from=0.70", "scan.axes.0.to=0.78", "scan.axes.0.count=2", "granular.runs=6"))
APOLAR = Run("apolar", "apolar_pair.toml", (), ("granular.runs=6",))
PURSUIT = Run("pursuit", "pursuit_bed.toml", (), ("granular.runs=6",))
PURSUIT_26 = Run("pursuit_26", "pursuit_bed.toml", ('granular.rods.1.position=["25 a", "34 a"]',), None)
NEAR = Run("pursuit_near", "pursuit_near.toml", quick=None)
UNSTRAINED, UNSTRAINED_90 = (Run(f"pair_unstrained_{angle}", f"pair_unstrained_{angle}.toml", quick=None) for angle in (0, 90))
A = 4e-4       # m
TURNED = 1 / 3  # of the other rod's turn: the rod that turns less "goes straight"


def half_box(folder):
    """Change of the separation over half a box, a."""
    pair = results.read_json(folder, "summary")["pair"]
    return pair.get("half_box_separation_change", nan) / A, pair.get("half_box_separation_change_error", nan) / A


def changes(expected):
    return lambda folder: judge.sign(*half_box(folder), expected, "a")


def turns(folder):
    """How far each rod has turned by the end of each run, radians."""
    found = []
    for path in sorted(folder.glob("runs/*/tracks.csv")):
        row = results.table(path)[-1]
        found.append((abs(float(row["theta0"])), abs(float(row["theta1"]))))
    return found


def one_straight(folder):
    pairs = turns(folder)
    runs, many = len(pairs), sum(min(pair) < TURNED * max(pair) for pair in pairs)
    share = many / runs
    found = judge.at_least(share, sqrt(max(share * (1 - share), 1 / runs) / runs), 0.5)
    return judge.Judged(found.verdict, f"{many} of {runs} runs", found.difference)


def curve(folder, distance):
    """[(phi_b, Delta y, error)] of one distance at the start, a. The axis ties the rods' places to it, and its column holds it."""
    rows = results.table(folder / "scan.csv")
    return [(float(row["granular.phi_b"]), float(row["delta_y"]), float(row["delta_y_error"])) for row in rows
            if row["delta_y"] and abs(float(row["granular.rods.0.position.1"]) / A - distance) < 0.01]


def pooled(folder, wanted):
    found = [(value, error) for distance in (18, 24) for phi, value, error in curve(folder, distance) if wanted(phi)]
    return judge.weighted(*zip(*found)) if found else (nan, nan)


def avoid(folder):
    return judge.sign(*pooled(folder, lambda phi: phi < 0.735), +1, "a")


def attract(folder):
    return judge.sign(*pooled(folder, lambda phi: phi > 0.745), -1, "a")


def sign_change(folder):
    """Between the last density at which the rods part for sure and the next at which they come together for sure."""
    places = sorted({phi for phi, *_ in curve(folder, 18)})
    sure = {phi: value / error for phi in places for value, error in [pooled(folder, lambda one, at=phi: one == at)]}
    apart = [phi for phi in places if sure[phi] > judge.CONFIRMED]
    together = [phi for phi in places if sure[phi] < -judge.CONFIRMED and apart and phi > max(apart)]
    if not together:
        return judge.unknown("the errors leave it open: Δy over its error is " + ", ".join(f"{ratio:+.1f} at {phi:.2f}" for phi, ratio in sure.items()))
    return judge.bracket(max(apart), min(together), 0.735, 0.755)  # two printed digits


def weakens(folder):
    """|Delta y| at 0.80 against that at 0.78, at each distance by itself: pooled first, the one with the smaller errors would decide."""
    changes = []
    for distance in (18, 24):
        at = {round(phi, 2): (value, error) for phi, value, error in curve(folder, distance)}
        if {0.78, 0.80} <= at.keys():
            changes.append((at[0.80][0] - at[0.78][0], sqrt(at[0.80][1] ** 2 + at[0.78][1] ** 2)))
    return judge.sign(*(judge.weighted(*zip(*changes)) if changes else (nan, nan)), +1, "a")


def rests(place):
    """A pair that does not walk, against what the motile pair does."""
    def judged(folder, motile):
        pair = results.read_json(folder / place, "summary")["pair"]
        change, error = (pair.get(key, nan) / A for key in ("separation_change", "separation_change_error"))
        return judge.none(change, error, abs(half_box(motile)[0]) / 2, "a")
    return judged


in_liquid, in_crystal = rests("."), rests("variants/crystal")


def no_interaction(*folders):
    return judge.together(in_liquid(*folders), in_crystal(*folders))


def rear_turns(folder):
    pairs = results.read_json(folder, "measure")["pairs"]
    return judge.sign(*results.estimate(pairs["non_reciprocity"]), +1)


def captured(folder):
    pairs = results.read_json(folder, "measure")["pairs"]
    runs = sum(pairs[name] for name in ("contact", "pursuit", "escape", "undecided"))
    share = (pairs["contact"] + pairs["pursuit"]) / runs
    found = judge.at_least(share, sqrt(max(share * (1 - share), 1 / runs) / runs), 0.5)
    return judge.Judged(found.verdict, f"{runs} runs: contact {pairs['contact']}, pursuit {pairs['pursuit']}", "criterion: half and more of the runs")


SCATTER = "Single runs scatter widely."
GRAINS = "A random start gives a mosaic of grains, whose boundaries also turn rods."
ROWS = "In our crystal the rod that heads across the close-packed rows turns towards them: the lattice decides, not the other rod."
LAWS = "A lattice-anchoring term improves every description more than strain does; no model tested fits (docs/findings.md)."
PAIRS = Subject("The bed: two rods", (
    Row("trajectory_c", "Fig. 1 (c), Movie S2", "15 a apart at φ_b = 0.78: the rods come together", changes(-1), (CRYSTAL,), ("tracks",), SCATTER),
    Row("trajectory_c_fit", "Fig. 1 (c)", "the same in a box that does not strain the crystal, rows along the rods", changes(-1), (UNSTRAINED,),
        ("tracks",)),
    Row("trajectory_c_fit_90", "Fig. 1 (c)", "the same, rows across the rods", changes(-1), (UNSTRAINED_90,), ("tracks",)),
    Row("trajectory_d_inset", "Fig. 1 (d), inset, Movie S4", "at φ_b = 0.70 they part", changes(+1), (FLUID,), ("tracks",), SCATTER),
    Row("trajectory_d_fluid", "Fig. 1 (d)", "Δy > 0 for φ_b < 0.74 (d₀ = 18 a and 24 a, pooled)", avoid, (DENSITY,), ("delta_y",), SCATTER),
    Row("trajectory_d_crystal", "Fig. 1 (d)", "Δy < 0 for φ_b > 0.74 (d₀ = 18 a and 24 a, pooled)", attract, (DENSITY,), (), SCATTER),
    Row("trajectory_d_change", "Fig. 1 (d)", "the sign changes at φ_b = 0.74 to 0.75", sign_change, (DENSITY,), (), SCATTER),
    Row("trajectory_d_weak", "text at Fig. 1", "possible weakening of the attraction at φ_b = 0.80", weakens, (DENSITY,)),
    Row("trajectory_a", "Fig. 1 (a), Movie S1", "in experiment, 15 a apart at φ_b = 0.78: together (here 18 a apart, in a dish of that size)",
        dish.changes(0.78, -1, 18), why=GRAINS, made=dish.MADE),
    Row("trajectory_b_fluid", "Fig. 1 (b), Movie S3", "in experiment Δy > 0 at φ_b = 0.70 (18 a and 24 a, pooled; the dish)", dish.changes(0.70, +1, 18, 24),
        why=SCATTER, made=dish.MADE),
    Row("trajectory_b_crystal", "Fig. 1 (b)", "in experiment Δy < 0 at φ_b = 0.78 (18 a and 24 a, pooled; the dish)",
        dish.changes(0.78, -1, 18, 24), why=GRAINS, made=dish.MADE),
    Row("one_straight", "text at Fig. 1", "more often one goes straight and the other turns (turns by less than a third of the other)",
        one_straight, (CRYSTAL,), (), SCATTER),
    Row("strain_crystal", "Eq. (22)", "strain turns the other rod, φ_b = 0.78: no law without it describes tracks of pairs better (AIC)",
        mechanism.strain_turns(0.78), why=LAWS, made=mechanism.MADE),
    Row("strain_fluid", "Eq. (22)", "the same at φ_b = 0.70", mechanism.strain_turns(0.70), made=mechanism.MADE),
    Row("strain_sign", "Eq. (22)", "κ > 0 at φ_b = 0.78, fitted together with lattice anchoring (lattice rows along the rods; across)", mechanism.kappa(0.78),
        why="Strain is not in the model with the lowest AIC, and no model tested fits.", made=mechanism.MADE),
    Row("apolar_pair", "section IV, Movies S7, S8", "apolar rods neither attract nor repel, φ_b = 0.70, 0.80 (less than half of what motile rods do)", no_interaction,
        (APOLAR, CRYSTAL), ("tracks",), SCATTER),
    Row("nonrecip_b", "Fig. 12 (b), Movie S9", "φ_b = 0.78, 39.4 a apart: the rear rod turns, the front one does not", rear_turns, (PURSUIT,),
        ("nonreciptheory_b",), ROWS),
    Row("nonrecip_b_end", "Fig. 12 (b)", "and captures", captured, (PURSUIT,), (), ROWS),
    Row("nonrecip_c", "Fig. 12 (c)", "26 a apart (an experiment; here simulated): the rear rod turns", rear_turns, (PURSUIT_26,),
        ("nonreciptheory_b",), ROWS),
    Row("nonrecip_c_dish", "Fig. 12 (c), Movie S10", "in experiment, 26 a apart: the rear rod turns (the dish: by more than the other)",
        dish.rear_turns, why=GRAINS, made=dish.MADE),
    Row("nonrecip_c_end", "Fig. 12 (c)", "and captures (the dish: the rods meet, whichever turned)", dish.captured, why=GRAINS, made=dish.MADE),
    Row("nonrecip_c_fit", "Fig. 12 (c)", "the same in a box that does not strain the crystal", rear_turns, (NEAR,), ("tracks",), ROWS),
))

APOLAR_RODS = ("granular.rods.0.kind=apolar", "granular.rods.1.kind=apolar", "granular.duration=10 s")
FRAMES = "granular.output.frames=0.2 s"


def film(name, scene, *settings):
    return Run(f"film_{name}", scene, settings)


def beside_film(judged):
    """The verdict is that of the runs that the film shows one more of."""
    return lambda _, *folders: judged(*folders)


FILMS = Subject("The paper's films", (
    Row("S1", "Movie S1", "two rods 15 a apart at φ_b = 0.78, experiment: together (here 18 a, the dish)", dish.changes(0.78, -1, 18), why=GRAINS,
        made=dish.MADE, counted=False),
    Row("S2", "Movie S2", "two rods 15 a apart at φ_b = 0.78 come together", beside_film(changes(-1)), (film("S2", "pair_film.toml"), CRYSTAL), ("film",),
        SCATTER, counted=False),
    Row("S3", "Movie S3", "two rods at φ_b = 0.70, experiment: they part (the dish)", dish.changes(0.70, +1, 18, 24), why=SCATTER, made=dish.MADE, counted=False),
    Row("S4", "Movie S4", "two rods at φ_b = 0.70 part", beside_film(changes(+1)), (film("S4", "pair_film.toml", "granular.phi_b=0.70"), FLUID), ("film",),
        SCATTER, counted=False),
    Row("S5", "Movie S5", "a rod drags the beads around it at φ_b = 0.70", beside_film(drags),
        (film("S5", "rod_in_bed.toml", "granular.phi_b=0.70", FRAMES), FLOW), ("film",), counted=False),
    Row("S6", "Movie S6", "a rod leaves the beads around it undisturbed at φ_b = 0.80", beside_film(leaves),
        (film("S6", "rod_in_bed.toml", FRAMES), FLOW), ("film",), counted=False),
    Row("S7", "Movie S7", "apolar rods at φ_b = 0.70 neither attract nor repel", beside_film(in_liquid),
        (film("S7", "pair_film.toml", "granular.phi_b=0.70", *APOLAR_RODS), APOLAR, CRYSTAL), ("film",), SCATTER, counted=False),
    Row("S8", "Movie S8", "apolar rods at φ_b = 0.80 neither attract nor repel", beside_film(in_crystal),
        (film("S8", "pair_film.toml", "granular.phi_b=0.80", *APOLAR_RODS), APOLAR, CRYSTAL), ("film",), SCATTER, counted=False),
    Row("S9", "Movie S9", "perpendicular start at φ_b = 0.78: the rear rod turns, the front one does not", beside_film(rear_turns),
        (film("S9", "pursuit_film.toml"), PURSUIT), ("film",), ROWS, counted=False),
    Row("S10", "Movie S10", "perpendicular start in experiment, 26 a apart: the rear rod turns (the dish)", dish.rear_turns, why=GRAINS, made=dish.MADE, counted=False),
))
