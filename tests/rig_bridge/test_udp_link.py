"""The UDP link with bad datagrams, strangers and nobody."""

import socket
import time

import pytest
from rig_links import DEMAND, FRAME, RIG, both_ends, free_port

from rig_bridge.transport.settings import UdpSettings
from rig_bridge.transport.udp import UdpLink
from steering_core.errors import BenchError


def test_bad_datagrams_are_counted_and_said():
    with both_ends("udp") as (bench, rig):
        rig.socket.send(b"what is this")
        rig.send_frame(FRAME)
        assert len(bench.receive_frames(1.0)) == 1
        assert bench.bad == 1
        assert "no frame of a rig" in bench.problem
        data = bytearray(rig.codec.pack_frame(FRAME))
        data[30] ^= 1
        rig.socket.send(bytes(data))
        assert bench.receive_frames(0.1) == []
        assert bench.problem == "wrong checksum"


def test_a_stranger_is_not_heard():
    with (
        both_ends("udp") as (bench, rig),
        socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as stranger,
    ):
        stranger.sendto(rig.codec.pack_frame(FRAME), bench.socket.getsockname())
        assert bench.receive_frames(0.1) == []
        assert bench.bad == 0


def test_nobody_there_is_noticed_and_so_is_somebody():
    ports = free_port(), free_port()
    settings = UdpSettings(bench=f"127.0.0.1:{ports[0]}", rig=f"127.0.0.1:{ports[1]}")
    bench = UdpLink(RIG, settings)
    try:
        for _ in range(3):
            bench.send_demand(DEMAND)
            bench.receive_frames(0.02)
        begin = time.monotonic()
        bench.send_demand(DEMAND)
        assert bench.receive_frames(0.1) == []
        assert time.monotonic() - begin > 0.08, "being refused does not cut the wait short"
        assert not bench.up
        assert "refused" in str(bench.problem)
        rig = UdpLink(RIG, settings, rig_end=True)
        rig.send_frame(FRAME)
        assert len(bench.receive_frames(1.0)) == 1
        assert bench.up
        rig.close()
    finally:
        bench.close()


def test_a_port_in_use_is_named():
    with both_ends("udp") as (bench, _):
        host, port = bench.socket.getsockname()
        with pytest.raises(BenchError, match=f"{host}:{port}"):
            UdpLink(RIG, UdpSettings(bench=f"{host}:{port}"))
