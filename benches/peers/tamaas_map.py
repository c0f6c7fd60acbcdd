"""Times a point of the steady solver on an elastic map beside tamaas, at equal error and on one core."""

import argparse
import os
import resource
import subprocess
import time
from pathlib import Path

os.environ |= {"OMP_NUM_THREADS": "1", "RAYON_NUM_THREADS": "1"}

import numpy as np
import tamaas

LENGTH, MODULUS, POISSON = 1e-2, 1e7, 0.49
# Mean pressures over the plane modulus: some 1 to 10 % of the area touch.
LOADS = np.array([1, 2, 4, 8]) * 1e-3
COMPARED = 2
TOLERANCES = [1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-10]
SCENE = """\
name = "map"
[layer]
foundation = "half_space"
masses = {n}
spacing = {spacing!r}
width = 1e-2
[material]
density = 1000.0
poisson_ratio = {poisson}
equilibrium_modulus = {modulus}
prony = []
[surface]
kind = "file"
path = "map.txt"
spacing = [{spacing!r}, {spacing!r}]
periodic = true
"""


def heights(n):
    """An isotropic self-affine map, Hurst exponent 0.8, waves from a quarter of its length to 16 points."""
    q = 2 * np.pi * np.fft.fftfreq(n, LENGTH / n)
    qx, qy = np.meshgrid(q, q)
    size = np.hypot(qx, qy)
    first = 2 * np.pi / LENGTH
    passes = (size >= 4 * first) & (size <= first * n / 16)
    amplitude = np.where(passes, np.where(size > 0, size, 1) ** -1.8, 0)
    spectrum = amplitude * np.fft.fft2(np.random.default_rng(1).standard_normal((n, n)))
    slopes = np.hypot(*(np.fft.ifft2(1j * wave * spectrum).real for wave in (qx, qy)))
    return np.ascontiguousarray(np.fft.ifft2(spectrum).real * 0.2 / np.sqrt((slopes**2).mean()))


def processor_seconds():
    """Of this process and of those it has waited for."""
    return time.process_time() + sum(resource.getrusage(resource.RUSAGE_CHILDREN)[:2])


def timed(work):
    """The shortest of three, in seconds of the processor: others may use the machine too."""
    times = []
    for _ in range(3):
        start = processor_seconds()
        work()
        times.append(processor_seconds() - start)
    return min(times)


def by_tamaas(surface, pressure, tolerance):
    n = len(surface)
    model = tamaas.ModelFactory.createModel(tamaas.model_type.basic_2d, [LENGTH] * 2, [n] * 2)
    model.E, model.nu = MODULUS, POISSON
    solver = tamaas.PolonskyKeerRey(model, surface, tolerance)
    solver.max_iter = 5_000
    # From nothing each time, as a point of a sweep is.
    start = lambda: model.traction.__setitem__(..., 0.0)
    seconds = timed(lambda: (start(), solver.solve(pressure)))
    return seconds, model.traction.copy()


def by_asperity(program, folder, pressures):
    """Seconds a point, without what a call of the program takes, and the pressures of the point compared."""

    def sweep(some):
        values = ",".join(f"{pressure!r}" for pressure in some.tolist())
        command = [program, "-q", "sweep", "scene.toml", "--speeds", "1e-3", "--pressures", values, "--force"]
        return timed(lambda: subprocess.run([*command, "-o", "table.csv"], cwd=folder, check=True, capture_output=True))

    seconds = (sweep(pressures) - sweep(pressures[:1])) / (len(pressures) - 1)
    point = ["--pressure", str(float(pressures[COMPARED])), "--speed", "1e-3", "-o", "point.png", "--write", "point.npz"]
    subprocess.run([program, "-q", "contact", "scene.toml", *point], cwd=folder, check=True, capture_output=True)
    return seconds, np.load(folder / "point.npz")["pressure"]


def compare(program, folder, n):
    folder.mkdir(parents=True, exist_ok=True)
    surface, spacing = heights(n), LENGTH / n
    np.savetxt(folder / "map.txt", surface, fmt="%.17g")
    (folder / "scene.toml").write_text(SCENE.format(n=n, spacing=spacing, poisson=POISSON, modulus=MODULUS))
    pressures = LOADS * MODULUS / (1 - POISSON**2)
    pressure = float(pressures[COMPARED])
    exact = by_tamaas(surface, pressure, 1e-11)[1]
    error = lambda found: np.abs(found - exact).max() / exact.max()
    seconds, found = by_asperity(program, folder, pressures)
    for tolerance in TOLERANCES:
        of_tamaas, other = by_tamaas(surface, pressure, tolerance)
        if error(other) <= error(found):
            break
    areas = [f"{(field > 0).mean():.6f}" for field in (found, other)]
    print(f"{n:>5} {error(found):>10.1e} {error(other):>10.1e} {areas[0]:>10} {areas[1]:>10} {of_tamaas / seconds:>8.1f}")


def main():
    arguments = argparse.ArgumentParser(description=__doc__)
    arguments.add_argument("--asperity", required=True)
    arguments.add_argument("--folder", type=Path, required=True)
    arguments.add_argument("--sizes", type=int, nargs="+", default=[256, 512])
    given = arguments.parse_args()
    tamaas.initialize(1)
    tamaas.set_log_level(tamaas.LogLevel.error)
    print(f"tamaas {tamaas.__version__}; errors: largest of a pressure over the largest pressure")
    print(f"{'n x n':>5} {'asperity':>10} {'tamaas':>10} {'area':>10} {'area':>10} {'times':>8}")
    for n in given.sizes:
        compare(given.asperity, given.folder / f"map-{n}", n)


if __name__ == "__main__":
    main()
