"""What the program's other commands say, in Python: describe, surface, converge, compare, and what shows a run."""

import json
import pickle

import asperity
import numpy as np
import pytest
from conftest import SCENES, names, program


def said(text):
    """Its words, wherever lines are broken."""
    return text.split()


@pytest.mark.parametrize("name", ["sweep/block", "tread-block/tread-block"])
def test_a_description_is_that_of_the_program(name, tmp_path):
    file = SCENES / f"{name}.toml"
    printed = program("-v", "describe", file, folder=tmp_path).stdout
    assert said(asperity.Scene.from_toml(file).describe()) == said(printed)


def test_a_patch_is_described_too(tmp_path):
    file = SCENES / "grip-mujoco" / "pad.toml"
    printed = program("-v", "describe", "--patch", file, folder=tmp_path).stdout
    assert said(asperity.Patch(file).describe()) == said(printed)


@pytest.fixture
def road(tmp_path):
    """A line in mm and µm."""
    x = np.linspace(0.0, 4e-3, 2001)
    waves = np.random.default_rng(1).normal(size=2001).cumsum()
    z = 1e-7 * (waves - waves.mean())
    np.savetxt(tmp_path / "road.csv", np.c_[1e3 * x, 1e6 * z], delimiter=",", header="x [mm],z [um]", comments="")
    return tmp_path / "road.csv"


@pytest.mark.parametrize(
    ("options", "keywords"),
    [
        ((), {}),
        (("--smooth", 5e-5, "--tilt", "remove", "--taper"), {"smooth": 5e-5, "tilt": "remove", "taper": True}),
        (("--split", 5e-5, "--mirror"), {"split": 5e-5, "mirror": True}),
        (("--wavelengths", "1e-5..1e-3", "--depth", "down"), {"wavelengths": (1e-5, 1e-3), "depth": "down"}),
    ],
)
def test_a_surface_is_that_of_the_program(road, options, keywords, tmp_path):
    printed = program("surface", road, *options, "--json", "--write", "out.csv", folder=tmp_path).stdout
    found = asperity.surface(road, **keywords)
    assert found.analysis == json.loads(printed)
    found.to_csv(tmp_path / "ours.csv")
    assert (tmp_path / "ours.csv").read_bytes() == (tmp_path / "out.csv").read_bytes()
    # A walk of some µm has a cut-off of 0.8 mm at most.
    assert found["roughness"]["cut_off"] <= 0.8e-3 and 0.0 < found["roughness"]["ra"] < found["roughness"]["rq"]
    assert len(found.plot().axes) == 2 and found.hurst == found["law"]["hurst"]
    # A matter of whether it was smoothed: what was read is drawn too.
    assert ("as read" in names(found.plot())) == (found["removed"] is not None)


def test_a_surface_in_memory_is_the_one_of_a_file(road):
    x, z = np.loadtxt(road, delimiter=",", skiprows=1).T
    found = asperity.surface({"x [mm]": x, "z [um]": z})
    assert found.analysis == asperity.surface(road).analysis and found.isotropic_spectrum is None
    with pytest.raises(ValueError, match="expected split="):
        found.spectrum_to_csv(road.with_name("spectrum.csv"))
    for keywords, expected in [
        ({"smooth": 1e-4, "split": 1e-4}, "smooth.*split.*expected one of them"),
        ({"mirror": True, "taper": True}, "mirror.*taper.*expected one of them"),
        ({"tilt": "away"}, '"away": expected one of "keep", "remove"'),
        ({"wavelengths": (1e-3, 1e-5)}, "wavelengths.*expected the shortest and the longest"),
        ({"periodic": True, "taper": True}, "taper.*periodic"),
        ({"columns": ["x", "y", "z"]}, "columns: expected those of x and z"),
        ({"smooth": 1.0}, "smooth` 1.0: expected at most 0.004"),
    ]:
        with pytest.raises(ValueError, match=expected):
            asperity.surface(road, **keywords)


def test_the_waves_that_are_split_off_go_into_a_scene(road, block, tmp_path):
    found = asperity.surface(road, split=5e-5, mirror=True)
    found.spectrum_to_csv(tmp_path / "spectrum.csv")
    q, C = found.isotropic_spectrum.T
    scene = block.with_profile(found.x, found.z, periodic=True).with_spectrum(q, C)
    np.testing.assert_allclose(np.loadtxt(tmp_path / "spectrum.csv", delimiter=",", skiprows=1), np.c_[q, C], rtol=0)
    assert scene.surface()["rms_height"] == found["rms_height"]


def test_a_map_is_analysed(block):
    x, y = np.meshgrid(np.arange(64) / 64, np.arange(32) / 32)
    heights = 1e-6 * (np.cos(2 * np.pi * x) + np.cos(4 * np.pi * y))
    found = block.with_map(heights, 1e-5).surface()
    # Two waves with a mean square of half their amplitudes' each.
    assert found["map"]["rms_height"] == pytest.approx(1e-6, rel=1e-12) and found.map[0].shape == (32, 64)
    assert found.isotropic_spectrum.shape[1] == 2


def columns(text):
    """The table without comments and run times, which are no result."""
    return [line.rsplit(",", 1)[0] for line in text.splitlines() if not line.startswith("#")]


def test_a_study_is_that_of_the_program(tmp_path):
    file = SCENES.parent / "tests" / "reference" / "half-plane" / "rough.toml"
    at = ["--pressure", 1e5, "--speed", 0.1, "--points", 128, "--most-points", 512]
    status = {0: True, 3: False}
    ran = program("converge", file, *at, "--error", 0.2, "-o", "out.csv", folder=tmp_path, allowed=status)
    scene, told = asperity.Scene.from_toml(file), []
    study = scene.converge(1e5, 0.1, error=0.2, points=128, most_points=512, progress=told.append)
    written = (tmp_path / "out.csv").read_text()
    assert columns(study.text) == columns(written) and f"# verdict = {study.verdict}" in written
    assert study.is_converged == status[ran.returncode] and set(study.open) >= {"spacing"}
    assert len(study["friction"]) == len(study) == len(study.to_pandas()) and study.units["spacing"] == "m"
    assert len(study.plot().axes) == 2 and study.parts == "points"
    with pytest.raises(ValueError, match="error = 0: expected a number above 0"):
        scene.converge(1e5, 0.1, error=0)


def test_a_comparison_is_that_of_the_program(block, tmp_path):
    table = block.sweep([0.01, 0.1, 1.0], [1e5, 2e5])
    table.to_csv(tmp_path / "table.csv")
    data = {
        "speed [m/s]": [0.01, 0.05, 0.5, 5.0],
        "pressure [bar]": [1.0, 1.5, 2.0, 2.0],
        "friction": [0.7, 0.7, 0.6, 0.5],
    }
    rows = zip(*data.values(), strict=True)
    (tmp_path / "data.csv").write_text(",".join(data) + "\n" + "".join(f"{v},{p},{mu}\n" for v, p, mu in rows))
    printed = program("compare", "table.csv", "--data", "data.csv", "-o", "out.svg", folder=tmp_path)
    with pytest.warns(UserWarning, match=r"1 of 4 measurements are left out: line 5 .*: the table does not reach"):
        found = table.compare(data)
    assert [one.line for one in found.left_out] == [5] and len(found.points) == 3
    assert f"{float(f'{found.chi_square:.4g}'):g}, " in printed.stdout
    at_point = next(one for one in found.points if one.line == 2)
    assert at_point.swept == table["friction"][0, 0, 0]
    # 5 % of it and 0.01, where nothing is given.
    assert at_point.sigma == pytest.approx(np.hypot(0.05 * 0.7, 0.01)) and found.sigma_assumed
    assert found.points[0].deviations == max((one.deviations for one in found.points), key=abs)
    assert len(found.to_pandas()) == 3 and names(found.plot())[-1] == "measured"
    with pytest.raises(ValueError, match="it has none"), pytest.warns(UserWarning, match="1 of 1"):
        table.compare({"speed": [5.0], "pressure": [1e5], "friction": [0.5]})


def test_an_animation_is_that_of_the_program(small, tmp_path):
    file = small.save(tmp_path / "small.toml")
    program("simulate", file, "-o", "out.csv", "--rows", 20, "--animate", "theirs.html", folder=tmp_path)
    result = small.simulate(rows=20, elements=True)
    assert result.animate(tmp_path / "ours.html").read_bytes() == (tmp_path / "theirs.html").read_bytes()
    with pytest.raises(ValueError, match=r"ends in \.html"):
        result.animate(tmp_path / "ours.gif")
    with pytest.raises(ValueError, match="elements=True"):
        small.simulate().animate(tmp_path / "ours.html")


def test_the_contact_of_a_run_is_that_of_its_row(small):
    result = small.simulate(rows=4, elements=True, times=[1.5e-3])
    row = int(np.flatnonzero(result.time == 1.5e-3)[0])
    contact = result.contact(1.5e-3)
    assert contact.time == 1.5e-3 and contact.slides > 0.0 and (contact.load_name, contact.load_unit) == (
        "normal force",
        "N",
    )
    for name, column in (("x", "x"), ("z", "z"), ("load", "F_N")):
        np.testing.assert_array_equal(getattr(contact, name), result.elements[column][row])
    modes = {0: "free", 2: "sticks"}
    assert list(contact.touch) == [modes.get(mode, "slips") for mode in result.elements["mode"][row]]
    figure = pickle.loads(pickle.dumps(contact)).plot()
    note = figure.texts[-1].get_text()
    assert "times as large" in note and note.endswith("the rubber slides →")
    touching = sum(len(bars.get_paths()) for bars in figure.axes[1].collections)
    assert names(figure) == ["rubber", "profile", "sticks", "slips", "free"] and touching == sum(contact.load > 0.0)
    with pytest.raises(ValueError, match="expected a time of the run, 0 to 0.003 s"):
        result.contact(4e-3)
