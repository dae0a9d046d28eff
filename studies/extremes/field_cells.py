"""Cells of the field: points at every distance, in every medium, against the closed form with 40 digits or more."""

import math
import random

from mpmath import mp

from lab import SOURCE, norm_error, rows, rows_of

from .cells import Cell, log_uniform, not_finite, random_eta

COLUMNS = ("Ux", "Uy", "exx", "exy", "eyy", "lapx", "lapy", "gradx_tr", "grady_tr", "dipUx", "dipUy")
VECTORS = {"U": (0, 1), "strain": (2, 3, 3, 4), "lap u": (5, 6), "grad div u": (7, 8), "dipole": (9, 10)}
BOUND = 1e-12       # relative to the norm; studies/reports/elastic.md, "Field of one rod"
SMALLEST = 1e-290   # below it numbers lose digits to underflow
POINTS = 250        # a process


DIGITS = 80         # of the reference; up to 40 of them cancel near the rod and on its axis


def bessel_k(z):
    """K0 and K1, DLMF 10.31.1 and .2 below, 10.40.2 above; mpmath's own take the limit of a fractional order, 100 times as long."""
    if z > 1.5 * DIGITS:
        return [asymptotic(order, z) for order in (0, 1)]
    with mp.extradps(int(z) + 15): # the series cancels as exp(2 z)
        quarter, log, psi = z * z / 4, mp.log(z / 2) + mp.euler, mp.mpf(0)
        term, k0, k1, n = mp.mpf(1), mp.mpf(0), mp.mpf(0), 0
        while n < 3 or abs(term) * 10**mp.dps > 1:
            k0 += term * (psi - log)
            k1 += term / (n + 1) * (log - psi - mp.mpf(1) / (2 * (n + 1)))
            n += 1
            psi += mp.mpf(1) / n
            term *= quarter / n**2
        return k0, 1 / z + z / 2 * k1


def asymptotic(order, z):
    term, total, n = mp.mpf(1), mp.mpf(1), 0
    while abs(term) * 10**mp.dps > 1:
        n += 1
        term *= (4 * order**2 - (2 * n - 1)**2) / (8 * z * n)
        total += term
    return mp.sqrt(mp.pi / (2 * z)) * mp.exp(-z) * total


class Potential:
    """G = exp(-c x) K0(c r) and its derivatives up to the second."""

    def __init__(self, c, x, y):
        r = mp.hypot(x, y)
        (k0, k1), wave = bessel_k(c * r), mp.exp(-c * x)
        first, second = -c * k1, c * c * k0 + c * k1 / r
        kx, ky = first * x / r, first * y / r
        kxx = (second * x * x + first * y * y / r) / r**2
        kyy = (second * y * y + first * x * x / r) / r**2
        kxy = (second - first / r) * x * y / r**2
        self.g, self.x, self.y = wave * k0, wave * (kx - c * k0), wave * ky
        self.xx, self.xy, self.yy = wave * (kxx - 2 * c * kx + c * c * k0), wave * (kxy - c * ky), wave * kyy


def exact(x, y, xi, eta):
    """The columns, docs/theory.md, Eqs. 9 to 14, with DIGITS."""
    with mp.workdps(DIGITS):
        x, y, xi, eta = map(mp.mpf, (x, y, xi, eta))
        nu = 1 / (1 + eta)
        ct, cl = 1 / (2 * xi), nu / (2 * xi)
        t, l = Potential(ct, x, y), Potential(cl, x, y)
        dx, dy = xi * (t.x - l.x), xi * (t.y - l.y)
        dxx, dxy, dyy = xi * (t.xx - l.xx), xi * (t.xy - l.xy), xi * (t.yy - l.yy)
        # xi lap D = -(d_x G_T - nu d_x G_L)
        lap = (-2 * ct * t.x - (t.xx - nu * l.xx), -(t.xy - nu * l.xy))
        dipole = (-(-(dxx + t.x - nu * l.x)), -(t.y - (dxy + t.y - nu * l.y)))
        values = (t.g + dx, dy, t.x + dxx, t.y / 2 + dxy, dyy, *lap, nu * l.xx, nu * l.xy, *dipole)
        return [value / (2 * mp.pi) for value in values]


def worst(got, want):
    """Largest relative error of the vectors that are not too small, in BOUND."""
    errors = [0.0]
    for places in VECTORS.values():
        norm = mp.sqrt(sum(want[k]**2 for k in places))
        if norm > SMALLEST:
            errors.append(float(mp.sqrt(sum((mp.mpf(got[k]) - want[k])**2 for k in places)) / norm) / BOUND)
    return max(errors)


def random_point(random_, _):
    xi, r, angle = log_uniform(random_, 1e-4, 1e4), log_uniform(random_, 1e-12, 1e8), random_.uniform(-math.pi, math.pi)
    if random_.random() < 0.3: # near the axis, ahead or behind
        angle = random_.choice((0.0, math.pi)) + random_.choice((-1, 1)) * log_uniform(random_, 1e-16, 0.1)
    return r * xi * math.cos(angle), r * xi * math.sin(angle), xi, random_eta(random_)


def axis_point(random_, number):
    """Exactly on an axis."""
    r, xi, eta = log_uniform(random_, 1e-9, 1e6), log_uniform(random_, 1e-4, 1e4), random_eta(random_)
    return ((r, 0.0), (-r, 0.0), (0.0, r), (0.0, -r))[number % 4] + (xi, eta)


def far_ahead(random_, _):
    """Where the field underflows, or nearly."""
    xi = log_uniform(random_, 1e-4, 1e4)
    return log_uniform(random_, 1e2, 1e9) * xi, random_.uniform(-1.0, 1.0) * xi, xi, random_eta(random_)


def at_limits(random_, number):
    """Places and media at the ends of what doubles hold."""
    eta = (1e12, 1e-12, -1.0 + 1e-12, -1e-12, 0.0)[number % 5]
    r = (1e-99, 1e-30, 1e30, 1e150, 1e299)[number // 5 % 5]
    angle = random_.choice((0.0, 0.5 * math.pi, math.pi, 1e-8, random_.uniform(-3.0, 3.0)))
    return r * math.cos(angle), r * math.sin(angle), 1.0, eta


KINDS = {"field: anywhere": (random_point, 8000), "field: on the axes": (axis_point, 1000), "field: far ahead": (far_ahead, 1000),
         "field: ends of the doubles": (at_limits, 500)}


def evaluated(lab, points):
    text = "x,y,xi,eta\n" + "".join(",".join(map(repr, point)) + "\n" for point in points)
    return lab.run("field", "--points", "-", limit=20.0, text=text)


def judged(group, point, row, each):
    name = "x={!r} y={!r} xi={!r} eta={!r}".format(*point)
    if row is None or not_finite(",".join(row[column] for column in COLUMNS)):
        return Cell(group, name, "not finite", "bad", each)
    got = [float(row[column]) for column in COLUMNS]
    if group.endswith("doubles") or group.endswith("ahead") and abs(point[0] / point[2]) > 1e5:
        return Cell(group, name, "finite", "good", each)
    error = worst(got, exact(*point))
    return Cell(group, name, "finite", "good" if error <= 1.0 else "differs", each, error)


def points_of(lab, group, maker, count, first):
    random_ = random.Random(f"{group} {lab.seed} {first}")
    points = [maker(random_, first + k) for k in range(count)]
    done = evaluated(lab, points)
    if done.code != 0:
        status = "timeout" if done.code is None else f"unnamed: exit code {done.code}, {done.stderr[-200:]}"
        return [Cell(group, f"{count} points", status, "bad", done.seconds)]
    return [judged(group, point, row, done.seconds / count) for point, row in zip(points, rows_of(done.stdout))]


def singular(lab):
    """Places without a field are reported, one by one."""
    places = [(0.0, 0.0, 1.0, 1.0), (1e-101, 0.0, 1.0, 1.0), (1e300, 1e300, 1e-3, 1.0), (-0.0, 0.0, 1e-4, -0.5)]
    for place in places:
        done = evaluated(lab, [place])
        reported = done.code == 3 and "standard input:2:1" in done.stderr
        yield Cell("field: no field there", str(place), "no field" if reported else f"unnamed: {done.code}", "reported" if reported else "bad", done.seconds)


def boxes(lab):
    """Rods in periodic boxes, against tests/data/periodic_field.csv."""
    path = SOURCE / "tests" / "data" / "periodic_field.csv"
    want, done = rows(path), lab.run("field", "--points", path, limit=60.0)
    for one, other in zip(rows_of(done.stdout), want):
        error = max(norm_error(one, other, names) for names in (("Ux", "Uy"), ("exx", "exy", "exy", "eyy"))) / BOUND
        yield Cell("field: boxes", f"row {other}", "finite", "good" if error <= 1.0 else "differs", done.seconds / len(want), error)


def run(lab):
    for group, (maker, count) in KINDS.items():
        count, size = (20, 20) if lab.quick else (count, POINTS)
        for first in range(0, count, size):
            lab.batch(f"{group} {first}", lambda: points_of(lab, group, maker, size, first))
    lab.batch("field: no field there", lambda: singular(lab))
    lab.batch("field: boxes", lambda: boxes(lab))
