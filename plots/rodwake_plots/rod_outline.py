"""The rod on paper to scale, as in the frame that moves with it: centre of mass at the origin, thin end towards +x. In a bed without
rods the force from which was measured: a circle of its width."""

import numpy as np

from . import style, words

USUAL = {"motile": (1.1e-3, 12), "apolar": (0.95e-3, 13)}  # thick diameter in m, spheres
FINE = 1200


def outline(run):
    """(x, half width) of the row of spheres in bead radii, thick end first; of the rod in whose frame was measured."""
    a = run.granular.a
    if who(run) == "force":
        width = number(run.scene["granular"]["body_force"], "width", a) / a
        x = np.linspace(-width, width, FINE)
        return x, np.sqrt(width**2 - x**2)
    centres, radii = row(rod_of(run.scene))
    x = np.linspace(centres[0] - radii[0], centres[-1] + radii[-1], FINE)
    square = (radii[:, None] ** 2 - (x - centres[:, None]) ** 2).max(axis=0).clip(0)
    middle = (x * square).sum() / square.sum()  # of the solid of revolution
    return (x - middle) / a, np.sqrt(square) / a


def who(run):
    """In whose frame was measured."""
    bed = run.scene.get("granular", {})
    return "force" if not bed.get("rods") and "body_force" in bed else "rod"


def shaded(run):
    return "the rod's body" if who(run) == "rod" else "one width of the force to each side"


def rod_of(scene):
    rods = scene.get("granular", {}).get("rods", [])
    number = scene.get("measure", {}).get("rod", 0)
    return rods[number] if isinstance(number, int) and 0 <= number < len(rods) else {}


def row(rod):
    """Centres along the axis and radii, m."""
    apolar = rod.get("kind") == "apolar"
    thick, count = USUAL["apolar" if apolar else "motile"]
    thick, thin = number(rod, "thick_diameter", thick), number(rod, "thin_diameter", 0.8e-3)
    length, count = number(rod, "length", 4.5e-3), int(number(rod, "spheres", count))
    place = np.linspace(0, 1, count) if count > 1 else np.array([0.5])
    first, last = (thin if apolar else thick) / 2, length - thin / 2
    return first + (last - first) * place, (thick + (thin - thick) * taper(rod, place, apolar)) / 2


def taper(rod, place, apolar):
    """0 where thick, 1 where thin."""
    part = abs(2 * place - 1) if apolar else place
    if rod.get("taper") != "stepwise":
        return part
    segments, count = int(number(rod, "segments", 4)), len(place)
    places = (count + 1) // 2 if apolar else count
    step = np.rint(part * (places - 1)) * segments // places
    return step / max(segments - 1, 1)


def number(rod, key, usual):
    value = rod.get(key)
    return value if words.is_number(value) else usual


def draw(axes, run, **look):
    x, half = outline(run)
    look = dict(facecolor="white", edgecolor="black", linewidth=0.9, zorder=5) | look
    axes.fill(np.concatenate([x, x[::-1]]), np.concatenate([half, -half[::-1]]), **look)


def shade(axes, run, along):
    """The stretch of a line that the rod's body covers."""
    x, half = outline(run)
    low, high = (x[0], x[-1]) if along == "x" else (-np.interp(0.0, x, half), np.interp(0.0, x, half))
    axes.axvspan(low, high, color="#e6e6e2", linewidth=0, zorder=0)
    axes.annotate(who(run), ((low + high) / 2, 0.02), xycoords=axes.get_xaxis_transform(), ha="center", va="bottom", fontsize=8.5,
                  color=style.GREY)
