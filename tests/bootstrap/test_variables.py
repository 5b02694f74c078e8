"""The environment of the nodes: ours first, nothing foreign, defaults that a person can change."""

import os
from pathlib import Path

import pytest

from bootstrap import variables
from bootstrap.layout import Layout

ENV, WS = Path("/p/.steer/env-1"), Path("/p/.steer/ws-1")
FOREIGN = {
    "PATH": "/usr/bin",
    "PYTHONPATH": "/opt/ros/humble/site-packages",
    "PYTHONHOME": "/elsewhere",
    "AMENT_PREFIX_PATH": "/opt/ros/humble",
    "LD_LIBRARY_PATH": "/opt/ros/humble/lib",
    "ROS_DISTRO": "humble",
}


@pytest.fixture
def layout(tmp_path):
    (tmp_path / "src" / "plant").mkdir(parents=True)
    (tmp_path / "src" / "plant" / "package.xml").touch()
    (tmp_path / "src" / "plant" / "setup.py").touch()
    return Layout(tmp_path)


def test_foreign_ros_is_kept_out_of_the_wheels(layout):
    result = variables.for_run(layout, ENV, WS, FOREIGN)
    assert "humble" not in " ".join(result.values())
    assert "PYTHONHOME" not in result
    assert result["AMENT_PREFIX_PATH"] == f"{WS}/install:{ENV}"
    assert result["LD_LIBRARY_PATH"].split(":")[:2] == [f"{WS}/install/lib", f"{ENV}/lib"]
    assert result["_ROS_WHEELS_BOOTSTRAP_COMPLETE"] == "1"
    assert result["PATH"] == f"{ENV}/bin:/usr/bin"


def test_sources_come_before_the_links_to_them(layout):
    paths = variables.for_run(layout, ENV, WS, {})["PYTHONPATH"].split(os.pathsep)
    assert paths[0] == str(layout.source / "plant")
    assert paths[-1] == f"{WS}/build/plant"
    assert any(path.startswith(f"{WS}/install/lib/python3.") for path in paths)


def test_sourced_ros_stays_behind_ours(layout):
    base = {"PYTHONPATH": "/opt/ros/jazzy/sp", "AMENT_PREFIX_PATH": "/opt/ros/jazzy"}
    base["LD_LIBRARY_PATH"] = "/opt/ros/jazzy/lib"
    result = variables.for_run(layout._replace(system_ros=True), ENV, WS, base)
    assert result["PYTHONPATH"].endswith(":/opt/ros/jazzy/sp")
    assert result["AMENT_PREFIX_PATH"] == f"{WS}/install:/opt/ros/jazzy"
    assert result["LD_LIBRARY_PATH"] == f"{WS}/install/lib:/opt/ros/jazzy/lib"
    assert "_ROS_WHEELS_BOOTSTRAP_COMPLETE" not in result


def test_discovery_stays_on_this_machine_unless_asked_otherwise(layout):
    name = "ROS_AUTOMATIC_DISCOVERY_RANGE"
    assert variables.for_run(layout, ENV, WS, {})[name] == "LOCALHOST"
    assert variables.for_run(layout, ENV, WS, {name: "SUBNET"})[name] == "SUBNET"


@pytest.mark.parametrize("name", ["OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS"])
def test_processes_that_share_the_cores_compute_in_one_thread_unless_asked_otherwise(layout, name):
    assert variables.for_run(layout, ENV, WS, {})[name] == "1"
    assert variables.for_run(layout, ENV, WS, {name: "4"})[name] == "4"


def test_pip_ignores_settings_that_would_lead_it_astray(layout):
    base = {"PIP_USER": "1", "PIP_TARGET": "/x", "PIP_INDEX_URL": "mirror"}
    result = variables.for_build(layout, ENV, base)
    assert result["PIP_USER"] == "0"
    assert "PIP_TARGET" not in result
    assert result["PIP_INDEX_URL"] == "mirror"
    assert result["TMPDIR"].startswith(str(layout.root))


def test_applying_it_twice_changes_nothing(layout):
    once = variables.for_run(layout, ENV, WS, FOREIGN)
    assert variables.for_run(layout, ENV, WS, once) == once
