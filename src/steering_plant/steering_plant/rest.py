"""The plant's equilibrium at the start: wheel and rack centred, no load, valves in balance."""

from __future__ import annotations

import numpy as np
from scipy.optimize import brentq

from steering_core.parameters import ParameterError
from steering_plant import boost_curve
from steering_plant.control_valve import holes_area
from steering_plant.model.states import (
    CLOSED_CENTRE_SIZE,
    CONTROL,
    LEFT,
    LEFT_SERVO,
    LEFT_VALVE,
    LOAD_CYLINDER_NAMES,
    LOAD_LEFT,
    LOAD_RIGHT,
    METER_IN,
    METER_OUT,
    OPEN_CENTRE_SIZE,
    PUMP,
    RIGHT,
    RIGHT_SERVO,
    RIGHT_VALVE,
    SERVO_VALVE_SIZE,
    SPOOL,
)
from steering_plant.orifice import orifice_flow


def rest_state(
    par: np.ndarray, table: np.ndarray, raised: float = 0.0, known: np.ndarray | None = None
) -> np.ndarray:
    """Return the state at rest: of open centre, closed centre or servo valves, and load cylinder.

    raised: common pressure raise of the pressure controllers [Pa]. known: the record that these
    controllers hold the plant to be, where effects have changed it.
    """
    p = par[0]
    controlled = par if known is None else known
    if p["closed_centre"] > 0.0:
        state = _closed_centre(p, closed_centre_rest_pressure(controlled, table, raised))
    elif p["servo_valve"] > 0.0:
        state = _servo_valve(p, closed_centre_rest_pressure(controlled, table, raised))
    else:
        state = _open_centre(p, table)
    return np.concatenate([state, _load_cylinder(p)]) if p["load_cylinder"] > 0.0 else state


def closed_centre_rest_pressure(par: np.ndarray, table: np.ndarray, raised: float) -> float:
    """Return both chambers' pressure at rest [Pa]: the open-centre map's plus the common raise.

    Raises ParameterError where the supply cannot give it.
    """
    right, _ = boost_curve.static_pressures(par[0], table, 0.0, 0.0)
    pressure, supply = float(right) + raised, float(par[0]["supply_pressure"])
    if pressure >= supply:
        raise ParameterError(
            f"closed_centre.supply_pressure {supply:g} Pa must exceed the chambers' pressure at "
            f"rest, {pressure:g} Pa, of which the common pressure raise is {raised:g}"
        )
    return pressure


def rest_spool(p: np.void, pressure: float) -> float:
    """Return the spool position [m] at which supply and tank edge pass the same flow."""
    underlap = float(p["underlap"])
    if underlap <= 0.0:
        return 0.0

    def surplus(spool: float) -> float:
        supply_area = holes_area(p["hole_diameter"], spool + underlap)
        tank_area = holes_area(p["hole_diameter"], underlap - spool)
        transition = p["laminar_transition_pressure"]
        drop = p["supply_pressure"] - pressure
        inflow = orifice_flow(supply_area, drop, transition)
        return float(inflow - orifice_flow(tank_area, pressure, transition))

    return float(brentq(surplus, -underlap, underlap, xtol=1e-18))


def rest_solenoid_force(p: np.void, pressure: float) -> float:
    """Return the solenoid force [N] that holds ``pressure`` [Pa] without load flow (eq. 5.1)."""
    spool = rest_spool(p, pressure)
    underlap = p["underlap"]
    jet = 2.0 * p["flow_coefficient"] * p["jet_angle_cosine"]
    supply_area = holes_area(p["hole_diameter"], spool + underlap)
    tank_area = holes_area(p["hole_diameter"], underlap - spool)
    flow_force = jet * (supply_area * (p["supply_pressure"] - pressure) - tank_area * pressure)
    spring = p["spring_preload"] + p["spring_stiffness"] * spool
    return float(p["pressure_area"] * pressure + spring + flow_force)


def rest_servo_command(p: np.void, pressure: float) -> float:
    """Return the command, a share of the stroke, that holds ``pressure`` [Pa] without load flow.

    bias + c passes from the supply what bias - c passes to the tank.
    """
    transition = p["laminar_transition_pressure"]
    inward = orifice_flow(1.0, p["supply_pressure"] - pressure, transition)
    outward = orifice_flow(1.0, pressure, transition)
    return float(p["servo_bias"] * (outward - inward) / (outward + inward))


def rest_signals(p: np.void, names: tuple[str, ...], state: np.ndarray) -> dict[str, float]:
    """Return what effects' states can be equal to at rest: the states and the valves' commands."""
    signals = dict(zip(names, state.tolist(), strict=True))
    force = 0.0
    if p["closed_centre"] > 0.0:
        force = rest_solenoid_force(p, state[LEFT])
    elif p["servo_valve"] > 0.0:
        force = rest_servo_command(p, state[LEFT])
    return signals | {"left_solenoid": force, "right_solenoid": force}


def _servo_valve(p: np.void, pressure: float) -> np.ndarray:
    state = np.zeros(SERVO_VALVE_SIZE)
    state[[LEFT, RIGHT]] = pressure
    command = rest_servo_command(p, pressure)
    for first in (LEFT_SERVO, RIGHT_SERVO):
        state[first + METER_IN] = p["servo_stroke"] * (p["servo_bias"] + command)
        state[first + METER_OUT] = p["servo_stroke"] * (p["servo_bias"] - command)
    return state


def _load_cylinder(p: np.void) -> np.ndarray:
    state = np.zeros(len(LOAD_CYLINDER_NAMES))
    state[[LOAD_LEFT, LOAD_RIGHT]] = 0.5 * p["load_supply_pressure"]
    return state


def _closed_centre(p: np.void, pressure: float) -> np.ndarray:
    state = np.zeros(CLOSED_CENTRE_SIZE)
    state[[LEFT, RIGHT]] = pressure
    for first in (LEFT_VALVE, RIGHT_VALVE):
        state[first + SPOOL] = rest_spool(p, pressure)
        state[first + CONTROL] = pressure
    return state


def _open_centre(p: np.void, table: np.ndarray) -> np.ndarray:
    area, _ = boost_curve.opening_areas(p, table, 0.0)
    conductance = float(p["orifice_constant"] * area)

    def surplus(pressure: float) -> float:
        transition = p["laminar_transition_pressure"]
        return float(2.0 * orifice_flow(conductance, pressure, transition) - p["pump_flow"])

    pressure = brentq(surplus, 0.0, 1e9, xtol=1e-9)
    state = np.zeros(OPEN_CENTRE_SIZE)
    state[[LEFT, RIGHT]] = pressure
    state[PUMP] = 2.0 * pressure
    return state
