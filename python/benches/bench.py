"""Times of the module beside those of Rust: a run beside the program's, and many short motions.

    bench.py PROGRAM ADVANCE [SCENE.toml ...]

PROGRAM is the program, ADVANCE the example `advance`, both built with --release, as the wheel is. The aim is 1.05 for
runs and 2 for motions. Processor times are compared, and the least of several counts.
"""

import os
import subprocess
import sys
import tempfile
import time
import warnings
from pathlib import Path

import asperity

HERE = Path(__file__).parent
REPETITIONS = 5


def least(action, clock):
    """The least processor time of several, s."""
    times = []
    for _ in range(REPETITIONS):
        start = clock()
        action()
        times.append(clock() - start)
    return min(times)


def of_children():
    """Processor time of the programs that were run, s."""
    times = os.times()
    return times.children_user + times.children_system


def motions():
    """10 000 short motions of a small layer."""
    simulation = asperity.Simulation(asperity.Scene.from_toml(HERE / "small.toml"))
    simulation.advance(1e-3, w_rate=-0.02)
    start = time.process_time()
    for _ in range(10_000):
        simulation.advance(1e-6, u_rate=0.1)
    return time.process_time() - start


def main():
    """Prints the ratios."""
    program, advance, *scenes = sys.argv[1:]
    warnings.simplefilter("ignore")
    usual = ("tread-block/tread-block", "tread-block-rubber/tread-block-rubber", "tester/tester")
    for file in scenes or [HERE.parents[1] / "scenes" / f"{name}.toml" for name in usual]:
        scene = asperity.Scene.from_toml(file)
        with tempfile.TemporaryDirectory() as folder:
            command = [program, "simulate", str(file), "-o", f"{folder}/out.csv", "-q"]

            def run(command=command):
                subprocess.run(command, check=True, capture_output=True)

            theirs = least(run, of_children)
        ours = least(scene.simulate, time.process_time)
        print(f"{scene.name}: {ours:.4f} s, the program {theirs:.4f} s, ratio {ours / theirs:.3f}")
    theirs = float(subprocess.run([advance], check=True, capture_output=True, text=True).stdout)
    ours = min(motions() for _ in range(REPETITIONS))
    print(f"10 000 motions: {ours:.4f} s, Rust {theirs:.4f} s, ratio {ours / theirs:.2f}")


if __name__ == "__main__":
    main()
