"""The longest frames, against the Linux kernel's table and frames stuffed bit by bit here."""

import random

import pytest
from can_rigs import DBC, extended, fd_dbc, rig_of

from rig_bridge.transport.can_load import Bits, FrameShape, worst_bits, worst_load
from rig_bridge.transport.can_options import Rates
from rig_bridge.transport.registry import check_link
from steering_core.errors import BenchError

ALL = (256, 257, 258, 259, 512, 513, 514, 515, 516)


@pytest.mark.parametrize(
    ("length", "extended_id", "fd", "bits"),
    [
        (8, False, False, 135),
        (8, True, False, 160),
        (64, False, True, 712),
        (64, True, True, 736),
    ],
)
def test_the_longest_frames_of_each_kind(length, extended_id, fd, bits):
    """As in linux/can/length.h (2023), with stuffing and the space between frames."""
    assert worst_bits(FrameShape(length, extended_id, fd)) == Bits(bits, 0)


def stuffed(bits):
    """Insert a bit after five equal ones, as a transmitter does; return where, too."""
    sent: list[int] = []
    run, places = 0, []
    for index, bit in enumerate(bits):
        run = run + 1 if sent and sent[-1] == bit else 1
        sent.append(bit)
        if run == 5:
            sent.append(1 - bit)
            places.append(index)
            run = 1
    return sent, places


def crc15(bits):
    register = 0
    for bit in bits:
        register = (register << 1 & 0x7FFF) ^ (0x4599 if bit ^ register >> 14 else 0)
    return [register >> place & 1 for place in range(14, -1, -1)]


def word(number, width):
    return [number >> place & 1 for place in range(width - 1, -1, -1)]


def classic(identifier, data, extended_id):
    """Return the bits of a classic frame on the wire, the space after it included."""
    head = [0]
    if extended_id:
        head += [*word(identifier >> 18, 11), 1, 1, *word(identifier & 0x3FFFF, 18), 0, 0, 0]
    else:
        head += [*word(identifier, 11), 0, 0, 0]
    head += word(len(data), 4) + [bit for octet in data for bit in word(octet, 8)]
    return stuffed(head + crc15(head))[0] + [1] + [0, 1] + [1] * 7 + [1] * 3


@pytest.mark.parametrize("extended_id", [False, True])
def test_no_classic_frame_is_longer_and_some_come_near(extended_id):
    rand = random.Random(5)
    for length in (0, 1, 4, 8):
        most = worst_bits(FrameShape(length, extended_id)).nominal
        longest = 0
        for _ in range(300):
            dull = rand.choice((b"\x00", b"\xff", b"\x0f", b"\x87", b"\xf0", b"\x1e", b"\x78"))
            data = dull * length if rand.random() < 0.7 else rand.randbytes(length)
            identifier = rand.choice((0, 0x7F, 0x78, 0x783, 0x1E1E1E1E, 0x0F0F0F0F, 0x1F07C1F0))
            number = identifier & (0x1FFFFFFF if extended_id else 0x7FF)
            longest = max(longest, len(classic(number, data, extended_id)))
        assert most - 12 <= longest <= most


def fd_parts(identifier, data, extended_id):
    """Return the bits of a CAN FD frame at either rate; the CRC's value does not matter here."""
    if extended_id:
        head = [0, *word(identifier >> 18, 11), 1, 1, *word(identifier & 0x3FFFF, 18), 0, 1, 0, 1]
    else:
        head = [0, *word(identifier, 11), 0, 0, 1, 0, 1]
    rest = [0] + word(9 + (len(data) > 12), 4) + [b for octet in data for b in word(octet, 8)]
    before = sum(place < len(head) for place in stuffed(head + rest)[1])
    after = len(stuffed(head + rest)[1]) - before
    check = 4 + (17 if len(data) <= 16 else 21)
    fixed = 1 + check // 4
    return len(head) + before + 1 + 12, len(rest) + after + check + fixed


@pytest.mark.parametrize("extended_id", [False, True])
def test_no_frame_of_can_fd_is_longer_at_either_rate(extended_id):
    rand = random.Random(6)
    for length in (8, 16, 20, 64):
        slow, fast = worst_bits(FrameShape(length, extended_id, True, True))
        longest = 0
        for _ in range(200):
            data = rand.choice((b"\x00", b"\xff", b"\x0f", b"\x87", b"\x78")) * length
            number = rand.choice((0, 0x78, 0x1E1E1E1E)) & (0x1FFFFFFF if extended_id else 0x7FF)
            parts = fd_parts(number, data, extended_id)
            assert parts[0] <= slow
            assert sum(parts) <= slow + fast
            longest = max(longest, sum(parts))
        assert longest > 0.93 * (slow + fast)


def test_the_share_by_hand():
    """Nine classic frames of 135 bits in a millisecond at 1 Mbit/s; two at the rates of CAN FD."""
    nine = [FrameShape(8, False)] * 9
    assert worst_load(nine, Rates(1_000_000, 1_000_000)) == pytest.approx(1.215)
    slow, fast = worst_bits(FrameShape(48, False, True, True))
    two = [FrameShape(48, False, True, True)] * 2
    share = 2.0 * (slow / 500e3 + fast / 4e6) * 1e3
    assert worst_load(two, Rates(500_000, 4_000_000)) == pytest.approx(share)


CAN = {"interface": "socketcan", "channel": "can0"}


def test_one_classic_bus_is_not_enough_for_the_shipped_table(tmp_path):
    rig = rig_of(tmp_path, {**CAN, "bitrate": 1_000_000})
    with pytest.raises(BenchError, match=r"can0: 11 messages .* up to 148\.5 % of 1 Mbit/s"):
        check_link("can", rig, tmp_path)
    long = rig_of(tmp_path, {**CAN, "bitrate": 1_000_000}, extended(DBC, ALL))
    with pytest.raises(BenchError, match=r"up to 171\.0 %"):
        check_link("can", long, tmp_path)


def test_two_buses_are(tmp_path):
    up = {**CAN, "bitrate": 1_000_000}
    down = {**CAN, "channel": "can1", "bitrate": 1_000_000, "messages": commands()}
    notes = check_link("can", rig_of(tmp_path, [up, down]), tmp_path)
    assert "can0: the rig takes up to 67.5 % of 1 Mbit/s, 32.5 % remain" in notes[0]
    assert "can1: the rig takes up to 81.0 % of 1 Mbit/s, 19.0 % remain" in notes[1]


def commands():
    return ["Demand", "LeftValve", "RightValve", "Load", "BenchStatus", "BenchTag", "BenchMeet"]


def test_can_fd_is(tmp_path):
    bus = {**CAN, "fd": True, "bitrate": 500_000, "data_bitrate": 5_000_000}
    (note,) = check_link("can", rig_of(tmp_path, bus, fd_dbc()), tmp_path)
    assert "of 0.5 and 5 Mbit/s" in note
    slow = {**bus, "data_bitrate": 500_000}
    with pytest.raises(BenchError, match=r"can0: 6 messages"):
        check_link("can", rig_of(tmp_path, slow, fd_dbc()), tmp_path)


def test_a_rate_that_nobody_told_is_said_of_hardware(tmp_path):
    bare = {"emulator": None, "authentication": "none"}
    note, unprotected = check_link("can", rig_of(tmp_path, CAN).model_copy(update=bare), tmp_path)
    assert "whoever reaches its link can move the rig" in unprotected
    assert "load is not known, as links.can gives no bitrate" in note
