"""The whole loop: the closed-centre gear against the open-centre one (figs 8.1 to 8.6)."""

import functools

import numpy as np
import pytest

from driver_model.driver import Driver
from driver_model.manoeuvres import make_manoeuvre
from pressure_control.controller import ValveController
from steering_bringup.direct.runner import Cores, run
from steering_core.parameters import load_parameters
from steering_plant.plant import Plant
from vehicle_model.loads import make_load
from vehicle_model.vehicle import Vehicle

PARAMETERS = load_parameters()
TICKS = 10_000


@functools.cache
def driven(valve_system, load):
    """On-centre sweep of +-30 degrees to 2 Hz."""
    closed = valve_system == "closed_centre"
    cores = Cores(
        Plant(PARAMETERS, valve_system),
        Driver(PARAMETERS, make_manoeuvre("on_centre"), TICKS),
        Vehicle(PARAMETERS, make_load(load), TICKS),
        ValveController(PARAMETERS, "left") if closed else None,
        ValveController(PARAMETERS, "right") if closed else None,
    )
    return run(cores, TICKS)


def load_pressure(trace):
    return trace.pressure[:, 1] - trace.pressure[:, 0]


def ripple(trace):
    """Second difference of the right chamber's pressure [Pa], standard deviation."""
    return np.std(np.diff(trace.pressure[:, 1], 2))


def test_on_centre_torque_differs_by_a_tenth_and_with_frequency_only():
    closed, opened = driven("closed_centre", "bicycle"), driven("open_centre", "bicycle")
    difference = np.abs(closed.driver[:, 0] - opened.driver[:, 0])
    by_second = difference.reshape(-1, 1000).max(axis=1)
    assert by_second.max() < 0.1
    assert by_second[0] < 0.01
    # the frequency rises by 0.2 Hz a second
    assert np.all(by_second[5:] > 0.9 * by_second[4:-1])
    assert np.max(np.abs(closed.torque[:, 2] - opened.torque[:, 2])) < 0.1


def test_on_centre_pressures_differ_by_less_than_a_bar():
    closed, opened = driven("closed_centre", "bicycle"), driven("open_centre", "bicycle")
    assert np.max(np.abs(load_pressure(closed) - load_pressure(opened))) < 0.3e5
    assert np.max(np.abs(closed.pressure[:, :2] - opened.pressure[:, :2])) < 1.0e5
    assert ripple(closed) < 600.0


def test_parking_reaches_80_bar_with_the_same_setting():
    closed, opened = driven("closed_centre", "dry_park"), driven("open_centre", "dry_park")
    assert 7.8e6 < load_pressure(closed).max() < 8.8e6
    assert np.max(np.abs(load_pressure(closed) - load_pressure(opened))) < 2.5e5
    assert np.max(np.abs(closed.torque[:, 2] - opened.torque[:, 2])) < 0.4
    assert ripple(closed) < 1500.0


def step_response(torque, ticks=80):
    """Chamber pressures [Pa] after a step of the torque signal, rack held by its load."""
    plant = Plant(PARAMETERS, "closed_centre")
    sides = [ValveController(PARAMETERS, "left"), ValveController(PARAMETERS, "right")]
    rows = []
    for tick in range(ticks):
        measured = plant.out.copy()
        measured[2] = torque
        rows.append(measured[3:5])
        left, right = (side.step(tick, *measured)[1] for side in sides)
        plant.step(tick, 0.0, left, right, 0.0, 1e10, 0.0)
    return np.array(rows)


def test_step_of_two_newton_metres_rises_in_the_sources_time():
    """fig 8.1: from about 4.5 to about 15 bar, as fast as the open-centre valve."""
    right = step_response(2.0)[:, 1]
    assert right[0] == pytest.approx(4.9e5, rel=0.02)
    assert right[-1] == pytest.approx(15.5e5, rel=0.02)
    reached = np.argmax(right > right[0] + 0.9 * (right[-1] - right[0]))
    assert 5 <= reached <= 13
    assert right.max() < right[-1] + 0.3e5


def test_step_mirrors():
    np.testing.assert_array_equal(step_response(2.0), step_response(-2.0)[:, ::-1])
