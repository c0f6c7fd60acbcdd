"""The largest amplitude over frequency against the load, beside one harmonic of a Jenkins element.

    damper.py ASPERITY FOLDER [--loads 0.01,0.02,...]

ASPERITY is the program. FOLDER gets damper.csv: load, the largest amplitude over the frequency and the frequency of
it, and the amplitude of a Jenkins element by one harmonic. Loads run on all cores.
"""

import argparse
import csv
import math
import os
import subprocess
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

SCENE = Path(__file__).with_name("damper.toml")
# The scene's numbers.
MASS, STIFFNESS, DAMPING, CONTACT, FRICTION, FORCE = 1e-3, 1e4, 0.0158, 1e4, 0.3, 0.01
LOADS = [0.029, 0.032, 0.036, 0.041, 0.046, 0.0525, 0.06, 0.07, 0.085, 0.11, 0.15, 0.2, 0.3, 0.4]
MEASURED, ROWS = 10, 400


def harmonic(load, amplitude):
    """Stiffness and loss of a Jenkins element swinging by an amplitude, over the contact's stiffness."""
    slip = FRICTION * load / CONTACT
    if amplitude <= slip:
        return 1.0, 0.0
    angle = math.acos(1 - 2 * slip / amplitude)
    return (angle - 0.5 * math.sin(2 * angle)) / math.pi, 4 * slip / (math.pi * amplitude) * (1 - slip / amplitude)


def one_harmonic(load):
    """The largest amplitude over frequency, and its frequency, if the motion is a sine."""

    def best(amplitude):
        """The least force over frequency that makes the amplitude, less the force there is, and the frequency."""
        stiff, loss = (CONTACT * part for part in harmonic(load, amplitude))
        squares = (
            ((STIFFNESS + stiff - MASS * w * w) ** 2 + (loss + DAMPING * w) ** 2, w)
            for w in (math.sqrt((STIFFNESS + stiff) / MASS) * (1 + 1e-4 * i) for i in range(-20, 1))
        )
        square, omega = min(squares)
        return amplitude * math.sqrt(square) - FORCE, omega / (2 * math.pi)

    low, high = 1e-7, FORCE / (DAMPING * math.sqrt(STIFFNESS / MASS)) * 1.01
    # From below: the first amplitude at which the force no longer suffices.
    amplitude = low
    while amplitude < high and best(amplitude)[0] < 0:
        amplitude *= 1.02
    low, high = amplitude / 1.02, amplitude
    for _ in range(50):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if best(middle)[0] < 0 else (low, middle)
    return low, best(low)[1]


def amplitude(program, folder, load, frequency, periods):
    """The amplitude of the carrier in the last periods."""
    result = folder / f"run-{load}-{frequency:.3f}.csv"
    settings = {
        "carrier.z.load": load,
        "excitation[1].pull_sine.frequency": frequency,
        "excitation[2].pull_sine.frequency": frequency,
        "excitation[1].duration": periods / frequency,
        "excitation[2].duration": MEASURED / frequency,
    }
    sets = [text for key, value in settings.items() for text in ("--set", f"{key}={value!r}")]
    command = [program, "simulate", SCENE, "-o", result, "--rows", str(ROWS), *sets]
    subprocess.run(command, check=True, capture_output=True)
    with open(result, newline="") as file:
        values = [float(row["carrier.u"]) for row in csv.DictReader(file)][-ROWS:]
    result.unlink()
    return 0.5 * (max(values) - min(values))


def largest(program, folder, load):
    """The largest amplitude over frequency and its frequency, by a search about that of one harmonic."""
    _, middle = one_harmonic(load)
    # At lower loads friction damps the start less and less.
    periods = 150 if load > 0.028 else 900
    found = {}

    def at(frequency):
        frequency = round(frequency, 3)
        if frequency not in found:
            found[frequency] = amplitude(program, folder, load, frequency, periods)
        return found[frequency]

    step = 0.01 * middle
    while step > 5e-4 * middle:
        around = [middle - step, middle, middle + step]
        best = max(around, key=at)
        step, middle = (0.5 * step, middle) if best == middle else (step, best)
    return at(middle), round(middle, 3)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", metavar="ASPERITY")
    parser.add_argument("folder", type=Path, metavar="FOLDER")
    parser.add_argument("--loads", type=lambda text: [float(load) for load in text.split(",")], default=LOADS)
    arguments = parser.parse_args()
    arguments.folder.mkdir(parents=True, exist_ok=True)
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        found = list(pool.map(lambda load: largest(arguments.program, arguments.folder, load), arguments.loads))
    with open(arguments.folder / "damper.csv", "w", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(["load [N]", "amplitude [m]", "frequency [Hz]", "one_harmonic [m]"])
        for load, (peak, frequency) in zip(arguments.loads, found):
            row = [load, peak, frequency, one_harmonic(load)[0]]
            writer.writerow([f"{value:.6g}" for value in row])
            print("  ".join(f"{value:12.5g}" for value in row))


if __name__ == "__main__":
    main()
