"""Figures of the documentation: each is a row of a benchmark, and none about speed stands alone."""

import re
from pathlib import Path
from typing import Any

import pytest

from steering_bringup.benchmarking import figures
from steering_bringup.benchmarking.registry import BENCHMARKS

ROOT = Path(__file__).parents[2]
PAGES = figures.pages(ROOT)

SPEED = re.compile(
    r"\d\s*(?:times|x) (?:real time|as fast|faster|slower)"
    r"|(?:faster|slower) by \d"
    r"|\bp(?:50|99) \d"
    r"|\d (?:us|ms) a tick"
    r"|\d % late"
    r"|\d s (?:of|on) (?:one|two|\d+) cores?"
)
"""How a measured speed is written; what is in a block of code is an example or a help text."""
OF_ANOTHER = {"docs/diagnosis_benchmark.md"}
"""Its figures are of runs of hours, named there."""


def unmarked(text: str) -> list[str]:
    """Return figures about speed that have no marker."""
    plain = re.sub(r"```.*?```", "", text, flags=re.DOTALL)
    return [found[0] for found in SPEED.finditer(figures.MARKED.sub("", plain))]


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_each_marker_names_a_row_and_its_command(page):
    text = page.read_text(encoding="utf-8")
    assert (
        text.count("<!-- bench:") == text.count("<!-- /bench -->") == len([*figures.marked(text)])
    )
    for name, row, figure in figures.marked(text):
        assert BENCHMARKS[name].row(row)
        assert f"`./steer bench {name}`" in text
        assert figure == "-" or float(figure) == float(figure)


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_no_figure_about_speed_stands_without_its_marker(page):
    if str(page.relative_to(ROOT)) not in OF_ANOTHER:
        assert unmarked(page.read_text(encoding="utf-8")) == []


@pytest.mark.parametrize(
    "text",
    [
        "some 400 times real time",
        "12 times faster",
        "UDP p50 177",
        "266 us a tick",
        "67 s of one core",
    ],
)
def test_a_figure_without_marker_is_seen(text):
    assert unmarked(f"It is {text}.")
    assert not unmarked(f"```\n{text}\n```")
    marker = "<!-- bench: direct_speed.real_time -->400<!-- /bench -->"
    assert not unmarked(re.sub(r"\d+(?= [tsu])|\d+$", marker, text))


def test_figures_are_rewritten_and_nothing_else(tmp_path):
    (tmp_path / "docs").mkdir()
    page = "a <!-- bench: x.a -->1<!-- /bench --> b <!-- bench: x.b -->2<!-- /bench -->\n"
    (tmp_path / "README.md").write_text(page)
    (tmp_path / "docs" / "one.md").write_text("nothing here\n")
    rows: dict[str, dict[str, dict[str, Any]]] = {
        "x": {"a": {"value": 3.0, "text": "3.0"}, "b": {"value": None, "text": "-"}}
    }
    changed, stale = figures.rewrite(tmp_path, rows)
    assert changed == [tmp_path / "README.md"]
    assert stale == ["x.b"]
    assert (tmp_path / "README.md").read_text() == page.replace(">1<", ">3.0<")
    assert figures.named(tmp_path) == {"x"}
    assert figures.rewrite(tmp_path, rows)[0] == []
