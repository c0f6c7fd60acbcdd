"""Pads in MuJoCo against closed solutions."""

import math
import os
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest

mujoco = pytest.importorskip("mujoco")
pytest.importorskip("fmpy")

from asperity.mujoco import PatchFmu, attach, step  # noqa: E402

REFERENCE = Path(__file__).resolve().parents[2] / "tests/reference/patch"
# Of that table, at all speeds and pressures: the friction coefficient, and the tangential stiffness, Pa/m.
FRICTION, STIFFNESS = 0.9, 1.5e9
GRAVITY = 9.81


@pytest.fixture(scope="module")
def pack(tmp_path_factory):
    """Packs a patch on the table of a bed of springs; returns the FMU's path."""

    def packed(patch, **files):
        folder = tmp_path_factory.mktemp("patch")
        shutil.copy(REFERENCE / "winkler.table.csv", folder)
        for name, text in files.items():
            (folder / f"{name}.csv").write_text(text)
        text = f'name = "pad"\ntable = {{ path = "winkler.table.csv" }}\n[patch]\n{patch}\n[fmu]\noutputs = ["forces"]\n'
        (folder / "pad.toml").write_text(text)
        program = os.environ.get("ASPERITY", "asperity")
        command = [program, "pack", "--patch", folder / "pad.toml", "-o", folder / "pad.fmu"]
        subprocess.run(command, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        return folder / "pad.fmu"

    return packed


@pytest.fixture(scope="module")
def square(pack):
    return pack('shape = "flat"\nlength = 0.02\nwidth = 0.02\nnx = 10\nny = 10')


def run(model, data, pads, duration):
    corrections = [step(model, data, pads) for _ in range(round(duration / model.opt.timestep))]
    return max(corrections)


def block(angle, h=1e-3):
    """A block of 1 kg on a plane that falls along x by an angle, pressed in by its weight."""
    place = -mass_pressed(GRAVITY * math.cos(angle))
    return scene(
        f"""<mujoco><option timestep="{h}" gravity="{GRAVITY * math.sin(angle)} 0 {-GRAVITY * math.cos(angle)}"/>
        <worldbody><geom name="ground" type="plane" size="1 1 1" contype="0" conaffinity="0"/>
        <body name="block" pos="0 0 {place}"><freejoint/>
        <inertial pos="0 0 1e-4" mass="1" diaginertia="1e-3 1e-3 1e-3"/></body></worldbody></mujoco>"""
    )


def mass_pressed(load, area=4e-4, bed=5e9):
    """How far (m) a load (N) presses the bed of springs in."""
    return load / (bed * area)


def scene(text):
    model = mujoco.MjModel.from_xml_string(text)
    return model, mujoco.MjData(model)


@pytest.mark.parametrize("h", [1e-3, 2e-4])
def test_a_block_holds_below_the_angle_of_friction(square, h):
    model, data = block(0.99 * math.atan(FRICTION), h)
    pad = attach(model, data, square, "block", "ground")
    run(model, data, [pad], 0.5)
    place = data.qpos.copy()
    run(model, data, [pad], 0.5)
    assert np.abs(data.qpos - place).max() < 1e-15
    print(place, pad.loads)


@pytest.mark.parametrize("h", [1e-3, 2e-4])
def test_it_slides_above_it(square, h):
    angle = 1.01 * math.atan(FRICTION)
    model, data = block(angle, h)
    pad = attach(model, data, square, "block", "ground")
    n = run(model, data, [pad], 1.0)
    expected = GRAVITY * (math.sin(angle) - FRICTION * math.cos(angle))
    print(n, data.qvel, expected, data.qpos)
    # But for the way by which the springs stretch.
    assert data.qvel[0] == pytest.approx(expected, rel=1e-2)
