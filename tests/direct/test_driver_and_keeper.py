"""The lane keeper with a driver: one who steers along, and one who overrules it."""

from functools import cache
from typing import Any

import numpy as np
import pytest
from overlay_rules import APPLIED, AUTHORITY, HAND, OVERRIDES, SOURCE

from steering_bringup.cores import build_cores
from steering_bringup.direct.runner import run
from steering_bringup.lane_keeping.lane import lane_offsets
from steering_bringup.scenario_files import load_node_set, load_scenario

TAKES_THE_WHEEL, LETS_GO = 4000, 10_000


@cache
def drive(name, side=1.0, **parameters):
    """Return (offsets [m], trace) of a shipped scenario; side -1: everything mirrored."""
    scenario = load_scenario(name)
    wind = side * scenario.parameters.get("vehicle.wind_force", 0.0)
    values = {**scenario.parameters, "vehicle.wind_force": wind, **parameters}
    update: dict[str, Any] = {"parameters": values}
    if side < 0.0:
        manoeuvre = scenario.manoeuvre.model_copy(update=mirrored(scenario.manoeuvre))
        update["manoeuvre"] = manoeuvre
    scenario = scenario.model_copy(update=update)
    made = build_cores(scenario, load_node_set("closed_centre_lane_keeping"))
    assert made.lane_keeper is not None
    made.lane_keeper.lane[:, 1:] *= side
    trace = run(made, scenario.ticks)
    aside = lane_offsets(made.lane_keeper.lane, trace.motion[:, 3], trace.motion[:, 4])
    return aside, trace


def mirrored(manoeuvre):
    values = manoeuvre.values()
    return {
        name: tuple(-v for v in value) if isinstance(value, tuple) else -value
        for name, value in values.items()
        if name in ("angle_deg", "steering_wheel_angle_deg")
    }


@pytest.mark.parametrize("name", ["lane_keeping", "lane_keeping_driver", "lane_change"])
def test_left_and_right_mirror_each_other_to_the_bit(name):
    (left, one), (right, other) = drive(name), drive(name, -1.0)
    assert np.array_equal(left, -right)
    assert np.array_equal(one.torque, -other.torque)
    assert np.array_equal(one.pressure[:, [1, 0, 2]], other.pressure)
    assert np.array_equal(one.overlay[:, : HAND + 1], -other.overlay[:, : HAND + 1])
    assert np.array_equal(one.overlay[:, AUTHORITY:], other.overlay[:, AUTHORITY:])


def test_a_driver_who_steers_along_does_not_overrule():
    aside, trace = drive("lane_keeping_driver")
    assert np.max(np.abs(aside)) < 0.05
    assert np.max(np.abs(trace.driver[:, 0])) > 0.2
    assert np.all(trace.overlay[:, AUTHORITY] == 1.0)


def test_the_driver_overrules_with_few_newton_metres():
    """UN R79 (Annex 8, 3.2.3) allows 50 N at the rim, 9.5 N m; here it takes less than a third."""
    aside, trace = drive("lane_change")
    held = slice(TAKES_THE_WHEEL, LETS_GO)
    assert np.max(aside) > 3.0
    assert np.max(np.abs(trace.driver[held, 0])) < 3.0
    authority, applied = trace.overlay[:, AUTHORITY], trace.overlay[:, APPLIED]
    assert np.all(authority[:TAKES_THE_WHEEL] == 1.0)
    assert np.min(authority[held]) < 0.4
    assert trace.overlay[-1, OVERRIDES] >= 1.0
    assert np.max(np.abs(np.diff(applied))) <= 0.0401


def test_after_the_driver_the_keeper_comes_back_without_swinging_over():
    aside, trace = drive("lane_change", **{"lane_keeping.largest_offset": 4.0})
    assert trace.overlay[-1, SOURCE] == 1
    assert trace.overlay[-1, AUTHORITY] == 1.0
    assert np.min(aside) > -0.3
    assert abs(aside[-1]) < 1.5
