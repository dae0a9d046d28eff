"""Displacement around rods in the unstrained bed against the orthotropic medium whose constants were measured without a rod."""

import math

from . import sound
from .lab import A, bed, combined, product, ratio, rod, table, text

SPEEDS = (None, 1.0, -1.0, 4.0)   # mm/s; None walks by itself
SECONDS, RUNS, WITH_SOUND = 40.0, 6, 1
MASKS = ((8, 10), (10, 12), (12, 14), (10, 16), (14, 14), (6, 12))  # strip, radius, a; the first is that of the fit
MONOPOLE = ("amplitude", "p_xx", "p_yy", "offset")
ROD_LENGTH = 11.25               # a


def cost():
    return len(SPEEDS) * (SECONDS + 2) * 1538 * (RUNS + WITH_SOUND * (sound.SOUND_COST - 1))


def run(lab, speed, seed, seconds=SECONDS, sound_too=False):
    first = 5.0 if lab.seconds(seconds) > 20 else 0.5
    measure = (f'displacement = "phase"\nforce = true\nmechanics = true\nfrom = "{first} s"\nblock = "{4.0 if lab.seconds(seconds) > 20 else 0.5} s"\n'
               + (f'phonons = true\nphonon_waves = 3\nphonon_interval = "{sound.INTERVAL} s"\n' if sound_too else ""))
    name = f"map_{'free' if speed is None else f'{speed:g}'}_{seed}"
    return lab.make(name, bed(lab.seconds(seconds), f"seed = {seed}\n", measure, rod(speed), frames=round(14 * sound.INTERVAL, 6)))


def folders(lab, speed):
    return [run(lab, speed, seed, sound_too=seed <= WITH_SOUND) for seed in range(1, lab.count(RUNS) + 1)]


def held(constants, force, density, with_errors=None):
    """Keys of a fit with everything but the amplitude held; the force over mass per area."""
    values = {name: one[0] for name, one in constants.items()} | {"force": force[0] / density / A**3, "rho": 1.0}
    errors = {name: one[1] for name, one in constants.items()} | {"force": force[1] / density / A**3}
    errors = {name: error for name, error in errors.items() if name in (with_errors or errors)}
    join = ", ".join
    return (f"fixed = {{ {join(f'{k} = {v:.10g}' for k, v in values.items())} }}\n"
            f"fixed_errors = {{ {join(f'{k} = {abs(v):.10g}' for k, v in errors.items())} }}\n")


def masks(pairs):
    return "".join(f"[[fit.masks]]\nstrip = {strip}\nradius = {radius}\n" for strip, radius in pairs)


def scene(files, speed, keys, parameters, start="", pairs=MASKS, width=1.0):
    listed = ", ".join(f'"{file}"' for file in files)
    quoted = ", ".join(f'"{name}"' for name in parameters)
    return (f"schema = 1\n[fit]\nparameters = [{quoted}]\n{keys}{start}rod_length = {ROD_LENGTH}\nsource_width = {width}\n"
            f"independent_spacing = 4.2\n[[fit.maps]]\nfiles = [{listed}]\nspeed = {speed:.8g}\n{masks(pairs)}"
            '[[figures]]\nname = "map"\nkind = "fit_map"\n')


def signed(folders_of, speed):
    """Force (N, with its error) and speed through the bed (a/s) of runs alike, with the sign of the rod's way."""
    sign = -1.0 if speed is not None and speed < 0 else 1.0
    force, error = combined(folders_of, "mechanics", "force")
    return (sign * force, error), combined(folders_of, "mechanics", "speed")[0]


def fit(lab, name, files_of, speed, constants, density, width=1.0):
    force, through = signed(files_of, speed)
    keys = held(constants, force, density)
    return lab.fit(name, scene([folder / "measure.h5" for folder in files_of], through, keys, MONOPOLE, width=width)), force, through


def part(lab):
    at_rest = sound.run(lab)
    constants = sound.constants(at_rest)
    density = sound.density(at_rest)
    rows, by_mask = [], []
    for speed in SPEEDS:
        label = "free" if speed is None else f"{speed:+g} mm/s"
        found, force, through = fit(lab, f"fit_{'free' if speed is None else f'{speed:g}'}", folders(lab, speed), speed, constants, density)
        errors = found["systematics"]["errors"]
        one = errors["amplitude"]
        amplitude, momentum_drag = (one["value"], one["total"]), combined(folders(lab, speed), "mechanics", "drag_rate")
        rows.append([label, text(force, 1e6), f"{through:.2f}", text(amplitude), text(product(amplitude, ratio(momentum_drag, constants["zeta"]))),
                     " / ".join(f"{one[part] or math.nan:.3f}" for part in ("jackknife", "held", "masks")),
                     *(text((errors[p]["value"] / 1e4, errors[p]["total"] / 1e4), digits=1) for p in ("p_xx", "p_yy")),
                     f"{found['chi2']:.0f} ({found['dof']})"])
        by_mask.append([label, *(text((m["parameters"]["amplitude"]["value"], m["parameters"]["amplitude"]["stderr"] or math.nan))
                                 for m in found["systematics"]["masks"])])
    table("Monopole over its prediction, no constant fitted", ["rod", "force, uN", "speed through the bed, a/s", "amplitude",
          "over drag x drift", "of its error: runs / held / masks", "P_xx/rho, 1e4 a^4/s^2", "P_yy/rho", "chi2 (dof)"], rows)
    table("The same by mask (|y| >= strip, r >= radius; errors of the curvature alone)", ["rod", *(f"{s} a, {r} a" for s, r in MASKS)], by_mask)
