"""Raw to SI and back, by hand and by properties."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rig_bridge.channels import Channel
from rig_bridge.conversion import raw_of, si_of
from rig_bridge.raw_types import RAW_TYPES, decoded, encoded


def channel(scale=1.0, offset=0.0, sign=1):
    return Channel.model_validate(
        {
            "direction": "measured",
            "unit": "N",
            "scale": scale,
            "offset": offset,
            "sign": sign,
            "range": (-1e9, 1e9),
            "rate": 1.0,
        }
    )


def test_by_hand():
    """A 12 bit pressure sensor of 0 to 250 bar at 0.5 to 4.5 V, mounted the other way round."""
    sensor = channel(scale=250e5 / 3276.0, offset=-250e5 * 409.5 / 3276.0, sign=-1)
    assert si_of(sensor, 409.5) == pytest.approx(0.0, abs=1e-6)
    assert si_of(sensor, 3685.5) == pytest.approx(-250e5)
    assert raw_of(sensor, -125e5) == pytest.approx(2047.5)


SCALES = st.floats(1e-6, 1e6)
OFFSETS = st.floats(-1e6, 1e6)


@given(SCALES, OFFSETS, st.sampled_from([-1, 1]), st.floats(-1e6, 1e6))
def test_there_and_back(scale, offset, sign, value):
    entry = channel(scale, offset, sign)
    back = si_of(entry, raw_of(entry, value))
    assert back == pytest.approx(value, rel=1e-9, abs=1e-9 * (abs(offset) + 1.0))


@given(SCALES, st.floats(-1e6, 1e6))
def test_sign_mirrors(scale, raw):
    assert si_of(channel(scale, sign=-1), raw) == -si_of(channel(scale), raw)


@given(st.sampled_from(sorted(RAW_TYPES)), st.floats(allow_nan=True, allow_infinity=True))
def test_a_raw_number_survives_its_frame(name, number):
    kind = RAW_TYPES[name]
    there = decoded(kind, encoded(kind, number))
    low, high = kind.limits
    if math.isnan(number):
        assert math.isnan(there)
    elif kind.whole:
        assert there == min(max(low, number), high) or abs(there - number) <= 0.5
    else:
        assert there == min(max(low, number), high)
