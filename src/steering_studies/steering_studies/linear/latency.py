"""Latency and stability: the largest gain at which the sampled loop is stable, by delay."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from pressure_control.servo_loop import largest_servo_gain, servo_points
from pressure_control.stability import largest_stable_resonance, operating_points
from steering_core.parameters import ParameterSet
from steering_studies.linear.chattering import bisected
from steering_studies.linear.systems import limit_cycle

HIGHEST = 3000.0
"""Largest resonance [rad/s] that is looked at: above it nothing fits into a tick."""

NODE_SETS = "closed_centre and its overlay sets"


@dataclass(frozen=True)
class LatencyMap:
    """Largest stable gain by delay [ticks] (n,), for a node set and a way to control it.

    unit of the gain; predicted (n,): by the sampled linear loop, with the growth that the check
    before a run allows; simulated (n,): by on-centre runs, within 6 % (nan: not simulated).
    """

    node_set: str
    way: str
    unit: str
    delay: np.ndarray
    predicted: np.ndarray
    simulated: np.ndarray


def latency_map(
    parameters: ParameterSet, delays: Sequence[int] = (0, 1, 2, 3), *, simulate: bool = True
) -> list[LatencyMap]:
    """Return the maps of all node sets; simulate: find it by runs as well.

    The overlay node sets have the closed_centre set's valve loop; the open-centre set has none.
    """
    ticks = np.array(delays)
    maps = []
    for known in (False, True):
        predicted, simulated = [], []
        for delay in delays:
            way = {"valve_controller.delay_compensation": float(delay if known else 0)}
            changed = parameters.with_values(way)
            damping = changed["valve_controller.damping"]
            points = operating_points(changed)
            predicted.append(largest_stable_resonance(points, HIGHEST, damping, delay))
            simulated.append(_simulated_largest(changed, delay) if simulate else np.nan)
        way_name = "delay known and compensated" if known else "plain"
        maps.append(
            LatencyMap(
                NODE_SETS, way_name, "rad/s", ticks, np.array(predicted), np.array(simulated)
            )
        )
    servos = servo_points(parameters)
    gains = np.array([largest_servo_gain(servos, delay) for delay in delays])
    nothing = np.full(len(ticks), np.nan)
    maps.append(LatencyMap("servo_valve", "plain", "1/s", ticks, gains, nothing))
    return maps


def _simulated_largest(parameters: ParameterSet, delay: int) -> float:
    """Return the resonance [rad/s] beyond which the on-centre run cycles."""

    def cycles(resonance: float) -> bool:
        changed = parameters.with_values({"valve_controller.resonance": resonance})
        return limit_cycle(changed, delay=delay)

    return bisected(cycles, 100.0, HIGHEST, 6)
