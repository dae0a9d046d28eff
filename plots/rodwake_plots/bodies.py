"""Bodies of the theory's rods to scale: rows of discs, as [body] of the scene has them."""

import numpy as np
from matplotlib.collections import EllipseCollection

SHAPE = ("spheres", "length", "thick_diameter", "thin_diameter")


def has_bodies(run):
    return "body" in run.scene or any("body" in rod for rod in run.scene.get("rods", ()))


def reach(run):
    """Half the length of the longest body, in reduced units; 0 without bodies."""
    shapes = [one["body"] for one in (run.scene, *run.scene.get("rods", ())) if "body" in one]
    return max((shape["length"] for shape in shapes), default=0.0) / 2


def discs(run, rod):
    """Places along the rod from its centre, + ahead, and radii, in reduced units."""
    own = (run.scene.get("rods") or [{}])[rod % len(run.scene.get("rods") or [{}])].get("body") if "rods_random" not in run.scene else None
    count, length, thick, thin = ((own or run.scene["body"])[name] for name in SHAPE)
    share = np.linspace(0, 1, count) if count > 1 else np.array([0.5])
    return (share - 0.5) * (length - (thick + thin) / 2), thick / 2 + share * (thin - thick) / 2


def centres(run, x, y, theta):
    """(x, y) of all discs of all rods, at (N,) poses in reduced units."""
    rows = [discs(run, rod)[0] for rod in range(len(x))]
    return np.concatenate([np.column_stack([x[rod] + row * np.cos(theta[rod]), y[rod] + row * np.sin(theta[rod])])
                           for rod, row in enumerate(rows)])


def add(axes, run, x, y, theta, factor, colours, **look):
    """Discs of rods at (N,) poses, scaled by `factor`, a colour a rod; the collection, whose offsets are centres()."""
    found = [discs(run, rod)[1] for rod in range(len(x))]
    widths = 2 * factor * np.concatenate(found)
    colours = np.repeat(np.asarray(colours), [len(one) for one in found], axis=0)
    made = EllipseCollection(widths, widths, np.zeros(len(widths)), units="xy", offsets=factor * centres(run, x, y, theta),
                             offset_transform=axes.transData, facecolors=colours, **look)
    axes.add_collection(made, autolim=False)
    return made
