"""The brush model in closed form, on the parabola of pressure of a cylinder on springs, and a wheel that brakes on it."""

import math

from tread import FRICTION, SLOPE, STIFFNESS

RADIUS, WIDTH = 0.3, 0.2


def approach(load):
    """How far (m) the cylinder is pressed in under a load (N): the springs bear 4/3 k B a d, with a^2 = 2 R d."""
    return (3 * load / (4 * SLOPE * WIDTH * math.sqrt(2 * RADIUS))) ** (2 / 3)


def rolling_radius(load):
    """The radius (m) that rolls freely: the tread lies on a chord, and runs along it by the mean of the cosine slower."""
    return RADIUS - approach(load) / 3


def force(slip, load):
    """The force (N) of a braked tread; the slip is the speed over the ground over that of the rolling tread, from 0."""
    half_squared = 2 * RADIUS * approach(load)
    q = min(1.0, 2 * STIFFNESS * half_squared * WIDTH * slip / (3 * FRICTION * load))
    return FRICTION * load * (3 * q - 3 * q * q + q**3)


def stop(mass, inertia, load, speed, brake, h=2e-5):
    """The rows (time, way, speed, tread's speed) of a stop on the model's steady forces, brake the torque over time."""
    time, way, tread, radius = 0.0, 0.0, speed, rolling_radius(load)
    rows = [(time, way, speed, tread)]
    while speed > 0:
        slip = (speed - tread) / tread if tread > 0 else math.inf
        pull = math.copysign(force(abs(slip), load), slip)
        speed -= h * pull / mass
        # A brake holds a wheel that stands.
        tread = max(tread + h * radius * (radius * pull - brake(time)) / inertia, 0.0)
        way, time = way + h * speed, time + h
        rows.append((time, way, speed, tread))
    return rows
