"""What a newcomer follows runs as it stands: the page on one's own machine, the quick start."""

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]


def followed(page):
    """Run a page's Python blocks one after the other; return what they leave."""
    names = {"__name__": "followed"}
    blocks = re.findall(r"```python\n(.*?)```", page.read_text("utf-8"), re.DOTALL)
    assert blocks
    for block in blocks:
        exec(compile(block, page.name, "exec"), names)
    return names


@pytest.fixture
def elsewhere(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_the_page_on_ones_own_machine(elsewhere, capsys):
    page = ROOT / "docs" / "own_machine.md"
    left = followed(page)
    said = capsys.readouterr().out
    diagnosis = left["diagnosis"]
    assert diagnosis.verdict.named == ("heat is radiated",)
    found = diagnosis.causes["heat is radiated"]["radiation"]
    assert found.low < 4e-9 < found.high
    before, after = diagnosis.gains[1].nominal, diagnosis.gains[1].extended
    assert after < 0.2 * before
    assert left["both"].verdict.named == ("heat is radiated",)
    assert left["blind"].gains[0].extended > 1.3 * diagnosis.gains[0].extended
    shown = re.search(r"```\n(named\. .*)\n```", page.read_text("utf-8"))[1]
    assert shown in said
    rows = (elsewhere / "monday.csv").read_text().splitlines()
    assert "\n".join(rows[:3]) in page.read_text("utf-8")
    assert (elsewhere / "report" / "page.html").is_file()


def test_the_quick_start(elsewhere):
    page = ROOT / "src" / "balance_diagnosis" / "README.md"
    block = re.search(r"```python\n(.*?)```", page.read_text("utf-8"), re.DOTALL)[1]
    assert len(block.splitlines()) <= 32
    diagnosis = followed(page)["diagnosis"]
    assert diagnosis.verdict.named == ("drag",)
    found = diagnosis.causes["drag"]["drag"]
    assert found.low < 20.0 < found.high
    assert (elsewhere / "report" / "page.html").is_file()
