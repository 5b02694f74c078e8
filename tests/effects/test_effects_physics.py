"""Each effect against its closed form."""

from __future__ import annotations

import numpy as np
import pytest
from closed_loop import trace

from steering_core.parameters import load_parameters
from steering_plant.effects import cross_piston_leakage, entrained_air
from steering_plant.plant import Plant
from steering_plant.rest import rest_solenoid_force


def test_entrained_air_is_the_series_of_two_springs() -> None:
    """Numerical derivative of the volume of oil and polytropic air in parallel volumes."""
    beta, fraction, exponent, pressure = 1e9, 0.01, 1.4, 4e5
    atmosphere = entrained_air.ATMOSPHERE

    def volume(gauge: float) -> float:
        return -gauge / beta + fraction * (atmosphere / (gauge + atmosphere)) ** (1 / exponent)

    step = 10.0
    slope = (volume(pressure + step) - volume(pressure - step)) / (2 * step)
    modulus = entrained_air.bulk_modulus(beta, pressure, fraction, exponent)
    assert modulus == pytest.approx(-1.0 / slope, rel=1e-6)


def test_leakage_conserves_volume() -> None:
    left = cross_piston_leakage.left_flow(0.0, 3e5, 9e5, 1e-12)
    right = cross_piston_leakage.right_flow(0.0, 3e5, 9e5, 1e-12)
    assert left == -right == pytest.approx(6e-7)


def test_solenoid_lag_is_a_first_order_lag() -> None:
    """A step of the command reaches 63 % of the way after one time constant."""
    tau = 0.005
    effects = {"solenoid_lag": {"time_constant": tau}}
    plant = Plant(load_parameters(), "closed_centre", effects=effects)
    rest = rest_solenoid_force(plant.par[0], plant.state[6])
    assert plant.state[-2:] == pytest.approx([rest, rest], rel=1e-12)
    for tick in range(5):
        plant.step(tick, 0.0, rest + 1.0, rest, 0.0, 1e12, 0.0)
    assert plant.state[-2] - rest == pytest.approx(1.0 - np.exp(-1.0), abs=1e-5)
    assert plant.state[-1] == pytest.approx(rest, rel=1e-12)


def test_torque_sensor_gain_scales_the_measurement_only() -> None:
    gain = {"torque_sensor_gain": {"gain": 1.1}}
    true, wrong = trace({}, "open_centre"), trace(gain, "open_centre")
    assert np.array_equal(wrong.rack, true.rack)
    assert wrong.torque[:, 2] == pytest.approx(1.1 * true.torque[:, 2], rel=1e-12)


def test_a_relaxing_tyre_follows_a_first_order_lag_in_distance() -> None:
    """Filter the force of the same motion by the closed form and compare."""
    length = 0.4
    late = trace({"tyre_relaxation": {"relaxation_length": length}}, "open_centre")
    from closed_loop import cores

    vehicle = cores({}, "open_centre", 1000).vehicle
    steady = np.array([vehicle.step(k, *row)[0] for k, row in enumerate(late.rack.tolist())])
    decay = np.exp(-load_parameters()["vehicle.speed"] * 1e-3 / length)
    expected, value = np.zeros(1000), 0.0
    for k in range(1, 1000):
        value = steady[k] + (value - steady[k]) * decay
        expected[k] = value
    assert late.load[:, 0] == pytest.approx(expected, abs=1e-9)
    assert not np.any(late.load[:, 1])
