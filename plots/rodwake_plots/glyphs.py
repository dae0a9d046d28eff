"""The rod: tapered, thin end forward, as in the experiments. Sizes are in points, so zooming does not change them."""

import numpy as np
from matplotlib.markers import MarkerStyle
from matplotlib.path import Path
from matplotlib.transforms import Affine2D

# Along +x, unit length, thick tail, thin rounded nose.
OUTLINE = np.array([(-0.5, -0.19), (0.40, -0.09), (0.5, 0.0), (0.40, 0.09), (-0.5, 0.19), (-0.5, -0.19)])


def rod(axes, x, y, theta, length=11, **look):
    """One rod at (x, y); `look` goes to scatter (facecolor, edgecolor, linewidth, zorder)."""
    turned = Affine2D().rotate(theta).transform(OUTLINE)
    # scatter scales a custom path by its largest coordinate, which depends on the turn: undo that.
    reach = 2 * np.abs(turned).max()
    marker = MarkerStyle(Path(turned, closed=True))
    axes.scatter([x], [y], s=(length * reach) ** 2, marker=marker, **look)


def at_origin(axes, length=15):
    rod(axes, 0, 0, 0, length, facecolor="white", edgecolor="black", linewidth=0.9, zorder=6)
