"""Persson's theory of a profile with a rate-dependent shear strength, fitted by scipy.optimize.least_squares.

Writes theory.measured.csv (with 3 % of noise) and theory.fit.csv (what scipy finds) for theory.toml, in its folder. Needs
numpy and scipy. An independent program: from docs/calibrate.md and docs/model.md.
"""

from pathlib import Path
import tomllib

import numpy as np
from scipy.optimize import least_squares
from scipy.special import erf

here = Path(__file__).parent
scene = tomllib.loads((here / "theory.toml").read_text())
z = np.array(scene["surface"]["z"][:-1])
length = scene["surface"]["x"][-1]
n = len(z)
m = np.arange(1, n // 2)
q = 2 * np.pi / length * m
square = 2 * np.abs(np.fft.fft(z)[m]) ** 2 / n**2
material = scene["material"]
terms = [(term["modulus"], term["relaxation_time"]) for term in material["prony"]]
bounds = {
    "friction.rate_shear.strength": (1e4, 1e8),
    "friction.rate_shear.reference_speed": (1e-4, 10.0),
    "friction.rate_shear.sharpness": (0.05, 5.0),
    "material.equilibrium_modulus": (1e6, 1e8),
}


def friction(parameters, speed, pressure):
    strength, reference, sharpness, equilibrium = parameters
    omega = q * speed
    modulus = equilibrium + sum(e * 1j * omega * tau / (1 + 1j * omega * tau) for e, tau in terms)
    plane = modulus / (1 - material["poisson_ratio"] ** 2)
    stress = np.cumsum(square * (q / 2 * np.abs(plane)) ** 2)
    contact = erf(pressure / np.sqrt(2 * stress))
    hysteresis = np.sum(q * square * q / 2 * plane.imag * contact) / pressure
    return hysteresis + contact[-1] / pressure * strength * np.exp(-sharpness * np.log10(speed / reference) ** 2)


truth = [4e6, 0.05, 0.3, 6e6]
points = [(speed, pressure) for pressure in (1e5, 8e5, 3e6) for speed in np.geomspace(1e-3, 10.0, 8)]
random = np.random.default_rng(46)
measured = np.array([friction(truth, *point) * (1 + 0.03 * random.standard_normal()) for point in points])
sigma = np.hypot(0.05 * measured, 0.01)
low, high = np.log(np.array(list(bounds.values()))).T


def residuals(logarithms):
    return (np.array([friction(np.exp(logarithms), *point) for point in points]) - measured) / sigma


fit = least_squares(residuals, 0.5 * (low + high), bounds=(low, high), xtol=1e-15, ftol=1e-15, gtol=1e-15, jac="3-point")
rows = [f"{float(speed)!r},{pressure!r},{float(mu)!r}" for (speed, pressure), mu in zip(points, measured)]
(here / "theory.measured.csv").write_text("\n".join(["speed [m/s],pressure [Pa],friction", *rows]) + "\n")
found = [f"{key},{a!r},{b!r},{float(value)!r}" for (key, (a, b)), value in zip(bounds.items(), np.exp(fit.x))]
found = ["key,low,high,value", *found, f"chi_square,0,0,{float(2 * fit.cost)!r}"]
(here / "theory.fit.csv").write_text("\n".join(found) + "\n")
