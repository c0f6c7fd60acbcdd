"""Property files of tyres, and laws of friction for other programs."""

import asperity
import numpy as np
import pytest
from conftest import SCENES, program


def test_a_property_file_is_scaled_as_by_the_program(tmp_path):
    base, slips = SCENES / "slip" / "tread.tir", np.linspace(-0.3, 0.3, 41)
    for road in ("asphalt", "smooth"):
        asperity.Patch(SCENES / "slip" / f"{road}.toml").slip([4e3], slips).save(tmp_path / f"{road}.csv")
    tables = [tmp_path / "asphalt.csv", tmp_path / "smooth.csv"]
    with pytest.warns(UserWarning, match="LMUY and LKY stay"):
        scaled = asperity.scale_tir(base, *tables, tmp_path / "own.tir", carcass=[3e5, 2e5])
    options = ["--from", tables[0], "--to", tables[1], "--carcass", "3e5,2e5", "-o", "its.tir"]
    program("tir", base, *options, folder=tmp_path)
    assert (tmp_path / "own.tir").read_bytes() == (tmp_path / "its.tir").read_bytes()
    assert set(scaled) == {"LMUX", "LKX"} and scaled["LMUX"].before == 1.0 and scaled["LMUX"].after < 1.0
    with pytest.raises(ValueError, match="`carcass`: expected"):
        asperity.scale_tir(base, *tables, tmp_path / "own.tir", carcass=-1.0)


def test_a_law_is_fitted_at_each_temperature():
    fits = asperity.fit_friction(SCENES / "rod-seal" / "rod.sweep.csv", "lugre")
    assert [fit.temperature for fit in fits] == [293.15, 313.15, 333.15, 353.15]
    for fit in fits:
        # Friction of that rod is nearly all adhesion, 0.12 of the pressure.
        value, error = fit.numbers["coulomb_coefficient"]
        assert value == pytest.approx(0.12, rel=0.2) and error < 0.1 * value
        assert fit.numbers["sigma_0"] is None and fit.rms < 0.1 * fit.largest
    with pytest.raises(ValueError, match="expected stribeck or lugre"):
        asperity.fit_friction(SCENES / "rod-seal" / "rod.sweep.csv", "dahl")
