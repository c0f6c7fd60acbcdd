"""The module and the program are one: the same numbers, to the last bit."""

import asperity
import numpy as np
import pytest
from conftest import SCENES, program

# All shipped scenes that have a motion and run within some seconds.
MOVED = [
    "coupled/inside",
    "damper/damper",
    "figure-7/high",
    "figure-7/low",
    "figure-7/middle",
    "stiff/stiff",
    "tester/tester",
    "tread-block/tread-block",
    "tread-block-rubber/tread-block-rubber",
]


@pytest.mark.parametrize("name", MOVED)
@pytest.mark.filterwarnings("ignore")
def test_a_run_is_that_of_the_program(name, tmp_path):
    file = SCENES / f"{name}.toml"
    program("simulate", file, "-o", "out.csv", "--rows", 20, folder=tmp_path)
    written = np.genfromtxt(tmp_path / "out.csv", delimiter=",", names=True, deletechars="", dtype=np.float64)
    result = asperity.Scene.from_toml(file).simulate(rows=20)
    # Processor time is no result.
    names = [column for column in result if column != "solver.run_time"]
    assert set(names) <= set(written.dtype.names) and len(names) > 4
    for column in names:
        np.testing.assert_array_equal(result[column], written[column], err_msg=column)


@pytest.mark.parametrize(
    ("name", "speeds", "pressures"), [("sweep/block", [0.1, 1.0], [1e5, 2e5]), ("two-maxima/two-maxima", [0.01], [4e5])]
)
def test_a_sweep_is_that_of_the_program(name, speeds, pressures, tmp_path):
    file = SCENES / f"{name}.toml"
    axes = ["--speeds", ",".join(map(str, speeds)), "--pressures", ",".join(map(str, pressures))]
    program("sweep", file, *axes, "-o", "out.csv", folder=tmp_path)
    table = asperity.Scene.from_toml(file).sweep(speeds, pressures)
    assert table.text == (tmp_path / "out.csv").read_text()


def test_a_contact_is_that_of_the_program(block, tmp_path):
    at = ["--pressure", 2e5, "--speed", 0.1]
    program("contact", block.file, *at, "-o", "out.png", "--write", "out.npz", folder=tmp_path)
    written, contact = np.load(tmp_path / "out.npz"), block.contact(2e5, 0.1)
    for name in ("x", "y", "height", "pressure", "gap"):
        np.testing.assert_array_equal(getattr(contact, name), written[name])


def test_an_fmu_is_that_of_the_program(block, tmp_path):
    import zipfile

    packed = block.pack(tmp_path / "ours.fmu")
    library = next((packed.parent / "x").parent.glob("ours.fmu"))
    from asperity._library import options

    program("pack", block.file, "-o", "theirs.fmu", *(f"--library={one}" for one in options()), folder=tmp_path)
    ours, theirs = zipfile.ZipFile(library), zipfile.ZipFile(tmp_path / "theirs.fmu")
    # The program adds a picture.
    pictures = ("model.png", "terminalsAndIcons/icon.png")
    assert ours.namelist() == [name for name in theirs.namelist() if name not in pictures]
    # The text of the scene may be written anew.
    same = [name for name in ours.namelist() if not name.endswith((".toml", ".xml"))]
    assert all(ours.read(name) == theirs.read(name) for name in same)
