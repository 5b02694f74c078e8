"""Every transport alike, both ends on this machine: what is sent arrives, once and in order."""

import math
import time
from typing import Any

import pytest
from rig_links import COMMANDED, DEMAND, FRAME, MEASURED, RIG, both_ends

from rig_bridge.transport.packets import Order
from rig_bridge.transport.registry import TRANSPORTS, open_link
from steering_core.errors import BenchError

WAIT_S = 10.0


@pytest.fixture(params=sorted(TRANSPORTS))
def ends(request):
    with both_ends(request.param) as pair:
        yield pair


def collected(receive, count):
    packets: list[Any] = []
    limit = time.monotonic() + WAIT_S
    while len(packets) < count and time.monotonic() < limit:
        packets += receive(0.1)
    return packets


def assert_close(names, received, sent):
    for name, there, here in zip(names, received, sent, strict=True):
        assert there == pytest.approx(here, abs=0.51 * RIG.channels[name].scale), name


def test_measurements_arrive(ends):
    bench, rig = ends
    rig.send_frame(FRAME)
    (frame,) = collected(bench.receive_frames, 1)
    assert frame.sequence == FRAME.sequence % (1 << bench.sequence_bits)
    assert (frame.rig_ns, frame.rig_safe) == (FRAME.rig_ns, False)
    assert_close(RIG.measured, frame.values, MEASURED)


def test_commands_arrive(ends):
    bench, rig = ends
    bench.send_demand(DEMAND)
    (demand,) = collected(rig.receive_demands, 1)
    assert (demand.order, demand.answers) == (Order.RUN, DEMAND.answers)
    assert_close(RIG.commanded, demand.values, COMMANDED)


def test_a_missing_value_arrives_as_nan(ends):
    bench, rig = ends
    rig.send_frame(FRAME._replace(values=(math.nan, *MEASURED[1:]), rig_safe=True))
    (frame,) = collected(bench.receive_frames, 1)
    assert math.isnan(frame.values[0])
    assert frame.rig_safe
    assert_close(RIG.measured[1:], frame.values[1:], MEASURED[1:])


def test_values_beyond_what_the_link_holds_are_limited_and_stay_out_of_range(ends):
    """Limited to the largest number, not wrapped round to a plausible one."""
    bench, rig = ends
    rig.send_frame(FRAME._replace(values=tuple(1e30 for _ in MEASURED)))
    (frame,) = collected(bench.receive_frames, 1)
    for name, value in zip(RIG.measured, frame.values, strict=True):
        assert value > RIG.channels[name].range[1], name


def test_a_thousand_both_ways_in_order(ends):
    bench, rig = ends
    bits = bench.sequence_bits
    for first in range(0, 1000, 50):
        for k in range(first, first + 50):
            rig.send_frame(FRAME._replace(sequence=k, rig_ns=k * 1_000_000))
            bench.send_demand(DEMAND._replace(sequence=k, answers=k))
        frames = collected(bench.receive_frames, 50)
        demands = collected(rig.receive_demands, 50)
        expected = [k % (1 << bits) for k in range(first, first + 50)]
        assert [frame.sequence for frame in frames] == expected
        assert [frame.rig_ns for frame in frames] == [
            k * 1_000_000 for k in range(first, first + 50)
        ]
        assert [demand.answers for demand in demands] == list(range(first, first + 50))
    assert (bench.bad, rig.bad) == (0, 0)


def test_nothing_comes_from_a_silent_peer_and_the_wait_ends(ends):
    bench, _ = ends
    begin = time.monotonic()
    assert bench.receive_frames(0.05) == []
    assert 0.03 < time.monotonic() - begin < 5.0


def test_the_other_end_may_leave_and_nothing_raises(ends):
    bench, rig = ends
    rig.close()
    for _ in range(5):
        bench.send_demand(DEMAND)
        bench.receive_frames(0.01)


@pytest.mark.parametrize("kind", sorted(TRANSPORTS))
def test_another_channel_table_is_refused_with_the_reason(kind):
    channels = dict(RIG.channels)
    channels["rack_force"] = channels["rack_force"].model_copy(update={"scale": 0.05})
    other = RIG.model_copy(update={"channels": channels})
    with both_ends(kind) as (bench, _), both_ends(kind, other) as (_, stranger):
        far = bench.codec
        if kind == "udp":
            with pytest.raises(ValueError, match="another channel table"):
                far.unpack_frame(stranger.codec.pack_frame(FRAME))
        else:
            packed = stranger.codec.pack_frame(FRAME)
            with pytest.raises(ValueError, match="another channel table"):
                [far.take_frame(*frame) for frame in packed]


def test_an_unknown_transport_names_the_nearest(tmp_path):
    with pytest.raises(BenchError, match="did you mean 'can'"):
        open_link("cann", RIG, tmp_path)


def test_a_wrong_setting_is_named(tmp_path):
    with pytest.raises(BenchError, match="bench"):
        open_link("udp", RIG, tmp_path, {"bench": "nowhere"})
