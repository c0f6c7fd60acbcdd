"""Couples heated.fmu with heat.fmu over ever shorter steps and compares with the whole system solved by scipy.

    thermal.py FOLDER

Prints the largest error of the temperature over its largest rise, for each number of steps.
"""

import sys
from pathlib import Path

import numpy as np
from scipy.integrate import solve_ivp

sys.path.insert(0, str(Path(__file__).parents[3] / "scenes/coupled"))
from heat import PARAMETERS
from slaves import Slave

# The scene's numbers.
MASSES, SPACING, THICKNESS, WIDTH = 4, 1e-3, 2e-3, 1e-2
EQUILIBRIUM, VISCOSITY, PRONY = 2e6, 200.0, [(5e6, 1e-3), (8e6, 1e-4)]
C1, C2, REFERENCE = 7.52, 119.75, 293.15
DEPTH, SWING, OMEGA, DURATION = 2e-4, 1e-4, 2 * np.pi * 50.0, 0.2
CAPACITY, COOLING, AIR = (PARAMETERS[name][0] for name in ("capacity", "cooling", "air"))


def place(t):
    return -DEPTH - SWING * np.sin(OMEGA * t)


def rate(t):
    return -SWING * OMEGA * np.cos(OMEGA * t)


def monolith(times):
    """The temperature at the times: every mass stands on the plate, so a link's elongation is -w."""
    size = MASSES * SPACING * WIDTH / THICKNESS
    moduli, tau = np.array(PRONY).T

    def slope(t, state):
        temperature, y = state[0], state[1:]
        shift = 10 ** (-C1 * (temperature - REFERENCE) / (C2 + temperature - REFERENCE))
        stretch = -place(t) - y
        heat = size * ((moduli * stretch**2 / (tau * shift)).sum() + VISCOSITY * shift * rate(t) ** 2)
        return [(heat - COOLING * (temperature - AIR)) / CAPACITY, *(stretch / (tau * shift))]

    start = [AIR, *np.full(len(PRONY), -place(0.0))]
    found = solve_ivp(slope, (0.0, times[-1]), start, "LSODA", times, rtol=1e-10, atol=1e-14)
    return found.y[0]


def coupled(folder, steps):
    """The temperature at the ends of the steps: the layer steps at it, the heat it makes warms it from there on."""
    layer, heat = Slave(folder / "heated.fmu"), Slave(folder / "heat.fmu")
    layer.fmu.setupExperiment(startTime=0.0)
    layer.fmu.enterInitializationMode()
    layer.set(["w"], [place(0.0)])
    layer.fmu.setRealInputDerivatives(layer.find(["w"]), [1], [rate(0.0)])
    layer.fmu.exitInitializationMode()
    heat.start(0.0)
    times = np.linspace(0.0, DURATION, steps + 1)
    found, lost = [heat.get(["T"])[0]], 0.0
    for t, end in zip(times, times[1:]):
        h = end - t
        # The mean temperature of the step, as far as the last one tells.
        ahead = found[-1] + 0.5 * (found[-1] - found[-2]) if len(found) > 1 else found[-1]
        layer.set(["w", "temperature"], [place(t), ahead])
        layer.fmu.setRealInputDerivatives(layer.find(["w"]), [1], [(place(end) - place(t)) / h])
        layer.step(t, h)
        before, lost = lost, layer.get(["E_diss"])[0]
        heat.set(["P"], [(lost - before) / h])
        heat.step(t, h)
        found.append(heat.get(["T"])[0])
    residual, put_in = layer.get(["energy.residual", "energy.input"])
    if abs(residual) > 1e-5 * abs(put_in):
        raise SystemExit(f"the energy balance misses {residual} of {put_in} J")
    layer.close()
    heat.close()
    return np.array(found)


def main():
    folder, counts = Path(sys.argv[1]), [1000, 2000, 4000]
    reference = monolith(np.linspace(0.0, DURATION, counts[-1] + 1))
    rise = reference.max() - AIR
    print(f"rise {float(rise)!r}")
    for steps in counts:
        error = np.abs(coupled(folder, steps) - reference[:: counts[-1] // steps]).max() / rise
        print(f"{steps} {float(error)!r}")


if __name__ == "__main__":
    main()
