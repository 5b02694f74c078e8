"""Several buses, and CAN FD, over what this machine has: in the process, a hub, multicast, vcan."""

import socket
import time
from typing import Any

import can
import pytest
from can_rigs import DBC, count_in, ends, fd_dbc, heard, rig_of, virtual, wire
from healthy_rig import emulated_rig
from rig_links import COMMANDED, DEMAND, FRAME, MEASURED, RIG, link_settings

from rig_bridge.bridge import Bridge
from rig_bridge.safety.machine import State
from rig_bridge.transport.can_bus import CanBuses
from rig_bridge.transport.registry import check_link, open_link
from rig_bridge.transport.settings import CanSettings
from steering_core.errors import BenchError

BENCHS = ["Demand", "LeftValve", "RightValve", "Load", "BenchStatus"]
RIGS = ["Wheel", "Pressure", "Rack", "RigStatus"]
HALVES = ["Wheel", "RigStatus", "Demand", "BenchStatus"]


def has_can():
    """Return whether this machine has a CAN FD bus ``vcan0`` (ip link add vcan0 type vcan)."""
    try:
        with socket.socket(socket.AF_CAN, socket.SOCK_RAW, socket.CAN_RAW) as probe:
            probe.setsockopt(socket.SOL_CAN_RAW, socket.CAN_RAW_FD_FRAMES, 1)
            probe.bind(("vcan0",))
    except OSError:
        return False
    return True


def multicasts():
    """Return whether multicast datagrams come back on this machine."""
    try:
        with can.Bus(**MULTICAST) as near, can.Bus(**MULTICAST) as far:
            near.send(can.Message(arbitration_id=1, is_extended_id=False))
            return far.recv(0.2) is not None
    except (can.CanError, OSError):
        return False


MULTICAST: dict[str, Any] = {
    "interface": "udp_multicast",
    "channel": "239.74.163.2",
    "hop_limit": 0,
}


@pytest.fixture(params=["virtual", "socketcand", "udp_multicast", "socketcan"])
def bus(request):
    """Give the settings of a CAN FD bus."""
    if request.param == "virtual":
        yield virtual(fd=True)
    elif request.param == "socketcand":
        with link_settings("can") as settings:
            yield {**settings, "fd": True}
    elif request.param == "udp_multicast":
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
            probe.bind(("127.0.0.1", 0))
            MULTICAST["port"] = probe.getsockname()[1]
        if not multicasts():
            pytest.skip("no multicast on this machine")
        yield {**MULTICAST, "fd": True}
    else:
        if not has_can():
            pytest.skip("no CAN FD bus vcan0 on this machine")
        yield {"interface": "socketcan", "channel": "vcan0", "fd": True}


def crossed(receive):
    limit = time.monotonic() + 5.0
    while time.monotonic() < limit:
        if packets := receive(0.1):
            return packets
    raise AssertionError("nothing has come")


def test_packets_cross_a_bus_of_can_fd(tmp_path, bus):
    with ends(tmp_path, bus, fd_dbc()) as (bench, rig):
        rig.send_frame(FRAME)
        (frame,) = crossed(bench.receive_frames)
        bench.send_demand(DEMAND)
        (demand,) = crossed(rig.receive_demands)
        close(RIG.measured, frame.values, MEASURED)
        close(RIG.commanded, demand.values, COMMANDED)
        assert (bench.bad, rig.bad) == (0, 0)


def close(names, received, sent):
    for name, there, here in zip(names, received, sent, strict=True):
        assert there == pytest.approx(here, abs=0.51 * RIG.channels[name].scale), name


def test_bits_of_a_long_frame_read_by_hand(tmp_path):
    """Motorola order: each channel's 32 bits begin at the highest bit of a byte."""
    bus = virtual(fd=True)
    with ends(tmp_path, bus, fd_dbc()) as (_, rig), wire(bus) as other:
        rig.send_frame(FRAME)
        data = bytes(heard(other)[0].data)
    for index, (name, value) in enumerate(zip(RIG.measured, MEASURED, strict=True)):
        count = count_in(data, 7 + 32 * index, 32, True, "-")
        assert count == round(value / RIG.channels[name].scale), name
    assert count_in(data, 320, 8, False, "+") == FRAME.sequence


@pytest.fixture(params=["virtual", "socketcand"])
def pair(request):
    """Give the settings of two buses: read by threads, and waited for by the system."""
    if request.param == "virtual":
        yield [virtual(), virtual(messages=HALVES)]
    else:
        with link_settings("can") as one:
            yield [one, {**one, "channel": "can1", "messages": HALVES}]


def test_a_packet_s_frames_are_on_two_buses(tmp_path, pair):
    with ends(tmp_path, pair) as (bench, rig):
        for k in range(50):
            rig.send_frame(FRAME._replace(sequence=k, rig_ns=k * 1_000_000))
            (frame,) = crossed(bench.receive_frames)
            assert frame.rig_ns == k * 1_000_000
            bench.send_demand(DEMAND._replace(sequence=k, answers=k))
            (demand,) = crossed(rig.receive_demands)
            assert demand.answers == k
        assert (bench.bad, rig.bad) == (0, 0)


def test_each_message_is_on_its_own_bus_only(tmp_path):
    first, second = virtual(), virtual(messages=HALVES)
    with ends(tmp_path, [first, second]) as (bench, rig), wire(first) as a, wire(second) as b:
        rig.send_frame(FRAME)
        bench.send_demand(DEMAND)
        on_first, on_second = heard(a), heard(b)
        assert {m.arbitration_id for m in on_second} == {256, 259, 512, 516}
        assert {m.arbitration_id for m in on_first} == {257, 258, 513, 514, 515}
        bench.receive_frames(0.05)
        for m in on_second:
            a.send(m)
        for m in on_first:
            b.send(m)
        assert bench.receive_frames(0.05) == [], "a frame on the other bus is not the rig's"


def test_a_bus_that_falls_silent_is_named(tmp_path):
    first, second = virtual(), virtual(messages=HALVES)
    table = rig_of(tmp_path, [first, second])
    with ends(tmp_path, [first, second]) as (bench, rig), wire(first) as other:
        bridge = Bridge(table.model_copy(update={"watching": emulated_rig().watching}), bench)
        rig.send_frame(FRAME)
        bridge.receive(0.05)
        bridge.guard.state = State.RUNNING
        for k in range(8):
            rig.codec.pack_frame(FRAME)
            for f in rig.codec.pack_frame(FRAME._replace(sequence=8 + k)):
                if f.bus == 0:
                    other.send(
                        can.Message(arbitration_id=f.number, data=f.data, is_extended_id=False)
                    )
            bridge.receive(0.005)
            bridge.answer(dict.fromkeys(table.commanded, 0.0))
        assert bridge.guard.state is State.SAFE
        fault = str(bridge.guard.fault)
    assert "no new measurements" in fault
    assert f"Wheel, RigStatus on virtual {second['channel']}" in fault
    assert first["channel"] not in fault


def test_a_bus_that_fails_is_named_and_the_other_is_still_sent_to(tmp_path):
    first, second = virtual(), virtual(messages=HALVES)
    with ends(tmp_path, [first, second]) as (bench, _), wire(second) as other:
        bench.buses.buses[0].shutdown()
        bench.send_demand(DEMAND)
        assert not bench.up
        assert bench.problem.startswith(f"CAN bus virtual {first['channel']}: ")
        assert {m.arbitration_id for m in heard(other)} == {512, 516}


def test_buses_with_a_file_each_may_use_a_name_twice(tmp_path):
    """The second file calls its status frames as the first; each message is on the bus it is on."""
    (tmp_path / "second.dbc").write_text(DBC.replace("BO_ 257 ", "BO_ 777 "))
    buses = [virtual(), virtual(messages=["Pressure", "Load"], dbc="second.dbc")]
    with ends(tmp_path, buses) as (bench, rig), wire(buses[1]) as other:
        rig.send_frame(FRAME)
        assert [m.arbitration_id for m in heard(other)] == [777]
        assert len(crossed(bench.receive_frames)) == 1


@pytest.mark.parametrize(
    ("buses", "said"),
    [
        ([{}, {}], "the bus virtual can0 is there twice"),
        ([{}, {"channel": "b"}], "which messages are on virtual can0 and virtual b"),
        ([{}, {"channel": "b", "messages": ["Wheal"]}], "'Wheal' of virtual b is not one"),
        ([{}, {"channel": "b", "messages": []}], "no message of the rig is on virtual b"),
        (
            [{"messages": ["Rack"]}, {"channel": "b", "messages": ["Wheel"]}],
            "message 'Pressure' is on no bus",
        ),
        (
            [{}, {"channel": "b", "messages": ["Rack"]}, {"channel": "c", "messages": ["Rack"]}],
            "'Rack' is on virtual b and virtual c",
        ),
        ([{}, {"channel": "b", "dbc": "gone.dbc", "messages": ["Rack"]}], "there is no DBC file"),
    ],
)
def test_buses_that_cannot_be_are_refused_before_the_run(tmp_path, buses, said):
    rig = rig_of(tmp_path, [{"interface": "virtual", **one} for one in buses])
    with pytest.raises(BenchError) as error:
        check_link("can", rig, tmp_path)
    assert said in str(error.value)


def test_of_two_buses_the_first_is_closed_where_the_second_cannot_be_opened(tmp_path):
    good, bad = virtual(), {"interface": "socketcan", "channel": "nocan7", "messages": HALVES}
    with pytest.raises(BenchError, match="cannot open the CAN bus socketcan nocan7"):
        open_link("can", rig_of(tmp_path, [good, bad]), tmp_path, [good, bad])


def test_a_flood_on_one_bus_leaves_the_other_its_turn():
    with link_settings("can") as one:
        settings = [CanSettings.model_validate({**one, "channel": name}) for name in ("a", "b")]
        near, far = CanBuses(settings), CanBuses(settings)
        for _ in range(300):
            far.buses[0].send(can.Message(arbitration_id=1, is_extended_id=False))
        far.buses[1].send(can.Message(arbitration_id=2, is_extended_id=False))
        time.sleep(0.1)
        come = [near.receive(0.1) for _ in range(301)]
        order = [one[0] for one in come if one is not None]
        assert order.index(1) < 200
        assert sorted(order) == [0] * 300 + [1]
        assert near.receive(0.01) is None
        near.close()
        far.close()
