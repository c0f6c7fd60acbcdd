"""Slip curves of a patch."""

import asperity
import numpy as np
import pytest
from conftest import SCENES, names, program

TREAD = SCENES / "slip" / "asphalt.toml"


def test_slip_curves_and_their_formula_are_those_of_the_program(tmp_path):
    slips, angles = [-0.2, -0.1, -0.05, 0.0, 0.05, 0.1, 0.2], [-0.1, 0.1]
    tread = asperity.Patch(TREAD)
    curves = tread.slip([2e3, 4e3], slips, angles, temperatures=["40 °C"])
    formula = curves.magic_formula(4e3)
    options = ["--loads", "2000,4000", "--slips", "-0.2,-0.1,-0.05,0,0.05,0.1,0.2", "--angles", "-0.1,0.1"]
    more = ["--temperatures", "40°C", "--fit", "mf", "--nominal", "4kN", "-o", "slip.csv"]
    program("slip", TREAD, *options, *more, folder=tmp_path)
    assert curves.save(tmp_path / "own.csv").read_bytes() == (tmp_path / "slip.csv").read_bytes()
    assert formula.save(tmp_path / "own.mf.csv").read_bytes() == (tmp_path / "slip.mf.csv").read_bytes()
    assert set(curves.status) == {"steady"} and len(curves) == 18 and curves.units["M_z"] == "N m"
    # Rolling freely there is no force but for what it is found to, and friction has the sign of ISO 8855.
    straight = curves["slip_angle"] == 0.0
    assert np.all(np.abs(curves["F_x"][straight & (curves["slip"] == 0.0)]) < 1e-6 * 4e3)
    assert np.all(curves["F_x"][straight] * curves["slip"][straight] >= 0.0)
    assert np.all(curves["F_y"][~straight] * curves["slip_angle"][~straight] < 0.0)
    assert curves["F_z"] == pytest.approx(curves["load"], rel=1e-4)
    rows = formula.to_pandas().set_index(["load", "coefficient"])
    assert 0.5 < rows.loc[(4e3, "PDX1"), "value"] < 1.2 and set(rows["force"]) == {"F_x"}
    assert "2000 N" in names(formula.plot()) and "2000 N" in names(curves.plot())


def test_what_is_wrong_is_said():
    tread = asperity.Patch(TREAD)
    with pytest.raises(ValueError, match="`slips`, `angles`"):
        tread.slip([4e3])
    with pytest.raises(ValueError, match="`temperatures`: expected those of the table"):
        tread.slip([4e3], [0.1], temperatures=["90 °C"])
    with pytest.raises(ValueError, match="a curve of 5 points"):
        tread.slip([4e3], [0.1]).magic_formula()
