"""What rigs get wrong is suspected with evidence and advice, and nothing else is."""

# mypy: allow-untyped-defs

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from rig_mistakes import (
    ANGLE,
    ATMOSPHERE,
    DEGREES,
    FORCE,
    KINDS,
    LEFT,
    POSITION,
    PRESSURES,
    RIGHT,
    SUPPLY,
    TORQUE,
    changed,
    clean_record,
    frozen,
    in_own_units,
    lost,
    rig,
    saturated,
    scaled,
    shifted,
)

from steering_bringup.benchmarking.registry import MISTAKES
from steering_diagnosis.benchmark.doors.logger import rounded
from steering_diagnosis.steering.channel_faults import clipping
from steering_diagnosis.steering.diagnose_record import diagnose_record
from steering_diagnosis.steering.mistakes import factors
from steering_diagnosis.steering.suspicions import suspicions, without

OPEN, CLOSED = 900_005, 900_001
"""Seeds of an open-centre gear stepped to and fro with a car, a closed-centre one on a weave."""

SECONDS = 6.0
UNSEEN = {OPEN: {"absolute"}, CLOSED: set()}
"""Kinds that these records do not show: docs/diagnosis_model.md has the rates."""


@cache
def record(seed=OPEN):
    return clean_record(seed, SECONDS)


def texts(found):
    return [s.text for s in found]


def test_the_records_are_of_both_gears():
    assert record(OPEN).valve_system == "open_centre"
    assert record(CLOSED).valve_system == "closed_centre"


def test_each_kind_has_a_name_in_the_benchmark():
    assert set(KINDS) == set(MISTAKES)


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("seed", [OPEN, CLOSED])
def test_a_mistake_is_suspected_by_its_name(seed, kind):
    first, *_ = KINDS[kind]
    told = texts(suspicions(first.done(record(seed))))
    assert first.found(record(seed)) is (kind not in UNSEEN[seed]), told


@pytest.mark.parametrize("seed", [OPEN, CLOSED])
@pytest.mark.parametrize("digits", [0, 4, 3])
def test_a_good_record_is_not_suspected(seed, digits):
    units = {"rad": 1.0 / DEGREES, "Pa": 1e5, "m": 1e-3}
    plain = rig(record(seed))
    few = {
        name: rounded(values / unit, digits) * unit
        for name, values in plain.channels.items()
        for unit in [
            units.get("Pa" if "pressure" in name else "m" if name == POSITION else "", 1.0)
        ]
    }
    assert suspicions(changed(plain, **few)) == []


@settings(max_examples=20, deadline=None, suppress_health_check=list(HealthCheck))
@given(
    st.sampled_from(["1e-2 bar", "0.1 bar", "1 bar"]),
    st.floats(0.2, 3.0),
    st.floats(0.05, 2.0),
    st.integers(0, 2**32 - 1),
)
def test_few_digits_are_no_clipping(step, rate, noise, seed):
    """A slow supply pressure of few digits holds its extremes longer than a clipped run is."""
    q = float(step.split()[0])
    time = np.arange(6000) * 1e-3
    swing = 5.0 * q * np.sin(2.0 * np.pi * rate * time)
    rough = noise * q * np.random.default_rng(seed).standard_normal(len(time))
    for values in (swing, swing + rough):
        assert not clipping(np.round((60.0 + values) / q) * q).any()


@given(st.integers(0, 2**32 - 1), st.sampled_from([0.0, 1e-4, 1e-3]))
@settings(max_examples=30, deadline=None)
def test_the_noise_of_a_wheel_that_is_held_is_no_jump(seed, step):
    draw = np.random.default_rng(seed)
    still = record()
    noise = {n: 2e-4 * draw.standard_normal(len(still)) for n in (ANGLE, POSITION)}
    noise = {n: np.round(v / step) * step if step else v for n, v in noise.items()}
    held = replace(still, channels={**still.channels, **noise})
    assert not any("jumps" in text for text in texts(suspicions(held)))


def test_where_a_channel_rests_is_no_clipping():
    """A supply of three digits stands at what it is regulated to, and dips when oil is drawn."""
    supply = np.full(6000, 200.0)
    for start in (100, 2500, 4000):
        supply[start : start + 60] = 199.0 - 4.0 * np.sin(np.linspace(0.0, np.pi, 60)).round()
    assert not clipping(supply * 1e5).any()


def test_what_stands_still_to_the_last_sample_is_no_error():
    held = record(CLOSED).channels[TORQUE].copy()
    held[-800:] = held[-800]
    stopped = replace(record(CLOSED), channels={**record(CLOSED).channels, TORQUE: held})
    assert all(TORQUE in text for text in texts(suspicions(stopped)))


@given(st.floats(0.2, 2.0), st.floats(0.3, 0.8), st.floats(0.0, 1e-3))
@settings(max_examples=20, deadline=None)
def test_a_clipped_swing_is_told_wherever_it_ends(rate, share, noise):
    time = np.arange(6000) * 1e-3
    rough = noise * np.random.default_rng(1).standard_normal(len(time))
    swing = np.sin(2.0 * np.pi * rate * time) + rough
    ends = np.abs(swing) >= share
    assert np.mean(clipping(np.clip(swing, -share, share)) == ends) > 0.98


def test_a_unit_is_named_with_the_mappings_key():
    (found,) = suspicions(scaled(DEGREES, "", ANGLE).done(rig(record())))
    assert found.channels == (ANGLE,)
    assert "in deg, taken for rad" in found.text
    assert "`unit: deg`" in found.text
    assert "times what it should be" in found.text


def test_a_mappings_own_unit_leaves_one_explanation():
    """Ten times too much is MPa for bar, where the mapping said bar; a power of ten elsewhere."""
    pressures = scaled(0.1, "", *PRESSURES)
    (found,) = suspicions(pressures.done(in_own_units(rig(record()))))
    assert "in MPa, taken for bar" in found.text
    assert "`unit: MPa`" in found.text
    assert "`unit: " not in texts(suspicions(pressures.done(rig(record()))))[0]


def test_a_sign_is_named_with_the_mappings_key():
    (found,) = suspicions(scaled(-1.0, "", FORCE).done(rig(record())))
    assert found.channels == (FORCE,)
    assert "`sign: -1`" in found.text


def test_two_mistakes_of_one_record_are_both_named():
    both = scaled(-1.0, "", TORQUE).done(scaled(1e3, "", POSITION).done(record()))
    found = suspicions(both)
    assert {s.channels for s in found} == {(TORQUE,), (POSITION,)}


def test_of_two_channels_alone_neither_is_believed():
    plain = record()
    two = replace(plain, channels={n: plain[n] for n in (ANGLE, POSITION, LEFT, RIGHT, SUPPLY)})
    found = suspicions(scaled(-1.0, "", ANGLE).done(two))
    assert {c for s in found for c in s.channels} == {ANGLE, POSITION}


def test_an_offset_of_one_pressure_is_an_effect_and_absolute_ones_are_a_mistake():
    plain = record(CLOSED)
    assert suspicions(shifted(ATMOSPHERE, "", LEFT).done(plain)) == []
    found = suspicions(shifted(ATMOSPHERE, "", *PRESSURES).done(plain))
    assert [s.channels for s in found] == [PRESSURES]
    assert "`offset: -101325` Pa" in found[0].text


@pytest.mark.parametrize("mistake", [saturated(TORQUE), frozen(FORCE, 0.9)])
def test_samples_that_say_nothing_are_not_judged(mistake):
    wrong = mistake.done(record())
    kept = without(wrong, suspicions(wrong))
    (channel,) = mistake.channels
    assert channel in kept
    assert kept.excluded is not None
    assert 0.0 < np.mean(kept.excluded) < 0.5


def test_a_number_that_stands_for_no_value_becomes_a_gap():
    plain = record()
    wrong = lost(ANGLE).done(plain)
    kept = without(wrong, suspicions(wrong))
    gap = np.isnan(kept[ANGLE])
    assert np.array_equal(gap, wrong[ANGLE] != plain[ANGLE])
    assert np.array_equal(kept[ANGLE][~gap], plain[ANGLE][~gap])


def test_factors_are_those_of_units_in_each_others_place():
    by_text = {text: factor for factor, text, _ in factors("Pa", "bar")}
    assert by_text["be in MPa, taken for bar"] == pytest.approx(0.1)
    assert by_text["be in psi, taken for bar"] == pytest.approx(14.5038, rel=1e-4)
    assert any("kp or daN" in text or "daN or kp" in text for _, text, _ in factors("N"))
    assert all(max(f, 1.0 / f) > 1.5 for f, _, _ in factors("N m"))


def test_what_cannot_be_replayed_without_the_suspected_is_not_judged():
    plain = rig(record())
    few = replace(plain, channels={n: plain[n] for n in (ANGLE, LEFT, RIGHT, POSITION, TORQUE)})
    report = diagnose_record(scaled(1e3, "", POSITION).done(few)).report
    assert report.verdict == "unexplained"
    assert report.causes == []
    assert "rack_position seems to be in mm" in report.sentence
    assert "put it right" in report.sentence


def test_a_suspected_hold_out_record_is_told():
    plain = rig(record())
    report = diagnose_record(plain, scaled(-1.0, "", ANGLE).done(plain)).report
    assert report.causes == []
    assert report.suspicions[0].startswith("in the hold-out record: steering_wheel_angle")
