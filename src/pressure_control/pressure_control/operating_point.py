"""The steering gear with both valves and controllers, linear at an operating point."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.linalg import expm

from pressure_control.linear_valve import LinearValve, linearise, state_space
from pressure_control.record import controller_record
from pressure_control.reference import mirrored, reference_pressures
from pressure_control.schedule import flow_feed_forward, opening_for_flow, scheduled_poles
from steering_core.parameters import ParameterSet
from steering_core.ticks import TICK_PERIOD

ANGLE, SPEED, POSITION, VELOCITY = range(4)
VALVES = (4, 8)
"""First state of the right and of the left valve; the fourth of each is the chamber pressure."""

PLANT_SIZE = 12

SPEED_STEP = 1e-4
"""Half width [m/s] over which the slopes by speed are taken: a slow, real motion of the rack."""


@dataclass(frozen=True)
class Chamber:
    """One chamber at the operating point, signs as the right one sees them.

    sign: +1 right, -1 left. poles: (w_0, d_0, K_s) that the schedule takes the valve for.
    load_pressure [Pa]: on which the wanted resonance depends. by_torque [Pa/(N m)], by_speed
    [Pa s/m]: slopes of the reference. feed_forward_by_speed [Pa s/m], feed_forward_by_pressure:
    slopes of the feed-forward, which takes the measured pressure.
    """

    sign: float
    valve: LinearValve
    poles: tuple[float, float, float]
    load_pressure: float
    by_torque: float
    by_speed: float
    feed_forward_by_speed: float
    feed_forward_by_pressure: float


@dataclass(frozen=True)
class SteeringPoint:
    """The loop at one operating point but for the wanted resonance and damping.

    transition (12, 12) and input (12, 2): of gear and valves over one tick, demands held.
    torque_row (12,): torsion-bar torque from the states.
    """

    name: str
    record: Any
    chambers: tuple[Chamber, Chamber]
    transition: np.ndarray
    input: np.ndarray
    torque_row: np.ndarray


def steering_point(
    parameters: ParameterSet,
    table: np.ndarray,
    torque: float,
    speed: float,
    stiffness: float,
    speed_step: float = SPEED_STEP,
) -> SteeringPoint:
    """Return the loop at a torsion-bar torque [N m], rack speed [m/s] and load stiffness [N/m].

    speed_step [m/s]: half width of the slopes by speed; the feed-forward has its dead zone of the
    underlap and a kink at standstill, so a small one is for small signals only. Raises
    ParameterError where the static map leaves the pressures that the valve can hold.
    """
    right = _chamber(parameters, table, 1.0, torque, speed, speed_step)
    left = _chamber(parameters, table, -1.0, torque, speed, speed_step)
    a, b, torque_row = _gear_and_valves(parameters, right.valve, left.valve, stiffness)
    whole = np.zeros((PLANT_SIZE + 2, PLANT_SIZE + 2))
    whole[:PLANT_SIZE, :PLANT_SIZE], whole[:PLANT_SIZE, PLANT_SIZE:] = a, b
    held = expm(whole * TICK_PERIOD)[:PLANT_SIZE]
    return SteeringPoint(
        f"at {torque:g} N m and {speed:g} m/s of the rack",
        controller_record(parameters, "right", table)[0],
        (right, left),
        held[:, :PLANT_SIZE],
        held[:, PLANT_SIZE:],
        torque_row,
    )


def _chamber(
    parameters: ParameterSet,
    table: np.ndarray,
    sign: float,
    torque: float,
    speed: float,
    small_speed: float,
) -> Chamber:
    right = sign > 0.0
    p = controller_record(parameters, "right" if right else "left", table)[0]
    own = table if right else mirrored(table)
    supply, area = float(p["supply_pressure"]), float(p["piston_area"])
    torque, speed = sign * torque, sign * speed

    def reference(at_torque: float, at_speed: float) -> float:
        return reference_pressures(p, own, at_torque, area * at_speed, supply)[0]

    pressure, load_pressure = reference_pressures(p, own, torque, area * speed, supply)
    valve = linearise(parameters, pressure, supply=supply, flow=area * speed)
    poles = scheduled_poles(
        p,
        pressure,
        supply,
        area * speed,
        *opening_for_flow(p, pressure, supply, area * speed)[:2],
        0.0,
    )
    small_torque, small_pressure = 1e-3, 1e2
    by_torque = reference(torque + small_torque, speed) - reference(torque - small_torque, speed)
    by_speed = reference(torque, speed + small_speed) - reference(torque, speed - small_speed)
    faster = _feed_forward(p, pressure, supply, area * (speed + small_speed))
    slower = _feed_forward(p, pressure, supply, area * (speed - small_speed))
    higher = _feed_forward(p, pressure + small_pressure, supply, area * speed)
    lower = _feed_forward(p, pressure - small_pressure, supply, area * speed)
    return Chamber(
        sign,
        valve,
        poles,
        load_pressure,
        sign * by_torque / (2.0 * small_torque),
        sign * by_speed / (2.0 * small_speed),
        sign * (faster - slower) / (2.0 * small_speed),
        (higher - lower) / (2.0 * small_pressure),
    )


def _feed_forward(p: Any, pressure: float, supply: float, flow: float) -> float:
    return flow_feed_forward(p, flow, *opening_for_flow(p, pressure, supply, flow))


def _gear_and_valves(
    parameters: ParameterSet, right: LinearValve, left: LinearValve, stiffness: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return A (12, 12), B (12, 2) and the row of the torsion-bar torque (4.1, 4.2, friction off).

    The driver holds the wheel: gain and lead of his torque act on angle and speed.
    """
    gear, driver = parameters.group("mechanics"), parameters.group("driver")
    torque = np.zeros(PLANT_SIZE)
    torque[ANGLE] = gear["torsion_bar_stiffness"]
    torque[POSITION] = -gear["torsion_bar_stiffness"] * gear["gear_ratio"]
    a, b = np.zeros((PLANT_SIZE, PLANT_SIZE)), np.zeros((PLANT_SIZE, 2))
    a[ANGLE, SPEED] = a[POSITION, VELOCITY] = 1.0
    a[SPEED] = -torque
    a[SPEED, ANGLE] -= driver["gain"]
    a[SPEED, SPEED] -= driver["gain"] * driver["lead"] + gear["steering_wheel_damping"]
    a[SPEED] /= gear["steering_wheel_inertia"]
    a[VELOCITY] = gear["gear_ratio"] * torque
    a[VELOCITY, POSITION] -= stiffness
    a[VELOCITY, VELOCITY] -= gear["rack_damping"]
    for number, (sign, valve) in enumerate(((1.0, right), (-1.0, left))):
        first = VALVES[number]
        inner, inputs, _ = state_space(valve)
        a[first : first + 4, first : first + 4] = inner
        a[first : first + 4, VELOCITY] = sign * gear["piston_area"] * inputs[:, 1]
        a[VELOCITY, first + 3] = sign * gear["piston_area"]
        b[first : first + 4, number] = inputs[:, 0]
    a[VELOCITY] /= gear["rack_mass"]
    return a, b, torque
