"""The load pressure that both valves give with their controllers, as frequency responses.

Two ways: the source's, continuous (6.6 to 6.12), and as the bench runs it: the sampled compensator
behind a hold, with whole valves and delays of whole ticks.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pressure_control.compensator import compensator_gains, desired_resonance
from pressure_control.linear_valve import LinearValve, state_space
from pressure_control.operating_point import Chamber, SteeringPoint
from steering_core.ticks import TICK_PERIOD
from steering_plant.linear.gear import Assistance


@dataclass(frozen=True)
class Manner:
    """How the controllers are seen.

    resonance [rad/s], damping: of the valve controller. sampled: at 1 kHz behind a hold with
    ``delay`` ticks; otherwise continuous. whole: valves with spool mass and control chamber;
    otherwise (5.31). flow_compensation: whether the flow is fed forward (6.9).
    """

    resonance: float
    damping: float
    sampled: bool = True
    whole: bool = True
    delay: int = 0
    flow_compensation: bool = True


def valve_responses(
    valve: LinearValve, omega: np.ndarray, whole: bool = True
) -> tuple[np.ndarray, np.ndarray]:
    """Return chamber pressure over demand and over load flow [Pa s/m3], complex (n,)."""
    s = 1j * np.asarray(omega, float)
    if not whole:
        denominator = (s / valve.w_0) ** 2 + 2.0 * valve.d_0 * s / valve.w_0 + 1.0
        droop = (1.0 + s / valve.w_v) / (valve.K_c * (1.0 + valve.loop_gain))
        return valve.K_s / denominator, -droop / denominator
    a, b, c = state_space(valve)
    inner = np.linalg.solve(s[:, None, None] * np.eye(4) - a, b.astype(complex))
    both = (c @ inner)[:, 0]
    return both[:, 0], both[:, 1]


def chamber_responses(
    point: SteeringPoint, chamber: Chamber, manner: Manner, omega: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return the chamber's pressure over torque, rack speed and wheel speed/R_T, complex (n,).

    The pressure is the chamber's own; torque and speeds carry the signs of the right one.
    """
    p = point.record
    s = 1j * np.asarray(omega, float)
    area = chamber.sign * float(p["piston_area"])
    by_demand, by_flow = valve_responses(chamber.valve, omega, manner.whole)
    w_k = desired_resonance(p, manner.resonance, chamber.load_pressure)
    compensator, hold, lowpass = _controller(p, chamber, w_k, manner, s)
    forward = float(manner.flow_compensation)
    by_demand = by_demand * hold
    inner = 1.0 + by_demand * (compensator - forward * chamber.feed_forward_by_pressure)
    wheel = compensator * chamber.by_speed * (1.0 - lowpass)
    wheel = wheel + forward * chamber.feed_forward_by_speed
    rack = by_demand * compensator * chamber.by_speed * lowpass + by_flow * area
    return (
        by_demand * compensator * chamber.by_torque / inner,
        rack / inner,
        by_demand * wheel / inner,
    )


def closed_centre_assistance(point: SteeringPoint, manner: Manner, omega: np.ndarray) -> Assistance:
    """Return the load pressure of both chambers (6.11) as ``Assistance``."""
    total = [np.zeros(len(omega), complex) for _ in range(3)]
    for chamber in point.chambers:
        parts = chamber_responses(point, chamber, manner, omega)
        total = [t + chamber.sign * part for t, part in zip(total, parts, strict=True)]
    return Assistance(omega, *total)


def pressure_loop_gain(
    point: SteeringPoint, chamber: Chamber, manner: Manner, omega: np.ndarray
) -> np.ndarray:
    """Return the loop gain of one chamber's pressure control (6.7), complex (n,)."""
    s = 1j * np.asarray(omega, float)
    w_k = desired_resonance(point.record, manner.resonance, chamber.load_pressure)
    compensator, hold, _ = _controller(point.record, chamber, w_k, manner, s)
    return compensator * hold * valve_responses(chamber.valve, omega, manner.whole)[0]


def _controller(
    p: np.void, chamber: Chamber, w_k: float, manner: Manner, s: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return compensator, hold with delay, and low-pass of the rack's speed."""
    if not manner.sampled:
        w_0, d_0, static_gain = chamber.poles
        corner = 2.0 * manner.damping * w_k
        cancel = (s / w_0) ** 2 + 2.0 * d_0 * s / w_0 + 1.0
        compensator = w_k**2 * cancel / (s * (s + corner)) / static_gain
        lowpass = 1.0 / (1.0 + s * float(p["velocity_lowpass"]))
        return compensator, np.exp(-s * TICK_PERIOD * manner.delay), lowpass
    before = np.exp(-s * TICK_PERIOD)
    direct, filtered, integral, weight = compensator_gains(w_k, manner.damping, *chamber.poles)
    compensator = direct + integral / (1.0 - before)
    compensator = compensator + filtered * weight / (1.0 - (1.0 - weight) * before)
    hold = (1.0 - before) / (s * TICK_PERIOD) * before**manner.delay
    slip = float(p["slip_weight"])
    return compensator, hold, slip / (1.0 - (1.0 - slip) * before)
