"""Lock files are complete, dated, and belong to their *.in files."""

import hashlib
import re
import tomllib
from pathlib import Path

import pytest

from bootstrap import lockfile
from bootstrap.layout import GROUPS_OF_WHEELS

FOLDER = Path(__file__).resolve().parents[2] / "requirements"
PYTHONS = ("3.11", "3.12", "3.13")
LOCKS = [(group, python) for group in GROUPS_OF_WHEELS for python in PYTHONS]


def wanted(group: str) -> list[str]:
    """Names in a *.in file."""
    lines = [
        line.split("#")[0].strip() for line in (FOLDER / f"{group}.in").read_text().split("\n")
    ]
    return [lockfile.canonical(re.split(r"[\[<>=!~ ]", line)[0]) for line in lines if line]


@pytest.mark.parametrize(("group", "python"), LOCKS)
def test_lock_was_made_from_the_present_input(group, python):
    head = (FOLDER / f"{group}-{python}.txt").read_text().splitlines()[:2]
    digest = hashlib.sha256((FOLDER / f"{group}.in").read_bytes()).hexdigest()
    assert re.search(rf"Locked on 20\d\d-\d\d-\d\d for Python {re.escape(python)} ", head[0])
    assert head[1].endswith(f"from {group}.in, sha256 {digest}"), "run requirements/lock"


@pytest.mark.parametrize(("group", "python"), LOCKS)
def test_every_requirement_is_pinned_with_hashes(group, python):
    file = FOLDER / f"{group}-{python}.txt"
    blocks = lockfile.blocks([file])
    assert len(blocks) > 5
    for name, block in blocks.items():
        assert lockfile.version_in(block), name
        assert "--hash=sha256:" in block, name
    lines = [line for line in file.read_text().splitlines() if not line.startswith("#")]
    assert len(lines) == sum(block.count("\n") for block in blocks.values())


@pytest.mark.parametrize("python", PYTHONS)
def test_every_wanted_package_is_locked_once(python):
    found = [lockfile.blocks([FOLDER / f"{group}-{python}.txt"]) for group in GROUPS_OF_WHEELS]
    names = [name for blocks in found for name in blocks]
    assert len(names) == len(set(names))
    assert {name for group in GROUPS_OF_WHEELS for name in wanted(group)} <= set(names)


@pytest.mark.parametrize("python", PYTHONS)
def test_nothing_of_ros_is_needed_beside_a_sourced_ros(python):
    beside = lockfile.blocks([FOLDER / f"{group}-{python}.txt" for group in ("runtime", "dev")])
    assert not [name for name in beside if name.startswith(("ros-", "colcon"))]


@pytest.mark.parametrize("file", sorted(FOLDER.iterdir()), ids=lambda file: file.name)
def test_no_address_of_a_package_index(file):
    text = file.read_text()
    assert "://" not in text
    assert not re.search(r"--(extra-)?index-url|--find-links [/\w]", text)


def test_blocks_of_a_lock_file(tmp_path):
    file = tmp_path / "lock.txt"
    file.write_text("# head\nA_b[x]==1.0 \\\n    --hash=sha256:00\nc==2\n")
    blocks = lockfile.blocks([file])
    assert list(blocks) == ["a-b", "c"]
    assert lockfile.version_in(blocks["a-b"]) == "1.0"
    assert blocks["a-b"].endswith("--hash=sha256:00\n")


def test_the_type_checker_takes_the_python_that_runs_it():
    """Each Python has a lock of its own: a numpy for 3.12 has annotations that 3.11 cannot read."""
    settings = tomllib.loads((FOLDER.parent / "pyproject.toml").read_text(encoding="utf-8"))
    assert "python_version" not in settings["tool"]["mypy"]
