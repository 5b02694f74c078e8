"""``steer run --plant rig`` with the emulated rig, in wall time: as any run, and under faults."""

import json
import os
import re
import resource
import signal
import time
from pathlib import Path

import numpy as np
import pytest
from bench_process import Bench, children, recorded_bytes, wait_for
from patient_rig import patient_rig

from steering_bringup.bags import read_bag
from steering_bringup.errors import BenchError
from steering_bringup.repeating import plan_from_bag

pytest.importorskip("rclpy")
pytestmark = pytest.mark.ros

WITHIN = 5
BAG = Path("out", "closed_centre_rig")
RUN = ("run", "step", "--node-set", "closed_centre", "--out", "out", "--json", "run.json")


@pytest.fixture
def rig_run(tmp_path):
    """Start a run with a patient rig; what is still there at the end is ended."""
    started = []

    def start(*words: str, emulator=None, watching=None, **options) -> Bench:
        rig = patient_rig(tmp_path, emulator, **(watching or {}))
        bench = Bench(*RUN, "--plant", "rig", "--rig", str(rig), *words, folder=tmp_path, **options)
        started.append(bench)
        return bench

    yield start
    for bench in started:
        if bench.process.poll() is None:
            os.killpg(bench.process.pid, signal.SIGKILL)
            bench.process.wait()


def running(bench: Bench, folder: Path) -> Bench:
    """Wait until the run records."""
    wait_for(lambda: bench.process.poll() is not None or recorded_bytes(folder / BAG) > 1e5, 90.0)
    assert bench.process.poll() is None, bench.finish()
    return bench


def report(folder: Path) -> dict:
    return json.loads((folder / "run.json").read_text())["runs"][0]["rig"]


def node_process(bench: Bench, name: str) -> int:
    """Return a node's process of its own, as they are started one after the other."""
    (helper,) = (p for p in children(bench.process.pid) if b"zygote" in command(p))
    names = ("plant", "valve_left", "valve_right", "driver", "vehicle", "recorder")
    return sorted(children(helper))[names.index(name)]


def command(pid: int) -> bytes:
    return Path(f"/proc/{pid}/cmdline").read_bytes()


def emulator_process(bench: Bench) -> int:
    """Return the emulated rig's process."""
    for pid in children(bench.process.pid):
        if b"rig_bridge.emulator.main" in command(pid):
            return pid
    raise AssertionError("no emulated rig")


def assert_tidy(bench: Bench, folder: Path) -> np.ndarray:
    """The bag holds whole, consecutive ticks; no process is left. Returns the ticks."""
    ticks = read_bag(folder / BAG)["/steering/torque"]["tick"]
    assert ticks.tolist() == list(range(len(ticks)))
    wait_for(lambda: not bench.left_over(), 10.0)
    return ticks


@pytest.mark.parametrize("link", ["udp", "can"])
def test_a_rig_run_is_a_run(rig_run, link, tmp_path):
    bench = rig_run("--rig-link", link, "--duration", "1.5")
    status, out, err = bench.finish()
    assert status == 0, err
    assert "patient" not in err
    assert "latency" in out
    assert len(assert_tidy(bench, tmp_path)) == 1500
    trace = read_bag(tmp_path / BAG)
    assert abs(trace["/steering/torque"]["torsion_bar_torque"]).max() > 0.5, "the wheel is turned"
    rig = report(tmp_path)
    assert (rig["state"], rig["fault"], rig["ticks"]) == ("running", None, 1500)
    assert 0.0 < rig["p50"] <= rig["p99"] <= rig["max"]
    assert [change["to"] for change in rig["changes"]] == ["checking", "entering", "running"]
    assert trace.run["rig"]["emulated"] is True
    assert trace.run["rig"]["link"] == link
    assert trace.run["rig_run"]["ticks"] == 1500

    if link == "udp":
        replay(tmp_path, trace)


def replay(folder, recorded):
    """The rig's measurements replayed without it give the same commands, bit for bit."""
    resonance = recorded.run["parameters"]["valve_controller.resonance"]
    words = ["run", "step", "--node-set", "closed_centre", "--direct", "--no-truth", "--duration"]
    words += ["1.5", "--set", f"valve_controller.resonance={resonance}", "--out", "again"]
    bench = Bench(*words, "--from-bag", f"plant={BAG}", folder=folder)
    status, _, err = bench.finish()
    assert status == 0, err
    again = read_bag(folder / "again" / "closed_centre")
    for topic, payloads in recorded.payloads.items():
        assert np.array_equal(payloads, again.payloads[topic]), topic
    with pytest.raises(BenchError, match="--from-bag plant=BAG"):
        plan_from_bag(recorded, folder / "repeated")


def test_a_replayed_node_answers_the_rig_with_its_recording(rig_run, tmp_path):
    """Beside the bridge, where its messages are handed over, as well as in a process of its own."""
    original = tmp_path / "original"
    words = [*RUN[:4], "--direct", "--duration", "1.5", "--out", str(original)]
    status, _, err = Bench(*words, folder=tmp_path).finish()
    assert status == 0, err
    recorded = read_bag(original / "closed_centre")
    replayed = ["--from-bag", f"driver={original / 'closed_centre'}"]
    replayed += ["--from-bag", f"valve_left={original / 'closed_centre'}"]
    for layout in ((), ("--processes", "each")):
        folder = tmp_path / f"out{len(layout)}"
        bench = rig_run(*replayed, *layout, "--duration", "1.5", "--out", str(folder))
        status, _, err = bench.finish()
        assert status == 0, err
        trace = read_bag(folder / BAG.name)
        assert len(trace.payloads["/steering/torque"]) == 1500
        for topic in ("/driver/torque", "/valve/left/command"):
            assert np.array_equal(trace.payloads[topic], recorded.payloads[topic]), topic
        assert not np.array_equal(
            trace.payloads["/valve/right/command"], recorded.payloads["/valve/right/command"]
        )


def test_a_dead_node_makes_the_rig_safe_and_is_named(rig_run, tmp_path):
    """Stopped, not ended: nobody but the watchdog on the commands can tell."""
    watching = {"command_stale_ticks": 300}
    words = ("--duration", "60", "--processes", "each")
    bench = running(rig_run(*words, watching=watching), tmp_path)
    os.kill(node_process(bench, "vehicle"), signal.SIGSTOP)
    status, _, err = bench.finish()
    assert status == 1
    assert "safe state" in err
    waited = re.search(r"of node 'vehicle': no new commands \(for (\d+) ticks\)", err)
    assert waited is not None, err
    assert 300 <= int(waited.group(1)) <= 300 + WITHIN  # a late machine has several frames at once
    ticks = assert_tidy(bench, tmp_path)
    rig = report(tmp_path)
    assert rig["state"] == "safe"
    safe_at = rig["changes"][-1]["tick"]
    assert safe_at == ticks[-1]
    commanded = read_bag(tmp_path / BAG)["/vehicle/rack_force"]["tick"][-1]
    assert safe_at - commanded <= 300 + WITHIN


def test_a_lost_rig_is_a_lost_link(rig_run, tmp_path):
    bench = running(rig_run("--duration", "60"), tmp_path)
    os.kill(emulator_process(bench), signal.SIGKILL)
    status, out, err = bench.finish()
    assert status == 1
    assert "link lost" in err
    assert "the emulated rig's process had ended (killed by SIGKILL)" in out
    assert_tidy(bench, tmp_path)
    assert report(tmp_path)["state"] == "safe"


def test_ctrl_c_takes_the_emulated_rig_along(rig_run, tmp_path):
    bench = running(rig_run("--duration", "60"), tmp_path)
    os.killpg(bench.process.pid, signal.SIGINT)
    status, _, err = bench.finish()
    assert status == 130, err
    assert_tidy(bench, tmp_path)


def test_a_killed_command_takes_the_emulated_rig_along(rig_run, tmp_path):
    bench = running(rig_run("--duration", "60"), tmp_path)
    bench.process.kill()
    bench.finish()
    assert_tidy(bench, tmp_path)


def small_files() -> None:
    resource.setrlimit(resource.RLIMIT_FSIZE, (2_000_000, 2_000_000))


def test_a_full_disk_ends_the_run_with_the_rig_safe(rig_run, tmp_path):
    bench = rig_run("--duration", "60", preexec_fn=small_files)
    status, _, err = bench.finish()
    assert status == 1
    assert "cannot be written on" in err
    assert len(assert_tidy(bench, tmp_path)) > 100


def test_checks_that_fail_name_every_channel(rig_run, tmp_path):
    """No pressure is raised, and no tick is done."""
    sensors = {
        "supply_pressure": {"noise": 5e3, "offset": -1.5e7},
        "rack_force": {"noise": 3.5, "offset": 2000.0},
    }
    bench = rig_run(
        "--duration", "1", emulator={"sensors": sensors}, watching={"check_timeout_ticks": 500}
    )
    status, _, err = bench.finish()
    assert status == 1
    assert "start-up checks failed" in err
    assert "supply_pressure" in err
    assert "rack_force" in err
    assert "steering_wheel_angle: does not move" not in err
    assert report(tmp_path)["state"] == "safe"
    wait_for(lambda: not bench.left_over(), 10.0)


def test_a_reset_takes_the_rig_up_again(rig_run, tmp_path):
    """The rig's own watchdog trips while it is stopped; the service leaves the safe state."""
    import rclpy
    from std_srvs.srv import Trigger

    domain = 77
    context = rclpy.context.Context()
    rclpy.init(context=context, domain_id=domain)
    node = rclpy.create_node("operator", context=context)
    client = node.create_client(Trigger, "/rig/reset")
    executor = rclpy.executors.SingleThreadedExecutor(context=context)
    executor.add_node(node)
    words = ("--duration", "8", "--rig-fault", "hold", "--domain", str(domain))
    watching = {"stale_ticks": 200}
    bench = running(rig_run(*words, watching=watching), tmp_path)
    assert client.wait_for_service(20.0)
    pid = emulator_process(bench)
    os.kill(pid, signal.SIGSTOP)
    time.sleep(0.6)
    os.kill(pid, signal.SIGCONT)
    future = client.call_async(Trigger.Request())
    executor.spin_until_future_complete(future, timeout_sec=10.0)
    answer = future.result()
    node.destroy_node()
    context.try_shutdown()
    assert answer is not None
    assert answer.success, answer.message
    status, _, err = bench.finish()
    assert status == 0, err
    # A machine that is too busy afterwards makes the rig safe once more.
    states = [change["to"] for change in report(tmp_path)["changes"]][:7]
    assert states == ["checking", "entering", "running", "safe", "checking", "entering", "running"]
    assert_tidy(bench, tmp_path)
