"""Contact patches, and FMUs of tables."""

import warnings

import asperity
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
