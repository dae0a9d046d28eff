"""The field of a rod that has always walked a circle in a periodic medium, and what closures make of it (docs/physics.md, section 4):
mode by mode, the circle's by its Fourier series in the heading, exact but for rounding. Reduced units, kappa's strain alone."""

import numpy as np
from scipy import special


class Modes:
    """Half of the wave vectors, of the others the conjugates: f_q over alpha, longitudinal and transverse."""

    def __init__(self, box, width, count):
        half = (count + 1) // 2 - 1
        m, n = (values.ravel() for values in np.meshgrid(np.arange(half + 1), np.arange(-half, half + 1), indexing="ij"))
        kept = (m > 0) | (n > 0)
        m, n = m[kept], n[kept]
        self.square, self.place = np.unique(m * m + n * n, return_inverse=True)
        self.unit = 2.0 * np.pi / box
        self.qx, self.qy = self.unit * m, self.unit * n
        self.q = np.hypot(self.qx, self.qy)
        self.force = np.exp(-0.5 * (width * self.q) ** 2) / box**2

    def decays(self, alpha, eta):
        return (1.0 + eta) * self.q**2 / alpha, self.q**2 / alpha

    def strain(self, amplitudes, x, y):
        """(eps_xx - eps_yy)/2 and eps_xy, which turn rods, at places x, y."""
        along, across = amplitudes
        ex, ey = self.qx / self.q, self.qy / self.q
        ux, uy = along * ex - across * ey, along * ey + across * ex
        phase = np.exp(1j * (np.outer(x, self.qx) + np.outer(y, self.qy)))
        difference, shear = 0.5j * (self.qx * ux - self.qy * uy), 0.5j * (self.qx * uy + self.qy * ux)
        return 2.0 * np.real(np.stack([phase @ difference, phase @ shear]))


def bessel(modes, rate):
    """J_k(q/rate) of each mode for k = 0 ... most; beyond, they are below 1e-16."""
    z = modes.unit * np.sqrt(modes.square) / abs(rate)
    most = int(z.max() + 16.0 * max(z.max(), 8.0) ** (1.0 / 3.0)) + 2
    return special.jv(np.arange(most + 1)[:, None], z[None, :])


def circle(modes, alpha, eta, rate, heading, table):
    """Amplitudes of a rod that turns at `rate` for ever, as seen from where it is at this heading."""
    z, psi = modes.q / rate, heading - np.arctan2(modes.qy, modes.qx)
    sign = np.sign(rate)
    decay_l, decay_t = modes.decays(alpha, eta)
    along = np.zeros(len(z), complex)
    across = np.zeros(len(z), complex)
    for k in range(len(table) - 1):
        order = (sign**k * table[k])[modes.place]  # J_k(-z) = (-1)^k J_k(z)
        slope = (sign ** (k + 1) * (0.5 * (table[k - 1] - table[k + 1]) if k else -table[1]))[modes.place]
        for turn in {k, -k}:
            parity = (-1.0) ** k if turn < 0 else 1.0
            phase = parity * np.exp(-1j * turn * psi)
            along += turn / z * order * phase / (decay_l - 1j * turn * rate)
            across += 1j * slope * phase / (decay_t - 1j * turn * rate)
    back = np.exp(1j * z * np.sin(psi)) * modes.force / alpha  # to the rod's place
    return along * back, across * back


def closures(modes, alpha, eta, heading):
    """Amplitudes of the steady field and of what a unit of turning rate adds in first order (models/medium/turning_wake.cpp)."""
    nx, ny = np.cos(heading), np.sin(heading)
    q_along, q_across = modes.qx * nx + modes.qy * ny, modes.qy * nx - modes.qx * ny
    along, across = q_along / modes.q, q_across / modes.q
    steady, first = [], []
    for decay, heading_part, turned_part in zip(modes.decays(alpha, eta), (along, -across), (across, along)):
        z = decay - 1j * q_along
        steady.append(modes.force / alpha * heading_part / z)
        first.append(-modes.force / alpha * (turned_part + 1j * q_across * heading_part / z) / z**2)
    return steady, first


def errors(modes, alpha, eta, rate, heading, distances, table, directions=24):
    """[(steady, first order, rate of memory)] by distance: root mean square errors of the strain over that of the exact one around the
    rod, and the size of what a unit of turning rate adds over the steady strain, f/(mu v0)."""
    steady, first = closures(modes, alpha, eta, heading)
    exact = circle(modes, alpha, eta, rate, heading, table)
    angles = 2.0 * np.pi * np.arange(directions) / directions
    found = []
    for r in distances:
        x, y = r * np.cos(angles), r * np.sin(angles)
        truth, zeroth, added = (modes.strain(field, x, y) for field in (exact, steady, first))
        size = np.sqrt((truth**2).sum())
        found.append((np.sqrt(((zeroth - truth) ** 2).sum()) / size, np.sqrt(((zeroth + rate * added - truth) ** 2).sum()) / size,
                      np.sqrt((added**2).sum() / (zeroth**2).sum())))
    return found
