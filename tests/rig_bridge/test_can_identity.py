"""Which frames are the rig's: bus, identifier, 11 or 29 bits, format, length; all else is told."""

import time

import can
import pytest
from can_rigs import DBC, FD_ATTRIBUTES, ends, extended, fd_dbc, heard, rig_of, virtual, wire
from rig_links import DEMAND, FRAME

from rig_bridge.transport.registry import check_link

RIGS, BENCHS = (256, 257, 258, 259), (512, 513, 514, 515, 516)
EXTENDED = extended(DBC, (*RIGS, *BENCHS))


def sent(link, bus):
    """Return what the rig's end sends of a packet."""
    link.send_frame(FRAME)
    return heard(bus)


def test_identifiers_of_29_bits_stay_so_both_ways(tmp_path):
    bus = virtual()
    with ends(tmp_path, bus, EXTENDED) as (bench, rig), wire(bus) as other:
        bench.send_demand(DEMAND)
        frames = heard(other)
        assert [(m.arbitration_id, m.is_extended_id) for m in frames] == [(n, True) for n in BENCHS]
        assert len(rig.receive_demands(0.1)) == 1
        rig.send_frame(FRAME)
        assert len(bench.receive_frames(0.1)) == 1


@pytest.mark.parametrize(("dbc", "bits"), [(DBC, 11), (EXTENDED, 29)])
def test_the_same_number_in_the_other_format_is_no_measurement(tmp_path, dbc, bits):
    bus = virtual()
    with ends(tmp_path, bus, dbc) as (bench, rig), wire(bus) as other:
        frames = sent(rig, other)
        assert len(bench.receive_frames(0.1)) == 1
        for m in frames:
            m.is_extended_id = not m.is_extended_id
            other.send(m)
        assert bench.receive_frames(0.02) == []
        assert bench.bad == len(frames)
        assert f"of {40 - bits} bits is not RigStatus, which has {bits}" in bench.problem


def test_one_number_may_be_two_frames(tmp_path):
    dbc = DBC.replace("BO_ 512 Demand", f"BO_ {256 | 1 << 31} Demand")
    bus = virtual()
    with ends(tmp_path, bus, dbc) as (bench, rig):
        bench.send_demand(DEMAND)
        rig.send_frame(FRAME)
        assert len(rig.receive_demands(0.1)) == len(bench.receive_frames(0.1)) == 1
        assert (bench.bad, rig.bad) == (0, 0)


def spoilt(m, how):
    if how == "short":
        m.data, m.dlc = m.data[:-1], m.dlc - 1
    elif how == "long":
        m.is_fd, m.data, m.dlc = True, m.data + b"1234", 12
    elif how == "fd":
        m.is_fd = True
    elif how == "remote":
        m.is_remote_frame, m.data = True, bytearray()
    elif how == "error":
        m.is_error_frame = True
    return m


@pytest.mark.parametrize("how", ["short", "long", "fd", "remote", "error"])
def test_a_frame_of_another_form_is_never_taken(tmp_path, how):
    bus = virtual()
    with ends(tmp_path, bus) as (bench, rig), wire(bus) as other:
        frames = sent(rig, other)
        bench.receive_frames(0.1)
        for m in frames:
            other.send(spoilt(m, how))
        assert bench.receive_frames(0.02) == []
        assert bench.bad == len(frames)
        assert bench.problem.startswith(f"CAN bus virtual {bus['channel']}: ")


def test_a_classic_frame_is_not_one_of_can_fd(tmp_path):
    bus = virtual(fd=True)
    with ends(tmp_path, bus, DBC) as (bench, rig), wire(bus) as other:
        frames = sent(rig, other)
        assert all(m.is_fd for m in frames), "the file says of no message what it is"
        bench.receive_frames(0.1)
        for m in frames:
            m.is_fd = False
            other.send(m)
        assert bench.receive_frames(0.02) == []
        assert "a frame of classic CAN, not of CAN FD" in bench.problem


def test_the_file_says_which_frames_of_a_bus_are_can_fd(tmp_path):
    dbc = DBC + FD_ATTRIBUTES + 'BA_ "VFrameFormat" BO_ 257 14;\n'
    bus = virtual(fd=True, data_bitrate=2_000_000)
    with ends(tmp_path, bus, dbc) as (bench, rig), wire(bus) as other:
        frames = sent(rig, other)
        assert [m.arbitration_id for m in frames if m.is_fd] == [257]
        assert [m.arbitration_id for m in frames if m.bitrate_switch] == [257]
        assert len(bench.receive_frames(0.1)) == 1


def test_its_own_echo_is_nothing_but_somebody_else_s_commands_are_told(tmp_path):
    bus = virtual(receive_own_messages=True)
    with ends(tmp_path, bus) as (bench, rig), wire(bus) as other:
        bench.send_demand(DEMAND)
        commands = heard(other)
        assert bench.receive_frames(0.02) == []
        assert (bench.bad, bench.problem) == (0, None)
        assert len(rig.receive_demands(0.1)) == 1
        for m in commands:
            other.send(m)
        assert bench.receive_frames(0.02) == []
        assert bench.bad == len(commands)
        assert "somebody else sends BenchStatus" in bench.problem


def test_a_busy_bus_does_not_hide_a_silent_rig(tmp_path):
    """Foreign frames came faster than the wait, and it began again with each."""
    bus = virtual()
    with ends(tmp_path, bus) as (bench, _), wire(bus) as other:
        task = other.send_periodic(can.Message(arbitration_id=0x123, is_extended_id=False), 1e-3)
        begin = time.monotonic()
        assert bench.receive_frames(0.02) == []
        task.stop()
        assert time.monotonic() - begin < 0.2


def test_long_frames_hold_what_cantools_packs(tmp_path):
    """48 bytes, and a wire length that the message does not fill."""
    dbc = fd_dbc().replace("BO_ 256 Measured: 48", "BO_ 256 Measured: 41")
    bus = virtual(fd=True, data_bitrate=4_000_000)
    with ends(tmp_path, bus, dbc) as (bench, rig), wire(bus) as other:
        frames = sent(rig, other)
        assert [(len(m.data), m.is_fd, m.bitrate_switch) for m in frames] == [
            (48, True, True),
            (8, True, True),
        ]
        assert frames[0].data[41:] == bytes(7)
        assert len(bench.receive_frames(0.1)) == 1
        frames[0].data, frames[0].dlc = frames[0].data[:41], 41
        for m in frames:
            other.send(m)
        assert bench.receive_frames(0.02) == []


@pytest.mark.parametrize("dbc", [DBC, EXTENDED, fd_dbc()])
def test_what_both_ends_compare_knows_the_identifier_s_bits(tmp_path, dbc):
    rig = rig_of(tmp_path, virtual(fd=True), dbc)
    check_link("can", rig, tmp_path)
    with ends(tmp_path, virtual(fd=True), dbc) as (bench, _):
        mine = bench.codec.signature
    moved = dbc.replace("BO_ 259 ", f"BO_ {259 | 1 << 31} ")
    moved = moved.replace(f"BO_ {259 | 1 << 31} ", "BO_ 259 ") if dbc is EXTENDED else moved
    with ends(tmp_path, virtual(fd=True), moved) as (bench, _):
        assert bench.codec.signature != mine
