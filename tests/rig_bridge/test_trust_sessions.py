"""Sessions and meetings without a link: what is taken, refused and counted, whatever comes."""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rig_bridge.transport.packets import Order
from rig_bridge.trust.peer import PATIENCE, BenchPeer, Budget, RefusedError, RigPeer
from rig_bridge.trust.session import WINDOW, Seal, Session, Verdict

KEY, OTHER_KEY = b"k" * 32, b"x" * 32
BODY = b"what is measured"
SIZES = [(64, 64), (16, 44), (8, 24)]
"""Bits of counter and tag: UDP, CAN as shipped, the least."""


def pair(key=KEY, nonces=(b"b" * 16, b"r" * 16)):
    bench_nonce, rig_nonce = nonces
    return (
        Session(key, bench_nonce, rig_nonce, "bench"),
        Session(key, bench_nonce, rig_nonce, "rig"),
    )


def cut(seal, bits):
    counter, tag = bits
    return Seal(seal.counter % (1 << counter), seal.tag % (1 << tag), counter, tag)


@pytest.mark.parametrize("bits", SIZES)
def test_packets_in_order_are_new_over_many_wraps_of_the_counter(bits):
    bench, rig = pair()
    for k in range(2000):
        body = BODY + bytes([k % 251])
        assert rig.judge(body, cut(bench.seal(body), bits)) is Verdict.NEW
    assert rig.last == 1999


@pytest.mark.parametrize("bits", SIZES)
@given(order=st.lists(st.integers(0, 100), min_size=1, max_size=80))
@settings(max_examples=60, deadline=None)
def test_each_packet_is_new_once_and_only_forwards(bits, order):
    """Against the plain rule: new where it is later than all before, else seen or overtaken."""
    bench, rig = pair()
    sent = [cut(bench.seal(BODY), bits) for _ in range(101)]
    last, seen = -1, set()
    for k in order:
        verdict = rig.judge(BODY, sent[k])
        if k > last:
            expected, last = Verdict.NEW, k
            seen.add(k)
        else:
            known = k in seen or last - k >= WINDOW
            expected = Verdict.REPLAYED if known else Verdict.REORDERED
        assert verdict is expected


@pytest.mark.parametrize("bits", SIZES)
def test_another_body_counter_direction_session_or_key_does_not_fit(bits):
    bench, rig = pair()
    seal = cut(bench.seal(BODY), bits)
    assert rig.judge(BODY + b"!", seal) is Verdict.FOREIGN
    assert rig.judge(BODY, seal._replace(counter=seal.counter + 1)) is Verdict.FOREIGN
    assert rig.judge(BODY, seal._replace(tag=seal.tag ^ 1)) is Verdict.FOREIGN
    assert bench.judge(BODY, seal) is Verdict.FOREIGN, "reflected to its sender"
    for strange in (pair(OTHER_KEY), pair(nonces=(b"b" * 16, b"R" * 16))):
        assert strange[1].judge(BODY, seal) is Verdict.FOREIGN
    assert rig.judge(BODY, seal) is Verdict.NEW, "nothing of that has moved the counter"


@given(st.binary(max_size=40), st.integers(0, 2**64 - 1), st.integers(0, 2**64 - 1))
@settings(max_examples=200, deadline=None)
def test_nothing_that_is_made_up_fits(body, counter, tag):
    _, rig = pair()
    assert rig.judge(body, Seal(counter, tag)) is Verdict.FOREIGN


class Wire:
    """A bench and a rig that have met, as often as ``meet`` is called."""

    def __init__(self, budget=None):
        self.bench = BenchPeer(KEY, 16, budget and Budget(*budget))
        self.rig = RigPeer(KEY, 16, budget and Budget(*budget))

    def meet(self):
        self.bench.meet()
        self.bench.hear(self.rig.hear(self.bench.greeting() or b""))
        assert self.bench.greeting() is None
        self.down()
        self.up()
        assert self.bench.unmet() is None
        return self

    def down(self, body=BODY):
        seal = self.bench.seal(body)
        self.rig.admit(body, seal)
        return seal

    def up(self, body=BODY):
        seal = self.rig.seal(body)
        self.bench.admit(body, seal)
        return seal


def refused(peer, body, seal):
    before = dict(peer.counts)
    with pytest.raises(RefusedError):
        peer.admit(body, seal)
    return next(why for why, count in peer.counts.items() if count > before[why])


def test_what_is_refused_is_counted_by_its_reason():
    wire = Wire().meet()
    old = wire.down()
    late, first = wire.bench.seal(BODY), wire.bench.seal(BODY)
    wire.rig.admit(BODY, first)
    assert refused(wire.rig, BODY, late) == "reordered"
    assert refused(wire.rig, BODY, first) == "replayed"
    assert refused(wire.rig, BODY, Seal(7, 7)) == "foreign"
    wire.meet()
    assert refused(wire.rig, BODY, old) == "stale"
    wire.meet()
    assert refused(wire.rig, BODY, old) == "foreign", "two sessions ago nothing is known of it"


def test_a_question_of_a_stranger_ends_no_session():
    wire = Wire().meet()
    for _ in range(100):
        wire.rig.hear(b"stranger's bytes")
        wire.down()
        wire.up()


def test_an_answer_of_a_stranger_only_delays_a_meeting():
    wire = Wire()
    question = wire.bench.greeting()
    wire.bench.hear(b"a forged answer!")
    answer = wire.rig.hear(question or b"")
    wire.bench.hear(answer)
    for _ in range(PATIENCE):
        assert wire.bench.greeting() is None
        assert refused(wire.rig, BODY, wire.bench.seal(BODY)) == "foreign"
    assert wire.bench.greeting() not in (None, question), "a fresh number, as nothing fitted"
    assert "same key" in str(wire.bench.unmet())
    wire.meet()


def test_after_hold_nothing_counts_but_hold_until_a_new_meeting():
    wire = Wire().meet()
    assert wire.rig.obeys(Order.RUN)
    assert wire.rig.obeys(Order.HOLD)
    for order in (Order.RUN, Order.ARM):
        wire.down()
        assert not wire.rig.obeys(order)
    assert wire.rig.obeys(Order.HOLD)
    assert wire.rig.counts["after_hold"] == 2
    wire.meet()
    assert wire.rig.obeys(Order.ARM)


def test_a_spent_budget_ends_the_session_at_either_end():
    wire = Wire((3.0, 0.5)).meet()
    for peer in (wire.bench, wire.rig):
        for _ in range(3):
            refused(peer, BODY, Seal(1, 2, 16, 44))
        assert not peer.spent
        refused(peer, BODY, Seal(1, 2, 16, 44))
        assert peer.spent
        assert peer.sending is None
    assert wire.bench.greeting() is not None
    wire.meet()
    assert not wire.bench.spent
    assert not wire.rig.spent


def test_packets_in_order_let_failures_be_forgotten():
    wire = Wire((3.0, 0.5)).meet()
    for _ in range(50):
        refused(wire.rig, BODY, Seal(1, 2, 16, 44))
        wire.down()
        wire.down()
    assert not wire.rig.spent


def test_meetings_have_numbers_of_their_own():
    asked = {BenchPeer(KEY, 16).greeting() for _ in range(100)}
    answered = {RigPeer(KEY, 16).hear(b"n" * 16) for _ in range(100)}
    assert len(asked) == len(answered) == 100
