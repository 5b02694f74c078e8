"""A rig test on the simulated plant, without ROS."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from steering_bringup.cores import build_cores
from steering_bringup.direct.runner import run
from steering_bringup.scenario_files import load_node_set
from steering_bringup.schema import Scenario
from steering_studies.channels import from_direct
from steering_studies.rig_tests.tests import RIG_TESTS, scenario

TYPICAL_NOISE: dict[str, float] = {
    "angle_sensor.noise": 2e-4,
    "torque_sensor.noise": 0.005,
    "left_pressure_sensor.noise": 3e3,
    "right_pressure_sensor.noise": 3e3,
    "supply_pressure_sensor.noise": 3e3,
    "rack_position_sensor.noise": 5e-6,
    "rack_force_sensor.noise": 5.0,
}
"""Standard deviations of a rig's usual sensors, as data sheet parameters, SI."""


def simulate(
    test: str,
    parameters: Mapping[str, float] | None = None,
    effects: Mapping[str, Mapping[str, float]] | None = None,
) -> dict[str, dict[str, np.ndarray]]:
    """Return the channels of every run of a rig test, by the run's name.

    parameters: of the gear and its sensors (TYPICAL_NOISE for a noisy record), full names, SI.
    """
    return {
        name: _channels(scenario(test, name, parameters or {}, effects or {}))
        for name in RIG_TESTS[test].runs
    }


def _channels(document: dict[str, Any]) -> dict[str, np.ndarray]:
    made = Scenario.model_validate({**document, "truth": False})
    cores = build_cores(made, load_node_set(made.node_set[0]))
    return from_direct(run(cores, made.ticks))
