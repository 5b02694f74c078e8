"""The pressure control valve's static force balance: demand for a pressure, and the reverse."""

from __future__ import annotations

import numpy as np
from scipy.optimize import brentq

from pressure_control.linear_valve import LinearValve, linearise
from pressure_control.valve_gains import edge_areas, valve_fields, valve_record
from steering_core.parameters import ParameterSet


def holding_demand(parameters: ParameterSet, valve: LinearValve) -> float:
    """Return the demand [Pa], (solenoid force - preload)/A_c, that holds the spool (5.1)."""
    areas = edge_areas(valve_record(parameters)[0], valve.displacement)
    jet = valve_fields(parameters)["jet_factor"]
    flow_force = jet * (areas[0] * (valve.supply - valve.pressure) - areas[2] * valve.pressure)
    spring = parameters["pressure_control_valve.spring_stiffness"] * valve.displacement
    return float(valve.pressure + (spring + flow_force) / valve.A_c)


def pressure_under_flow(parameters: ParameterSet, closed: float, flows: np.ndarray) -> np.ndarray:
    """Return the pressures [Pa] at load flows [m3/s] for the demand that holds ``closed`` [Pa].

    Positive flow leaves the valve (pressure reducing), negative returns (pressure relief), fig 6.5.
    """
    demand = holding_demand(parameters, linearise(parameters, closed, flow=0.0))
    supply = parameters["closed_centre.supply_pressure"]

    def surplus(pressure: float, flow: float) -> float:
        return holding_demand(parameters, linearise(parameters, pressure, flow=flow)) - demand

    lowest, highest = 0.02e5, 0.999 * supply
    found = []
    for flow in np.asarray(flows, float):
        low, high = (lowest, closed) if flow > 0.0 else (closed, highest)
        low = _carrying(parameters, low, high, float(flow)) if flow < 0.0 else low
        at_ends = surplus(low, flow), surplus(high, flow)
        if at_ends[0] * at_ends[1] > 0.0:
            found.append(low if abs(at_ends[0]) < abs(at_ends[1]) else high)
        else:
            found.append(brentq(surplus, low, high, args=(flow,), xtol=1.0))
    return np.array(found)


def _carrying(parameters: ParameterSet, low: float, high: float, flow: float) -> float:
    """Return the lowest pressure [Pa] within the bounds at which the open tank edge can carry."""
    p = valve_record(parameters)[0]
    travel = parameters["pressure_control_valve.maximum_travel"]
    area = edge_areas(p, -travel)[2]
    needed = (flow / (float(p["orifice_constant"]) * area)) ** 2
    return min(max(low, 1.01 * needed + 1.0), high)
