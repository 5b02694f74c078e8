"""Whole numbers in a frame, read and written without cantools, against cantools."""

from typing import Any

import cantools
from hypothesis import given, settings
from hypothesis import strategies as st

from rig_bridge.transport.can_whole import WholeNumbers

DBC = """VERSION ""

BU_: A B

BO_ 1 Little: 8 A
 SG_ Fresh : 0|16@1+ (1,0) [0|0] "" B
 SG_ Tag : 16|44@1+ (1,0) [0|0] "" B
 SG_ Counter : 60|4@1+ (1,0) [0|0] "" B

BO_ 2 Big: 8 A
 SG_ Fresh : 7|16@0+ (1,0) [0|0] "" B
 SG_ Tag : 21|37@0+ (1,0) [0|0] "" B
 SG_ Counter : 59|4@0+ (1,0) [0|0] "" B

BO_ 3 Mixed: 12 A
 SG_ Fresh : 3|9@0+ (1,0) [0|0] "" B
 SG_ Tag : 16|64@1+ (1,0) [0|0] "" B
 SG_ Counter : 83|4@0+ (1,0) [0|0] "" B
"""
DATABASE: Any = cantools.database.load_string(DBC, "dbc")
NAMES = ("Counter", "Fresh", "Tag")
WHOLE = st.integers(0, 2**64 - 1)


@given(st.sampled_from(["Little", "Big", "Mixed"]), WHOLE, WHOLE, WHOLE)
@settings(max_examples=200, deadline=None)
def test_the_same_bits_as_cantools(name, counter, fresh, tag):
    message = DATABASE.get_message_by_name(name)
    sizes = {signal.name: signal.length for signal in message.signals}
    numbers = dict(zip(NAMES, (counter, fresh, tag), strict=True))
    cut = {key: number % (1 << sizes[key]) for key, number in numbers.items()}
    whole = WholeNumbers(message, NAMES, message.length)
    data = whole.encode(numbers)
    assert data == message.encode(cut, scaling=False, strict=False)
    assert whole.decode(data) == cut
