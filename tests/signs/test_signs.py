"""The convention of docs/signs_and_units.md, on the whole loop of driver, plant and vehicle."""

import numpy as np
import pytest

from driver_model.driver import Driver
from driver_model.manoeuvres import make_manoeuvre
from steering_core.parameters import load_parameters
from steering_plant.plant import Plant
from vehicle_model.loads import make_load
from vehicle_model.vehicle import Vehicle

NOMINAL = load_parameters()
TICKS = 900
ANGLE, SPEED, TORQUE, LEFT, RIGHT, _, RACK, RACK_SPEED, FORCE = range(9)


def turn(degrees: float) -> dict[str, np.ndarray]:
    """Steer to ``degrees`` and hold; return what each node has put out, one row a tick."""
    manoeuvre = make_manoeuvre("step", angle_deg=degrees, start_s=0.0, rise_s=0.3)
    driver = Driver(NOMINAL, manoeuvre, TICKS)
    vehicle = Vehicle(NOMINAL, make_load("bicycle"), TICKS)
    plant = Plant(NOMINAL, "open_centre")
    rows: dict[str, list] = {"measured": [], "driver": [], "load": [], "motion": [], "imu": []}
    for tick in range(TICKS):
        m = plant.out.copy()
        torque = driver.step(tick, *m[:3])
        load = vehicle.step(tick, *m[6:])
        values = m, torque.copy(), load.copy(), vehicle.odometry(), vehicle.imu()
        for name, value in zip(rows, values, strict=True):
            rows[name].append(value)
        plant.step(tick, torque[0], 0.0, 0.0, *load)
    return {name: np.array(values) for name, values in rows.items()}


@pytest.fixture(scope="module")
def left() -> dict[str, np.ndarray]:
    return turn(20.0)


def test_everything_that_goes_with_a_left_turn_is_positive(left):
    measured = left["measured"][-1]
    assert measured[ANGLE] > 0.3
    assert measured[TORQUE] > 0.5
    assert measured[RACK] > 1e-3
    assert measured[RIGHT] - measured[LEFT] > 1e5
    assert measured[FORCE] > 500.0
    assert left["driver"][-1][0] > 0.5
    assert left["driver"][-1][1] == pytest.approx(np.radians(20.0))
    assert left["load"][-1][0] > 500.0
    assert left["load"][-1][1] > 0.0
    assert left["motion"][-1][1] > 0.1  # y: it has gone to the left
    assert left["motion"][-1][2] > 0.01  # heading
    assert (left["imu"][-1] > 0.05).all()
    while_turning = left["measured"][150]
    assert while_turning[SPEED] > 0.5
    assert while_turning[RACK_SPEED] > 5e-3


def test_the_torsion_bar_is_the_difference_of_wheel_and_rack(left):
    m = left["measured"]
    stiffness, ratio = 60.734, 130.9
    assert m[:, TORQUE] == pytest.approx(stiffness * (m[:, ANGLE] - ratio * m[:, RACK]), abs=1e-9)


def test_the_load_belongs_to_the_rack_position_of_its_tick(left):
    assert (left["load"][:, 2] == left["measured"][:, RACK]).all()
    # The plant's load cell shows the same force, a tick's stiffness term apart.
    assert left["measured"][100:, FORCE] == pytest.approx(left["load"][100:, 0], abs=5.0)


def test_in_the_steady_turn_the_rack_is_in_balance(left):
    """p_L A + T R_T = F, within the rack's friction of 60 N + 2.2e-5 N/Pa of both pressures."""
    m = left["measured"][-1]
    pushed = (m[RIGHT] - m[LEFT]) * 7.0e-4 + m[TORQUE] * 130.9
    friction = 60.0 + 2.2e-5 * (m[RIGHT] + m[LEFT])
    assert abs(pushed - m[FORCE]) < friction


def test_a_right_turn_is_the_mirror_image(left):
    right = turn(-20.0)
    mirrored = right["measured"][:, [ANGLE, SPEED, TORQUE, RIGHT, LEFT, 5, RACK, RACK_SPEED, FORCE]]
    mirrored[:, [ANGLE, SPEED, TORQUE, RACK, RACK_SPEED, FORCE]] *= -1.0
    assert mirrored == pytest.approx(left["measured"], rel=1e-9, abs=1e-9)
