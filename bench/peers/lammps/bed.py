"""The vibrated layer of dem_peers.py for LAMMPS: parameters and a start, written by write_case().

LAMMPS has soft spheres: a linear spring and dashpot in the normal direction, a spring with history and a dashpot in the
tangential one, capped by Coulomb's law. Beads, plates, friction and restitution are those of rodwake's scene. What rodwake
does not have: kn = 500 N/m, so that beads overlap about as much as rodwake's do (0.4 % of a radius at 0.1 m/s, which
write_case's caller prints), kt = 2/7 kn, tangential damping half the normal one, and a step of 2e-6 s, 1/45 of a contact of
two beads. The cost at fixed physics goes as sqrt(kn).

Origin: this choice of spring, step and damping, and the way of timing, are those of the comparison of DEM codes that the
project's requirements came with; the files are written anew.
"""

import math
import random

BEADS, RADIUS, DENSITY = 1549, 0.4e-3, 2700.0  # m, kg/m^3
BOX, GAP = 78 * RADIUS, 1.2e-3  # m
FREQUENCY, GAMMA, GRAVITY = 200.0, 7.0, 9.81  # Hz, -, m/s^2
RESTITUTION = 0.3
FRICTION = {"bb": 0.05, "bw": 0.20}  # bead-bead, bead-plate
KN, STEP = 500.0, 2e-6  # N/m, s
AMPLITUDE = GAMMA * GRAVITY / (2 * math.pi * FREQUENCY) ** 2  # m
MASS = DENSITY * 4 / 3 * math.pi * RADIUS**3  # kg
START_SPEED = 0.02  # m/s, as rodwake's


def damping_ratio():
    """Of x'' + 2 ratio w0 x' + w0^2 x = 0, so that half an oscillation ends at -RESTITUTION times the first speed."""
    decay = -math.log(RESTITUTION)
    return decay / math.hypot(math.pi, decay)


def damping_rate(mass):
    """gamma_n of LAMMPS' hooke styles, 1/s: the force is kn x - mass gamma_n v."""
    return 2 * damping_ratio() * math.sqrt(KN / mass)


def contact_time(mass):
    return math.pi / (math.sqrt(KN / mass) * math.sqrt(1 - damping_ratio() ** 2))


def deepest_overlap(mass, speed):
    """m, of one impact at this speed."""
    ratio = damping_ratio()
    root = math.sqrt(1 - ratio**2)
    return speed / math.sqrt(KN / mass) * math.exp(-ratio / root * math.atan2(root, ratio))


def variables():
    rates = {"bb": damping_rate(MASS / 2), "bw": damping_rate(MASS)}
    values = {"kn": KN, "kt": 2 / 7 * KN, "dt": STEP, "gravity": GRAVITY, "gap": GAP, "amplitude": AMPLITUDE,
              "period": 1 / FREQUENCY}
    for kind in ("bb", "bw"):
        values |= {f"gn_{kind}": rates[kind], f"gt_{kind}": rates[kind] / 2, f"mu_{kind}": FRICTION[kind]}
    return values


def start(seed):
    """Rows of a triangular lattice 37 x 42, five sites left out at random, at mid gap; a normal velocity each."""
    stream = random.Random(seed)
    across, along = 37, 42
    dx, dy = BOX / across, BOX / along
    sites = [((i + 0.25 + 0.5 * (j % 2)) * dx, (j + 0.5) * dy) for j in range(along) for i in range(across)]
    sites = [sites[k] for k in sorted(stream.sample(range(len(sites)), BEADS))]
    return [(x, y, AMPLITUDE + GAP / 2, *(stream.gauss(0.0, START_SPEED) for _ in range(3))) for x, y in sites]


def data_text(seed):
    """In the format of read_data, atom_style sphere."""
    bodies = list(enumerate(start(seed), 1))
    lines = ["vibrated layer", "", f"{BEADS} atoms", "1 atom types", "", f"0 {BOX!r} xlo xhi", f"0 {BOX!r} ylo yhi",
             f"{-GAP / 6!r} {GAP * 5 / 4!r} zlo zhi", "", "Atoms", ""]
    lines += [f"{i} 1 {2 * RADIUS!r} {DENSITY!r} {b[0]!r} {b[1]!r} {b[2]!r}" for i, b in bodies]
    lines += ["", "Velocities", ""] + [f"{i} {b[3]!r} {b[4]!r} {b[5]!r} 0 0 0" for i, b in bodies]
    return "\n".join(lines) + "\n"


def write_case(folder, seed):
    (folder / "parameters.lmp").write_text("".join(f"variable {k} equal {v!r}\n" for k, v in variables().items()))
    (folder / "start.data").write_text(data_text(seed))
