"""./steer itself, started as a process, in a copy of the project that was never set up."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from bootstrap import checks, help_text
from bootstrap.layout import Layout

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture
def clone(tmp_path):
    for name in ("tools", "requirements"):
        shutil.copytree(ROOT / name, tmp_path / name)
    shutil.copy(ROOT / "steer", tmp_path / "steer")
    package = tmp_path / "src" / "steering_msgs"
    package.mkdir(parents=True)
    shutil.copy(ROOT / "src" / "steering_msgs" / "package.xml", package)
    command_line = Path("src", "steering_bringup", "steering_bringup", "cli", "__init__.py")
    (tmp_path / command_line).parent.mkdir(parents=True)
    shutil.copy(ROOT / command_line, tmp_path / command_line)
    return tmp_path


def steer(clone, *arguments, **variables):
    environ = {"HOME": str(clone), "PATH": os.environ["PATH"], **variables}
    return subprocess.run(
        [sys.executable, clone / "steer", *arguments],
        env=environ, capture_output=True, text=True, timeout=60, check=False,
    )  # fmt: skip


@pytest.mark.parametrize("arguments", [(), ("--help",), ("-h",)])
def test_help_needs_no_set_up(clone, arguments):
    result = steer(clone, *arguments)
    assert result.returncode == 0
    commands = help_text.commands(ROOT)
    assert commands.keys() >= {"run", "compare", "list", "bench", "test", "setup"}
    for command in commands:
        assert f"\n  {command} " in result.stdout
    assert not (clone / ".steer").exists()


@pytest.mark.parametrize("arguments", [("run",), ("test",), ("setup",)])
def test_missing_compiler_is_one_line(clone, arguments):
    empty = clone / "bin"
    empty.mkdir()
    result = steer(clone, *arguments, PATH=str(empty))
    assert result.returncode == 1
    assert result.stdout == ""
    assert result.stderr.count("\n") == 1
    assert "g++" in result.stderr
    assert not list((clone / ".steer").glob("env-*/"))


def test_missing_lock_is_one_line(clone):
    for file in (clone / "requirements").glob("ros-*.txt"):
        file.unlink()
    result = steer(clone, "run")
    assert result.returncode == 1
    assert "requirements/ros-3." in result.stderr
    assert result.stderr.count("\n") == 1


def test_unreachable_network_is_one_line(clone):
    nowhere = "http://127.0.0.1:9/simple"
    result = steer(
        clone, "setup", PIP_INDEX_URL=nowhere, PIP_RETRIES="0", PIP_CONFIG_FILE=os.devnull,
        PIP_NO_CACHE_DIR="1", PIP_NO_INDEX="0", PIP_TIMEOUT="2",
    )  # fmt: skip
    assert result.returncode == 1
    assert "cannot reach the package index" in result.stderr.splitlines()[-1]
    assert not list((clone / ".steer").glob("*.json")), "a half-made environment has no stamp"


@pytest.mark.parametrize(
    ("statuses", "expected"),
    [({}, 0), ({"ruff": 1}, 1), ({"mypy": 2}, 1), ({"pytest": 1}, 1), ({"pytest": 5}, 1)],
)
def test_checks_fail_when_anything_fails(tmp_path, capsys, monkeypatch, statuses, expected):
    def commands(python, arguments):
        return {
            name: ["sh", "-c", f"echo {name} >> ran; exit {statuses.get(name, 0)}"]
            for name in ("ruff", "mypy", "pytest")
        }

    monkeypatch.setattr(checks, "commands", commands)
    status = checks.run(Layout(tmp_path), Path("python"), dict(os.environ), [])
    assert status == expected
    assert (tmp_path / "ran").read_text().split() == ["ruff", "mypy", "pytest"]
    assert ("no test ran" in capsys.readouterr().err) == (statuses.get("pytest") == 5)


def test_arguments_reach_pytest():
    command = checks.commands(Path("python"), ["-k", "boot strap"])["pytest"]
    assert command[-2:] == ["-k", "boot strap"]
