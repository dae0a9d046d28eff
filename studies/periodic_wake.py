"""The steady field of a rod in an L x L periodic box, zero Fourier mode removed (docs/physics.md), by its Fourier series: for
comparisons with measured profiles, where a thousandth is enough."""

import numpy as np

TERMS = 4000


def potential(x, y, c, box):
    """G, dG/dx and dG/dy of lap G + 2 c dG/dx = -2 pi (delta - 1/L^2), for 0 < x < L."""
    x, y = np.broadcast_arrays(np.asarray(x, dtype=float), np.asarray(y, dtype=float))
    q = 2.0 * np.pi * np.arange(1, TERMS + 1) / box
    s = np.sqrt(c * c + q * q)
    down, up = -c - s, -c + s
    xs, ys = x.reshape(-1, 1), y.reshape(-1, 1)
    strength = 2.0 * np.pi / box / (2.0 * s)
    behind = strength * np.exp(down * xs) / -np.expm1(down * box)
    ahead = strength * np.exp(up * (xs - box)) / -np.expm1(-up * box)
    wave, slope = np.cos(q * ys), -q * np.sin(q * ys)
    A = -(2.0 * np.pi / box) / -np.expm1(-2.0 * c * box)
    x0 = x.reshape(-1)
    mean = np.pi * x0 / (c * box**2) - A * np.exp(-2.0 * c * x0) / (2.0 * c) - np.pi / (2.0 * c * box) - np.pi / (2.0 * c**2 * box**2)
    mean_slope = np.pi / (c * box**2) + A * np.exp(-2.0 * c * x0)
    G = mean + 2.0 * ((behind + ahead) * wave).sum(1)
    Gx = mean_slope + 2.0 * ((down * behind + up * ahead) * wave).sum(1)
    Gy = 2.0 * ((behind + ahead) * slope).sum(1)
    return G.reshape(x.shape), Gx.reshape(x.shape), Gy.reshape(x.shape)


def field(x, y, f_over_mu, xi, eta, box):
    """U_x, U_y at places in the rod's frame; x = 0 itself is taken a little ahead of it."""
    inside = np.mod(x, box)
    inside = np.clip(inside, 1e-6 * box, (1.0 - 1e-6) * box)
    c_shear, c_long = 1.0 / (2.0 * xi), 1.0 / ((1.0 + eta) * 2.0 * xi)
    GT, GTx, GTy = potential(inside, y, c_shear, box)
    _, GLx, GLy = potential(inside, y, c_long, box)
    scale = f_over_mu / (2.0 * np.pi)
    return scale * (GT + xi * (GTx - GLx)), scale * xi * (GTy - GLy)
