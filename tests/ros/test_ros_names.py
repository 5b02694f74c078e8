"""Where a run is found in the ROS graph: its domain, its namespace, the names of its topics."""

import contextlib
import io
import json
import os
import subprocess
import sys
from pathlib import Path

import pytest
from bench_process import Bench, wait_for

from steering_bringup.bags import first_difference, read_bag
from steering_bringup.cli import main
from steering_lockstep.domain import claim_domain
from steering_lockstep.middleware import ros_environment

pytest.importorskip("rclpy")
pytest.importorskip("steering_msgs.msg")
from nav_msgs.msg import Odometry
from rclpy.serialization import deserialize_message
from steering_msgs.msg import DriverTorque, SteeringTorque

pytestmark = pytest.mark.ros

LISTENER = Path(__file__).parents[1] / "support" / "topic_listener.py"
TORQUE, HAND = "steering_msgs/msg/SteeringTorque", "steering_msgs/msg/DriverTorque"
ODOMETRY = "nav_msgs/msg/Odometry"
KINDS = {"torque": SteeringTorque, "hand": DriverTorque, "odometry": Odometry}


@pytest.fixture
def domain(monkeypatch):
    claim = claim_domain()
    claim.release()
    monkeypatch.setenv("ROS_DOMAIN_ID", str(claim.number))
    return claim.number


@pytest.fixture
def listener(tmp_path):
    """Start a program of plain rclpy that hears topics; it is ready when that returns."""
    started = []

    def start(*topics, count=300, seconds=40):
        process = subprocess.Popen(
            [
                *(sys.executable, str(LISTENER), str(tmp_path / "heard.json")),
                *(str(count), str(seconds)),
                *(f"{topic}={kind}" for topic, kind in topics),
            ],
            env={**os.environ, **ros_environment({})},
            stdout=subprocess.PIPE,
            text=True,
        )
        started.append(process)
        assert process.stdout is not None
        assert process.stdout.readline() == "ready\n"
        return process

    yield start
    for process in started:
        process.kill()
        process.communicate()


def heard(process, folder):
    """Return {topic: messages as rclpy reads them} of a listener that has ended."""
    assert process.wait(60) == 0
    content = json.loads((folder / "heard.json").read_text())
    return {
        topic: [
            deserialize_message(bytes.fromhex(data), KINDS[topic.split("/")[-1]])
            for _, data in came
        ]
        for topic, came in content.items()
    }


def test_a_listener_in_the_shell_s_domain_is_waited_for_and_hears_tick_0(
    tmp_path, domain, listener
):
    words = ("run", "step", "--duration", "0.3", "--out", "out", "--wait-for", "/steering/torque")
    run = Bench(*words, folder=tmp_path)
    process = listener(("/steering/torque", TORQUE))
    status, out, err = run.finish()
    assert status == 0, err
    first = out.splitlines()[0]
    assert first == f"step / closed_centre: ROS_DOMAIN_ID={domain}, seen on this computer"
    messages = heard(process, tmp_path)["/steering/torque"]
    assert [message.tick for message in messages] == list(range(300))
    assert read_bag(tmp_path / "out" / "closed_centre").run["domain"] == domain


def test_a_listener_that_is_there_first_hears_the_run_within_half_a_second(
    tmp_path, domain, listener
):
    process = listener(("/steering/torque", TORQUE), count=1)
    words = ("run", "step", "--duration", "1.5", "--real-time", "--no-record")
    status, _, err = Bench(*words, folder=tmp_path).finish()
    assert status == 0, err
    assert heard(process, tmp_path)["/steering/torque"][0].tick <= 500


def test_two_cars_in_one_domain_do_not_hear_each_other(tmp_path, domain, listener):
    process = listener(("/car1/steering/torque", TORQUE), ("/fleet/car2/odometry", ODOMETRY))
    step = ("run", "step", "--namespace")
    more = (
        "--duration",
        "60",
        "--real-time",
        "--no-record",
        "--remap",
        "vehicle/odometry:=odometry",
    )
    second = Bench(*step, "fleet/car2", *more, folder=tmp_path)
    assert second.process.stdout is not None
    assert second.process.stdout.readline().endswith(
        "namespace /fleet/car2, seen on this computer\n"
    )
    wait = ("--duration", "0.3", "--wait-for", "/steering/torque", "--out", "out")
    status, _, err = Bench(*step, "car1", *wait, folder=tmp_path).finish()
    assert status == 0, err
    messages = heard(process, tmp_path)
    second.process.terminate()
    assert second.finish()[0] == 143
    words = ("run", "step", "--duration", "0.3", "--direct", "--out", "direct")
    Bench(*words, folder=tmp_path).finish()
    recorded, alone = (read_bag(tmp_path / name / "closed_centre") for name in ("out", "direct"))
    assert first_difference(recorded, alone) is None
    assert len(messages["/car1/steering/torque"]) == 300
    assert messages["/fleet/car2/odometry"]


def test_two_runs_in_one_domain_need_namespaces(tmp_path, domain):
    claim = claim_domain(domain)
    try:
        status, _, err = Bench("run", "step", folder=tmp_path).finish()
    finally:
        claim.release()
    assert status == 1
    assert f"ROS_DOMAIN_ID {domain} is used by another run" in err
    assert "--namespace" in err
    assert len(err.splitlines()) == 1


def test_another_name_holds_for_all_nodes_and_the_bag_keeps_the_own_one(tmp_path, domain, listener):
    process = listener(("/hand", HAND))
    words = ("--remap", "driver/torque:=/hand", "--wait-for", "/driver/torque", "--out", "out")
    run = Bench(
        *("run", "step", "--duration", "0.3", "--processes", "each", *words), folder=tmp_path
    )
    status, _, err = run.finish()
    assert status == 0, err
    recorded = read_bag(tmp_path / "out" / "closed_centre").column("/driver/torque", "torque")
    assert [m.torque for m in heard(process, tmp_path)["/hand"]] == recorded.tolist()


@pytest.mark.parametrize(
    ("words", "named"),
    [
        (("--domain", "233"), "--domain must be a number from 0 to 232, it is '233'"),
        (("--namespace", "1car"), "--namespace '1car'"),
        (("--remap", "driver/torqe:=x"), "did you mean '/driver/torque'"),
        (("--remap", "driver/torque"), "write OLD:=NEW"),
        (("--remap", "driver/torque:=steering/torque"), "would both be called steering/torque"),
        (("--wait-for", "/nothing"), "unknown topic '/nothing'"),
        (("--direct", "--namespace", "car1"), "leave out --namespace"),
    ],
    ids=str,
)
def test_a_slip_is_one_line(words, named, tmp_path):
    status, err = in_process(["run", "step", *words, "--out", str(tmp_path)])
    assert status == 1
    assert named in err
    assert len(err.splitlines()) == 1


def in_process(words):
    told = io.StringIO()
    with contextlib.redirect_stderr(told):
        status = main(words)
    return status, told.getvalue()


def test_a_domain_that_is_none_is_refused(tmp_path, monkeypatch):
    monkeypatch.setenv("ROS_DOMAIN_ID", "forty")
    status, _, err = Bench("run", "step", folder=tmp_path).finish()
    assert status == 1
    assert "ROS_DOMAIN_ID must be a number from 0 to 232, it is 'forty'" in err


def test_nobody_that_listens_is_told(tmp_path, domain):
    words = ("run", "step", "--wait-for", "/steering/rack", "--wait", "2", "--no-record")
    run = Bench(*words, folder=tmp_path)
    status, _, err = run.finish()
    assert status == 1
    assert "not ready after 2 s" in err
    assert "/steering/rack: " in err
    wait_for(lambda: run.process.poll() is not None)
