"""The wheel's contact in closed form, on its backing alone: how far it is pressed in, at which radius it rolls."""

import math

RADIUS, WIDTH = 0.3, 0.2
# Pa/m: the backing of tread.toml along the normal.
NORMAL = 5e7
# m: between the mean planes of tread and road under 1.5 bar, of tread.table.csv.
SEPARATION = 1.4e-4


def approach(load):
    """How far (m) the backing is pressed in under a load (N): it bears 4/3 k B a d, with a^2 = 2 R d."""
    return (3 * load / (4 * NORMAL * WIDTH * math.sqrt(2 * RADIUS))) ** (2 / 3)


def rolling_radius(load):
    """The radius (m) that rolls freely: the tread lies on a chord, and runs along it slower by the mean of the cosine."""
    return RADIUS - approach(load) / 3

