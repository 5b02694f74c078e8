"""What is suspected of a record before any inference, and what is not."""

from dataclasses import replace

import numpy as np
import pytest
from bench_records import NOISE, bench_record

from steering_diagnosis.steering.diagnose_record import diagnose_record
from steering_diagnosis.steering.suspicions import suspicions, without

SYSTEMS = ("open_centre", "closed_centre")


@pytest.fixture(scope="module", params=SYSTEMS)
def record(request):
    return bench_record(request.param, scenario="weave", duration=6.0, noise=NOISE)


def changed(record, **channels):
    return replace(record, channels={**record.channels, **channels})


def about(record):
    return [channel for s in suspicions(record) for channel in s.channels]


def test_a_good_record_is_not_suspected(record):
    assert suspicions(record) == []


@pytest.mark.parametrize("effect", ["torque_sensor_gain", "rack_force_sensor_gain"])
def test_an_effect_is_no_mistake_of_the_record(effect):
    for gain in (0.8, 1.25):
        record = bench_record("closed_centre", scenario="weave", effects={effect: {"gain": gain}})
        assert suspicions(record) == []


@pytest.mark.parametrize(
    ("channel", "factor", "text"),
    [
        ("steering_wheel_angle", -1.0, "wrong sign"),
        ("steering_wheel_angle", 180.0 / np.pi, "degrees"),
        ("rack_position", 1e3, "thousandths"),
        ("rack_force", -1.0, "wrong sign"),
        ("rack_force", 1e-3, "kilo"),
        ("torsion_bar_torque", -1.0, "wrong sign"),
    ],
)
def test_a_wrong_sign_or_unit_is_named_with_its_evidence(record, channel, factor, text):
    wrong = changed(record, **{channel: factor * record[channel]})
    found = [s for s in suspicions(wrong) if channel in s.channels]
    assert len(found) == 1
    assert text in found[0].text
    assert "correlation" in found[0].text


def test_swapped_chambers_are_named(record):
    swapped = changed(
        record, left_pressure=record["right_pressure"], right_pressure=record["left_pressure"]
    )
    assert about(swapped) == ["left_pressure", "right_pressure"]
    assert "swapped" in suspicions(swapped)[0].text


def test_a_rack_that_only_drives_oil_has_no_swapped_chambers(record):
    """Moved fast without a load, the pressures go against the torque, and are small."""
    level, small = record["left_pressure"].mean(), 0.01
    driven = changed(
        record,
        left_pressure=level + small * (record["right_pressure"] - level),
        right_pressure=level + small * (record["left_pressure"] - level),
    )
    assert not {"left_pressure", "right_pressure"} & set(about(driven))


def test_a_dead_channel_is_named_and_left_out(record):
    dead = changed(record, rack_position=np.full(len(record), 1e-3))
    assert about(dead) == ["rack_position"]
    assert "rack_position" not in without(dead, suspicions(dead))


def test_a_clipped_channel_is_named_and_its_samples_are_not_judged(record):
    limit = 0.7 * np.abs(record["torsion_bar_torque"]).max()
    clipped = changed(
        record, torsion_bar_torque=np.clip(record["torsion_bar_torque"], -limit, limit)
    )
    found = suspicions(clipped)
    assert len(found) == 1
    assert "torsion_bar_torque seems to be clipped" in found[0].text
    excluded = without(clipped, found).excluded
    assert excluded is not None
    assert np.abs(clipped["torsion_bar_torque"][excluded]).min() == pytest.approx(limit)


def test_a_gear_that_oscillates_by_itself_is_told(record):
    time = np.arange(len(record)) * 1e-3
    size = 0.7 * np.std(record["rack_speed"])
    singing = changed(
        record, rack_speed=record["rack_speed"] + size * np.sin(2.0 * np.pi * 74.0 * time)
    )
    (found,) = suspicions(singing)
    assert "oscillates by itself at 74 Hz" in found.text
    assert found.channels == ()


def test_a_record_whose_wheel_has_the_wrong_sign_is_not_judged(record):
    wrong = changed(record, steering_wheel_angle=-record["steering_wheel_angle"])
    report = diagnose_record(wrong).report
    assert report.causes == []
    assert report.suspicions
    assert "put it right" in report.sentence


def test_a_record_without_motion_excites_nothing(record):
    still = {
        name: values[:1] + 0.01 * np.abs(values).max() * 0.0 * values
        for name, values in record.channels.items()
    }
    report = diagnose_record(replace(record, channels=still)).report
    assert report.verdict == "insufficient_excitation"
    assert report.causes == []
