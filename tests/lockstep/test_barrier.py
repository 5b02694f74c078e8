"""The barrier against a plain table of what each tick needs."""

import math
import random

import pytest
from hypothesis import given
from hypothesis import strategies as st

from steering_lockstep.barrier import Barrier, Input
from steering_lockstep.errors import LockstepError
from steering_lockstep.topics import wire

TORQUE, RACK = wire("/steering/torque"), wire("/steering/rack")


class Node:
    """A barrier with receivers that notes the values of each tick."""

    def __init__(self, inputs, period=1):
        self.barrier = Barrier("node", inputs, period)
        self.ticks = []
        self.receive = [self.barrier.receiver(i, self.complete) for i in range(len(inputs))]
        if not self.barrier.missing:
            self.complete()

    def complete(self):
        while True:
            self.ticks.append((self.barrier.tick, tuple(self.barrier.values())))
            if not self.barrier.inputs or not self.barrier.advance():
                return


def message(source, tick):
    return (float(source), float(tick), 0.5)


def pair(**more):
    return [Input("/steering/torque", TORQUE), Input("/steering/rack", RACK, **more)]


def test_steps_once_all_inputs_are_there():
    node = Node(pair())
    node.receive[0](TORQUE.pack(0, message(0, 0)))
    assert node.ticks == []
    assert node.barrier.lacking() == ("/steering/rack",)
    node.receive[1](RACK.pack(0, message(1, 0)))
    assert node.ticks == [(0, (*message(0, 0), *message(1, 0)))]
    assert node.barrier.lacking() == ("/steering/torque", "/steering/rack")


def test_early_message_waits_for_its_tick():
    node = Node(pair())
    for tick in range(3):
        node.receive[0](TORQUE.pack(tick, message(0, tick)))
    for tick in range(3):
        node.receive[1](RACK.pack(tick, message(1, tick)))
    assert [tick for tick, _ in node.ticks] == [0, 1, 2]
    assert node.ticks[2][1] == (*message(0, 2), *message(1, 2))


def test_delayed_input_rests_at_first():
    node = Node([*pair()[:1], Input("/steering/rack", RACK, 2, rest=(9.0, 8.0, 7.0))])
    for tick in range(2):
        node.receive[0](TORQUE.pack(tick, message(0, tick)))
    assert [values[3:] for _, values in node.ticks] == [(9.0, 8.0, 7.0)] * 2


@st.composite
def cases(draw):
    """Inputs with delays and source periods, a node period, and an order of arrival."""
    count = draw(st.integers(1, 3))
    inputs = [(draw(st.integers(0, 4)), draw(st.integers(1, 4))) for _ in range(count)]
    return inputs, draw(st.integers(1, 4)), draw(st.integers(0, 2**32))


@given(cases())
def test_each_tick_gets_what_its_delays_and_periods_say(case):
    inputs, period, seed = case
    node = Node([Input("/steering/torque", TORQUE, d, every) for d, every in inputs], period)
    horizon = 24
    queues = [list(range(0, horizon, every)) for _, every in inputs]
    order = random.Random(seed)
    while any(queues):
        source = order.choice([i for i, queue in enumerate(queues) if queue])
        tick = queues[source].pop(0)
        node.receive[source](TORQUE.pack(tick, message(source, tick)))
    expected = []
    for tick in range(0, horizon, period):
        values = ()
        for source, (delay, every) in enumerate(inputs):
            seen = tick - delay
            last = seen // every * every if seen >= 0 else None
            values += (0.0, 0.0, 0.0) if last is None else message(source, last)
        expected.append((tick, values))
    assert node.ticks[: len(expected)] == expected


def test_a_message_that_comes_again_is_refused():
    node = Node(pair())
    node.receive[0](TORQUE.pack(0, message(0, 0)))
    with pytest.raises(LockstepError, match=r"topic /steering/torque, tick 0.*again") as e:
        node.receive[0](TORQUE.pack(0, message(0, 0)))
    assert e.value.kind == "order"


def test_a_gap_is_noticed():
    node = Node(pair())
    with pytest.raises(LockstepError, match="messages were lost; expected tick 0"):
        node.receive[0](TORQUE.pack(1, message(0, 1)))


@pytest.mark.parametrize("bad", [math.nan, math.inf, -math.inf])
@pytest.mark.parametrize("place", [0, 1, 2])
def test_not_finite_names_the_field(bad, place):
    values = [1.0, 2.0, 3.0]
    values[place] = bad
    node = Node(pair())
    with pytest.raises(LockstepError, match=f"field {TORQUE.fields[place]} is not finite") as e:
        node.receive[0](TORQUE.pack(0, values))
    assert (e.value.kind, e.value.tick, e.value.topic) == ("not_finite", 0, "/steering/torque")


def test_infinities_of_both_signs_do_not_cancel():
    with pytest.raises(LockstepError, match="steering_wheel_angle"):
        Node(pair()).receive[0](TORQUE.pack(0, (math.inf, -math.inf, 0.0)))


def test_wrong_size_names_node_topic_and_size():
    with pytest.raises(LockstepError, match=r"'node', topic /steering/torque.*10 bytes.*68") as e:
        Node(pair()).receive[0](b"0123456789")
    assert e.value.kind == "size"
