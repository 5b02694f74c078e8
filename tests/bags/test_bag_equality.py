"""The first difference of two traces is found, and named."""

import numpy as np
import pytest

from steering_bringup.bags import BagWriter, Difference, Trace, first_difference, read_bag


@pytest.fixture
def bag(tmp_path, topics, random_ticks):
    def make(name, change=None, count=100):
        return _bag(tmp_path / name, topics, random_ticks(100), change, count)

    return make


def _bag(path, topics, ticks, change, count):
    stamps, payloads = ticks
    if change:
        topic, tick, byte = change
        payloads[topic][tick, byte] ^= 1
    with BagWriter(path, topics) as writer:
        writer.write_block(stamps[:count], {t: p[:count] for t, p in payloads.items()})
    return read_bag(path)


def _difference(a: Trace, b: Trace) -> Difference:
    found = first_difference(a, b)
    assert found is not None
    return found


def test_equal_traces_have_no_difference(bag):
    assert first_difference(bag("a"), bag("b")) is None


@pytest.mark.parametrize("tick", [0, 57, 99])
def test_the_last_bit_of_one_number_is_seen(bag, tick):
    # Byte -8 is the least significant of the last float64, reference_angle.
    changed = bag("b", ("/driver/torque", tick, -8))
    found = _difference(bag("a"), changed)
    assert (found.topic, found.tick, found.field) == ("/driver/torque", tick, "reference_angle")
    assert found.left != found.right


def test_the_frame_id_counts(bag):
    found = _difference(bag("a"), bag("b", ("/driver/torque", 3, 16)))
    assert found.tick == 3
    assert "outside" in found.field


def test_a_shorter_and_a_missing_topic_are_differences(bag):
    a, b = bag("a"), bag("b", count=90)
    assert (_difference(a, b).tick, _difference(a, b).field) == (90, "count")
    del b.topics["/driver/torque"]
    assert "missing" in str(first_difference(a, b))
    assert first_difference(a, bag("c"), topics=["/steering/rack"]) is None


def test_the_earliest_of_several_differences_is_reported(bag):
    a = bag("a")
    b = bag("b", ("/driver/torque", 50, -1))
    b.payloads["/steering/rack"] = b.payloads["/steering/rack"].copy()
    b.payloads["/steering/rack"][20, -1] ^= 1
    assert _difference(a, b).topic == "/steering/rack"


def test_nan_equals_itself_by_its_bits(bag):
    a, b = bag("a"), bag("b")
    for trace in (a, b):
        trace.payloads["/steering/rack"] = trace.payloads["/steering/rack"].copy()
        trace.payloads["/steering/rack"][4, -8:] = np.frombuffer(np.float64(np.nan).tobytes(), "u1")
    assert first_difference(a, b) is None
