"""The body on the layer, as an FMU: `pythonfmu build -f body.py --handle-state`.

    m ü + d_x u̇ + c_x u = F_x + P_x sin(2π f t)
    m ẅ + d_z ẇ + c_z w = F_z - P_z

F_x and F_z are the forces of the layer on the body. Each is given as a value and a rate and runs linearly over the
step; with the rate 0 it is held. Spring and damper join the body to a fixed frame; w < 0 presses.
"""

from math import ceil, pi, sin

from pythonfmu import Fmi2Causality, Fmi2Slave, Fmi2Variability, Real

PARAMETERS = {
    "mass": (5e-3, "kg"),
    "stiffness_x": (5e3, "N/m"),
    "damping_x": (1.0, "N s/m"),
    "stiffness_z": (5e3, "N/m"),
    "damping_z": (1.0, "N s/m"),
    "load_x": (0.4, "N, P_x"),
    "frequency": (250.0, "Hz, f"),
    "load_z": (1.2, "N, P_z"),
    "substep": (2e-6, "s, the largest step of the Runge-Kutta method inside"),
}
INPUTS = {"F_x": "N", "F_z": "N", "F_x_rate": "N/s", "F_z_rate": "N/s"}
OUTPUTS = {"u": "m", "w": "m", "u_rate": "m/s", "w_rate": "m/s", "energy_out": "J, given off to the layer"}


class Body(Fmi2Slave):
    """A mass with two degrees of freedom."""

    description = "A body on a suspension, driven by a force"

    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        for name, (start, unit) in PARAMETERS.items():
            self.add(name, start, unit, Fmi2Causality.parameter, Fmi2Variability.fixed)
        for name, unit in INPUTS.items():
            self.add(name, 0.0, unit, Fmi2Causality.input, Fmi2Variability.continuous)
        for name, unit in OUTPUTS.items():
            self.add(name, 0.0, unit, Fmi2Causality.output, Fmi2Variability.continuous)

    def add(self, name: str, start: float, unit: str, causality, variability):
        """An attribute that is a variable of the FMU, too, and so part of its state."""
        setattr(self, name, start)
        self.register_variable(Real(name, causality=causality, variability=variability, description=unit))

    def do_step(self, current_time: float, step_size: float) -> bool:
        """Steps of the classical Runge-Kutta method, so short that their error does not count."""
        steps = ceil(step_size / self.substep)
        h = step_size / steps
        state = [self.u, self.w, self.u_rate, self.w_rate, self.energy_out]
        for i in range(steps):
            state = self.runge_kutta(current_time, i * h, h, state)
        self.u, self.w, self.u_rate, self.w_rate, self.energy_out = state
        return True

    def runge_kutta(self, start: float, since: float, h: float, y: list) -> list:
        """One step from `since` the start of the communication step."""
        k1 = self.slope(start, since, y)
        k2 = self.slope(start, since + h / 2, [a + h / 2 * b for a, b in zip(y, k1)])
        k3 = self.slope(start, since + h / 2, [a + h / 2 * b for a, b in zip(y, k2)])
        k4 = self.slope(start, since + h, [a + h * b for a, b in zip(y, k3)])
        return [a + h / 6 * (b + 2 * c + 2 * d + e) for a, b, c, d, e in zip(y, k1, k2, k3, k4)]

    def slope(self, start: float, since: float, state: list) -> tuple:
        """The derivatives of u, w, u̇, ẇ and the energy given off."""
        u, w, u_rate, w_rate, _ = state
        f_x = self.F_x + since * self.F_x_rate
        f_z = self.F_z + since * self.F_z_rate
        load_x = self.load_x * sin(2 * pi * self.frequency * (start + since))
        return (
            u_rate,
            w_rate,
            (f_x + load_x - self.stiffness_x * u - self.damping_x * u_rate) / self.mass,
            (f_z - self.load_z - self.stiffness_z * w - self.damping_z * w_rate) / self.mass,
            -(f_x * u_rate + f_z * w_rate),
        )
