"""A rig's logger: gaps, and the noise of what drives the replay."""

from dataclasses import replace

import numpy as np
import pytest
from bench_records import NOISE, bench_record
from scipy.signal import lfilter, welch

from steering_diagnosis.steering.replay import BRIDGED, CUT_OFF, UNSETTLED, SteeringReplay
from steering_diagnosis.steering.smoothing import noise_like

SEVEN = (
    "steering_wheel_angle",
    "torsion_bar_torque",
    "left_pressure",
    "right_pressure",
    "supply_pressure",
    "rack_position",
    "rack_force",
)


def with_gap(record, channels, first, length):
    lost = {name: record[name].copy() for name in channels}
    for values in lost.values():
        values[first : first + length] = np.nan
    return replace(record, channels={**record.channels, **lost})


@pytest.fixture(scope="module")
def record():
    return bench_record("open_centre", noise=NOISE)


def test_behind_a_gap_of_an_input_nothing_is_judged_until_the_states_have_settled(record):
    first, length = len(record) // 2, 100
    judged = SteeringReplay(with_gap(record, SEVEN, first, length)).judged
    assert judged[first - CUT_OFF - 1]
    assert not judged[first - CUT_OFF : first + length + UNSETTLED].any()
    assert judged[first + length :].sum() > 0.6 * (len(record) - first - length)


@pytest.mark.parametrize(
    ("channels", "length"), [(SEVEN, BRIDGED), (("supply_pressure",), 100)], ids=["short", "output"]
)
def test_a_few_lost_ticks_and_an_output_s_gap_cost_no_more_than_themselves(
    record, channels, length
):
    whole, cut = (
        SteeringReplay(r).judged
        for r in (record, with_gap(record, channels, len(record) // 2, length))
    )
    np.testing.assert_array_equal(whole, cut)


def test_the_noise_of_pressures_that_drive_the_replay_shakes_it():
    sizes = []
    for noise in (3e3, 3e4):
        of_pressures = {f"{side}_pressure_sensor.noise": noise for side in ("left", "right")}
        record = bench_record("closed_centre", noise=NOISE | of_pressures)
        replay = SteeringReplay(replace(record, channels={name: record[name] for name in SEVEN}))
        torque = [o.name for o in replay.outputs].index("torsion_bar_torque")
        sizes.append(np.nanstd(replay.shaken({}, {})[:, torque]))
    assert sizes[1] > 1.25 * sizes[0]


@pytest.mark.parametrize("coloured", [0.0, 0.45])
def test_noise_is_drawn_in_the_channel_s_own_colour(coloured):
    random = np.random.default_rng(2)
    time = np.arange(20_000) * 1e-3
    keep = np.exp(-2.0 * np.pi * 30.0 * 1e-3)
    slow = lfilter([np.sqrt(1.0 - keep**2)], [1.0, -keep], random.standard_normal((2, 20_000)))
    noise = random.standard_normal((2, 20_000)) + coloured * slow
    drawn = noise_like(400.0 * np.sin(2.0 * np.pi * 0.5 * time) + noise[0], random)
    hz, expected = welch(noise[1], 1e3, nperseg=1024)
    _, found = welch(drawn, 1e3, nperseg=1024)
    for low, high in ((20.0, 45.0), (45.0, 120.0), (150.0, 450.0)):
        inside = (hz > low) & (hz < high)
        assert found[inside].mean() == pytest.approx(expected[inside].mean(), rel=0.4)
