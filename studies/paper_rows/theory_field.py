"""The field of one rod: the paper's solution, its limits, its figures."""

import h5py
import numpy as np
from mpmath import besselk, diff, exp, mp, mpf, pi, sqrt

from . import judge, results
from .entry import Row, Run, Subject

UFIELD = Run("ufield", "ufield.toml")
TAIL = Run("wake_tail", "wake_tail.toml")
MAP = Run("attraction", "attraction.toml")
POLAR = Run("sup_ufield", "sup_ufield.toml")
ETA, XI = 1.3, 10  # of ufield.toml: alpha = 0.1
HALF_BOX = 39 / 2.2  # f/mu, with the paper's f/mu = 2.2 a
DIGITS = 30


def printed(x, y, xi, eta, nu):
    """The paper's Eq. (20), in f/mu."""
    r, a, b = sqrt(x * x + y * y), 1 / (2 * mpf(xi)), mpf(nu) / (2 * mpf(xi))
    wave, slow = exp(-a * x), exp(-b * x)
    ux = (besselk(0, a * r) - x / r * besselk(1, a * r)) * wave + nu * (besselk(0, b * r) + x / r * besselk(1, b * r)) * slow
    uy = y / r * (nu * besselk(1, b * r) * slow - besselk(1, a * r) * wave)
    return ux / (4 * pi), uy / (4 * pi)


def residual(nu, x=mpf(-3), y=mpf(2), xi=mpf(2), eta=mpf("1.3")):
    """What Eq. (20) leaves of the x component of Eq. (17) beside the rod, over its largest term."""
    ux, uy = (lambda u, v, n=n: printed(u, v, xi, eta, nu)[n] for n in (0, 1))
    terms = (-diff(ux, (x, y), (1, 0)) / xi, -diff(ux, (x, y), (2, 0)), -diff(ux, (x, y), (0, 2)),
             -eta * diff(ux, (x, y), (2, 0)), -eta * diff(uy, (x, y), (1, 1)))
    return float(abs(sum(terms)) / max(map(abs, terms)))


def nu_as_printed():
    with mp.workdps(DIGITS):
        eta = mpf("1.3")
        wrong, right = residual(1 + 1 / eta), residual(1 / (1 + eta))
    return judge.holds(wrong < 1e-6, f"ν = 1/(1 + η): residual {right:.0e} of the terms; the printed one leaves {wrong:.2f}")


def solution(folder):
    """rodwake's field against the printed formula with nu = 1/(1 + eta)."""
    worst = 0.0
    with mp.workdps(DIGITS):
        for cut, y in ((0, 0.0), (1, 1.8)):
            for x, ux, uy in zip(*(column[40::160] for column in results.columns(folder / f"field_cut_{cut}.csv", "x", "Ux", "Uy"))):
                u, v = printed(mpf(float(x)), mpf(y), XI, mpf("1.3"), 1 / mpf("2.3"))
                worst = max(worst, float(abs(u - float(ux)) + abs(v - float(uy))) / float(sqrt(u * u + v * v)))
    return judge.holds(worst < 1e-12, f"largest relative difference {worst:.0e} at 10 points")


def slope(x, u):
    return np.polyfit(x, u, 1)[0]


def behind(folder):
    x, u = results.columns(folder / "field_cut_0.csv", "x", "Ux")
    far = x < -500.0
    power = slope(np.log(-x[far]), np.log(u[far]))
    return judge.holds(abs(power + 0.5) < 0.005, f"power {power:.4f} from 500 to 1000 ξ behind", f"{power + 0.5:+.4f}")


def ahead(folder):
    x, u = results.columns(folder / "field_cut_1.csv", "x", "Ux")
    rate = -slope(x, np.log(np.sqrt(x) * u))
    nu = 1.0 / (1.0 + ETA)
    return judge.holds(abs(rate / nu - 1) < 0.05, f"exp(-{rate:.3f} x/ξ)/√x from 10 to 40 ξ ahead (theory: ν = {nu:.3f})")


def fore_aft(folder):
    x, u = results.columns(folder / "field_cut_0.csv", "x", "Ux")
    back, front = (float(np.interp(place, x, u)) for place in (-8.0, 8.0))
    return judge.holds(front < back, f"U_x(8) / U_x(-8) = {front / back:.2f} (positions in f/μ)")


def changes_sign(folder):
    x, u = results.columns(folder / "field_cut_1.csv", "x", "Uy")
    place = float(x[1:][(u[1:] > 0) & (u[:-1] <= 0)][0])
    return judge.holds(abs(place) < 1.0 and u[0] < 0 < u[-1], f"U_y from {np.nanmin(u):.3f} to {np.nanmax(u):+.3f} f/μ, zero at x = {place:.2f} f/μ")


def flat(folder):
    x, u = results.columns(folder / "field_cut_2.csv", "x", "Ux")
    inside = (x >= -HALF_BOX) & (x <= -5.0)
    scaled = np.sqrt(-x[inside]) * u[inside]
    change = scaled.max() / scaled.min() - 1.0
    return judge.holds(change < 0.1, f"it changes by {100 * change:.0f} % from 5 to {HALF_BOX:.0f} f/μ behind", "criterion: below 10 %")


def axis_turns_together(folder):
    with h5py.File(folder / "result.h5") as file:
        grid = file["field/grid"]
        x, y, shear = (grid[name][...] for name in ("x", "y", "exy"))
    beside = shear[y > 0.5, np.argmin(np.abs(x))]
    return judge.holds(bool(np.all(beside < 0)), f"ε_xy from {beside.min():.3f} to {beside.max():.4f} beside the rod, y from 0.5 to 5 f/μ: "
                       "the axis leans towards it on both sides")


def varies_faster(folder, _):
    with h5py.File(folder / "result.h5") as file:
        grid = file["field/grid"]
        x, y, shear, lx, ly = (grid[name][...] for name in ("x", "y", "exy", "lapx", "lapy"))
    column, rows = np.argmin(np.abs(x)), (y > 0.4) & (y < 4.0)
    powers = [slope(np.log(y[rows]), np.log(np.abs(field[rows, column]))) for field in (shear, np.hypot(lx, ly))]
    return judge.holds(powers[1] < powers[0] - 0.5, f"beside the rod ε_xy falls as y^{powers[0]:.1f}, |∇²u| as y^{powers[1]:.1f}")


FIELD = Subject("Theory: the field of one rod", (
    Row("uxuy", "Eq. (20)", "U of one rod in closed form", solution, (UFIELD,)),
    Row("nu", "text below Eq. (19)", "ν = 1 + η⁻¹", nu_as_printed,
        why="A misprint: only ν = 1/(1 + η) solves the paper's own Eq. (17) (docs/theory.md, section 5)."),
    Row("tail", "abstract; text at Fig. 6", "U_x falls as |x|^(-1/2) behind the rod", behind, (TAIL,), ("tail",)),
    Row("screened", "text at Fig. 6", "exponential decay ahead of the rod", ahead, (TAIL,), ("ahead",)),
    Row("ufield_b", "Fig. 6 (b)", "U_x(x, 0) decays rapidly for x > 0 compared to x < 0", fore_aft, (UFIELD,), ("ufield_b",)),
    Row("ufield_d", "Fig. 6 (d)", "U_y beside the rod changes sign as x goes through 0", changes_sign, (UFIELD,), ("ufield_d",)),
    Row("ufield_e_theory", "Fig. 6 (e), theory", "|x|^(1/2) U_x is constant for x < 0 (with the paper's values, inside its box)", flat,
        (UFIELD,), ("ufield_e",), "The power law is approached only some ξ = 22 a behind the rod, and half of the paper's box is 39 a."),
    Row("attraction_a", "Fig. 9 (a)", "two rods separated only along y each turn the other along the extensional axis, towards itself",
        axis_turns_together, (MAP,), ("attraction_a",)),
    Row("sup_ufield", "Fig. 10", "γ₁, γ₂ give more complex and rapid spatial variation than the strain-aligning κ term", varies_faster,
        (MAP, POLAR), ("sup_ufield",)),
))
