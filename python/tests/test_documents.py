"""The five lines of the documents work."""

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
