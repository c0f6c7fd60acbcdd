"""The library's module for patches in MuJoCo, from its source: the package need not be built for it."""

import importlib.util
from pathlib import Path

_PATH = Path(__file__).resolve().parents[2] / "python/python/asperity/mujoco.py"
_SPEC = importlib.util.spec_from_file_location("asperity_mujoco", _PATH)
_MODULE = importlib.util.module_from_spec(_SPEC)
_SPEC.loader.exec_module(_MODULE)

PatchFmu, attach, step = _MODULE.PatchFmu, _MODULE.attach, _MODULE.step
