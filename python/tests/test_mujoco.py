"""Pads in MuJoCo against closed solutions."""

import math
import shutil
from pathlib import Path

import asperity
import numpy as np
import pytest

mujoco = pytest.importorskip("mujoco")
pytest.importorskip("fmpy")

from asperity.mujoco import PatchFmu, attach, step  # noqa: E402

REFERENCE = Path(__file__).resolve().parents[2] / "tests/reference/patch"
# Of that table, at all speeds and pressures: friction coefficient, stiffness along the plane and normal to it (Pa/m).
FRICTION, STIFFNESS, BED = 0.9, 1.5e9, 5e9
GRAVITY = 9.81


@pytest.fixture(scope="module")
def pack(tmp_path_factory):
    """Packs a patch on the table of a bed of springs; returns the FMU's path."""

    def packed(patch, **files):
        folder = tmp_path_factory.mktemp("patch")
        shutil.copy(REFERENCE / "winkler.table.csv", folder)
        for name, text in files.items():
            (folder / f"{name}.csv").write_text(text)
        table = 'table = { path = "winkler.table.csv" }'
        text = f'name = "pad"\n{table}\n[patch]\n{patch}\n[fmu]\noutputs = ["forces"]\n'
        (folder / "pad.toml").write_text(text)
        asperity.Patch(folder / "pad.toml").pack(folder / "pad.fmu")
        return folder / "pad.fmu"

    return packed


@pytest.fixture(scope="module")
def square(pack):
    return pack('shape = "flat"\nlength = 0.02\nwidth = 0.02\nnx = 10\nny = 10')


def scene(text):
    model = mujoco.MjModel.from_xml_string(text)
    return model, mujoco.MjData(model)


def run(model, data, pads, duration):
    """Returns how often the loads were corrected in a step, at most."""
    return max(step(model, data, pads) for _ in range(round(duration / model.opt.timestep)))


def block(angle=0.0, h=1e-3, load=GRAVITY):
    """A block of 1 kg on a plane that falls along x by an angle, pressed in by what it bears of a load (N)."""
    along, down = load * math.sin(angle), load * math.cos(angle)
    return scene(
        f"""<mujoco><option timestep="{h}" gravity="{along} 0 {-down}"/>
        <worldbody><geom name="ground" type="plane" size="1 1 1" contype="0" conaffinity="0"/>
        <body name="block" pos="0 0 {-pressed(down)}"><freejoint/>
        <inertial pos="0 0 0" mass="1" diaginertia="1e-3 1e-3 1e-3"/></body></worldbody></mujoco>"""
    )


def pressed(load, area=4e-4):
    """How far (m) a load (N) presses the bed of springs in."""
    return load / (BED * area)


@pytest.mark.parametrize("h", [1e-3, 2e-4])
def test_a_block_holds_below_the_angle_of_friction(square, h):
    model, data = block(0.99 * math.atan(FRICTION), h)
    pad = attach(model, data, square, "block", "ground")
    run(model, data, [pad], 2.0)
    place = data.qpos[:3].copy()
    run(model, data, [pad], 1.0)
    # m, in a second: a thousand roundings of 1e-4 m.
    assert np.abs(data.qpos[:3] - place).max() < 1e-16
    assert pad.loads[0] == pytest.approx(-GRAVITY * math.sin(0.99 * math.atan(FRICTION)), rel=1e-9)


@pytest.mark.parametrize("h", [1e-3, 2e-4])
def test_it_slides_above_it(square, h):
    angle = 1.01 * math.atan(FRICTION)
    model, data = block(angle, h)
    pad = attach(model, data, square, "block", "ground")
    run(model, data, [pad], 0.5)
    before = data.qvel[0]
    run(model, data, [pad], 0.5)
    expected = GRAVITY * (math.sin(angle) - FRICTION * math.cos(angle))
    assert (data.qvel[0] - before) / 0.5 == pytest.approx(expected, rel=1e-5)
    assert pad.loads[0] == pytest.approx(-FRICTION * pad.loads[2], rel=1e-9)


def test_it_comes_to_rest_where_coulomb_stops_it(square):
    """Pushed by 0.2 m/s it stops, and stands; the stiff springs do not ring."""
    model, data = block()
    pad = attach(model, data, square, "block", "ground")
    data.qvel[0] = 0.2
    assert run(model, data, [pad], 0.5) < 12
    # But for a step, and what the springs stretch.
    assert data.qpos[0] == pytest.approx(0.2**2 / (2 * FRICTION * GRAVITY), abs=0.2 * 1e-3)
    place = data.qpos[0]
    run(model, data, [pad], 0.5)
    assert abs(data.qpos[0] - place) < 1e-15


def test_a_step_is_the_implicit_one(square):
    """Along the normal the bed is a spring: step by step what Euler's implicit method makes of it."""
    h, spring = 1e-3, BED * 4e-4
    model, data = block(h=h, load=100.0)
    data.qpos[2] *= 0.8
    pad = attach(model, data, square, "block", "ground")
    z, v = data.qpos[2], 0.0
    for _ in range(30):
        step(model, data, [pad])
        v = (v + h * (-100.0 - spring * z)) / (1.0 + spring * h**2)
        z += h * v
        # Newton's method ends at 2 % of the change of the loads in a step, here of 13 N in the first.
        assert data.qpos[2] == pytest.approx(z, abs=2e-3 * pressed(100.0))


def test_halving_the_step_halves_the_error(square):
    """A block that sticks and swings on its springs by (v/w) sin(w t), and does not turn."""
    spring, speed, until = STIFFNESS * 4e-4, 1e-3, 2e-3
    frequency = math.sqrt(spring)
    exact, errors = speed / frequency * math.sin(frequency * until), []
    for h in (1e-4, 5e-5, 2.5e-5):
        model, data = block(h=h)
        pad = attach(model, data, square, "block", "ground")
        data.qvel[0] = speed
        run(model, data, [pad], until)
        errors.append(abs(data.qpos[0] - exact))
    for coarse, fine in zip(errors, errors[1:]):
        # 2 + O(h w), h w = 0.08 at most.
        assert coarse / fine == pytest.approx(2.0, abs=0.2)


def disc(rings=20, around=24, radius=0.01):
    """A flat round pad as points: rings of even width, each element with its area."""
    text, width = "x,y,z,area\n", radius / rings
    for i in range(rings):
        r = (i + 0.5) * width
        for j in range(around):
            angle = 2 * math.pi * (j + 0.5 * (i % 2)) / around
            text += f"{r * math.cos(angle)},{r * math.sin(angle)},0,{2 * math.pi * r * width / around}\n"
    return text


def test_a_round_pad_drills_with_two_thirds(pack):
    """Under even pressure a disc turns against 2/3 mu N a: it holds 0.99 of that and spins under 1.01 of it."""
    radius, load, inertia = 0.01, 20.0, 1e-3
    fmu = pack('shape = "points"\npath = "disc.csv"', disc=disc(radius=radius))
    limit = 2 / 3 * FRICTION * load * radius
    for share in (0.99, 1.01):
        model, data = scene(
            f"""<mujoco><option gravity="0 0 {-load}"/><worldbody>
            <geom name="ground" type="plane" size="1 1 1" contype="0" conaffinity="0"/>
            <body name="disc" pos="0 0 {-pressed(load, math.pi * radius**2)}">
            <joint name="z" type="slide" axis="0 0 1"/><joint name="turn" axis="0 0 1"/>
            <inertial pos="0 0 0" mass="1" diaginertia="1e-3 1e-3 {inertia}"/></body></worldbody></mujoco>"""
        )
        pad = attach(model, data, fmu, "disc", "ground")
        data.qfrc_applied[1] = share * limit
        run(model, data, [pad], 1.0)
        before = data.qvel[1]
        run(model, data, [pad], 0.5)
        if share < 1.0:
            # rad/s; the last elements yield as slowly as they like.
            assert abs(data.qvel[1]) < 1e-9
            assert pad.loads[5] == pytest.approx(-share * limit, rel=1e-6)
        else:
            # Of 20 rings the arm is 1/1600 shorter than of a disc.
            assert pad.loads[5] == pytest.approx(-limit, rel=1e-3)
            assert (data.qvel[1] - before) / 0.5 == pytest.approx((share - 1.0) * limit / inertia, rel=0.1)


def test_a_wheel_creeps_as_a_brush_does(pack):
    """A wheel drives a carrier against a drag, steadily: the slip that its force takes, of the brush model."""
    radius, half, width, speed = 0.3, 8e-3, 0.02, 2.0
    depth = half**2 / (2 * radius)
    load = 4 / 3 * BED * width * half * depth
    text = f'shape = "cylinder"\nradius = {radius}\nlength = 0.02\nwidth = {width}\nnx = 50\nny = 2\ntransport = true'
    # (1 - q)^3 = 1 - F/(mu N)
    force = 0.5 * FRICTION * load
    q = 1.0 - 0.5 ** (1 / 3)
    slip = 3 * q * FRICTION * load / (2 * STIFFNESS * half**2 * width)
    # The tread lies on a chord: what rolls freely has the mean of the heights below the axis.
    rolling = radius - depth / 3
    model, data = scene(
        f"""<mujoco><option gravity="0 0 {-load / 10.0}"/><worldbody>
        <geom name="ground" type="plane" size="1 1 1" contype="0" conaffinity="0"/>
        <body name="carrier" pos="0 0 {radius - depth}">
        <joint name="x" type="slide" axis="1 0 0" damping="{force / speed}"/>
        <joint name="z" type="slide" axis="0 0 1" damping="1e4"/><inertial pos="0 0 0" mass="9" diaginertia="1 1 1"/>
        <body name="wheel"><joint name="spin" axis="0 1 0"/>
        <inertial pos="0 0 0" mass="1" diaginertia=".05 .1 .05"/></body></body></worldbody></mujoco>"""
    )
    data.joint("x").qvel[0] = speed
    data.joint("spin").qvel[0] = speed * (1 + slip) / rolling
    pad = attach(model, data, pack(text), "carrier", "ground", spin=("spin", radius))
    data.joint("spin").qfrc_applied[0] = force * rolling
    run(model, data, [pad], 0.5)
    means = []
    for _ in range(500):
        step(model, data, [pad])
        tread = rolling * data.joint("spin").qvel[0]
        means.append([1.0 - data.joint("x").qvel[0] / tread, pad.loads[0], pad.loads[2]])
    found, along, normal = np.mean(means, axis=0)
    assert normal == pytest.approx(load, rel=2e-3)
    # The drag of a carrier at this speed, slowly coming to it.
    assert along == pytest.approx(force, rel=1e-2)
    # Of 40 cells in contact the tread's ends are met to a cell.
    assert found == pytest.approx(slip, rel=3e-2)


def test_what_presses_is_pressed_back(square):
    """A block that hits a free box and slides on it: momentum stays, with the ground turning."""
    model, data = scene(
        """<mujoco><option gravity="0 0 0"/><worldbody>
        <body name="ground" quat="0.9 0.1 0.3 -0.2"><freejoint/>
        <geom name="ground" type="box" size="0.1 0.1 0.05" mass="2" contype="0" conaffinity="0"/></body>
        <body name="block" quat="0.9 0.1 0.3 -0.2"><freejoint/>
        <inertial pos="0 0 0" mass="1" diaginertia="1e-3 1e-3 1e-3"/></body></worldbody></mujoco>"""
    )
    mujoco.mj_forward(model, data)
    normal = data.geom("ground").xmat.reshape(3, 3)[:, 2]
    data.qpos[7:10] = (0.05 + 1e-5) * normal
    data.qvel[6:9] = -0.2 * normal + [0.1, 0.0, 0.02]
    data.qvel[3:6] = [0.0, 0.0, 0.5]
    pad = attach(model, data, square, "block", "ground")
    before, pressing = 2 * data.qvel[:3] + data.qvel[6:9], 0.0
    for _ in range(20):
        step(model, data, [pad])
        pressing = max(pressing, pad.loads[2])
        assert np.abs(2 * data.qvel[:3] + data.qvel[6:9] - before).max() < 1e-14
    assert pressing > 1.0


def test_what_cannot_be_is_refused(square):
    model, data = scene(
        """<mujoco><worldbody><geom name="ball" type="sphere" size="1"/><geom name="plane" type="plane" size="1 1 1"/>
        <body name="block" pos="0 0 2"><freejoint/><geom size="0.1"/></body></worldbody></mujoco>"""
    )
    mujoco.mj_forward(model, data)
    with pytest.raises(ValueError, match="geom 'ball': expected a plane or a box, found mjGEOM_SPHERE"):
        attach(model, data, square, "block", "ball")
    with pytest.raises(ValueError, match="tread"):
        attach(model, data, square, "block", "plane", spin=("spin", 0.3))
    model.opt.integrator = mujoco.mjtIntegrator.mjINT_RK4
    with pytest.raises(ValueError, match="integrator: .* found RK4"):
        attach(model, data, square, "block", "plane")


@pytest.mark.parametrize("own, warned", [('name="own"', True), ('contype="0" conaffinity="0"', False)])
def test_a_pad_that_collides_in_mujoco_too_is_warned_of(square, recwarn, own, warned):
    model, data = scene(
        f"""<mujoco><worldbody><geom name="ground" type="plane" size="1 1 1"/>
        <body name="block" pos="0 0 0.001"><freejoint/><geom {own} type="box" size="0.01 0.01 0.01" mass="1"/></body>
        </worldbody></mujoco>"""
    )
    attach(model, data, square, "block", "ground")
    found = [str(warning.message) for warning in recwarn if "collide" in str(warning.message)]
    assert len(found) == warned and all("'own'" in text and "'ground'" in text for text in found)
