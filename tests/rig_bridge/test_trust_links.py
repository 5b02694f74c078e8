"""Links with a key: they meet, carry all that links without one do, and refuse everything else."""

import pytest
from healthy_rig import EMULATED, emulated_rig
from rig_links import DEMAND, FRAME, RIG, both_ends, link_settings, meet
from rig_loop import HOLD, Loop

from rig_bridge.safety.faults import Kind
from rig_bridge.safety.machine import State
from rig_bridge.transport.packets import Order
from rig_bridge.transport.registry import TRANSPORTS, open_link

KEY = bytes(range(32))
WAIT_S = 0.5
"""A question is no packet: the rig's end waits on behind it."""

pytestmark = pytest.mark.parametrize("kind", sorted(TRANSPORTS))


def raw(link, kind):
    """Return what sends already packed things as this end of a link does."""
    return (lambda packed: link.socket.send(packed)) if kind == "udp" else link._send


def packed(link, demand=DEMAND):
    return link.codec.pack_demand(demand)


def test_nothing_goes_out_before_they_have_met_and_everything_after(kind):
    with both_ends(kind, key=KEY) as (bench, far):
        far.send_frame(FRAME)
        bench.send_demand(DEMAND)
        assert bench.receive_frames(0.05) == []
        assert "does not answer" in bench.unheard()
        meet(bench, far)
        for k in range(100):
            bench.send_demand(DEMAND._replace(sequence=k, answers=k))
            (demand,) = far.receive_demands(1.0)
            far.send_frame(FRAME._replace(sequence=k))
            (frame,) = bench.receive_frames(1.0)
            assert demand.answers == k
            assert frame.sequence == k % (1 << bench.sequence_bits)
        assert set(bench.peer.counts.values()) == set(far.peer.counts.values()) == {0}


def test_another_key_never_meets_and_says_so(kind):
    with link_settings(kind) as settings:
        bench = open_link(kind, RIG, EMULATED.parent, settings, key=KEY)
        far = open_link(kind, RIG, EMULATED.parent, settings, rig_end=True, key=KEY[::-1])
        try:
            with pytest.raises(AssertionError, match="has it the same key"):
                meet(bench, far, 3)
        finally:
            bench.close()
            far.close()


def test_repeated_and_overtaken_packets_are_refused(kind):
    with both_ends(kind, key=KEY) as (bench, far):
        meet(bench, far)
        first, second = packed(bench), packed(bench, DEMAND._replace(sequence=10))
        send = raw(bench, kind)
        send(second)
        assert len(far.receive_demands(1.0)) == 1
        for old in (second, first, first):
            send(old)
            assert far.receive_demands(0.05) == []
        assert (far.peer.counts["replayed"], far.peer.counts["reordered"]) == (1, 2)
        assert far.bad == 3


def test_a_packet_of_an_earlier_session_is_stale(kind):
    with both_ends(kind, key=KEY) as (bench, far):
        meet(bench, far)
        old = packed(bench, DEMAND._replace(order=Order.RUN))
        bench.meet()
        meet(bench, far)
        raw(bench, kind)(old)
        assert far.receive_demands(0.05) == []
        assert far.peer.counts["stale"] == 1


def test_after_hold_no_order_counts_in_the_same_session(kind):
    with both_ends(kind, key=KEY) as (bench, far):
        meet(bench, far)
        for order, comes in ((Order.RUN, 1), (Order.HOLD, 1), (Order.ARM, 0), (Order.RUN, 0)):
            bench.send_demand(DEMAND._replace(sequence=DEMAND.sequence + order, order=order))
            assert len(far.receive_demands(0.1)) == comes, order
        assert far.peer.counts["after_hold"] == 2
        bench.meet()
        meet(bench, far)
        bench.send_demand(DEMAND._replace(order=Order.RUN))
        assert len(far.receive_demands(1.0)) == 1


def test_the_order_to_hold_goes_out_during_a_meeting_too(kind):
    with both_ends(kind, key=KEY) as (bench, far):
        meet(bench, far)
        bench.meet()
        bench.send_demand(DEMAND._replace(order=Order.HOLD))
        (demand,) = far.receive_demands(1.0)
        assert demand.order is Order.HOLD


def test_a_stranger_s_packets_and_those_without_a_tag_are_foreign(kind):
    with both_ends(kind, key=KEY) as (bench, far), both_ends(kind) as (plain, _):
        meet(bench, far)
        bare = packed(plain)
        raw(bench, kind)(bare)
        assert far.receive_demands(0.05) == []
        if kind == "udp":
            assert far.peer.counts["foreign"] == 1
            assert "does not fit the key" in far.problem
        bench.send_demand(DEMAND._replace(sequence=DEMAND.sequence + 1))
        assert len(far.receive_demands(1.0)) == 1


def keyed_loop(kind, run):
    with both_ends(kind, key=KEY) as (bench, far):
        meet(bench, far)
        run(Loop(bench, far, emulated_rig(), wait_s=WAIT_S))


def test_the_closed_loop_runs_holds_and_comes_back_by_a_new_meeting(kind):
    def run(loop):
        loop.started(HOLD)
        before = loop.rig_end.peer.current
        for _ in range(6):
            loop.tick(HOLD, way=lambda frame: [])
        assert loop.state is State.SAFE
        loop.tick(HOLD)
        assert before.held
        loop.tick(HOLD, reset=True)
        loop.started(HOLD, 200)
        assert loop.rig_end.peer.current is not before
        assert loop.rig.watchdog.latched is False
        assert loop.bridge.report()["foreign_packets"] == 0

    keyed_loop(kind, run)


def test_guesses_beyond_the_budget_make_both_ends_safe_on_can(kind):
    """A guesser with the right identifiers; UDP's tags are long enough not to count."""

    def run(loop):
        loop.started(HOLD)
        send = raw(loop.rig_end, kind)
        for guess in range(40):
            good = loop.rig_end.codec.pack_frame(FRAME._replace(sequence=loop.rig.tick + 8))
            send(spoilt(good, kind, guess))
            loop.tick(HOLD)
            if loop.state is State.SAFE:
                break
        if kind == "udp":
            assert loop.state is State.RUNNING
            assert loop.bench_end.peer.counts["foreign"] == 40
            return
        assert loop.state is State.SAFE
        assert loop.bridge.guard.fault.kind is Kind.LINK
        assert "does not fit the key" in str(loop.bridge.guard.fault)
        assert guess == 16

    keyed_loop(kind, run)


def spoilt(good, kind, guess):
    """Return a packet with a tag that was guessed."""
    if kind == "udp":
        return good[:-1] + bytes([good[-1] ^ (guess + 1)])
    data = bytearray(good[-1].data)
    data[3] ^= guess + 1
    return [*good[:-1], good[-1]._replace(data=bytes(data))]
