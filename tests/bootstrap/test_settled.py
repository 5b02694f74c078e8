"""Another interpreter first on PATH: the one whose environment is there goes on being used."""

import json
import os
import sys

import pytest

from bootstrap import ensure, interpreter, removal, settled
from bootstrap.layout import Layout

OTHER = "3.12.0 in /elsewhere"


@pytest.fixture
def layout(tmp_path, monkeypatch):
    monkeypatch.delenv(settled.SWITCHED, raising=False)
    (tmp_path / "requirements").mkdir()
    for file in Layout(tmp_path).locks():
        file.touch()
    python = tmp_path / ".steer" / "env-old" / "bin" / "python"
    python.parent.mkdir(parents=True)
    python.symlink_to(os.path.realpath(sys.executable))
    (tmp_path / ".steer" / "env-old.json").write_text(json.dumps({"python": OTHER}))
    return Layout(tmp_path)


@pytest.fixture
def started(monkeypatch):
    calls = []
    monkeypatch.setattr(os, "execv", lambda *call: calls.append(call))
    return calls


def test_it_starts_again_and_says_so(layout, started, capsys):
    settled.keep_interpreter(layout, ["run", "step"])
    python = os.path.realpath(sys.executable)
    assert started == [(python, [python, str(layout.root / "steer"), "run", "step"])]
    said = capsys.readouterr().err
    assert said.count("\n") == 1
    assert python in said
    assert "setup" in said


def test_it_does_so_once(layout, started, monkeypatch):
    monkeypatch.setenv(settled.SWITCHED, "1")
    settled.keep_interpreter(layout, ["run"])
    assert not started
    assert settled.SWITCHED not in os.environ


def test_an_environment_of_this_interpreter_is_used(layout, started):
    mine = ensure.names(layout).environment
    mine.with_name(mine.name + ".json").write_text("{}")
    settled.keep_interpreter(layout, ["run"])
    assert not started


@pytest.mark.parametrize("stamp", ["", "[]", "{}", '{"python": 3}'])
def test_a_stamp_that_says_nothing_is_passed_over(layout, started, stamp, monkeypatch):
    monkeypatch.setattr(interpreter, "version_of", lambda command: None)
    (layout.state / "env-old.json").write_text(stamp)
    settled.keep_interpreter(layout, ["run"])
    assert not started


def test_an_interpreter_that_is_gone_is_passed_over(layout, started):
    python = layout.state / "env-old" / "bin" / "python"
    python.unlink()
    settled.keep_interpreter(layout, ["run"])
    python.symlink_to("/no/such/python")
    settled.keep_interpreter(layout, ["run"])
    assert not started


def test_a_link_to_another_project_s_environment_is_removed_alone(tmp_path):
    theirs = tmp_path / "theirs"
    theirs.mkdir()
    (theirs / "file").touch()
    link = tmp_path / "env-1"
    link.symlink_to(theirs)
    removal.remove(link)
    assert not link.is_symlink()
    assert (theirs / "file").is_file()
