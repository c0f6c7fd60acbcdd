"""A small master for one FMU, which tells it the rates of its inputs, as fmpy's own loop does not; and what other ways of
driving it lose."""

from __future__ import annotations

import csv
import io
import shutil
import tempfile
import zipfile
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from os import PathLike
from posixpath import join, normpath
from typing import Any
from urllib.parse import unquote
from xml.etree import ElementTree

import numpy as np

from ._arguments import Floats, columns_of, floats
from ._result import Result
from ._verification import Verification

__all__ = ["Verification", "simulate", "verify"]

_REFERENCES = "extra/org.fmi-standard.fmi-ls-ref"
_LEFT_OUT = "extra/org.asperity/left-out.txt"
# Bytes, unpacked: pack writes tables of 0.1 MB, and libraries of three platforms have some 30 MB.
_LARGEST_TABLE = 1 << 24
_LARGEST = 1 << 30


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
    so the table says what a master costs. Print it, or take :meth:`Verification.to_pandas`.

    Args:
        fmu: The FMU.

    Raises:
        ValueError: Where it carries no experiment and result (FMI-LS-REF), these do not go with each other or with the
            FMU, by file and row, or it is larger than 1 GiB when unpacked.
    """
    import fmpy

    _check_archive(fmu)
    description = fmpy.read_model_description(str(fmu))
    inputs = [variable for variable in description.modelVariables if variable.causality == "input"]
    experiment, result, of_result = _experiment(fmu, {one.name for one in _calculated(description)})
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
        description.modelName, tuple(ways), tuple(result), np.array(differences), problems, of_result
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


def _check_archive(fmu: str | PathLike[str]) -> None:
    """Refuses an archive that is too large, or whose files would lie outside of the folder that it is unpacked to."""
    with zipfile.ZipFile(fmu) as archive:
        size = sum(one.file_size for one in archive.infolist())
        if size > _LARGEST:
            raise ValueError(f"{fmu}: expected at most {_LARGEST} bytes when unpacked, found {size}")
        for name in archive.namelist():
            if name.startswith("/") or "\\" in name or ":" in name or ".." in name.split("/"):
                raise ValueError(f"{fmu}: {name}: expected a name within the archive, with forward slashes")


def _experiment(
    fmu: str | PathLike[str], outputs: set[str]
) -> tuple[dict[str, Floats], dict[str, Floats], str]:
    """Inputs and result that an FMU carries, by the manifest's roles, the result without its times; and what it is."""
    with zipfile.ZipFile(fmu) as archive:
        names = archive.namelist()
        manifest = f"{_REFERENCES}/fmi-ls-manifest.xml"
        root = ElementTree.fromstring(archive.read(manifest)) if manifest in names else ElementTree.Element("none")
        related = {one.get("role", ""): one for one in root.iter("Related")}
        named = [related.get(role, root).get("source", "") for role in ("experiment/smoke-test", "result")]
        tables = [normpath(join(_REFERENCES, unquote(source))) for source in named]
        if not all(table in names for table in tables):
            why = (
                f"it has {archive.read(_LEFT_OUT).decode().strip()}"
                if _LEFT_OUT in names
                else "an FMU of asperity pack has them, unless it was packed with --no-references"
            )
            raise ValueError(f"{fmu}: expected an experiment and its result in {_REFERENCES}: {why}")
        experiment, result = (_columns(archive, table, f"{fmu}: {table}") for table in tables)
    time, own, where = experiment.get("time", np.empty(0)), result.pop("time", np.empty(0)), f"{fmu}: {tables[1]}"
    unknown = [name for name in result if name not in outputs]
    if unknown or not result:
        raise ValueError(f"{where}, row 1: expected columns time and outputs of the FMU, found {', '.join(unknown) or 'none'}")
    if len(own) != len(time):
        raise ValueError(f"{where}: expected {len(time)} rows, as the experiment {tables[0]} has, found {len(own)}")
    for i in np.flatnonzero(own != time)[:1]:
        raise ValueError(f"{where}, row {i + 2}: expected time = {time[i]:g}, as in the experiment {tables[0]}, found {own[i]:g}")
    return experiment, result, related["result"].get("description", "")


def _columns(archive: zipfile.ZipFile, table: str, where: str) -> dict[str, Floats]:
    """The columns of a table of finite numbers; ``where`` it is, for messages."""
    size = archive.getinfo(table).file_size
    if size > _LARGEST_TABLE:
        raise ValueError(f"{where}: expected at most {_LARGEST_TABLE} bytes, found {size}")
    try:
        head, *rows = csv.reader(io.StringIO(archive.read(table).decode()))
    except (csv.Error, UnicodeDecodeError, ValueError) as problem:
        raise ValueError(f"{where}: expected a table of numbers under their names: {problem}") from None
    if len(set(head)) != len(head):
        raise ValueError(f"{where}, row 1: expected each column once, found {', '.join(head)}")
    values = np.empty((len(rows), len(head)))
    for i, row in enumerate(rows):
        if len(row) != len(head):
            raise ValueError(f"{where}, row {i + 2}: expected {len(head)} numbers, one for each column, found {len(row)}")
        for j, field in enumerate(row):
            try:
                values[i, j] = float(field)
            except ValueError:
                values[i, j] = np.nan
            if not np.isfinite(values[i, j]):
                raise ValueError(f"{where}, row {i + 2}: {head[j]} = {field[:40]!r}: expected a number")
    return {name: values[:, j] for j, name in enumerate(head)}


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
