"""What a launch file's Node adds to steer, and what a program says where imports are missing."""

import re

import pytest

from steering_bringup.cli import COMMANDS
from steering_bringup.cli.ros_arguments import OF_THE_PROGRAM, settled
from steering_bringup.errors import BenchError
from steering_core import requirements


@pytest.mark.parametrize(
    ("ros", "own"),
    [
        (["-r", "__node:=bench"], []),
        (["-r", "__ns:=/car1"], ["--namespace", "/car1"]),
        (["--remap", "driver/torque:=/hand"], ["--remap", "driver/torque:=/hand"]),
        (["--log-level", "debug", "--disable-rosout-logs"], []),
        (["-p", "use_sim_time:=true"], []),
        (["-r", "__node:=b", "--", "--json", "x"], ["--json", "x"]),
    ],
    ids=str,
)
def test_names_are_taken_over(ros, own):
    assert settled(["run", "step", "--ros-args", *ros]) == ["run", "step", *own]


def test_words_that_are_not_ros_s_stay():
    words = ["run", "-r", "--", "x"]
    assert settled(words) == words


@pytest.mark.parametrize("ros", [["-p", "mechanics.rack_mass:=30.0"], ["--params-file", "a.yaml"]])
def test_values_are_not_dropped_without_a_word(ros):
    with pytest.raises(BenchError, match="--set NAME=VALUE"):
        settled(["run", "--ros-args", *ros])


def test_arguments_of_another_program_are_its_own():
    words = ["python", "mine.py", "--ros-args", "-p", "gain:=2.0"]
    assert settled(words) == words
    assert set(OF_THE_PROGRAM) <= COMMANDS.keys()


def test_what_is_missing_is_named(monkeypatch):
    assert requirements.missing() == []
    monkeypatch.setitem(requirements.MODULES, "no_such_module", "no-such-package")
    monkeypatch.setitem(requirements.LEAST, "pydantic", 99)
    text = requirements.missing_text(ModuleNotFoundError("No module named 'no_such_module'"))
    assert "Not installed: no-such-package, pydantic 99 or newer" in text
    assert "pip install -r requirements/runtime-" in text


def test_every_locked_requirement_is_known():
    from pathlib import Path

    lines = (Path(__file__).parents[2] / "requirements" / "runtime.in").read_text().splitlines()
    told = [line for line in lines if line.strip() and not line.startswith("#")]
    names = {re.split(r"[\s<>=]", line, maxsplit=1)[0] for line in told}
    assert set(requirements.MODULES.values()) == names
