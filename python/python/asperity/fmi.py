"""A small master for one FMU, which tells it the rates of its inputs, as fmpy's own loop does not; and what other ways of
driving it lose."""

from __future__ import annotations

import shutil
import tempfile
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np

from . import _native
from ._arguments import Floats, columns_of, floats
from ._library import own_libraries
from ._result import Result
from ._verification import Verification

__all__ = ["Verification", "simulate", "verify"]


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

    description = fmpy.read_model_description(str(fmu))
    columns = {name.removesuffix(" [s]"): floats(name, column) for name, column in columns_of(motion).items()}
    inputs = [variable for variable in description.modelVariables if variable.causality == "input"]
    rows = _rows(columns, [variable.name for variable in inputs])
    with _slave(fmu, description) as slave:
        return _run(slave, description, inputs, columns["time"], rows, parameters or {}, with_rates=True)


def verify(fmu: str | PathLike[str]) -> Verification:
    """Drives an FMU of ``asperity pack`` along the experiment that it carries, in fmpy, and compares it with the result.

    It is driven with rates and with values alone, at the experiment's steps, at ten times longer and ten times shorter ones:
    so the table says what a master costs. Print it, or take :meth:`Verification.to_pandas`. Before that its files are
    compared with those that this package packs of its resources, as ``asperity verify`` does.

    Args:
        fmu: The FMU.

    Raises:
        ValueError: Where it carries no experiment and result (FMI-LS-REF), these do not go with each other or with the
            FMU, by file and row, its library is not whole, or it is larger than 1 GiB when unpacked.
    """
    import fmpy

    verified = _native.verify(Path(fmu), own_libraries())
    if verified["why_none"] is not None:
        raise ValueError(f"{fmu}: {verified['why_none']}")
    description = fmpy.read_model_description(str(fmu))
    inputs = [variable for variable in description.modelVariables if variable.causality == "input"]
    experiment, result = verified["experiment"], verified["result"]
    result.pop("time")
    rows = _rows(experiment, [variable.name for variable in inputs])
    units = {variable.name: variable.unit for variable in description.modelVariables}
    scales = _scales(result, units)
    ways: list[str] = []
    differences: list[list[float]] = []
    problems: dict[str, str] = {}
    for kind, with_rates in (("rates", True), ("values alone", False)):
        for steps, times in (("", 1.0), (", steps ten times longer", 10.0), (", steps ten times shorter", 0.1)):
            ways.append(kind + steps)
            at = _communication_points(experiment["time"], times)
            motion = np.column_stack([np.interp(at, experiment["time"], column) for column in rows.T])
            try:
                with _slave(fmu, description) as slave:
                    run = _run(slave, description, inputs, at, motion, {}, with_rates=with_rates)
            except Exception as problem:  # fmpy raises its own kinds, and bare exceptions of calls that fail
                problems[ways[-1]] = str(problem)
                differences.append([float("nan")] * len(result))
                continue
            differences.append(
                [_difference(run, name, experiment["time"], column) / scales[name] for name, column in result.items()]
            )
    return Verification(
        description.modelName,
        tuple(ways),
        tuple(result),
        np.array(differences),
        problems,
        verified["description"],
        tuple(verified["problems"]),
        tuple(f"{label}: {text}" for label, text in verified["facts"]),
    )


def _communication_points(time: Floats, times: float) -> Floats:
    """Every so manieth row, the last too, or points between the rows."""
    if times < 1.0:
        parts = round(1.0 / times)
        between = np.linspace(0.0, 1.0, parts, endpoint=False)
        return np.append((time[:-1, None] + np.diff(time)[:, None] * between).ravel(), time[-1])
    kept = np.arange(0, len(time), round(times))
    return np.asarray(time[np.union1d(kept, [len(time) - 1])], dtype=np.float64)


def _scales(result: Mapping[str, Floats], units: Mapping[str, str | None]) -> dict[str, float]:
    """What each quantity is measured by: the largest value of all of its unit, 1 where all are 0."""
    largest: dict[str | None, float] = {}
    for name, column in result.items():
        largest[units[name]] = max(largest.get(units[name], 0.0), float(np.max(np.abs(column))))
    return {name: largest[units[name]] or 1.0 for name in result}


def _difference(run: Result, name: str, time: Floats, expected: Floats) -> float:
    """The largest at the rows that both have."""
    _, own, theirs = np.intersect1d(time, run.time, return_indices=True)
    return float(np.max(np.abs(expected[own] - np.asarray(run[name], dtype=np.float64)[theirs])))


@contextmanager
def _slave(fmu: str | PathLike[str], description: Any) -> Iterator[Any]:
    """An instance of the FMU, unpacked while it lives."""
    import fmpy
    from fmpy.fmi2 import FMU2Slave

    folder = tempfile.mkdtemp(prefix="asperity-")
    try:
        fmpy.extract(str(fmu), folder)
        slave = FMU2Slave(
            guid=description.guid,
            unzipDirectory=folder,
            modelIdentifier=description.coSimulation.modelIdentifier,
            instanceName="asperity",
        )
        slave.instantiate()
        try:
            yield slave
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


def _calculated(description: Any) -> list[Any]:
    return [variable for variable in description.modelVariables if variable.causality in ("output", "local")]


def _run(
    slave: Any,
    description: Any,
    inputs: list[Any],
    time: Any,
    rows: Any,
    parameters: Mapping[str, float | int | str],
    *,
    with_rates: bool,
) -> Result:
    by_name = {variable.name: variable for variable in description.modelVariables}
    for name, value in parameters.items():
        _set(slave, by_name[name], value)
    references = [variable.valueReference for variable in inputs]
    outputs = _calculated(description)
    rates = np.vstack([np.diff(rows, axis=0) / np.diff(time)[:, None], np.zeros((1, rows.shape[1]))])

    def give(i: int) -> None:
        slave.setReal(references, rows[i].tolist())
        if with_rates:
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
