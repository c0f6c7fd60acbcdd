"""Runs an FMU in libcosim along a motion given as a CSV file.

    in_libcosim.py MODEL.fmu MOTION.csv -o RESULT.csv

The inputs are overridden before every step by a manipulator; an observer reads the last values.
"""

from libcosimpy.CosimExecution import CosimExecution
from libcosimpy.CosimLogging import CosimLogLevel, log_output_level
from libcosimpy.CosimManipulator import CosimManipulator
from libcosimpy.CosimObserver import CosimObserver
from libcosimpy.CosimSlave import CosimLocalSlave

import master

NANOSECOND = 1e-9


def simulate(fmu, step, inputs, reals, integers):
    """Yields the time and the outputs after each step."""
    references = master.variables(fmu, "input", "Real")
    execution = CosimExecution.from_step_size(round(step / NANOSECOND))
    model = CosimLocalSlave(fmu_path=fmu, instance_name="block")
    slave = execution.add_local_slave(model)
    manipulator = CosimManipulator.create_override()
    observer = CosimObserver.create_last_value()
    if slave < 0 or not execution.add_manipulator(manipulator) or not execution.add_observer(observer):
        raise SystemExit(f"libcosim does not take {fmu}")
    for values in inputs:
        manipulator.slave_real_values(slave, [references[name] for name in values], [*values.values()])
        if not execution.step():
            raise SystemExit(f"libcosim: the step at {execution.status().current_time} ns failed")
        found = observer.last_real_values(slave, [*reals.values()])
        found += observer.last_integer_values(slave, [*integers.values()])
        yield [execution.status().current_time * NANOSECOND, *found]


if __name__ == "__main__":
    log_output_level(CosimLogLevel.WARNING)
    master.run(simulate, __doc__)
