"""Signals of every kind against a decoder of bits written here, and what says "no value"."""

import math
from typing import Any

import cantools
import pytest
from can_rigs import count_in
from hypothesis import given, settings
from hypothesis import strategies as st
from rig_links import RIG

from rig_bridge.channels import CanPlace
from rig_bridge.conversion import raw_of
from rig_bridge.transport.can_fields import CanField
from rig_bridge.transport.can_layout import Bus, Layout
from steering_core.errors import BenchError

ROW = RIG.channels["rack_force"].model_copy(
    update={"can": CanPlace(message="M", signal="S"), "scale": 1.0, "offset": 0.0}
)


def field(signal, more="", row=ROW, length=8):
    text = f'VERSION ""\n\nBU_: A\n\nBO_ 1 M: {length} A\n SG_ S : {signal} "" A\n\n{more}'
    database: Any = cantools.database.load_string(text, "dbc")
    layout = Layout([Bus("can0", database, fd=True)])
    return CanField("rack_force", row, layout), database.get_message_by_name("M")


def packed(there, message, raw):
    return message.encode({"S": there.encoded(raw)}, scaling=False, strict=False)


def taken(there, message, data):
    return there.decoded(message.decode(data, decode_choices=False, scaling=False)["S"])


@settings(max_examples=60, deadline=None)
@given(
    st.integers(2, 50),
    st.integers(0, 60),
    st.booleans(),
    st.sampled_from("+-"),
    st.sampled_from(["1", "-1", "0.5", "0.01", "-0.125", "1e-3", "1000"]),
    st.sampled_from(["0", "-40", "1000.5"]),
    st.floats(0.0, 1.0),
)
def test_every_place_sign_and_scale(width, shift, motorola, sign, scale, offset, share):
    """The count found bit by bit is the one that the scale gives, and comes back as sent."""
    start = 7 + 8 * (shift // 8) if motorola else shift % (65 - width)
    width = min(width, 64 - 8 * (shift // 8)) if motorola else width
    low, high = (
        (0, 2**width - 2) if sign == "+" else (-(2 ** (width - 1)) + 1, 2 ** (width - 1) - 1)
    )
    count = low + round(share * (high - low))
    ends = sorted((float(scale) * c + float(offset)) for c in (low, high))
    row = ROW.model_copy(update={"range": (ends[0], ends[1])}) if ends[0] < ends[1] else ROW
    order = 0 if motorola else 1
    there, message = field(f"{start}|{width}@{order}{sign} ({scale},{offset}) [0|0]", row=row)
    raw = float(scale) * count + float(offset)
    data = packed(there, message, raw)
    found = count_in(data, start, width, motorola, sign)
    assert found == pytest.approx(count, abs=max(1.0, abs(count) * 1e-12))
    assert taken(there, message, data) == pytest.approx(raw, rel=1e-9, abs=abs(float(scale)))
    nothing = packed(there, message, math.nan)
    assert math.isnan(taken(there, message, nothing))
    for beyond in (1e30, -1e30):
        assert not math.isnan(taken(there, message, packed(there, message, beyond)))


@pytest.mark.parametrize(("width", "kind"), [(32, 1), (64, 2)])
@pytest.mark.parametrize("motorola", [False, True])
def test_floats(width, kind, motorola):
    start, order = (7, 0) if motorola else (0, 1)
    there, message = field(f"{start}|{width}@{order}- (1,0) [0|0]", f"SIG_VALTYPE_ 1 S : {kind};\n")
    data = packed(there, message, -1234.0625)
    assert count_in(data, start, width, motorola, "f") == -1234.0625
    assert taken(there, message, data) == -1234.0625
    assert math.isnan(taken(there, message, packed(there, message, math.nan)))
    assert math.isfinite(taken(there, message, packed(there, message, 1e300)))


SIGNAL = "0|16@1+ (1,-30000) [-30000|30000]"


def test_numbers_with_a_name_beyond_the_range_are_no_value():
    """SNA, Error and their like: 65535 would be 35535 N. 7 has a name, and is a value."""
    table = 'VAL_ 1 S 65535 "SNA" 65534 "Error" 60500 "Sonderfall" 30007 "Seven" ;\n'
    there, message = field(SIGNAL, table)
    for count in (65535, 65534, 60500):
        assert math.isnan(taken(there, message, count.to_bytes(2, "little") + bytes(6)))
    assert taken(there, message, (30007).to_bytes(2, "little") + bytes(6)) == 7.0
    assert taken(there, message, (65533).to_bytes(2, "little") + bytes(6)) == 35533.0


@pytest.mark.parametrize("text", ["SNA", "Signal_SNA", "invalid", "Not available", "Fehler", "N/A"])
def test_a_name_that_says_no_value_within_the_range_is_refused(text):
    with pytest.raises(BenchError) as error:
        field(SIGNAL, f'VAL_ 1 S 30000 "{text}" ;\n')
    assert f"its range holds 0, which is '{text}' in the value table of M.S" in str(error.value)


@pytest.mark.parametrize("text", ["Zero", "snack", "Neutral", "Initial_position_reached"])
def test_other_names_within_the_range_are_values(text):
    there, message = field(SIGNAL, f'VAL_ 1 S 30000 "{text}" ;\n')
    assert taken(there, message, (30000).to_bytes(2, "little") + bytes(6)) == 0.0


def test_a_reversed_scale_holds_the_range_the_other_way_round():
    there, message = field("0|16@1+ (-1,30000) [-30000|30000]")
    assert count_in(packed(there, message, raw_of(ROW, 20000.0)), 0, 16, False, "+") == 10000
    with pytest.raises(BenchError, match="cannot hold -20000 N"):
        field("0|15@1+ (-1,20000) [0|0]")
