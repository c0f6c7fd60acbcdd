"""The wheel's contact in closed form, on its backing alone: how far it is pressed in, how long it is, how it rolls."""

import math

RADIUS, WIDTH = 0.3, 0.2
# Pa/m: the backing of tread.toml.
NORMAL, SHEAR = 5e7, 8e7
# m: between the mean planes of tread and road under 1.5 bar, of tread.table.csv.
SEPARATION = 1.4e-4


def approach(load):
    """How far (m) the backing is pressed in under a load (N): it bears 4/3 k B a d, with a^2 = 2 R d."""
    return (3 * load / (4 * NORMAL * WIDTH * math.sqrt(2 * RADIUS))) ** (2 / 3)


def rolling_radius(load):
    """The radius (m) that rolls freely: the tread lies on a chord, and runs along it by the mean of the cosine slower."""
    return RADIUS - approach(load) / 3


def force(slip, load, friction):
    """The force (N) of a braked tread of one friction coefficient, after it has run through: the slip is the speed over the
    ground over that of the rolling tread, from 0."""
    half_squared = 2 * RADIUS * approach(load)
    q = min(1.0, 2 * SHEAR * half_squared * WIDTH * slip / (3 * friction * load))
    return friction * load * (3 * q - 3 * q * q + q**3)
