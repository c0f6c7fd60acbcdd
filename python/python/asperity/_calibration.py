"""Calibrations: numbers of a scene from measured friction."""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from . import _native
from ._arguments import Floats

if TYPE_CHECKING:
    import pandas as pd

    from ._scene import Scene


@dataclass(frozen=True)
class Parameter:
    """A number that was fitted.

    Attributes:
        key: Its key in the scene.
        before: Its value before.
        value: Its value now.
        standard_error: Its standard error; None at a bound, and where the data do not tell it.
        interval: Its 95 % interval; None as for the error.
        is_identifiable: Whether the data tell it.
    """

    key: str
    before: float
    value: float
    standard_error: float | None
    interval: tuple[float, float] | None
    is_identifiable: bool


@dataclass(frozen=True, eq=False, repr=False)
class Calibration:
    """What a calibration found.

    Attributes:
        scene: The scene with the numbers found.
        parameters: The numbers, in the order in which they were asked for.
        correlation: Their correlations, shape (parameters, parameters).
        chi_square: χ² per degree of freedom, 1.
        is_whole: Whether the fit has converged, all numbers are identifiable, and the scene can say the data.
        measured: The measurements, shape (n, 6): speed (m/s), pressure (Pa), temperature (K), friction, its standard
            deviation, and the friction that the scene has there; nan where there is none.
        text: The scene's text with the numbers found, and what they rest on as comments.
        covariance: Covariance of the numbers that the data tell, in the order of ``covariance_keys``: of the natural
            logarithm of those whose bounds are positive and a decade apart, of others in the unit of their key.
        covariance_keys: Their keys; those at a bound and those that the data do not tell are left out.
    """

    scene: Scene
    parameters: tuple[Parameter, ...]
    correlation: Floats
    chi_square: float
    is_whole: bool
    measured: Floats
    text: str
    covariance: Floats
    covariance_keys: tuple[str, ...]
    _covariance_text: str | None

    @classmethod
    def _of(cls, found: dict[str, Any], scene: Scene) -> Calibration:
        return cls(
            scene=scene,
            parameters=tuple(Parameter(**one) for one in found["parameters"]),
            correlation=np.array(found["correlation"], dtype=np.float64),
            chi_square=found["chi_square"],
            is_whole=found["is_whole"],
            measured=np.array(found["measured"], dtype=np.float64).reshape(-1, 6),
            text=found["text"],
            covariance=np.array(found["covariance"], dtype=np.float64).reshape(2 * (len(found["covariance_keys"]),)),
            covariance_keys=tuple(found["covariance_keys"]),
            _covariance_text=found["covariance_text"],
        )

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes the scene and, beside it as ``….covariance.csv``, the covariance, which its ``[uncertainty]`` names."""
        scene, text = Path(path), self.text
        if self._covariance_text is not None:
            beside = scene.with_suffix(".covariance.csv")
            beside.write_text(self._covariance_text, encoding="utf-8")
            text = _native.with_covariance(text, beside.name, list(self.covariance_keys))
        scene.write_text(text, encoding="utf-8")

    def __getitem__(self, key: str) -> float:
        """The value found of a key."""
        for parameter in self.parameters:
            if parameter.key == key:
                return parameter.value
        raise KeyError(f"{key}: expected one of {', '.join(one.key for one in self.parameters)}")

    def to_pandas(self) -> pd.DataFrame:
        """The parameters as a DataFrame over their keys."""
        import pandas as pd

        rows = [
            {**vars(one), "low": (one.interval or (np.nan, np.nan))[0], "high": (one.interval or (np.nan, np.nan))[1]}
            for one in self.parameters
        ]
        return pd.DataFrame(rows).drop(columns="interval").set_index("key")

    def __repr__(self) -> str:
        found = ", ".join(f"{one.key} = {one.value:.5g}" for one in self.parameters)
        return f"<asperity.Calibration: {found}; χ² {self.chi_square:.4g} per degree of freedom>"
