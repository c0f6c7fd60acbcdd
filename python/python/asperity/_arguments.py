"""Values of Python as the native part takes them."""

from __future__ import annotations

import json
import sys
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import wraps
from pathlib import Path
from textwrap import wrap
from typing import Any, ParamSpec, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

P = ParamSpec("P")
R = TypeVar("R")
Floats = NDArray[np.float64]
Progress = bool | Callable[[float], object]


def renamed(**names: str) -> Callable[[Callable[P, R]], Callable[P, R]]:
    """Refuses keywords that a function had, by the names that they have now: ``renamed(old="new")``."""

    def of(function: Callable[P, R]) -> Callable[P, R]:
        @wraps(function)
        def checked(*args: P.args, **kwargs: P.kwargs) -> R:
            for old, new in names.items():
                if old in kwargs:
                    raise TypeError(f"{function.__name__}: {old} is now {new}")
            return function(*args, **kwargs)

        return checked

    return of


def to_toml(value: object) -> str:
    """The value as TOML: numbers, texts, flags, lists and arrays, and dictionaries as inline tables."""
    if isinstance(value, np.ndarray | np.generic):
        value = value.tolist()
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
    """A line of numbers."""
    array = np.atleast_1d(np.asarray(values, dtype=np.float64))
    if array.ndim != 1:
        raise ValueError(f"{name}: expected a line of numbers, found an array of shape {array.shape}")
    return np.ascontiguousarray(array)


def axis(name: str, values: ArrayLike) -> list[float]:
    """Values of an axis of a sweep, rising, each once, all above 0."""
    found = np.unique(numbers(name, values))
    if found.size == 0 or not np.all(np.isfinite(found)) or found[0] <= 0.0:
        raise ValueError(f"{name}: expected numbers above 0, found {values!r}")
    return [float(value) for value in found]


def positive(name: str, value: float) -> float:
    """A number above 0."""
    if not (np.isfinite(value) and value > 0.0):
        raise ValueError(f"{name} = {value!r}: expected a number above 0")
    return float(value)


def given(**options: object) -> dict[str, Any]:
    """The options that are given, as plain values; what is None is left out."""

    def plain(value: object) -> object:
        if isinstance(value, np.ndarray | np.generic):
            return value.tolist()
        return str(value) if isinstance(value, Path) else value

    return {name: plain(value) for name, value in options.items() if value is not None}


def columns_of(data: object) -> dict[str, Any]:
    """The columns of a DataFrame, or of a mapping of names to columns."""
    if not hasattr(data, "items"):
        raise TypeError(f"expected a DataFrame or a mapping of names to columns, found {type(data).__name__}")
    return {str(name): column for name, column in data.items()}


def table_text(data: object) -> str:
    """A table with columns as text: a DataFrame, or a mapping of names to columns."""
    columns = {name: np.asarray(column) for name, column in columns_of(data).items()}
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
    text = "" if value is None else str(value)
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
