"""The emulated rig as a process, in wall time; limits wide enough for a machine that is busy."""

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from bench_process import wait_for
from healthy_rig import EMULATED, emulated_rig
from rig_links import link_settings
from rig_loop import HOLD

from rig_bridge.bridge import Bridge
from rig_bridge.safety.machine import State
from rig_bridge.transport.registry import TRANSPORTS, trusted_link

BUSY = {"stale_ticks": 1000, "bad_frames": 1e6, "clock_offset_s": 60.0}


def emulator(tmp_path, kind, settings, *more):
    """Start the process; its own watchdog is as patient as the bench's."""
    text = EMULATED.with_name("emulator.yaml").read_text() + "\nstale_ticks: 100000\n"
    (tmp_path / "emulator.yaml").write_text(text)
    given = [f"--setting={name}={value}" for name, value in settings.items()]
    command = [sys.executable, "-m", "rig_bridge.emulator.main", "--link", kind, *given, *more]
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, sys.path))}
    return subprocess.Popen(
        [*command, "--emulator", str(tmp_path / "emulator.yaml")],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env=environment,
    )


@pytest.mark.parametrize("kind", sorted(TRANSPORTS))
def test_in_wall_time(tmp_path, kind):
    table = emulated_rig(**BUSY, check_ticks=50, check_timeout_ticks=100_000)
    with link_settings(kind) as settings:
        link = trusted_link(kind, table, EMULATED.parent, settings)
        process = emulator(tmp_path, kind, settings)
        try:
            bridge = Bridge(table, link)
            until = time.monotonic() + 60.0
            while bridge.guard.state is not State.RUNNING and time.monotonic() < until:
                bridge.receive(0.1)
                bridge.answer(HOLD)
            assert bridge.guard.state is State.RUNNING, bridge.report()
            begin, first = time.monotonic(), bridge.guard.measurements.clock.rig_ns or 0
            for _ in range(1000):
                measured = bridge.receive(0.5)
                bridge.answer(HOLD)
            assert bridge.guard.state is State.RUNNING, bridge.report()
            assert measured["right_pressure"] == pytest.approx(2.0e6, abs=3e5)
            passed = ((bridge.guard.measurements.clock.rig_ns or 0) - first) * 1e-9
            assert 0.5 < passed / (time.monotonic() - begin) < 1.5, "a tick is 1 ms of wall time"
            process.send_signal(signal.SIGTERM)
            out, err = process.communicate(timeout=10.0)
            assert process.returncode == 0, err
            assert json.loads(out.splitlines()[-1])["ticks"] > 1000
        finally:
            process.kill()
            process.communicate()
            link.close()


def test_a_wrong_call_is_one_clear_line(tmp_path):
    process = emulator(tmp_path, "udp", {"bench": "nowhere"})
    _, err = process.communicate(timeout=60.0)
    assert process.returncode == 2
    assert err.startswith("rig_emulator: setting of the udp link: bench")
    assert len(err.splitlines()) == 1


def test_signals_at_any_moment_after_the_first_line_end_it_in_order():
    """One, two, with its input closed as well, and one after the other until it is gone."""
    with link_settings("udp") as settings:
        words = ["-m", "emulator_starts", "20", settings["bench"], settings["rig"]]
        done = run_python(*words)
    assert done.stderr == ""
    for status, told in json.loads(done.stdout):
        assert status == 0
        assert json.loads(told)["ticks"] >= 0


def run_python(*words):
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, sys.path))}
    command = [sys.executable, *words]
    return subprocess.run(command, env=environment, capture_output=True, text=True, timeout=120.0)


def test_a_signal_before_the_first_line_ends_it_at_once_and_without_a_word(tmp_path):
    with link_settings("udp") as settings:
        process = emulator(tmp_path, "udp", settings)
        wait_for(lambda: b"numpy" in Path(f"/proc/{process.pid}/maps").read_bytes())
        process.send_signal(signal.SIGTERM)
        out, err = process.communicate(timeout=10.0)
    assert (out, err) == ("", "")
    assert process.returncode == -signal.SIGTERM
