"""A lumped heat capacity, heated by a power and cooled by the air: `pythonfmu build -f heat.py --handle-state`.

    C Ṫ = P - h (T - T_air)

P is held over a step, so the step is exact.
"""

from math import exp

from pythonfmu import Fmi2Causality, Fmi2Slave, Fmi2Variability, Real

PARAMETERS = {"capacity": (2e-4, "J/K"), "cooling": (4e-3, "W/K"), "air": (293.15, "K")}


class Heat(Fmi2Slave):
    """The bulk temperature of the rubber."""

    description = "A heat capacity in the air"

    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        for name, (start, unit) in PARAMETERS.items():
            self.add(name, start, unit, Fmi2Causality.parameter, Fmi2Variability.fixed)
        self.add("P", 0.0, "W", Fmi2Causality.input, Fmi2Variability.continuous)
        self.add("T", 293.15, "K", Fmi2Causality.output, Fmi2Variability.continuous)

    def add(self, name: str, start: float, unit: str, causality, variability):
        """An attribute that is a variable of the FMU, too."""
        setattr(self, name, start)
        self.register_variable(Real(name, causality=causality, variability=variability, description=unit))

    def do_step(self, current_time: float, step_size: float) -> bool:
        """Towards the temperature at which the air takes what comes in."""
        balance = self.air + self.P / self.cooling
        self.T = balance + (self.T - balance) * exp(-self.cooling * step_size / self.capacity)
        return True
