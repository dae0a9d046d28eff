"""Displacement around rods in the unstrained bed against the orthotropic medium whose constants were measured without a rod."""

import math

from lab import estimate, ratio, table, text, read_json

from . import push, sound
from .bed import A, bed, combined, rod

SPEEDS = (None, 1.0, -1.0, 4.0)   # mm/s; None walks by itself
SECONDS, RUNS = 30.0, 6
HEARD_SECONDS = 40.0
MASKS = ((8, 10), (10, 12), (12, 14), (10, 16), (14, 14), (6, 12))  # strip, radius, a; the first is that of the fit
MONOPOLE = ("amplitude", "p_xx", "p_yy", "offset")
ROD_LENGTH = 11.25               # a


def cost():
    return len(SPEEDS) * 1538 * (RUNS * (SECONDS + 2) + (HEARD_SECONDS + 2) * sound.SOUND_COST)


def run(lab, speed, seed, seconds=SECONDS, sound_too=False):
    first = 5.0 if lab.seconds(seconds) > 20 else 0.5
    measure = (f'displacement = "phase"\nforce = true\nmechanics = true\nfrom = "{first} s"\nblock = "{4.0 if lab.seconds(seconds) > 20 else 0.5} s"\n'
               + (f'phonons = true\nphonon_waves = 3\nphonon_interval = "{sound.INTERVAL} s"\n' if sound_too else ""))
    name = f"map_{'free' if speed is None else f'{speed:g}'}_{seed}"
    return lab.make(name, bed(lab.seconds(seconds), f"seed = {seed}\n", measure, rod(speed), frames=round(14 * sound.INTERVAL, 6)))


def folders(lab, speed):
    return [run(lab, speed, seed) for seed in range(1, lab.count(RUNS) + 1)]


def held(constants, inertia, force, density, with_errors=None):
    """Keys of a fit with everything but the amplitude held; the force over mass per area. The error of the inertia, a common factor of
    all constants, counts as one of the force."""
    force = force[0], abs(force[0]) * math.hypot(force[1] / force[0], inertia[1] / inertia[0])
    values = {name: one[0] for name, one in constants.items()} | {"force": force[0] / density / A**3, "rho": inertia[0]}
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


def fit(lab, name, files_of, speed, constants, inertia, density, width=1.0, parameters=MONOPOLE):
    force, through = signed(files_of, speed)
    keys = held(constants, inertia, force, density)
    return lab.fit(name, scene([folder / "measure.h5" for folder in files_of], through, keys, parameters, width=width)), force, through


def heard(lab, speed):
    """A run of the same bed in which sound is measured too."""
    return run(lab, speed, 101, seconds=HEARD_SECONDS, sound_too=True)


def name_of(speed):
    return "free" if speed is None else f"{speed:g}"


def amplitude(found):
    one = found["systematics"]["errors"]["amplitude"]
    return one["value"], one["total"]


def row(label, found, force, through, own, inertia):
    errors = found["systematics"]["errors"]
    value, error = amplitude(found)
    bare = value / inertia[0], math.hypot(error, value * inertia[1] / inertia[0]) / inertia[0]
    return [label, text(force, 1e6), f"{through:.2f}", text((value, error)), text(amplitude(own)), text(bare),
            " / ".join(f"{errors['amplitude'][part] or math.nan:.3f}" for part in ("jackknife", "held", "masks")),
            *(text((errors[p]["value"] / 1e4, errors[p]["total"] / 1e4), digits=0) for p in ("p_xx", "p_yy")), f"{found['chi2']:.0f} ({found['dof']})"]


def over_masks(found):
    """Mean amplitude of all masks, and half of its range."""
    values = [mask["parameters"]["amplitude"]["value"] for mask in found["systematics"]["masks"]]
    return sum(values) / len(values), (max(values) - min(values)) / 2


def mask_row(label, found, own, inertia):
    """Amplitudes over all masks with each set of constants; the error of the runs; the first fit by mask."""
    at_rest, errors = over_masks(found), found["systematics"]["errors"]["amplitude"]
    bare = tuple(one / inertia[0] for one in at_rest)
    runs = math.hypot(errors["jackknife"] or math.nan, errors["held"])
    each = [(m["parameters"]["amplitude"]["value"], m["parameters"]["amplitude"]["stderr"] or math.nan) for m in found["systematics"]["masks"]]
    return [label, text(at_rest), text(over_masks(own)), text(bare), f"{runs:.2f}", *map(text, each)]


def medium_row(label, waves, constants, force, through, density, momentum):
    """What theory calls f/mu, eta, xi and alpha, of the medium itself, and drag by momentum over damping; mu is C66."""
    stiffness = constants["c66"]
    reach = ratio(force, (stiffness[0] * density * A**3, stiffness[1] * density * A**3))
    damping = estimate(read_json(waves, "measure")["phonons"]["drag_rate"])
    xi = ratio(stiffness, (constants["zeta"][0] * abs(through), constants["zeta"][1] * abs(through)))
    alpha = force[0] / density / A**3 * constants["zeta"][0] * abs(through) / stiffness[0]**2
    return [label, text(reach), text(estimate(read_json(waves, "measure")["phonons"]["eta"])), text(xi, digits=0), f"{alpha:.4f}", text(ratio(momentum, damping))]


def part(lab):
    at_rest = sound.run(lab)
    constants, inertia = push.constants(lab, at_rest)
    density = sound.density(at_rest)
    rows, by_mask, own_medium = [], [], []
    for speed in SPEEDS:
        label = "free" if speed is None else f"{speed:+g} mm/s"
        found, force, through = fit(lab, f"fit_{name_of(speed)}", folders(lab, speed), speed, constants, inertia, density)
        own_constants, _ = push.constants(lab, heard(lab, speed))
        own, *_ = fit(lab, f"fit_{name_of(speed)}_own", folders(lab, speed), speed, own_constants, inertia, density)
        rows.append(row(label, found, force, through, own, inertia))
        by_mask.append(mask_row(label, found, own, inertia))
        size = abs(force[0]), force[1]
        own_medium.append(medium_row(f"{label}, at rest", at_rest, constants, size, through, density, constants["zeta"]))
        momentum = combined(folders(lab, speed), "mechanics", "drag_rate")
        own_medium.append(medium_row(f"{label}, bed with this rod", heard(lab, speed), own_constants, size, through, density, momentum))
    table("Monopole over its prediction, no constant fitted", ["rod", "force, uN", "speed through the bed, a/s", "constants of the bed at rest",
          "of the bed with this rod", "at rest, bare mass", "first error: runs / held / masks", "P_xx/rho, 1e4 a^4/s^2", "P_yy/rho", "chi2 (dof)"], rows)
    table("Amplitudes over all masks: mean +- half the range; the first by mask (|y| >= strip, r >= radius; errors of the curvature alone)",
          ["rod", "at rest", "bed with this rod", "at rest, bare mass", "runs and held", *(f"{s} a, {r} a" for s, r in MASKS)], by_mask)
    table("The medium's own parameters, constants times m*", ["rod, bed", "f/C66, a", "eta", "xi, a", "alpha", "drag by momentum over damping"], own_medium)
    sound.show("Sound in these beds, times m*", [("at rest", at_rest), *(("free rod" if v is None else f"{v:+g} mm/s", heard(lab, v)) for v in SPEEDS)],
               inertia[0])
