"""The steering gear with four servo valves, linear at an operating point (section 7.2)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.linalg import expm

from pressure_control.record import Side
from pressure_control.reference import mirrored, reference_pressures
from pressure_control.servo_record import flow_gain, servo_controller_record
from steering_core.parameters import ParameterError, ParameterSet
from steering_core.ticks import TICK_PERIOD
from steering_plant.boost_curve import FORMULA
from steering_plant.orifice import orifice_flow, orifice_flow_gain

ANGLE, SPEED, POSITION, VELOCITY = range(4)
PAIRS = (4, 7)
"""First state of the right and of the left chamber: pressure, opening of its valves, its rate."""

PLANT_SIZE = 10


@dataclass(frozen=True)
class ServoChamber:
    """One chamber with its valves at the operating point, signs as the right one sees them.

    sign: +1 right, -1 left. pressure [Pa]. flow_gain K_q [m3/s], flow_pressure K_c [m3/(s Pa)] of
    both valves together (7.8), opening of the meter-in valve. by_torque [Pa/(N m)], by_speed
    [Pa s/m]: slopes of the reference. gain_slope [1/Pa]: of 1/K_q with the measured pressure,
    over 1/K_q. steady [m3/s]: what the controller asks for beside its resting command.
    """

    sign: float
    pressure: float
    opening: float
    flow_gain: float
    flow_pressure: float
    by_torque: float
    by_speed: float
    gain_slope: float
    steady: float


@dataclass(frozen=True)
class ServoPoint:
    """The loop at one operating point but for the controller's gain.

    transition (10, 10) and input (10, 2): of gear and valves over one tick, commands held.
    system (10, 10), drive (10, 2): the same in continuous time.
    """

    name: str
    record: Any
    chambers: tuple[ServoChamber, ServoChamber]
    transition: np.ndarray
    input: np.ndarray
    system: np.ndarray
    drive: np.ndarray
    torque_row: np.ndarray


def servo_point(
    parameters: ParameterSet,
    torque: float,
    speed: float,
    table: np.ndarray = FORMULA,
    stiffness: float = 0.0,
) -> ServoPoint:
    """Return the loop at a torsion-bar torque [N m], rack speed [m/s] and load stiffness [N/m].

    Raises ParameterError where valves or supply cannot hold the point.
    """
    chambers = (
        servo_chamber(parameters, table, 1.0, torque, speed),
        servo_chamber(parameters, table, -1.0, torque, speed),
    )
    a, b, row = _gear_and_valves(parameters, chambers, stiffness)
    whole = np.zeros((PLANT_SIZE + 2, PLANT_SIZE + 2))
    whole[:PLANT_SIZE, :PLANT_SIZE], whole[:PLANT_SIZE, PLANT_SIZE:] = a, b
    held = expm(whole * TICK_PERIOD)[:PLANT_SIZE]
    name = f"at {torque:g} N m and {speed:g} m/s of the rack"
    record = servo_controller_record(parameters, "right", table)[0]
    return ServoPoint(name, record, chambers, held[:, :PLANT_SIZE], held[:, PLANT_SIZE:], a, b, row)


def servo_chamber(
    parameters: ParameterSet, table: np.ndarray, sign: float, torque: float, speed: float
) -> ServoChamber:
    """Return one chamber at the operating point; ``sign`` is +1 for the right one."""
    side: Side = "right" if sign > 0.0 else "left"
    p = servo_controller_record(parameters, side, table)[0]
    own = table if sign > 0.0 else mirrored(table)
    supply, area = float(p["supply_pressure"]), float(p["piston_area"])
    torque, speed = sign * torque, sign * speed

    def reference(at_torque: float, at_speed: float) -> float:
        return float(reference_pressures(p, own, at_torque, area * at_speed, supply)[0])

    pressure = reference(torque, speed)
    transition = p["laminar_transition_pressure"]
    full = p["orifice_constant"] * p["servo_full_opening"]
    inward = orifice_flow(full, supply - pressure, transition)
    outward = orifice_flow(full, pressure, transition)
    bias, gain = p["servo_bias"], float(flow_gain(p, pressure, supply))
    command = float((area * speed - bias * (inward - outward)) / gain)
    if abs(command) >= bias or pressure <= 0.0:
        raise ParameterError(
            f"the servo valves have no linear point at {torque:g} N m, {speed:g} m/s"
        )
    flow_pressure = orifice_flow_gain(full * (bias + command), supply - pressure, transition)
    flow_pressure += orifice_flow_gain(full * (bias - command), pressure, transition)
    dt, dv, dp = 1e-3, 1e-4, 1e2
    slope = gain / flow_gain(p, pressure + dp, supply) - gain / flow_gain(p, pressure - dp, supply)
    return ServoChamber(
        sign,
        pressure,
        float(bias + command),
        gain,
        float(flow_pressure),
        sign * (reference(torque + dt, speed) - reference(torque - dt, speed)) / (2.0 * dt),
        sign * (reference(torque, speed + dv) - reference(torque, speed - dv)) / (2.0 * dv),
        float(slope) / (2.0 * dp),
        float((command - p["rest_command"]) * gain),
    )


def _gear_and_valves(
    parameters: ParameterSet, chambers: tuple[ServoChamber, ServoChamber], stiffness: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return A (10, 10), B (10, 2) and the row of the torsion-bar torque (4.1, 4.2, 7.3, 7.8).

    Friction is off; the driver holds the wheel, gain and lead of his torque on angle and speed.
    """
    gear, driver = parameters.group("mechanics"), parameters.group("driver")
    servo = parameters.group("servo_valve")
    rate = parameters["oil.bulk_modulus"] / parameters["open_centre.chamber_volume"]
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
    for number, chamber in enumerate(chambers):
        pressure, opening, opening_rate = range(PAIRS[number], PAIRS[number] + 3)
        a[VELOCITY, pressure] = chamber.sign * gear["piston_area"]
        a[pressure, opening] = rate * chamber.flow_gain
        a[pressure, pressure] = -rate * chamber.flow_pressure
        a[pressure, VELOCITY] = -rate * chamber.sign * gear["piston_area"]
        a[opening, opening_rate] = 1.0
        a[opening_rate, opening] = -(servo["resonance"] ** 2)
        a[opening_rate, opening_rate] = -2.0 * servo["damping"] * servo["resonance"]
        b[opening_rate, number] = servo["resonance"] ** 2
    a[VELOCITY] /= gear["rack_mass"]
    return a, b, torque
