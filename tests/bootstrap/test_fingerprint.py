"""What asks for a new environment or a new build, and what does not."""

import sys

import pytest

from bootstrap import fingerprint
from bootstrap.layout import Layout

VERSION = f"{sys.version_info[0]}.{sys.version_info[1]}"


@pytest.fixture
def layout(tmp_path):
    (tmp_path / "requirements").mkdir()
    for group in ("runtime", "dev", "ros"):
        (tmp_path / "requirements" / f"{group}-{VERSION}.txt").write_text(f"{group}==1\n")
    for name, file in (("msgs", "msg/A.msg"), ("plant", "plant/model.py")):
        package = tmp_path / "src" / name
        (package / file).parent.mkdir(parents=True)
        (package / file).write_text("float64 x\n")
        (package / "package.xml").write_text(f"<name>{name}</name>")
    (tmp_path / "src" / "plant" / "setup.py").write_text("setup()\n")
    return Layout(tmp_path)


def keys(layout):
    key = fingerprint.environment_key(layout)
    return key, fingerprint.workspace_key(layout, key)


@pytest.mark.parametrize("name", ["msgs/msg/A.msg", "plant/setup.py", "plant/package.xml"])
def test_edited_build_file_asks_for_a_build_only(layout, name):
    before = keys(layout)
    file = layout.source / name
    file.write_text(file.read_text() + "#\n")
    after = keys(layout)
    assert after[0] == before[0]
    assert after[1] != before[1]


def test_edited_module_asks_for_nothing(layout):
    before = keys(layout)
    (layout.source / "plant/plant/model.py").write_text("x = 3\n")
    (layout.source / "plant/plant/new.py").write_text("x = 3\n")
    assert keys(layout) == before


@pytest.mark.parametrize("name", ["msgs/msg/B.msg", "extra/package.xml", "msgs/CMakeLists.txt"])
def test_added_file_asks_for_a_build(layout, name):
    before = keys(layout)
    (layout.source / name).parent.mkdir(exist_ok=True)
    (layout.source / name).write_text("float64 x\n")
    assert keys(layout)[1] != before[1]


def test_changed_lock_asks_for_everything(layout):
    before = keys(layout)
    layout.locks()[1].write_text("dev==2\n")
    after = keys(layout)
    assert after[0] != before[0]
    assert after[1] != before[1]


def test_moved_project_asks_for_everything(layout, tmp_path):
    before = keys(layout)
    moved = tmp_path.with_name(tmp_path.name + "-moved")
    tmp_path.rename(moved)
    assert keys(Layout(moved))[0] != before[0]


def test_sourced_ros_and_wheels_stand_apart(layout):
    assert keys(layout._replace(system_ros=True))[0] != keys(layout)[0]


def test_parts_cannot_run_together():
    assert fingerprint.digest([b"ab", b"c"]) != fingerprint.digest([b"a", b"bc"])
