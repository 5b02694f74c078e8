from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from steering_core.parameters import ParameterError, load_parameters
from vehicle_model.bicycle import continuous, rack_force_gains, yaw_rate_gain
from vehicle_model.loads import LOADS, make_load
from vehicle_model.motion import sampled_bicycle
from vehicle_model.vehicle import Vehicle

NOMINAL = load_parameters()
P = NOMINAL.group("vehicle")
# Rack displacement at 30 degrees of steering wheel, rigid column.
THIRTY_DEGREES = np.radians(30.0) / NOMINAL["mechanics.gear_ratio"]


def vehicle(speed: float = P["speed"], kind: str = "bicycle") -> Vehicle:
    return Vehicle(NOMINAL.with_values({"vehicle.speed": speed}), make_load(kind), 10)


def run(v: Vehicle, positions: np.ndarray) -> np.ndarray:
    """Return the forces of ``v`` for rack ``positions`` of ticks 0, 1, ..."""
    return np.array([v.step(tick, x, 0.0, 0.0)[0] for tick, x in enumerate(positions)])


@pytest.mark.parametrize("speed", [0.2, 1.0, 8.0, 19.444, 40.0])
def test_settles_at_the_closed_form(speed):
    v = vehicle(speed)
    x = 0.001
    run(v, np.full(6000, x))
    yaw_rate = yaw_rate_gain(P, speed) * x / P["steering_arm"]
    assert v.odometry().yaw_rate == pytest.approx(yaw_rate, rel=1e-6)
    assert v.imu().yaw_rate == v.odometry().yaw_rate
    assert v.imu().lateral_acceleration == pytest.approx(speed * yaw_rate, rel=1e-6)
    # Moment balance about the rear axle: F_yf = m a_y b / l; on trail and arm it is the rack force.
    front = P["mass"] * speed * yaw_rate * 1.5 / 2.7
    assert v.out[0] == pytest.approx(front * 0.08 / 0.11, rel=1e-6)


def test_rack_force_at_30_degrees_and_70_kmh():
    """The source's load cylinder sees about 2.3 kN; here steady, with a rigid column: 2.7 kN."""
    v = vehicle()
    run(v, np.full(4000, THIRTY_DEGREES))
    assert v.out[0] == pytest.approx(2721.0, abs=2.0)
    assert v.imu().lateral_acceleration == pytest.approx(3.64, abs=0.01)


def test_rack_force_of_a_30_degree_sweep_is_near_the_sources_2_3_kn():
    """From 0 to 2 Hz in 10 s; at 2 Hz the yaw response has dropped and the tyre slips less."""
    t = np.arange(10001) / 1000.0
    forces = np.abs(run(vehicle(), THIRTY_DEGREES * np.sin(2.0 * np.pi * 0.1 * t**2)))
    assert forces.max() == pytest.approx(2616.0, abs=5.0)
    assert forces[-500:].max() == pytest.approx(2106.0, abs=5.0)
    assert 2106.0 < 2300.0 < 2616.0


def reference_solution(speed: float, positions: np.ndarray) -> np.ndarray:
    """Return [v_y, r, heading, x, y] in the textbook's own states, rack linear between ticks."""
    m, inertia, a, b = P["mass"], P["yaw_inertia"], 1.2, 1.5
    ticks = np.arange(positions.size) * 1e-3

    def rate(t, state):
        v_y, r, heading = state[:3]
        delta = np.interp(t, ticks, positions) / P["steering_arm"]
        front = P["front_cornering_stiffness"] * (delta - (v_y + a * r) / speed)
        rear = -P["rear_cornering_stiffness"] * (v_y - b * r) / speed
        return [
            (front + rear) / m - speed * r,
            (a * front - b * rear) / inertia,
            r,
            speed * np.cos(heading) - v_y * np.sin(heading),
            speed * np.sin(heading) + v_y * np.cos(heading),
        ]

    state = np.zeros(5)
    for begin, end in pairwise(ticks):  # the input has a kink at each tick
        state = solve_ivp(rate, (begin, end), state, "Radau", rtol=1e-9, atol=1e-12).y[:, -1]
    return state


@pytest.mark.parametrize("speed", [0.3, 4.0, 19.444])
def test_exact_against_a_stiff_solver(speed):
    """Second route: v_y and r integrated tightly; 0.3 m/s has a time constant of 2 ms."""
    positions = 0.004 * np.sin(2.0 * np.pi * 2.0 * np.arange(301) * 1e-3)
    v = vehicle(speed)
    run(v, positions)
    found = v.odometry()
    v_y, r, heading, x, y = reference_solution(speed, positions)
    assert found.v_y == pytest.approx(v_y, abs=1e-12)
    assert found.yaw_rate == pytest.approx(r, abs=1e-12)
    assert found.heading == pytest.approx(heading, abs=1e-12)
    assert (found.x, found.y) == pytest.approx((x, y), abs=1e-6)
    assert found.v_x == speed


def test_drives_a_circle_of_the_kinematic_radius_at_walking_pace():
    """Half a turn left: displaced by the diameter 2 l / delta, heading reversed."""
    v = vehicle(1.0)
    delta = 0.2
    radius = 2.7 / delta * (1.0 + 0.00285 / 2.7)
    run(v, np.full(round(np.pi * radius * 1000.0) + 1, delta * P["steering_arm"]))
    position = v.odometry()
    rear_offset = 1.5
    assert position.heading == pytest.approx(np.pi, abs=0.01)
    assert position.y == pytest.approx(2.0 * radius, rel=0.01)
    assert position.x == pytest.approx(-2.0 * rear_offset, abs=0.3)


def test_goes_over_to_the_standstill_without_a_jump():
    """The sampled model at 1e-5 m/s is the one at rest, and neither has tyre force."""
    slow, still = (sampled_bicycle(P, speed, 1e-3) for speed in (1e-5, 0.0))
    for one, other in zip(slow, still, strict=True):
        assert one == pytest.approx(other, abs=1e-3 * np.abs(other).max())
    v = vehicle(0.0)
    forces = run(v, np.linspace(0.0, 0.05, 50))
    assert np.abs(forces).max() < 1e-6
    assert abs(v.out[1]) < 1e-6
    assert v.odometry()[:3] == (0.0, 0.0, 0.0)
    assert v.imu() == (0.0, 0.0)


@pytest.mark.parametrize("speed", [1e-12, 1e-6, 1e-3, 0.1, 3.0, 19.444, 100.0])
def test_finite_and_bounded_at_any_speed(speed):
    rng = np.random.default_rng(7)
    positions = np.cumsum(rng.normal(size=2000)) * 1e-4
    v = vehicle(speed)
    forces = run(v, positions)
    assert np.isfinite(forces).all()
    assert np.isfinite(v.state).all()
    direct = 115e3 * 0.08 / 0.11**2
    assert 0.0 <= v.out[1] <= direct * (1.0 + 1e-12)
    assert np.abs(forces).max() < 5.0 * direct * np.abs(positions).max()


def test_stiffness_predicts_the_force_at_the_end_of_a_tick():
    """F(k+1) = F(k+1 | rack held) + stiffness (x(k+1) - x(k)); near the direct one at 70 km/h."""
    for speed in (0.05, 1.0, 19.444):
        history = np.linspace(0.0, 0.001, 30)
        held, moved = vehicle(speed), vehicle(speed)
        stay = run(held, np.append(history, history[-1]))[-1]
        go = run(moved, np.append(history, history[-1] + 1e-4))[-1]
        assert go - stay == pytest.approx(held.out[1] * 1e-4, rel=1e-6)
    assert vehicle().par["stiffness"][0] == pytest.approx(115e3 * 0.08 / 0.11**2, rel=0.004)


def work_per_cycle(speed: float, frequency: float, amplitude: float) -> float:
    """Return the rack's work on the tyre: pi amplitude^2 Im G(j omega) of the continuous model."""
    a_matrix, b_vector = continuous(P, speed)
    gains = rack_force_gains(P)
    s = 2j * np.pi * frequency
    states = np.linalg.solve(s * np.eye(2) - a_matrix[:2, :2], b_vector[:2])
    return np.pi * amplitude**2 * (gains[:2] @ states + gains[2]).imag


@pytest.mark.parametrize("speed", [0.1, 5.0, 19.444])
@pytest.mark.parametrize("frequency", [0.5, 2.0, 10.0])
def test_energy_of_a_rack_moved_to_and_fro(speed, frequency):
    """The sampled tyre takes what the continuous one takes.

    Slow, it only takes; at 70 km/h and 0.5 Hz the car, kept at its speed, returns 5 J a cycle.
    """
    t = np.arange(6001) / 1000.0
    positions = 0.004 * np.sin(2.0 * np.pi * frequency * t)
    forces = run(vehicle(speed), positions)
    mean = 0.5 * (forces[1:] + forces[:-1])
    cycle = slice(-round(1000 / frequency), None)
    expected = work_per_cycle(speed, frequency, 0.004)
    assert np.sum((mean * np.diff(positions))[cycle]) == pytest.approx(expected, rel=0.01)
    if speed < 1.0:
        assert expected > 0.0


def test_a_car_let_straight_comes_to_rest_on_its_heading():
    v = vehicle()
    run(v, np.concatenate([np.full(500, 0.002), np.zeros(5000)]))
    assert abs(v.out[0]) < 1e-6
    assert abs(v.imu().yaw_rate) < 1e-9
    assert v.odometry().heading > 0.01


@pytest.mark.parametrize("speed", [-1.0, float("nan"), float("inf")])
def test_impossible_speeds_are_refused(speed):
    with pytest.raises(ParameterError, match=r"vehicle\.speed"):
        vehicle(speed)


def test_the_first_tick_has_no_past():
    """A rack that is found displaced at tick 0 has not moved there during the run."""
    v = vehicle()
    assert v.step(0, 0.001, 0.0, 0.0)[0] == pytest.approx(115e3 * 0.08 / 0.11**2 * 0.001)
    assert v.odometry()[:3] == (0.0, 0.0, 0.0)


def test_a_measurement_that_is_no_number_is_not_hidden():
    assert np.isnan(vehicle().step(0, float("nan"), 0.0, 0.0)[0])


paths = st.lists(st.floats(-0.075, 0.075), min_size=1, max_size=60)


@settings(max_examples=80, deadline=None)
@given(paths, st.floats(0.0, 60.0), st.sampled_from(["bicycle", "dry_park", "none"]))
def test_left_and_right_mirror_each_other_to_the_bit(positions, speed, kind):
    left, right = vehicle(speed, kind), vehicle(speed, kind)
    for tick, x in enumerate(positions):
        one, other = left.step(tick, x, 0.0, 0.0), right.step(tick, -x, 0.0, 0.0)
        assert one[0] == -other[0]
        assert one[1] == other[1]
        assert one[2] == -other[2]
    here, there = left.odometry(), right.odometry()
    assert here.x == there.x
    assert (here.y, here.heading, here.v_y, here.yaw_rate) == (
        -there.y,
        -there.heading,
        -there.v_y,
        -there.yaw_rate,
    )
    assert left.imu() == tuple(-value for value in right.imu())


@settings(max_examples=40, deadline=None)
@given(paths, st.floats(0.1, 60.0), st.floats(-3.0, 3.0))
def test_the_force_is_linear_in_the_rack(positions, speed, factor):
    scaled = run(vehicle(speed), factor * np.array(positions))
    assert scaled == pytest.approx(factor * run(vehicle(speed), np.array(positions)), abs=1e-6)


@pytest.mark.parametrize("kind", LOADS)
def test_uniform_interface(kind):
    v = vehicle(kind=kind)
    assert v.par.shape == (1,)
    assert v.par.dtype.names
    assert all(v.par.dtype[name] == np.float64 for name in v.par.dtype.names)
    assert v.state.dtype == v.out.dtype == v.external.dtype == np.float64
    assert v.step(0, 0.0, 0.0, 0.0) is v.out
