"""Whatever is sent, no limit of the overlay is exceeded at any tick, and the sides mirror."""

import math

import numba
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from overlay_rules import APPLIED, Rules, lateral_gain

from pressure_control.overlay.arbiter import OUTPUTS, OverlayArbiter, arbiter_step, overlay_record
from pressure_control.overlay.lateral import lateral_gain as kernel_gain
from steering_core.parameters import ParameterError, load_parameters

PARAMETERS = load_parameters()
VARIANTS = {
    "torque": {},
    "pressure": {"overlay.maximum_pressure": 6e5},
    "acceleration": {"overlay.maximum_lateral_acceleration": 0.5},
    "rate": {"overlay.maximum_rate": 7.0},
    "jerk": {"overlay.maximum_lateral_jerk": 1.0},
}
any_float = st.floats(allow_nan=True, allow_infinity=True)
wish = st.one_of(st.floats(-40.0, 40.0), any_float)
priority = st.one_of(st.sampled_from([-1.0, 0.0, 1.0, 2.0]), any_float)
row = st.tuples(any_float, any_float, wish, priority, wish, priority, st.integers(1, 60))


def run(arbiter, rows, sign=1.0):
    """Hold each row for its number of ticks; return what the arbiter gave, (n, 19)."""
    out, tick = [], 0
    for speed, bar, first, rank, second, other, ticks in rows:
        for _ in range(ticks):
            values = (0.0, sign * speed, sign * bar, 20.0, sign * first, rank, sign * second, other)
            out.append(arbiter.step(tick, *values).copy())
            tick += 1
    return np.array(out).reshape(-1, OUTPUTS)


@pytest.mark.parametrize("variant", VARIANTS)
@given(rows=st.lists(row, max_size=8))
@settings(max_examples=40, deadline=None)
def test_no_sequence_exceeds_a_limit(variant, rows):
    parameters = PARAMETERS.with_values(VARIANTS[variant])
    Rules(parameters).check(run(OverlayArbiter(parameters, (10, 1)), rows))


@given(rows=st.lists(row, max_size=8))
@settings(max_examples=60, deadline=None)
def test_left_and_right_mirror_each_other_to_the_bit(rows):
    one = run(OverlayArbiter(PARAMETERS, (10, 1)), rows)
    other = run(OverlayArbiter(PARAMETERS, (10, 1)), rows, -1.0)
    assert np.array_equal(one[:, :5], -other[:, :5])
    assert np.array_equal(one[:, 5:], other[:, 5:])


@numba.njit
def drawn(state):
    """Return a number from 0 to 1 of a linear congruential generator whose state it moves on."""
    state[0] = (state[0] * 1103515245 + 12345) % 2147483648
    return state[0] / 2147483648.0


@numba.njit
def drawn_torque(state):
    """A wish: mostly sensible, sometimes far out, infinite or no number."""
    kind = drawn(state)
    if kind < 0.05:
        return math.nan
    if kind < 0.08:
        return math.inf if drawn(state) < 0.5 else -math.inf
    return (drawn(state) - 0.5) * (80.0 if kind < 0.4 else 24.0)


@numba.njit
def worst(par, sequences, ticks, seed, level, step):
    """Run random sequences; return the greatest share of level and step, and mirror faults."""
    random = np.array([seed])
    top, fastest, faults, moved = 0.0, 0.0, 0, 0
    longest, bounds, requests = np.array([30.0, 9.0]), np.zeros(5), np.zeros((2, 3))
    states, kept, outs = np.zeros((2, 10)), np.zeros((2, 2, 6)), np.zeros((2, 19))
    for _ in range(sequences):
        states[:] = 0.0
        states[:, 1] = states[:, 5] = 1.0
        kept[:] = 0.0
        kept[:, :, 2:4] = -1.0
        before, wheel, bar, speed = 0.0, 0.0, 0.0, 20.0
        requests[:, 2] = -1.0
        for tick in range(ticks):
            for i in range(2):
                if drawn(random) < 0.12:
                    requests[i, 0] = drawn_torque(random)
                    requests[i, 1] = math.floor(drawn(random) * 5.0) - 1.0
                    requests[i, 2] = tick
            if drawn(random) < 0.04:
                bar = drawn_torque(random) * 0.3
                wheel = (drawn(random) - 0.5) * 20.0
            for side in range(2):
                sign = 1.0 - 2.0 * side
                requests[:, 0] *= sign
                arbiter_step(
                    par, states[side], kept[side], requests, longest, bounds, outs[side],
                    tick, speed, sign * wheel, sign * bar,
                )  # fmt: skip
                requests[:, 0] *= sign
            applied = outs[0, 1]
            faults += applied != -outs[1, 1] or outs[0, 5] != outs[1, 5]
            top = max(top, abs(applied) / level)
            fastest = max(fastest, abs(applied - before) / step)
            moved += applied != before
            before = applied
    return top, fastest, faults, moved


@pytest.mark.parametrize("variant", VARIANTS)
def test_no_limit_is_exceeded_in_random_sequences(variant):
    """100,000 sequences of a quarter of a second, 20,000 for each limit that is the tightest."""
    parameters = PARAMETERS.with_values(VARIANTS[variant])
    rules = Rules(parameters)
    seed = 7 + list(VARIANTS).index(variant)
    record = overlay_record(parameters)
    top, fastest, faults, moved = worst(record, 20_000, 250, seed, rules.level, rules.step)
    assert top <= 1.0 + 1e-12
    assert fastest <= 1.0 + 1e-10  # the difference of two numbers of 10 N m rounds
    assert faults == 0
    assert moved > 1_000_000
    assert fastest > 0.99


@pytest.mark.parametrize("variant", VARIANTS)
def test_the_limits_are_used_to_the_full(variant):
    parameters = PARAMETERS.with_values(VARIANTS[variant])
    rules = Rules(parameters)
    arbiter = OverlayArbiter(parameters, (1,))
    wished = [(0.0, 0.0, 0.0, 20.0, 29.0 if k < 6000 else -29.0, 1.0) for k in range(7000)]
    out = np.array([arbiter.step(k, *row).copy() for k, row in enumerate(wished)])
    assert out[5999, APPLIED] == pytest.approx(rules.level, rel=1e-12)
    assert out[6001, APPLIED] - out[6000, APPLIED] == pytest.approx(-rules.step, rel=1e-9)


def test_full_torque_without_any_cause_is_the_data_sheets():
    assert Rules().level == PARAMETERS["overlay.maximum_torque"]


@pytest.mark.parametrize("centring", [0.0, 2e4])
@pytest.mark.parametrize("speed", [0.5, 3.0, 20.0, 60.0])
def test_the_gain_is_that_of_the_cars_balances(speed, centring):
    parameters = PARAMETERS.with_values({"overlay.centring_stiffness": centring})
    found = kernel_gain(overlay_record(parameters)[0], speed)
    assert found == pytest.approx(lateral_gain(parameters, speed), rel=1e-9)


def test_an_unbelievable_speed_leaves_the_cautious_gain():
    record = overlay_record(PARAMETERS.with_values({"overlay.centring_stiffness": 2e4}))[0]
    for speed in (math.nan, math.inf, -math.inf, 1e300):
        assert kernel_gain(record, speed) >= kernel_gain(record, 100.0)
        assert np.isfinite(kernel_gain(record, speed))


def test_a_falling_bound_is_come_down_to_at_the_limit_of_rate():
    """From standstill, where hardly any torque moves the car sideways, to 30 m/s within a tick."""
    parameters = PARAMETERS.with_values(
        {"overlay.centring_stiffness": 5e4, "overlay.maximum_lateral_acceleration": 0.2}
    )
    arbiter = OverlayArbiter(parameters, (1,))
    slow, fast = (Rules(parameters, speed) for speed in (1.0, 30.0))
    assert fast.level < slow.level
    applied = [
        arbiter.step(k, 0.0, 0.0, 0.0, 1.0 if k < 2000 else 30.0, 9.0, 1.0)[APPLIED]
        for k in range(4000)
    ]
    steps = np.diff(applied)
    assert np.all(np.abs(steps[2000:]) <= fast.step * (1.0 + 1e-9))
    assert np.all(steps[2000:] <= 1e-15)
    assert applied[-1] == pytest.approx(fast.level, rel=1e-12)


def test_an_override_that_cannot_be_is_refused():
    with pytest.raises(ParameterError, match="override_full"):
        overlay_record(PARAMETERS.with_values({"overlay.override_full": 1.0}))
