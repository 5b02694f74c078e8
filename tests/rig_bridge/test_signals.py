"""Each signal has its place in the bench's messages."""

import pytest

from rig_bridge.signals import MEASURED, UNITS
from steering_lockstep.signals import PLACES
from steering_lockstep.topics import wire


@pytest.mark.parametrize("name", UNITS)
def test_a_signal_is_a_field_of_a_message(name):
    topic, field = PLACES[name]
    assert field in wire(topic).fields


def test_what_is_measured_fills_the_plant_s_messages_in_order():
    topics = dict.fromkeys(PLACES[name][0] for name in MEASURED)
    fields = [(topic, field) for topic in topics for field in wire(topic).fields]
    assert [PLACES[name] for name in MEASURED] == fields


def test_no_place_without_a_signal():
    assert set(PLACES) == {*UNITS, "reference_angle"}
