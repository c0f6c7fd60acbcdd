"""Values of Python as the native part takes them."""

from __future__ import annotations

import json
import re
import sys
from collections.abc import Callable, Iterable, Mapping, Sequence
from datetime import datetime, timedelta
from pathlib import Path
from textwrap import wrap
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

Floats = NDArray[np.float64]
Progress = bool | Callable[[float], object]

# Units of arrays that carry one, as pint, astropy and xarray write them.
_SI = {"", "1", "dimensionless", "m", "meter", "metre", "s", "second", "N", "newton", "Pa", "pascal", "K", "kelvin"}
_SI |= {"m/s", "m / s", "meter / second", "1/m", "1 / m", "1 / meter", "m4", "m^4", "meter ** 4"}


def to_toml(value: object) -> str:
    """The value as TOML: numbers, texts, flags, lists and arrays, and dictionaries as inline tables."""
    if isinstance(value, np.datetime64 | np.timedelta64):
        raise TypeError(f"{value!r}: expected a number, in SI units")
    if isinstance(value, np.ndarray | np.generic):
        value = plain("an array", value).tolist()
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, int | float):
        return repr(value)
    if isinstance(value, str | Path):
        return json.dumps(str(value), ensure_ascii=False).replace("\x7f", "\\u007f")
    if isinstance(value, Mapping):
        return "{ " + ", ".join(f"{_name(key)} = {to_toml(one)}" for key, one in value.items()) + " }"
    if isinstance(value, Iterable):
        return "[" + ", ".join(map(to_toml, value)) + "]"
    raise TypeError(f"{value!r}: expected a number, a text, a flag, a list or a dictionary")


def _name(key: object) -> str:
    return str(key) if str(key).replace("-", "_").isidentifier() else json.dumps(str(key))


def numbers(name: str, values: ArrayLike) -> Floats:
    """A line of numbers: masked ones are NaN, times are in seconds."""
    array = np.atleast_1d(floats(name, values))
    if array.ndim != 1:
        raise ValueError(f"{name}: expected a line of numbers, found an array of shape {array.shape}")
    return np.ascontiguousarray(array)


def floats(name: str, values: object) -> Floats:
    """An array of numbers: masked ones are NaN, times are in seconds."""
    array = plain(name, values)
    try:
        return np.asarray(array, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise TypeError(f"{name}: expected numbers, found {array.dtype}: {error}") from None


def plain(name: str, values: object) -> NDArray[Any]:
    """An array without what numpy would drop in silence: masked values are NaN, and times are seconds.

    Dates count from the first of them. Arrays with units other than SI are refused.
    """
    kind = getattr(values, "dtype", None)
    unit = next((one for one in (_unit(values), _unit(kind)) if one is not None), None)
    if unit is not None and getattr(kind, "kind", "") not in ("m", "M") and str(unit) not in _SI:
        raise TypeError(f"{name}: expected numbers in SI units, found an array in {unit}")
    values = getattr(values, "magnitude", values)
    if isinstance(values, np.ma.MaskedArray):
        masked: Any = values
        if masked.dtype.kind in "mM":
            return plain(name, masked.filled(np.array("NaT", masked.dtype)))
        is_whole = not np.any(np.ma.getmaskarray(masked)) or masked.dtype.kind not in "buif"
        return np.asarray(masked.filled() if is_whole else masked.astype(np.float64).filled(np.nan))
    array = np.asarray(values)
    if array.dtype.kind == "M":
        array = array - array.flat[0] if array.size else array.astype("m8[ns]")
    if array.dtype.kind == "m":
        return np.asarray(array / np.timedelta64(1, "s"), dtype=np.float64)
    return _seconds(array) if _is_time(array) else array


def _unit(values: object) -> object:
    """The unit that an array of pint, astropy or xarray has, or a column's type."""
    return getattr(values, "units", getattr(values, "unit", None))


def _is_time(array: NDArray[Any]) -> bool:
    """Whether an array has dates or spans of time, of numpy or as objects."""
    if array.dtype.kind != "O" or not array.size:
        return array.dtype.kind in "mM"
    return all(isinstance(one, datetime | timedelta) for one in array.flat)


def _seconds(array: NDArray[Any]) -> Floats:
    """Seconds of objects of datetime, those with a zone of time among them."""
    first = array.flat[0]
    spans = [one if isinstance(one, timedelta) else one - first for one in array.flat]
    return np.array([span.total_seconds() for span in spans], dtype=np.float64).reshape(array.shape)


def lines_along_x(heights: Any, spacing: tuple[float, float]) -> Floats:
    """Heights in the order (y, x) of rising coordinates, by the names and the coordinates that the array has."""
    array = floats("heights", heights)
    if array.ndim != 2:
        raise ValueError(f"heights: expected an array of shape (ny, nx), found {array.shape}")
    names, coordinates = _axes_of(heights)
    if names[0] == "x" or names[1] == "y":
        array, names, coordinates = array.T, names[::-1], coordinates[::-1]
    if names not in (("y", "x"), ("y", None), (None, "x"), (None, None)):
        raise ValueError(f"heights: expected axes called y and x, found {names[0]} and {names[1]}")
    for which, (along, distance) in enumerate(zip(coordinates, spacing[::-1], strict=True)):
        if along is None or along.size < 2:
            continue
        if along[1] < along[0]:
            array, along = np.flip(array, which), along[::-1]
        if not np.allclose(np.diff(along), distance, rtol=1e-3, atol=0.0):
            found = f"{np.diff(along).min():g} to {np.diff(along).max():g}"
            raise ValueError(f"heights: expected coordinates at the distance {distance:g} m, found {found} along {'yx'[which]}")
    return array


def _axes_of(heights: Any) -> tuple[tuple[Any, ...], list[Floats | None]]:
    """The names of two axes, in lower case, and their coordinates; None where they have none."""
    if hasattr(heights, "coords") and hasattr(heights, "dims"):
        names = [None if str(name).startswith("dim_") else str(name).lower() for name in heights.dims]
        along = [floats(str(name), heights.coords[name]) if name in heights.coords else None for name in heights.dims]
        return tuple(names), along
    if hasattr(heights, "index") and hasattr(heights, "columns"):
        both = (heights.index, heights.columns)
        names = [None if one.name is None else str(one.name).lower() for one in both]
        # Whole numbers and names without a name of their axis count rows and columns.
        is_axis = [one.name is not None or np.asarray(one).dtype.kind == "f" for one in both]
        along = [floats("heights", one) if has else None for one, has in zip(both, is_axis, strict=True)]
        return tuple(names), along
    return (None, None), [None, None]


def axis(name: str, values: ArrayLike) -> list[float]:
    """Values of an axis of a sweep, rising, each once, all above 0; temperatures may be texts with their unit."""
    listed: Any = [values] if isinstance(values, str) else values
    if name == "temperatures" and isinstance(listed, Sequence):
        listed = [kelvin(one) if isinstance(one, str) else one for one in listed]
    found = np.unique(numbers(name, listed))
    if found.size == 0 or not np.all(np.isfinite(found)) or found[0] <= 0.0:
        raise ValueError(f"{name}: expected numbers above 0, found {values!r}")
    return [float(value) for value in found]


def kelvin(text: str) -> float:
    """The temperature (K) of a text such as ``"20 °C"``."""
    read = re.fullmatch(r"\s*([-+.\de]+)\s*(K|°C|°F)\s*", text)
    try:
        value = float(read[1] if read else "")
    except ValueError:
        raise ValueError(f"temperatures: expected numbers, in K, or texts such as '20 °C', found {text!r}") from None
    unit = read[2] if read else ""
    return value if unit == "K" else round(273.15 + (value if unit == "°C" else (value - 32.0) / 1.8), 9)


def positive(name: str, value: float) -> float:
    """A number above 0."""
    if not (np.isfinite(value) and value > 0.0):
        raise ValueError(f"{name} = {value!r}: expected a number above 0")
    return float(value)


def given(**options: object) -> dict[str, Any]:
    """The options that are given, as plain values; what is None is left out."""

    def as_plain(value: object) -> object:
        if isinstance(value, np.ndarray | np.generic):
            return value.tolist()
        return str(value) if isinstance(value, Path) else value

    return {name: as_plain(value) for name, value in options.items() if value is not None}


def mapping(name: str, value: Any) -> Mapping[Any, Any]:
    """A dictionary, or another mapping."""
    if not isinstance(value, Mapping):
        raise TypeError(f"{name}: expected a dictionary, found {type(value).__name__}")
    return value


def columns_of(data: Any) -> dict[str, NDArray[Any]]:
    """The columns of a DataFrame, its index among them, or of a mapping of names to columns.

    Times are in seconds, which stands beside their names.
    """
    units: dict[str, str] = {}
    kept = getattr(data, "attrs", {}).get("units")
    if isinstance(kept, Mapping):
        units = {str(name): str(unit) for name, unit in kept.items() if unit not in ("", "1")}
    if hasattr(data, "data_vars"):
        units = {str(name): one.attrs["units"] for name, one in data.variables.items() if "units" in one.attrs}
        data = data.to_dataframe()
    if hasattr(data, "reset_index") and hasattr(data, "columns"):
        data = _with_index(data)
    if not hasattr(data, "items") or hasattr(data, "to_frame"):
        raise TypeError(f"expected a DataFrame or a mapping of names to columns, found {type(data).__name__}")
    columns: dict[str, NDArray[Any]] = {}
    for given, column in data.items():
        name, array = str(given), plain(str(given), column)
        if _is_time(np.asarray(column)):
            if "[" in name or "(" in name:
                raise TypeError(f"{name}: expected numbers in this unit, found dates or spans of time, which have their own")
            name += " [s]"
        elif name in units:
            name += f" [{units[name]}]"
        if name in columns:
            raise ValueError(f"two columns are called {name!r}: expected names of their own")
        columns[name] = array
    return columns


def _with_index(data: Any) -> Any:
    """A DataFrame whose index is a column, unless that has no name and only counts the rows."""
    index = data.index
    named = any(name is not None for name in index.names)
    return data.reset_index() if named or np.asarray(index).dtype.kind not in "iu" else data


def given_columns(columns: Mapping[str, str | int] | None) -> list[tuple[str, str]]:
    """Which column is which, by its name or number."""
    return [(str(role), str(column)) for role, column in mapping("columns", columns or {}).items()]


def table_text(data: object) -> str:
    """A table with columns as text: a DataFrame, or a mapping of names to columns."""
    columns = columns_of(data)
    lengths = {column.shape for column in columns.values()}
    if len(lengths) != 1 or len(next(iter(lengths))) != 1:
        raise ValueError(f"expected columns of one length, found { ({n: c.shape for n, c in columns.items()}) }")
    lines = [",".join(map(_field, columns))]
    lines += [
        ",".join(_field(value) for value in row) for row in zip(*(c.tolist() for c in columns.values()), strict=True)
    ]
    return "\n".join(lines) + "\n"


def with_units(data: object, units: Mapping[str, str]) -> dict[str, Any]:
    """The columns of a table, units beside those names that stand alone."""
    return {f"{name} [{units[name]}]" if name in units else name: column for name, column in columns_of(data).items()}


def _field(value: object) -> str:
    if isinstance(value, float):
        return "" if value != value else repr(value)
    # pandas writes values that are missing so.
    text = "" if value is None or str(value) in ("<NA>", "NaT") else str(value)
    return '"' + text.replace('"', '""') + '"' if any(c in text for c in ',"\n') else text


def described(rows: Sequence[tuple[str, str]]) -> str:
    """Lines after their labels, broken between words as the program breaks them."""
    return "".join(
        "\n".join(wrap(f"{label:<12}{text}", 120, subsequent_indent=" " * 14, break_long_words=False)) + "\n"
        for label, text in rows
    )


def shown(progress: Progress) -> Callable[[float], object] | None:
    """What is called with the fraction done: what is given, or for True a line on standard error."""
    if callable(progress):
        return progress
    if not progress:
        return None

    def write(done: float) -> None:
        print(f"\rasperity: {100 * done:5.1f} %", end="\n" if done >= 1.0 else "", file=sys.stderr, flush=True)

    return write
