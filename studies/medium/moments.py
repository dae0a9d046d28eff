"""Is what the rod does to the bed near it compact? Maps of `monopole` and `scaling`, fitted with dipoles and with second moments too.

A compact zone around the rod is seen from outside through the moments of its forces alone. If dipoles and second moments are enough
beyond the first mask, the amplitude does not depend on the mask, chi2 is that of the runs' scatter, and the drag that fits is the
measured one. q_yxy is held at 0: outside the rod only two combinations of the three second moments show (elastic/anisotropic.hpp).
Moments beyond the second only in the mean map of the runs, where NumPy fits them. Made up: a map whose drag is that of a push and whose
moments are those of the highest order fitted; if fewer orders find in it the drag and amplitude that they find in the data, nothing but
the moments they leave out is behind these.
"""

import copy
import math
from dataclasses import dataclass

import numpy as np

from lab import table, text

from . import monopole, push, scaling, sound, spread
from .bed import A

ORDERS = (("dipoles", "", monopole.MONOPOLE), ("and second moments", "_second", ("amplitude", "p_xx", "p_yy", "q_xxx", "q_xyy", "offset")))
INDEPENDENT_SPACING = 4.2  # a, as in monopole.scene
HIGHEST = 4                # order of the expansion in the second table
RADII = (10.0, 15.0, 20.0, 25.0, 30.0)  # a
UNIT = 10.0                # a: moments of order n are given over f UNIT^n


@dataclass
class Case:
    """Runs alike, the medium around them, and the names of their fits."""

    label: str
    name: str
    folders: list
    speed: float  # mm/s; None: free
    medium: tuple  # constants, inertia, density
    spacing: float  # a, of the bins, which is the source's width
    stirred: tuple = ()  # the medium with this rod in it, where it was heard

    def independent(self):
        """Values that a bin is worth."""
        return min(1.0, (self.spacing / INDEPENDENT_SPACING) ** 2)


def cost():
    return monopole.cost() + scaling.cost(155)


def medium_of(lab, *name, **keys):
    waves = sound.run(lab, *name, **keys)
    return *push.constants(lab, waves), sound.density(waves)


def small_cases(lab):
    medium = medium_of(lab)
    return [Case("free" if speed is None else f"{speed:+g} mm/s", f"fit_{monopole.name_of(speed)}", monopole.folders(lab, speed), speed, medium, 1.0,
                 (*push.constants(lab, monopole.heard(lab, speed)), medium[2])) for speed in monopole.SPEEDS]


def large_cases(lab):
    medium = medium_of(lab, "sound_155", seconds=scaling.SOUND_SECONDS, runs=1, box="fit 155 a")
    return [Case(f"{label} a/s", f"fit_155_{label}", scaling.case_folders(lab, 155, variant), float(label) * 0.4, medium, scaling.SPACING[155])
            for variant, label in scaling.CASES]


def over_force(found, name, force, density):
    """A moment over the force, as a rod that walks along +x would have it, with the jackknife's error, in a or a^2."""
    size = force[0] / density / A**3
    size = abs(size) if name.startswith("p_") else size  # seen from behind a dipole is itself, force and second moments change sign
    one = found["systematics"]["errors"][name]
    return one["value"] / size, abs((one["jackknife"] or math.nan) / size)


def scatter(maps, independent):
    """chi2 of the runs' maps about their mean, bin by bin, and its degrees of freedom: what no model can fit. fit_map files have
    sigmas that are enlarged for bins that share data."""
    kept = np.all([one["used"] > 0 for one in maps], axis=0)
    chi2 = 0.0
    for c in "xy":
        values, sigmas = (np.array([one[name + c][kept] for one in maps]) for name in ("U", "sigma_"))
        weights = sigmas**-2
        mean = (weights * values).sum(axis=0) / weights.sum(axis=0)
        chi2 += (weights * (values - mean) ** 2).sum()
    return chi2, independent * 2 * kept.sum() * (len(maps) - 1)


def row(lab, case, order):
    title, suffix, parameters = order
    constants, inertia, density = case.medium
    found, force, through = monopole.fit(lab, case.name + suffix, case.folders, case.speed, *case.medium, case.spacing, parameters)
    drag = scaling.fitted_drag(lab, case.name + suffix, case.folders, through, constants, inertia, force, density, case.spacing, parameters)
    value, half_range = monopole.over_masks(found)
    runs = found["systematics"]["errors"]["amplitude"]["jackknife"] or math.nan
    maps = [scaling.columns(lab.folder / (case.name + suffix) / f"fit_map_{k}.csv") for k in range(len(case.folders))]
    rest, rest_dof = scatter(maps, case.independent())
    moments = [text(over_force(found, name, force, density), digits=0) if name in parameters else "-" for name in ("p_xx", "p_yy", "q_xxx", "q_xyy")]
    return [case.label, title, text((value, half_range)), text((found["systematics"]["errors"]["amplitude"]["value"], runs)),
            f"{found['chi2']:.0f} ({found['dof']})", f"{rest:.0f} ({rest_dof:.0f})", text(drag, digits=1), *moments]


def sources(medium, force, order):
    """Fields of the predicted force and of its moments up to an order, over the force and UNIT^n."""
    half = monopole.ROD_LENGTH / 2
    moments = [medium.dipoles(), *(medium.moments(n) for n in range(2, order + 1))]
    return [force * medium.line(-half, half), *(force * UNIT ** (n + 1) * one for n, pair in enumerate(moments) for one in pair)]


class Mean:
    """Fits to the mean map of runs alike, at three drags: none, that of a push, and twice that."""

    def __init__(self, found, medium_of_drag, drag, force, independent):
        self.found, self.independent = np.array(found), independent
        self.drags = np.array([0.0, drag, 2 * drag])
        self.fields = [sources(medium_of_drag(one), force, HIGHEST) for one in self.drags]

    def fit(self, order, at=1, keep=slice(None), mask=monopole.MASKS[0]):
        """At one of the three drags: as spread.Data.fit, of the force and its moments up to an order."""
        return spread.Data(list(self.found[keep]), mask, self.independent).fit(self.fields[at][:1 + 2 * order])

    def parabola(self, order, keep=slice(None), mask=monopole.MASKS[0]):
        """chi2 at the three drags."""
        return [self.fit(order, at, keep, mask)[1] for at in range(3)]

    def with_error(self, function):
        """Of all runs, and the jackknife's error."""
        return function(slice(None)), scaling.leave_one_out(function, len(self.found))

    def drag(self, order, mask=monopole.MASKS[0]):
        """Where the parabola through chi2 at the three drags is least."""
        return self.with_error(lambda keep: scaling.vertex(self.drags, self.parabola(order, keep, mask)))

    def gain(self, order):
        """chi2 at the drag of a push less that at the drag that fits."""
        chi2 = self.parabola(order)
        a, b, c = np.polyfit(self.drags, chi2, 2)
        return chi2[1] - (c - b**2 / (4 * a))

    def amplitude(self, order, mask=monopole.MASKS[0]):
        return self.with_error(lambda keep: self.fit(order, 1, keep, mask)[0][0])

    def made_up(self):
        """The field that the highest order fits at the drag of a push, in place of the data."""
        Ux, Uy = sum(strength * field for strength, field in zip(self.fit(HIGHEST)[0][:-1], self.fields[1]))
        other = copy.copy(self)
        other.found = np.array([one | {"Ux": Ux, "Uy": Uy} for one in self.found])
        return other

    def over_masks(self, order):
        return [self.fit(order, mask=mask)[0][0] for mask in monopole.MASKS]


def mean_of(case, medium):
    constants, inertia, density = medium
    found = spread.maps(case.folders)
    force, through = monopole.signed(case.folders, case.speed)
    elastic = [constants[name][0] for name in ("c11", "c22", "c12", "c66")]

    def medium_of_drag(drag):
        return spread.Medium(found[0]["x"], found[0]["y"], elastic, drag, inertia[0], 0.0, through, case.spacing)
    return Mean(found, medium_of_drag, constants["zeta"][0], force[0] / density / A**3, case.independent())


def over(values):
    return text((np.mean(values), np.ptp(values) / 2))


def order_rows(case):
    mean, stirred = (mean_of(case, medium) if medium else None for medium in (case.medium, case.stirred))
    for order in range(1, HIGHEST + 1):
        best, chi2, dof = mean.fit(order)
        yield [case.label, order, over(mean.over_masks(order)), f"{mean.amplitude(order)[1]:.2f}", over(stirred.over_masks(order)) if stirred else "-",
               f"{chi2:.0f} ({dof:.0f})", text(mean.drag(order), digits=0), f"{mean.gain(order):.0f}", ", ".join(f"{one:.1f}" for one in best[1:-1])]


def radius_rows(case):
    """What moments that are left out add falls with the distance: amplitude, drag and chi2 beyond each radius; and what they add to a
    made-up map."""
    mean = mean_of(case, case.medium)
    for label, of, orders in ((case.label, mean, (1, 2, HIGHEST)), (f"{case.label}, made up", mean.made_up(), (1, 2))):
        for order in orders:
            yield [label, order, *(beyond(of, order, (monopole.MASKS[0][0], radius)) for radius in RADII)]


def beyond(mean, order, mask):
    _, chi2, dof = mean.fit(order, mask=mask)
    return f"{text(mean.amplitude(order, mask))}; {text(mean.drag(order, mask), digits=0)} ({chi2 / dof:.2f})"


def part(lab):
    for size, cases in ((78, small_cases(lab)), (155, large_cases(lab))):
        rows = [row(lab, case, order) for case in cases for order in ORDERS]
        table(f"Dipoles and second moments, box of {size} a", ["rod", "moments", "amplitude, mean of all masks +- half the range",
              "of the first mask +- runs", "chi2 (dof)", "of it the runs about their mean", "drag that fits, 1/s", "P_xx/f, a", "P_yy/f, a",
              "Q_xxx/f, a^2", "Q_xyy/f, a^2"], rows)
        table(f"Mean map of the runs by the highest order of moments, box of {size} a", ["rod", "order", "amplitude, mean of all masks +- half the range",
              "error of the runs", "the same with the constants of the bed with this rod", "chi2 (dof)", "drag that fits, 1/s",
              "chi2 gained by it", f"moments over f ({UNIT:g} a)^n"], [one for case in cases for one in order_rows(case)])
        table(f"Beyond a radius and |y| > {monopole.MASKS[0][0]} a: amplitude; drag that fits, 1/s (chi2 per degree of freedom), box of {size} a",
              ["rod", "order", *(f"{radius:g} a" for radius in RADII)], [one for case in cases for one in radius_rows(case)])
