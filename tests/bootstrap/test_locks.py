"""Several ./steer at once: one sets up while the others wait, and nobody loses what is in use."""

import subprocess
import sys
import time
from pathlib import Path

import pytest

from bootstrap import locks, removal, stamp

TOOLS = Path(__file__).resolve().parents[2] / "tools"
WAITER = """
import sys
from pathlib import Path
sys.path.insert(0, sys.argv[1])
from bootstrap import locks
with locks.setting_up(Path(sys.argv[2])):
    print("mine")
"""


@pytest.fixture
def top(tmp_path):
    folder = tmp_path / "env-1"
    folder.mkdir()
    stamp.write(folder)
    return folder


def test_second_set_up_waits_and_says_so(tmp_path):
    file = tmp_path / "lock"
    with locks.setting_up(file):
        other = subprocess.Popen(
            [sys.executable, "-c", WAITER, str(TOOLS), str(file)],
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        )
        assert other.stderr is not None
        line = other.stderr.readline()
        assert "is setting up; waiting" in line
        assert other.poll() is None
    out, _ = other.communicate(timeout=20)
    assert out == "mine\n"


def test_lock_outlives_its_owner_while_a_child_works(tmp_path):
    file = tmp_path / "lock"
    with locks.setting_up(file) as descriptor:
        child = subprocess.Popen(["sleep", "1"], pass_fds=(descriptor,))
    begin = time.monotonic()
    with locks.setting_up(file):
        assert child.poll() is not None or time.monotonic() - begin > 0.5
    child.wait()


def test_used_environment_is_not_removed(top):
    assert locks.mark_in_use(top) is not None
    assert not removal.remove_if_unused(top)
    assert stamp.read(top) is not None


def test_unused_environment_goes_with_its_stamp(top):
    assert removal.remove_if_unused(top)
    assert not top.exists()
    assert stamp.read(top) is None
    assert list(top.parent.iterdir()) == []


@pytest.mark.parametrize(
    ("name", "facts", "stays"),
    [
        ("env-2", {"python": "3.11"}, False),
        ("env-2", {"python": "3.13"}, True),
        ("env-2", None, False),
        ("ws-2", {"environment": "env-1"}, False),
        ("ws-2", {"environment": "env-3"}, True),
        ("ws-2", {"environment": "env-gone"}, False),
        ("ws-2", None, False),
    ],
)
def test_only_what_is_outdated_goes(top, name, facts, stays):
    other_python = top.with_name("env-3")
    other_python.mkdir()
    stamp.write(other_python, python="3.13")
    other = top.with_name(name)
    other.mkdir()
    if facts is not None:
        stamp.write(other, **facts)
    removal.remove_outdated(top.parent, {top}, "3.11")
    assert top.exists()
    assert other_python.exists()
    assert other.exists() == stays


def test_environment_under_removal_cannot_be_marked(top):
    with locks.unused(top) as free:
        assert free
        assert locks.mark_in_use(top) is None
