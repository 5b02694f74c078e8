"""Is the sampled loop stable? Checked before anything runs."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from pressure_control.sampled_loop import SteeringPoint, spectral_radius, steering_point
from steering_core.parameters import ParameterError, ParameterSet
from steering_plant.boost_curve import FORMULA

POINTS = ((0.0, 0.0), (0.5, 0.01), (1.0, 0.02), (2.0, 0.05), (3.0, 0.01))
"""Torsion-bar torque [N m] and rack speed [m/s] of the points, along an on-centre cycle."""


class ControllerError(ValueError):
    """A choice of controller parameters that cannot work."""


def check_sampled_stability(
    parameters: ParameterSet, table: np.ndarray = FORMULA, delay: int = 0
) -> None:
    """Raise ControllerError where the steering loop is unstable in the linear, sampled model.

    delay: ticks declared between measurement and command, both ways added. The error names the
    resonance, the damping, the worst point and the largest stable resonance.
    """
    check_schedule(parameters)
    resonance = parameters["valve_controller.resonance"]
    damping = parameters["valve_controller.damping"]
    points = operating_points(parameters, table)
    radii = [spectral_radius(point, resonance, damping, delay) for point in points]
    if not radii or max(radii) < 1.0:
        return
    worst = points[int(np.argmax(radii))]
    largest = largest_stable_resonance(points, resonance, damping, delay)
    late = f" with {delay} ticks of delay" if delay else ""
    advice = f"at most {largest:.3g} rad/s is stable" if largest > 0.0 else "no resonance is stable"
    raise ControllerError(
        f"valve_controller.resonance {resonance:g} rad/s is unstable at 1 kHz{late} {worst.name}; "
        f"with valve_controller.damping {damping:g} {advice}"
    )


def largest_stable_resonance(
    points: Sequence[SteeringPoint], highest: float, damping: float, delay: int = 0
) -> float:
    """Return the largest resonance [rad/s] up to ``highest`` stable at all points, or 0."""
    low, high = 0.0, highest
    for _ in range(8):
        middle = 0.5 * (low + high)
        if all(spectral_radius(point, middle, damping, delay) < 1.0 for point in points):
            low = middle
        else:
            high = middle
    return low


def operating_points(parameters: ParameterSet, table: np.ndarray = FORMULA) -> list[SteeringPoint]:
    """Return the loop at all of POINTS that the valves can hold."""
    points = []
    for torque, speed in POINTS:
        try:
            points.append(steering_point(parameters, table, torque, speed, 0.0))
        except ParameterError:
            continue
    return points


def check_schedule(parameters: ParameterSet) -> None:
    """Raise ControllerError where the schedule's nominal displacement leaves the valve closed."""
    nominal = parameters["valve_controller.nominal_spool_displacement"]
    underlap = parameters["pressure_control_valve.underlap"]
    if nominal + underlap <= 0.0:
        raise ControllerError(
            f"valve_controller.nominal_spool_displacement {nominal:g} m does not open the valve: "
            f"it must exceed the overlap of {-underlap:g} m"
        )
