"""The vibrated bed: the apparatus, order and stiffness of the beads, flow and force around a rod."""

import tomllib
from math import hypot, nan

import h5py
import numpy as np

from . import dish, judge, results
from .entry import Row, Run, Subject

LONE = Run("lone", "lone_rod.toml", ("granular.runs=16",), ("granular.runs=4",))
LONE_APOLAR = Run("lone_apolar", "lone_rod.toml", ("granular.rods.0.kind=apolar", "granular.runs=64"), ("granular.runs=16",))
ORDER = Run("order", "order.toml", (), ("granular.runs=2", "granular.equilibrate=6 s", "granular.duration=6 s"))
FLOW = Run("flow", "bead_drag.toml", (), ("granular.runs=4",))
FORCE = Run("force", "force.toml", (), ("granular.runs=2", "granular.duration=10 s"))
A = 0.4            # mm
EXTINGUISHED = 0.25  # of what is there in the liquid


APPARATUS = {"bead_radius": 4e-4, "box": 78 * 4e-4, "plates.gap": 1.2e-3, "plates.frequency": 200.0, "plates.gamma": 7.0,
             "contacts.particle_particle.friction": 0.05, "contacts.particle_particle.restitution": 0.3,
             "contacts.rod_wall.friction": 0.03, "contacts.rod_wall.restitution": 0.1,
             "contacts.bead_wall.friction": 0.2, "contacts.bead_wall.restitution": 0.3,
             "rods.0.length": 4.5e-3, "rods.0.thin_diameter": 0.8e-3}  # of section II, SI


def apparatus(folder):
    scene = tomllib.loads((folder / "scene.toml").read_text(encoding="utf-8"))["granular"]
    other = []
    for name, paper in APPARATUS.items():
        value = scene
        for key in name.split("."):
            value = value[int(key) if key.isdigit() else key]
        other += [] if abs(value - paper) < 1e-9 * paper else [f"{name} = {value}"]
    return judge.holds(not other, "; ".join(other) or f"{len(APPARATUS)} keys as in the paper")


def speed(folder):
    """mm/s, + thin end first."""
    rod = results.read_json(folder, "summary")["rods"][0]
    return 1e3 * rod["mean_speed"], 1e3 * rod.get("mean_speed_error", nan)


def walks(folder):
    return judge.sign(*speed(folder), +1, "mm/s")


def alone(folder):
    """Runs of a lone rod end on one limit cycle, so their scatter says nothing of what the first 0.2 s take from the mean (0.18 % in 10 s)."""
    value, scatter = speed(folder)
    return judge.Judged(walks(folder).verdict, f"{value:.3f} mm/s (mean over 10 s from the start; all runs end on one limit cycle and differ by {scatter:.0e} mm/s)")


def stays(folder, motile):
    return judge.none(*speed(folder), 0.1 * speed(motile)[0], "mm/s")


def walks_in_crystal(folder):
    return judge.sign(*speed(folder / "variants/crystal"), +1, "mm/s")


def by_density(folder):
    return {round(float(row["phi_b"]), 3): results.read_json(place, "measure") for row, place in results.cases(folder)}


def crossing(values, level):
    """The two densities between which a rising quantity passes a level."""
    places = sorted(values)
    for low, high in zip(places, places[1:]):
        if values[low] < level <= values[high]:
            return low, high
    return nan, nan


def order_onset(folder):
    psi6 = {phi: record["order"]["psi6"]["value"] for phi, record in by_density(folder).items()}
    return judge.bracket(*crossing(psi6, 0.3), 0.71, 0.73)


def order_saturates(folder):
    beds = by_density(folder)
    (high, high_error), (low, low_error) = (results.estimate(beds[phi]["order"]["psi6"]) for phi in (0.80, 0.78))
    return judge.at_most(high - low, hypot(high_error, low_error), 0.05)


CLASSES = ("exponential", "algebraic", "long-range")


def class_change(upper, paper):
    """Between the last density below the class and the first of it; where the classes alternate, these two are in the other order.

    The paper's density is compared as printed. It gives no grid of densities, so its own uncertainty is unknown."""
    def judged(folder):
        rank = {phi: CLASSES.index(record["order"]["class"]) for phi, record in by_density(folder).items() if record["order"]["class"] in CLASSES}
        below, above = ([phi for phi, k in rank.items() if (k >= upper) == wanted] for wanted in (False, True))
        if not below or not above:
            return judge.unknown("one class only")
        low, high = sorted((max(below), min(above)))
        found, off = judge.bracket(low, high, paper - 0.005, paper + 0.005), (low + high) / 2 - paper
        return judge.Judged(found.verdict, found.ours, f"{off:+.3f}; our densities are {high - low:.2g} apart")
    return judged


def stiffness(record):
    found = record["microrheology"]
    scatter, bend = (found.get(key) for key in ("scatter", "bend"))
    return found["stiffness"]["value"], nan if scatter is None or bend is None else hypot(scatter, bend)


def soft_below(folder):
    beds = by_density(folder)
    return judge.none(*stiffness(beds[0.66]), 0.1 * stiffness(beds[0.78])[0], "1/a²")


def stiff_above(folder):
    found = stiffness(by_density(folder)[0.78])
    return judge.sign(*found, +1, "1/a²")


def flow_far(folder):
    """Velocity of the beads 10 to 22 a behind and ahead of the rod, along its heading, a/s."""
    with h5py.File(folder / "measure.h5") as file:
        x, y, v, sigma = (file[f"flow/{name}"][...] for name in ("x", "y", "vx", "sigma_x"))
    means = []
    for low, high in ((-22, -10), (10, 22)):
        strip = np.ix_(np.abs(y) < 3.1, (x >= low) & (x <= high))
        weights = 1.0 / np.maximum(sigma[strip], 1e-9) ** 2
        means.append((np.sum(weights * v[strip]) / np.sum(weights), np.sum(weights) ** -0.5))
    return means


def flows(folder):
    return judge.together(*(judge.sign(*mean, +1, "a/s") for mean in flow_far(folder)))


def flow_dies(folder):
    liquid = max(value for value, _ in flow_far(folder))
    return judge.together(*(judge.none(*mean, EXTINGUISHED * liquid, "a/s") for mean in flow_far(folder / "variants/crystal")))


def drag(folder):
    return results.estimate(results.read_json(folder, "measure")["flow"]["drag"])


def drags(folder):
    return judge.sign(*drag(folder), +1, "a")


def leaves(folder):
    return judge.none(*drag(folder / "variants/crystal"), EXTINGUISHED * drag(folder)[0], "a")


def proportional(folder):
    """Force in uN against speed in mm/s: the intercept of a line, over the force at the highest speed."""
    found = [(float(row["imposed_speed"]) * A, 1e6 * float(row["force"]), 1e6 * float(row["force_error"])) for row, _ in results.cases(folder)]
    v, f, e = map(np.array, zip(*sorted(found)))
    line, cov = np.polyfit(v, f, 1, w=1.0 / e, cov="unscaled")
    judged = judge.at_most(line[1], np.sqrt(cov[1, 1]), 0.25 * f[-1], "µN")
    return judge.Judged(judged.verdict, f"f = {judge.with_error(line[1], np.sqrt(cov[1, 1]))} µN + ({judge.with_error(line[0], np.sqrt(cov[0, 0]))}) "
                        "µN s/mm v", "criterion: an intercept below a quarter of the force at the highest speed")


SINGLE_BOX = "We used one box size and a start from the lattice; the onset depends on both and on the waiting time."
ONE_STEP = "The difference of 0.015 is about one density step, and the paper gives no grid. " + SINGLE_BOX
BED = Subject("The bed: rods, order, flow, force", (
    Row("apparatus", "section II", "a = 0.4 mm, rods 4.5 mm long and 0.8 mm thin at one end, gap 1.2 mm, 200 Hz, Γ = 7.0, box 78 a, friction and "
        "restitution of three kinds of contact", apparatus, (FLOW,), counted=False),
    Row("lone_rod", "section II", "a tapered rod on the vibrated plate moves, thin end first", alone, (LONE,), ("track",)),
    Row("lone_apolar", "section IV", "a rod tapered to both ends is not motile (below 10 % of the motile one)", stays, (LONE_APOLAR, LONE)),
    Row("motile_crystal", "section I", "polar rods stay motile in the crystal, φ_b = 0.80", walks_in_crystal, (FLOW,)),
    Row("hop_a", "Fig. 2 (a)", "onset of ψ₆ around φ_b = 0.72 (here: where it passes 0.3)", order_onset, (ORDER,), ("hop_a",), SINGLE_BOX),
    Row("hop_a_end", "Fig. 2 (a)", "ψ₆ saturates above φ_b = 0.78 (from 0.78 to 0.80 it grows by less than 0.05)", order_saturates, (ORDER,)),
    Row("hop_b_low", "Fig. 2 (b)", "g_B exponential below φ_b = 0.72, algebraic above", class_change(1, 0.72), (ORDER,), ("hop_b",), ONE_STEP),
    Row("hop_b_high", "Fig. 2 (b)", "g_B does not decay above φ_b = 0.75", class_change(2, 0.75), (ORDER,), (), ONE_STEP),
    Row("micro_a_low", "Fig. 3 (a)", "stiffness consistent with zero at small φ_b (0.66; below a tenth of that at 0.78)", soft_below, (ORDER,),
        ("micro_a",)),
    Row("micro_a", "Fig. 3 (a)", "nonzero stiffness at large φ_b (0.78)", stiff_above, (ORDER,), (),
        "The error holds the bend of the mean square displacement, a third and more of the value."),
    Row("micro_b", "Fig. 3 (b)", "stiffness in experiment: nonzero at φ_b = 0.78 (the dish, its film)", dish.stiff, made=dish.MADE),
    Row("bead_drag_a", "Fig. 4 (a)", "flow along the rod's path at φ_b = 0.70", flows, (FLOW,), ("flow",)),
    Row("bead_drag_c", "Fig. 4 (c)", "the flow is extinguished at φ_b = 0.80 (below a quarter of that at 0.70)", flow_dies, (FLOW,)),
    Row("bead_drag_b", "Fig. 4 (b), Movie S5", "the rod drags the beads around it at φ_b = 0.70", drags, (FLOW,), ("dragged",)),
    Row("bead_drag_d", "Fig. 4 (d), Movie S6", "it leaves them undisturbed at φ_b = 0.80 (below a quarter of that at 0.70)", leaves, (FLOW,)),
    Row("rel_fv", "Fig. 5", "f and v₀ are roughly proportional", proportional, (FORCE,), ("rel_fv",),
        "The bed yields: rows of beads need a finite force to slip, to which a part proportional to speed is added."),
))
