"""The source's figures of linear analysis and controller design, by number.

``FIGURES[number](parameters)`` returns the study's arrays and figures of merit: a ``Family`` of
frequency responses, ``StaticCurves``, steps or a ``Comparison``.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from steering_core.parameters import ParameterSet
from steering_studies.linear import open_centre_study, steering_study, valve_study
from steering_studies.linear.bode import Family
from steering_studies.linear.steps import torque_step
from steering_studies.linear.systems import Comparison, compare
from steering_studies.linear.valve_study import ValveStep, valve_step


def servo_as_printed(parameters: ParameterSet) -> ParameterSet:
    """Return the parameters with (7.15) as it is printed: without a flow feed-forward."""
    return parameters.with_values({"servo_valve.flow_feed_forward": 0.0})


def figure_6_7(parameters: ParameterSet) -> dict[str, ValveStep]:
    """Return the large and the small step of the pressure control valve."""
    return {
        "large": valve_step(parameters, 2e5, 100e5),
        "small": valve_step(parameters, 5e5, 15e5),
    }


def figure_7_6(parameters: ParameterSet) -> Family:
    """Return the loop gain with servo valves as printed."""
    return steering_study.servo_loop_gain(servo_as_printed(parameters))


def figure_7_7(parameters: ParameterSet) -> Family:
    """Return the closed loop with servo valves as printed."""
    return steering_study.servo_closed_loop(servo_as_printed(parameters))


def on_centre(parameters: ParameterSet) -> Comparison:
    """Return both systems on-centre, for figs 8.2 to 8.5."""
    return compare(parameters)


def dry_park(parameters: ParameterSet) -> Comparison:
    """Return both systems against the dry-park spring, fig 8.6."""
    return compare(parameters, "dry_park")


def dry_park_lower_gain(parameters: ParameterSet) -> Comparison:
    """Return fig 8.6 with the source's way: a constant, lower controller gain."""
    lower = {"valve_controller.resonance": 175.0, "valve_controller.resonance_fall_pressure": 0.0}
    return compare(parameters.with_values(lower), "dry_park")


FIGURES: dict[str, Callable[[ParameterSet], Any]] = {
    "4.3": open_centre_study.static_characteristic,
    "4.5": open_centre_study.pressure_response,
    "4.6": open_centre_study.loop_gain,
    "4.7": open_centre_study.closed_loop,
    "6.5": valve_study.static_characteristic,
    "6.6": valve_study.loop_gain,
    "6.7": figure_6_7,
    "6.11": steering_study.closed_centre_loop_gain,
    "6.12": steering_study.closed_centre_closed_loop,
    "7.6": figure_7_6,
    "7.7": figure_7_7,
    "8.1": torque_step,
    "8.2": on_centre,
    "8.3": on_centre,
    "8.4": on_centre,
    "8.5": on_centre,
    "8.6": dry_park,
}
"""The source's figures by number."""
