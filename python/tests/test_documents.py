"""The code of the documents works."""

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("document", ["README.md", "docs/python.md"])
def test_five_lines_go_from_a_file_to_a_curve(document, tmp_path, monkeypatch):
    text = (ROOT / document).read_text(encoding="utf-8")
    code = next(code for code in re.findall(r"```python\n(.*?)```", text, re.DOTALL) if "savefig" in code)
    assert len(code.splitlines()) <= 5
    (tmp_path / "scenes").symlink_to(ROOT / "scenes", target_is_directory=True)
    monkeypatch.chdir(tmp_path)
    exec(code, {})
    assert "<svg" in (tmp_path / "friction.svg").read_text(encoding="utf-8")


@pytest.mark.filterwarnings("error")
def test_the_whole_scene_runs():
    text = (ROOT / "docs" / "python.md").read_text(encoding="utf-8")
    code = next(code for code in re.findall(r"```python\n(.*?)```", text, re.DOTALL) if "from_dict({\n" in code)
    names = {}
    exec(code, names)
    # Coulomb's and what the compound loses on the wave.
    assert 0.3 < names["friction"] < 0.4 and names["masses_that_slip"] > 10
    assert names["block"].warnings == [] and "block on a wave" in names["block"].describe()
