"""However a run ends, nothing stays behind: no process, no shared memory, no domain in use."""

import os
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import lockstep_dummies as dummies
import pytest
from bench_process import orphans, shared_memory

from steering_lockstep.domain import claim_domain
from steering_lockstep.processes import Zygote, run_graph

pytest.importorskip("rclpy")
pytest.importorskip("steering_msgs.msg")
pytestmark = pytest.mark.ros

LONG = 1_000_000
SCRIPT = """
import sys, lockstep_dummies as dummies
from steering_lockstep.processes import run_graph

def show(progress):
    if progress.phase == sys.argv[2] and progress.tick >= int(sys.argv[3]):
        print("here", flush=True)

result = run_graph(dummies.graph(), 1_000_000, layout=sys.argv[1], on_progress=show)
print("ended", result.stopped_by, result.ok, result.domain, flush=True)
"""


def children(pid):
    return [int(p) for p in Path(f"/proc/{pid}/task/{pid}/children").read_text().split()]


def alive(pid):
    try:
        return Path(f"/proc/{pid}/stat").read_text().split()[2] != "Z"
    except FileNotFoundError:
        return False


def wait_until(condition, seconds=10.0):
    deadline = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < deadline
        time.sleep(0.02)


@pytest.fixture(autouse=True)
def no_shared_memory_is_left():
    before = shared_memory()
    yield
    wait_until(lambda: not orphans(shared_memory() - before))


@pytest.fixture
def script():
    """Start a run in another process; ends whatever is left of it."""
    started = []

    def start(*arguments):
        environment = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)}
        process = subprocess.Popen(
            [sys.executable, "-c", SCRIPT, *arguments],
            stdout=subprocess.PIPE,
            text=True,
            env=environment,
        )
        started.append(process)
        return process

    yield start
    for process in started:
        process.kill()
        process.wait()
        if process.stdout:
            process.stdout.close()


def family(process):
    (zygote,) = children(process.pid)
    return [process.pid, zygote, *children(zygote)]


@pytest.mark.parametrize("layout", ["one", "each"])
def test_killed_node_process_is_named(layout):
    with Zygote([dummies.HERE]) as zygote:
        seen: list[int] = []

        def kill(progress):
            if progress.phase == "running" and progress.tick > 100 and not seen:
                seen.extend(children(zygote._process.pid))
                os.kill(seen[-1], signal.SIGKILL)

        began = time.monotonic()
        result = run_graph(dummies.graph(), LONG, layout=layout, on_progress=kill, zygote=zygote)
        assert time.monotonic() - began < 20.0
        assert result.error is not None
        assert result.error.kind == "died"
        assert "SIGKILL" in result.error.message
        assert result.error.node == ("vehicle" if layout == "each" else "plant")
        assert not any(alive(pid) for pid in seen)


def test_terminated_node_process_closes_and_is_named():
    with Zygote([dummies.HERE]) as zygote:
        done: list[bool] = []

        def terminate(progress):
            if progress.phase == "running" and progress.tick > 100 and not done:
                done.append(True)
                os.kill(children(zygote._process.pid)[-1], signal.SIGTERM)

        result = run_graph(
            dummies.graph(), LONG, layout="each", on_progress=terminate, zygote=zygote
        )
        assert result.error is not None
        assert (result.error.kind, result.error.node) == ("died", "vehicle")
        assert set(result.node_results) == {"plant", "left", "right", "driver", "vehicle"}


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
@pytest.mark.parametrize("layout", ["one", "each"])
def test_signal_ends_the_run_in_order(script, layout, number):
    process = script(layout, "running", "200")
    assert process.stdout.readline() == "here\n"
    members = family(process)
    assert len(members) == 2 + (1 if layout == "one" else 5)
    began = time.monotonic()
    process.send_signal(number)
    last = process.stdout.read().splitlines()[-1].split()
    assert last[:3] == ["ended", number.name, "False"]
    assert process.wait(10.0) == 0
    assert time.monotonic() - began < 6.0
    wait_until(lambda: not any(alive(pid) for pid in members))
    claim_domain(int(last[3])).release()


@pytest.mark.parametrize("phase", ["starting", "matching"])
def test_signal_before_the_first_tick(script, phase):
    process = script("each", phase, "0")
    line = process.stdout.readline()
    process.send_signal(signal.SIGINT)
    rest = line + process.stdout.read()
    assert "ended SIGINT False" in rest
    assert process.wait(10.0) == 0


def test_killed_supervisor_takes_all_with_it(script):
    process = script("each", "running", "200")
    assert process.stdout.readline() == "here\n"
    members = family(process)
    process.kill()
    wait_until(lambda: not any(alive(pid) for pid in members[1:]))


def test_two_runs_at_once_do_not_meet():
    results = []

    def run():
        results.append(run_graph(dummies.graph(), 500, layout="each"))

    threads = [threading.Thread(target=run) for _ in range(2)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert [r.ok for r in results] == [True, True]
    assert results[0].domain != results[1].domain
    assert results[0].node_results["plant"]["digest"] == results[1].node_results["plant"]["digest"]


def test_a_process_that_does_not_leave_costs_the_run_nothing_and_is_ended():
    began = time.monotonic()
    result = run_graph(
        dummies.graph(driver="troubled"),
        200,
        layout="each",
        parameters={"driver": {"trouble": "stay"}},
        grace=1.0,
    )
    assert result.ok, result.error
    assert result.ticks == 200
    assert time.monotonic() - began < 30.0
