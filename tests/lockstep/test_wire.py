"""The byte layout against rosbags' serialiser, which shares no code with it."""

import struct
import timeit

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

from steering_lockstep.msg_text import MessageError, definition, leaves
from steering_lockstep.topics import TABLE, TopicError, topic, wire
from steering_lockstep.wire import Wire

FIXED = [name for name, entry in TABLE.items() if entry.lockstep] + ["/torque_overlay/lane_keeper"]
OURS = sorted({topic(n).type_name for n in FIXED if topic(n).type_name.startswith("steering")})

finite = st.floats(allow_nan=False, allow_infinity=False)


@pytest.fixture(scope="module")
def store():
    store = get_typestore(Stores.ROS2_JAZZY)
    for name in OURS:
        full = name.replace("/", "/msg/")
        store.register(get_types_from_msg(definition(name), full))
    return store


def read(message, path):
    """Follow "pose.covariance[3]" into a message object."""
    for part in path.split("."):
        name, _, index = part.partition("[")
        message = getattr(message, name)
        if index:
            message = message[int(index[:-1])]
    return message


def fitting(layout, values):
    """``values`` as the layout's fields can hold them: floats, whole numbers or truths."""
    codes = {s.path: s.code for s in layout.slots}
    kinds = [{"?": bool, "I": lambda v: abs(int(v))}.get(codes[f], float) for f in layout.fields]
    return [kind(value) for kind, value in zip(kinds, values, strict=True)]


@pytest.mark.parametrize("name", FIXED)
def test_rosbags_reads_what_we_pack_and_writes_the_same_bytes(store, name):
    layout, tick = wire(name), 12_345
    values = fitting(layout, [0.5 - 3.0 * i for i in range(len(layout.fields))])
    data = layout.pack(tick, values)
    full = topic(name).type_name.replace("/", "/msg/")
    message = store.deserialize_cdr(data, full)
    stamp = message.clock if name == "/clock" else message.header.stamp
    assert (stamp.sec, stamp.nanosec) == (12, 345_000_000)
    assert [read(message, path) for path in layout.fields] == values
    for path, text in topic(name).strings.items():
        assert read(message, path) == text
    if layout.has_tick:
        assert message.tick == tick
    assert bytes(store.serialize_cdr(message, full)) == data


@pytest.mark.parametrize("name", FIXED)
def test_unpack_is_the_inverse_of_pack(name):
    layout = wire(name)
    values = fitting(layout, [1e-3 * i for i in range(len(layout.fields))])
    assert layout.unpack(layout.pack(77, values)) == (77, *values)


@given(tick=st.integers(0, 2**31 * 1000 - 1), values=st.tuples(finite, finite, finite))
def test_every_number_survives(tick, values):
    layout = wire("/steering/torque")
    assert layout.unpack(layout.pack(tick, values)) == (tick, *values)


@pytest.mark.parametrize("name", FIXED)
def test_array_of_messages_is_the_messages_one_after_the_other(name):
    layout = wire(name)
    ticks = np.arange(995, 1005)
    columns = np.random.default_rng(1).normal(size=(10, len(layout.fields)))
    columns = np.array([fitting(layout, row) for row in columns], np.float64)
    one_by_one = b"".join(
        layout.pack(int(tick), row) for tick, row in zip(ticks, columns.tolist(), strict=True)
    )
    assert layout.from_columns(ticks, columns).tobytes() == one_by_one
    view = layout.view(one_by_one)
    assert np.array_equal(view["sec"] * 1000 + view["nanosec"] // 1_000_000, ticks)
    for index, field in enumerate(layout.fields):
        assert np.array_equal(view[field], columns[:, index])


@pytest.mark.parametrize("wrong", [b"", b"\0" * 67, b"\0" * 69])
def test_wrong_size_is_refused(wrong):
    with pytest.raises(struct.error):
        wire("/steering/torque").unpack(wrong)


def test_padding_is_zero():
    data = np.frombuffer(wire("/steering/torque").pack(0, (0.0, 0.0, 0.0)), np.uint8)
    used = np.zeros(len(data), bool)
    used[:4] = True
    for slot in wire("/steering/torque").slots:
        used[slot.offset : slot.offset + slot.size] = True
    assert not used.all()
    assert not data[~used].any()


def test_pack_and_unpack_take_about_a_microsecond():
    layout, values = wire("/steering/torque"), (1.0, 2.0, 3.0)
    data = layout.pack(1, values)
    # Ten times what it takes on an idle machine.
    assert min(timeit.repeat(lambda: layout.pack(1, values), number=1000, repeat=5)) < 5e-3
    assert min(timeit.repeat(lambda: layout.unpack(data), number=1000, repeat=5)) < 3e-3


def test_sequences_have_no_fixed_layout():
    with pytest.raises(MessageError, match="status"):
        list(leaves("diagnostic_msgs/DiagnosticArray"))


def test_unknown_message_is_named():
    with pytest.raises(MessageError, match="steering_msgs/NoSuch"):
        Wire("steering_msgs/NoSuch")


def test_unknown_topic_suggests_the_nearest():
    with pytest.raises(TopicError, match="/steering/torque"):
        topic("/steering/torqe")


def test_each_source_of_an_overlay_has_a_topic_that_carries_its_name():
    assert topic("/torque_overlay/lane_keeper").strings["source"] == "lane_keeper"
    assert topic("/torque_overlay/applied").type_name == "steering_msgs/TorqueOverlayApplied"
    assert "/torque_overlay/side_wind_2" in TABLE


@pytest.mark.parametrize("name", ["/torque_overlay", "/torque_overlay/", "/torque_overlay/Lane"])
def test_a_source_needs_a_plain_name(name):
    assert name not in TABLE
    with pytest.raises(TopicError):
        topic(name)
