"""What a newcomer follows runs as it stands: the page on one's own machine, the quick start."""

import re
from pathlib import Path

import pytest

from balance_diagnosis.fmu.binding import read_binding

ROOT = Path(__file__).parents[2]


def followed(page):
    """Run a page's Python blocks one after the other; return what they leave."""
    names = {"__name__": "followed"}
    blocks = re.findall(r"```python\n(.*?)```", page.read_text("utf-8"), re.DOTALL)
    assert blocks
    for block in blocks:
        exec(compile(block, page.name, "exec"), names)
    return names


def alike(shown, said):
    """Return whether two texts are the same, their numbers within 2 %."""
    number = r"\d+\.?\d*(?:e.\d+)?"
    one, other = (
        [float(n.replace("−", "-")) for n in re.findall(number, text)] for text in (shown, said)
    )
    return re.sub(number, "#", shown) == re.sub(number, "#", said) and one == pytest.approx(
        other, rel=0.02
    )


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
    (shown,) = re.findall(r"```\n(named\. .*)\n```", page.read_text("utf-8"))
    assert alike(shown, said.splitlines()[0])
    rows = (elsewhere / "monday.csv").read_text().splitlines()
    assert "\n".join(rows[:3]) in page.read_text("utf-8")
    assert (elsewhere / "report" / "page.html").is_file()


def test_the_quick_start(elsewhere):
    page = ROOT / "src" / "balance_diagnosis" / "README.md"
    (block,) = re.findall(r"```python\n(.*?)```", page.read_text("utf-8"), re.DOTALL)
    assert len(block.splitlines()) <= 32
    diagnosis = followed(page)["diagnosis"]
    assert diagnosis.verdict.named == ("drag",)
    found = diagnosis.causes["drag"]["drag"]
    assert found.low < 20.0 < found.high
    assert (elsewhere / "report" / "page.html").is_file()


def test_the_binding_of_an_fmu_on_the_page_is_one(tmp_path):
    text = (ROOT / "docs" / "own_machine.md").read_text("utf-8")
    blocks = re.findall(r"```yaml\n(.*?)```", text, re.DOTALL)
    file = tmp_path / "binding.yaml"
    file.write_text("\n".join(blocks))
    bound = read_binding(file)
    assert bound.variables["damping"] == "friction.d"
    assert set(bound.data["channels"]) == {*bound.inputs, *bound.outputs}
