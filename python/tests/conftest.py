"""What the tests share."""

import os
import subprocess
import sys
from pathlib import Path

import asperity
import matplotlib
import pytest

matplotlib.use("Agg")

SCENES = Path(__file__).parents[2] / "scenes"

SMALL = """
name = "small"
[layer]
masses = 8
spacing = 1e-4
mass = 1e-6
[layer.vertical]
stiffness = 2e3
damping = 1e-2
maxwell = [{ stiffness = 1.5e3, relaxation_time = 1e-4 }]
[layer.horizontal]
stiffness = 1e3
damping = 8e-3
[surface]
kind = "sinusoid"
amplitude = 1e-5
wavelength = 4e-4
[friction]
coulomb = 0.3
[fmu]
outputs = ["forces", "dissipation", "contact", "tangent"]
[[excitation]]
duration = 1e-3
w_rate = -2e-2
[[excitation]]
duration = 2e-3
u_rate = 0.1
"""


@pytest.fixture
def small():
    """A layer of a few masses, pressed and slid."""
    return asperity.Scene(SMALL)


@pytest.fixture
def block():
    """A block of rubber on a rough road, which steady sliding is solved for."""
    return asperity.Scene.from_toml(SCENES / "sweep" / "block.toml")


def names(figure):
    """What the legends of a figure name."""
    return [text.get_text() for legend in figure.legends for text in legend.get_texts()]


def program(*arguments, folder, allowed=(0,)):
    """Runs the program: the one that ASPERITY_PROGRAM names, else the command of this package."""
    named = os.environ.get("ASPERITY_PROGRAM")
    command = [named] if named else [sys.executable, "-m", "asperity"]
    ran = subprocess.run([*command, *map(str, arguments)], cwd=folder, check=False, capture_output=True, text=True)
    assert ran.returncode in allowed, ran.stderr
    return ran
