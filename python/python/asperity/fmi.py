"""A small master for one FMU, which tells it the rates of its inputs, as fmpy's own loop does not."""

from __future__ import annotations

import shutil
from collections.abc import Mapping
from os import PathLike
from typing import Any

import numpy as np

from ._arguments import columns_of
from ._result import Result


def simulate(
    fmu: str | PathLike[str],
    motion: object,
    *,
    parameters: Mapping[str, float | int | str] | None = None,
) -> Result:
    """Runs an FMU along a motion, straight from row to row: by the values at a row and the rates to the next.

    Args:
        fmu: The FMU, of ``asperity pack`` or any other for co-simulation by FMI 2.0.
        motion: A DataFrame, or a mapping of names to arrays of shape (n,): ``time`` (s) and inputs of the FMU. Inputs
            without a column are 0; other columns are refused.
        parameters: Values of parameters, by their names.

    Returns:
        A row for each of the motion's: the inputs, and all outputs.

    Raises:
        ValueError: Where the motion has no rows, its times do not rise, or the FMU has no such input.
    """
    import fmpy
    from fmpy.fmi2 import FMU2Slave

    description = fmpy.read_model_description(str(fmu))
    columns = {name: np.asarray(column, dtype=np.float64) for name, column in columns_of(motion).items()}
    inputs = [variable for variable in description.modelVariables if variable.causality == "input"]
    rows = _rows(columns, [variable.name for variable in inputs])
    folder = fmpy.extract(str(fmu))
    try:
        slave = FMU2Slave(
            guid=description.guid,
            unzipDirectory=folder,
            modelIdentifier=description.coSimulation.modelIdentifier,
            instanceName="asperity",
        )
        slave.instantiate()
        try:
            return _run(slave, description, inputs, columns["time"], rows, parameters or {})
        finally:
            slave.freeInstance()
    finally:
        shutil.rmtree(folder, ignore_errors=True)


def _rows(columns: Mapping[str, Any], names: list[str]) -> Any:
    """The inputs at the rows, shape (rows, inputs)."""
    unknown = [name for name in columns if name != "time" and name not in names]
    if "time" not in columns or unknown:
        found = ", ".join(columns)
        raise ValueError(f"expected columns time and some of {', '.join(names)}, found {found}")
    time = columns["time"]
    if len(time) == 0 or np.any(np.diff(time) <= 0.0):
        raise ValueError("time: expected at least one row, and times that rise")
    return np.column_stack([columns.get(name, np.zeros(len(time))) for name in names])


def _run(
    slave: Any, description: Any, inputs: list[Any], time: Any, rows: Any, parameters: Mapping[str, float | int | str]
) -> Result:
    by_name = {variable.name: variable for variable in description.modelVariables}
    for name, value in parameters.items():
        _set(slave, by_name[name], value)
    references = [variable.valueReference for variable in inputs]
    outputs = [variable for variable in description.modelVariables if variable.causality in ("output", "local")]
    rates = np.vstack([np.diff(rows, axis=0) / np.diff(time)[:, None], np.zeros((1, rows.shape[1]))])

    def give(i: int) -> None:
        slave.setReal(references, rows[i].tolist())
        slave.setRealInputDerivatives(references, [1] * len(references), rates[i].tolist())

    slave.setupExperiment(startTime=float(time[0]))
    slave.enterInitializationMode()
    give(0)
    slave.exitInitializationMode()
    found = [_values(slave, outputs)]
    for i in range(len(time) - 1):
        give(i)
        slave.doStep(currentCommunicationPoint=float(time[i]), communicationStepSize=float(time[i + 1] - time[i]))
        found.append(_values(slave, outputs))
    slave.terminate()
    columns = {"time": time, **{variable.name: rows[:, j] for j, variable in enumerate(inputs)}}
    for variable, values in zip(outputs, zip(*found, strict=True), strict=True):
        columns[variable.name] = np.array(values, dtype=np.float64 if variable.type == "Real" else np.int64)
    units = {variable.name: variable.unit or "1" for variable in (*inputs, *outputs)}
    return Result(description.modelName, columns, {"time": "s", **units}, {}, (np.empty(0), np.empty(0)))


def _set(slave: Any, variable: Any, value: float | int | str) -> None:
    reference = [variable.valueReference]
    if variable.type == "Real":
        slave.setReal(reference, [float(value)])
    elif variable.type == "Integer":
        slave.setInteger(reference, [int(value)])
    else:
        slave.setString(reference, [str(value)])


def _values(slave: Any, outputs: list[Any]) -> list[float]:
    found: dict[tuple[str, int], float] = {}
    for kind, get in (("Real", slave.getReal), ("Integer", slave.getInteger)):
        references = [variable.valueReference for variable in outputs if variable.type == kind]
        if references:
            found.update(zip(((kind, reference) for reference in references), get(references), strict=True))
    return [found[variable.type, variable.valueReference] for variable in outputs]
