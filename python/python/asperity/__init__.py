"""Rubber on a rough, hard surface: transient contact, friction, calibration, FMUs.

    scene = asperity.Scene.from_toml("scene.toml")
    result = scene.simulate(points=200)
    result["F_x"], result.time

All numbers are in SI units. The manual is docs/python.md of the repository, the keys of a scene are in
docs/reference.md.
"""

from . import fmi
from ._calibration import Calibration, Parameter
from ._comparison import Comparison
from ._contact import Contact
from ._convergence import Convergence
from ._errors import SceneError, SimulationError
from ._fit import Fit, fit
from ._laws import FrictionFit, Scaling, fit_friction, scale_tir
from ._moment import Moment
from ._native import __version__
from ._patch import Patch, PatchState
from ._ranking import Ranking, rank
from ._result import Result
from ._scene import Scene
from ._seal import Seal, SealState, Stribeck
from ._simulation import Simulation, State
from ._slip import MagicFormula, SlipCurves
from ._surface import Surface, surface
from ._table import Table

__all__ = [
    "Calibration",
    "Comparison",
    "Contact",
    "Convergence",
    "Fit",
    "FrictionFit",
    "MagicFormula",
    "Moment",
    "Parameter",
    "Patch",
    "PatchState",
    "Ranking",
    "Result",
    "Scaling",
    "Scene",
    "SceneError",
    "Seal",
    "SealState",
    "Simulation",
    "SimulationError",
    "SlipCurves",
    "State",
    "Stribeck",
    "Surface",
    "Table",
    "__version__",
    "fit",
    "fit_friction",
    "fmi",
    "rank",
    "scale_tir",
    "surface",
]
