"""Makes the scenes of the benchmark and their profiles: the same ones everywhere, with the standard library alone.

    scenes.py FOLDER

tread-block-*: k masses 5e-5 m apart, five Maxwell elements on the links to the carrier and two on the lateral ones,
pressed on a rough profile within 1e-3 s and slid at 1 m/s with Coulomb friction. The profile is periodic, 2e-2 m long
(8e-2 m under 800 masses), of wavelengths from 2e-2 to 2e-4 m with amplitudes falling as a power of the wave number,
rms 5e-6 m, its highest point at 0. smooth-chain-1000: pressed from the start on a profile of long waves, 2e-2 to 1.3e-3 m, and slid at
1 m/s and a swing of 0.3 m/s with little friction: every mass moves on its own and smoothly, none ever changes its mode.
"""

import argparse
import math
from pathlib import Path

# name: masses, speed of pressing in m/s, time of sliding in s, power of the amplitudes.
TREAD_BLOCKS = {
    "tread-block-50": (50, 0.010, 2e-3, -1.3),
    "tread-block-50-rough": (50, 0.010, 2e-3, -0.8),
    "tread-block-200": (200, 0.010, 2e-3, -1.3),
    "tread-block-200-rough": (200, 0.010, 2e-3, -0.8),
    "tread-block-800": (800, 0.016, 5e-4, -1.3),
}
SMOOTH_CHAIN = "smooth-chain-1000"
NAMES = [*TREAD_BLOCKS, SMOOTH_CHAIN]

SPACING = 5e-5  # m
POINT_SPACING = 1e-5  # m, of the profile
LONGEST_WAVE, WAVES = 2e-2, 100  # m; the shortest is a hundredth of it
LONG_WAVES = 15  # of the smooth chain's profile
RMS = 5e-6  # m

TO_CARRIER = [(3000.0, 1e-6), (1500.0, 1e-5), (800.0, 1e-4), (400.0, 1e-3), (200.0, 1e-2)]
LATERAL = [(200.0, 1e-5), (100.0, 1e-4)]
THREE = [(1500.0, 1e-5), (800.0, 1e-4), (400.0, 1e-3)]
THREE_LATERAL = [(300.0, 1e-5), (200.0, 1e-4), (100.0, 1e-3)]


def uniform(count):
    """Random numbers from 0 to 1: those of numpy.random.default_rng(20240), a PCG-64 (XSL-RR) from here on."""
    state, increment = 295388718667920580737395580179587812046, 49964799241825161180779864768900035845
    for _ in range(count):
        state = (state * 0x2360ED051FC65DA44385DF649FCCF645 + increment) % 2**128
        word, turn = (state >> 64 ^ state) % 2**64, state >> 122
        yield ((word >> turn | word << (64 - turn)) % 2**64 >> 11) / 2**53


def profile(masses, power, shortest=WAVES):
    """Places and heights of the profile's data points, m: rounded to 1e-12 m and 1e-13 m."""
    repeats = max(1, round(2 * SPACING * masses / LONGEST_WAVE))
    length, points = repeats * LONGEST_WAVE, 2000 * repeats
    waves = range(repeats, shortest * repeats + 1)
    waves = [(wave, (wave / repeats) ** power, 2 * math.pi * part) for wave, part in zip(waves, uniform(len(waves)))]
    x = [i * (length / points) for i in range(points)]
    z = [sum(a * math.sin(2 * math.pi * wave * place / length + phase) for wave, a, phase in waves) for place in x]
    mean = sum(z) / points
    scale = RMS / math.sqrt(sum((height - mean) ** 2 for height in z) / points)
    top = max(z)
    z = [round(scale * (height - top), 13) for height in z]
    return [*x, length], [*z, z[0]]


def link(name, stiffness, damping, elements):
    rows = ", ".join(f"{{ stiffness = {c!r}, relaxation_time = {tau!r} }}" for c, tau in elements)
    return f"[layer.{name}]\nstiffness = {stiffness!r}\ndamping = {damping!r}\nmaxwell = [{rows}]\n"


def scene(name, masses, clearance, links, rest):
    head = f"""name = "{name}"

[layer]
masses = {masses}
spacing = {SPACING!r}
clearance = {clearance!r}
mass = 1e-07
"""
    return "\n".join([head, *(link(*one) for one in links), rest])


def tread_block(name, masses, pressing, sliding):
    links = [
        ("vertical", 2000.0, 0.0085, TO_CARRIER),
        ("horizontal", 1000.0, 0.006, TO_CARRIER),
        ("lateral_x", 500.0, 0.0042, LATERAL),
        ("lateral_z", 300.0, 0.0033, LATERAL),
    ]
    rest = f"""[surface]
kind = "file"
path = "{name}.profile.csv"
periodic = true

[friction]
coulomb = 0.3

[[excitation]]
duration = 0.001
w_rate = {-pressing!r}

[[excitation]]
duration = {sliding!r}
u_rate = 1.0
"""
    return scene(name, masses, 0.0, links, rest)


def smooth_chain(name):
    links = [
        ("vertical", 2000.0, 0.0085, THREE),
        ("horizontal", 1000.0, 0.006, THREE),
        ("lateral_x", 500.0, 0.0042, THREE_LATERAL),
        ("lateral_z", 300.0, 0.0033, THREE_LATERAL),
    ]
    # So little friction that the masses, which start at the carrier's speed, never stop.
    rest = f"""[surface]
kind = "file"
path = "{name}.profile.csv"
periodic = true

[friction]
coulomb = 0.05

[[excitation]]
duration = 0.01
u_rate = 1.0
u_sine = {{ amplitude = 0.0005, frequency = 100.0 }}
"""
    return scene(name, 1000, -4e-5, links, rest)


def write_profile(path, points):
    path.write_text("x,z\n" + "".join(f"{x:.12g},{z:.12g}\n" for x, z in zip(*points)))


def write(folder):
    """Writes all scenes into `folder`."""
    folder.mkdir(parents=True, exist_ok=True)
    for name, (masses, pressing, sliding, power) in TREAD_BLOCKS.items():
        (folder / f"{name}.toml").write_text(tread_block(name, masses, pressing, sliding))
        write_profile(folder / f"{name}.profile.csv", profile(masses, power))
    (folder / f"{SMOOTH_CHAIN}.toml").write_text(smooth_chain(SMOOTH_CHAIN))
    write_profile(folder / f"{SMOOTH_CHAIN}.profile.csv", profile(1000, -1.0, LONG_WAVES))


if __name__ == "__main__":
    arguments = argparse.ArgumentParser(description="Makes the scenes of the benchmark and their profiles.")
    arguments.add_argument("folder", type=Path, metavar="FOLDER", help="where to write them")
    write(arguments.parse_args().folder)
