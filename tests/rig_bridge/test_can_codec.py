"""CAN frames against cantools' own reading of the DBC file, and wrong DBC files."""

import itertools
import math
import random
from typing import Any

import cantools
import pytest
from healthy_rig import EMULATED
from rig_links import DEMAND, FRAME, MEASURED, RIG

from rig_bridge.transport.assembly import Unwrapped
from rig_bridge.transport.can_codec import CanCodec
from rig_bridge.transport.can_layout import Bus
from rig_bridge.transport.dbc import load_dbc
from rig_bridge.transport.packets import PacketError
from steering_core.errors import BenchError

DBC = EMULATED.with_suffix(".dbc")
TEXT = DBC.read_text()


def codec(text=TEXT, rig=RIG):
    database: Any = cantools.database.load_string(text, "dbc")
    return CanCodec(rig, [Bus("can0", database)])


def by_number(frames):
    return {frame.number: frame.data for frame in frames}


def taken(there, frames):
    return [packet for frame in frames if (packet := there.take_frame(*frame)) is not None]


def test_counts_on_the_bus_by_hand():
    """Angle 0.1 rad is 12500 counts of 8 urad in the lowest 20 bits of message 256."""
    frames = by_number(codec().pack_frame(FRAME))
    word = int.from_bytes(frames[256], "little")
    assert word & 0xFFFFF == 12500
    assert (word >> 20) & 0xFFFFF == (-10000) % 2**20
    assert word >> 60 == FRAME.sequence
    assert int.from_bytes(frames[259], "little") & 0xFFFFFFFF == 12_345_678


def test_cantools_reads_the_same():
    database: Any = load_dbc(DBC)
    frames = by_number(codec().pack_demand(DEMAND))
    assert database.decode_message("Load", frames[515])["Stiffness"] == 5e4 / 40.0
    assert database.decode_message("LeftValve", frames[513])["LeftForce"] == 40000


def test_scale_and_offset_of_the_dbc_file_come_before_the_table_s():
    """The sensor's frame holds tenths of a degree from -400; the table goes from degrees to rad."""
    old = 'SG_ Angle : 0|20@1- (1,0) [-524287|524287] "counts"'
    new = 'SG_ Angle : 0|20@1+ (0.1,-400) [-400|400] "deg"'
    channels = dict(RIG.channels)
    row = channels["steering_wheel_angle"]
    channels["steering_wheel_angle"] = row.model_copy(update={"scale": math.pi / 180.0})
    there = codec(TEXT.replace(old, new), RIG.model_copy(update={"channels": channels}))
    frames = there.pack_frame(FRAME._replace(values=(math.radians(-31.4), *MEASURED[1:])))
    assert int.from_bytes(by_number(frames)[256], "little") & 0xFFFFF == 3686
    assert taken(there, frames)[0].values[0] == pytest.approx(math.radians(-31.4))


def test_the_frames_of_a_packet_may_come_in_any_order():
    frames = codec().pack_frame(FRAME)
    for order in itertools.permutations(frames):
        assert len(taken(codec(), order)) == 1


def test_a_packet_that_lacks_a_frame_is_dropped_and_never_mixed_with_a_later_one():
    there = codec()
    random.seed(1)
    received = []
    sent = {}
    for k in range(400):
        values = tuple(value * (1.0 - 1e-3 * k) for value in MEASURED)
        frames = there.pack_frame(FRAME._replace(sequence=k, rig_ns=k * 10**6, values=values))
        sent[k * 10**6] = taken(codec(), frames)[0].values
        if random.random() < 0.3:
            frames.pop(random.randrange(len(frames)))
        received += taken(there, frames)
    assert 200 < len(received) < 400
    for frame in received:
        assert frame.values == sent[frame.rig_ns]


def test_a_repeated_packet_comes_twice_so_that_the_guard_can_count_it():
    there = codec()
    frames = there.pack_frame(FRAME)
    assert len(taken(there, frames + frames)) == 2


def test_a_short_frame_is_refused():
    with pytest.raises(PacketError, match="Wheel of 3 bytes"):
        codec().take_frame(256, b"abc")


def test_foreign_frames_are_passed_over():
    assert codec().take_frame(0x7A1, b"12345678") is None


def test_another_dbc_file_at_the_other_end_is_noticed():
    moved = TEXT.replace("BO_ 258 Rack", "BO_ 261 Rack").replace("BO_ 256 Wheel", "BO_ 258 Wheel")
    moved = moved.replace("BO_ 261 Rack", "BO_ 256 Rack")
    with pytest.raises(PacketError, match="another channel table or DBC"):
        taken(codec(), codec(moved).pack_frame(FRAME))


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("BO_ 256 Wheel", "BO_ 256 Wheal", "did you mean 'Wheal'"),
        ("SG_ Angle", "SG_ Angel", "did you mean 'Angel'"),
        ("SG_ Clock", "SG_ Time", "signal of RigStatus 'Clock'"),
        ("BO_ 516 BenchStatus", "BO_ 516 Other", "message 'BenchStatus'"),
        ("SG_ Angle : 0|20@1-", "SG_ Angle : 0|12@1-", "cannot hold -4 rad"),
        ("SG_ Torque : 40|20@1-", "SG_ Torque : 40|20@1+", "cannot hold -20 N m"),
    ],
)
def test_a_dbc_file_that_does_not_fit_is_refused_with_the_reason(old, new, said):
    with pytest.raises(BenchError) as error:
        codec(TEXT.replace(old, new))
    assert said in str(error.value)


def test_no_dbc_file_and_a_broken_one(tmp_path):
    with pytest.raises(BenchError, match="there is no DBC file"):
        load_dbc(tmp_path / "none.dbc")
    (tmp_path / "broken.dbc").write_text("BO_ what\n")
    with pytest.raises(BenchError, match=r"broken\.dbc"):
        load_dbc(tmp_path / "broken.dbc")


def test_the_clock_does_not_wrap():
    """32 bits of microseconds are 71 minutes."""
    clock = Unwrapped(32)
    times = [0, 10**6, 2**32 - 5, 2**32 + 3, 2**32 + 10**9, 2**33 + 7]
    assert [clock.follow(t % 2**32) for t in (0, 10**6)] == times[:2]
    late = Unwrapped(32)
    late.follow(2**32 - 5)
    assert [late.follow(t % 2**32) for t in times[3:4]] == times[3:4]
    assert late.follow((2**32 + 1) % 2**32) == 2**32 + 1, "a late frame goes back"
