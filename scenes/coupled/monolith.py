"""The same system solved as one: the body's two equations added to the layers', by scipy.

Independent of the FMUs: the equations are those of the documentation, for a scene without friction whose masses never
leave the profile. A mass then has one coordinate, its place x, and the body's load reaches it through the links alone.
"""

import tomllib
from pathlib import Path

import numpy as np
from scipy.integrate import solve_ivp
from scipy.interpolate import CubicSpline

# The error allowed in a speed over that in a place, 1/s: masses this light have speeds that matter little.
SPEED = 1e3
KINDS = ("vertical", "horizontal", "lateral_x", "lateral_z")


class Link:
    """The links of a kind: a spring, a damper and Maxwell elements in parallel."""

    def __init__(self, table: dict, count: int):
        self.stiffness, self.damping = table.get("stiffness", 0.0), table.get("damping", 0.0)
        elements = table.get("maxwell", [])
        self.c = np.array([[element["stiffness"]] for element in elements]).reshape(-1, 1)
        self.tau = np.array([[element["relaxation_time"]] for element in elements]).reshape(-1, 1)
        self.count, self.states = count, len(elements) * count

    def force(self, e, e_rate, y):
        """The forces, and the rates of the dashpots' displacements y."""
        y = y.reshape(-1, self.count)
        stretch = e - y
        force = self.stiffness * e + self.damping * e_rate + (self.c * stretch).sum(axis=0)
        return force, (stretch / self.tau).ravel()


class Layer:
    """The layer of a scene: masses that stay on the profile."""

    def __init__(self, scene: dict):
        layer, surface = scene["layer"], scene["surface"]
        self.count, self.mass = layer["masses"], layer["mass"]
        self.rest_x = layer.get("origin", 0.0) + layer["spacing"] * np.arange(self.count)
        self.rest_z = layer.get("clearance", 0.0)
        lateral = self.count - 1
        counts = (self.count, self.count, lateral, lateral)
        self.links = [Link(layer.get(kind, {}), count) for kind, count in zip(KINDS, counts)]
        self.profile = profile(surface)
        dashpots = sum(link.states for link in self.links)
        self.scale = np.concatenate([np.full(self.count, 1.0), np.full(self.count, SPEED), np.full(dashpots, 1.0)])

    def start(self) -> np.ndarray:
        """Masses on the profile below their rest places, at rest, dashpots relaxed."""
        e = self.elongations(self.rest_x, np.zeros(2))
        dashpots = [np.tile(e, link.states // link.count) for link, e in zip(self.links, e)]
        return np.concatenate([self.rest_x, np.zeros(self.count), *dashpots])

    def elongations(self, x, place) -> tuple:
        u, w = place
        xi, zeta = x - self.rest_x, self.profile(x) - self.rest_z
        return zeta - w, xi - u, np.diff(xi), np.diff(zeta)

    def slope(self, state, place, speed) -> tuple:
        """The rates of the state, the force on the body and the least contact force."""
        x, v = state[: self.count], state[self.count : 2 * self.count]
        s, kappa = self.profile(x, 1), self.profile(x, 2)
        rates = (s * v - speed[1], v - speed[0], np.diff(v), np.diff(s * v))
        ends = 2 * self.count + np.cumsum([link.states for link in self.links])
        dashpots = np.split(state, [2 * self.count, *ends])[1:-1]
        parts = zip(self.links, self.elongations(x, place), rates, dashpots)
        forces, y_rates = zip(*(link.force(e, e_rate, y) for link, e, e_rate, y in parts))
        f_z, f_x = (on_masses(along, lateral) for along, lateral in zip(forces[:2], (forces[3], forces[2])))
        # m q² ẍ + m s κ ẋ² = f_x + s f_z, with q² = 1 + s²
        a = (f_x + s * f_z - self.mass * s * kappa * v**2) / (self.mass * (1 + s**2))
        contact = (self.mass * kappa * v**2 - f_z + s * f_x) / np.sqrt(1 + s**2)
        on_body = np.array([forces[1].sum(), forces[0].sum()])
        return np.concatenate([v, a, *y_rates]), on_body, contact.min()


def on_masses(along, lateral):
    """The force of the links on the masses: (3) and (4)."""
    return -along + np.append(lateral, 0.0) - np.insert(lateral, 0, 0.0)


def profile(surface: dict) -> CubicSpline:
    """The periodic spline through a sine, 64 points a period."""
    phase = np.linspace(0, 1, 65)
    z = surface["amplitude"] * np.sin(2 * np.pi * phase)
    z[-1] = z[0]
    return CubicSpline(surface["wavelength"] * phase, z, bc_type="periodic")


def integrate(slope, span, start, scale, tolerance, times=None):
    """The light masses make the equations stiff."""
    solution = solve_ivp(slope, span, start, "Radau", times, rtol=tolerance, atol=1e-4 * tolerance * scale)
    if not solution.success:
        raise RuntimeError(solution.message)
    return solution


class System:
    """The body and the layers, each below it or mirrored above it."""

    def __init__(self, scene: Path, mirrored: list, body: dict):
        self.layer = Layer(tomllib.loads(scene.read_text()))
        self.signs = [np.array([1.0, -1.0 if above else 1.0]) for above in mirrored]
        self.body = body

    def solve(self, settle: float, times: np.ndarray, tolerance: float) -> np.ndarray:
        """u and w at the times, the layers having settled under the body at 0."""
        settled = self.settle(settle, tolerance)
        start = np.concatenate([np.zeros(4), *[settled for _ in self.signs]])
        scale = np.concatenate([[1.0, 1.0, SPEED, SPEED], *[self.layer.scale for _ in self.signs]])
        solution = integrate(self.slope, (0.0, times[-1]), start, scale, tolerance, times)
        contact = min(self.contact(y) for y in solution.y.T)
        if contact <= 0:
            raise RuntimeError(f"a mass has left the profile: contact force {contact} N")
        return solution.y[:2].T

    def settle(self, duration: float, tolerance: float) -> np.ndarray:
        """The state of a layer under a body that has stood at 0 for some time."""
        still = np.zeros(2)

        def slope(_, y):
            return self.layer.slope(y, still, still)[0]

        return integrate(slope, (-duration, 0.0), self.layer.start(), self.layer.scale, tolerance).y[:, -1]

    def layers(self, y):
        """Each layer's part of the state, with its sign."""
        return zip(np.split(y[4:], len(self.signs)), self.signs)

    def contact(self, y) -> float:
        return min(self.layer.slope(part, sign * y[:2], sign * y[2:4])[2] for part, sign in self.layers(y))

    def slope(self, time, y):
        b, place, speed = self.body, y[:2], y[2:4]
        parts = [self.layer.slope(part, sign * place, sign * speed) for part, sign in self.layers(y)]
        force = sum(sign * found[1] for found, sign in zip(parts, self.signs))
        load = np.array([b["load_x"] * np.sin(2 * np.pi * b["frequency"] * time), -b["load_z"]])
        stiffness, damping = ([b[f"{name}_{axis}"] for axis in "xz"] for name in ("stiffness", "damping"))
        a = (force + load - np.multiply(stiffness, place) - np.multiply(damping, speed)) / b["mass"]
        return np.concatenate([speed, a, *[found[0] for found in parts]])
