"""What a run tells of itself on /rosout and /diagnostics, heard by plain rclpy."""

import contextlib
import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import lockstep_dummies as dummies
import pytest

from steering_lockstep.domain import claim_domain
from steering_lockstep.middleware import ros_environment
from steering_lockstep.names import Names
from steering_lockstep.processes import Zygote, run_graph

pytest.importorskip("rclpy")
pytest.importorskip("steering_msgs.msg")
pytestmark = pytest.mark.ros

EAR = Path(__file__).parents[1] / "support" / "ros_ear.py"
OK, WARN, ERROR = 0, 1, 2
INFO_LOG, WARN_LOG, ERROR_LOG = 20, 30, 40
HEARD = "/steering/torque"


@contextlib.contextmanager
def ear(folder, *topics):
    """Give a domain, and a list that holds what was heard there once the context is left."""
    claim = claim_domain()
    lines: list[dict[str, Any]] = []
    environment = {**os.environ, **ros_environment(os.environ), "ROS_DOMAIN_ID": str(claim.number)}
    program = [sys.executable, str(EAR), str(folder / "heard"), *topics]
    process = subprocess.Popen(program, env=environment, stdout=subprocess.PIPE)
    assert process.stdout is not None
    try:
        assert process.stdout.readline() == b"ready\n"
        yield claim, lines
        process.terminate()
        process.wait(20)
        lines += map(json.loads, (folder / "heard").read_text().splitlines())
    finally:
        process.kill()
        process.wait()
        process.stdout.close()
        claim.release()


@pytest.fixture(scope="module")
def zygote():
    with Zygote([dummies.HERE]) as crew:
        yield crew


def logs(lines):
    return [(m["level"], m["name"], m["msg"]) for m in lines if m["topic"] == "/rosout"]


def statuses(lines):
    return [s for m in lines if m["topic"] == "/diagnostics" for s in m["status"]]


def values(status):
    return {entry["key"]: entry["value"] for entry in status["values"]}


def test_a_run_tells_its_start_its_pace_and_its_end(tmp_path, zygote):
    names = Names("/car1")
    with ear(tmp_path, f"/car1{HEARD}=steering_msgs/SteeringTorque") as (domain, lines):
        result = run_graph(
            dummies.graph(),
            2500,
            real_time=True,
            zygote=zygote,
            domain=domain,
            names=names,
            wait_for=(HEARD,),
        )
    assert result.ok, result.error
    told = logs(lines)
    for node in dummies.graph().nodes:
        mine = [(level, text) for level, name, text in told if name == f"car1.{node.name}"]
        assert mine[0][0] == INFO_LOG
        assert mine[0][1].startswith(f"ready: {node.kind}, takes {len(node.inputs)} topics")
        assert mine[1:] == [(INFO_LOG, "finished after 2500 ticks")]
    found = statuses(lines)
    assert {s["name"] for s in found} == {"car1/plant: lock step"}
    assert {s["hardware_id"] for s in found} == {"steering bench car1"}
    assert {s["level"] for s in found} <= {OK, WARN}
    assert found[-1]["message"] == "finished after 2500 ticks"
    # begin, each second, end; and once more where the machine fell behind
    assert 4 <= len(found) <= 7
    paces = [float(v["real_time_factor"]) for v in map(values, found) if "real_time_factor" in v]
    assert len(paces) >= 2
    # in real time, but a busy machine falls behind and catches up
    assert all(0.05 < pace < 10.0 for pace in paces)
    assert [int(values(s)["tick"]) for s in found] == sorted(int(values(s)["tick"]) for s in found)


def test_a_fault_is_told_with_its_node(tmp_path, zygote):
    parameters = {"driver": {"trouble": "raise"}}
    with ear(tmp_path, f"{HEARD}=steering_msgs/SteeringTorque") as (domain, lines):
        result = run_graph(
            dummies.graph(driver="troubled"),
            500,
            parameters=parameters,
            zygote=zygote,
            domain=domain,
            wait_for=(HEARD,),
        )
    assert result.error is not None
    errors = [(name, text) for level, name, text in logs(lines) if level == ERROR_LOG]
    assert errors == [("driver", str(result.error.message))]
    ends = {name: text for level, name, text in logs(lines) if level == WARN_LOG}
    assert ends["plant"].startswith("ended at tick 5")
    last = statuses(lines)[-1]
    assert last["level"] == ERROR
    assert "made up" in last["message"]
