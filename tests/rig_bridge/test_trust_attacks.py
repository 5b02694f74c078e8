"""Another process on this machine against the emulated rig, itself a process, and the bench.

It has no key. It never moves the rig, and the bench never takes a measurement of it; without a key
it does move the rig, which shows that the attack is one. Watchdogs are patient: none of them helps.
"""

import json
import os
import subprocess
import sys
import time
from contextlib import contextmanager
from pathlib import Path

import pytest
import yaml
from healthy_rig import EMULATED
from rig_links import free_port
from rig_loop import HOLD

from rig_bridge.bridge import Bridge
from rig_bridge.rig_file import load_rig
from rig_bridge.safety.machine import State
from rig_bridge.transport.can_hub import CanHub
from rig_bridge.transport.registry import trusted_link

ATTACKER = Path(__file__).parents[1] / "support" / "rig_attacker.py"
PATIENT = {
    "stale_ticks": 1000,
    "command_stale_ticks": 1000,
    "bad_frames": 1e6,
    "clock_offset_s": 60.0,
    "clock_step_s": 10.0,
    "check_ticks": 50,
    "check_timeout_ticks": 100_000,
    "entry_ticks": 20,
}
STILL_RAD = 0.07
"""How far the bench's own commands turn the wheel; the attacker asks for ten times as much."""


@pytest.fixture(autouse=True)
def home(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path / "config"))


def rig_file(folder, authentication="key"):
    """Write the shipped rig with patient watchdogs; return its path."""
    rig = yaml.safe_load(EMULATED.read_text())
    rig |= {"watching": PATIENT, "relations": {}, "rates": {}, "authentication": authentication}
    own = yaml.safe_load(EMULATED.with_name("emulator.yaml").read_text()) | {"stale_ticks": 100_000}
    (folder / "emulator.yaml").write_text(yaml.safe_dump(own))
    (folder / "emulated.dbc").write_bytes(EMULATED.with_suffix(".dbc").read_bytes())
    path = folder / "rig.yaml"
    path.write_text(yaml.safe_dump(rig, sort_keys=False))
    return path


@contextmanager
def process(*words):
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, sys.path))}
    pipe = subprocess.PIPE
    with subprocess.Popen(
        [sys.executable, *words], env=environment, stdin=pipe, stdout=pipe, text=True
    ) as started:
        try:
            assert started.stdout is not None
            assert "ready" in started.stdout.readline()
            yield started
        finally:
            started.kill()


def ended(started):
    """End a process by its input, an attacker's or an attached rig's; return what it tells."""
    out, _ = started.communicate(timeout=20.0)
    return json.loads(out.splitlines()[-1])


def emulator(path, kind, settings):
    words = ["-m", "rig_bridge.emulator.main", "--attached", "--link", kind, "--rig", str(path)]
    words += ["--emulator", str(path.parent / "emulator.yaml"), "--settings", json.dumps(settings)]
    return process(*words)


def attacker(*words):
    return process(str(ATTACKER), *words)


@contextmanager
def bench(path, kind, settings):
    rig = load_rig(path)
    link = trusted_link(kind, rig, path.parent, settings)
    try:
        yield Bridge(rig, link)
    finally:
        link.close()


def drive(bridge, seconds, asked=HOLD):
    """Answer the rig for some time; return the largest angle that the bench believed [rad]."""
    until, largest = time.monotonic() + seconds, 0.0
    while time.monotonic() < until:
        largest = max(largest, abs(bridge.receive(0.02)["steering_wheel_angle"]))
        bridge.answer(asked)
    return largest


def listened(bridge):
    """Take what comes for some time without an answer; return the angle then [rad]."""
    until = time.monotonic() + 0.6
    while time.monotonic() < until:
        measured = bridge.receive(0.02)
    return measured["steering_wheel_angle"]


def started(bridge):
    until = time.monotonic() + 30.0
    while bridge.guard.state is not State.RUNNING and time.monotonic() < until:
        bridge.receive(0.02)
        bridge.answer(HOLD)
    assert bridge.guard.state is State.RUNNING, bridge.report()


def angle(bridge):
    """Return where the wheel is by the rig's own measurement [rad], told to nobody else."""
    started(bridge)
    return bridge.receive(0.1)["steering_wheel_angle"]


def udp_ports(*names):
    return {name: f"127.0.0.1:{free_port()}" for name in names}


@pytest.mark.parametrize("authentication", ["key", "none"])
def test_who_has_the_bench_s_address_first_moves_the_rig_only_without_a_key(
    tmp_path, authentication
):
    path, settings = rig_file(tmp_path, authentication), udp_ports("bench", "rig")
    with emulator(path, "udp", settings) as rig:
        with attacker("squat", settings["bench"], settings["rig"]) as thief:
            time.sleep(0.7)
            tried = ended(thief)
        with bench(path, "udp", settings) as bridge:
            if authentication == "none":
                assert tried["measurements"] > 100
                assert abs(bridge.link.receive_frames(1.0)[-1].values[0]) > 10.0 * STILL_RAD
                return
            assert abs(angle(bridge)) < STILL_RAD
        told = ended(rig)
    assert tried["pushes"] > 100
    assert tried["answers"] > 10
    assert "measurements" not in tried
    assert told["foreign_packets"] >= 2 * tried["pushes"] - 10


def test_somebody_on_the_path_moves_nothing_and_goes_on_in_vain_after_hold(tmp_path):
    path, places = rig_file(tmp_path), udp_ports("bench", "front", "back", "rig")
    rig_side = {"bench": places["back"], "rig": places["rig"]}
    bench_side = {"bench": places["bench"], "rig": places["front"]}
    with (
        emulator(path, "udp", rig_side) as rig,
        attacker("relay", places["front"], places["back"], places["rig"]) as relay,
        bench(path, "udp", bench_side) as bridge,
    ):
        started(bridge)
        assert drive(bridge, 1.0) < STILL_RAD
        assert bridge.guard.state is State.RUNNING
        # What follows is recorded on the path, and repeated behind the order to hold.
        moved = drive(bridge, 0.3, HOLD | {"driver_torque": 8.0})
        assert bridge.guard.state is State.RUNNING, bridge.guard.fault
        assert moved > 2.0 * STILL_RAD
        for _ in range(3):
            bridge.hold()
        rests = listened(bridge)
        assert listened(bridge) == pytest.approx(rests, abs=0.02)
        counts = bridge.link.peer.counts
        tried = ended(relay)
        told = ended(rig)
    assert tried["holds"] == 3
    assert tried["alone"] >= 5
    assert counts["foreign"] > 500
    assert counts["replayed"] > 200
    assert told["foreign_packets"] > 500
    assert told["replayed_packets"] > 1000


def test_somebody_on_the_can_bus_moves_nothing_and_is_not_believed(tmp_path):
    hub, path = CanHub(), rig_file(tmp_path)
    where = {"interface": "socketcand", "channel": "can0", "host": "127.0.0.1", "port": hub.port}
    try:
        with emulator(path, "can", [where]) as rig:
            with attacker("can", str(hub.port)) as stranger:
                time.sleep(0.5)
                with bench(path, "can", [where]) as bridge:
                    assert drive(bridge, 1.0) < STILL_RAD
                    assert bridge.link.bad > 100
                tried = ended(stranger)
            with bench(path, "can", [where]) as bridge:
                assert abs(angle(bridge)) < STILL_RAD
            ended(rig)
    finally:
        hub.close()
    assert tried["pushes"] > 100
