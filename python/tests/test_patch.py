"""Contact patches, and FMUs of tables."""

import copy
import pickle
import warnings

import asperity
import numpy as np
import pytest
from conftest import SCENES


def test_a_patch_is_pressed_and_dragged(tmp_path):
    above = (0.0, 0.0, 0.5, 0.0, 0.0, 0.0)
    patch = asperity.Patch(SCENES / "patch-mujoco" / "tread.toml", pose=above)
    assert len(patch) > 1 and patch["force.z"] == 0.0
    while patch["force.z"] == 0.0:
        x, y, z, *angles = patch.pose
        patch.advance(1e-4, (x, y, z - 1e-4, *angles))
    patch.advance(1e-3, rates=(1.0, 0.0, 0.0, 0.0, 0.0, 0.0))
    assert patch.pose[0] == pytest.approx(1e-3, rel=1e-12) and patch.time > 1e-3
    # Friction is against the motion.
    assert patch["force.x"] < 0.0 and set(patch.units) == set(patch.names) and len(patch.values) == len(patch.names)
    with pytest.raises(KeyError, match="force: expected one of force.x"):
        patch["force"]
    with pytest.raises(ValueError, match="one of them"):
        patch.advance(1e-3, above, rates=above)
    assert patch.pack(tmp_path / "patch.fmu").stat().st_size > 1e5
    with pytest.raises(OSError, match="there is no folder"):
        patch.pack(tmp_path / "none" / "patch.fmu")


# A bed of springs of 1e9 Pa/m.
BED = """# asperity sweep = 1
# nominal_area = 1 m2
# rest_separation = 0 m
speed [m/s],pressure [Pa],temperature [K],status,friction [1],separation [m],tangential_stiffness [N/m]
1e-4,1e4,,steady,0.5,-1e-5,1e12
1,1e4,,steady,0.5,-1e-5,1e12
1e-4,1e5,,steady,0.5,-1e-4,1e12
1,1e5,,steady,0.5,-1e-4,1e12
"""
PAD = """name = "pad"
table = { path = "bed.csv" }
patch = { shape = "flat", length = 0.02, width = 0.01, nx = 2, ny = 1 }
"""


@pytest.fixture
def pad(tmp_path):
    """The file of a small pad on a bed of springs, up to 1e5 Pa."""
    (tmp_path / "bed.csv").write_text(BED)
    file = tmp_path / "pad.toml"
    file.write_text(PAD)
    return file


def test_a_patch_beyond_its_table_warns_once(pad):
    patch = asperity.Patch(pad)
    with pytest.warns(UserWarning, match=r"element\[1,1\] is beyond the table at t = ") as said:
        patch.advance(1e-3, (0.0, 0.0, -2e-4, 0.0, 0.0, 0.0))
    assert len(said) == 1 and said[0].filename == __file__
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        patch.advance(1e-3, (0.0, 0.0, -3e-4, 0.0, 0.0, 0.0))
    with pytest.warns(UserWarning, match="is beyond the table at t = 0 s"):
        asperity.Patch(pad, pose=(0.0, 0.0, -2e-4, 0.0, 0.0, 0.0))


def test_a_patch_that_is_read_to_be_packed_starts_nowhere(pad, tmp_path):
    file = tmp_path / "below.toml"
    keys = 'offset = [0, 0, -1]\n[table]\nextrapolation = "refuse"\npath = "bed.csv"\n'
    grid = 'shape = "flat"\nlength = 0.02\nwidth = 0.01\nnx = 2\nny = 1\n'
    file.write_text(f'name = "below"\n[patch]\n{grid}{keys}')
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert asperity.Patch(file).pack(tmp_path / "below.fmu").exists()
    with pytest.raises(asperity.SimulationError, match="beyond the table"):
        asperity.Patch(file)["force.z"]
    with pytest.raises(asperity.SimulationError, match="beyond the table"):
        asperity.Patch(file, pose=np.zeros(6))


def test_a_patch_without_a_tread_has_no_speed_of_one(pad):
    with pytest.raises(ValueError, match="the patch has no tread"):
        asperity.Patch(pad, transport_speed=1.0)
    with pytest.raises(ValueError, match="the patch has no tread"):
        asperity.Patch(pad).advance(1e-3, transport_speed=1.0)


DOWN = (0.0, 0.0, -5e-5, 0.0, 0.0, 0.0)
AHEAD = (0.1, 0.0, 0.0, 0.0, 0.0, 0.0)


def test_poses_and_rates_may_be_arrays(pad):
    one, other = asperity.Patch(pad), asperity.Patch(pad, pose=np.zeros(6))
    one.advance(1e-3, DOWN)
    other.advance(1e-3, np.array(DOWN))
    one.advance(1e-3, rates=AHEAD)
    other.advance(1e-3, rates=np.array(AHEAD))
    assert other["force.x"] < 0.0 and one.state == other.state
    with pytest.raises(ValueError, match="length 6"):
        one.advance(1e-3, rates=np.zeros(5))


@pytest.mark.parametrize("copied", [copy.copy, copy.deepcopy, lambda one: pickle.loads(pickle.dumps(one))])
def test_a_copy_of_a_patch_goes_on_bit_for_bit(pad, copied, tmp_path):
    first = asperity.Patch(pad, pose=DOWN)
    first.advance(1e-3, rates=AHEAD)
    second = copied(first)
    for patch in (first, second):
        patch.advance(1e-3, rates=AHEAD)
    assert np.array_equal(first.values, second.values) and first.state == second.state
    assert second.pack(tmp_path / "copy.fmu").stat().st_size > 1e5
    with pytest.raises(ValueError, match="will not write"):
        first.pack(pad)
    assert pad.read_text() == PAD


def test_a_state_of_a_patch_is_put_back(pad):
    patch = asperity.Patch(pad, pose=DOWN)
    state = pickle.loads(pickle.dumps(patch.state))
    patch.advance(1e-3, rates=AHEAD)
    there = patch.values
    patch.state = state
    assert patch.time == 0.0
    patch.advance(1e-3, rates=AHEAD)
    np.testing.assert_array_equal(patch.values, there)
    pad.write_text(PAD.replace("nx = 2", "nx = 3"))
    with pytest.raises(ValueError, match="2 elements, expected 3"):
        asperity.Patch(pad).state = state


def test_a_patch_that_cannot_go_on_says_why(pad):
    pad.write_text(PAD.replace('"bed.csv"', '"bed.csv", extrapolation = "refuse"'))
    patch = asperity.Patch(pad, pose=DOWN)
    before = patch.state
    with pytest.raises(asperity.SimulationError, match="beyond the table"):
        patch.advance(1e-3, rates=(0.0, 0.0, -1.0, 0.0, 0.0, 0.0))
    with pytest.raises(ValueError, match="dt = 0: expected a number above 0"):
        patch.advance(0.0)
    with pytest.raises(ValueError, match="out of range"):
        patch.advance(1e-3, rates=(float("nan"), 0.0, 0.0, 0.0, 0.0, 0.0))
    assert patch.state == before
    with pytest.raises(asperity.SimulationError, match="beyond the table"):
        asperity.Patch(pad, pose=(0.0, 0.0, -1e-3, 0.0, 0.0, 0.0))


def test_what_is_not_given_stays(tmp_path, pad):
    rows = BED.splitlines()
    laws = [(290, 0.5), (310, 0.3)]
    warm = [row.replace(",,steady,0.5", f",{kelvin},steady,{mu}") for kelvin, mu in laws for row in rows[4:]]
    (tmp_path / "bed.csv").write_text("\n".join(rows[:4] + warm) + "\n")
    patch = asperity.Patch(pad, pose=DOWN, temperature=310.0)
    for _ in range(2):
        patch.advance(1e-2, rates=AHEAD)
        assert -patch["force.x"] / patch["force.z"] == pytest.approx(0.3, rel=1e-6)
    patch.advance(1e-2, rates=AHEAD, temperature=290.0)
    patch.advance(1e-2, rates=AHEAD)
    assert -patch["force.x"] / patch["force.z"] == pytest.approx(0.5, rel=1e-6)


def test_a_patch_that_is_refused_says_where(tmp_path):
    (tmp_path / "patch.toml").write_text('name = "p"\ntable = 3\n')
    with pytest.raises(asperity.SceneError) as raised:
        asperity.Patch(tmp_path / "patch.toml")
    assert raised.value.line == 2 and raised.value.key == "table"


def test_a_table_is_packed_as_an_element(block, tmp_path):
    table = block.sweep([0.1, 1.0], [1e5, 2e5, 4e5])
    motion = {"time": [0.0, 1e-3], "u": [0.0, 1e-4], "w": [0.0, 0.0]}
    result = asperity.fmi.simulate(table.pack(tmp_path / "table.fmu"), motion)
    assert len(result) == 2 and "F_z" in result
    with pytest.raises(ValueError, match="expected columns time and some of"):
        asperity.fmi.simulate(tmp_path / "table.fmu", {"time": [0.0], "v": [0.0]})
