"""Rankings: scenes in the order of their friction, and how sure that is."""

from __future__ import annotations

import warnings
from collections.abc import Mapping, Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from . import _native
from ._arguments import Floats, Progress, axis, given, given_columns, positive, shown
from ._files import table_file
from ._scene_text import SceneText

if TYPE_CHECKING:
    import pandas as pd

    from ._scene import Scene


class MeasuredScene(NamedTuple):
    """Means over the points at which all scenes with data were measured.

    Attributes:
        scene: The name of the scene.
        measured: Measured friction.
        computed: Friction of the scene there.
    """

    scene: str
    measured: float
    computed: float


@dataclass(frozen=True, eq=False, repr=False)
class Ranking:
    """Scenes by the weighted mean of their friction.

    Arrays are in the order in which the scenes were given; bands are the quantiles 0.05, 0.25, 0.5, 0.75 and 0.95, nan
    where no scene says what is not known of it.

    Attributes:
        scenes: Their names.
        order: Their indices, that with the largest friction first.
        friction: Weighted means of friction as the scenes stand.
        friction_bands: Bands of these, shape (scenes, 5).
        index: The means over that of the first scene, times 100.
        index_bands: Bands of these, of the same sample of both scenes: what they share drops out.
        largest: Probability that a scene is the largest; equal ones share it.
        above: Probability that scene i is above scene j, ties counted by half, shape (scenes, scenes); nan without
            samples and of a scene with itself.
        ties: Part of the samples in which they are equal, likewise.
        is_sure: Whether the first two in the order are told apart with a probability of 0.9.
        samples: How many samples count; 0 where no scene has ``[uncertainty]``.
        failed: How many samples had no result somewhere and are left out.
        redrawn: How many draws were no scene, and were drawn anew.
        points: Shape (points, 4): speed (m/s), pressure (Pa) or force (N), temperature (K), and the weight in the mean.
        point_friction: Friction as the scenes stand, shape (points, scenes); nan where there is no result.
        point_bands: Bands of it, shape (points, scenes, 5).
        point_largest: Probability that a scene has the largest friction there, shape (points, scenes).
        measured: The scenes of which ``data`` has friction; empty without it.
        tau: Kendall's rank correlation (tau-b) of what was measured and computed; None without data.
        notes: How the data were read, and what of them is left out.
    """

    scenes: tuple[str, ...]
    order: tuple[int, ...]
    friction: Floats
    friction_bands: Floats
    index: Floats
    index_bands: Floats
    largest: Floats
    above: Floats
    ties: Floats
    is_sure: bool
    samples: int
    failed: int
    redrawn: int
    points: Floats
    point_friction: Floats
    point_bands: Floats
    point_largest: Floats
    measured: tuple[MeasuredScene, ...]
    tau: float | None
    notes: tuple[str, ...]

    @classmethod
    def _of(cls, found: dict[str, Any]) -> Ranking:
        scenes, points, count = found["scenes"], found["points"], len(found["scenes"])

        def array(values: object) -> Floats:
            return np.array(values, dtype=np.float64)

        def bands(values: list[tuple[float, ...] | None]) -> list[Sequence[float]]:
            return [5 * [np.nan] if band is None else band for band in values]

        ties = np.full((count, count), np.nan)
        for pair in found["pairs"]:
            one, other = pair["scenes"]
            ties[one, other] = ties[other, one] = pair["ties"]
        keys = ("speed", "load", "temperature")
        at = [(*(point["point"][key] for key in keys), point["weight"]) for point in points]
        measured = found["measured"] or {"scenes": [], "tau": None, "notes": []}
        return cls(
            scenes=tuple(scene["label"] for scene in scenes),
            order=tuple(found["order"]),
            friction=array([scene["friction"] for scene in scenes]),
            friction_bands=array(bands([scene["friction_band"] for scene in scenes])),
            index=array([scene["index"] for scene in scenes]),
            index_bands=array(bands([scene["index_band"] for scene in scenes])),
            largest=array([scene["largest"] for scene in scenes]),
            above=array(found["above"]),
            ties=ties,
            is_sure=found["is_sure"],
            samples=found["samples"],
            failed=found["failed"],
            redrawn=found["redrawn"],
            points=array(at),
            point_friction=array([point["friction"] for point in points]),
            point_bands=array([bands(point["bands"]) for point in points]),
            point_largest=array([point["largest"] for point in points]),
            measured=tuple(MeasuredScene(*one.values()) for one in measured["scenes"]),
            tau=measured["tau"],
            notes=tuple(measured["notes"]),
        )

    def to_pandas(self) -> pd.DataFrame:
        """The scenes in their order: index, its band, friction, probability to be the largest."""
        import pandas as pd

        quantiles = ["q05", "q25", "q50", "q75", "q95"]
        found = pd.DataFrame(self.index_bands, columns=quantiles, index=pd.Index(self.scenes, name="scene"))
        found.insert(0, "index", self.index)
        found["friction"], found["largest"] = self.friction, self.largest
        return found.iloc[list(self.order)]

    def __repr__(self) -> str:
        found = ", ".join(f"{self.scenes[i]} {self.index[i]:.1f}" for i in self.order)
        return f"<asperity.Ranking: {found}; {'told apart' if self.is_sure else 'not told apart'}>"


def rank(
    scenes: Sequence[Scene],
    speeds: ArrayLike,
    pressures: ArrayLike | None = None,
    temperatures: ArrayLike | None = None,
    *,
    forces: ArrayLike | None = None,
    weights: object = None,
    samples: int = 128,
    seed: int = 1,
    refit: bool = False,
    mean: Literal["arithmetic", "harmonic"] = "arithmetic",
    data: object = None,
    columns: Mapping[str, str | int] | None = None,
    method: Literal["steady", "layer"] | None = None,
    way: float | None = None,
    points: int | None = None,
    friction_error: float | None = None,
    distance: float | None = None,
    progress: Progress = False,
) -> Ranking:
    """Ranks scenes by their friction in steady sliding, on all cores.

    What ``[uncertainty]`` of the scenes says is drawn with common random numbers: sample i draws the same for keys of the
    same name and for a surface's seed, so that what the scenes share drops out.

    Args:
        scenes: Two or more; the index of the first is 100.
        speeds: Speeds, m/s, shape (n,).
        pressures: Mean pressures, Pa, shape (n,).
        temperatures: Temperatures, K, shape (n,); None: the scenes' own, which must be the same.
        forces: Mean forces on the whole layer, N, in place of pressures.
        weights: The weights of the points in the mean: the path of a table, a DataFrame or a mapping with a column
            ``weight`` and those of speed, pressure and temperature that it depends on; None: all the same.
        samples: Number of samples, where a scene has ``[uncertainty]``.
        seed: The seed of the samples.
        refit: As for :meth:`Scene.sweep`, of the scenes that have a covariance.
        mean: The mean over the points: of friction μ, or "harmonic", 1 over the mean of 1/μ, with which the braking way goes.
        data: Measured friction as for :meth:`Scene.calibrate`, with a column ``scene`` of the scenes' names.
        columns: As for :meth:`Scene.calibrate`.
        method: As for :meth:`Scene.sweep`.
        way: As for :meth:`Scene.sweep`.
        points: As for :meth:`Scene.sweep`.
        friction_error: As for :meth:`Scene.sweep`.
        distance: As for :meth:`Scene.sweep`.
        progress: True for a line on standard error, or a function of the fraction done.

    Raises:
        SceneError, ValueError: Where the scenes, the weights or the data are refused.
    """
    for scene in scenes:
        if not isinstance(scene, SceneText):
            raise TypeError(f"scenes: expected scenes, found {type(scene).__name__}")
    with ExitStack() as files:
        weights_file = None if weights is None else files.enter_context(table_file(weights))
        data_file = None if data is None else files.enter_context(table_file(data))
        found = _native.rank(
            [scene._native for scene in scenes],
            given(
                speeds=axis("speeds", speeds),
                pressures=None if pressures is None else axis("pressures", pressures),
                forces=None if forces is None else axis("forces", forces),
                temperatures=None if temperatures is None else axis("temperatures", temperatures),
                weights=weights_file,
                samples=samples,
                seed=seed,
                refit=refit,
                mean=mean,
                data=data_file,
                columns=given_columns(columns),
                method=method,
                way=None if way is None else positive("way", way),
                points=points,
                friction_error=friction_error,
                distance=distance,
            ),
            shown(progress),
        )
    for text in found["warnings"]:
        warnings.warn(text, stacklevel=2)
    return Ranking._of(found)
