"""./steer env: a shell on the bench's ROS, and what of a person's own workspace a run keeps."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from bootstrap import inherited, overlay, shell, variables
from bootstrap.ensure import Ready
from bootstrap.layout import Layout
from steering_lockstep.middleware import PROFILE, PROFILE_VARIABLE, RANGE, ros_environment

ROOT = Path(__file__).resolve().parents[2]
ODD = "a b'c\"d\\e$HOME`;#é"


@pytest.fixture
def layout():
    return Layout(ROOT)


@pytest.fixture
def ready(layout):
    return Ready(layout.state / "env-1", layout.state / "ws-1")


@pytest.mark.parametrize("name", shell.SHELLS)
def test_a_shell_reads_what_it_is_told(name):
    if shutil.which(name) is None:
        pytest.skip(f"{name} is not installed")
    lines = shell.lines({"GONE": "x", "KEPT": "k"}, {"KEPT": "k", "ODD": ODD}, name)
    words = ["fish", "--no-config"] if name == "fish" else [name]
    script = "\n".join([*lines, "command env -0"])
    result = subprocess.run(
        [*words, "-c", script],
        env={"PATH": os.environ["PATH"], "HOME": "/", "GONE": "x", "KEPT": "k"},
        capture_output=True,
        check=True,
        timeout=30,
    )
    after = dict(e.split("=", 1) for e in result.stdout.decode().split("\0") if e)
    assert after["ODD"] == ODD
    assert after["KEPT"] == "k"
    assert "GONE" not in after


def test_a_second_time_changes_nothing(layout, ready):
    base = {"PATH": "/usr/bin", "PYTHONHOME": "/x", "PYTHONIOENCODING": "ascii"}
    once = shell.variables(layout, ready, base)
    assert once["PYTHONIOENCODING"] == "ascii"
    assert once["ROS_DOMAIN_ID"] == "0"
    assert once[PROFILE_VARIABLE] == str(PROFILE)
    assert shell.lines(once, shell.variables(layout, ready, once), "bash") == []


def test_a_run_in_such_a_shell_is_as_elsewhere(layout, ready):
    base = {"PATH": "/usr/bin"}
    plain = variables.for_run(layout, ready.environment, ready.workspace, base)
    inside = variables.for_run(
        layout, ready.environment, ready.workspace, shell.variables(layout, ready, base)
    )
    more = {"ROS_DOMAIN_ID", "CMAKE_PREFIX_PATH"}
    assert {k: v for k, v in inside.items() if k not in more} == plain


def test_a_range_that_is_asked_for_in_such_a_shell_counts(layout, ready):
    inside = shell.variables(layout, ready, {"PATH": "/usr/bin"}) | {RANGE: "SUBNET"}
    result = variables.for_run(layout, ready.environment, ready.workspace, inside)
    assert result[RANGE] == "SUBNET"
    assert inherited.PROFILE not in result
    # A node of plain ros2 run, which does not come through ./steer.
    assert ros_environment(inside)[PROFILE_VARIABLE] == ""


@pytest.fixture
def workspace(tmp_path, layout):
    """What colcon leaves of a workspace that was built on the bench's environment."""
    prefix = tmp_path / "mine" / "install"
    index = prefix / "share" / "ament_index" / "resource_index" / "parent_prefix_path"
    index.mkdir(parents=True)
    (index / "my_msgs").write_text(f"{layout.state}/ws-0/install:{layout.state}/env-0")
    (prefix / "local_setup.sh").touch()
    return prefix


def sourced(prefix, **more):
    return {"AMENT_PREFIX_PATH": str(prefix), "PYTHONPATH": f"{prefix}/lib/python", **more}


def test_a_workspace_built_on_the_bench_is_kept_behind_it(workspace, layout, ready):
    base = sourced(workspace, LD_LIBRARY_PATH=f"{workspace}/lib:/opt/ros/humble/lib")
    result = variables.for_run(layout, ready.environment, ready.workspace, base)
    assert result["AMENT_PREFIX_PATH"].split(":")[-1] == str(workspace)
    assert result["PYTHONPATH"].split(":")[-1] == f"{workspace}/lib/python"
    assert result["LD_LIBRARY_PATH"].split(":")[-1] == f"{workspace}/lib"
    assert "humble" not in " ".join(result.values())
    assert variables.for_run(layout, ready.environment, ready.workspace, result) == result


def test_links_into_its_build_folder_are_kept(workspace, layout):
    build = workspace.parent / "build" / "my_node"
    base = {"AMENT_PREFIX_PATH": str(workspace), "PYTHONPATH": f"{build}:/elsewhere"}
    assert overlay.search_paths(layout, base)["PYTHONPATH"] == str(build)


def test_a_workspace_of_another_ros_is_not_kept(tmp_path, layout, ready):
    prefix = tmp_path / "install"
    prefix.mkdir()
    (prefix / "setup.sh").write_text('COLCON_CURRENT_PREFIX="/opt/ros/humble"\n')
    result = variables.for_run(layout, ready.environment, ready.workspace, sourced(prefix))
    assert str(prefix) not in " ".join(result.values())


def test_in_a_shell_of_the_bench_everything_that_is_added_counts(layout, ready):
    inside = shell.variables(layout, ready, {"PATH": "/usr/bin"})
    inside["PYTHONPATH"] = f"/my/tools:{inside['PYTHONPATH']}"
    result = variables.for_run(layout, ready.environment, ready.workspace, inside)
    assert result["PYTHONPATH"].endswith(":/my/tools")


def test_help_and_a_wrong_domain(tmp_path):
    words = [sys.executable, str(ROOT / "steer"), "env"]
    told = subprocess.run(
        [*words, "--help"], capture_output=True, text=True, timeout=60, check=True
    )
    assert 'eval "$(./steer env)"' in told.stdout
    wrong = subprocess.run([*words, "--domain", "999"], capture_output=True, text=True, timeout=60)
    assert wrong.returncode == 2
    assert wrong.stdout == ""
