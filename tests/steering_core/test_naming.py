"""Errors that suggest the nearest right name."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from steering_core.naming import nearest, unknown
from steering_core.parameters import load_parameters

NAMES = sorted(load_parameters())


@pytest.mark.parametrize(
    ("wrong", "right"),
    [
        ("mechanics.rack_mas", "mechanics.rack_mass"),
        ("rack_mass", "mechanics.rack_mass"),
        ("Mechanics.Rack_Mass", "mechanics.rack_mass"),
        ("mechanics.mass_rack", "mechanics.rack_mass"),
        ("oil.dencity", "oil.density"),
    ],
)
def test_the_nearest_name(wrong, right):
    assert nearest(wrong, NAMES) == f"; did you mean '{right}'?"


def test_nothing_near_means_no_hint():
    assert nearest("xyzzy", NAMES) == ""
    assert unknown("thing", "xyzzy", ["b", "a"]) == "unknown thing 'xyzzy'; known: a, b"
    assert unknown("thing", "xyzzy", NAMES) == "unknown thing 'xyzzy'"


@given(st.sampled_from(NAMES), st.data())
def test_one_letter_left_out_is_found(name, data):
    at = data.draw(st.integers(0, len(name) - 1))
    assert "did you mean" in nearest(name[:at] + name[at + 1 :], NAMES)


@given(st.text(max_size=20))
def test_any_text_gives_a_text(name):
    assert unknown("parameter", name, NAMES).startswith(f"unknown parameter '{name}'")
