"""Side wind on the bicycle: against its steady balances, and none leaves everything as it was."""

import numpy as np
import pytest

from steering_core.parameters import load_parameters
from vehicle_model.loads import make_load
from vehicle_model.vehicle import Vehicle

FORCE = 800.0


def blown(force, ticks=8000, kind="bicycle", **more):
    values = {"vehicle.wind_force": force, "vehicle.wind_start": 1.0, **more}
    car = Vehicle(load_parameters().with_values(values), make_load(kind), ticks)
    loads = np.array([car.step(tick, 0.0, 0.0, 0.0).copy() for tick in range(ticks)])
    return car, loads


@pytest.mark.parametrize("arm", [-0.4, 0.0, 0.5])
def test_settles_where_forces_and_moments_balance(arm):
    car, loads = blown(FORCE, **{"vehicle.wind_arm": arm})
    p = load_parameters().group("vehicle")
    a, b, v = p["front_axle_distance"], p["rear_axle_distance"], p["speed"]
    c_f, c_r = p["front_cornering_stiffness"], p["rear_cornering_stiffness"]
    # unknowns: front and rear force, sideslip, curvature, with the wheels held straight
    balance = np.array(
        [
            [1.0, 1.0, 0.0, -p["mass"] * v**2],
            [a, -b, 0.0, 0.0],
            [1.0, 0.0, c_f, a * c_f],
            [0.0, 1.0, c_r, -b * c_r],
        ]
    )
    front, _, sideslip, curvature = np.linalg.solve(balance, [-FORCE, -FORCE * arm, 0.0, 0.0])
    assert car.odometry().yaw_rate == pytest.approx(v * curvature, rel=1e-6)
    assert car.odometry().v_y == pytest.approx(v * sideslip, rel=1e-6)
    assert car.imu().lateral_acceleration == pytest.approx(v**2 * curvature, rel=1e-6)
    trail = (p["pneumatic_trail"] + p["mechanical_trail"]) / p["steering_arm"]
    assert loads[-1, 0] == pytest.approx(front * trail, rel=1e-6)


def test_wind_from_the_other_side_is_the_mirror_image():
    (left, one), (right, other) = blown(FORCE, 3000), blown(-FORCE, 3000)
    assert np.array_equal(one[:, 0], -other[:, 0])
    assert left.odometry().y == -right.odometry().y > 0.0


def test_nothing_moves_before_the_wind_or_without_it():
    assert not blown(FORCE, 1000)[1][:, 0].any()
    assert not blown(0.0, 3000)[1][:, 0].any()


def test_a_standing_car_is_not_blown_away():
    for kind, speed in (("dry_park", 20.0), ("bicycle", 0.0)):
        car, loads = blown(FORCE, 3000, kind, **{"vehicle.speed": speed})
        assert car.odometry()[:2] == (0.0, 0.0)
        assert not loads[:, 0].any()
