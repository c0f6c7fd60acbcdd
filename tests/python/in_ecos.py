"""Runs an FMU in Ecos along a motion given as a CSV file.

    in_ecos.py MODEL.fmu MOTION.csv -o RESULT.csv

The inputs are set before every step.
"""

import ctypes
from importlib.metadata import files

import master


def load_tbb():
    """Ecos is linked against TBB. The package of that name puts the library where the loader does not look, and a
    folder of packages that is no virtual environment does not get it at all: then it has to be the system's."""
    library = next(file for file in files("tbb") if file.name == "libtbb.so.12").locate()
    try:
        ctypes.CDLL(str(library) if library.exists() else "libtbb.so.12")
    except OSError as error:
        raise SystemExit(f"Ecos needs the library TBB, in Debian the package libtbb12: {error}")


def simulate(fmu, step, inputs, reals, integers):
    """Yields the time and the outputs after each step."""
    from ecospy import EcosSimulation, EcosSimulationStructure

    with EcosSimulationStructure() as structure:
        structure.add_model("block", fmu)
        with EcosSimulation(step, structure=structure) as simulation:
            if not simulation.init():
                raise SystemExit(f"Ecos does not take {fmu}")
            for values in inputs:
                for name, value in values.items():
                    simulation.set_real(f"block::{name}", value)
                time = simulation.step()
                found = [simulation.get_real(f"block::{name}") for name in reals]
                found += [simulation.get_integer(f"block::{name}") for name in integers]
                yield [time, *found]
            simulation.terminate()


if __name__ == "__main__":
    load_tbb()
    master.run(simulate, __doc__)
