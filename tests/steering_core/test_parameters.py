"""The data sheet: checks, changes, files and records."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from steering_core.parameters import Info, ParameterError, load_parameters, shipped_sets

PARAMETERS = load_parameters()


def test_every_line_says_what_it_is():
    for name in PARAMETERS:
        info = PARAMETERS.info(name)
        assert info.unit
        assert info.source
        assert 0.0 <= info.tolerance < 1.0
        assert PARAMETERS[name] == info.value == info.checked(name, info.value)


def test_changes_make_a_new_set_and_leave_the_old_one():
    changed = PARAMETERS.with_values({"mechanics.rack_mass": "30"})
    assert (PARAMETERS["mechanics.rack_mass"], changed["mechanics.rack_mass"]) == (24.0, 30.0)
    assert changed.changed() == {"mechanics.rack_mass": 30.0}
    assert PARAMETERS.changed() == {}


@pytest.mark.parametrize(
    ("name", "value", "text"),
    [
        ("mechanics.rack_mass", -1.0, "mechanics.rack_mass must be greater than 0 kg, got -1"),
        ("open_centre.chamber_volume", 0.0, "chamber_volume must be greater than 0 m3, got 0"),
        ("oil.density", math.nan, "oil.density must be finite, got nan"),
        ("oil.density", math.inf, "oil.density must be finite, got inf"),
        ("oil.density", "thick", "oil.density: 'thick' is not a number"),
        ("oil.density", None, "oil.density: 'None' is not a number"),
        ("mechanics.column_friction", -0.1, "must be at least 0 N m, got -0.1"),
        ("mechanics.rack_mas", 1.0, "did you mean 'mechanics.rack_mass'"),
        ("rack_mass", 1.0, "did you mean 'mechanics.rack_mass'"),
    ],
)
def test_what_cannot_be_is_refused_by_name(name, value, text):
    with pytest.raises(ParameterError) as error:
        PARAMETERS.with_values({name: value})
    assert text in str(error.value)


@given(st.sampled_from(sorted(PARAMETERS)), st.floats(allow_nan=True, allow_infinity=True))
def test_a_value_is_taken_exactly_or_refused(name, value):
    info = PARAMETERS.info(name)
    least = 0.0 if info.minimum is None else info.minimum
    allowed = math.isfinite(value) and (
        value > least or (value == least and info.minimum is not None)
    )
    if allowed:
        assert PARAMETERS.with_values({name: value})[name] == value
    else:
        with pytest.raises(ParameterError):
            PARAMETERS.with_values({name: value})


def test_groups_and_records_keep_the_order():
    group = PARAMETERS.group("driver")
    assert list(group) == ["gain", "lead", "lag", "maximum_torque"]
    record = PARAMETERS.record("driver", "oil")
    assert record.shape == (1,)
    names = record.dtype.names or ()
    assert names[:4] == tuple(group)
    assert record[0]["density"] == PARAMETERS["oil.density"]
    assert all(record.dtype[name] == np.float64 for name in names)


def test_a_record_refuses_one_name_twice():
    with pytest.raises(ParameterError, match="more than one of the groups"):
        PARAMETERS.record("pressure_control_valve", "driver", "valve_controller", "servo_valve")


def test_an_unknown_group_names_the_nearest():
    with pytest.raises(ParameterError, match="did you mean 'mechanics'"):
        PARAMETERS.group("mechanic")


@pytest.mark.parametrize(
    "text",
    [
        "mechanics: {rack_mass: 30}",
        "mechanics.rack_mass: 30",
        "mechanics: {rack_mass: {value: 30, tolerance: 0.1}}",
    ],
)
def test_a_file_replaces_values(tmp_path, text):
    path = tmp_path / "heavy.yaml"
    path.write_text(text, encoding="utf-8")
    assert load_parameters(path).changed() == {"mechanics.rack_mass": 30.0}


@pytest.mark.parametrize(
    "text", ["mechanics: {rack_mass: -3}", "[1, 2]", "mechanics: [", "no.such: 1", ""]
)
def test_a_bad_file_is_named(tmp_path, text):
    path = tmp_path / "bad.yaml"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(ParameterError, match=r"bad\.yaml"):
        load_parameters(path)


def test_a_missing_file_and_an_unknown_set(tmp_path):
    with pytest.raises(ParameterError, match="cannot read the parameter set"):
        load_parameters(tmp_path / "none.yaml")
    assert "nominal" in shipped_sets()
    with pytest.raises(ParameterError, match="did you mean 'nominal'"):
        load_parameters("nominl")


def test_the_smallest_value_itself_is_allowed():
    assert Info(1.0, "m", "test", minimum=-2.0).checked("x", -2.0) == -2.0
    with pytest.raises(ParameterError, match="greater than 0"):
        Info(1.0, "m", "test").checked("x", 0.0)


def test_a_file_brings_tolerance_and_source_of_its_values(tmp_path):
    path = tmp_path / "mine.yaml"
    path.write_text(
        "mechanics:\n  rack_mass: {value: 25.0, tolerance: 0.02, source: weighed}\n"
        "  rack_friction: 70.0\n"
    )
    mine = load_parameters(path)
    info = mine.info("mechanics.rack_mass")
    assert mine["mechanics.rack_mass"] == 25.0
    assert (info.tolerance, info.source) == (0.02, "weighed")
    assert mine.info("mechanics.rack_friction") == load_parameters().info("mechanics.rack_friction")


@pytest.mark.parametrize("tolerance", ["1.5", "-0.1", "wide", "true"])
def test_a_tolerance_that_cannot_be_is_named(tmp_path, tolerance):
    path = tmp_path / "mine.yaml"
    path.write_text(f"mechanics:\n  rack_mass: {{value: 25.0, tolerance: {tolerance}}}\n")
    with pytest.raises(ParameterError, match=r"mine\.yaml: mechanics\.rack_mass.*tolerance"):
        load_parameters(path)
