"""Inputs of a clock that waits for nobody: what is used, how old it is, who owes it."""

import pytest

from steering_lockstep.barrier import Input
from steering_lockstep.errors import LockstepError
from steering_lockstep.held import Held
from steering_lockstep.topics import wire

TORQUE, FORCE = wire("/driver/torque"), wire("/vehicle/rack_force")


class Clock:
    """Two inputs; ``give`` brings their next message, whose first number tells its tick."""

    def __init__(self, **more):
        inputs = [
            Input("/driver/torque", TORQUE, rest=(-1.0, 0.0), **more),
            Input("/vehicle/rack_force", FORCE, rest=(-1.0, 0.0, 0.0)),
        ]
        self.held = Held("rig", inputs)
        self.completed = []
        self.receive = [self.held.receiver(i, self.complete) for i in range(2)]
        self.given = [0, 0]

    def complete(self):
        self.completed.append(self.held.tick)

    def give(self, index, count=1, value=None):
        for _ in range(count):
            tick = self.given[index]
            numbers = (float(tick) if value is None else value, 0.0, 0.0)
            layout = (TORQUE, FORCE)[index]
            self.receive[index](layout.pack(tick, numbers[: len(layout.fields)]))
            self.given[index] += 1

    def used(self):
        values = self.held.values()
        return values[0], values[2]


def test_a_late_value_is_held_and_its_age_and_topic_are_known():
    clock = Clock()
    assert (clock.held.age(), clock.used()) == (1, (-1.0, -1.0))
    clock.give(0)
    clock.give(1)
    assert clock.completed == [0]
    assert (clock.held.age(), clock.held.oldest()) == (0, None)
    for _ in range(3):
        assert not clock.held.advance()
    clock.give(0, 3)
    assert clock.used() == (3.0, 0.0)
    assert (clock.held.age(), clock.held.oldest()) == (3, "/vehicle/rack_force")
    clock.give(1, 2)
    assert (clock.held.age(), clock.used()) == (1, (3.0, 2.0))
    assert clock.completed == [0], "late values complete nothing"
    clock.give(1)
    assert clock.completed == [0, 3]


def test_a_node_that_is_ahead_waits_its_turn():
    clock = Clock()
    clock.give(0, 3)
    clock.give(1, 3)
    assert clock.used() == (0.0, 0.0)
    assert clock.held.advance()
    assert clock.used() == (1.0, 1.0)


def test_a_delay_that_is_wanted_is_no_age():
    clock = Clock(delay=2)
    clock.give(1)
    assert clock.completed == [0]
    assert (clock.held.age(), clock.used()) == (0, (-1.0, 0.0))
    clock.give(0)
    clock.held.advance()
    clock.held.advance()
    clock.give(1, 2)
    assert (clock.held.age(), clock.used()) == (0, (0.0, 2.0))


def test_no_number_is_passed_on_to_who_uses_it():
    clock = Clock()
    clock.give(0, value=float("nan"))
    assert clock.used()[0] != clock.used()[0]


def test_a_message_out_of_turn_is_an_error():
    clock = Clock()
    clock.given[0] = 1
    with pytest.raises(LockstepError, match="expected tick 0"):
        clock.give(0)
