"""The UDP frame, byte by byte, and that no damaged frame is taken for a whole one."""

import struct
import zlib

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from rig_links import DEMAND, FRAME, RIG

from rig_bridge.transport.packets import PacketError
from rig_bridge.transport.signature import signature
from rig_bridge.transport.udp_codec import UdpCodec

CODEC = UdpCodec(RIG)
PACKED = CODEC.pack_frame(FRAME)


def test_bytes_of_a_frame_by_hand():
    """Written from the documentation of the frame, with no code of the bridge but the signature."""
    counts = (12500, -10000, 50000, 10000, 20000, 333333, 62500, -10000, 37500)
    head = b"SR" + bytes([1, 1]) + struct.pack("<IIqB", signature(RIG), 7, 12_345_678_000, 0)
    body = head + struct.pack("<9i", *counts)
    assert body + struct.pack("<I", zlib.crc32(body)) == PACKED


@given(st.integers(0, 8 * len(PACKED) - 1))
def test_every_single_wrong_bit_is_noticed(bit):
    damaged = bytearray(PACKED)
    damaged[bit // 8] ^= 1 << (bit % 8)
    with pytest.raises(PacketError):
        CODEC.unpack_frame(bytes(damaged))


@given(st.integers(0, len(PACKED) - 1))
def test_every_shortened_frame_is_noticed(length):
    with pytest.raises(PacketError):
        CODEC.unpack_frame(PACKED[:length])


@settings(max_examples=300)
@given(st.binary(max_size=200))
def test_any_bytes_are_refused_in_one_way_only(data):
    for unpack in (CODEC.unpack_frame, CODEC.unpack_demand):
        with pytest.raises(PacketError):
            unpack(data)


def test_frames_of_the_other_direction_are_refused():
    with pytest.raises(PacketError, match="other direction"):
        CODEC.unpack_demand(PACKED)
    with pytest.raises(PacketError, match="other direction"):
        CODEC.unpack_frame(CODEC.pack_demand(DEMAND))


def test_an_unknown_order_is_refused():
    data = bytearray(CODEC.pack_demand(DEMAND))[:-4]
    data[20] = 9
    with pytest.raises(PacketError, match="unknown order 9"):
        CODEC.unpack_demand(bytes(data) + struct.pack("<I", zlib.crc32(bytes(data))))


@given(st.integers(0, 2**40), st.integers(0, 2**62))
def test_sequence_numbers_wrap(sequence, rig_ns):
    frame = FRAME._replace(sequence=sequence, rig_ns=rig_ns)
    there = CODEC.unpack_frame(CODEC.pack_frame(frame))
    assert (there.sequence, there.rig_ns) == (sequence % 2**32, rig_ns)
