"""Ranges of the keys, as the extremes are asked for."""

import math


def log_uniform(random_, low, high):
    return math.exp(random_.uniform(math.log(low), math.log(high)))


def either_sign(random_, low, high):
    return random_.choice((-1.0, 1.0)) * log_uniform(random_, low, high)


def coupling(random_):
    """kappa or a gamma: 1e-6 to 1e8 of either sign; one in four 0."""
    return 0.0 if random_.random() < 0.25 else either_sign(random_, 1e-6, 1e8)


def random_eta(random_):
    """1e-6 to 1e6, and (-1, 0): near both of its ends."""
    if random_.random() < 0.7:
        return log_uniform(random_, 1e-6, 1e6)
    near = log_uniform(random_, 1e-6, 0.5)
    return random_.choice((-near, near - 1.0))
