"""The bed beside hard discs, of which all is known: elastic, frictionless beads between still plates a diameter apart, without gravity.

    Z = p A/(N m T_xy) = 1 + x + sum b_n x^(n-1),  x = B2 rho = 2 phi,  b_n = B_n/B2^(n-1)      (fluid)
    g(sigma) = (Z - 1)/(2 phi),  g from the distances of frames: shares nothing with the impulses that make p
    p sigma^2/(m T_xy) = 9.18 where liquid and hexatic coexist, phi = 0.700 to 0.716 (Engel et al., Phys. Rev. E 87, 042134, 2013)

The plates are 1.01 diameters apart: beads meet at 0.99999 diameters in the mean. Then the bed becomes the paper's, one change at a time.
Discs of two sizes: spheres whose centres start at one height, with velocities in the plane, stay in it, so plates 2.02 large radii apart do.

    Z = p A/(sum m_i T_i) = (1 - s)/(1 - phi) + s Z_1(phi),  s = <a>^2/<a^2>,  Z_1 of equal discs    (Santos, Yuste and Lopez de Haro 1999)

The range of the fit of g and the level of psi6 that is called the onset were set before the runs; the third step was added when two had
been seen, the area fractions of a bed were chosen as the order of those before it was known.
"""

from pathlib import Path

import numpy as np

from lab import columns, estimate, keep_row, kept_rows, mean, table, text, read_json

from .bed import A, HEAD

STORED = Path(__file__).with_suffix(".csv")  # reduced runs of an earlier time
B = (1.0, 1.0, 0.7820044, 0.53223180, 0.33555604, 0.1988425, 0.11486728, 0.0649930, 0.0362193, 0.0199537)  # b_1 to b_10
COEXISTENCE = 9.18
MASS = 4 / 3 * np.pi * A**3 * 2700.0  # kg
SPEED = 0.05                          # m/s, rms of a component at the start
FLUID, BEADS, STEPS = (0.2, 0.3, 0.4, 0.5, 0.6), 1500, (1e-4, 5e-5, 2.5e-5)
FINEST_FROM = 0.5                     # phi: below it the third step is not made
SECONDS, SETTLE, RUNS = 2.0, 0.5, 4
CONTACT = 2.05, 2.45                  # a: g is extrapolated from these bins; nearer ones hold pairs that still overlap after a step
ELASTIC = "friction = 0\nrestitution = 1\n"
SMOOTH = f"[granular.contacts.particle_particle]\n{ELASTIC}[granular.contacts.bead_wall]\n{ELASTIC}"
STILL = "gravity = 0\n", '[granular.plates]\ngamma = 0\ngap = "{} a"\n' + SMOOTH
BEDS = {  # keys of [granular], tables and area fractions, one change a row
    "hard discs": (STILL[0], STILL[1].format(2.02), (0.69, 0.70, 0.71, 0.72, 0.73)),
    "gap of 1.5 diameters": (STILL[0], STILL[1].format(3), (0.72, 0.74, 0.76, 0.78, 0.80)),
    "shaken, losses at the plates": ("", f"[granular.contacts.bead_bead]\n{ELASTIC}", (0.70, 0.72, 0.74)),
    "losses among beads: the paper's": ("", "", (0.70, 0.71, 0.72))}
TIMES = {True: (3.0, 6.0), False: (8.0, 16.0)}  # s before and while measured, of elastic and of shaken beds: some 10^4 impacts a bead
ORDER_RUNS, ORDER_BEADS = 2, 1400
LARGE = 0.708, 4, 5e-5, (6.0, 8.0)     # phi; times as many beads; step, times, s
ONSET = 0.4                           # of psi6
COOLING = 0.72, 1.0                   # phi; s
MIXTURES = {"1 : 1.4, half and half": (1.4, 2), "1 : 2, three small to one large": (2.0, 4)}  # ratio of radii; one disc in so many is large
MIXED = (0.3, 0.5, 0.6), 32, 2.5e-5, (0.5, 1.0)  # phi; discs along a side; step, times, s
FAST = 5                              # times the cost of a shaken bed, of elastic ones at their speed


def cost():
    fluids = sum(FAST * RUNS * (SECONDS + SETTLE) * BEADS * 1e-4 / step for phi in FLUID for step in steps(phi))
    beds = sum(len(phis) * ORDER_RUNS * sum(TIMES[still]) * ORDER_BEADS * (FAST if still else 1)
               for phis, still in ((phis, keys == STILL[0]) for keys, _, phis in BEDS.values()))
    phis, side, step, seconds = MIXED
    mixtures = FAST * len(MIXTURES) * len(phis) * RUNS * side**2 * sum(seconds) * 1e-4 / step
    return fluids + mixtures + beds + FAST * ORDER_BEADS * (sum(TIMES[True]) + COOLING[1] + ORDER_RUNS * LARGE[1] * sum(LARGE[3]) * 1e-4 / LARGE[2])


def brief(lab, seconds):
    return seconds / 10 if lab.quick else seconds  # these runs are shorter than those of Lab.seconds


def scene(keys, seconds, settle, runs, tables, frames=0.5):
    return (f'{HEAD}{keys}start_speed = {SPEED}\noverlap_limit = 0.3\nequilibrate = "{settle:.6g} s"\nduration = "{seconds:.6g} s"\n'
            f'runs = {runs}\n{tables}[granular.output]\nformats = []\nlast_period = false\nframes = "{frames} s"\n'
            f'[measure]\norder = true\norder_interval = "{frames} s"\nblock = "{min(5.0, seconds / 4):.6g} s"\n')


# What is kept of a run.


def reduced(folder):
    """Of an ensemble: Z and p sigma^2/(m T_xy) with errors between runs, temperatures, order, g at contact."""
    summary, order = read_json(folder, "summary"), read_json(folder, "measure")["order"]
    runs = columns(folder / "runs.csv") if (folder / "runs.csv").is_file() else {
        "p_xx": np.array([summary["pressure"]["xx"]]), "p_yy": np.array([summary["pressure"]["yy"]]), "T_xy": np.array([summary["T_xy"]])}
    area = np.prod(summary["box"]) if isinstance(summary["box"], list) else summary["box"]**2
    kT = MASS * runs["T_xy"]
    p = (runs["p_xx"] + runs["p_yy"]) / 2
    row = {"phi": summary["beads_fraction"], "beads": summary["beads"], "runs": summary["runs"], "T_xy": summary["T_xy"], "T_z": summary["T_z"]}
    found = {"Z": mean(p * area / (summary["beads"] * kT)), "P": mean(p * (2 * A)**2 / kT), "psi6": estimate(order["psi6"]),
             "exponent": estimate(order["exponent"]), "contact": contact(*columns(folder / "gr.csv", "r", "g", "sigma"))}
    for name, (value, error) in found.items():
        row |= {name: value, f"{name}_error": error}
    return row | {"class": order["class"]}


def contact(r, g, sigma):
    """g at r = 2 a, by a parabola through ln g over CONTACT: (value, error)."""
    near = (r > CONTACT[0]) & (r < CONTACT[1]) & (g > 0) & (sigma > 0)
    if near.sum() < 4:
        return np.nan, np.nan
    found, covariance = np.polyfit(r[near] - 2.0, np.log(g[near]), 2, w=g[near] / sigma[near], cov="unscaled")
    return np.exp(found[-1]), np.exp(found[-1]) * covariance[-1, -1]**0.5


def kept(lab, name, text_):
    """The row of a run: of stored ones, else made now and kept with the other runs."""
    mine = lab.folder / STORED.name
    for row in (*([] if lab.quick else kept_rows(STORED)), *kept_rows(mine)):
        if row["name"] == name:
            return {key: value if key in ("name", "class") else float(value) for key, value in row.items()}
    keep_row(mine, {"name": name} | reduced(lab.make(name, text_)))
    return kept(lab, name, text_)


def pair(row, name):
    return row[name], row[f"{name}_error"]


# The fluid.


def series(phi):
    """Ten terms, and the last of them."""
    terms = [b * (2 * phi)**n for n, b in enumerate(B)]
    return sum(terms), terms[-1]


def pade(phi, low=4):
    """The approximant [low/9 - low] of the same ten coefficients."""
    high = len(B) - 1 - low
    rows = [[B[low + i - j] if low + i >= j else 0.0 for j in range(1, high + 1)] for i in range(1, high + 1)]
    below = np.concatenate([[1.0], np.linalg.solve(rows, [-B[low + i] for i in range(1, high + 1)])])
    above = [sum(below[j] * B[i - j] for j in range(min(i, high) + 1)) for i in range(low + 1)]
    return np.polyval(above[::-1], 2 * phi) / np.polyval(below[::-1], 2 * phi)


def fluid(lab, phi, step):
    side = np.sqrt(BEADS * np.pi / phi)
    keys = f'beads = {BEADS}\nbox = "{side:.12g} a"\nstart = "lattice"\ntime_step = {step}\n{STILL[0]}'
    return kept(lab, f"fluid_{phi:g}_{step:g}",
                scene(keys, brief(lab, SECONDS), SETTLE, lab.count(RUNS), STILL[1].format(2.02), frames=0.05))


def steps(phi):
    return STEPS if phi >= FINEST_FROM else STEPS[:2]


def without_step(coarse, fine):
    """To step 0, as the error is proportional to the step: from (value, error) at a step and at half of it."""
    return 2 * fine[0] - coarse[0], np.hypot(2 * fine[1], coarse[1])


def excess(pair_, reference):
    return text((pair_[0] / reference - 1, pair_[1] / reference), 100)


def fluid_tables(lab):
    lines, contacts = [], []
    for phi in FLUID:
        rows = [fluid(lab, phi, step) for step in steps(phi)]
        Z = [pair(row, "Z") for row in rows]
        shown = [text(one, digits=4) for one in Z] + ["-"] * (len(STEPS) - len(Z))
        limit, reference, (ten, last) = without_step(*Z[-2:]), pade(phi), series(phi)
        lines.append([f"{phi:g}", *shown, text(limit, digits=4), f"{ten:.4f}", f"{last:.4f}", f"{reference:.4f}",
                      f"{abs(pade(phi, 5) - reference):.4f}", *(excess(one, reference) for one in (Z[-1], limit))])
        g = pair(rows[-1], "contact")
        of_pressure = (Z[-1][0] - 1) / (2 * phi), Z[-1][1] / (2 * phi)
        contacts.append([f"{phi:g}", text(g, digits=3), text(of_pressure, digits=4), f"{(reference - 1) / (2 * phi):.4f}",
                         text((g[0] / of_pressure[0] - 1, np.hypot(g[1] / g[0], of_pressure[1] / of_pressure[0])), 100)])
    table("Z of hard discs", ["phi", *(f"step {step:g} s" for step in STEPS), "step to 0", "ten terms", "the last one", "Pade [4/5]",
                              "less [5/4]", "finest step over Pade, %", "step to 0 over it, %"], lines)
    table("g at contact", ["phi", "from distances", "(Z - 1)/(2 phi) of the same runs", "of Pade", "distances over pressure, %"], contacts)


# Two sizes.


def discs(lab, phi, ratio, of):
    """A square grid of discs in one plane, which melts; (folder, sums of N a and N a^2 in units of a)."""
    _, side, step, (settle, seconds) = MIXED
    row, column = np.indices((side, side)).reshape(2, -1)
    large = (row + column) % of == 0
    radius = np.where(large, ratio, 1.0)
    spacing = np.sqrt(np.pi * (radius**2).mean() / phi)
    start = lab.write(f"discs_{ratio:g}_{phi:g}.csv", "x,y,z,vz,radius,kind\n" + "".join(
        f"{A * spacing * (i + 0.5):.12g},{A * spacing * (j + 0.5):.12g},{1.01 * ratio * A:.12g},0,{A * r:.12g},{k:d}\n"
        for i, j, r, k in zip(column, row, radius, large)))
    kinds = "".join(f'[[granular.bead_kinds]]\nradius = "{one:.12g} a"\n' for one in (1.0, ratio))
    keys = f'box = "{spacing * side:.12g} a"\nstart = "file"\nstart_file = "{start.name}"\ntime_step = {step}\n{STILL[0]}'
    text_ = scene(keys, brief(lab, seconds), settle, lab.count(RUNS), STILL[1].format(2.02 * ratio) + kinds)
    return lab.make(f"discs_{ratio:g}_{phi:g}", text_.partition("[measure]")[0]), radius.mean(), (radius**2).mean()


def mixture(lab, name, phi):
    """Z of discs of two sizes, its error between runs, the formula, and what the energy of a run changes by."""
    mine, key = lab.folder / "mixtures.csv", f"{name}, {phi:g}"
    for row in (*([] if lab.quick else kept_rows(STORED.with_name("mixtures.csv"))), *kept_rows(mine)):
        if row["name"] == key:
            return {column: float(value) for column, value in row.items() if column != "name"}
    folder, first, second = discs(lab, phi, *MIXTURES[name])
    kinds, runs = read_json(folder, "summary")["kinds"], columns(folder / "runs.csv")
    heat = sum(kind["beads"] * MASS * (kind["radius"] / A)**3 * runs[f"T_xy_kind{k}"] for k, kind in enumerate(kinds))
    Z = mean((runs["p_xx"] + runs["p_yy"]) / 2 * read_json(folder, "summary")["box"]**2 / heat)
    s, (energy,) = first**2 / second, columns(folder / "runs/0001/table.csv", "energy")
    keep_row(mine, {"name": key, "Z": Z[0], "Z_error": Z[1], "formula": (1 - s) / (1 - phi) + s * pade(phi), "energy": np.ptp(energy) / energy[0],
                    "T_z": sum(kind["T_z"] for kind in kinds)})
    return mixture(lab, name, phi)


def mixture_table(lab):
    found = [(name, phi, mixture(lab, name, phi)) for name in MIXTURES for phi in MIXED[0]]
    table("Z of hard discs of two sizes", ["radii", "phi", "Z", "formula", "over it, %", "change of energy", "T_z, m^2/s^2"],
          [[name, f"{phi:g}", text(pair(row, "Z"), digits=4), f"{row['formula']:.4f}", excess(pair(row, "Z"), row["formula"]), f"{row['energy']:.0e}",
            f"{row['T_z']:g}"] for name, phi, row in found])


# The order.


def bed_scene(lab, name, phi, runs):
    keys, tables, _ = BEDS[name]
    settle, seconds = TIMES[keys == STILL[0]]
    return scene(f'phi_b = {phi}\nbox = "78 a"\nstart = "lattice"\n{keys}', brief(lab, seconds), settle, runs, tables, frames=0.1)


def large(lab):
    """Hard discs in a box where liquid and hexatic find room beside each other."""
    phi, times, step, (settle, seconds) = LARGE
    keys = f'phi_b = {phi}\nbox = "{78 * (1 if lab.quick else times)**0.5:g} a"\nstart = "lattice"\ntime_step = {step}\n{STILL[0]}'
    return kept(lab, "large", scene(keys, brief(lab, seconds), settle, lab.count(ORDER_RUNS), STILL[1].format(2.02), frames=0.1))


def ordered(lab, name, phi):
    number = list(BEDS).index(name)
    return kept(lab, f"order_{number}_{phi:g}", bed_scene(lab, name, phi, lab.count(ORDER_RUNS)))


def onset(phis, psi):
    """Area fraction at which psi6 = ONSET, by straight lines between its values: (value, error); NaN where it is never crossed."""
    for (low, (a, ea)), (high, (b, eb)) in zip(zip(phis, psi), zip(phis[1:], psi[1:])):
        if a < ONSET <= b:
            part = (ONSET - a) / (b - a)
            return low + part * (high - low), (high - low) / (b - a) * np.hypot((1 - part) * ea, part * eb)
    return np.nan, np.nan


def cooled(lab):
    """psi6 and T_xy of the gap's bed before and after losses act in it, unshaken: [row] of (t, T_xy, psi6)."""
    phi, seconds = COOLING
    name = "gap of 1.5 diameters"
    start = lab.make("warm", bed_scene(lab, name, phi, 1))
    keys = f'phi_b = {phi}\nbox = "78 a"\nstart = "restart"\nrestart_from = "{start / "final.rwc"}"\n{STILL[0]}'
    folder = lab.make("cooling", scene(keys, seconds, 0.0, 1, '[granular.plates]\ngamma = 0\ngap = "3 a"\n', frames=0.05))
    return columns(folder / "table.csv", "t", "T_xy", "psi6")


def order_tables(lab):
    found = {name: {phi: ordered(lab, name, phi) for phi in phis} for name, (_, _, phis) in BEDS.items()}
    every = sorted({phi for rows in found.values() for phi in rows})
    table("psi6 by area fraction and bed", ["bed", *(f"{phi:.2f}" for phi in every), f"psi6 = {ONSET}", "T_z/T_xy at 0.72"],
          [[name, *(f"{text(pair(rows[phi], 'psi6'))}, {rows[phi]['class'][:4]}" if phi in rows else "" for phi in every),
            text(onset(list(rows), [pair(row, "psi6") for row in rows.values()]), digits=4), f"{rows[0.72]['T_z'] / rows[0.72]['T_xy']:.3f}"]
           for name, rows in found.items()])
    discs = [(f"{phi:.2f}", row) for phi, row in found["hard discs"].items()]
    discs.append((f"{LARGE[0]:.3f}, step {LARGE[2]:g} s", large(lab)))
    table("Pressure of hard discs", ["phi", "beads", "p sigma^2/(m T_xy)", f"less {COEXISTENCE}", "psi6"],
          [[phi, f"{row['beads']:.0f}", text(pair(row, "P"), digits=3), f"{row['P'] - COEXISTENCE:+.3f}", text(pair(row, "psi6"))]
           for phi, row in discs])
    t, T, psi = cooled(lab)
    table(f"Losses without shaking, phi_b = {COOLING[0]}", ["t, s", "T_xy, m^2/s^2", "psi6"],
          [[f"{t[k]:.2f}", f"{T[k]:.2e}", f"{psi[k]:.2f}"] for k in np.searchsorted(t, (0, 0.02, 0.05, 0.1, 0.3, COOLING[1] - 1e-9))])


def part(lab):
    fluid_tables(lab)
    mixture_table(lab)
    order_tables(lab)
