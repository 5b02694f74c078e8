"""The search for a suitable Python."""

import ast
import os
import sys
from pathlib import Path

import pytest

from bootstrap import interpreter

ROOT = Path(__file__).resolve().parents[2]


def executable(file: Path, text: str) -> Path:
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_text(f"#!/bin/sh\n{text}\n")
    file.chmod(0o755)
    return file


@pytest.mark.parametrize("name", ["steer", "tools/bootstrap/interpreter.py"])
def test_old_python_can_read_what_turns_it_away(name):
    ast.parse((ROOT / name).read_text(), feature_version=(3, 7))


def test_shim_without_python_is_passed_over(tmp_path):
    shim = executable(tmp_path / "shims/python3.11", "echo 'command not found' >&2; exit 127")
    good = executable(tmp_path / "bin/python3.11", "echo 3.11")
    path = f"{shim.parent}{os.pathsep}{good.parent}"
    found = list(interpreter.candidates(((3, 11),), path))
    assert found == [str(shim), str(good)]
    assert [interpreter.version_of(command) for command in found] == [None, (3, 11)]


def test_python_that_lies_about_its_name_is_passed_over(tmp_path, monkeypatch, capsys):
    executable(tmp_path / "python3.12", "echo 3.9")
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.delenv("ROS_DISTRO", raising=False)
    monkeypatch.setattr(sys, "version_info", (3, 8, 18))
    with pytest.raises(SystemExit) as left:
        interpreter.require(["steer"])
    line = str(left.value)
    assert "\n" not in line
    assert "found only 3.8" in line
    assert "apt install python3.11" in line


def test_starts_again_under_a_suitable_python(tmp_path, monkeypatch):
    good = executable(tmp_path / "python3.13", "echo 3.13")
    calls = []
    monkeypatch.setattr(os, "execv", lambda *call: calls.append(call))
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.delenv("ROS_DISTRO", raising=False)
    monkeypatch.setattr(sys, "version_info", (3, 14, 0))
    with pytest.raises(SystemExit):
        interpreter.require(["steer", "run"])
    assert calls == [(str(good), [str(good), "steer", "run"])]


def test_sourced_ros_asks_for_its_own_python(tmp_path):
    package = tmp_path / "lib/python3.12/site-packages/rclpy"
    package.mkdir(parents=True)
    (package / "_rclpy_pybind11.cpython-312-x86_64-linux-gnu.so").touch()
    environ = {"ROS_DISTRO": "jazzy", "PYTHONPATH": f"/nowhere:{package.parent}"}
    assert interpreter.wanted(environ) == ((3, 12),)
    assert interpreter.wanted({**environ, "ROS_DISTRO": "humble"}) == interpreter.SUPPORTED
    assert interpreter.wanted({"ROS_DISTRO": "jazzy"}) == interpreter.SUPPORTED
