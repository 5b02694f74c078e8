"""A ROS user's day one, with the real ros2cli and launch_ros where these are installed."""

import os
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from bench_process import Bench, children, recorded_bytes, wait_for

from steering_bringup.bags import first_difference, read_bag
from steering_lockstep.domain import claim_domain
from steering_lockstep.middleware import ros_environment

pytest.importorskip("rclpy")
WHY = "the real ros2 command line and launch are not installed beside rclpy: docs/ros.md"
pytest.importorskip("ros2cli", reason=WHY)
pytest.importorskip("ros2topic", reason=WHY)
pytest.importorskip("launch_ros", reason=WHY)
pytest.importorskip("ros2launch", reason=WHY)
pytestmark = [pytest.mark.ros, pytest.mark.slow]

ROS2 = "import sys; from ros2cli.cli import main; sys.exit(main())"
ALONE = ("--no-daemon", "--spin-time", "1")


@pytest.fixture
def domain(monkeypatch):
    claim = claim_domain()
    claim.release()
    monkeypatch.setenv("ROS_DOMAIN_ID", str(claim.number))
    return claim.number


@pytest.fixture
def ros2(tmp_path, domain):
    """Start ``ros2 WORDS`` in the test's folder, in a process group of its own."""
    started = []

    def start(*words):
        path = os.pathsep.join(p for p in sys.path if p)
        process = subprocess.Popen(
            [sys.executable, "-c", ROS2, *words],
            cwd=tmp_path,
            env={**os.environ, **ros_environment(os.environ), "PYTHONPATH": path},
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            start_new_session=True,
        )
        started.append(process)
        return process

    yield start
    for process in started:
        if process.poll() is None:
            os.killpg(process.pid, signal.SIGKILL)
        process.communicate()


def told(process, seconds=90):
    """Return what a program that ends by itself has printed."""
    text, _ = process.communicate(timeout=seconds)
    assert process.returncode == 0, text
    return text


def test_topics_and_nodes_of_a_run_are_seen(tmp_path, ros2):
    words = ("run", "weave", "--duration", "60", "--real-time", "--no-record")
    run = Bench(*words, "--namespace", "car1", folder=tmp_path)
    assert run.process.stdout is not None
    run.process.stdout.readline()
    echo = ros2(
        "topic",
        "echo",
        "--no-daemon",
        "--once",
        "/car1/steering/rack",
        "steering_msgs/msg/RackState",
    )
    assert re.search(r"^position: ", told(echo), re.MULTILINE)
    topics = told(ros2("topic", "list", *ALONE)).split()
    assert {"/car1/steering/torque", "/car1/clock", "/car1/vehicle/odometry"} <= set(topics)
    nodes = told(ros2("node", "list", *ALONE)).split()
    assert {"/car1/plant", "/car1/driver", "/car1/vehicle"} <= set(nodes)
    run.process.send_signal(signal.SIGINT)
    assert run.finish()[0] == 130


def test_a_launched_bench_makes_the_direct_runner_s_bytes(tmp_path, ros2):
    (tmp_path / "values.yaml").write_text(
        "plant:\n  ros__parameters:\n    mechanics.rack_mass: 31.0\n"
        "/**:\n  ros__parameters:\n    vehicle.speed: 25.0\n"
    )
    text = told(
        ros2(
            *("launch", "steering_bringup", "bench.launch.py", "scenario:=step", "duration:=0.3"),
            *("params_file:=values.yaml", "set:=mechanics.rack_mass=30", "out:=out"),
        )
    )
    assert text.count("process has finished cleanly") == 6
    changed = ("--set", "mechanics.rack_mass=31", "--set", "vehicle.speed=25", "--out", "direct")
    Bench("run", "step", "--duration", "0.3", "--direct", *changed, folder=tmp_path).finish()
    launched = read_bag(tmp_path / "out" / "bag")
    alone = read_bag(tmp_path / "direct" / "closed_centre")
    assert len(launched["/clock"]) == 300
    assert first_difference(launched, alone) is None


def launched(ros2, tmp_path, *words):
    """Launch a long bench; return it when its nodes have been running for a while."""
    process = ros2("launch", "steering_bringup", *words, "real_time:=true", "out:=out")
    bag = tmp_path / "out" / "bag"
    wait_for(lambda: bag.exists() and recorded_bytes(bag) > 50_000, 90)
    return process


def test_ctrl_c_ends_a_launch_in_order(tmp_path, ros2):
    process = launched(ros2, tmp_path, "lane_keeping.launch.py", "namespace:=car1")
    os.killpg(process.pid, signal.SIGINT)
    sent = time.monotonic()
    text = told(process, 10)
    assert time.monotonic() - sent < 5.0
    assert text.count("process has finished cleanly") == 8
    assert "Traceback" not in text
    assert "process has died" not in text
    (note,) = read_bag(tmp_path / "out" / "bag").notes
    assert note.startswith("the run was broken off after ")


def test_the_end_of_one_node_ends_all(tmp_path, ros2):
    process = launched(ros2, tmp_path, "bench.launch.py", "scenario:=weave")
    programs = {pid: Path(f"/proc/{pid}/cmdline").read_text() for pid in children(process.pid)}
    (pid,) = (pid for pid, words in programs.items() if "driver_node" in words)
    os.kill(pid, signal.SIGKILL)
    text = told(process, 15)
    assert re.search(r"driver_node-\d\]: process has died", text)
    assert text.count("process has finished cleanly") == 5
    assert "was required: shutting down" in text


def test_steer_is_a_launch_node_like_any_other(tmp_path, ros2):
    (tmp_path / "mine.launch.py").write_text(
        "from launch import LaunchDescription\n"
        "from launch_ros.actions import Node\n"
        "def generate_launch_description():\n"
        "    words = ['run', 'step', '--duration', '0.2', '--out', 'out']\n"
        "    return LaunchDescription([Node(package='steering_bringup', executable='steer',\n"
        "        name='bench', namespace='/car7', arguments=words, output='screen',\n"
        "        remappings=[('driver/torque', '/hand')])])\n"
    )
    text = told(ros2("launch", "./mine.launch.py"))
    assert "namespace /car7" in text
    assert "process has finished cleanly" in text
    assert read_bag(tmp_path / "out" / "closed_centre").run["namespace"] == "/car7"


def test_a_rig_is_launched_with_what_emulates_it(tmp_path, ros2):
    """In its safe state it goes on: this machine may have fewer cores than there are nodes."""
    text = told(
        ros2(
            *("launch", "steering_bringup", "rig.launch.py", "rig_fault:=hold", "duration:=0.5"),
            "out:=out",
        )
    )
    assert '{"ready": "emulated"}' in text
    assert text.count("process has finished cleanly") == 7
    assert len(read_bag(tmp_path / "out" / "bag")["/steering/torque"]) == 500


@pytest.mark.parametrize(
    ("words", "named"),
    [
        (("scenario:=stp",), "did you mean 'step'"),
        (("scenario:=step", "set:=mechanics.rack_mas=3"), "mechanics.rack_mass"),
        (("scenario:=step", "real_time:=perhaps"), "real_time:=perhaps: write true or false"),
        ((), "has 2 node sets: choose one"),
    ],
    ids=str,
)
def test_a_slip_in_an_argument_is_named(words, named, ros2):
    process = ros2("launch", "steering_bringup", "bench.launch.py", *words)
    text, _ = process.communicate(timeout=60)
    assert process.returncode == 1
    assert named in text
    assert "Traceback" not in text
