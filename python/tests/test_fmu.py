"""What an FMU carries and what ways of driving it lose."""

import sys

import pytest

import asperity


def test_an_fmu_proves_itself(small, tmp_path):
    if sys.platform == "darwin":
        pytest.skip("FMI 2.0 names no platform of Apple's processors")
    found = asperity.fmi.verify(small.pack(tmp_path / "small.fmu"))
    assert found.ways[0] == "rates" and len(found.ways) == 6 and not found.problems
    # Along the same lines the FMU has the error of its tolerance; values alone are predictions at every point.
    assert found["rates"]["F_z"] < 1e-3 < found["values alone"]["F_z"]
    assert found["values alone, steps ten times shorter"]["F_z"] < found["values alone"]["F_z"]
    assert "values alone" in str(found) and found.to_pandas().shape == found.differences.shape
    with pytest.raises(KeyError, match="expected one of rates"):
        found["none"]
    with pytest.raises(ValueError, match="no-references"):
        asperity.fmi.verify(small.pack(tmp_path / "without.fmu", references=False))
    with pytest.warns(UserWarning, match="no experiment and result: the scene has no excitation"):
        still = small.with_(excitation=[]).pack(tmp_path / "still.fmu")
    with pytest.raises(ValueError, match="the scene has no excitation"):
        asperity.fmi.verify(still)
