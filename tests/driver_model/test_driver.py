import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from driver_model.driver import Driver
from driver_model.manoeuvres import make_manoeuvre
from steering_core.parameters import load_parameters

NOMINAL = load_parameters()
GAIN = NOMINAL["driver.gain"]
LIMIT = NOMINAL["driver.maximum_torque"]


def driver(kind="hold", ticks=3000, parameters=NOMINAL, **values) -> Driver:
    return Driver(parameters, make_manoeuvre(kind, **values), ticks)


def loop_poles(wheel, delay: int) -> np.ndarray:
    """Return the poles of driver and wheel, from the kernel's answer to each unit state."""
    unlimited = NOMINAL.with_values({"driver.maximum_torque": 1e9})
    columns = []
    for unit in np.eye(4 + delay):
        d = driver(parameters=unlimited)
        d.state[:] = unit[2:4]
        torque = d.step(0, unit[0], unit[1], 0.0)[0]
        chain = [torque, *unit[4:]]
        moved = wheel.transition @ unit[:2] + wheel.by_torque * chain[-1]
        columns.append([*moved, *d.state, *chain[:-1]])
    return np.linalg.eigvals(np.array(columns).T)


@pytest.mark.parametrize(("delay", "damping"), [(0, 0.8), (1, 0.6)])
def test_loop_with_the_wheel_is_stable_and_well_damped(wheel, delay, damping):
    poles = loop_poles(wheel, delay)
    assert np.abs(poles).max() < 0.97
    roots = np.log(poles[np.abs(poles) > 1e-6].astype(complex)) / 1e-3
    slow = roots[np.abs(roots) < 600.0]
    assert slow.size >= 2
    assert (-slow.real / np.abs(slow)).min() > damping


@pytest.mark.parametrize("delay", [0, 1])
def test_the_wheel_follows_and_settles_at_the_static_balance(wheel, delay):
    """gain (reference - angle) = K_T angle: the torsion bar keeps the angle 17 % short."""
    d = driver("step", angle_deg=8.0, start_s=0.1, rise_s=0.05)
    angles, _ = wheel.drive(d, 3000, delay)
    final = np.radians(8.0) * GAIN / (GAIN + wheel.stiffness)
    assert angles[-1] == pytest.approx(final, rel=1e-6)
    assert angles.max() < 1.3 * final
    assert np.abs(angles[400:] / final - 1.0).max() < 0.01


def test_a_saturated_driver_comes_back_without_a_swing(wheel):
    """A step far beyond the limit: pinned at it on the way up, yet no overshoot."""
    values = {"angle_deg": 30.0, "start_s": 0.01, "rise_s": 0.002}
    angles, torques = wheel.drive(driver("step", **values), 3000)
    assert np.abs(torques).max() == LIMIT
    assert np.count_nonzero(np.abs(torques) == LIMIT) > 10
    assert angles[-1] == pytest.approx(np.radians(30.0) * GAIN / (GAIN + wheel.stiffness), rel=1e-6)
    assert angles.max() < 1.05 * angles[-1]


def test_a_slow_lag_does_not_wind_up_at_the_limit():
    """A second at six times the limit, then no error: the torque leaves the limit at once.

    A lag that had gone on filtering the error would stay at the limit for ln(6) x 0.2 s.
    """
    sluggish = NOMINAL.with_values({"driver.lead": 0.0, "driver.lag": 0.2})
    d = driver(parameters=sluggish)
    saturated = [d.step(k, -1.0, 0.0, 0.0)[0] for k in range(1000)]
    assert saturated[-1] == LIMIT
    after = [d.step(k, 0.0, 0.0, 0.0)[0] for k in range(1000, 1400)]
    assert after[1] < LIMIT
    assert after[200] == pytest.approx(LIMIT * np.exp(-1.0), rel=0.02)


def test_release_is_exactly_zero_from_its_tick_on(wheel):
    d = driver("free_release", angle_deg=10.0, start_s=0.0, rise_s=0.2, release_s=0.5)
    angles, torques = wheel.drive(d, 1500)
    assert abs(torques[499]) > 5.0
    assert (torques[500:] == 0.0).all()
    # The wheel now swings on the torsion bar at sqrt(K_T / J_sw): 5.15 Hz (eq 3.1).
    crossings = np.flatnonzero(np.diff(np.sign(angles[500:])))
    assert 1000.0 / (2.0 * np.diff(crossings).mean()) == pytest.approx(5.15, rel=0.01)


def test_hands_that_come_back_start_softly():
    d = driver()
    d.hands_on = np.array([1.0, 0.0, 0.0, 1.0])
    torques = [d.step(k, 0.1, 0.0, 0.0)[0] for k in range(4)]
    assert torques[1:3] == [0.0, 0.0]
    assert torques[3] == pytest.approx(-0.1 * GAIN)


def test_tables_hold_their_last_value():
    d = driver("ramp", ticks=1000, angle_deg=90.0, speed_deg_s=30.0)
    d.step(0, 0.0, 0.0, 0.0)
    d.step(10**7, 0.0, 0.0, 0.0)
    assert d.out[1] == d.reference[-1] == d.reference[1000]


def test_reports_the_reference_it_follows():
    d = driver("weave")
    for tick in range(50):
        d.step(tick, 0.0, 0.0, 0.0)
        assert d.out[1] == d.reference[tick]


def test_a_measurement_that_is_no_number_is_not_hidden():
    assert np.isnan(driver().step(0, float("nan"), 0.0, 0.0)[0])


sequences = st.lists(st.floats(-20.0, 20.0), min_size=1, max_size=40)


@settings(max_examples=60, deadline=None)
@given(sequences)
def test_limit_holds_and_left_mirrors_right_to_the_bit(angles):
    left, right = driver(), driver()
    for tick, angle in enumerate(angles):
        one = left.step(tick, angle, 1.0, 2.0)[0]
        other = right.step(tick, -angle, -1.0, -2.0)[0]
        assert abs(one) <= LIMIT
        assert one == -other


@settings(max_examples=30, deadline=None)
@given(sequences)
def test_same_inputs_give_the_same_bits(angles):
    one, other = driver("on_centre"), driver("on_centre", ticks=len(angles))
    for tick, angle in enumerate(angles):
        assert one.step(tick, angle, 0.0, 0.0).tobytes() == (
            other.step(tick, angle, 0.0, 0.0).tobytes()
        )
