"""Makes the rough profiles of the scenes: periodic, self-affine, the highest point at 0.

    rough_profile.py OUT.csv LENGTH POINTS HURST RMS ROLL_OFF CUT_OFF SEED

LENGTH, RMS and the wavelengths ROLL_OFF and CUT_OFF in m. The one-sided power spectrum is constant up to
q = 2π/ROLL_OFF, falls as q^(-1-2 HURST) up to 2π/CUT_OFF and is 0 beyond; the phases are random. Heights are rounded
to 1e-10 m.
"""

import sys

import numpy as np


def rough_profile(length, points, hurst, rms, roll_off, cut_off, seed):
    """The places of the data points and their heights, the last as high as the first."""
    waves = np.arange(1, int(length / cut_off) + 1)
    amplitudes = np.sqrt(np.maximum(waves / length, 1 / roll_off) ** (-1 - 2 * hurst))
    phases = np.random.default_rng(seed).uniform(0, 2 * np.pi, len(waves))
    x = np.linspace(0, length, points + 1)
    z = (amplitudes * np.cos(2 * np.pi * np.outer(x / length, waves) + phases)).sum(axis=1)
    z[-1] = z[0]
    z *= rms / np.std(z[:-1])
    return np.round(x, 12), np.round(z - z.max(), 10)


def main():
    path, length, points, *others, seed = sys.argv[1:]
    x, z = rough_profile(float(length), int(points), *map(float, others), int(seed))
    with open(path, "w") as file:
        file.write("x [m],z [m]\n")
        file.writelines(f"{a:.12g},{b:.6g}\n" for a, b in zip(x, z))


if __name__ == "__main__":
    main()
