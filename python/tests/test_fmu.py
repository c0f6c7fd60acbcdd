"""What an FMU carries and what ways of driving it lose."""

import sys
import zipfile

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
        still = small.with_keys({"excitation": []}).pack(tmp_path / "still.fmu")
    with pytest.raises(ValueError, match="the scene has no excitation"):
        asperity.fmi.verify(still)


FORGED = [
    (lambda rows: [*rows, rows[-1]], r"result\.csv: expected \d+ rows, as the experiment"),
    (lambda rows: rows[:3], r"result\.csv: expected \d+ rows"),
    (lambda rows: rows[:1], r"result\.csv: expected \d+ rows"),
    (lambda rows: [rows[0], *("9" + row for row in rows[1:])], r"result\.csv, row 2: expected time = 0"),
    (lambda rows: [rows[0].replace("F_x", "F_q"), *rows[1:]], r"result\.csv, row 1: .*F_q"),
    (lambda rows: [*rows[:5], "1,2", *rows[6:]], r"result\.csv, row 6: expected \d+ numbers"),
    (lambda rows: [*rows[:5], rows[5].rpartition(",")[0] + ",inf", *rows[6:]], r"row 6: .* = 'inf': expected a number"),
    (lambda rows: [*rows[:5], rows[5].rpartition(",")[0] + ",", *rows[6:]], r"row 6: .* = '': expected a number"),
    (lambda rows: [rows[0], "0" * (1 << 25)], r"result\.csv: expected at most 16777216 bytes"),
]


def test_a_result_that_proves_nothing_is_refused(small, tmp_path):
    packed, forged = small.pack(tmp_path / "small.fmu"), tmp_path / "forged.fmu"
    for edit, message in FORGED:
        with zipfile.ZipFile(packed) as archive, zipfile.ZipFile(forged, "w", zipfile.ZIP_DEFLATED) as other:
            for name in archive.namelist():
                content = archive.read(name)
                if name.endswith("result.csv"):
                    content = "".join(row + "\n" for row in edit(content.decode().splitlines())).encode()
                other.writestr(name, content)
        with pytest.raises(ValueError, match=message):
            asperity.fmi.verify(forged)


def test_what_is_not_as_it_was_packed_is_told(small, tmp_path):
    packed, forged = small.pack(tmp_path / "small.fmu"), tmp_path / "forged.fmu"
    assert asperity.fmi.verify(packed).deviations == ()

    def forge(of, edit):
        with zipfile.ZipFile(packed) as archive, zipfile.ZipFile(forged, "w") as other:
            for name in archive.namelist():
                content = archive.read(name)
                other.writestr(name, edit(content) if name.endswith(of) else content)

    forge("modelDescription.xml", lambda content: content.replace(b'unit="N"', b'unit="m"', 1))
    found = asperity.fmi.verify(forged)
    assert len(found.deviations) == 1 and "Not as packed: modelDescription.xml, line" in str(found)
    # A library that is cut off would end the process when it is loaded.
    forge((".so", ".dll"), lambda content: content[: len(content) // 2])
    if sys.platform == "linux":
        with pytest.raises(ValueError, match="whole shared library"):
            asperity.fmi.verify(forged)


def test_an_archive_that_leaves_its_folder_is_not_unpacked(tmp_path):
    for name in ("../a", "/a"):
        with zipfile.ZipFile(tmp_path / "a.fmu", "w") as archive:
            archive.writestr(name, "")
        with pytest.raises(ValueError, match="within the archive"):
            asperity.fmi.verify(tmp_path / "a.fmu")
