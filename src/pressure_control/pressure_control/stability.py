"""Is the sampled loop stable? Checked before anything runs."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from pressure_control.errors import ControllerError
from pressure_control.operating_point import SteeringPoint, steering_point
from pressure_control.sampled_loop import spectral_radius
from pressure_control.state_places import LONGEST
from steering_core.parameters import ParameterError, ParameterSet
from steering_core.ticks import TICK_PERIOD
from steering_plant.boost_curve import FORMULA

__all__ = ["ControllerError", "check_sampled_stability"]

POINTS = ((0.0, 0.0, 1.03), (1.5, 0.04, 1.03), (2.85, 0.001, 1.08))
"""Torsion-bar torque [N m], rack speed [m/s] and growth a tick of the points: at rest, fast through
the middle, and at the turn of an on-centre cycle.

Up to that growth friction and the short stay at the point keep the full simulation quiet; beyond
it limit cycles were seen there. The boost curve's steep end is passed at the turn only.
"""


def check_sampled_stability(
    parameters: ParameterSet, table: np.ndarray = FORMULA, delay: int | None = None
) -> None:
    """Raise ControllerError where the steering loop is unstable in the linear, sampled model.

    delay: ticks declared between measurement and command, both ways added; None: as many as the
    controller compensates. The error names the
    resonance, the damping, the worst point and the largest stable resonance.
    """
    check_schedule(parameters)
    delay = check_compensation(parameters) if delay is None else delay
    resonance = parameters["valve_controller.resonance"]
    damping = parameters["valve_controller.damping"]
    points = operating_points(parameters, table)
    if not points:
        supply = parameters["closed_centre.supply_pressure"]
        raise ControllerError(
            f"closed_centre.supply_pressure {supply:g} Pa is too low for the valves to hold any "
            "pressure of the boost curve, so nothing can be said of their stability"
        )
    excess = [growth_excess(point, resonance, damping, delay) for point in points]
    if max(excess) < 0.0:
        return
    worst, _ = points[int(np.argmax(excess))]
    largest = largest_stable_resonance(points, resonance, damping, delay)
    late = f" with {delay} ticks of delay" if delay else ""
    advice = f"at most {largest:.3g} rad/s is stable" if largest > 0.0 else "no resonance is stable"
    raise ControllerError(
        f"valve_controller.resonance {resonance:g} rad/s is unstable at 1 kHz{late} {worst.name}; "
        f"with valve_controller.damping {damping:g} {advice}"
    )


Point = tuple[SteeringPoint, float]
"""An operating point and the growth a tick that is allowed there."""


def growth_excess(point: Point, resonance: float, damping: float, delay: int = 0) -> float:
    """Return by how much the loop grows faster than allowed; below zero it passes."""
    return spectral_radius(point[0], resonance, damping, delay) - point[1]


def largest_stable_resonance(
    points: Sequence[Point], highest: float, damping: float, delay: int = 0
) -> float:
    """Return the largest resonance [rad/s] up to ``highest`` that passes at all points, or 0."""
    low, high = 0.0, min(highest, np.pi / TICK_PERIOD)
    for _ in range(8):
        middle = 0.5 * (low + high)
        if all(growth_excess(point, middle, damping, delay) < 0.0 for point in points):
            low = middle
        else:
            high = middle
    return low


def operating_points(parameters: ParameterSet, table: np.ndarray = FORMULA) -> list[Point]:
    """Return the loop at all of POINTS that the valves can hold."""
    points = []
    for torque, speed, growth in POINTS:
        try:
            points.append((steering_point(parameters, table, torque, speed, 0.0), growth))
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


def check_compensation(parameters: ParameterSet) -> int:
    """Return the ticks that are compensated; ControllerError unless a number that can be kept."""
    ticks = parameters["valve_controller.delay_compensation"]
    if not (ticks.is_integer() and ticks < LONGEST):
        raise ControllerError(
            f"valve_controller.delay_compensation must be a whole number of ticks up to "
            f"{LONGEST - 1}, got {ticks:g}"
        )
    return int(ticks)
