#!/usr/bin/python3
"""Validation of the granular simulator: every number of studies/reports/granular.md that comes from a bed.

    studies/validate_granular.py [--program build/release/rodwake] [--only lone,beads,order,bed,steps,pairs,impacts,force,yield] [--quick]
                               [-j 2] [--keep DIR]

Prints Markdown. Each line gives mean +- standard error, the number of runs and what was asked. --quick: few and short runs, to
see that everything works; its numbers mean little.
"""

import math

import numpy as np

from lab import SOURCE, estimate, line_fit, norm_error, parser, rows, rows_of, run_parts, table, text, read_json

BOX = 'box = "78 a"\n'
UNSTRAINED = 'box = "fit"\n'
QUIET = "[granular.output]\nformats = []\nlast_period = false\n"
STEPS = ("5e-6", "1e-5", "2e-5", "5e-5", "1e-4")  # s


def run(lab, name, keys, rods="", runs=1):
    """The summary of a bed."""
    scene = f"schema = 1\n[granular]\nruns = {lab.count(runs)}\n{keys}{QUIET}{rods}"
    return read_json(lab.make(name, scene, verbs=("dem",)), "summary")


def seconds(lab, value):
    return f'"{value / 10 if lab.quick else value} s"'


def rod(x, y, kind="motile", extra=""):
    return f'[[granular.rods]]\nkind = "{kind}"\nposition = ["{x} a", "{y} a"]\n{extra}'


def shown(found, key, scale=1.0, digits=3):
    return text(estimate(found, key), scale, digits)


def speed(found, digits=3):
    return shown(found["rods"][0], "mean_speed", 1e3, digits)


def force_of(found, key="force"):
    return shown(found["rods"][0], key, 1e6)


def impacts(lab):
    data = SOURCE / "tests/granular/data/stronge_impacts.csv"
    wanted, answer = rows(data), rows_of(lab.call("impact", "--cases", data).stdout)
    worst = max(norm_error(got, want, ("Px", "Py", "Pz")) for got, want in zip(answer, wanted, strict=True))
    table("Single impacts", ["cases", "largest error of P, of |P|", "asked"], [[len(wanted), f"{worst:.1e}", "1e-9"]])


def lone(lab):
    kinds = [("motile", "", 16, "2 to 4"), ("apolar", "", 64, "0 within 2 errors"), ("motile", 'taper = "stepwise"\n', 16, "")]
    found = []
    for kind, shape, runs, asked in kinds:
        name = kind + (", stepwise" if shape else "")
        for dt in STEPS:
            keys = f'beads = 0\n{BOX}time_step = "{dt} s"\nequilibrate = "0.1 s"\nduration = {seconds(lab, 5)}\n'
            s = run(lab, f"lone_{name.replace(', ', '_')}_{dt}", keys, rod(39, 39, kind, shape), runs)
            found.append([name, dt, speed(s, 4), s["runs"], asked])
    table("Lone rod at Gamma = 7, + = thin end first", ["rod", "dt, s", "speed, mm/s", "runs", "asked"], found)


def beads(lab):
    found = []
    for dt in STEPS:
        keys = f'phi_b = 0.80\n{BOX}time_step = "{dt} s"\nequilibrate = "0.5 s"\nduration = {seconds(lab, 2)}\n'
        s = run(lab, f"beads_{dt}", keys, runs=8)
        found.append([dt, shown(s, "T_xy", 1e5), shown(s, "T_z", 1e3, 4), f'{s["max_overlap"]:.4f}', s["runs"]])
    found.append(["soft spheres, stiff limit", "5.2", "1.69", "", ""])
    table("Beads alone, phi_b = 0.80", ["dt, s", "T_xy, 1e-5 m^2/s^2", "T_z, 1e-3 m^2/s^2", "largest overlap, a", "runs"], found)


def psi6(lab, phi, start, equilibrate):
    """After a wait in seconds, or the default one."""
    wait = "" if equilibrate is None and not lab.quick else f"equilibrate = {seconds(lab, equilibrate or 2)}\n"
    keys = f'phi_b = {phi}\n{BOX}start = "{start}"\n{wait}duration = {seconds(lab, 8)}\n'
    return shown(run(lab, f"order_{phi}_{start}", keys, runs=4), "psi6")


def order(lab):
    densities = (0.66, 0.68, 0.70, 0.71, 0.72, 0.73, 0.74, 0.76, 0.78, 0.80)
    table("Order: psi_6 over 8 s, 4 runs each", ["phi_b", "from the lattice (8 s before)", "from a random start (default wait)"],
          [[f"{phi:.2f}", psi6(lab, phi, "lattice", 8), psi6(lab, phi, "random", None)] for phi in densities])


def bed(lab):
    found = []
    for phi in (0.70, 0.76, 0.80):
        s = run(lab, f"bed_{phi}", f"phi_b = {phi}\n{BOX}duration = {seconds(lab, 10)}\n", rod(20, 39), 16)
        found.append([f"{phi:.2f}", speed(s), force_of(s), s["runs"]])
    table("One rod in the bed, 10 s", ["phi_b", "speed, mm/s", "force on the beads, uN", "runs"], found)


def steps(lab):
    found = []
    for phi, runs in ((0.70, 16), (0.80, 32)):  # in the crystal a rod's speed scatters more
        for dt in ("1.25e-5", "2.5e-5", "5e-5", "1e-4"):
            keys = f'phi_b = {phi}\n{BOX}time_step = "{dt} s"\nduration = {seconds(lab, 10)}\n'
            s = run(lab, f"steps_{phi}_{dt}", keys, rod(20, 39), runs)
            found.append([f"{phi:.2f}", dt, speed(s), shown(s, "T_xy", 1e5), shown(s, "T_z", 1e3, 4),
                          f'{s["cpu_seconds"] / (s["runs"] * (s["simulated_time"] + 0.5)):.3f}', s["runs"]])
    table("What the time step changes: one rod in the bed, 10 s",
          ["phi_b", "dt, s", "speed, mm/s", "T_xy, 1e-5 m^2/s^2", "T_z, 1e-3 m^2/s^2", "CPU s per simulated s", "runs"], found)


def pairs(lab):
    kinds = [("motile", 0.70, 0), ("motile", 0.78, 0), ("motile", 0.70, 90), ("motile", 0.78, 90), ("apolar", 0.70, 0), ("apolar", 0.78, 0)]
    table("Two rods side by side, 15 a apart: change of their separation over half the box (apolar: in 14 s)",
          ["rods", "phi_b", "lattice turned by", "change, a", "in errors", "time, s", "runs that got there"], [pair_row(lab, *one) for one in kinds])


def pair_row(lab, kind, phi, angle):
    moving = kind == "motile"
    stop = 'stop_at_travel = "39.01 a"\n' if moving and not lab.quick else ""
    keys = f'phi_b = {phi}\n{BOX}orientation = "{angle} deg"\n{stop}duration = {seconds(lab, 60 if moving else 14)}\n'
    s = run(lab, f"pair_{kind}_{phi}_{angle}", keys, rod(20, 46.5, kind) + rod(20, 31.5, kind), 50)
    pair, half = s["pair"], "half_box_separation_change"
    change, error = estimate(pair, half if moving and half in pair else "separation_change")
    return [kind, f"{phi:.2f}", angle, text((change, error), 1 / s["bead_radius"]), f'{abs(change) / error if error else math.nan:.1f}',
            f'{pair.get("half_box_time", s["simulated_time"]):.1f}', f'{pair["half_box_runs"]}/{s["runs"]}']


def held(lab, name, bed_keys, imposed, runs):
    """A rod held at a speed, mm/s."""
    keys = f"{bed_keys}duration = {seconds(lab, 10)}\n"
    return run(lab, f"{name}_{imposed}", keys, rod(20, 39, extra=f'imposed_speed = "{imposed} mm/s"\n'), runs)


def force(lab):
    found = [(imposed, held(lab, "force", f"phi_b = 0.80\n{BOX}", imposed, 8)) for imposed in (0.25, 0.5, 1.0, 2.0, 4.0)]
    table("Force on the beads of a rod held at a speed, phi_b = 0.80, 10 s", ["speed, mm/s", "force, uN", "runs"],
          [[f"{imposed:g}", force_of(s), s["runs"]] for imposed, s in found])


def crossing(thrust, force_points):
    """Speed at which two straight lines through (v, f, error) meet, with the error of their coefficients carried on."""
    lines = [line_fit(*np.array(points).T) for points in (thrust, force_points)]
    (slope, at_rest), (c, f0) = ((one[0][0], one[1][0]) for one in lines)
    v = (at_rest - f0) / (c - slope)
    gradient = np.array([v, 1.0]) / (c - slope)
    return v, math.sqrt(sum(gradient @ covariance @ gradient for *_, covariance in lines))


def yielding(lab):
    """Thrust of a lone rod held at a speed against the force that the bed takes at it: where they are equal it should walk."""
    speeds, found, points = (0.5, 1.0, 1.5, 2.0, 2.5), [], {}
    for phi in (None, 0.70, 0.80):
        bed_keys = (f"beads = 0\n{BOX}" if phi is None else f"phi_b = {phi}\n{UNSTRAINED}") + 'equilibrate = "0.5 s"\n'
        for imposed in (0.0, *speeds) if phi is None else speeds:
            s = held(lab, f"yield_{phi}", bed_keys, imposed, 16)
            points.setdefault(phi, []).append((imposed, s["rods"][0]))
            found.append(["none" if phi is None else f"{phi:.2f}", f"{imposed:g}", force_of(s, "thrust"), force_of(s)])
    table("Thrust of the plates on a rod held at a speed, and its force on the beads, 10 s, 16 runs",
          ["phi_b", "speed, mm/s", "thrust, uN", "force, uN"], found)
    table("Speed from thrust = force, and the free rod's",
          ["phi_b", "lone rod's thrust, mm/s", "thrust in the bed, mm/s", "free, mm/s", "its thrust, uN", "its force, uN"],
          [free_row(lab, phi, points) for phi in (0.70, 0.80)])


def free_row(lab, phi, points):
    def of(at, key):
        return [(v, *(1e6 * one for one in estimate(r, key))) for v, r in points[at]]
    s = run(lab, f"free_{phi}", f"phi_b = {phi}\n{UNSTRAINED}duration = {seconds(lab, 10)}\n", rod(20, 39), 16)
    meet = (text(crossing(of(at, "thrust"), of(phi, "force")), digits=3) for at in (None, phi))
    return [f"{phi:.2f}", *meet, speed(s), force_of(s, "thrust"), force_of(s)]


PARTS = {"impacts": impacts, "lone": lone, "beads": beads, "order": order, "bed": bed, "steps": steps, "pairs": pairs,
         "force": force, "yield": yielding}

if __name__ == "__main__":
    run_parts(parser(__doc__, "report", "quick", "threads", "keep", parts=PARTS).parse_args(), PARTS)
