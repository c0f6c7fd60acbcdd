"""Rankings, and the covariance that a calibration hands on."""

import asperity
import numpy as np
import pytest


def test_scenes_are_ranked(block):
    other = block.with_keys({"name": "stronger", "friction.shear_strength": 6.6e6})
    weights = {"speed [m/s]": [0.01, 0.1], "weight": [3.0, 1.0]}
    ranking = asperity.rank([block, other], [1e-2, 0.1], [1e5], weights=weights)
    # Without [uncertainty] there is an order, and nothing to say how sure it is.
    assert ranking.order == (1, 0) and not ranking.is_sure and ranking.samples == 0
    assert ranking.index[0] == 100.0 and ranking.points[:, 3] == pytest.approx([0.75, 0.25])
    swept = other.sweep([1e-2, 0.1], [1e5]).to_pandas()["friction"].to_numpy()
    assert ranking.friction[1] == pytest.approx(swept @ [0.75, 0.25], rel=1e-12)
    assert np.isnan(ranking.index_bands).all() and list(ranking.to_pandas().index) == ["stronger", ranking.scenes[0]]
    harmonic = asperity.rank([block, other], [1e-2, 0.1], [1e5], weights=weights, mean="harmonic")
    assert 1.0 / harmonic.friction[1] == pytest.approx((1.0 / swept) @ [0.75, 0.25], rel=1e-12)
    with pytest.raises(ValueError, match="no weight of"):
        asperity.rank([block, other], [1e-2, 0.1], [1e5], weights={"speed [m/s]": [0.01], "weight": [3.0]})


def test_common_numbers_tell_scenes_apart(block):
    uncertain = block.with_keys({"uncertainty": {"friction.shear_strength": {"relative": 0.1}}})
    other = uncertain.with_keys({"name": "stronger", "friction.shear_strength": 1.01 * block["friction.shear_strength"]})
    data = {"scene": [block.name, "stronger"], "speed [m/s]": [0.1, 0.1], "pressure [Pa]": [1e5, 1e5], "mu": [0.5, 0.6]}
    ranking = asperity.rank([uncertain, other], [1e-2, 0.1], [1e5], samples=32, data=data)
    # Both are known to 10 % and differ by 1 %.
    assert ranking.is_sure and ranking.above[1, 0] == 1.0 and ranking.above[0, 1] == 0.0 and ranking.ties[0, 1] == 0.0
    assert ranking.friction_bands[0, 4] > 1.1 * ranking.friction_bands[0, 0]
    assert np.ptp(ranking.index_bands[1]) < 0.1 and ranking.tau == 1.0
    same = asperity.rank([uncertain, uncertain], [1e-2, 0.1], [1e5], samples=32)
    assert same.above[0, 1] == 0.5 and same.ties[0, 1] == 1.0 and not same.is_sure


def test_a_calibration_writes_its_covariance(block, tmp_path):
    measured = block.sweep([1e-3, 1e-2, 0.1, 1.0], [1e5]).to_pandas()
    data = {"speed [m/s]": measured["speed"], "pressure [Pa]": measured["pressure"]}
    data |= {"temperature [K]": measured["temperature"], "friction": measured["friction"] * [1.02, 0.98, 1.02, 0.98]}
    found = block.calibrate(data, {"friction.shear_strength": (1e6, 2e7)})
    # Of the logarithm, whose standard error is that of the number over the number.
    relative = found.parameters[0].standard_error / found["friction.shear_strength"]
    assert found.covariance == pytest.approx(relative**2) and found.covariance_keys == ("friction.shear_strength",)
    found.save(tmp_path / "fitted.toml")
    assert 'covariance = "fitted.covariance.csv"' in (tmp_path / "fitted.toml").read_text(encoding="utf-8")
    row = (tmp_path / "fitted.covariance.csv").read_text(encoding="utf-8").splitlines()[-1].split(",")
    assert row[0] == "friction.shear_strength" and row[2] == "log" and float(row[3]) == found.covariance[0, 0]
    # What was written is a scene that says what is not known of it, beside the files that it names.
    (tmp_path / "profile.csv").write_bytes((block.file.parent / "profile.csv").read_bytes())
    fitted = asperity.Scene.from_toml(tmp_path / "fitted.toml")
    ranking = asperity.rank([fitted, fitted], [1e-2], [1e5], samples=16)
    assert ranking.samples == 16 and ranking.friction_bands[0, 4] > ranking.friction_bands[0, 0]
    # What varies beside it is counted twice, unless the strength is fitted anew in each sample.
    beside = fitted.with_keys({"uncertainty.\"material.prony\".relative": 0.2})
    with pytest.warns(UserWarning, match=r"material\.prony beside friction\.shear_strength"):
        wide = beside.sweep([1e-2], [1e5], samples=16)
    narrow = beside.sweep([1e-2], [1e5], samples=16, refit=True)
    band = [float((table["friction_q95"] / table["friction_q05"]).max()) for table in (wide, narrow)]
    own = float(ranking.friction_bands[0, 4] / ranking.friction_bands[0, 0])
    assert band[1] < 1.5 * (own - 1.0) + 1.0 and narrow.quantile(0.05, beside)["friction"].shape == (1, 1, 1)
    assert asperity.rank([beside, beside], [1e-2], [1e5], samples=4, refit=True).samples == 4
    with pytest.raises(ValueError, match="expected samples"):
        beside.sweep([1e-2], [1e5], refit=True)


def test_a_map_is_drawn_over_two_quantities(block):
    table = block.sweep(np.geomspace(1e-3, 10.0, 9), [1e5, 2e5], [283.15, 293.15, 303.15])
    figure = table.plot_map("speed", "temperature")
    # Two maps and the scale.
    assert len(figure.axes) == 3 and figure.axes[0].get_xscale() == "log" and figure.axes[1].get_title() == "200 kPa"
    figure.draw_without_rendering()
    assert table.plot_map("speed", "temperature", "contact_ratio").axes[2].get_title(loc="left") == "contact_ratio"
    with pytest.raises(ValueError, match="over pressure, not over force"):
        table.plot_map("speed", "force")
    with pytest.raises(ValueError, match="expected two of"):
        table.plot_map("speed", "speed")
    with pytest.raises(ValueError, match="at least 2 values"):
        block.sweep([0.1, 1.0], [1e5]).plot_map("speed", "pressure")
