"""One pressure control valve at a chamber of fixed volume, with the simple controller of 6.1."""

from __future__ import annotations

import numpy as np

from steering_core.compiled import kernel
from steering_plant.model import chamber
from steering_plant.model.closed_centre import valve_rates
from steering_plant.model.states import CONTROL, LEFT, LEFT_VALVE, SPOOL, SPOOL_SPEED

STATES = 16
"""Of the plant's closed-centre model; the first valve, its chamber, and the controller are used."""

INTEGRAL = 15
"""Position of the controller's integral [N], behind the plant's states."""

NO_EFFECTS = np.zeros(0)


@kernel
def design_rates(p, y, dy, reference, load_flow, gain, e):
    """Fill the rates of spool, control chamber, chamber pressure and controller.

    F = p_ref A_c + f_0 + integral, integral' = gain A_c (p_ref - p_l); the solenoid only pushes.
    load_flow [m3/s] leaves the chamber.
    """
    pressure = y[LEFT]
    force = max(reference * p.pressure_area + p.spring_preload + y[INTEGRAL], 0.0)
    _, net = valve_rates(p, y, dy, LEFT_VALVE, pressure, p.supply_pressure, force, 0.0, e)
    dy[LEFT] = chamber.stiffness(p, pressure, y, e) / p.chamber_volume * (net - load_flow)
    dy[INTEGRAL] = gain * p.pressure_area * (reference - pressure)


@kernel
def simulate(par, start, reference, load_flow, ramp, gain, step, work, out, e):
    """Fill ``out`` (n, 3) with pressure [Pa], spool [m] and solenoid force [N] at each step.

    The load flow [m3/s] comes in over ``ramp`` steps. Classical Runge-Kutta; the start state is
    what rests at ``start`` [Pa] with the edges shut.
    work: zeros, shape (6, 16). Returns whether the state stayed within bounds; what follows is
    NaN otherwise.
    """
    p = par[0]
    y, at, k1, k2, k3, k4 = work[0], work[1], work[2], work[3], work[4], work[5]
    y[LEFT] = start
    y[LEFT_VALVE + CONTROL] = start
    for i in range(out.shape[0]):
        force = reference * p.pressure_area + p.spring_preload + y[INTEGRAL]
        out[i, 0], out[i, 1], out[i, 2] = y[LEFT], y[LEFT_VALVE + SPOOL], max(force, 0.0)
        if not abs(y[LEFT_VALVE + SPOOL_SPEED]) < 1e4 or not abs(y[LEFT]) < 1e9:
            for j in range(i, out.shape[0]):
                out[j, 0], out[j, 1], out[j, 2] = np.nan, np.nan, np.nan
            return False
        flow = load_flow * min(i / ramp, 1.0)
        design_rates(p, y, k1, reference, flow, gain, e)
        for j in range(STATES):
            at[j] = y[j] + 0.5 * step * k1[j]
        design_rates(p, at, k2, reference, flow, gain, e)
        for j in range(STATES):
            at[j] = y[j] + 0.5 * step * k2[j]
        design_rates(p, at, k3, reference, flow, gain, e)
        for j in range(STATES):
            at[j] = y[j] + step * k3[j]
        design_rates(p, at, k4, reference, flow, gain, e)
        for j in range(STATES):
            y[j] += step / 6.0 * (k1[j] + 2.0 * k2[j] + 2.0 * k3[j] + k4[j])
    return True
