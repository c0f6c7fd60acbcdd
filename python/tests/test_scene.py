"""Scenes: keys, arrays, errors, copies."""

import copy
import pickle

import asperity
import numpy as np
import pytest
from asperity._arguments import axis, table_text
from conftest import SCENES, SMALL, names


def test_keys_are_read_set_and_added(small):
    assert small["layer.masses"] == 8 and "friction.shear_force" not in small
    small["friction.coulomb"] = np.float64(0.4)
    small["solver.relative_tolerance"] = 1e-4
    assert small["friction"] == {"coulomb": 0.4}
    assert small["layer.vertical.maxwell[1].stiffness"] == 1.5e3
    assert small["excitation[2].duration"] == 2e-3
    assert asperity.Scene(small.to_toml()) == small
    with pytest.raises(KeyError, match="layer.height"):
        small["layer.height"]


def test_a_dictionary_is_a_scene(small):
    keys = {name: small[name] for name in ("name", "layer", "surface", "friction", "fmu", "excitation")}
    keys["layer"]["masses"] = np.int64(8)
    assert asperity.Scene.from_dict(keys) == small


def test_temperatures_may_have_their_unit():
    assert axis("temperatures", ["20 °C", 300.0, "-5°C"]) == [268.15, 293.15, 300.0]
    assert axis("temperatures", "20 °C") == [293.15]
    with pytest.raises(ValueError, match="texts such as '20 °C', found '20 furlongs'"):
        axis("temperatures", ["20 furlongs"])


def test_a_frame_brings_the_units_that_it_keeps():
    pd = pytest.importorskip("pandas")
    frame = pd.DataFrame({"speed": [0.1], "pressure": [1e5], "temperature": [293.15], "friction": [1.0]})
    frame.attrs["units"] = {"speed": "m/s", "pressure": "Pa", "temperature": "K", "friction": "1"}
    assert table_text(frame).splitlines()[0] == "speed [m/s],pressure [Pa],temperature [K],friction"


def test_what_is_no_file_is_not_found(tmp_path):
    with pytest.raises(FileNotFoundError, match="no.toml"):
        asperity.Patch(tmp_path / "no.toml")
    with pytest.raises(FileNotFoundError):
        asperity.Scene.from_toml(tmp_path / "no.toml")


def test_errors_say_where():
    with pytest.raises(asperity.SceneError, match="expected a whole number") as raised:
        asperity.Scene(SMALL.replace("masses = 8", "masses = 0"), "small.toml")
    error = raised.value
    assert (error.key, error.line, error.file.name) == ("layer.masses", 4, "small.toml")
    assert str(pickle.loads(pickle.dumps(error))) == str(error)


def test_a_key_that_is_refused_leaves_the_scene(small):
    before = copy.copy(small)
    with pytest.raises(asperity.SceneError, match=r"did you mean friction.coulomb\?") as raised:
        small["friction.coulom"] = 0.4
    assert raised.value.key == "friction.coulom" and small == before
    with pytest.raises(asperity.SceneError, match="expected"):
        small["friction.coulomb"] = -1.0
    assert small == before
    with pytest.raises(TypeError, match="expected a number"):
        small["friction.coulomb"] = object()


def test_an_error_in_a_file_that_is_named_has_its_line(tmp_path):
    (tmp_path / "road.csv").write_text("x,z\n0,0\n1e-3,up\n")
    keys = {"kind": "file", "path": "road.csv"}
    text = SMALL.replace(
        'kind = "sinusoid"\namplitude = 1e-5\nwavelength = 4e-4', f'kind = "file"\npath = "{keys["path"]}"'
    )
    with pytest.raises(asperity.SceneError) as raised:
        asperity.Scene(text, tmp_path / "scene.toml")
    assert (raised.value.line, raised.value.file) == (3, tmp_path / "road.csv")


def test_a_profile_of_arrays_is_the_one_of_a_file(block):
    x, z = block.profile
    same = block.with_profile(x, z, periodic=True)
    assert same == block and same["surface.fine"] == block["surface.fine"]
    with pytest.raises(asperity.SceneError, match="expected"):
        block.with_profile(x, z[::-1] + np.arange(len(z)), periodic=True)


def test_a_map_keeps_its_bits(block):
    heights = 1e-5 * np.random.default_rng(1).normal(size=(16, 32))
    scene = block.with_map(heights, (2e-5, 4e-5))
    found, spacing = scene.map
    np.testing.assert_array_equal(found, heights)
    assert spacing == (2e-5, 4e-5)
    with pytest.raises(ValueError, match="shape"):
        block.with_map(heights[0], 2e-5)


def test_axes_of_a_map_count_by_their_names(block):
    pd = pytest.importorskip("pandas")
    heights = np.arange(6.0).reshape(2, 3)
    frame = pd.DataFrame(heights, pd.Index([0.0, 2e-4], name="y"), pd.Index([0.0, 1e-4, 2e-4], name="x"))
    for turned in (frame, frame.T, frame.T[::-1]):
        kept, spacing = block.with_map(turned, (1e-4, 2e-4), periodic=False).map
        assert np.array_equal(kept, heights) and spacing == (1e-4, 2e-4)
    with pytest.raises(ValueError, match="along x"):
        block.with_map(frame, 2e-4, periodic=False)


def test_masked_heights_are_missing(block):
    heights = np.ma.masked_greater(np.array([[0.0, 1e-6, 9.0, 1e-6]] * 4), 1.0)
    with pytest.raises(asperity.SceneError, match="missing"):
        block.with_map(heights, 1e-4, periodic=False)


def test_dates_and_spans_are_seconds(small):
    pd = pytest.importorskip("pandas")
    pose = {"u": [0.0, 0.0, 1e-4], "w": [0.0, -1e-5, -1e-5]}
    seconds = [0.0, 0.01, 0.02]
    times = [
        pd.to_timedelta(seconds, unit="s"),
        pd.date_range("2026-01-01", periods=3, freq="10ms"),
        np.array([0, 10, 20], "timedelta64[ms]"),
    ]
    for time in times:
        assert small.with_motion({"time": time, **pose}).duration == 0.02
    assert small.with_motion(pd.DataFrame(pose, pd.Index(seconds, name="time"))).duration == 0.02
    with pytest.raises(TypeError, match="time \\[ms\\]"):
        small.with_motion({"time [ms]": times[0], **pose})


def test_what_is_no_scene_is_refused_by_its_name(small, tmp_path):
    (tmp_path / "latin.toml").write_bytes("# \u00b5".encode("latin-1"))
    with pytest.raises(asperity.SceneError, match=r"latin\.toml"):
        asperity.Scene.from_toml(tmp_path / "latin.toml")
    with pytest.raises(TypeError, match="keys: expected a dictionary"):
        asperity.Scene.from_dict([1])
    with pytest.raises(TypeError, match="scenes: expected scenes"):
        asperity.rank([small, 1.0], [1.0], [3e5])


def test_a_spectrum_and_a_prony_series_come_in_as_arrays(block):
    q = np.geomspace(1e5, 1e8, 40)
    scene = block.with_spectrum(q, 1e-6 * q**-3.6, longest=2e-5)
    assert scene["surface.fine"]["spectrum"] == "with_spectrum.csv"
    scene = scene.with_prony([2e7, 3e6], [1e-6, 1e-3], equilibrium=4e6)
    # What one mode of each term gives: halfway at ω = 1/τ, by (2) of the paper.
    omega, shift = np.array([1.0, 1e4]), 1.0
    terms = sum(modulus * 1j * omega * time / (1 + 1j * omega * time) for modulus, time in ((2e7, 1e-6), (3e6, 1e-3)))
    np.testing.assert_allclose(scene.complex_modulus(omega * shift), 4e6 + terms, rtol=1e-12)


@pytest.mark.parametrize("copied", [copy.copy, copy.deepcopy, lambda scene: pickle.loads(pickle.dumps(scene))])
def test_copies_carry_their_files_and_are_independent(block, copied):
    other = copied(block.with_map(1e-6 * np.eye(16), 1e-5))
    del block
    again = copied(other)
    again["friction.shear_strength"] = 1e6
    assert other["friction.shear_strength"] == 6.5e6 and again != other
    assert again.map[0].shape == (16, 16)


def test_a_motion_is_followed_row_by_row(small):
    motion = {"time": [0.0, 1e-3, 3e-3], "u": [0.0, 0.0, 2e-4], "w": [0.0, -2e-5, -2e-5]}
    result = small.simulate(motion=motion)
    np.testing.assert_allclose(result.time, motion["time"], rtol=1e-15)
    # The scene's own excitation is the same motion.
    np.testing.assert_allclose(result["F_z"][-1], small.simulate(rows=1)["F_z"][-1], rtol=1e-9)


def test_results_go_to_pandas_xarray_and_pictures(small):
    result = small.simulate(rows=10, elements=True, times=[1.23e-3])
    assert 1.23e-3 in result.time and len(result) == 22
    assert result.elements["mode"].dtype == np.int64 and result.elements["x"].shape == (22, 8)
    frame, data = result.to_pandas(), result.to_xarray()
    assert frame.index.name == "time" and frame.attrs["units"]["F_z"] == "N"
    assert data["element_x"].dims == ("time", "mass") and data["F_z"].attrs["units"] == "N"
    assert len(result.plot("F_x", "F_z", "P_diss").axes) == 2
    assert "<img" in result._repr_html_()
    with pytest.raises(KeyError, match="fmu.outputs"):
        result["nothing"]


def test_progress_is_told_and_may_end_the_run(block):
    told = []
    block.sweep([0.1, 1.0], [1e5], method="layer", friction_error=0.5, progress=told.append)
    assert all(0.0 <= done <= 1.0 for done in told)

    def refuse(done):
        raise RuntimeError("enough")

    with pytest.raises(RuntimeError, match="enough"):
        slow = asperity.Scene.from_toml(SCENES / "road" / "slide.toml")
        slow.simulate(progress=refuse)


def test_a_sweep_of_what_does_not_slide_is_refused(small):
    with pytest.raises(asperity.SceneError, match="direct form"):
        small.sweep([0.1], [1e5])
    with pytest.raises(ValueError, match="speeds: expected numbers above 0"):
        small.sweep([-0.1], forces=[1.0])
    with pytest.raises(ValueError, match="steady"):
        small.sweep([0.1], forces=[1.0], method="fast")


def test_points_that_are_not_steady_are_warned_of_and_hollow(block):
    with pytest.warns(UserWarning, match="2 of 2 points are not steady or failed, the first: no stiffness"):
        table = asperity.Scene.from_toml(SCENES / "grip-mujoco" / "face.toml").sweep([1e-3, 1e-2], [1e-3])
    (hollow,) = table.plot().axes[0].lines
    assert len(hollow.get_xdata()) == 2 and hollow.get_markerfacecolor() == "white"


def test_what_is_no_table_is_refused():
    with pytest.raises(ValueError, match="expected 2"):
        asperity.Table("speed,pressure\n1\n")
    with pytest.raises(ValueError, match="# asperity sweep"):
        asperity.Table("speed,pressure\n1,2\n")


def test_a_scene_is_saved_with_its_files(small, block, tmp_path):
    changed = small.with_profile([0.0, 1e-4, 2e-4], [0.0, 1e-6, 0.0], periodic=True)
    for scene in (changed, block):
        file = scene.save(tmp_path / "folder" / "scene.toml", overwrite=True)
        assert asperity.Scene.from_toml(file) == scene and scene.save(file) == file
    with pytest.raises(FileExistsError, match="overwrite=True"):
        small.save(file)
    assert asperity.Scene.from_toml(file) == block


def test_a_motion_counts_from_its_first_row(small):
    motion = {"time": [0.0, 1e-3], "u": [0.0, 0.0], "w": [-1e-5, -2e-5]}
    with pytest.warns(UserWarning, match="motion: u and w count from the first row, 0.0 m and -1e-5 m"):
        offset = small.simulate(motion=motion)
    motion["w"] = [0.0, -1e-5]
    assert np.array_equal(offset["F_z"], small.simulate(motion=motion)["F_z"])
    with pytest.raises(ValueError, match="times: expected numbers from 0 to"):
        small.simulate(times=[np.nan])


def test_inputs_that_a_motion_lacks_stay_as_at_the_start(small):
    whole = {"time": [0.0, 1e-3, 3e-3], "u": [0.0, 0.0, 0.0], "w": [0.0, -2e-5, -3e-5]}
    with pytest.warns(UserWarning, match="motion: no column u: it stays as at the start"):
        result = small.simulate(motion={"time": whole["time"], "w": whole["w"]})
    assert np.array_equal(result["F_z"], small.simulate(motion=whole)["F_z"]) and result["F_z"][-1] > 0.0
    with pytest.raises(asperity.SceneError, match="time alone"):
        small.simulate(motion={"time": whole["time"]})


def test_a_motion_is_taken_from_a_file(small, tmp_path):
    motion = {"time": [0.0, 1e-3, 3e-3], "u": [0.0, 0.0, 2e-4], "w": [0.0, -2e-5, -2e-5]}
    path = tmp_path / "motion.csv"
    rows = zip(*motion.values(), strict=True)
    path.write_text("t [ms];x [mm];w [um]\n" + "".join(f"{1e3 * t};{1e3 * u};{1e6 * w}\n" for t, u, w in rows))
    for given in (path, str(path)):
        # The units' factors round.
        np.testing.assert_allclose(small.simulate(motion=given)["F_z"], small.simulate(motion=motion)["F_z"], rtol=1e-9)
    path.write_text("t [ms];w [um]\n0;0\n1;-20\n")
    with pytest.warns(UserWarning, match=r"motion\.csv: no column u: it stays as at the start"):
        small.with_motion(path)
    with pytest.raises(FileNotFoundError, match="nothing"):
        small.with_motion(tmp_path / "nothing.csv")


def test_a_compound_has_a_time_for_each_modulus(block):
    with pytest.raises(ValueError, match="2 moduli and 1 times"):
        block.with_prony([1e6, 2e6], [1e-3])


def test_files_that_are_missing_are_said_so(block):
    with pytest.raises(FileNotFoundError):
        asperity.fit("missing.csv")
    with pytest.raises(ValueError, match="`free`: expected a parameter to fit, found none"):
        block.calibrate({"speed": [0.1], "pressure": [1e5], "friction": [0.5]}, {})


def test_a_table_reads_back(block, tmp_path):
    table = block.sweep([0.1, 1.0], [1e5, 2e5, 4e5], [283.15, 293.15])
    assert table["friction"].shape == (2, 3, 2) and np.all(table.status == "steady")
    table.to_csv(tmp_path / "table.csv")
    again = asperity.Table.read(tmp_path / "table.csv")
    np.testing.assert_array_equal(again["friction"], table["friction"])
    data = pickle.loads(pickle.dumps(table)).to_xarray()
    assert data["friction"].dims == ("v", "p", "T") and float(data["p"][1]) == 2e5
    assert len(table.to_pandas()) == 12 and names(table.plot()) == ["100 kPa", "200 kPa", "400 kPa"]


SEAL = {
    "name": "seal",
    "layer": {"masses": 100, "spacing": 2e-5, "thickness": 3e-3, "width": 5e-3},
    "material": {
        "density": 1200.0,
        "poisson_ratio": 0.5,
        "equilibrium_modulus": 6e6,
        "prony": [{"modulus": 2e7, "relaxation_time": 1e-3}],
    },
    "surface": {"kind": "sinusoid", "amplitude": 1e-6, "wavelength": 2e-4},
    "friction": {"coulomb": 0.2},
}


def test_springs_that_are_no_rubber_are_warned_of():
    scene = asperity.Scene.from_dict(SEAL)
    assert not any("springs" in warning for warning in scene.warnings)
    scene["layer.foundation"] = "springs"
    assert any(warning.startswith('foundation = "springs": ') for warning in scene.warnings)


def test_a_key_that_is_missing_for_friction_to_be_that_of_rubber_is_named():
    scene = asperity.Scene.from_dict(SEAL | {"friction": {"shear_strength": 5e6}})
    with pytest.warns(UserWarning, match=r"friction is .* without surface.fine"):
        scene.sweep([0.1], [1e5])
    with pytest.warns(UserWarning, match="without surface.fine"):
        scene.contact(1e5, 0.1)
