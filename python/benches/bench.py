"""Times of the module beside those of Rust: a run beside the program's, and many short motions.

    bench.py PROGRAM ADVANCE [SCENE.toml ...]

PROGRAM is the program, ADVANCE the example `advance`, both built with --release, as the wheel is. The aim is 1.05 for
runs and 2 for motions. The least of several times counts.
"""

import subprocess
import sys
import tempfile
import time
import warnings
from pathlib import Path

import asperity

HERE = Path(__file__).parent
REPETITIONS = 5


def least(action):
    """The least time of several, s."""
    times = []
    for _ in range(REPETITIONS):
        start = time.perf_counter()
        action()
        times.append(time.perf_counter() - start)
    return min(times)


def motions():
    """10 000 short motions of a small layer."""
    simulation = asperity.Simulation(asperity.Scene.from_toml(HERE / "small.toml"))
    simulation.advance(1e-3, w_rate=-0.02)
    start = time.perf_counter()
    for _ in range(10_000):
        simulation.advance(1e-6, u_rate=0.1)
    return time.perf_counter() - start


def main():
    """Prints the ratios."""
    program, advance, *scenes = sys.argv[1:]
    warnings.simplefilter("ignore")
    usual = ("tread-block/tread-block", "tread-block-rubber/tread-block-rubber", "tester/tester")
    for file in scenes or [HERE.parents[1] / "scenes" / f"{name}.toml" for name in usual]:
        scene = asperity.Scene.from_toml(file)
        with tempfile.TemporaryDirectory() as folder:
            command = [program, "simulate", str(file), "-o", "out.csv", "-q"]
            theirs = least(lambda: subprocess.run(command, cwd=folder, check=True, capture_output=True))
        ours = least(scene.simulate)
        print(f"{scene.name}: {ours:.4f} s, the program {theirs:.4f} s, ratio {ours / theirs:.3f}")
    theirs = float(subprocess.run([advance], check=True, capture_output=True, text=True).stdout)
    ours = min(motions() for _ in range(REPETITIONS))
    print(f"10 000 motions: {ours:.4f} s, Rust {theirs:.4f} s, ratio {ours / theirs:.2f}")


if __name__ == "__main__":
    main()
